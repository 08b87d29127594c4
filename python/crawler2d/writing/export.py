"""Write a robot as a model file: the one door for all formats."""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.common.ends import discs_in, ends_of
from crawler2d.errors import ScenarioError
from crawler2d.models.tree import Tree
from crawler2d.writing.across import Across, across_of
from crawler2d.writing.held import Format
from crawler2d.writing.mjcf import MJCF, mjcf_of
from crawler2d.writing.model import model_of
from crawler2d.writing.motors import Limits
from crawler2d.writing.sdf import SDF, sdf_of
from crawler2d.writing.urdf import URDF, urdf_of
from crawler2d.writing.xml import XML, commented, document

__all__ = ["ModelText", "Name", "written"]

Name = Literal["sdf", "urdf", "mjcf"]

_WRITERS: dict[Name, tuple[Format, Callable[[Tree, Across, Limits], XML]]] = {
    "sdf": (SDF, sdf_of),
    "urdf": (URDF, lambda tree, *_: urdf_of(tree)),
    "mjcf": (MJCF, lambda tree, *_: mjcf_of(tree)),
}


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
    text : str
        The scenario in JSON, with the robot on level ground.
    name : {"sdf", "urdf", "mjcf"}
        The format.
    path : path or None
        Where to write the text, too.
    friction, track_width, chassis_width
        See `Robot.to_sdf`.
    """
    robot: dict[str, Any] = json.loads(_core.canonical(text))["robot"]
    across = across_of(float(robot["gauge"]), track_width, chassis_width)
    friction = real_number(friction, "friction")
    if not 0.0 <= friction <= 1e3:
        raise ScenarioError("friction", friction, "must be between 0 and 1000")
    form, write = _WRITERS[name]
    tree = model_of(robot, text, across, friction=friction, form=form)
    made = ModelText(
        document(write(tree, across, _limits(robot)), _comment(robot, across, friction))
    )
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


def _comment(robot: dict[str, Any], across: Across, friction: float) -> str:
    """Return where the file comes from, and what in it is not from the robot."""
    return "\n".join(
        [
            f"Written by crawler2d {_core.build_info()['version']}. Not from the robot:",
            f"friction {friction:g} of all surfaces; widths of track {across.track_width:g} m,",
            f"chassis {across.chassis_width:g} m and flippers {across.flipper_width:g} m;",
            "moments of inertia about x and z; masses of single wheels, shares of their motors;",
            "limits of half a turn for flippers.",
            f"The robot: {commented(robot)}",
        ]
    )
