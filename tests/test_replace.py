"""Variants by dotted path."""

import dataclasses

import pytest

import crawler2d as c2d
from conftest import ROBOT, VARIANTS
from crawler2d.scenario import Scenario


def test_a_path_replaces_one_field_and_nothing_else() -> None:
    scenario = VARIANTS["line-flat"]
    variant = scenario.replace({"robot.track.count": 5})
    assert variant.robot.track == c2d.LineOfWheels(5, wheel_radius=0.06)
    assert dataclasses.replace(variant.robot, track=scenario.robot.track) == scenario.robot
    assert dataclasses.replace(variant, robot=scenario.robot) == scenario


def test_paths_are_replaced_in_order() -> None:
    scenario = VARIANTS["belt-step"].replace(
        {"robot.track": c2d.LineOfWheels(3), "robot.track.count": 5}
    )
    assert scenario.robot.track == c2d.LineOfWheels(5)


def test_a_path_reaches_into_lanes() -> None:
    scenario = VARIANTS["belt-lanes"].replace({"terrain.left.height": 0.1})
    assert scenario.to_json().count('"height":0.1') == 1


def test_nothing_to_replace_is_the_same_scenario(scenario: Scenario) -> None:
    assert scenario.replace({}) == scenario


def test_the_original_does_not_change(scenario: Scenario) -> None:
    before = scenario.to_json()
    scenario.replace({"terrain.height": 0.2, "duration": 1.0})
    assert scenario.to_json() == before


@pytest.mark.parametrize(
    ("path", "message"),
    [
        (
            "robot.track.cuont",
            "a field of LineOfWheels: count, wheel_radius, wheel (did you mean count?)",
        ),
        ("Duration", "(did you mean duration?)"),
        ("terrain.height", "a field of Flat: length, friction"),
        ("robot.track.kind", "a field of LineOfWheels"),
        ("robot.track.wheel.radius", "a field of RoundWheel: it has none"),
        ("goal.x", "goal = 1.0 has none"),
        ("robot.flippers.length", "robot.flippers = None has none"),
        ("", "a field of Scenario"),
        ("robot..mass", "a field of Robot"),
    ],
)
def test_an_unknown_path_lists_the_fields_and_the_nearest(path: str, message: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        VARIANTS["line-flat"].replace({path: 1.0})
    assert message in str(caught.value)
    assert caught.value.path == path


def test_another_track_is_the_same_robot() -> None:
    other = ROBOT.with_track(c2d.LineOfWheels(3))
    assert other.track == c2d.LineOfWheels(3)
    assert other.with_track(ROBOT.track) == ROBOT
