"""Export a robot as a model file, or with its obstacle as a world for Gazebo or MuJoCo."""

from __future__ import annotations

import itertools
import json
import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.common.bodies import Lane, discs_in, end_discs
from crawler2d.common.files import write_text
from crawler2d.drawings.scene import Scene, profile_between
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Friction, Pose, Tree, from_rpy
from crawler2d.writing.carriers import Across, Format, across_of
from crawler2d.writing.formats import (
    MJCF,
    SDF,
    URDF,
    XML,
    commented,
    document,
    element,
    mjcf_of,
    numbers,
    pose_text,
    sdf_of,
    surface,
    texts,
    urdf_of,
)
from crawler2d.writing.model import CHASSIS, Limits, model_of
from crawler2d.writing.shapes import in_space, lowest

__all__ = ["export_robot", "export_world"]

Name = Literal["sdf", "urdf", "mjcf"]

_WRITERS: dict[Name, tuple[Format, Callable[[Model, Pose], XML]]] = {
    "sdf": (SDF, lambda model, stand: sdf_of(model.tree, model.across, model.limits, stand)),
    "urdf": (URDF, lambda model, _: urdf_of(model.tree)),
    "mjcf": (MJCF, lambda model, stand: mjcf_of(model.tree, stand)),
}

# Twice the robot's width: the robot may drift without falling off the obstacle.
_WIDTH = 2.0  # gauges and track widths

_FLAT = 1e-9  # [m] Heights that differ by less are equal.
_FORMATS: dict[str, Name] = {".sdf": "sdf", ".world": "sdf", ".xml": "mjcf"}

# Visible ground behind the start and beyond the goal, in lengths of the robot.
_BEHIND, _BEYOND = 2.0, 4.0

# In track widths: how far the ground of a track extends inwards of it. Exactly at its rim, the
# track would stand on two pieces.
_BESIDE = 0.1

_BELOW = 0.1  # In gauges: depth of the plane below lanes with different friction.

_PLANE = 100.0  # [m] Visible size of an endless plane.


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """A three-dimensional robot, independent of a format.

    Parameters
    ----------
    tree : Tree
        Its links and joints.
    across : Across
        Widths and lateral positions.
    limits : Limits
        Total limits of the motors.
    comment : str
        Comment for the file: its origin, and values that are not from the robot.
    """

    tree: Tree
    across: Across
    limits: Limits
    comment: str


class ModelText(str):
    """The text of a model file: a string with a short form in consoles.

    Examples
    --------
    >>> text = ModelText("<robot></robot>")
    >>> text
    <model file, 15 characters; print it to see them>
    >>> print(text)
    <robot></robot>
    """

    __slots__ = ()

    def __repr__(self) -> str:
        """Return the short form."""
        return f"<model file, {len(self)} characters; print it to see them>"


@dataclass(frozen=True, slots=True, kw_only=True)
class Piece:
    """A convex prism that extends laterally.

    Parameters
    ----------
    corners : ndarray, shape (n, 2)
        [m] Its outline in side view, counter-clockwise, x forward and y up.
    across, width : float
        [m] Lateral position of its middle, positive to the left, and its width.
    friction : float
        [-] Coefficient of friction of its surface.
    """

    corners: Array
    across: float
    width: float
    friction: float

    @property
    def is_box(self) -> bool:
        """Whether it is a rectangle with level and upright sides."""
        sides = np.abs(np.diff(self.corners, axis=0, append=self.corners[:1]))
        return len(self.corners) == 4 and bool((sides.min(axis=1) < _FLAT).all())


@dataclass(frozen=True, slots=True, kw_only=True)
class Ground:
    """The ground of a robot.

    Parameters
    ----------
    level : float
        [m] Height of a plane at or below the lowest ground.
    friction : float
        [-] Coefficient of friction of the plane.
    pieces : tuple of Piece
        The obstacles on it.
    """

    level: float
    friction: float
    pieces: tuple[Piece, ...]


def export_robot(
    text: str,
    name: Name,
    path: str | os.PathLike[str] | None,
    *,
    friction: float,
    track_width: float | None,
    chassis_width: float | None,
) -> ModelText:
    """Write the robot of a scenario in JSON, on level ground, in a format; see `Robot.to_sdf`."""
    model = _build_model(text, name, friction, (track_width, chassis_width))
    stand = Pose(place=np.array([0.0, 0.0, -lowest(model.tree)]))
    return _save(_WRITERS[name][1](model, stand), model.comment, path)


