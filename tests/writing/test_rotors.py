"""Rotor inertias are the armature of joints in MJCF, and a comment in other formats."""

import dataclasses
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
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
    """Like the force of the motors: at the ground, whatever the radius of the belt."""
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


@pytest.mark.parametrize("name", ["sdf", "urdf", "mjcf"])
@pytest.mark.parametrize("robot", ON_WHEELS.values(), ids=ON_WHEELS)
def test_all_wheels_of_a_side_share_its_torque(robot: c2d.Robot, name: str, tmp_path: Path) -> None:
    """Also those on flippers, by the rule by which the simulator shares it among N wheels."""
    if name == "mjcf":
        pytest.importorskip("mujoco")
    path = tmp_path / f"robot.{'xml' if name == 'mjcf' else name}"
    getattr(robot, f"to_{name}")(path)
    again = quietly(path)
    force = robot.drivetrain.max_torque / belt_radius(robot)
    assert again.robot.drivetrain.max_torque / again.robot.outline.rear_radius == pytest.approx(
        force, rel=1e-9
    )
    joints = [again.tree.joints[each] for each in again.wheels["name"].tolist()]
    forces = [joint.effort for joint in joints] / again.wheels["radius"]
    assert forces == pytest.approx(force / (len(forces) / 2), rel=1e-6)


def test_a_motor_of_the_core_is_that_of_the_file(tmp_path: Path) -> None:
    """At rest against a slope too steep for it, every wheel has all the force of its motors."""
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(3)).without_rotors()
    robot = with_motors(robot, max_torque=1.0, torque_sharing="wheel")
    path = tmp_path / "robot.urdf"
    robot.to_urdf(path)
    again = quietly(path)
    slope = c2d.terrains.ramp(0.6, friction=1.0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", c2d.ScenarioWarning)
        run = c2d.simulate(again.robot, slope, drive=c2d.Drive(speed=0.3), duration=4.0)
    joint = again.tree.joints["left_wheel_1"]
    assert joint.effort is not None
    most = np.abs(run.drive_forces).max(axis=0)
    assert len(most) == len(again.wheels) // 2
    assert most[0] == pytest.approx(2.0 * joint.effort / again.robot.outline.rear_radius, rel=1e-6)


def belt_radius(robot: c2d.Robot) -> float:
    return robot.outline.rear_radius - robot.outline.grouser_height


def left_out(text: str) -> list[str]:
    """Names of properties that the comment lists as left out."""
    found = re.search(r"Left out, as [A-Z]+ has no place for it: (.*)\.\n", text)
    return [] if found is None else found[1].split(", ")


def with_rotors(robot: c2d.Robot) -> c2d.Robot:
    drivetrain = dataclasses.replace(robot.drivetrain, rotor_inertia=0.02)
    flippers = robot.flippers
    if flippers is not None:
        flippers = dataclasses.replace(flippers, rotor_inertia=0.3)
    return dataclasses.replace(robot, drivetrain=drivetrain, flippers=flippers)


def test_rotors_that_a_file_cannot_hold_are_in_its_comment() -> None:
    wheeled = with_rotors(c2d.robots.engineer(track=c2d.LineOfWheels(3)))
    for text in (wheeled.to_sdf(), wheeled.to_urdf()):
        assert left_out(text) == ["drivetrain.rotor_inertia", "flippers.rotor_inertia"]
        assert "armature" not in text
    assert left_out(wheeled.to_mjcf()) == []
    belted = with_rotors(c2d.robots.engineer()).to_mjcf()
    assert left_out(belted) == ["drivetrain.max_torque", "drivetrain.rotor_inertia"]


def test_without_rotors_files_are_as_before() -> None:
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(3)).without_rotors()
    assert "armature" not in robot.to_mjcf()
    assert left_out(robot.to_sdf()) == []


def test_mujoco_has_the_rotors_in_its_joints() -> None:
    mujoco = pytest.importorskip("mujoco")
    robot = with_rotors(c2d.robots.engineer(track=c2d.LineOfWheels(3)))
    model = mujoco.MjModel.from_xml_string(robot.to_mjcf())
    found = [
        float(model.dof_armature[model.jnt_dofadr[number]])
        for number in range(model.njnt)
        if model.jnt_type[number] == mujoco.mjtJoint.mjJNT_HINGE
    ]
    wheels = robot.wheels()
    rotors = 0.02 / (len(wheels) / 2) * (wheels["radius"] / belt_radius(robot)) ** 2
    assert robot.flippers is not None
    arms = 4 if robot.flippers.ends == "both" else 2
    expected = sorted([*rotors.tolist(), *[0.3] * arms])
    assert sorted(each for each in found if each) == pytest.approx(expected)


