"""A valid scenario that is probably a mistake is simulated, and a warning names the field."""

import math
import pickle
import warnings
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.parameters.track import Track
from tests.shared import ROBOT, VARIANTS, with_flippers

ARMED = c2d.robots.engineer(track=c2d.BeltTrack())
STEP = c2d.terrains.step(0.05)
HIGH = Scenario(ROBOT, c2d.terrains.step(75.0), duration=0.05)


def line(radius: float) -> c2d.LineOfWheels:
    return c2d.LineOfWheels(3, wheel_radius=radius)


def placed(x: float, y: float, radius: float) -> c2d.HybridWheels:
    return c2d.HybridWheels(((0.0, 0.0, 0.06), (x, y, radius)))


def hold(angle: float) -> Scenario:
    return Scenario(ARMED, STEP, drive=c2d.Drive(gait=c2d.Hold(angle)))


def on(track: Track) -> Scenario:
    return Scenario(ROBOT.with_track(track), STEP)


def over(terrain: Terrain) -> Scenario:
    return Scenario(ROBOT, terrain)


LANES = c2d.terrains.lanes(c2d.terrains.step(0.03), c2d.terrains.step(5.0))
DOUBTFUL: dict[str, tuple[Scenario, str, float]] = {
    "a step of 75 m": (HIGH, "terrain.height", 75.0),
    "a barrier in centimetres": (over(c2d.terrains.barrier(5.0, 0.05)), "terrain.height", 5.0),
    "stairs in centimetres": (over(c2d.terrains.stairs(rise=18.0)), "terrain.rise", 18.0),
    "a trench in centimetres": (over(c2d.terrains.gap(8.0)), "terrain.width", 8.0),
    "friction in percent": (over(c2d.terrains.step(0.05, friction=90.0)), "terrain.friction", 90.0),
    "friction of one lane": (
        over(c2d.terrains.lanes(c2d.terrains.step(0.03), c2d.terrains.step(0.03, friction=9.0))),
        "terrain.right.friction",
        9.0,
    ),
    "a polyline with its goal behind the robot": (
        over(c2d.terrains.from_points([(-9.0, 0.0), (9.0, 0.0)], goal=-2.0)),
        "terrain.goal",
        -2.0,
    ),
    "friction of one segment": (
        over(
            c2d.terrains.from_points(
                [(-9.0, 0.0), (0.5, 0.0), (9.0, 0.0)], goal=1.0, segment_friction=[0.9, 90.0]
            )
        ),
        "terrain.segment_friction[1]",
        90.0,
    ),
    "a pipe in centimetres": (over(c2d.terrains.half_round(5.0)), "terrain.radius", 5.0),
    "one lane of two": (over(LANES), "terrain.right.height", 5.0),
    "huge wheels": (on(line(0.5)), "robot.track.wheel_radius", 0.5),
    "a huge placed wheel": (on(placed(0.1, 0.0, 0.5)), "robot.track.placements[1][2]", 0.5),
    "a wheel beside the robot": (on(placed(18.0, 0.0, 0.06)), "robot.track.placements[1][0]", 18.0),
    "pins that straighten the chain": (
        on(c2d.SegmentalTrack(pin_stiffness=50.0)),
        "robot.track.pin_stiffness",
        50.0,
    ),
    "pins that hold the chain fast": (
        on(c2d.SegmentalTrack(pin_damping=2.0)),
        "robot.track.pin_damping",
        2.0,
    ),
    "an angle in degrees": (hold(5.0), "drive.gait.angle", 5.0),
    "an angle in degrees, later": (
        Scenario(ARMED, STEP, drive=c2d.Drive(gait=c2d.Hold(0.5, ((1.0, -6.0),)))),
        "drive.gait.schedule[0][1]",
        -6.0,
    ),
    "a climb in degrees": (
        Scenario(ARMED, STEP, drive=c2d.Drive(gait=c2d.Climb(reach_angle=6.0))),
        "drive.gait.reach_angle",
        6.0,
    ),
    "a goal out of reach": (Scenario(ROBOT, STEP, goal=50.0), "goal", 50.0),
    "a goal that is passed": (Scenario(ROBOT, STEP, goal=-50.0), "goal", -50.0),
    "ground that is too long": (over(c2d.terrains.flat(length=50.0)), "duration", 15.0),
    "an approach out of reach": (
        Scenario(ROBOT, STEP, start=c2d.Start(approach=50.0)),
        "start.approach",
        50.0,
    ),
    "a centre of mass in millimetres": (
        Scenario(replace(ROBOT, center_of_mass=(0.0, 20.0)), STEP),
        "robot.center_of_mass[1]",
        20.0,
    ),
    "a moment of inertia in another unit": (
        Scenario(replace(ROBOT, moment_of_inertia=440.0), STEP),
        "robot.moment_of_inertia",
        440.0,
    ),
    "a robot in grams": (Scenario(replace(ROBOT, mass=21_200.0), STEP), "robot.mass", 21_200.0),
    "a robot in tonnes": (
        Scenario(replace(ROBOT, mass=0.0212, track_mass=0.002), STEP),
        "robot.mass",
        0.0212,
    ),
    "ground like foam": (
        Scenario(ROBOT, STEP, solver=c2d.Solver(contact_frequency=3.0)),
        "solver.contact_frequency",
        3.0,
    ),
    "gravity in centimetres": (Scenario(ROBOT, STEP, gravity=981.0), "gravity", 981.0),
}


