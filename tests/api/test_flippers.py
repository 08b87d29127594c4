"""Flippers and gaits, as commanded by users."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.shared import refusal

ENGINEER = c2d.robots.engineer()
ARMS: Any = ENGINEER.flippers


def on_flat(robot: c2d.Robot, **drive: Any) -> c2d.Run:
    """Drive for three seconds on level ground."""
    return c2d.simulate(
        Scenario(robot, c2d.terrains.flat(), drive=c2d.Drive(**drive), duration=3.0)
    )


def test_flippers_turn_at_their_rate_and_stay() -> None:
    """30 N m take 0.04 s to bring a rotor of 1.2 kg m^2 to 1 rad/s; the arm itself is light."""
    run = on_flat(ENGINEER, gait=c2d.Hold(0.8, ((1.0, 0.2),)))
    angle = run.flipper_angles[:, 0]
    assert angle[run.time < 1.0] == pytest.approx(0.8)
    turning = (run.time > 1.05) & (run.time < 1.59)
    assert np.diff(angle[turning]) == pytest.approx(-0.01 * ARMS.rate_limit, rel=1e-6)
    assert angle[run.time > 1.7] == pytest.approx(0.2)


def test_without_a_gait_flippers_stay_where_they_start() -> None:
    run = on_flat(ENGINEER)
    assert run.flipper_angles.shape == (run.time.size, 1)
    assert run.flipper_angles == pytest.approx(ARMS.angle)
    assert on_flat(c2d.robots.engineer(flippers=None)).flipper_angles.shape == (301, 0)


def test_a_schedule_of_speeds_is_followed() -> None:
    drivetrain = replace(ENGINEER.drivetrain, max_acceleration=5.0)
    run = on_flat(
        replace(ENGINEER, drivetrain=drivetrain), speed=0.3, schedule=((1.0, -0.3), (2.0, 0.0))
    )
    speed = {time: run.track_speed[np.abs(run.time - time).argmin()] for time in (0.9, 1.9, 2.9)}
    assert speed == pytest.approx({0.9: 0.3, 1.9: -0.3, 2.9: 0.0}, abs=1e-6)


def test_a_run_whose_schedule_starts_later_does_not_end_early() -> None:
    drive = c2d.Drive(speed=0.0, schedule=((8.0, 0.4),))
    scenario = Scenario(ENGINEER, c2d.terrains.flat(length=0.2), drive=drive, duration=15.0)
    assert c2d.simulate(scenario).outcome == "cleared"


def test_commands_override_the_gait_of_the_flippers() -> None:
    robot = c2d.robots.absolem()
    drive = c2d.Drive(speed=0.0, gait=c2d.Climb())
    sim = c2d.Simulation(Scenario(robot, c2d.terrains.flat(), drive=drive))
    sim.command(rear_flipper_angle=1.2)
    sim.advance(2.0)
    assert sim.state().flipper_angles == pytest.approx([0.8, 1.2])
    with pytest.raises(c2d.ScenarioError, match="flipper_angle"):
        sim.command(flipper_angle=np.nan, speed=0.1, rear_flipper_angle=0.1)
    sim.advance(1.0)  # a refused command has no effect
    assert sim.state().flipper_angles == pytest.approx([0.8, 1.2])
    front = c2d.Simulation(Scenario(ENGINEER, c2d.terrains.flat()))
    with pytest.raises(c2d.ScenarioError, match="no flippers there"):
        front.command(rear_flipper_angle=0.1)


@pytest.mark.parametrize(
    "track",
    [
        c2d.BeltTrack(),
        c2d.GrouserBeltTrack(),
        c2d.LineOfWheels(3),
        c2d.LineOfWheels(3, wheel=c2d.GearWheel()),
        c2d.CircumferentialWheels(24),
        c2d.SegmentalTrack(),
        c2d.SegmentalTrack(mechanism="sprocket"),
        c2d.ForceTrack(),
        c2d.ForceTrack(support="wheels"),
    ],
    ids=lambda track: track.kind,
)
def test_every_model_stands_on_its_flippers(track: Any) -> None:
    robot = replace(ENGINEER.with_track(track), flippers=replace(ARMS, ends="both", angle=-0.4))
    run = on_flat(robot, speed=0.0)
    assert run.position[-1, 1] > 0.064 + 0.05  # sin 0.4 of 0.34 m, less the taper
    weight = robot.mass * 9.81
    last = run.contacts["time"] > 2.0
    lift = run.contacts["normal_force"] * run.contacts["normal_y"]
    lift = lift + run.contacts["friction_force"] * -run.contacts["normal_x"]
    samples = np.unique(run.contacts["time"][last]).size
    assert lift[last].sum() / samples == pytest.approx(weight, rel=5e-3)


@pytest.mark.parametrize(("ends", "angle"), [("front", -2.9), ("rear", -2.9), ("rear", 3.1)])
@pytest.mark.parametrize(
    "track", [c2d.BeltTrack(), c2d.GrouserBeltTrack()], ids=["belt", "grousers"]
)
def test_a_robot_whose_arms_are_folded_back_starts_on_the_ground(
    track: Any, ends: Any, angle: float
) -> None:
    robot = replace(ENGINEER.with_track(track), flippers=replace(ARMS, ends=ends, angle=angle))
    for place in np.arange(-0.6, -0.05, 0.06):
        spike = [(-6.0, 0.0), (place - 0.02, 0.0), (place, 0.1), (place + 0.02, 0.0)]
        ground = c2d.terrains.from_points([*spike, (0.3, 0.0), (0.3, 0.01), (3.0, 0.01)], goal=2.0)
        start = c2d.Start(approach=0.3)  # from the edge at 0.3 m
        sim = c2d.Simulation(Scenario(robot, ground, drive=c2d.Drive(speed=0.0), start=start))
        sim.advance(2e-5)
        assert sim.state().contacts["penetration"].max() < 1e-6


def test_same_bits_in_a_batch_and_from_a_snapshot() -> None:
    robot = c2d.robots.absolem(track=c2d.LineOfWheels(5, wheel=c2d.GearWheel()))
    scenario = Scenario(
        robot, c2d.terrains.step(0.2), drive=c2d.Drive(gait=c2d.Climb()), duration=4.0
    )
    alone = c2d.simulate(scenario)
    batch = c2d.simulate_many([scenario, scenario], threads=2, progress=False)
    for run in batch:
        assert run.flipper_angles.tobytes() == alone.flipper_angles.tobytes()
        assert run.position.tobytes() == alone.position.tobytes()


def test_shoes_and_arms_that_leave_the_chassis_no_inertia_are_refused() -> None:
    """Together they may have more than the robot, for which a step never ended."""
    robot = c2d.robots.engineer(flippers=None, track=c2d.SegmentalTrack(shoe_count=44))
    arms = replace(ARMS, ends="both")
    with pytest.raises(c2d.ScenarioError, match=r"robot\.moment_of_inertia must exceed"):
        c2d.Scenario(replace(robot, flippers=arms), c2d.terrains.step(0.1)).validate()


def test_stops_with_flippers_are_certified_and_a_belt_is_never_seized() -> None:
    heights = (0.06, 0.10, 0.14, 0.18)
    # With more friction belts clear, or tip over.
    models: dict[Any, float] = {
        c2d.LineOfWheels(3): 0.9,
        c2d.CircumferentialWheels(24): 0.9,
        c2d.BeltTrack(): 0.4,
    }
    for make in (c2d.robots.engineer, c2d.robots.absolem):
        scenarios = [
            Scenario(
                make(track=model),
                c2d.terrains.step(height, friction=friction),
                drive=c2d.Drive(gait=gait),
            )
            for model, friction in models.items()
            for height in heights
            for gait in (None, c2d.Climb())
        ]
        runs = c2d.simulate_many(scenarios, record="summary", progress=False)
        stops = [run for run in runs if run.diagnosis is not None]
        of_belts = [run for run in stops if run.scenario.robot.track == c2d.BeltTrack()]
        assert min(len(of_belts), len(stops) - len(of_belts)) >= 2
        for run in stops:
            assert run.diagnosis is not None
            assert run.diagnosis.certified, run.scenario.to_json()
        assert "seized" not in [run.outcome for run in of_belts]


def test_ground_between_wheels_of_a_flipper_is_a_pocket() -> None:
    """A low step caught between the wheels of an arm that lies level, far from the main track."""
    arms = replace(ARMS, angle=0.0, track=c2d.LineOfWheels(2))
    robot = c2d.robots.engineer(flippers=arms, track=c2d.BeltTrack())
    run = c2d.simulate(robot, c2d.terrains.step(0.05), drive=c2d.Drive(speed=0.1))
    inside = run.events["kind"] == "intrusion"
    assert inside.any()
    bodies = {body for row in np.flatnonzero(inside) for body in run.events["bodies"][row]}
    assert bodies <= {1, 2}  # the belt is body 0


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"length": 0.02}, "robot.flippers.tip_radius"),
        ({"tip_radius": 0.011}, "robot.flippers.tip_radius"),
        ({"mass": 9.9}, "robot.flippers.mass"),
        ({"torque_limit": -1.0}, "robot.flippers.torque_limit"),
        ({"rate_limit": 0.0}, "robot.flippers.rate_limit"),
        ({"angle": np.inf}, "robot.flippers.angle"),
        ({"ends": "left"}, "robot.flippers.ends"),
        ({"mass": 0.0}, "robot.flippers.mass"),
        ({"rate_limit": 101.0}, "robot.flippers.rate_limit"),
        ({"torque_limit": np.nan}, "robot.flippers.torque_limit"),
        ({"track": "belt"}, "robot.flippers.track"),
        ({"track": c2d.LineOfWheels(1)}, "robot.flippers.track.count"),
        (
            {"track": c2d.CircumferentialWheels(12, wheel_radius=0.05)},
            "robot.flippers.track.wheel_radius",
        ),
        ({"track": c2d.SegmentalTrack()}, "robot.flippers.track"),
        ({"track": c2d.ForceTrack()}, "robot.flippers.track"),
        ({"track": c2d.CircumferentialWheels(5)}, "robot.flippers.track.count"),
    ],
)
def test_bad_flippers_are_refused_by_path(changes: dict[str, Any], path: str) -> None:
    error = refusal(lambda: replace(ENGINEER, flippers=replace(ARMS, **changes)))
    assert error.path == path


@pytest.mark.parametrize(
    ("gait", "path"),
    [
        (c2d.Hold(np.nan), "drive.gait.angle"),
        (c2d.Hold(9.0), "drive.gait.angle"),
        (c2d.Hold(0.0, ((2.0, 0.1), (1.0, 0.2))), "drive.gait.schedule[1][0]"),
        (c2d.Hold(0.0, ((1.0, 9.0),)), "drive.gait.schedule[0][1]"),
        (c2d.Climb(level_angle=0.0), "drive.gait.level_angle"),
    ],
)
def test_a_bad_gait_is_refused_by_path(gait: Any, path: str) -> None:
    assert refusal(ENGINEER, drive=c2d.Drive(gait=gait)).path == path


def test_anything_but_a_gait_is_refused_at_once() -> None:
    for make, path in (
        (lambda: c2d.Climb(reach_angle="up"), "drive.gait.reach_angle"),  # type: ignore[arg-type]
        (lambda: c2d.Drive(gait="climb"), "drive.gait"),  # type: ignore[arg-type]
    ):
        with pytest.raises(c2d.ScenarioError) as caught:
            make()
        assert caught.value.path == path


def test_arms_that_turn_too_far_in_a_step_are_refused_not_slowed() -> None:
    fast = replace(ENGINEER, flippers=replace(ARMS, rate_limit=100.0))
    error = refusal(fast, solver=c2d.Solver(time_step=8e-3))
    assert error.path == "solver.time_step"
    assert "no wheel or flipper turns by more than 0.7 rad (here 0.800 rad)" in error.rule
    # With an accuracy, steps are as short as needed.
    c2d.Scenario(fast, c2d.terrains.flat()).validate()


def test_a_sweep_may_leave_the_flippers_off_and_keep_the_gait() -> None:
    drive = c2d.Drive(gait=c2d.Climb())
    base = Scenario(ENGINEER, c2d.terrains.step(0.05), drive=drive, duration=3.0)
    bare = c2d.robots.engineer(flippers=None)
    over = {"robot": {"arms": ENGINEER, "none": bare}}
    table = c2d.sweep(base, over, repeats=1, vary={}, progress=False)
    alone = c2d.simulate(Scenario(bare, c2d.terrains.step(0.05), duration=3.0))
    found = table["final_x"].sel(robot="none").item()
    assert found == alone.metrics["final_x"]


def test_bad_commands_are_refused_by_path() -> None:
    late = c2d.Drive(schedule=((2.0, 0.1), (1.0, 0.2)))
    assert refusal(ENGINEER, drive=late).path == "drive.schedule[1][0]"
    fast = c2d.Drive(schedule=((2.0, 5.0),))
    assert refusal(ENGINEER, drive=fast).path == "drive.schedule[0][1]"
    wheels = c2d.HybridWheels(((0.0, 0.0, 0.05),))
    assert refusal(ENGINEER.with_track(wheels)).path == "robot.flippers.track"
    with pytest.raises(c2d.ScenarioError, match="built"):
        c2d.robots.engineer(flippers="none")  # type: ignore[arg-type]
