"""Presets and generators: their values, and the rules of Robot.simple."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.fields import read_path
from crawler2d.parameters.scenario import Scenario


def test_the_engineer_has_the_figures_of_its_sources() -> None:
    robot = c2d.robots.engineer(flippers=None)
    assert (robot.mass, robot.track_mass) == (21.2, 2.4)
    assert robot.center_of_mass == (0.0, 0.02)
    assert robot.outline == c2d.TrackOutline(
        axle_distance=0.365,
        front_radius=0.064,
        rear_radius=0.064,
        grouser_height=0.012,
        grouser_pitch=0.048,
        grouser_thickness=0.006,
    )
    assert robot.moment_of_inertia == pytest.approx(21.2 / 12 * (0.482**2 + 0.130**2))
    assert robot.drivetrain.max_torque == 6.0
    assert robot.track == c2d.BeltTrack()


@pytest.mark.parametrize("preset", [c2d.robots.absolem, c2d.robots.gz_tracked_vehicle])
def test_every_preset_drives_over_what_its_radius_allows(preset: Any) -> None:
    run = c2d.simulate(preset(), c2d.terrains.step(0.05, friction=0.7))
    assert run.outcome == "cleared"
    assert run.scenario.robot.name == preset.__name__


def test_the_gazebo_vehicle_is_put_together_from_its_file() -> None:
    robot = c2d.robots.gz_tracked_vehicle(flippers=None)
    assert robot.mass == pytest.approx(25.26)
    assert robot.center_of_mass == pytest.approx((-0.0635, 0.0496), abs=5e-5)
    assert robot.moment_of_inertia == pytest.approx(0.529, abs=5e-4)
    assert c2d.robots.gz_tracked_vehicle(flippers=None, track="public").track == c2d.BeltTrack()


def test_an_edge_that_a_belt_clears_enters_public_wheel_models() -> None:
    """The problem of users who replace tracks by wheels in a simulator, which has no rotors."""
    blade = c2d.terrains.knife_edge(0.05, thickness=0.02)
    wheels = c2d.robots.engineer(flippers=None, track="public").without_rotors()
    belt = c2d.robots.engineer(flippers=None).without_rotors()
    assert c2d.simulate(wheels, blade).mechanism is not None
    assert c2d.simulate(belt, blade).outcome == "cleared"


def test_the_engineers_rotors_carry_its_public_wheels_over_that_edge() -> None:
    blade = c2d.terrains.knife_edge(0.05, thickness=0.02)
    wheels = c2d.robots.engineer(flippers=None, track="public")
    assert c2d.simulate(wheels, blade).outcome == "cleared"


@pytest.mark.parametrize(
    ("with_rotors", "seizing", "clear"), [(True, (80, 100, 120), 130), (False, (70, 100, 130), 140)]
)
def test_public_absolem_seizes_between_the_wheels_of_its_flippers(
    with_rotors: bool, seizing: tuple[int, ...], clear: int
) -> None:
    """At the friction of its wheels, where a belt clears; with more, the wheels clear, too."""
    drive = c2d.Drive(gait=c2d.Climb())
    robots = [c2d.robots.absolem(track=track) for track in ("public", None)]
    scenarios = [
        Scenario(robot if with_rotors else robot.without_rotors(), terrain, drive=drive)
        for height in (1e-3 * millimetres for millimetres in (*seizing, clear))
        for terrain in (
            c2d.terrains.step(height, friction=0.5),
            c2d.terrains.knife_edge(height, friction=0.5),
            c2d.terrains.barrier(height, 0.1, friction=0.5),
        )
        for robot in robots
    ]
    runs = c2d.simulate_many(scenarios, record="summary", progress=False)
    assert {str(run.outcome) for run in runs[1::2]} == {"cleared"}
    assert [str(run.outcome) for run in runs[::2]] == ["seized"] * 9 + ["cleared"] * 3
    for run in runs[:18:2]:
        assert run.diagnosis is not None
        assert run.diagnosis.intrusion is not None
        # Wheels 0 to 7 are the track's, 8 to 12 those of the flippers in front.
        assert run.diagnosis.intrusion.bodies == (9, 8)


def test_public_absolem_without_flippers_seizes_on_no_step() -> None:
    """With the masses of its file; a guess of its centre of mass once made it seize at 110 mm."""
    robot = c2d.robots.absolem(flippers=None, track="public")
    scenarios = [
        Scenario(robot, c2d.terrains.step(height, friction=friction))
        for height in (0.06, 0.08, 0.09, 0.10, 0.11, 0.12)
        for friction in (0.6, 0.8, 1.0)
    ]
    runs = c2d.simulate_many(scenarios, record="summary", progress=False)
    outcomes = [str(run.outcome) for run in runs]
    assert "seized" not in outcomes
    assert outcomes[:3] == ["cleared"] * 3


@pytest.mark.parametrize(
    ("preset", "mass", "track", "flipper"),
    [(c2d.robots.absolem, 40.0, 30.0, 30.0), (c2d.robots.marv, 70.0, 2 * 25.0, 180.0)],
)
def test_a_robot_that_was_published_twice_has_the_figures_of_the_source_asked_for(
    preset: Any, mass: float, track: float, flipper: float
) -> None:
    subt, rough = preset(), preset(source="rough")
    assert preset(source="subt") == subt
    assert rough.mass == pytest.approx(mass)
    assert rough.drivetrain.max_torque == track
    assert rough.flippers.torque_limit == flipper
    assert rough.outline == subt.outline
    bare = [robot.without_flippers() for robot in (subt, rough)]
    assert bare[1].center_of_mass == pytest.approx(bare[0].center_of_mass)
    radii = [robot.moment_of_inertia / robot.mass for robot in bare]  # squared, of gyration
    assert radii[1] == pytest.approx(radii[0])


def test_a_robot_without_rotors_is_the_same_otherwise() -> None:
    robot = c2d.robots.absolem()
    assert robot.flippers is not None
    bare = robot.without_rotors()
    assert bare.flippers is not None
    assert bare.drivetrain.rotor_inertia == bare.flippers.rotor_inertia == 0.0
    assert bare.drivetrain == dataclasses.replace(robot.drivetrain, rotor_inertia=0.0)
    assert bare == dataclasses.replace(
        robot,
        drivetrain=bare.drivetrain,
        flippers=dataclasses.replace(robot.flippers, rotor_inertia=0.0),
    )
    assert bare.without_rotors() == bare
    assert robot.without_flippers().without_rotors() == bare.without_flippers()


@pytest.mark.parametrize("preset", [c2d.robots.absolem, c2d.robots.marv])
def test_the_ranges_of_unknowns_cover_both_sources(preset: Any) -> None:
    robots = preset(), preset(source="rough")
    for path in ("robot.mass", "robot.drivetrain.max_torque", "robot.flippers.torque_limit"):
        own = [read_path(Scenario(robot, c2d.terrains.flat()), path) for robot in robots]
        for robot, figure in zip(robots, own, strict=True):
            within = c2d.unknowns.of_robot(robot)[path]
            low, high = within.values(np.array([0.0, 1.0]), figure)
            assert low <= min(own) * 1.001  # scales have three digits
            assert high >= max(own) * 0.999


@pytest.mark.parametrize("preset", [c2d.robots.absolem, c2d.robots.marv])
@pytest.mark.parametrize("source", ["SubT", "", None, 40.0])
def test_an_unknown_source_is_refused(preset: Any, source: Any) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        preset(source=source)
    assert caught.value.path == "source"


@pytest.mark.parametrize("name", c2d.robots.__all__)
def test_an_unknown_track_is_refused(name: str) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        getattr(c2d.robots, name)(track="private")
    assert caught.value.path == "track"


def test_22_grousers_fit_on_the_engineers_belt() -> None:
    outline = c2d.robots.engineer(flippers=None).outline
    belt = outline.front_radius - outline.grouser_height
    perimeter = 2 * outline.axle_distance + 2 * math.pi * belt
    assert perimeter / outline.grouser_pitch == pytest.approx(22, abs=0.02)


def test_the_belly_of_the_engineer_lies_as_high_as_asked() -> None:
    robot = c2d.robots.engineer(flippers=None, belly_clearance=0.02)
    assert robot.belly is not None
    assert min(y for _, y in robot.belly) == pytest.approx(0.02 - 0.064)
    Scenario(robot, c2d.terrains.flat()).validate()


@pytest.mark.parametrize("clearance", ["0.03", None, True])
def test_a_clearance_that_is_no_number_is_refused(clearance: Any) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.robots.engineer(flippers=None, belly_clearance=clearance)
    assert caught.value.path == "belly_clearance"


def test_a_simple_robot_of_the_engineers_size_is_like_it() -> None:
    simple = c2d.Robot.simple(21.2, axle_distance=0.365, radius=0.064)
    preset = c2d.robots.engineer(flippers=None)
    assert simple.drivetrain.max_torque == pytest.approx(preset.drivetrain.max_torque, rel=0.03)
    assert simple.outline.grouser_height == pytest.approx(preset.outline.grouser_height)
    assert simple.outline.grouser_pitch == pytest.approx(preset.outline.grouser_pitch, rel=1e-3)


@pytest.mark.parametrize(
    ("mass", "axle_distance", "radius"),
    [(0.5, 0.05, 0.01), (20.0, 0.4, 0.06), (38.0, 0.5, 0.089), (5000.0, 3.0, 0.5), (5, 0.05, 0.3)],
)
@pytest.mark.parametrize(
    "track", [None, c2d.LineOfWheels(2), c2d.ForceTrack()], ids=["belt", "line", "force"]
)
def test_a_simple_robot_of_any_size_can_be_simulated(
    mass: float, axle_distance: float, radius: float, track: Any
) -> None:
    robot = c2d.Robot.simple(mass, axle_distance=axle_distance, radius=radius, track=track)
    run = c2d.simulate(robot, c2d.terrains.flat(), duration=0.5)
    assert run.metrics["distance"] > 0.01


def test_a_simple_robot_has_a_whole_number_of_grousers() -> None:
    outline = c2d.Robot.simple(20.0, axle_distance=0.41, radius=0.07).outline
    belt = outline.front_radius - outline.grouser_height
    count = (2 * outline.axle_distance + 2 * math.pi * belt) / outline.grouser_pitch
    assert count == pytest.approx(round(count))


@pytest.mark.parametrize("name", ["mass", "axle_distance", "radius"])
@pytest.mark.parametrize("value", [0, -1.0, math.nan, math.inf, "1", None, True, 1e300])
def test_a_simple_robot_of_impossible_figures_is_refused(name: str, value: Any) -> None:
    figures: dict[str, Any] = {"mass": 20.0, "axle_distance": 0.4, "radius": 0.06, name: value}
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.Robot.simple(figures.pop("mass"), **figures)
    assert caught.value.path == name


def test_a_terrain_generator_sets_what_it_is_given() -> None:
    assert c2d.terrains.step(0.1, friction=0.5).friction == 0.5
    assert c2d.terrains.ramp(0.2).length == 1.0
    assert c2d.terrains.flat().length == 2.0
    left, right = c2d.terrains.step(0.1), c2d.terrains.flat()
    assert c2d.terrains.lanes(left, right).middle is None


def test_parameters_cannot_be_changed() -> None:
    robot = c2d.robots.engineer(flippers=None)
    with pytest.raises(dataclasses.FrozenInstanceError):
        robot.mass = 1.0  # type: ignore[misc]
