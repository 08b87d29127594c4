"""Scenario and JSON: a round trip loses no bit, and the text is the same everywhere."""

import copy
import dataclasses
import json
import math
import pickle
import sys
from pathlib import Path
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

import crawler2d as c2d
from crawler2d import _core
from crawler2d.parameters.scenario import Scenario
from tests.shared import POINTS, ROBOT, VARIANTS

SHARED = sorted((Path(__file__).parents[1] / "scenarios").glob("*.json"))


@pytest.mark.parametrize("name", VARIANTS)
def test_a_scenario_survives_json(name: str) -> None:
    scenario = VARIANTS[name]
    scenario.validate()
    assert Scenario.from_json(scenario.to_json()) == scenario
    assert Scenario.from_json(scenario.to_json(indent=2)) == scenario


@pytest.mark.parametrize("indent", ["x", "\t", True, -1, 2.5, 10**9])
def test_a_wrong_indent_is_refused_before_it_makes_text_that_is_no_json(indent: Any) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"^indent must be a whole number from 0 to 16, g"):
        VARIANTS["belt-lanes"].to_json(indent=indent)


@pytest.mark.parametrize("name", VARIANTS)
def test_a_scenario_can_be_hashed_pickled_and_copied(name: str) -> None:
    scenario = VARIANTS[name]
    for twin in (pickle.loads(pickle.dumps(scenario)), copy.deepcopy(scenario)):
        assert twin == scenario
        assert hash(twin) == hash(scenario)
        assert twin.identity == scenario.identity


