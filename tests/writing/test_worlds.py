"""Worlds of a robot at an obstacle: the ground is the terrain, and MuJoCo drives over it."""

import dataclasses
import importlib
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.model_tree import from_rpy
from crawler2d.parameters.scenario import Scenario
from tests.shared import refused, with_flippers

WHEELS = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
RAMP = c2d.terrains.ramp(0.3)
WET = c2d.terrains.from_points([(-3, 0), (0, 0), (3, 0)], goal=1.0, segment_friction=[0.9, 0.2])
TERRAINS: dict[str, Any] = {
    "flat": c2d.terrains.flat(),
    "step": c2d.terrains.step(0.05, friction=0.6),
    "rounded step": c2d.terrains.step(0.05, edge_radius=0.02),
    "drop": c2d.terrains.from_points([(-3.0, 0.2), (0.0, 0.2), (0.0, 0.0), (3.0, 0.0)], goal=1.0),
    "ramp": RAMP,
    "barrier": c2d.terrains.barrier(0.05, 0.1),
    "ridge": c2d.terrains.ridge(0.05, 1.0),
    "gap": c2d.terrains.gap(0.1),
    "stairs": c2d.terrains.stairs(),
    "half round": c2d.terrains.half_round(0.04),
    "diagonal barrier": c2d.terrains.diagonal_barrier(0.5),
    "step field": c2d.terrains.random_stepfield(3),
    "lanes": c2d.terrains.lanes(
        c2d.terrains.gap(0.1, friction=0.5), c2d.terrains.step(0.05, friction=0.7)
    ),
}
ALL = pytest.mark.parametrize("terrain", TERRAINS.values(), ids=TERRAINS)


def world(folder: Path, robot: c2d.Robot, terrain: Any) -> ElementTree.Element:
    path = folder / "world.sdf"
    text = robot.to_world(path, terrain)
    assert path.read_text("utf-8") == text
    found = ElementTree.fromstring(text.encode()).find("world")
    assert found is not None
    return found


def values(element: ElementTree.Element, path: str) -> list[float]:
    text = element.findtext(path)
    assert text is not None
    return [float(word) for word in text.split()]


def pieces(
    world: ElementTree.Element,
) -> tuple[float, list[tuple[np.ndarray, tuple[float, float], float]]]:
    """[m, -] Height of the plane; outline, sides and friction of each piece, as defined by SDF."""
    level, found = None, []
    for collision in world.iterfind("model/link[@name='ground']/collision"):
        x, y, z, *angles = values(collision, "pose")
        friction = values(collision, "surface/friction/ode/mu")[0]
        if collision.find("geometry/plane") is not None:
            level = z
        elif collision.find("geometry/box") is not None:
            assert not any(angles)
            length, width, height = values(collision, "geometry/box/size")
            half = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) * (0.5 * length, 0.5 * height)
            found.append((half + np.array([x, z]), (y - 0.5 * width, y + 0.5 * width), friction))
        else:
            drawn = collision.findall("geometry/polyline/point")
            flat = np.array([[float(word) for word in str(each.text).split()] for each in drawn])
            (height,) = values(collision, "geometry/polyline/height")
            pose = from_rpy(angles, (x, y, z))
            ends = [
                pose.at(np.column_stack([flat, np.full(len(flat), way)])) for way in (0.0, height)
            ]
            assert np.allclose(ends[0][:, [0, 2]], ends[1][:, [0, 2]], rtol=0, atol=1e-9)
            sides = sorted(float(end[0, 1]) for end in ends)
            found.append((ends[0][:, [0, 2]], (sides[0], sides[1]), friction))
    assert level is not None
    return level, found


def top_of(outline: np.ndarray, x: float) -> float:
    """[m] The highest point of a convex polygon at a position; -inf beside it."""
    heights = []
    for (x0, y0), (x1, y1) in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        if min(x0, x1) <= x <= max(x0, x1):
            heights.append(max(y0, y1) if x0 == x1 else y0 + (y1 - y0) * (x - x0) / (x1 - x0))
    return max(heights, default=-np.inf)


