"""Readings of public models agree with their files; each value is checked against the file."""

import dataclasses
import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.fields import Parameters
from tests.reading.carts import ROBOTS, quietly
from tests.robots import robot_files
from tests.robots.robot_files import together

ABSOLEM = quietly(ROBOTS / "absolem.sdf")
MARV = quietly(ROBOTS / "marv.sdf")
GAZEBO = quietly(ROBOTS / "tracked_vehicle_simple.sdf")
URDF = quietly(ROBOTS / "eng.urdf", mesh="leave_out")
ALL = {"absolem": ABSOLEM, "marv": MARV, "gz_tracked_vehicle": GAZEBO, "eng.urdf": URDF}

DIGIT = 1e-6
"""[m] Last digit of the places in the files."""


def wheels(reading: c2d.Reading, carrier: str, side: str = "left") -> Any:
    """x, y and radius of the wheels of a carrier on one side, from the rear."""
    chosen = (reading.wheels["carrier"] == carrier) & (reading.wheels["side"] == side)
    return np.array([reading.wheels[name][chosen] for name in ("x", "y", "radius")]).T


@pytest.mark.parametrize("side", ["left", "right"])
def test_absolem_has_eight_wheels_of_89_mm_a_track(side: str) -> None:
    found = wheels(ABSOLEM, "chassis", side)
    assert found[:, 2].tolist() == [0.089] * 8
    assert found[:, 0] == pytest.approx(np.linspace(-0.25, 0.25, 8), abs=DIGIT)
    assert ABSOLEM.robot.track == c2d.LineOfWheels(8)


@pytest.mark.parametrize("carrier", ["front flipper", "rear flipper"])
def test_absolem_has_five_wheels_a_flipper(carrier: str) -> None:
    radii = wheels(ABSOLEM, carrier)[:, 2]
    assert sorted(radii) == pytest.approx([0.029, 0.044, 0.059, 0.074, 0.089])
    assert ABSOLEM.robot.flippers is not None
    assert ABSOLEM.robot.flippers.track == c2d.LineOfWheels(5)


def test_absolems_mass_and_centre_are_the_sums_over_its_links() -> None:
    """The flippers are turned to angle 0: its centre is higher than in the file, by little."""
    links = robot_files.read_sdf("absolem.sdf")
    whole = together(links)
    assert ABSOLEM.robot.mass == pytest.approx(whole.mass, rel=1e-12)
    assert round(ABSOLEM.robot.mass, 3) == 38.698
    x, y = ABSOLEM.robot.center_of_mass
    # Front and rear flippers turn alike, so x stays; they are 3 kg with centres 0.24 m out.
    assert x == pytest.approx(whole.x, abs=1e-6)
    raised = 3.0 * 0.242 * math.sin(0.1937) / whole.mass
    assert y + 0.01855 == pytest.approx(whole.z + raised, abs=1e-4)


@pytest.mark.parametrize(
    ("reading", "file", "model"),
    [(MARV, "marv.sdf", None), (GAZEBO, "tracked_vehicle_simple.sdf", "simple_tracked")],
)
def test_the_mass_is_the_sum_over_all_links(
    reading: c2d.Reading, file: str, model: str | None
) -> None:
    whole = together(robot_files.read_sdf(file, model))
    assert reading.robot.mass == pytest.approx(whole.mass, rel=1e-12)
    assert reading.robot.center_of_mass[0] == pytest.approx(whole.x, abs=1e-6)


def test_marvs_level_flippers_leave_centre_and_inertia_those_of_the_file() -> None:
    whole = together(robot_files.read_sdf("marv.sdf"))
    assert MARV.robot.center_of_mass == pytest.approx((whole.x, whole.z), rel=1e-12)
    assert MARV.robot.moment_of_inertia == pytest.approx(whole.inertia, rel=1e-9)


def test_a_front_wheel_15_mm_inboard_is_paired() -> None:
    assert "left_track_wheel1: 15 mm inboard of the others" in ABSOLEM.notes
    assert "right_track_wheel1: 15 mm inboard of the others" in ABSOLEM.notes


def test_marv_stands_on_its_flippers_of_eight_wheels() -> None:
    assert MARV.robot.track == c2d.LineOfWheels(2, as_track=False)
    assert MARV.robot.flippers is not None
    assert MARV.robot.flippers.track == c2d.LineOfWheels(8)
    for carrier in ("front flipper", "rear flipper"):
        assert sorted(wheels(MARV, carrier)[:, 2]) == pytest.approx(np.linspace(0.078, 0.1165, 8))


def test_gazebos_vehicle_has_belts_that_its_controllers_move() -> None:
    robot = GAZEBO.robot
    assert robot.track == c2d.BeltTrack()
    assert (robot.outline.front_radius, robot.outline.rear_radius) == (0.09047, 0.09047)
    assert robot.drivetrain.max_speed == 1.0
    assert robot.flippers is not None
    assert robot.flippers.track == c2d.BeltTrack()
    assert any("locked" in note for note in GAZEBO.notes)


