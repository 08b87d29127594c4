"""Rotors, torque curves and controllers, as specified by users."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.track import Track
from tests.judges.judge import Judge
from tests.shared import refusal

ENGINEER = c2d.robots.engineer().without_flippers().without_rotors()
RADIUS = 0.052  # [m] Of its sprockets.


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
def test_impossible_motors_are_refused_by_field(fields: dict[str, Any], path: str) -> None:
    assert refusal(driven(**fields)).path == path


def test_a_line_and_a_curve_exclude_each_other() -> None:
    robot = driven(no_load_speed=1.0, torque_curve=((0.0, 6.0), (1.0, 0.0)))
    assert refusal(robot).path == "robot.drivetrain.no_load_speed"


CURVED = c2d.Scenario(driven(torque_curve=((0.0, 6.0), (2.0, 0.0))), c2d.terrains.step(0.05))
"""With a curve that is the line of `FALLING`."""
FALLING = c2d.Scenario(driven(no_load_speed=2.0), c2d.terrains.step(0.05))


def test_a_torque_that_is_replaced_scales_its_curve() -> None:
    torque, curve = "robot.drivetrain.max_torque", "robot.drivetrain.torque_curve"
    assert CURVED.replace({torque: 6.0}) == CURVED
    doubled = CURVED.replace({torque: 12.0}).robot.drivetrain
    assert doubled.torque_curve == ((0.0, 12.0), (2.0, 0.0))
    given = ((0.0, 9.0), (1.0, 3.0))
    for fields in ({torque: 9.0, curve: given}, {curve: given, torque: 9.0}):
        assert CURVED.replace(fields).robot.drivetrain.torque_curve == given
    robot = driven(max_torque=8.0, torque_curve=((0.0, 8.0), (1.0, 4.0)))
    other = CURVED.replace({"robot": robot, torque: 4.0}).robot.drivetrain
    assert other.torque_curve == ((0.0, 4.0), (1.0, 2.0))


@pytest.mark.parametrize("drawn", [c2d.scaled(0.2, 1.0), c2d.uniform(1.5, 6.0)])
def test_a_torque_that_is_drawn_scales_its_curve(drawn: Any) -> None:
    def work(base: c2d.Scenario, **how: Any) -> np.ndarray:
        how = {"samples": 2, "repeats": 2, "progress": False, **how}
        values: np.ndarray = c2d.sweep(base, {}, **how)["drive_work"].to_numpy()
        return values

    vary = {"robot.drivetrain.max_torque": drawn}
    assert work(CURVED, vary=vary) == pytest.approx(work(FALLING, vary=vary), rel=1e-6)
    assert work(CURVED, unknown=vary) == pytest.approx(work(FALLING, unknown=vary), rel=1e-6)


def test_a_line_that_is_drawn_takes_the_place_of_a_curve() -> None:
    vary: dict[str, Any] = {
        "robot.drivetrain.max_torque": c2d.scaled(0.5, 1.0),
        "robot.drivetrain.no_load_speed": c2d.uniform(1.0, 2.0),
    }
    of_curve, of_line = (
        c2d.sweep(base, {}, vary=vary, repeats=2, progress=False)["identity"].values
        for base in (CURVED, FALLING)
    )
    assert (of_curve == of_line).all()


def test_the_limit_of_a_motor_with_a_torque_curve_is_found() -> None:
    found = []
    for base in (CURVED, FALLING):
        slope = base.replace({"terrain": c2d.terrains.ramp(0.5)})
        table = c2d.studies.max_speed(slope, repeats=1, vary={}, progress=False)
        found.append((table["speed_with"].values, table["limit"].item()))
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-6)
    assert found[0][1] == found[1][1] == "torque"


@pytest.mark.parametrize("end", [0.3001, 0.31])
@pytest.mark.parametrize("acceleration", [2.0, 1e4])
def test_a_motor_does_not_drive_beyond_the_end_of_its_curve(
    end: float, acceleration: float
) -> None:
    curve = ((0.0, 6.0), (0.3, 6.0), (end, 0.0))
    robot = driven(torque_curve=curve, max_acceleration=acceleration)
    run = c2d.simulate(
        c2d.Scenario(robot, c2d.terrains.flat(), drive=c2d.Drive(speed=1.2), duration=1.0)
    )
    # After the shortest step, of 20 us, under the force of a motor at rest.
    force = 2.0 * 6.0 / RADIUS
    assert run.track_speed.max() < end + 20e-6 * force / robot.mass + 5e-4
    assert run.track_speed[-1] > 0.3


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


def test_a_lock_without_a_use_is_refused_with_the_reason() -> None:
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
    # With only its own torque, a motor would leave a tenth of the weight or more.
    assert run.diagnosis.imbalance < 1e-6
    assert Judge(run).opinion().imbalance < 1e-6
    assert Judge(run).opinion().symptom == "stalled"
