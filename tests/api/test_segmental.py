"""A chain of shoes in Python: shapes, values, errors, variants."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.shared import refusal

ENGINEER = c2d.robots.engineer(flippers=None)


def chain(**options: object) -> c2d.Robot:
    return ENGINEER.with_track(c2d.SegmentalTrack(**options))  # type: ignore[arg-type]


SOON = {("guide", "rectangle", 22), ("guide", "trapezoid", 44), ("sprocket", "trapezoid", 22)}
"""Each mechanism, shape and end of the numbers, of all that the soak tries."""


@pytest.mark.parametrize(
    ("mechanism", "shape", "count"),
    [
        pytest.param(*each, marks=() if each in SOON else pytest.mark.soak)
        for each in itertools.product(
            ("guide", "sprocket"), ("rectangle", "trapezoid"), (22, 36, 44)
        )
    ],
)
def test_shoes_stay_linked_and_the_robot_as_high_as_built(
    mechanism: str, shape: str, count: int
) -> None:
    robot = chain(shoe_count=count, shoe_shape=shape, mechanism=mechanism)
    run = c2d.simulate(Scenario(robot, c2d.terrains.flat(), duration=4.0))
    assert run.shoe_poses.shape == (run.time.size, count, 3)
    pitch = _pitch(run)
    middle, angle = run.shoe_poses[:, :, :2], run.shoe_poses[:, :, 2]
    along = 0.5 * pitch * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    gaps = np.linalg.norm(np.roll(middle - along, -1, axis=1) - (middle + along), axis=-1)
    assert gaps.max() < 1e-4
    assert run.metrics["max_pin_gap"] < 1e-4
    settled = run.time > 3.0  # chassis and guide settle
    # On a guide, the polygon of 22 shoes lifts the robot by up to 1.1 mm.
    within = 1.2e-3 if (mechanism, count) == ("guide", 22) else 1e-3
    assert run.position[settled, 1] == pytest.approx(0.064, abs=within)


def _pitch(run: c2d.Run) -> float:
    """[m] Distance of the pins, with which the first chain closes best."""
    middle, angle = run.shoe_poses[0, :, :2], run.shoe_poses[0, :, 2]
    along = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    between = np.roll(middle, -1, axis=0) - middle
    halves = 0.5 * (along + np.roll(along, -1, axis=0))
    return float(np.sum(between * halves) / np.sum(halves * halves))


@pytest.mark.parametrize("mechanism", ["guide", "sprocket"])
def test_ground_speed_is_the_belts(mechanism: str) -> None:
    run = c2d.simulate(Scenario(chain(mechanism=mechanism), c2d.terrains.flat(), duration=5.0))
    steady = run.time > 2.0
    ground = np.ptp(run.position[steady, 0]) / np.ptp(run.time[steady])
    belt = np.ptp(run.track_position[steady]) / np.ptp(run.time[steady])
    assert belt == pytest.approx(0.4, rel=0.005)
    assert ground == pytest.approx(0.4, rel=0.01)


def test_a_tighter_chain_has_more_tension() -> None:
    def tension(newtons: float) -> float:
        robot = chain(shoe_count=44, pre_tension=newtons)
        run = c2d.simulate(Scenario(robot, smooth, drive=c2d.Drive(speed=0.0), duration=2.0))
        return float(run.track_tension[-1])

    # Both tracks are lumped, and each has two runs: the force of one tensioner is in their pins.
    # Shoes that stick keep some of the initial tension, even on smooth ground.
    smooth = c2d.terrains.flat(friction=0.05)
    assert tension(100.0) - tension(50.0) == pytest.approx(50.0, rel=0.15)


@pytest.mark.parametrize("mechanism", ["guide", "sprocket"])
def test_forces_of_the_ground_bear_the_weight(mechanism: str) -> None:
    robot = chain(mechanism=mechanism)
    run = c2d.simulate(Scenario(robot, c2d.terrains.flat(), duration=6.0))
    contacts = run.contacts
    upwards = contacts["normal_force"] * contacts["normal_y"]
    upwards = upwards - contacts["friction_force"] * contacts["normal_x"]
    settled = contacts["time"] > 2.0
    samples = np.count_nonzero(run.time > 2.0)
    weight = robot.mass * 9.81
    assert upwards[settled].sum() / samples == pytest.approx(weight, rel=2e-3)


@pytest.mark.parametrize("mechanism", ["guide", "sprocket"])
def test_the_same_bits_again_and_from_a_snapshot(mechanism: str) -> None:
    scenario = Scenario(chain(mechanism=mechanism), c2d.terrains.step(0.05), duration=1.6)
    first, again = (c2d.simulate(scenario) for _ in range(2))
    assert first.shoe_poses.tobytes() == again.shoe_poses.tobytes()
    half = c2d.Simulation(scenario)
    half.advance(1.0)
    copy = c2d.Simulation.from_snapshot(half.snapshot())
    half.advance(0.5)
    copy.advance(0.5)
    assert half.snapshot() == copy.snapshot()


@pytest.mark.parametrize(
    ("options", "path", "rule"),
    [
        ({"shoe_count": 2}, "robot.track.shoe_count", "from 3 to 400"),
        ({"shoe_count": 0}, "robot.track.shoe_count", "from 3 to 400"),
        ({"shoe_count": 1}, "robot.track.shoe_count", "from 3 to 400"),
        ({"shoe_count": 10_000}, "robot.track.shoe_count", "from 3 to 400"),
        ({"shoe_count": 5}, "robot.track.shoe_count", "must be from 12 to 400 here"),
        ({"shoe_count": 11}, "robot.track.shoe_count", "not be longer than the diameter"),
        ({"mechanism": "Sproket"}, "robot.track.mechanism", "did you mean sprocket?"),
        ({"shoe_shape": "trapez"}, "robot.track.shoe_shape", "did you mean trapezoid?"),
        ({"shoe_count": 22.5}, "robot.track.shoe_count", "integer"),
        ({"shoe_shape": "round"}, "robot.track.shoe_shape", "rectangle"),
        ({"plate_thickness": 0.06}, "robot.track.plate_thickness", "leave room for a guide"),
        ({"plate_thickness": -1.0}, "robot.track.plate_thickness", "m"),
        ({"pre_tension": 0.0}, "robot.track.pre_tension", "N"),
        ({"pre_tension": float("nan")}, "robot.track.pre_tension", "N"),
        ({"mechanism": "friction"}, "robot.track.mechanism", "guide, sprocket"),
        ({"tensioner_stiffness": 0.0}, "robot.track.tensioner_stiffness", "N/m"),
        ({"tensioner_damping": -1.0}, "robot.track.tensioner_damping", "N s/m"),
        ({"pin_damping": -1.0}, "robot.track.pin_damping", "N m s/rad"),
        ({"pin_stiffness": 1e23}, "robot.track.pin_stiffness", "N m/rad"),
        ({"road_wheel_count": 5}, "robot.track.road_wheel_count", "a guide, which has no wheels"),
        (
            {"return_roller_count": 0},
            "robot.track.return_roller_count",
            "a guide, which has no wheels",
        ),
        (
            {"mechanism": "sprocket", "road_wheel_count": 201},
            "robot.track.road_wheel_count",
            "from 0 to 200",
        ),
    ],
)
def test_bad_fields_are_refused_by_name(options: dict[str, object], path: str, rule: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.simulate(Scenario(chain(**options), c2d.terrains.flat(), duration=0.1))
    assert path in str(caught.value)
    assert rule in str(caught.value)


def test_the_fewest_shoes_that_are_allowed_run() -> None:
    run = c2d.simulate(Scenario(chain(shoe_count=12), c2d.terrains.flat(), duration=4.0))
    assert run.metrics["max_pin_gap"] < 1e-4
    assert run.metrics["distance"] > 0.5


def test_ends_too_small_for_any_shoe_say_so() -> None:
    outline = replace(ENGINEER.outline, axle_distance=3.0, front_radius=0.013, grouser_height=0.012)
    error = refusal(replace(chain(plate_thickness=1e-4), outline=outline, belly=None))
    assert error.path == "robot.track.shoe_count"
    assert "more than 400" in error.rule


def test_a_shoe_may_weigh_a_three_thousandth_of_the_rest() -> None:
    """Beyond this, pins open by millimetres; up to it they hold like those of heavier shoes."""
    light = replace(chain(), track_mass=0.16)
    run = c2d.simulate(Scenario(light, c2d.terrains.step(0.06), duration=8.0))
    assert run.outcome == "cleared"
    assert run.metrics["max_pin_gap"] < 2e-4
    error = refusal(replace(light, track_mass=0.15))
    assert error.path == "robot.track_mass"
    assert "at least 0.1543 kg for 22 shoes" in error.rule


def test_shoes_must_leave_the_chassis_a_moment_of_inertia() -> None:
    error = refusal(replace(chain(), moment_of_inertia=0.03))
    assert error.path == "robot.moment_of_inertia"
    assert error.value == "0.03"


def test_the_closed_belt_of_a_stop_weighs_as_much() -> None:
    scenario = Scenario(chain(), c2d.terrains.step(0.16), duration=6.0)
    weak = scenario.replace({"robot.drivetrain.max_torque": 2.0})
    run = c2d.simulate(weak, trials=["closed track"])
    assert run.diagnosis is not None
    assert "closed track" in [tried.name for tried in run.diagnosis.trials]


def test_only_a_sprocket_slips() -> None:
    def slip(robot: c2d.Robot) -> float:
        run = c2d.simulate(Scenario(robot, c2d.terrains.flat(), duration=4.0))
        return run.metrics["max_sprocket_slip"]

    assert slip(chain()) == 0.0
    # The play of the teeth is 4 % of the pitch of 48.7 mm, and the polygon makes as much.
    assert 0.0 < slip(chain(mechanism="sprocket")) < 4e-3


def test_a_sprocket_on_two_lanes_turns_each_chain() -> None:
    lanes = c2d.terrains.lanes(c2d.terrains.step(0.05), c2d.terrains.step(0.03))
    run = c2d.simulate(Scenario(chain(mechanism="sprocket"), lanes, duration=5.0))
    assert run.shoe_poses.shape[1] == 44
    assert run.metrics["max_pin_gap"] < 6e-4
    assert run.outcome == c2d.Outcome.CLEARED


def test_a_belt_takes_over_from_a_chain_and_back() -> None:
    scenario = Scenario(chain(), c2d.terrains.step(0.05), duration=4.0)
    run = c2d.simulate(scenario)
    belt = run.branch(at=1.0, track=c2d.BeltTrack())
    assert belt.outcome == c2d.Outcome.CLEARED
    back = c2d.simulate(scenario.replace({"robot.track": c2d.BeltTrack()})).branch(
        at=1.0, track=c2d.SegmentalTrack()
    )
    assert back.metrics["max_pin_gap"] < 2e-3