def export_world(
    text: str,
    alone: str,
    path: str | os.PathLike[str],
    *,
    track_width: float | None,
    chassis_width: float | None,
) -> ModelText:
    """Write the robot of a scenario at its start; see `Robot.to_world`.

    Parameters
    ----------
    text : str
        The scenario in JSON.
    alone : str
        The same robot in JSON, on level ground.
    path : path
        The file, whose suffix selects the format.
    track_width, chassis_width
        See `Robot.to_world`.
    """
    name = _FORMATS.get(Path(path).suffix.lower())
    if name is None:
        raise ScenarioError("path", os.fspath(path), "must end in .sdf, .world or .xml")
    scene, geometry = Scene.at_start(text), _core.geometry(text)
    lanes = list(zip(geometry["lanes"], geometry["frictions"], strict=True))
    widths = track_width, chassis_width
    model = _build_model(alone, name, max(geometry["frictions"]), widths)
    _refuse_segments(json.loads(text)["terrain"])
    left, right, _, _ = scene.extent()
    length = right - left
    ends = (left - _BEHIND * length, max(right, scene.goal) + _BEYOND * length)
    ground = _ground_of(lanes, model.across, ends)
    # The start is level unless it has an angle.
    stand = Pose(place=in_space(scene.carriers[0].poses[0], 0.0))
    root = _WRITERS[name][1](model, stand)
    add_ground = _add_to_mjcf if name == "mjcf" else _add_to_sdf
    return _save(add_ground(root, ground, json.loads(text)["gravity"]), model.comment, path)


def _build_model(
    text: str, name: Name, friction: float, widths: tuple[float | None, float | None]
) -> Model:
    """Build a model of the robot of a scenario, with widths of track and chassis.

    Parameters
    ----------
    text : str
        The scenario in JSON, with the robot on level ground.
    name : {"sdf", "urdf", "mjcf"}
        The format, which must be able to represent the robot.
    friction, widths
        See `Robot.to_sdf`.
    """
    robot: dict[str, Any] = json.loads(_core.canonical(text))["robot"]
    across = across_of(float(robot["gauge"]), *widths)
    friction = real_number(friction, "friction")
    if not 0.0 <= friction <= 1e3:
        raise ScenarioError("friction", friction, "must be between 0 and 1000")
    target = _WRITERS[name][0]
    tree = model_of(robot, text, across, friction=friction, target=target)
    drivetrain, ends = robot["drivetrain"], end_discs(discs_in(robot["outline"]))
    limits = Limits(
        speed=float(drivetrain["max_speed"]),
        acceleration=float(drivetrain["max_acceleration"]),
        deceleration=float(drivetrain["max_deceleration"]),
        track_height=2.0 * max(radius for _, _, radius in ends),
    )
    comment = [
        f"Written by crawler2d {_core.build_info()['version']}. Not from the robot:",
        f"friction {friction:g} of all surfaces; widths of track {across.track_width:g} m,",
        f"chassis {across.chassis_width:g} m and flippers {across.flipper_width:g} m;",
        "moments of inertia about x and z; masses of single wheels, shares of their motors;",
        "limits of half a turn for flippers.",
        *_left_out(robot, tree, target),
        f"The robot: {commented(robot)}",
    ]
    return Model(tree=tree, across=across, limits=limits, comment="\n".join(comment))


def _left_out(robot: dict[str, Any], tree: Tree, target: Format) -> list[str]:
    """List properties of motors that the file cannot represent, such as the torque of belts."""
    wheels = [joint for joint in tree.joints.values() if joint.is_unlimited]
    motors = [joint for joint in wheels if joint.parent == CHASSIS]
    has_motors = target.has_rotors and bool(motors)
    drivetrain, flippers = robot["drivetrain"], robot["flippers"] or {}
    given = {f"drivetrain.{name}": value for name, value in drivetrain.items()}
    given |= {f"flippers.{name}": value for name, value in flippers.items()}
    given["drivetrain.controller.integral"] = (drivetrain.get("controller") or {}).get("integral")
    is_held = {
        "drivetrain.max_torque": bool(motors),
        "drivetrain.rotor_inertia": has_motors and any(joint.armature for joint in motors),
        "drivetrain.no_load_speed": False,
        "drivetrain.torque_curve": False,
        "drivetrain.controller": has_motors,
        "drivetrain.controller.integral": False,
        "drivetrain.self_locking": False,
        "flippers.rotor_inertia": target.has_rotors,
        "flippers.self_locking": False,
    }
    names = [name for name, held in is_held.items() if given.get(name) and not held]
    return [f"Left out, as {target.name} has no place for it: {', '.join(names)}."] if names else []


