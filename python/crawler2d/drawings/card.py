"""Robots and scenarios in a notebook: a side view beside a table of the figures that matter."""

from __future__ import annotations

import json
import warnings
from typing import Any

from crawler2d.common.ends import discs_in, ends_of, is_short
from crawler2d.common.markup import escaped, table
from crawler2d.drawings.extents import course, robot_box
from crawler2d.drawings.robot_view import robot_alone
from crawler2d.drawings.scene import Scene, at_start
from crawler2d.drawings.svg import svg

__all__ = ["robot_card", "scenario_card"]


def robot_card(text: str, title: str) -> str:
    """Show the robot of a scenario in JSON, in the frame of its chassis.

    Parameters
    ----------
    text : str
        A scenario with the robot on level ground.
    title : str
        What to write over it.

    Returns
    -------
    str
        HTML.

    Raises
    ------
    ScenarioError
        If the robot breaks a rule.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a look at something is no call to be warned of
        scene = robot_alone(text)
    left, right, bottom, top = robot_box(scene)
    margin = 0.02 * (right - left)
    extent = (left - margin, right + margin, bottom - margin, top + margin)
    return _card(title, svg(scene, extent, ground=False), _robot_rows(json.loads(text)["robot"]))


def scenario_card(text: str, title: str, terrain: str) -> str:
    """Show a scenario in JSON, the robot at its start; `terrain` says in words what its ground is.

    The rest is as for `robot_card`.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        scene = Scene(text, at_start(text))
    plain = json.loads(text)
    gait = plain["drive"]["gait"]
    rows = [
        ("terrain", terrain),
        ("friction", _listed({lane["friction"] for lane in _grounds(plain["terrain"])})),
        ("speed", f"{plain['drive']['speed']:.4g} m/s"),
        *([("gait", gait["kind"])] if gait else []),
        ("goal", f"x = {scene.goal:.4g} m"),
        ("duration", f"at most {plain['duration']:.4g} s"),
        ("mass", f"{plain['robot']['mass']:.4g} kg"),
    ]
    return _card(title, svg(scene, course(scene), ground=True), rows)


def _card(title: str, drawing: str, rows: list[tuple[str, str]]) -> str:
    return (
        f"<div><p><strong>{escaped(title)}</strong></p>"
        '<div style="display: flex; flex-wrap: wrap; align-items: center; gap: 1.5em">'
        f"{drawing}{table(rows)}</div></div>"
    )


def _robot_rows(robot: dict[str, Any]) -> list[tuple[str, str]]:
    outline, drivetrain, flippers = robot["outline"], robot["drivetrain"], robot["flippers"]
    x, y = robot["center_of_mass"]
    discs = discs_in(outline)
    (rear, _, _), (front, _, _) = ends_of(discs)
    origin = "midway between the axles" if is_short(discs) else "the origin of the discs"
    rows = [
        ("mass", f"{robot['mass']:.4g} kg, of which tracks {robot['track_mass']:.3g} kg"),
        ("centre of mass", f"({x:.3f}, {y:.3f}) m from {origin}"),
        ("moment of inertia", f"{robot['moment_of_inertia']:.3g} kg m²"),
        ("axle distance", f"{front - rear:.4g} m"),
        ("radius", f"{_listed({radius for _, _, radius in discs})} m"),
    ]
    if outline["grouser_height"] > 0.0:
        height, pitch = outline["grouser_height"], outline["grouser_pitch"]
        rows.append(("grousers", f"{height:.3g} m high, {pitch:.3g} m apart"))
    if flippers:
        ends = {"both": "at both ends"}.get(flippers["ends"], f"at the {flippers['ends']}")
        rows.append(("flippers", f"{flippers['length']:.3g} m long, {ends}"))
    rows.append(("speed", f"up to {drivetrain['max_speed']:.3g} m/s"))
    rows.append(("torque", f"up to {drivetrain['max_torque']:.3g} N m a sprocket"))
    return rows


def _grounds(terrain: dict[str, Any]) -> list[dict[str, Any]]:
    """List what has a friction of its own: the terrain, or its lanes."""
    lanes = [terrain.get(name) for name in ("left", "right")]
    return [lane for lane in lanes if lane] or [terrain]


def _listed(values: set[float]) -> str:
    return " and ".join(f"{value:.4g}" for value in sorted(values))
