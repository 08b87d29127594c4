"""Write a robot as a model file: the one door for all formats."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.common.ends import discs_in, ends_of
from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Pose
from crawler2d.models.tree import Tree
from crawler2d.writing.across import Across, across_of
from crawler2d.writing.held import Format
from crawler2d.writing.mjcf import MJCF, mjcf_of
from crawler2d.writing.model import model_of
from crawler2d.writing.motors import Limits
from crawler2d.writing.sdf import SDF, sdf_of
from crawler2d.writing.solids import lowest
from crawler2d.writing.urdf import URDF, urdf_of
from crawler2d.writing.xml import XML, commented, document

__all__ = ["Model", "ModelText", "Name", "modelled", "placed_model", "stored", "written"]

Name = Literal["sdf", "urdf", "mjcf"]

_WRITERS: dict[Name, tuple[Format, Callable[[Model, Pose], XML]]] = {
    "sdf": (SDF, lambda model, stand: sdf_of(model.tree, model.across, model.limits, stand)),
    "urdf": (URDF, lambda model, _: urdf_of(model.tree)),
    "mjcf": (MJCF, lambda model, stand: mjcf_of(model.tree, stand)),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """A robot in three dimensions, in no format yet.

    Parameters
    ----------
    tree : Tree
        Its links and joints.
    across : Across
        Widths and lateral places.
    limits : Limits
        What its motors can do together.
    comment : str
        Where a file of it comes from, and what in it is not from the robot.
    """

    tree: Tree
    across: Across
    limits: Limits
    comment: str


class ModelText(str):
    """The text of a model file: any string, but that a console shows what it is, and not all of it.

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
        """Write the short form."""
        return f"<model file, {len(self)} characters; print it to see them>"


def modelled(
    text: str,
    name: Name,
    *,
    friction: float,
    track_width: float | None,
    chassis_width: float | None,
) -> Model:
    """Make a model of the robot of a scenario.

    Parameters
    ----------
    text : str
        The scenario in JSON, with the robot on level ground.
    name : {"sdf", "urdf", "mjcf"}
        The format, which must be able to hold it.
    friction, track_width, chassis_width
        See `Robot.to_sdf`.
    """
    robot: dict[str, Any] = json.loads(_core.canonical(text))["robot"]
    across = across_of(float(robot["gauge"]), track_width, chassis_width)
    friction = real_number(friction, "friction")
    if not 0.0 <= friction <= 1e3:
        raise ScenarioError("friction", friction, "must be between 0 and 1000")
    tree = model_of(robot, text, across, friction=friction, form=_WRITERS[name][0])
    comment = _comment(robot, across, friction, _left_out(robot, tree, _WRITERS[name][0]))
    return Model(tree=tree, across=across, limits=_limits(robot), comment=comment)


def placed_model(model: Model, name: Name, stand: Pose) -> XML:
    """Write a model in a format, its chassis frame where it stands."""
    return _WRITERS[name][1](model, stand)


def written(
    text: str,
    name: Name,
    path: str | os.PathLike[str] | None,
    *,
    friction: float,
    track_width: float | None,
    chassis_width: float | None,
) -> ModelText:
    """Write the robot of a scenario; see `Robot.to_sdf`.

    Parameters
    ----------
    text, name, friction, track_width, chassis_width
        See `modelled`.
    path : path or None
        Where to write the text, too.
    """
    model = modelled(
        text, name, friction=friction, track_width=track_width, chassis_width=chassis_width
    )
    stand = Pose(place=np.array([0.0, 0.0, -lowest(model.tree)]))
    return stored(placed_model(model, name, stand), model.comment, path)


def stored(root: XML, comment: str, path: str | os.PathLike[str] | None) -> ModelText:
    """Write a file, and return its text."""
    made = ModelText(document(root, comment))
    if path is not None:
        Path(path).write_text(made, encoding="utf-8")
    return made


def _limits(robot: dict[str, Any]) -> Limits:
    drivetrain, ends = robot["drivetrain"], ends_of(discs_in(robot["outline"]))
    return Limits(
        speed=float(drivetrain["max_speed"]),
        acceleration=float(drivetrain["max_acceleration"]),
        deceleration=float(drivetrain["max_deceleration"]),
        track_height=2.0 * max(radius for _, _, radius in ends),
    )


def _left_out(robot: dict[str, Any], tree: Tree, form: Format) -> list[str]:
    """Return what the file cannot hold of the motors, such as rotors of belts, without joints."""
    has_motors = form.has_rotors and any(joint.is_unlimited for joint in tree.joints.values())
    drivetrain, flippers = robot["drivetrain"], robot["flippers"] or {}
    is_held = {
        "drivetrain.rotor_inertia": has_motors,
        "drivetrain.no_load_speed": False,
        "drivetrain.torque_curve": False,
        "drivetrain.controller": has_motors,
        "drivetrain.controller.integral": False,
        "drivetrain.self_locking": False,
        "flippers.rotor_inertia": form.has_rotors,
        "flippers.self_locking": False,
    }
    given = {f"drivetrain.{name}": value for name, value in drivetrain.items()}
    given |= {f"flippers.{name}": value for name, value in flippers.items()}
    given["drivetrain.controller.integral"] = (drivetrain.get("controller") or {}).get("integral")
    names = [name for name, held in is_held.items() if given.get(name) and not held]
    return [f"Left out, for {form.name} has no place for it: {', '.join(names)}."] if names else []


def _comment(robot: dict[str, Any], across: Across, friction: float, left_out: list[str]) -> str:
    """Return where the file comes from, and what in it is not from the robot."""
    return "\n".join(
        [
            f"Written by crawler2d {_core.build_info()['version']}. Not from the robot:",
            f"friction {friction:g} of all surfaces; widths of track {across.track_width:g} m,",
            f"chassis {across.chassis_width:g} m and flippers {across.flipper_width:g} m;",
            "moments of inertia about x and z; masses of single wheels, shares of their motors;",
            "limits of half a turn for flippers.",
            *left_out,
            f"The robot: {commented(robot)}",
        ]
    )