def _save(root: XML, comment: str, path: str | os.PathLike[str] | None) -> ModelText:
    """Write a file, if there is a path, and return its text."""
    text = ModelText(document(root, comment))
    if path is not None:
        write_text(path, text)
    return text


def _refuse_segments(terrain: dict[str, Any]) -> None:
    """Refuse segments with different friction: all faces of a piece of ground have the same."""
    lanes = {f"terrain.{side}": terrain.get(side) for side in ("left", "right", "middle")}
    for path, lane in {"terrain": terrain, **lanes}.items():
        frictions = (lane or {}).get("segment_friction") or ()
        if len(set(frictions)) > 1:
            rule = "must be equal: a piece of the ground has one friction in a model file"
            raise ScenarioError(f"{path}.segment_friction", frictions, rule)


def _ground_of(
    lanes: list[tuple[tuple[int, Array], float]],
    across: Across,
    ends: tuple[float, float],
) -> Ground:
    """Extrude the profiles of a side view laterally.

    Parameters
    ----------
    lanes : list of tuple
        Lanes from the core, each with its profile [m] and friction [-].
    across : Across
        Widths and lateral positions of the robot.
    ends : tuple of float, shape (2,)
        [m] The range of the profiles; the plane is endless.
    """
    profiles = [(lane, profile_between(points, *ends), each) for (lane, points), each in lanes]
    level = min(float(points[:, 1].min()) for _, points, _ in profiles)
    if len({friction for _, friction in lanes}) > 1:
        level -= _BELOW * across.gauge  # or else the plane's friction would count for a lane there
    half = 0.5 * _WIDTH * (across.gauge + across.track_width)
    inner = 0.5 * (across.gauge - across.track_width)
    inner -= min(_BESIDE * across.track_width, 0.5 * inner)
    strips = {
        Lane.BOTH: (-half, half),
        Lane.LEFT: (inner, half),
        Lane.RIGHT: (-half, -inner),
        Lane.MIDDLE: (-inner, inner),
    }
    pieces = [
        Piece(
            corners=corners,
            across=0.5 * sum(strips[Lane(lane)]),
            width=float(np.ptp(strips[Lane(lane)])),
            friction=friction,
        )
        for lane, points, friction in profiles
        for corners in _convex(points, level)
    ]
    largest = max(friction for _, friction in lanes)
    return Ground(level=level, friction=largest, pieces=tuple(pieces))


def _convex(points: Array, level: float) -> Iterator[Array]:
    """Divide the area between a profile and a level into convex polygons.

    Cuts go vertically down from concave corners of the ground, where tracks cannot touch them.
    """
    ahead = np.diff(points, axis=0)
    turns = ahead[:-1, 0] * ahead[1:, 1] - ahead[:-1, 1] * ahead[1:, 0]
    inner = [0, *(np.flatnonzero(turns > 0.0) + 1).tolist(), len(points) - 1]
    for first, last in itertools.pairwise(inner):
        run = points[first : last + 1]
        if np.ptp(run[:, 0]) < _FLAT or run[:, 1].max() < level + _FLAT:
            continue
        # A piece that begins or ends on the level, or at a wall, already has its foot.
        foot = np.array([[run[0, 0], level], [run[-1, 0], level]])
        yield _corners(np.array([foot[0], foot[1], *run[::-1]]))


def _corners(points: Array) -> Array:
    """Return the corners of a convex polygon, without repeated points and points on its sides."""
    points = points[np.abs(points - np.roll(points, 1, axis=0)).max(axis=1) > _FLAT]
    to, on = points - np.roll(points, 1, axis=0), np.roll(points, -1, axis=0) - points
    turns = to[:, 0] * on[:, 1] - to[:, 1] * on[:, 0]
    corners: Array = points[turns > _FLAT * np.linalg.norm(to, axis=1) * np.linalg.norm(on, axis=1)]
    return corners


