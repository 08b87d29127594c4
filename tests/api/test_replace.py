"""Variants by dotted path."""

import dataclasses
import json
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.fields import read_path
from crawler2d.parameters.scenario import Scenario
from tests.shared import ROBOT, VARIANTS, with_flippers


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


def test_setting_the_accuracy_or_the_time_step_clears_the_other() -> None:
    scenario = VARIANTS["belt-step"]
    steps = scenario.replace({"solver.time_step": 1e-3})
    assert steps.solver == c2d.Solver(time_step=1e-3)
    assert steps.solver.accuracy is None
    fine = steps.replace({"solver.accuracy": 1e-7})
    assert fine.solver == c2d.Solver(accuracy=1e-7)
    assert fine.solver.time_step is None
    for variant in (steps, fine):
        variant.validate()
        assert Scenario.from_json(variant.to_json()) == variant
    # A field that is already off stays so; without both, the default accuracy applies.
    assert fine.replace({"solver.time_step": None}) == fine
    assert steps.replace({"solver.time_step": None}) == scenario
    both = {"solver.accuracy": None, "solver.time_step": 1e-3}
    assert scenario.replace(both) == steps.replace(both) == steps


def test_an_accuracy_and_a_time_step_at_once_are_refused() -> None:
    scenario = VARIANTS["belt-step"]
    both = [
        scenario.replace({"solver.time_step": 1e-3, "solver.accuracy": 1e-7}),
        scenario.replace({"solver.accuracy": 1e-7, "solver.time_step": 1e-3}),
        scenario.replace({"solver": c2d.Solver(accuracy=1e-7, time_step=1e-3)}),
        scenario.replace({"solver": dataclasses.replace(scenario.solver, time_step=1e-3)}),
    ]
    for variant in both:
        with pytest.raises(c2d.ScenarioError, match="together with accuracy") as caught:
            variant.validate()
        assert caught.value.path == "solver.time_step"


def test_a_path_reaches_into_lanes() -> None:
    scenario = VARIANTS["belt-lanes"].replace({"terrain.left.height": 0.1})
    assert scenario.to_json().count('"height":0.1') == 1


@pytest.mark.parametrize(
    ("name", "path", "value", "whole", "expected"),
    [
        ("belt-step", "robot.center_of_mass[0]", -0.05, "robot.center_of_mass", (-0.05, 0.02)),
        ("belt-step", "robot.center_of_mass[1]", 0, "robot.center_of_mass", (0.0, 0.0)),
        (
            "belt-points",
            "terrain.points[3]",
            np.array([4.0, 0.06]),
            "terrain.points",
            ((-3.0, 0.0), (0.0, 0.0), (0.0, 0.05), (4.0, 0.06)),
        ),
        (
            "belt-points",
            "terrain.points[2][1]",
            np.float32(0.5),
            "terrain.points",
            ((-3.0, 0.0), (0.0, 0.0), (0.0, 0.5), (3.0, 0.05)),
        ),
        ("flippers-climb", "drive.schedule[0][1]", 0.3, "drive.schedule", ((1.0, 0.3), (2.0, 0.4))),
        (
            "hybrid-gap",
            "robot.track.placements[1][2]",
            0.03,
            "robot.track.placements",
            ((-0.1875, 0.0, 0.0625), (0.0, -0.03125, 0.03), (0.1875, 0.0, 0.0625)),
        ),
        ("flippers-hold", "drive.gait.schedule[0][1]", 0.1, "drive.gait.schedule", ((0.5, 0.1),)),
    ],
)
def test_an_index_replaces_one_element_and_nothing_else(
    name: str, path: str, value: Any, whole: str, expected: Any
) -> None:
    scenario = VARIANTS[name]
    variant = scenario.replace({path: value})
    assert variant == scenario.replace({whole: expected})
    assert variant != scenario
    assert read_path(variant, whole) == expected


