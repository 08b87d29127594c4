"""Files loaded into other engines have the robot's masses and wheels, and drive forward."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import crawler2d as c2d
from tests.shared import GEAR, with_flippers
from tests.writing.test_checkers import BELTED, WHEELED

TAPERED = {"tapered": c2d.robots.engineer(track=c2d.LineOfWheels(3, wheel=GEAR))}
HELD = {
    "mjcf": {**WHEELED, **BELTED, **TAPERED},
    "sdf": {**WHEELED, **BELTED},
    "urdf": WHEELED,
}
SECONDS, SHARE = 2.0, 0.5  # driven, with this fraction of the largest speed


def engine(name: str) -> Any:
    pytest.importorskip(name)
    return importlib.import_module(name)


def whole(robot: c2d.Robot) -> np.ndarray:
    """[m] Centre of mass with the flippers at their angle, in the chassis frame of three axes.

    Flippers are uniform rods; `center_of_mass` has them at angle 0.
    """
    moment = robot.mass * np.array(robot.center_of_mass)
    flippers = robot.flippers
    if flippers is not None:
        half = 0.5 * flippers.length
        moved = half * np.array([np.cos(flippers.angle) - 1.0, np.sin(flippers.angle)])
        for end, sign in (("front", 1.0), ("rear", -1.0)):
            if flippers.ends in (end, "both"):
                moment += 2.0 * flippers.mass * moved * (sign, 1.0)
    x, y = moment / robot.mass
    return np.array([x, 0.0, y])


def wheels_of(robot: c2d.Robot) -> list[list[float]]:
    """[m] Forward and upward coordinates of the axles of both sides."""
    wheels = robot.wheels()
    return sorted(np.column_stack([wheels["x"], wheels["y"]]).round(9).tolist())


def compare(
    robot: c2d.Robot, mass: float, center: Any, axles: list[np.ndarray], accuracy: float = 1e-9
) -> None:
    """Compare the loaded robot with the original, both in the chassis frame."""
    assert mass == pytest.approx(robot.mass, rel=accuracy)
    assert np.allclose(center, whole(robot), rtol=0.0, atol=accuracy)
    found = sorted(np.array(axles).reshape(-1, 3)[:, [0, 2]].round(9).tolist())
    expected = wheels_of(robot)
    assert len(found) == len(expected)
    # Sorting depends on differences in the last digit.
    for axle in found:
        assert min(np.hypot(*np.subtract(axle, each)) for each in expected) <= accuracy


@pytest.mark.parametrize("robot", HELD["mjcf"].values(), ids=HELD["mjcf"])
def test_mujoco_has_the_same_robot(robot: c2d.Robot, capfd: pytest.CaptureFixture[str]) -> None:
    mujoco = engine("mujoco")
    model = mujoco.MjModel.from_xml_string(robot.to_mjcf())
    assert capfd.readouterr() == ("", "")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    origin = data.xpos[1]
    names = [model.body(number).name for number in range(model.nbody)]
    axles = [data.xpos[i] - origin for i, name in enumerate(names) if "wheel" in name]
    compare(robot, model.body_subtreemass[1], data.subtree_com[1] - origin, axles)


@pytest.mark.parametrize("robot", HELD["urdf"].values(), ids=HELD["urdf"])
def test_bullet_has_the_same_robot(
    robot: c2d.Robot, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    bullet = engine("pybullet")
    path = tmp_path / "robot.urdf"
    robot.to_urdf(path)
    client = bullet.connect(bullet.DIRECT)
    try:
        body = bullet.loadURDF(str(path), flags=bullet.URDF_USE_INERTIA_FROM_FILE)
        assert "arning" not in "".join(capfd.readouterr())
        count = bullet.getNumJoints(body)
        masses = [bullet.getDynamicsInfo(body, i)[0] for i in range(-1, count)]
        middle, _ = bullet.getBasePositionAndOrientation(body)
        states = [bullet.getLinkState(body, i) for i in range(count)]
        centers = [middle, *(state[0] for state in states)]
        names = [bullet.getJointInfo(body, i)[12].decode() for i in range(count)]
        # The root's frame is the chassis frame; Bullet returns its centre of mass.
        offset = np.array(bullet.getDynamicsInfo(body, -1)[3])
        origin = np.array(middle) - offset
        axles = [
            np.array(state[4]) - origin
            for state, name in zip(states, names, strict=True)
            if "wheel" in name
        ]
        center = np.array(masses) @ (np.array(centers) - origin) / sum(masses)
        compare(robot, sum(masses), center, axles, accuracy=1e-6)
    finally:
        bullet.disconnect(client)


@pytest.mark.parametrize("form", ["sdf", "urdf"])
def test_dart_has_the_same_robots(
    form: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    dart = engine("dartpy")
    for number, robot in enumerate(HELD[form].values()):
        path = tmp_path / f"{number}.{form}"
        getattr(robot, f"to_{form}")(path)
        if form == "sdf":
            skeleton = dart.utils.SdfParser.readSkeleton(f"file://{path}")
        else:
            skeleton = dart.utils.DartLoader().parseSkeleton(f"file://{path}")
        assert capfd.readouterr() == ("", "")
        nodes = [skeleton.getBodyNode(i) for i in range(skeleton.getNumBodyNodes())]
        places = {node.getName(): node.getTransform().translation() for node in nodes}
        origin = places["chassis"]
        axles = [place - origin for name, place in places.items() if "wheel" in name]
        compare(robot, skeleton.getMass(), skeleton.getCOM() - origin, axles)


DRIVEN = {
    "round wheels": c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4)),
    "round wheels and flippers": c2d.robots.engineer(track=c2d.LineOfWheels(4)),
    "small wheels": c2d.robots.engineer(flippers=None, track=c2d.CircumferentialWheels(16)),
    "belt": c2d.robots.engineer(flippers=None),
    "belt and flippers": with_flippers(c2d.BeltTrack()),
    "absolem": c2d.robots.absolem(track="public"),
}


def driven(mujoco: Any, robot: c2d.Robot) -> Iterator[np.ndarray]:
    """Drive on level ground at a fraction of the largest speed; yield the position at each step."""
    root = ElementTree.fromstring(robot.to_mjcf().encode())
    world = root.find("worldbody")
    assert world is not None
    world.append(ElementTree.Element("geom", type="plane", size="50 50 1"))
    model = mujoco.MjModel.from_xml_string(ElementTree.tostring(root, encoding="unicode"))
    data = mujoco.MjData(model)
    for number in range(model.nu):
        if model.actuator_dyntype[number] == mujoco.mjtDyn.mjDYN_NONE:  # a wheel
            data.ctrl[number] = SHARE * model.actuator_ctrlrange[number, 1]
    model.geom_surfacevel *= SHARE
    while data.time < SECONDS:
        mujoco.mj_step(model, data)
        yield data.qpos[:3].copy()
    assert not any(warning.number for warning in data.warning)


@pytest.mark.parametrize("robot", DRIVEN.values(), ids=DRIVEN)
def test_it_drives_forward_at_the_commanded_speed_in_mujoco(robot: c2d.Robot) -> None:
    places = np.array(list(driven(engine("mujoco"), robot)))
    speed = SHARE * robot.drivetrain.max_speed
    later = places[len(places) // 2 :]
    found = (later[-1, 0] - later[0, 0]) / (SECONDS * (len(later) - 1) / len(places))
    assert found == pytest.approx(speed, rel=0.01)
    assert abs(places[:, 1]).max() < 0.01 * places[-1, 0]
    assert np.ptp(places[:, 2]) < 0.01  # [m] nothing jumps or sinks


def test_gear_wheels_drive_forward_in_mujoco() -> None:
    """On their grousers, which roll on a polygon: a little slower than the circle."""
    robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(3, wheel=c2d.GearWheel()))
    robot = robot.without_rotors()  # which take more of the time to reach their speed
    places = np.array(list(driven(engine("mujoco"), robot)))
    assert 0.9 < places[-1, 0] / (SECONDS * SHARE * robot.drivetrain.max_speed) < 1.0


def test_it_drives_forward_at_the_commanded_speed_in_bullet(tmp_path: Path) -> None:
    bullet = engine("pybullet")
    robot = DRIVEN["round wheels"]
    path, speed = tmp_path / "robot.urdf", SHARE * robot.drivetrain.max_speed
    robot.to_urdf(path)
    client = bullet.connect(bullet.DIRECT)
    try:
        bullet.setGravity(0.0, 0.0, -9.81)
        ground = bullet.createCollisionShape(bullet.GEOM_PLANE)
        floor = bullet.createMultiBody(0.0, ground)
        bullet.changeDynamics(floor, -1, lateralFriction=1.0)
        radius = robot.outline.rear_radius
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        body = bullet.loadURDF(str(path), basePosition=[0.0, 0.0, radius], flags=flags)
        for joint in range(bullet.getNumJoints(body)):
            effort = bullet.getJointInfo(body, joint)[10]
            bullet.setJointMotorControl2(
                body,
                joint,
                bullet.VELOCITY_CONTROL,
                targetVelocity=speed / radius,
                force=effort,
            )
        places = []
        for _ in range(480):  # steps of 1/240 s
            bullet.stepSimulation()
            places.append(bullet.getBasePositionAndOrientation(body)[0])
        later = np.array(places)[240:]
        assert later[-1, 0] - later[0, 0] == pytest.approx(speed * 239.0 / 240.0, rel=0.02)
        assert abs(later[:, 1]).max() < 0.01
    finally:
        bullet.disconnect(client)
