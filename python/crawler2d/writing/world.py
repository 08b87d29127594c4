"""A robot before an obstacle as a world of its own: SDF for Gazebo, MJCF for MuJoCo."""

from __future__ import annotations

import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from crawler2d import _core
from crawler2d.common.bodies import Lane
from crawler2d.drawings.scene import Scene, at_start
from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Pose, from_rpy
from crawler2d.models.tree import Friction
from crawler2d.writing.export import ModelText, Name, modelled, placed_model, stored
from crawler2d.writing.ground import Ground, Piece, ground_of
from crawler2d.writing.sdf import pose_text, surface
from crawler2d.writing.solids import in_space
from crawler2d.writing.xml import XML, element, numbers

__all__ = ["written_world"]

_FORMATS: dict[str, Name] = {".sdf": "sdf", ".world": "sdf", ".xml": "mjcf"}

# In lengths of the robot: what is seen of the ground behind its start and beyond the goal.
_BEHIND, _BEYOND = 2.0, 4.0
_PLANE = 100.0  # [m] How much of an endless plane is drawn.


def written_world(
    text: str,
    alone: str,
    path: str | os.PathLike[str],
    *,
    track_width: float | None,
    chassis_width: float | None,
) -> ModelText:
    """Write the robot of a scenario where it starts; see `Robot.to_world`.

    Parameters
    ----------
    text : str
        The scenario in JSON.
    alone : str
        The same robot in JSON, on level ground.
    path : path
        The file, whose suffix says in which format.
    track_width, chassis_width
        See `Robot.to_world`.
    """
    name = _FORMATS.get(Path(path).suffix.lower())
    if name is None:
        raise ScenarioError("path", os.fspath(path), "must end in .sdf, .world or .xml")
    scene = Scene(text, at_start(text))
    frictions = _frictions(json.loads(text)["terrain"])
    model = modelled(
        alone,
        name,
        friction=max(frictions.values()),
        track_width=track_width,
        chassis_width=chassis_width,
    )
    left, right, _, _ = scene.extent()
    length = right - left
    ends = (left - _BEHIND * length, max(right, scene.goal) + _BEYOND * length)
    ground = ground_of(_core.geometry(text)["lanes"], frictions, model.across, ends)
    # A start is level unless it says otherwise.
    stand = Pose(place=in_space(scene.carriers[0].poses[0], 0.0))
    root = placed_model(model, name, stand)
    add = _add_to_mjcf if name == "mjcf" else _into_world
    return stored(add(root, ground, json.loads(text)["gravity"]), model.comment, path)


def _frictions(terrain: dict[str, Any]) -> dict[int, float]:
    """[-] Return the friction of each lane."""
    if terrain["kind"] != "lanes":
        return dict.fromkeys(Lane, float(terrain["friction"]))
    left, right = (float(terrain[side]["friction"]) for side in ("left", "right"))
    middle = terrain["middle"]
    under = max(left, right) if middle is None else float(middle["friction"])
    return {Lane.BOTH: left, Lane.LEFT: left, Lane.RIGHT: right, Lane.MIDDLE: under}


def _placed(piece: Piece) -> tuple[Pose, np.ndarray[Any, Any]]:
    """Return the middle of a piece in the world, and its corners about that."""
    middle = 0.5 * (piece.corners.min(axis=0) + piece.corners.max(axis=0))
    x, z = middle
    return Pose(place=np.array([x, piece.across, z])), piece.corners - middle


def _into_world(root: XML, ground: Ground, gravity: float) -> XML:
    """Put the model of an SDF file into a world with a ground and light."""
    (model,) = root
    # The model may have any name but this one.
    static = element("model", element("static", text="true"), name=f"{model.get('name')}_ground")
    link = element("link", name="ground")
    static.append(link)
    plane = element(
        "plane",
        element("normal", text="0 0 1"),
        element("size", text=numbers((_PLANE, _PLANE))),
    )
    shapes = [(Pose(place=np.array([0.0, 0.0, ground.level])), plane, ground.friction)]
    shapes += [(*_sdf_shape(piece), piece.friction) for piece in ground.pieces]
    for number, (pose, shape, friction) in enumerate(shapes):
        for tag in ("collision", "visual"):
            made = element(
                tag,
                element("pose", text=pose_text(pose)),
                element("geometry", shape),
                name=f"ground_{number}_{tag}",
            )
            if tag == "collision":
                made.append(surface(Friction(first=friction, second=friction)))
            link.append(made)
    sun = element(
        "light",
        element("pose", text="0 0 10 0 0 0"),
        element("direction", text="-0.3 0.4 -0.9"),
        name="sun",
        type="directional",
    )
    down = element("gravity", text=numbers((0.0, 0.0, -gravity)))
    root[:] = [element("world", down, sun, static, model, name="crawler2d")]
    return root


def _sdf_shape(piece: Piece) -> tuple[Pose, XML]:
    """Return a box, or a polygon that is drawn out along its own z, which is to the right."""
    pose, corners = _placed(piece)
    if piece.is_box:
        size = (np.ptp(corners[:, 0]), piece.width, np.ptp(corners[:, 1]))
        return pose, element("box", element("size", text=numbers(size)))
    x, y, z = pose.place.tolist()
    turned = from_rpy((0.5 * math.pi, 0.0, 0.0), (x, y + 0.5 * piece.width, z))
    points = (element("point", text=numbers(corner)) for corner in corners)
    return turned, element("polyline", *points, element("height", text=numbers(piece.width)))


def _add_to_mjcf(root: XML, ground: Ground, gravity: float) -> XML:
    """Put a ground into an MJCF file."""
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
        # With the higher priority its own friction holds, whatever the robot has.
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