@pytest.mark.parametrize("robot", ON_WHEELS.values(), ids=ON_WHEELS)
def test_the_gain_of_a_controller_comes_back_from_mjcf(robot: c2d.Robot, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    robot = with_motors(robot, controller=c2d.PI(gain=4.0))
    path = tmp_path / "robot.xml"
    assert left_out(robot.to_mjcf(path)) == []
    again = quietly(path).robot
    assert again.drivetrain.controller is not None
    assert again.drivetrain.controller.gain / again.outline.rear_radius**2 == pytest.approx(
        4.0 / belt_radius(robot) ** 2, rel=1e-9
    )


def test_motors_that_no_file_holds_are_in_its_comment() -> None:
    robot = ON_WHEELS["all round"].without_rotors()
    line = with_motors(robot, controller=c2d.PI(gain=4.0, integral=1.0), no_load_speed=2.0)
    assert left_out(line.to_mjcf()) == [
        "drivetrain.no_load_speed",
        "drivetrain.controller.integral",
    ]
    torque = robot.drivetrain.max_torque
    curve = with_motors(robot, torque_curve=((0.0, torque), (1.0, 0.5 * torque)))
    assert left_out(curve.to_urdf()) == ["drivetrain.torque_curve"]


def test_the_rotor_of_a_belt_is_in_the_comment_of_wheels_on_flippers() -> None:
    """It turns with the belt, which has no joint; without one, all wheels share it."""
    arms = c2d.robots.engineer().flippers
    assert arms is not None
    arms = dataclasses.replace(arms, track=c2d.LineOfWheels(3))
    belted = c2d.robots.engineer(flippers=arms, track=c2d.BeltTrack())
    named = ["drivetrain.max_torque", "drivetrain.rotor_inertia"]
    assert left_out(belted.to_mjcf()) == named
    held = with_motors(belted, controller=c2d.PI(gain=4.0))
    assert left_out(held.to_mjcf()) == [*named, "drivetrain.controller"]
    assert left_out(belted.with_track(c2d.LineOfWheels(3)).to_mjcf()) == []


def test_the_torque_of_a_belt_is_in_the_comment_as_left_out() -> None:
    """No format has a limit of force for a surface that moves."""
    robot = c2d.robots.engineer(flippers=None).without_rotors()
    for text in (robot.to_sdf(), robot.to_mjcf()):
        assert left_out(text) == ["drivetrain.max_torque"]
    free = with_motors(robot, max_torque=0.0)
    assert left_out(free.to_sdf()) == []


def with_motors(robot: c2d.Robot, **motors: Any) -> c2d.Robot:
    drivetrain = dataclasses.replace(robot.drivetrain, **motors)
    return dataclasses.replace(robot, drivetrain=drivetrain)


def test_rotor_and_gain_speed_a_robot_up_as_in_mujoco() -> None:
    """On level ground, to 2 %: contacts in MuJoCo creep."""
    mujoco = pytest.importorskip("mujoco")
    robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
    robot = with_motors(
        robot, rotor_inertia=0.05, controller=c2d.PI(gain=0.5), max_acceleration=1e4
    )
    text = robot.to_mjcf(friction=0.9)
    ground = '<worldbody><geom type="plane" size="50 50 1"/>'
    model = mujoco.MjModel.from_xml_string(text.replace("<worldbody>", ground))
    model.opt.timestep = 5e-4
    data = mujoco.MjData(model)
    while data.time < 0.2:  # it settles
        mujoco.mj_step(model, data)
    data.ctrl[:] = 0.4 / robot.outline.rear_radius
    scenario = c2d.Scenario(
        robot, c2d.terrains.flat(friction=0.9), drive=c2d.Drive(speed=0.4), duration=1.0
    )
    simulation = c2d.Simulation(scenario)
    for _ in range(4):
        simulation.advance(0.1)
        for _ in range(200):
            mujoco.mj_step(model, data)
        assert simulation.state().velocity[0] == pytest.approx(data.qvel[0], rel=0.02)
    assert data.qvel[0] < 0.38  # [m/s] as yet
