"""Scenes at the limits of legal values, found by random draws."""

import dataclasses
import math
import time

import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.shared import ROBOT, refusal

# Overlaps are then due to shapes: in the long steps that the default accuracy allows, corners
# penetrate by 20 um, and by 0.1 mm if the engine finds the contacts.
OF_1_MS = c2d.Solver(time_step=1e-3)


@pytest.mark.parametrize("mechanism", ["guide", "sprocket"])
@pytest.mark.parametrize("shoe_count", [None, 60, 100])
@pytest.mark.parametrize("ends", [(0.4, 0.064), (0.064, 0.4)], ids=["front", "rear"])
def test_a_chain_round_ends_with_no_run_between_them_is_refused_by_its_count(
    mechanism: str, shoe_count: int | None, ends: tuple[float, float]
) -> None:
    front, rear = ends
    outline = dataclasses.replace(
        ROBOT.outline, axle_distance=0.34, front_radius=front, rear_radius=rear
    )
    track = c2d.SegmentalTrack(mechanism=mechanism, shoe_count=shoe_count)  # type: ignore[arg-type]
    robot = dataclasses.replace(
        ROBOT, outline=outline, moment_of_inertia=2.0, track_mass=8.0, track=track
    )
    begin = time.process_time()
    error = refusal(robot)
    assert error.path == "robot.track.shoe_count"
    assert "straight run" in error.rule
    assert time.process_time() - begin < 1.0  # Ctrl-C waits for so long


def with_grousers(height: float, thickness: float, contact: str) -> c2d.Run:
    wheel = c2d.GearWheel(grouser_count=9, grouser_height=height, tip_thickness=thickness)
    robot = ROBOT.with_track(c2d.LineOfWheels(3, wheel=wheel))
    scenario = Scenario(robot, c2d.terrains.step(0.02), duration=0.5, solver=OF_1_MS)
    return c2d.simulate(scenario.replace({"solver.contact": contact}), record="summary")


@pytest.mark.parametrize("height", [1e-20, 1e-9, 1e-4, 5e-3])
@pytest.mark.parametrize("thickness", [1e-300, 1e-17, 1e-9])
def test_grousers_thinner_than_any_are_met_as_thin_ones_are(
    height: float, thickness: float
) -> None:
    none, thin = (with_grousers(height, t, "own").metrics for t in (thickness, 1e-6))
    for name in ("final_x", "final_y", "final_angle"):
        assert none[name] == pytest.approx(thin[name], abs=1e-6)


@pytest.mark.parametrize("height", [1e-20, 1e-9, 1e-4, 5e-3])
@pytest.mark.parametrize("thickness", [1e-300, 1e-17, 1e-9, 1e-3])
def test_grousers_however_flat_and_thin_have_pieces_for_the_engine(
    height: float, thickness: float
) -> None:
    metrics = with_grousers(height, thickness, "reference").metrics
    assert metrics["max_penetration"] < 1e-5


@pytest.mark.parametrize("radius", [0.03, 0.06])
@pytest.mark.parametrize("tip", [1e-5, 1e-3])
@pytest.mark.parametrize("height", [1e-4, 1e-3])
def test_grousers_whose_flanks_would_end_inside_the_root_circle_are_refused(
    radius: float, tip: float, height: float
) -> None:
    def scenario(base: float) -> Scenario:
        wheel = c2d.GearWheel(
            grouser_count=9, grouser_height=height, tip_thickness=tip, base_thickness=base
        )
        track = c2d.LineOfWheels(3, wheel_radius=radius, wheel=wheel)
        robot = dataclasses.replace(ROBOT, belly=None, track=track)
        return Scenario(robot, c2d.terrains.step(0.005), duration=0.5, solver=OF_1_MS)

    # The flank of the widest one touches the root circle: a right angle at its foot.
    root = radius - height
    half = math.asin(0.5 * tip / radius) + math.acos(root / radius)
    widest = 2.0 * root * math.sin(half)
    with pytest.raises(c2d.ScenarioError, match="inside the root circle") as caught:
        scenario(1.001 * widest).validate()
    assert caught.value.path == "robot.track.wheel.base_thickness"
    run = c2d.simulate(scenario(0.999 * widest), record="summary")
    assert run.metrics["max_penetration"] < 1e-5