def test_every_number_of_every_scenario_has_a_path_that_replaces_it() -> None:
    def paths(node: Any, path: str = "") -> Any:
        if isinstance(node, dict):
            for key, value in node.items():
                if key != "kind":
                    yield from paths(value, f"{path}.{key}".removeprefix("."))
        elif isinstance(node, list):
            for index, value in enumerate(node):
                yield from paths(value, f"{path}[{index}]")
        elif type(node) in (int, float):
            yield path, node

    for scenario in VARIANTS.values():
        for path, number in paths(json.loads(scenario.to_json())):
            assert read_path(scenario, path) == number
            other = scenario.replace({path: number + 1})
            assert read_path(other, path) == number + 1
            assert other.replace({path: number}) == scenario


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
            "a known field, got 1.0: LineOfWheels has count, wheel_radius, wheel, as_track "
            "(did you mean count?)",
        ),
        ("Duration", "(did you mean duration?)"),
        ("terrain.height", "a known field, got 1.0: Flat has length, friction"),
        ("robot.track.kind", "a known field, got 1.0: LineOfWheels has"),
        ("robot.track.wheel.radius", "a known field, got 1.0: RoundWheel has no fields"),
        ("goal.x", "goal = 1.0 has no fields"),
        ("robot.flippers.length", "robot.flippers = None has no fields"),
        ("", "a known field, got 1.0: Scenario has"),
        ("robot..mass", "a known field, got 1.0: Robot has"),
        ("robot.center_of_mass[2]", "robot.center_of_mass has 2 elements, counted from 0"),
        ("robot.center_of_mass[-1]", "robot.center_of_mass has 2 elements, counted from 0"),
        ("robot.center_of_mass[00]", "a known field, got 1.0: Robot has"),
        ("robot.center_of_mass[x]", "(did you mean center_of_mass?)"),
        ("robot.center_of_mass[0", "(did you mean center_of_mass?)"),
        ("robot.center_of_mass.x", "robot.center_of_mass = (0.0, 0.02) has no fields"),
        ("robot.center_of_mass[0].x", "robot.center_of_mass[0] = 0.0 has no fields"),
        ("robot.center_of_mass[0][0]", "robot.center_of_mass[0] = 0.0 has no elements"),
        ("robot.belly[7][0]", "robot.belly has 4 elements, counted from 0"),
        ("robot.belly[3][2]", "robot.belly[3] has 2 elements, counted from 0"),
        ("robot.name[0]", "robot.name = 'engineer' has no elements"),
        ("drive.schedule[0]", "drive.schedule = None has no elements"),
        ("robot[0]", "robot = Robot("),
        ("[0]", "a known field, got 1.0: Scenario has"),
        (3, "path must be a string"),
    ],
)
def test_an_unknown_path_lists_the_fields_and_the_nearest(path: Any, message: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        VARIANTS["line-flat"].replace({path: 1.0})
    assert message in str(caught.value)
    assert caught.value.path == (path if isinstance(path, str) else "path")


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        ("terrain.points[3][1]", "high", "terrain.points[3][1] must be a number, got high"),
        ("terrain.points[3][1]", None, "terrain.points[3][1] must be a number, got None"),
        ("terrain.points[3]", (1.0, 2.0, 3.0), "terrain.points[3] must have shape (2,)"),
        ("terrain.points[3]", 1.0, "terrain.points[3] must have shape (2,)"),
        ("robot.center_of_mass[0]", True, "robot.center_of_mass[0] must be a number, got True"),
    ],
)
def test_an_element_of_another_kind_is_refused_by_its_path(
    path: str, value: Any, message: str
) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        VARIANTS["belt-points"].replace({path: value})
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize("fields", [5, None, "duration", [("duration", 2.0)]])
def test_anything_but_a_mapping_is_refused(fields: Any) -> None:
    with pytest.raises(c2d.ScenarioError, match="must be a mapping from paths to values"):
        VARIANTS["belt-step"].replace(fields)


def test_another_track_is_the_same_robot() -> None:
    other = ROBOT.with_track(c2d.LineOfWheels(3))
    assert other.track == c2d.LineOfWheels(3)
    assert other.with_track(ROBOT.track) == ROBOT


def test_a_wrong_type_is_refused_by_the_given_path() -> None:
    robot = with_flippers(c2d.BeltTrack(), c2d.LineOfWheels(3))
    lanes = c2d.terrains.lanes(c2d.terrains.step(0.05), c2d.terrains.flat())
    scenario = Scenario(robot, lanes)
    for path, value in (
        ("robot.flippers.track.count", "4"),
        ("robot.flippers.track", "belt"),
        ("terrain.left.height", "high"),
        ("duration", "long"),
        ("robot.outline.front_radius", "thick"),
    ):
        with pytest.raises(c2d.ScenarioError) as caught:
            scenario.replace({path: value})
        assert caught.value.path == path