@ALL
def test_the_ground_of_a_world_is_the_profile_of_the_terrain(tmp_path: Path, terrain: Any) -> None:
    level, found = pieces(world(tmp_path, WHEELS, terrain))
    half = 0.5 * WHEELS.gauge
    for lane, points in _core.geometry(Scenario(WHEELS, terrain).to_json())["lanes"]:
        y = {0: half, 1: half, 2: -half, 3: 0.0}[lane]
        here = [outline for outline, (right, left), _ in found if right < y < left]
        # Beside corners, where a vertical face has two heights.
        for x in np.linspace(-1.0, 2.0, 301) + 1.234e-5:
            top = max([level, *(top_of(outline, x) for outline in here)])
            assert top == pytest.approx(np.interp(x, *points.T), abs=2e-9)


@ALL
def test_the_pieces_are_convex_and_the_obstacle_is_wider_than_the_robot(
    tmp_path: Path, terrain: Any
) -> None:
    _, found = pieces(world(tmp_path, WHEELS, terrain))
    for outline, _, _ in found:
        to = outline - np.roll(outline, 1, axis=0)
        on = np.roll(to, -1, axis=0)
        assert (to[:, 0] * on[:, 1] - to[:, 1] * on[:, 0] > 0.0).all()
    if found:
        width = 1.25 * WHEELS.gauge  # with a track on either side
        assert min(right for _, (right, _), _ in found) == pytest.approx(-width)
        assert max(left for _, (_, left), _ in found) == pytest.approx(width)


@ALL
def test_the_robot_is_read_back_from_a_world(tmp_path: Path, terrain: Any) -> None:
    world(tmp_path, WHEELS, terrain)
    WHEELS.to_sdf(tmp_path / "robot.sdf")
    alone, there = (
        c2d.read_robot(tmp_path / f"{name}.sdf", model=model)
        for name, model in (("robot", None), ("world", WHEELS.name))
    )
    assert there.robot == alone.robot
    assert there.friction == getattr(terrain, "friction", 0.7)


@pytest.mark.parametrize("name", ["sun", "ground", "sun_sun", "crawler2d"])
def test_no_two_parts_of_a_world_have_one_name(tmp_path: Path, name: str) -> None:
    found = world(tmp_path, dataclasses.replace(WHEELS, name=name), TERRAINS["step"])
    names = [part.get("name") for part in found if part.get("name") is not None]
    assert len(set(names)) == len(names) == 3


def test_each_lane_has_its_own_friction(tmp_path: Path) -> None:
    _, found = pieces(world(tmp_path, WHEELS, TERRAINS["lanes"]))
    assert {friction for _, (right, left), friction in found if right > 0.0 < left} == {0.5}
    assert {friction for _, (right, left), friction in found if right < 0.0 > left} == {0.7}


def test_a_lane_on_the_level_of_the_plane_has_its_own_friction(tmp_path: Path) -> None:
    level = c2d.terrains.flat(friction=0.2)
    terrain = c2d.terrains.lanes(level, c2d.terrains.step(0.05, friction=0.7))
    for robot in ROBOTS.values():
        mujoco, model, data = scene(tmp_path, robot, terrain)
        found = set()
        for _ in range(20):
            mujoco.mj_step(model, data)
            for contact in data.contact:
                names = "".join(model.geom(each).name for each in contact.geom)
                found.add(("left" in names, round(contact.friction[0], 9)))
        assert found == {(True, 0.2), (False, 0.7)}
    height, parts = pieces(world(tmp_path, WHEELS, terrain))
    assert height < -0.01
    assert {friction for _, (right, left), friction in parts if right > 0.0 < left} == {0.2}


