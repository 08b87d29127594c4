"""Rotor inertias are the armature of joints in MJCF, and a comment where there is none."""

import dataclasses
from pathlib import Path

import pytest

import crawler2d as c2d
from tests.reading.carts import quietly

ON_WHEELS = {
    "line": c2d.robots.engineer(track=c2d.LineOfWheels(3)),
    "small wheels": c2d.robots.engineer(
        flippers=None, track=c2d.LineOfWheels(5, wheel_radius=0.03)
    ),
    "all round": c2d.robots.engineer(flippers=None, track=c2d.CircumferentialWheels(16)),
    "absolem": c2d.robots.absolem(track="public"),
    "marv": c2d.robots.marv(track="public"),
}


@pytest.mark.parametrize("robot", ON_WHEELS.values(), ids=ON_WHEELS)
def test_rotors_come_back_from_mjcf(robot: c2d.Robot, tmp_path: Path) -> None:
    """As the force of the motors does: at the ground, whatever the radius of the belt."""
    pytest.importorskip("mujoco")
    robot = with_rotors(robot)
    path = tmp_path / "robot.xml"
    robot.to_mjcf(path)
    again = quietly(path).robot
    assert again.drivetrain.rotor_inertia / again.outline.rear_radius**2 == pytest.approx(
        robot.drivetrain.rotor_inertia / belt_radius(robot) ** 2, rel=1e-9
    )
    if robot.flippers is not None:
        assert again.flippers is not None
        assert again.flippers.rotor_inertia == pytest.approx(0.3, rel=1e-9)


def belt_radius(robot: c2d.Robot) -> float:
    return robot.outline.rear_radius - robot.outline.grouser_height


def with_rotors(robot: c2d.Robot) -> c2d.Robot:
    drivetrain = dataclasses.replace(robot.drivetrain, rotor_inertia=0.02)
    flippers = robot.flippers
    if flippers is not None:
        flippers = dataclasses.replace(flippers, rotor_inertia=0.3)
    return dataclasses.replace(robot, drivetrain=drivetrain, flippers=flippers)


def test_what_a_file_cannot_hold_of_rotors_is_in_its_comment() -> None:
    wheeled = with_rotors(c2d.robots.engineer(track=c2d.LineOfWheels(3)))
    for text in (wheeled.to_sdf(), wheeled.to_urdf()):
        assert "drivetrain.rotor_inertia 0.02 kg m^2" in text
        assert "flippers.rotor_inertia 0.3 kg m^2" in text
        assert "armature" not in text
    assert "Left out" not in wheeled.to_mjcf()
    belted = with_rotors(c2d.robots.engineer()).to_mjcf()
    assert "Left out, without a place here: drivetrain.rotor_inertia" in belted
    assert "Left out, without a place here: flippers" not in belted


def test_without_rotors_files_are_as_before() -> None:
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(3))
    assert "armature" not in robot.to_mjcf()
    assert "Left out" not in robot.to_sdf()


def test_mujoco_has_the_rotors_in_its_joints() -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = with_rotors(c2d.robots.engineer(track=c2d.LineOfWheels(3)))
    model = mujoco.MjModel.from_xml_string(robot.to_mjcf())
    found = [
        float(model.dof_armature[model.jnt_dofadr[number]])
        for number in range(model.njnt)
        if model.jnt_type[number] == mujoco.mjtJoint.mjJNT_HINGE
    ]
    of_wheel = 0.02 / 3.0 * (robot.outline.rear_radius / belt_radius(robot)) ** 2
    assert robot.flippers is not None
    arms = 4 if robot.flippers.ends == "both" else 2
    assert sorted(each for each in found if each) == pytest.approx([of_wheel] * 6 + [0.3] * arms)
