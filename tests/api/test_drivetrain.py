"""Rotors, torque curves and controllers as a user gives them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.track import Track
from tests.judges.judge import Judge
from tests.shared import refusal

ENGINEER = c2d.robots.engineer().without_flippers().without_rotors()


def driven(**fields: Any) -> c2d.Robot:
    """The Engineer with other motors."""
    return replace(ENGINEER, drivetrain=replace(ENGINEER.drivetrain, **fields))


@pytest.mark.parametrize(
    ("fields", "path"),
    [
        ({"rotor_inertia": -1.0}, "robot.drivetrain.rotor_inertia"),
        ({"rotor_inertia": 1e9}, "robot.drivetrain.rotor_inertia"),
        ({"no_load_speed": 0.0}, "robot.drivetrain.no_load_speed"),
        ({"torque_curve": ((0.1, 6.0),)}, "robot.drivetrain.torque_curve[0][0]"),
        ({"torque_curve": ((0.0, 5.0), (1.0, 0.0))}, "robot.drivetrain.torque_curve[0][1]"),
        ({"torque_curve": ((0.0, 6.0), (0.0, 0.0))}, "robot.drivetrain.torque_curve[1][0]"),
        ({"torque_curve": ((0.0, 6.0), (1.0, 7.0))}, "robot.drivetrain.torque_curve[1][1]"),
        ({"controller": c2d.PI(0.0)}, "robot.drivetrain.controller.gain"),
        ({"controller": c2d.PI(1.0, -1.0)}, "robot.drivetrain.controller.integral"),
        ({"controller": c2d.PI(1.0), "self_locking": True}, "robot.drivetrain.self_locking"),
    ],
)
def test_motors_that_none_can_be_are_refused_by_field(fields: dict[str, Any], path: str) -> None:
    assert refusal(driven(**fields)).path == path


def test_a_line_and_a_curve_exclude_each_other() -> None:
    robot = driven(no_load_speed=1.0, torque_curve=((0.0, 6.0), (1.0, 0.0)))
    assert refusal(robot).path == "robot.drivetrain.no_load_speed"


def test_texts_leave_out_what_motors_do_not_have() -> None:
    scenario = c2d.Scenario(ENGINEER, c2d.terrains.flat())
    assert "rotor_inertia" not in scenario.to_json()
    assert "controller" not in scenario.to_json()
    assert "self_locking" not in scenario.to_json()


def test_motors_come_back_from_json() -> None:
    curve = ((0.0, 6.0), (0.5, 4.0), (1.0, 0.0))
    robot = driven(rotor_inertia=0.03, torque_curve=curve, controller=c2d.PI(1.0, 2.0))
    scenario = c2d.Scenario(robot, c2d.terrains.flat())
    assert c2d.Scenario.from_json(scenario.to_json()) == scenario


def test_a_snapshot_keeps_what_a_controller_has_summed_up() -> None:
    robot = driven(rotor_inertia=0.03, no_load_speed=0.6, controller=c2d.PI(0.5, 5.0))
    simulation = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.ramp(0.2)))
    simulation.advance(2.0)
    other = c2d.Simulation.from_snapshot(simulation.snapshot())
    for each in (simulation, other):
        each.advance(1.0)
    assert np.array_equal(simulation.state().position, other.state().position)
    assert simulation.state().track_speed == other.state().track_speed


def test_another_engine_refuses_motors_that_it_does_not_have() -> None:
    solver = c2d.Solver(engine="rapier", accuracy=None, time_step=1e-3)
    robot = driven(rotor_inertia=0.03).with_track(c2d.LineOfWheels(3))
    assert refusal(robot, solver=solver).path == "robot.drivetrain.rotor_inertia"
    robot = driven(self_locking=True).with_track(c2d.LineOfWheels(3))
    assert refusal(robot, solver=solver).path == "robot.drivetrain.self_locking"


def test_a_lock_is_refused_where_it_has_nothing_to_do_and_says_why() -> None:
    with_controller = refusal(driven(self_locking=True, controller=c2d.PI(1.0)))
    assert "with a controller, got true: the load never reaches the motor" in str(with_controller)
    on_a_force = refusal(driven(self_locking=True).with_track(c2d.ForceTrack()))
    assert on_a_force.path == "robot.drivetrain.self_locking"
    with pytest.raises(c2d.errors.ScenarioError, match="must be True or False"):
        driven(self_locking=1.0)


def test_locks_of_tracks_and_arms_come_back_from_json() -> None:
    robot = c2d.robots.engineer()
    assert robot.flippers is not None
    locked = replace(
        robot,
        drivetrain=replace(robot.drivetrain, self_locking=True),
        flippers=replace(robot.flippers, self_locking=True),
    )
    scenario = c2d.Scenario(locked, c2d.terrains.flat())
    assert scenario.to_json().count('"self_locking"') == 2
    assert c2d.Scenario.from_json(scenario.to_json()) == scenario


def on_a_slope(robot: c2d.Robot, duration: float) -> c2d.Scenario:
    """A slope that rises by a quarter, on which the robot begins."""
    ground = c2d.terrains.from_points([(-20.0, -5.0), (20.0, 5.0)], goal=3.0)
    return c2d.Scenario(robot, ground, start=c2d.Start(angle=0.245), duration=duration)


def test_a_sweep_varies_a_lock() -> None:
    slope = on_a_slope(driven(max_torque=0.0), duration=1.0)
    table = c2d.sweep(
        slope,
        {"robot.drivetrain.self_locking": [False, True]},
        repeats=1,
        vary={},
        progress=False,
    )
    rolled, held = table["final_x"].squeeze().values
    assert held - rolled > 0.5


@pytest.mark.parametrize("torque", [0.0, 0.4])
@pytest.mark.parametrize("track", [c2d.BeltTrack(), c2d.LineOfWheels(3, wheel=c2d.GearWheel())])
def test_a_stop_that_only_a_lock_bears_is_an_equilibrium_to_both_judges(
    track: Track, torque: float
) -> None:
    robot = driven(max_torque=torque, self_locking=True).with_track(track)
    run = c2d.simulate(on_a_slope(robot, duration=15.0))
    assert run.outcome == c2d.Outcome.STALLED
    assert run.diagnosis is not None
    assert run.diagnosis.imbalance is not None
    # Within its torque alone a motor would leave a tenth of the weight or more.
    assert run.diagnosis.imbalance < 1e-6
    assert Judge(run).opinion().imbalance < 1e-6
    assert Judge(run).opinion().symptom == "stalled"