@pytest.mark.parametrize("name", ["absolem", "marv", "gz_tracked_vehicle"])
def test_a_reading_agrees_with_the_preset_in_what_both_take_from_the_file(name: str) -> None:
    preset: c2d.Robot = getattr(c2d.robots, name)(track="public")
    robot = ALL[name].robot
    for field in ("axle_distance", "front_radius", "rear_radius"):
        own, other = getattr(robot.outline, field), getattr(preset.outline, field)
        assert own == pytest.approx(other, abs=DIGIT), field
    assert robot.track == preset.track
    assert robot.gauge == pytest.approx(preset.gauge, abs=DIGIT)
    assert robot.mass == pytest.approx(preset.mass, abs=1e-3)
    arms, others = robot.flippers, preset.flippers
    assert arms is not None
    assert others is not None
    assert arms.ends == others.ends == "both"
    # Absolem's drop by 0.19 rad is written with six decimals.
    for field in ("length", "root_radius", "tip_radius"):
        assert getattr(arms, field) == pytest.approx(getattr(others, field), abs=2e-6), field
    assert arms.mass == pytest.approx(others.mass, abs=1e-3)  # frames of 10 mg are counted here
    if name != "gz_tracked_vehicle":  # whose flippers are locked
        assert arms.rate_limit == others.rate_limit
        assert arms.torque_limit == others.torque_limit


def test_the_engineers_urdf_is_read_although_ten_times_too_large() -> None:
    assert wheels(URDF, "chassis")[:, 2].tolist() == [0.8, 0.8]
    assert URDF.robot.outline.axle_distance == pytest.approx(3.72)
    assert any("is the file in metres?" in warning for warning in URDF.warnings)


def test_the_engineers_urdf_has_its_lateral_axis_along_x() -> None:
    assert URDF.notes[0] == "links called front are ahead of those called rear: +y is forward"


def test_the_engineers_xacro_has_three_wheels_of_80_mm_a_side() -> None:
    pytest.importorskip("xacrodoc")
    reading = quietly(ROBOTS / "eng.xacro", trusted=True, mesh="leave_out", missing="leave_out")
    found = wheels(reading, "chassis")
    assert found[:, 2] == pytest.approx([0.08] * 3)
    assert found[:, 0] == pytest.approx([-0.186, 0.0, 0.186])
    masses, _ = robot_files.read_xacro("eng.xacro")
    assert reading.robot.mass == pytest.approx(sum(masses.values()))
    assert wheels(reading, "front flipper")[:, 2] == pytest.approx([0.056])
    assert sum("is left out: the file must be in" in warning for warning in reading.warnings) == 3


def leaves(parameters: Parameters, path: str) -> Iterator[str]:
    fields = [field.name for field in dataclasses.fields(parameters)]  # type: ignore[arg-type]
    for name in (each for field in fields for each in parameters.written_as.get(field, (field,))):
        value = getattr(parameters, name)
        inner = f"{path}.{name}"
        if isinstance(value, Parameters) and not value.kind:
            yield from leaves(value, inner)
        else:
            yield inner


@pytest.mark.parametrize("name", ALL)
def test_every_figure_has_a_source(name: str) -> None:
    reading = ALL[name]
    wanted = {*leaves(reading.robot, "robot"), "friction"}
    assert wanted == set(reading.sources)
    for path, source in reading.sources.items():
        assert source.startswith("estimate: ") or reading.tree.file in source, path


@pytest.mark.parametrize(
    ("reading", "figure", "line", "holds"),
    [
        (ABSOLEM, "robot.outline.axle_distance", 1273, "0.25 0.1985 0.01855"),
        (ABSOLEM, "robot.outline.front_radius", 1291, "<radius>0.089"),
        (ABSOLEM, "robot.flippers.torque_limit", 967, "<effort>20"),
        (ABSOLEM, "robot.flippers.rate_limit", 968, "<velocity>0.785398"),
        (ABSOLEM, "robot.mass", 7, "<mass>22.4783"),
        (GAZEBO, "robot.drivetrain.max_speed", 1085, "<max_velocity>1.0"),
        (GAZEBO, "robot.flippers.angle", 298, "-0.5"),
    ],
)
def test_a_source_names_the_line_that_holds_the_figure(
    reading: c2d.Reading, figure: str, line: int, holds: str
) -> None:
    assert re.search(rf":{line}\b|[:,] {line}\b", reading.sources[figure])
    assert holds in robot_files.lines(reading.tree.file)[line]


def test_along_a_wheel_friction_is_across_its_fdir1() -> None:
    """fdir1 is the z axis of the collision, which is the axle: mu acts along it, mu2 across."""
    assert "1 along the track" in ABSOLEM.sources["friction"]
    assert ":1019 to" in ABSOLEM.sources["friction"]
    assert "<mu2>1<" in robot_files.lines("absolem.sdf")[1019]
    assert MARV.sources["friction"].startswith("150 along the track, min with 1 of the ground")


def test_along_a_moved_track_friction_is_mu() -> None:
    assert GAZEBO.friction == 0.7
    assert quietly(ROBOTS / "tracked_vehicle_simple.sdf", engine="mujoco").friction == 1.0
    isaac = quietly(ROBOTS / "tracked_vehicle_simple.sdf", engine="isaac").friction
    assert isaac == pytest.approx(0.5 * (0.7 + 0.5))


@pytest.mark.parametrize("name", ["absolem", "marv", "gz_tracked_vehicle"])
def test_a_reading_can_be_simulated(name: str) -> None:
    reading = ALL[name]
    flat = c2d.terrains.flat(friction=reading.friction)
    run = c2d.simulate(c2d.Scenario(reading.robot, flat, duration=1.0, drive=c2d.Drive(speed=0.2)))
    assert run.position[-1, 0] > run.position[0, 0]
