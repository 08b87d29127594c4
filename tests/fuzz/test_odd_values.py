"""Invalid values of any type are refused with the path of the field, in a short message."""

import enum
import pickle
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.fuzz.objects import Refuses
from tests.shared import ROBOT

BASE = Scenario(ROBOT, c2d.terrains.flat())
ANY: Any = c2d
ANY_ROBOT: Any = ROBOT
HUGE = 10**5000
"""Python itself writes no number of so many digits."""


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("duration", (None,)),
        ("duration", (1.0, 2.0)),
        ("robot.name", ("engineer",)),
        ("solver.iterations", ()),
        ("robot.outline.front_radius", (("a", 1), None)),
    ],
)
def test_a_tuple_is_no_number_and_no_text(scenario: Scenario, path: str, value: Any) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        scenario.replace({path: value}).to_json()
    assert caught.value.path == path


@pytest.mark.parametrize("number", [float("inf"), float("-inf"), float("nan"), 10**400, 1.0])
def test_a_number_is_no_name(scenario: Scenario, number: float) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"robot.name must be a string"):
        scenario.replace({"robot.name": number}).validate()


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("robot.center_of_mass", Refuses()),
        ("robot.center_of_mass", [Refuses(), 1.0]),
        ("robot.belly", Refuses()),
        ("robot.belly", [[0.0, 0.0], Refuses()]),
        ("drive.schedule", [Refuses()]),
        ("duration", Refuses()),
        ("robot.track", Refuses()),
    ],
)
def test_an_object_that_fails_whatever_it_is_asked_is_refused(
    scenario: Scenario, path: str, value: Any
) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        scenario.replace({path: value}).validate()
    assert caught.value.path.startswith(path)
    assert "Refuses" in str(pickle.loads(pickle.dumps(caught.value)))


def test_a_number_of_a_class_of_ones_own_is_a_plain_number(scenario: Scenario) -> None:
    class Length(float):
        def __repr__(self) -> str:
            return "a length"

    class Step(enum.IntEnum):
        FOUR = 4

    own = {"duration": Length(4.0), "start.approach": Step.FOUR, "solver.iterations": Step.FOUR}
    variant = scenario.replace(own)
    plain = scenario.replace({"duration": 4.0, "start.approach": 4.0, "solver.iterations": 4})
    assert repr(variant) == repr(plain)
    assert variant.to_json() == plain.to_json()


@pytest.mark.parametrize(
    "value",
    [HUGE, -HUGE, [HUGE], (HUGE, {"a": HUGE}), "x" * 100_000, ["x" * 100_000]],
    ids=["positive", "negative", "in a list", "in a tuple", "text", "text in a list"],
)
def test_an_error_about_a_huge_value_can_be_shown_and_handed_on(value: Any) -> None:
    error = c2d.ScenarioError("duration", value, "must be a number")
    copy = pickle.loads(pickle.dumps(error))
    assert str(copy) == str(error)
    assert len(str(error)) < 300
    assert len(repr(error)) < 300


def test_an_error_keeps_what_is_short_as_it_is() -> None:
    for value in ("x" * 80, 2**64, -1, 1e308, True, None):
        kept = c2d.ScenarioError("duration", value, "must be a number").value
        assert kept == value
        assert type(kept) is type(value)


@pytest.mark.parametrize(
    ("make", "path", "rule"),
    [
        (lambda: ANY_ROBOT.with_track("wheels"), "robot.track", "must be a LineOfWheels or"),
        (lambda: ANY_ROBOT.with_track(ANY.BeltTrack), "robot.track", "write BeltTrack(...)"),
        (lambda: ANY_ROBOT.with_track(None), "robot.track", "must be a LineOfWheels or"),
        (lambda: ANY_ROBOT.with_flippers("built"), "robot.flippers", "must be a Flippers"),
        (lambda: ANY.terrains.step(0.1, friction="0.7"), "terrain.friction", "not a string"),
        (lambda: ANY.terrains.step(None), "terrain.height", "must be a number"),
        (lambda: ANY.LineOfWheels("4"), "robot.track.count", "must be a whole number"),
        (
            lambda: ANY.LineOfWheels(4, wheel=ANY.GearWheel),
            "robot.track.wheel",
            "GearWheel(",
        ),
        (lambda: ANY.Scenario(ANY_ROBOT, "step"), "terrain", "must be a Flat or"),
        (lambda: ANY.Scenario(ANY_ROBOT, ANY.terrains.flat), "terrain", "write Flat(...)"),
        (lambda: ANY.Drive(gait=ANY.Climb), "drive.gait", "write Climb(...)"),
        (lambda: ANY.Solver(engine=3), "solver.engine", "must be one of own, rapier"),
        (lambda: BASE.replace({"solver": "rapier"}), "solver", "must be a Solver"),
    ],
)
def test_a_value_of_another_type_is_refused_where_it_is_given(
    make: Any, path: str, rule: str
) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        make()
    assert caught.value.path == path
    assert rule in caught.value.rule


@pytest.mark.parametrize("value", [HUGE, -HUGE, 10**400], ids=["huge", "less", "infinite"])
def test_a_scenario_can_be_shown_because_no_field_holds_what_no_float_does(
    scenario: Scenario, value: int
) -> None:
    for path in ("duration", "solver.iterations", "robot.mass"):
        with pytest.raises(c2d.ScenarioError, match=f"^{path} must fit in float64, got a whole"):
            scenario.replace({path: value})
    assert repr(scenario.replace({"duration": 2**70})).endswith(f"duration={2.0**70})")