def test_the_robot_stands_where_a_scenario_starts_it(tmp_path: Path) -> None:
    outline = dataclasses.replace(WHEELS.outline, front_radius=0.08)
    robot = dataclasses.replace(WHEELS, outline=outline, track=c2d.BeltTrack())
    assert Scenario(robot, TERRAINS["step"]).start.angle == 0.0
    there = values(world(tmp_path, robot, TERRAINS["step"]), f"model[@name='{robot.name}']/pose")
    start = c2d.simulate(robot, TERRAINS["step"], duration=0.01)
    x, z = start.position[0]
    assert there == pytest.approx([x, 0.0, z, 0.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize(
    ("path", "terrain", "field"),
    [
        ("world.urdf", RAMP, "path"),
        ("world", RAMP, "path"),
        ("world.sdf", 0.1, "terrain"),
        ("world.sdf", c2d.terrains.step(-0.1), "terrain.height"),
        ("world.sdf", WET, "terrain.segment_friction"),
        ("world.xml", c2d.terrains.lanes(RAMP, WET), "terrain.right.segment_friction"),
    ],
)
def test_a_world_that_cannot_be_written_is_refused(
    tmp_path: Path, path: str, terrain: Any, field: str
) -> None:
    assert refused(lambda: WHEELS.to_world(tmp_path / path, terrain)).path == field
    assert not list(tmp_path.iterdir())


def scene(folder: Path, robot: c2d.Robot, terrain: Any) -> tuple[Any, Any, Any]:
    """MuJoCo with a scene before its first step."""
    pytest.importorskip("mujoco")
    mujoco = importlib.import_module("mujoco")
    path = folder / "scene.xml"
    robot.to_world(path, terrain)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return mujoco, model, data


ROBOTS = {
    "wheels": WHEELS,
    "belt": c2d.robots.engineer(flippers=None),
    "flippers": with_flippers(c2d.LineOfWheels(4)),
}


@pytest.mark.parametrize(
    ("robot", "terrain"),
    [
        pytest.param(
            robot,
            terrain,
            # The ground does not depend on the robot: the others meet an edge and a slope.
            marks=() if robot == "wheels" or terrain in ("step", "ramp") else pytest.mark.soak,
        )
        for robot in ROBOTS
        for terrain in TERRAINS
    ],
)
def test_the_robot_stands_on_the_ground_and_not_in_it(
    tmp_path: Path, robot: str, terrain: str, capfd: pytest.CaptureFixture[str]
) -> None:
    mujoco, model, data = scene(tmp_path, ROBOTS[robot], TERRAINS[terrain])
    assert capfd.readouterr() == ("", "")
    assert (data.contact.dist > -1e-6).all()
    height, touching = data.qpos[2], 0
    for _ in range(20):
        mujoco.mj_step(model, data)
        touching += data.ncon > 0
    assert touching > 0
    assert data.qpos[2] == pytest.approx(height, abs=2e-3)  # belts start at full speed: they hop


def driven(folder: Path, terrain: Any, seconds: float = 3.0) -> Any:
    """[m] Final position of the chassis of the robot on wheels."""
    mujoco, model, data = scene(folder, WHEELS, terrain)
    data.ctrl[:] = 0.5 * model.actuator_ctrlrange[:, 1]
    start = data.qpos[:3].copy()
    while data.time < seconds:
        mujoco.mj_step(model, data)
    assert np.abs(data.qvel[6:]).max() > 1.0  # wheels turn
    return data.qpos[:3] - start


def test_its_motors_drive_the_robot_onto_a_low_step(tmp_path: Path) -> None:
    x, y, z = driven(tmp_path, c2d.terrains.step(0.03))
    assert x > 0.8
    assert abs(y) < 0.1
    assert z == pytest.approx(0.03, abs=2e-3)


def test_a_wall_stops_the_robot(tmp_path: Path) -> None:
    x, _, z = driven(tmp_path, c2d.terrains.step(0.5, friction=0.3))
    # The front of the track begins 0.1 m before the wall.
    assert x == pytest.approx(0.1, abs=5e-3)
    assert abs(z) < 5e-3


def test_the_friction_of_the_terrain_holds_in_mujoco(tmp_path: Path) -> None:
    _, model, data = scene(tmp_path, WHEELS, c2d.terrains.step(0.05, friction=0.4))
    assert data.contact.friction[:, 0] == pytest.approx(0.4)
    assert model.opt.gravity[2] == -9.81


def test_a_scene_of_mujoco_has_the_robot_that_is_read_back(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    robots = []
    WHEELS.to_world(tmp_path / "scene.xml", RAMP)
    WHEELS.to_mjcf(tmp_path / "robot.xml")
    robots = [c2d.read_robot(tmp_path / f"{name}.xml").robot for name in ("scene", "robot")]
    assert robots[0] == dataclasses.replace(robots[1], name=robots[0].name)