@pytest.mark.parametrize("path", SHARED, ids=lambda path: path.stem)
def test_a_shared_scenario_file_reads_and_writes_back(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert json.loads(Scenario.from_json(text).to_json()) == json.loads(text)


# Over the whole range of exponents: a decimal detour loses the last bit of about one in ten.
LENGTHS = st.floats(min_value=1e-3, max_value=1e2, exclude_max=True)
FRICTIONS = st.floats(min_value=sys.float_info.min, max_value=100.0) | st.just(0.0)


@given(
    friction=FRICTIONS,
    speed=st.floats(min_value=-1.0, max_value=1.0, allow_subnormal=False),
    approach=st.floats(min_value=0.0, max_value=10.0, allow_subnormal=False),
    x=st.lists(LENGTHS, min_size=1, max_size=20, unique=True),
    name=st.text(),
)
def test_every_bit_survives(
    friction: float, speed: float, approach: float, x: list[float], name: str
) -> None:
    points = [(-1e3, 0.0), *((value, 0.0) for value in sorted(x)), (1e3, 0.0)]
    terrain = c2d.terrains.from_points(points, goal=x[0], friction=friction)
    scenario = Scenario(
        dataclasses.replace(ROBOT, name=name),
        terrain,
        drive=c2d.Drive(speed=speed),
        start=c2d.Start(approach=approach),
    )
    copied = Scenario.from_json(scenario.to_json())
    assert copied == scenario
    assert copied.identity == scenario.identity


def test_the_json_has_every_key_and_a_kind_for_every_variant() -> None:
    plain = json.loads(VARIANTS["belt-lanes"].to_json())
    assert list(plain)[:2] == ["robot", "terrain"]
    assert plain["robot"]["track"] == {"kind": "belt"}
    assert plain["robot"]["flippers"] is None
    assert plain["goal"] is None
    assert plain["terrain"]["left"]["kind"] == "step"
    assert set(plain) == {field.name for field in dataclasses.fields(Scenario)}


def test_equal_scenarios_have_one_identity_and_different_ones_another(scenario: Scenario) -> None:
    same = scenario.replace({"terrain.height": np.float64(0.03), "duration": 6})
    assert same == scenario
    assert same.identity == scenario.identity
    assert scenario.replace({"terrain.height": 0.031}).identity != scenario.identity


@pytest.mark.parametrize("path", ["goal", "start.angle", "start.track_phase", "drive.speed"])
def test_a_zero_below_zero_is_the_same_scenario_and_the_same_run(
    scenario: Scenario, path: str
) -> None:
    fields = {"goal": 0.0, "terrain": c2d.terrains.from_points(POINTS, goal=0.0), "duration": 0.2}
    plain = scenario.replace(fields | {path: 0.0})
    below = scenario.replace(fields | {path: -0.0})
    assert below == plain
    assert repr(below) == repr(plain)
    assert below.identity == plain.identity
    text = plain.to_json()
    by_hand = json.loads(text)
    place = by_hand
    *parents, last = path.split(".")
    for name in parents:
        place = place[name]
    place[last] = -0.0
    changed = json.dumps(by_hand)
    assert "-0.0" in changed
    assert _core.identity(changed) == plain.identity
    assert _core.canonical(changed) == _core.canonical(text)
    runs = [_core.simulate(each, 0.01, "full", [])["trace"] for each in (text, changed)]
    for name, column in runs[0].items():
        assert column.tobytes() == runs[1][name].tobytes()


def test_a_zero_below_zero_in_a_list_is_the_same_scenario(scenario: Scenario) -> None:
    above, below = ([[-3.0, zero], [zero, zero], [0.0, 0.05], [3.0, 0.05]] for zero in (0.0, -0.0))
    first, second = (
        scenario.replace({"terrain": c2d.terrains.from_points(points, goal=0.0)})
        for points in (above, below)
    )
    assert repr(first) == repr(second)
    assert first.identity == second.identity


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_refused_by_its_path(
    scenario: Scenario, value: float
) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        scenario.replace({"robot.outline.front_radius": value}).validate()
    assert caught.value.path == "robot.outline.front_radius"


@pytest.mark.parametrize(
    ("number", "plain"),
    [
        (np.float64(0.3), 0.3),
        (np.float32(0.5), 0.5),
        (np.array(0.3), 0.3),
        (np.int64(1), 1.0),
        (np.uint8(1), 1.0),
        (np.longdouble(0.3), 0.3),
        (1, 1.0),
    ],
)
def test_a_numpy_scalar_is_a_plain_number(scenario: Scenario, number: Any, plain: float) -> None:
    variant = scenario.replace({"start.approach": number})
    assert type(variant.start.approach) is float
    assert variant == scenario.replace({"start.approach": plain})
    assert Scenario.from_json(variant.to_json()) == variant


def test_a_whole_number_beyond_float64_is_the_nearest(scenario: Scenario) -> None:
    variant = scenario.replace({"robot.moment_of_inertia": 2**53 + 1})
    assert repr(variant.robot.moment_of_inertia) == repr(2.0**53)
    assert Scenario.from_json(variant.to_json()) == variant


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("robot", "engineer"),
        ("robot", {"name": "engineer"}),
        ("robot", c2d.Robot),
        ("robot", None),
        ("robot.track", c2d.RoundWheel()),
        ("terrain", ROBOT),
        ("terrain", object()),
        ("drive", 0.4),
        ("duration", object()),
        ("duration", [1.0]),
        ("duration", 1j),
        ("duration", np.float64),
        ("duration", np.array([1.0])),
        ("duration", "15"),
        ("duration", True),
        ("duration", np.True_),
        ("duration", None),
        ("duration", 10**400),
        ("robot.name", 5),
        ("robot.name", b"engineer"),
        ("robot.name", "\ud800"),
        ("solver.iterations", 2.5),
        ("solver.iterations", "4"),
        ("solver.iterations", 2**70),
        ("solver.iterations", True),
    ],
)
def test_an_invalid_scenario_is_refused_by_its_path(
    scenario: Scenario, path: str, value: object
) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        scenario.replace({path: value}).validate()
    assert caught.value.path == path


@pytest.mark.parametrize(
    "text", ["", "{", "[]", "3", "null", '"x"', "{}", "\ud800", '{"a":1,"a":2}']
)
def test_a_text_that_is_no_scenario_is_refused(text: str) -> None:
    with pytest.raises(c2d.ScenarioError):
        Scenario.from_json(text)


@pytest.mark.parametrize("text", [None, b"{}", 5, {}, Path("scenario.json")])
def test_anything_but_text_is_refused(text: Any) -> None:
    with pytest.raises(c2d.ScenarioError, match="scenario must be a string"):
        Scenario.from_json(text)