def _add_to_mjcf(root: XML, ground: Ground, gravity: float) -> XML:
    """Add the ground to an MJCF file."""
    parts = {part.tag: part for part in root}
    world = parts["worldbody"]
    parts["option"].set("gravity", numbers((0.0, 0.0, -gravity)))
    assets = parts.get("asset")
    if assets is None:
        assets = element("asset")
        root.insert(list(root).index(world), assets)
    plane = {"type": "plane", "size": numbers((0.5 * _PLANE, 0.5 * _PLANE, 1.0))}
    shapes = [({**plane, "pos": numbers((0.0, 0.0, ground.level))}, ground.friction)]
    for number, piece in enumerate(ground.pieces, 1):
        shapes.append((_mjcf_shape(f"ground_{number}", piece, assets), piece.friction))
    for number, (shape, friction) in enumerate(shapes):
        # With the higher priority, its friction counts, whatever the robot has.
        given = {"name": f"ground_{number}", "friction": numbers(friction), "priority": "2"}
        world.insert(number, element("geom", **given, **shape))
    return root


def _mjcf_shape(name: str, piece: Piece, assets: XML) -> dict[str, str]:
    """Return the attributes of a box, or of a convex mesh, whose corners are an asset."""
    pose, corners = _placed(piece)
    half = 0.5 * piece.width
    at = {"pos": numbers(pose.place)}
    if piece.is_box:
        x, z = corners.max(axis=0)
        return {"type": "box", "size": numbers((x, half, z)), **at}
    points = np.array([(x, side, z) for side in (-half, half) for x, z in corners])
    assets.append(element("mesh", name=name, vertex=numbers(points.ravel())))
    return {"type": "mesh", "mesh": name, **at}


def _placed(piece: Piece) -> tuple[Pose, np.ndarray[Any, Any]]:
    """Return the pose of the middle of a piece, and its corners relative to that."""
    middle = 0.5 * (piece.corners.min(axis=0) + piece.corners.max(axis=0))
    x, z = middle
    return Pose(place=np.array([x, piece.across, z])), piece.corners - middle


def _add_to_sdf(root: XML, ground: Ground, gravity: float) -> XML:
    """Put the model of an SDF file into a world with ground and light."""
    (model,) = root
    # The model may not have these names.
    ground_name, sun_name = (f"{model.get('name')}_{part}" for part in ("ground", "sun"))
    static = element("model", *texts(static="true"), name=ground_name)
    link = element("link", name="ground")
    static.append(link)
    plane = element("plane", *texts(normal="0 0 1", size=(_PLANE, _PLANE)))
    shapes = [(Pose(place=np.array([0.0, 0.0, ground.level])), plane, ground.friction)]
    shapes += [(*_sdf_shape(piece), piece.friction) for piece in ground.pieces]
    for number, (pose, shape, friction) in enumerate(shapes):
        for tag in ("collision", "visual"):
            pose_element, geometry = texts(pose=pose_text(pose)), element("geometry", shape)
            part = element(tag, *pose_element, geometry, name=f"ground_{number}_{tag}")
            if tag == "collision":
                part.append(surface(Friction(first=friction, second=friction)))
            link.append(part)
    light = texts(pose="0 0 10 0 0 0", direction="-0.3 0.4 -0.9")
    sun = element("light", *light, name=sun_name, type="directional")
    down = texts(gravity=(0.0, 0.0, -gravity))
    root[:] = [element("world", *down, sun, static, model, name="crawler2d")]
    return root


def _sdf_shape(piece: Piece) -> tuple[Pose, XML]:
    """Return a box, or a polygon extruded along its own z axis, which points to the right."""
    pose, corners = _placed(piece)
    if piece.is_box:
        size = (np.ptp(corners[:, 0]), piece.width, np.ptp(corners[:, 1]))
        return pose, element("box", *texts(size=size))
    x, y, z = pose.place.tolist()
    turned = from_rpy((0.5 * math.pi, 0.0, 0.0), (x, y + 0.5 * piece.width, z))
    points = (element("point", text=numbers(corner)) for corner in corners)
    return turned, element("polyline", *points, *texts(height=piece.width))