def warnings_of(call: Callable[[], object]) -> list[c2d.ScenarioWarning]:
    """Return the warnings of a call, which must be at the line of this file."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        call()
    assert all(each.filename == __file__ for each in caught)
    messages = [each.message for each in caught]
    assert all(isinstance(each, c2d.ScenarioWarning) for each in messages)
    return messages  # type: ignore[return-value]


@pytest.mark.parametrize("name", DOUBTFUL)
def test_an_unlikely_value_gets_a_warning_with_its_path(name: str) -> None:
    scenario, path, value = DOUBTFUL[name]
    found = {warning.path: warning for warning in warnings_of(scenario.validate)}
    assert found[path].value == value
    assert str(found[path]) == f"{path} {found[path].reason}, got {value}"


def test_a_tip_radius_that_a_wheel_radius_overrides_gets_a_warning() -> None:
    # With the arms' own model, and with the robot's.
    arms = with_flippers(c2d.BeltTrack(), c2d.LineOfWheels(5, wheel_radius=0.06))
    assert arms.flippers is not None
    tip = arms.flippers.tip_radius
    inherited = with_flippers(c2d.LineOfWheels(5, wheel_radius=0.06))
    for robot, path in ((arms, "robot.flippers.track"), (inherited, "robot.track")):
        (warning,) = warnings_of(Scenario(robot, STEP).validate)
        assert (warning.path, warning.value) == ("robot.flippers.tip_radius", tip)
        assert f"{path}.wheel_radius = 0.06 m" in warning.reason
    as_built = with_flippers(c2d.BeltTrack(), c2d.LineOfWheels(5, wheel_radius=tip))
    of_both = with_flippers(c2d.LineOfWheels(5))
    for robot in (as_built, of_both):
        assert not warnings_of(Scenario(robot, STEP).validate)


@pytest.mark.parametrize("name", VARIANTS)
def test_usual_values_get_no_warning(name: str) -> None:
    assert not warnings_of(VARIANTS[name].validate)


@pytest.mark.parametrize(
    "scenario",
    [
        Scenario(ROBOT, c2d.terrains.step(1.0)),
        Scenario(ROBOT, c2d.terrains.flat(), duration=0.5),
        Scenario(ROBOT, c2d.terrains.flat(), duration=4.0),
        Scenario(ROBOT, STEP, goal=50.0, duration=0.5),
        Scenario(ROBOT, STEP, goal=50.0, drive=c2d.Drive(speed=0.0)),
        Scenario(ROBOT, STEP, goal=50.0, drive=c2d.Drive(speed=-0.4)),
        Scenario(ROBOT, STEP, goal=-0.5),
        Scenario(ROBOT, STEP, goal=5.0),
        hold(math.pi),
        on(line(0.12)),
        on(line(0.01)),
        Scenario(ROBOT, STEP, solver=c2d.Solver(contact_frequency=30.0)),
    ],
)
def test_plausible_values_get_no_warning(scenario: Scenario) -> None:
    assert not warnings_of(scenario.validate)


@pytest.mark.parametrize("frequency", [10.0, 30.0])
def test_the_sinkage_of_a_warning_is_that_of_a_robot_at_rest(frequency: float) -> None:
    solver = c2d.Solver(contact_frequency=frequency, contact_damping_ratio=1.0)
    still = Scenario(ROBOT, c2d.terrains.flat(), drive=c2d.Drive(speed=0.0), solver=solver)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", c2d.ScenarioWarning)
        run = c2d.simulate(still, duration=4.0)
    # Each end of the belt bears half of the weight, on a contact as stiff as if it bore all.
    sinkage = 9.81 / (2.0 * math.pi * frequency) ** 2
    bearing = run.contacts["time"] == run.time[-1]
    share = run.contacts["normal_force"][bearing] / (9.81 * ROBOT.mass)
    assert run.contacts["penetration"][bearing] == pytest.approx(share * sinkage, rel=1e-3)
    assert share.sum() == pytest.approx(1.0, rel=1e-3)
    found = warnings_of(still.validate)
    assert [each.path for each in found] == ["solver.contact_frequency"] * (frequency < 20.0)
    assert all(f"{sinkage:.2e}"[:4] in each.reason for each in found)


CALLS: dict[str, Callable[[], object]] = {
    "validate": HIGH.validate,
    "simulate": lambda: c2d.simulate(HIGH),
    "simulate a robot": lambda: c2d.simulate(ROBOT, c2d.terrains.step(75.0), duration=0.05),
    "simulate_many": lambda: c2d.simulate_many(
        [HIGH.replace({"terrain.height": height}) for height in (75.0, 80.0, 75.0)]
    ),
    "Simulation": lambda: c2d.Simulation(HIGH),
    "sweep": lambda: c2d.sweep(
        HIGH, {"terrain.height": [0.05, 60.0, 75.0]}, repeats=3, progress=False
    ),
    "compare": lambda: c2d.compare(
        HIGH, {"belt": c2d.BeltTrack(), "wheels": c2d.LineOfWheels(4)}, repeats=2, progress=False
    ),
}


@pytest.mark.parametrize("name", CALLS)
def test_a_call_warns_once_at_the_line_of_the_caller(name: str) -> None:
    (warning,) = warnings_of(CALLS[name])
    assert warning.path == "terrain.height"


SUNK = Scenario(
    ROBOT,
    c2d.terrains.flat(),
    gravity=20.0,
    drive=c2d.Drive(speed=0.0),
    duration=2.0,
    solver=c2d.Solver(max_push_speed=1e-6, contact_damping_ratio=0.01, contact_frequency=200.0),
)
"""Contacts that may not push it out again."""


def test_a_run_that_sank_deeper_than_its_softness_explains_gets_a_warning() -> None:
    runs = []
    (warning,) = warnings_of(lambda: runs.append(c2d.simulate(SUNK)))
    assert warning.path == "max_penetration"
    assert warning.value == runs[0].metrics["max_penetration"] > 2e-3
    assert "max_push_speed" in warning.reason
    for call in (
        lambda: c2d.simulate_many([SUNK, SUNK]),
        lambda: c2d.sweep(SUNK, {"gravity": [20.0, 21.0]}, progress=False),
    ):
        (warning,) = warnings_of(call)
        assert warning.path == "max_penetration"


def test_ground_inside_a_closed_track_does_not_count_as_sinkage() -> None:
    wheels = ROBOT.with_track(c2d.LineOfWheels(2))
    run = c2d.simulate(wheels, c2d.terrains.knife_edge(0.1), duration=8.0)
    assert run.outcome is c2d.Outcome.HUNG_UP
    closed = run.branch(at=run.metrics["time"], track="closed")
    # The dent heals where contacts find it; the outline alone is 30 mm deep.
    assert closed.metrics["max_penetration"] < 0.01


@pytest.mark.parametrize("name", VARIANTS)
def test_a_run_of_usual_values_gets_no_warning(name: str) -> None:
    assert not warnings_of(lambda: c2d.simulate(VARIANTS[name], record="summary"))


def test_reading_and_writing_warn_of_nothing() -> None:
    def read_and_write() -> None:
        scenario = Scenario.from_json(HIGH.to_json()).replace({"duration": 0.01})
        assert scenario.identity
        ROBOT.with_track(line(0.5)).wheels()

    assert not warnings_of(read_and_write)


def test_a_robot_too_large_for_the_ground_gets_a_warning() -> None:
    rule = r"terrain must reach under .* \(robot\.track\.wheel_radius = 90 is usually at most 0\.18"
    with pytest.raises(c2d.ScenarioError, match=rule):
        on(line(90.0)).validate()
    points = c2d.terrains.from_points([(-9.0, 0.0), (0.0, 0.0), (9.0, 0.0)], goal=1.0)
    with pytest.raises(c2d.ScenarioError, match=r"to -9\.0000 m, got x from -9 to 9 m$"):
        replace(over(points), start=c2d.Start(approach=9.0)).validate()


def test_a_warning_that_is_made_an_error_comes_before_the_run() -> None:
    asked: list[int] = []
    with warnings.catch_warnings():
        warnings.simplefilter("error", c2d.ScenarioWarning)
        with pytest.raises(c2d.ScenarioWarning, match=r"terrain\.height is usually at most"):
            c2d.simulate_many([HIGH], progress=lambda done, _: asked.append(done))
    assert not asked


def test_a_warning_survives_pickling() -> None:
    warning = c2d.ScenarioWarning("terrain.height", 75.0, "is usually at most 1.5 m")
    twin: Any = pickle.loads(pickle.dumps(warning))
    assert vars(twin) == vars(warning)
    assert str(twin) == "terrain.height is usually at most 1.5 m, got 75.0"


def test_a_robot_that_falls_off_the_end_of_the_ground_has_not_sunk_into_it() -> None:
    arms = c2d.Flippers(
        length=0.72,
        root_radius=0.13,
        tip_radius=0.17,
        mass=0.04,
        ends="both",
        angle=-0.25,
        torque_limit=44.0,
    )
    robot = c2d.Robot.simple(11.5, axle_distance=0.96, radius=0.19)
    robot = robot.with_track(c2d.LineOfWheels(9)).with_flippers(arms)
    # It slides back down the slope, its flippers first over the end.
    slope = c2d.terrains.from_points([(-5, -0.5), (5, 0.5)], goal=3.8, friction=0.05)
    run = c2d.simulate(robot, slope, start=c2d.Start(angle=0.0))
    assert run.outcome is c2d.Outcome.LEFT_TERRAIN