@pytest.mark.parametrize(
    ("old", "new", "path"),
    [
        ('"mass":', '"mass":5.0,"mass":', "robot.mass"),
        ('"speed":0.4', '"speed":0.4,"sp\\u0065ed":0.4', "drive.speed"),
        ('"duration":6.0', '"duration":6.0,"robot":null', "robot"),
    ],
)
def test_a_key_that_is_given_twice_is_refused_by_its_path(
    scenario: Scenario, old: str, new: str, path: str
) -> None:
    text = scenario.to_json()
    assert old in text
    with pytest.raises(c2d.ScenarioError, match="must be given only once") as caught:
        Scenario.from_json(text.replace(old, new, 1))
    assert caught.value.path == path


@pytest.mark.parametrize("number", ["1e-400", "-1e-400", "0.0000012E-330", "1e400", "1" * 400])
def test_a_number_that_no_float_can_hold_is_refused_by_its_path(
    scenario: Scenario, number: str
) -> None:
    text = scenario.to_json().replace('"track_phase":0.0', f'"track_phase":{number}')
    with pytest.raises(c2d.ScenarioError, match="must be a number that fits in float64") as caught:
        Scenario.from_json(text)
    assert caught.value.path == "start.track_phase"


@pytest.mark.parametrize("zero", ["0", "-0", "0e5", "0.000e-400", "-0.0E+7"])
def test_a_zero_may_be_written_in_any_way(scenario: Scenario, zero: str) -> None:
    text = scenario.to_json().replace('"track_phase":0.0', f'"track_phase":{zero}')
    assert Scenario.from_json(text) == scenario


def test_a_number_too_small_to_keep_its_digits_is_refused_with_the_reason(
    scenario: Scenario,
) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"must be 0 or at least 2\.2.*e-308 in magnitude"):
        scenario.replace({"start.track_phase": 1e-310}).validate()


def test_a_text_cut_short_is_refused_wherever_it_ends(scenario: Scenario) -> None:
    text = scenario.to_json()
    for end in range(len(text)):
        with pytest.raises(c2d.ScenarioError):
            Scenario.from_json(text[:end])


@pytest.mark.parametrize(("begin", "end"), [("[", "]"), ('{"robot":', "}"), ('{"a":[', "]}")])
@pytest.mark.parametrize("depth", [20, 10_000, 1_000_000])
def test_deep_nesting_is_refused(begin: str, end: str, depth: int) -> None:
    with pytest.raises(c2d.ScenarioError, match="must be JSON"):
        Scenario.from_json(begin * depth)
    with pytest.raises(c2d.ScenarioError, match="must not be nested more than 12 levels deep"):
        Scenario.from_json(begin * depth + "1" + end * depth)


@pytest.mark.parametrize(
    ("text", "got"),
    [
        ("{}", "{}"),
        ('{"robots": 1, "a": 2}', "JSON of something else, with the keys robots, a"),
        ('{"$schema": "x", "type": "object"}', "JSON of something else, with the keys $schema, t"),
        (json.dumps(dict.fromkeys("abcdefgh", 0)), "JSON of something else, with the keys a, b, c"),
    ],
)
def test_json_of_something_else_is_refused_as_such(text: str, got: str) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"must be what Scenario\.to_json writes") as caught:
        Scenario.from_json(text)
    assert caught.value.path == "scenario"
    assert str(caught.value.value).startswith(got)
    with pytest.raises(c2d.ScenarioError, match="schema must be given"):  # as in another version
        Scenario.from_json('{"robot": {}}')


def test_a_field_that_is_missing_is_looked_for_among_those_given(scenario: Scenario) -> None:
    text = scenario.to_json()
    for key, rule in [
        ('"hieght":', "must be given (is hieght a misspelling of it?)"),
        ('"tall":', "must be given"),
        (f'"{"height" * 100_000}":', "must be given"),
    ]:
        with pytest.raises(c2d.ScenarioError) as caught:
            Scenario.from_json(text.replace('"height":', key))
        assert (caught.value.path, caught.value.rule) == ("terrain.height", rule)
