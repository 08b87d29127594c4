"""How a model file is read: what its user may decide, checked."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, get_args

from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError
from crawler2d.reading.friction import ENGINES
from crawler2d.reading.meshes import MeshRule

__all__ = ["TOLERANCE", "How"]

TOLERANCE = 0.001
"""[m] By which sides may differ: public models are symmetric to their last digit, CAD exports to
0.1 mm."""


@dataclass(frozen=True, slots=True, kw_only=True)
class How:
    """The keywords of `read_robot`.

    Parameters
    ----------
    engine : str or None
        By whose rules the friction of two surfaces is combined, and motors drive.
    forward : str or None
        Direction of the model that is forward.
    model : str or None
        Name of the model in a world.
    mesh, missing : str
        What to do with meshes, and with what is not there.
    tracks : collection of str
        Links whose surface something outside the file moves.
    ground_friction : float or None
        [-] Coefficient of the ground's own surface.
    tolerance : float
        [m] By how much the two sides may differ in side view.
    scale : float or None
        [-] By which every length of the file is multiplied.
    trusted : bool
        Whether xacro may evaluate expressions of any kind.
    packages : mapping of str to path
        Folders of packages.
    arguments : mapping of str to str
        Values for the arguments of a xacro file.

    Raises
    ------
    ScenarioError
        If one breaks its rule.
    """

    engine: str | None = None
    forward: str | None = None
    model: str | None = None
    mesh: MeshRule = "hull"
    missing: str = "leave_out"
    tracks: Collection[str] = ()
    ground_friction: float | None = None
    tolerance: float = TOLERANCE
    scale: float | None = None
    trusted: bool = False
    packages: Mapping[str, str | os.PathLike[str]] = field(default_factory=dict)
    arguments: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Check what does not need the file."""
        for name, value, allowed in (
            ("engine", self.engine, (None, *ENGINES)),
            ("mesh", self.mesh, get_args(MeshRule)),
            ("missing", self.missing, ("refuse", "leave_out")),
        ):
            if not (value is None or isinstance(value, str)) or value not in allowed:
                rule = f"must be one of {', '.join(str(each) for each in allowed)}"
                raise ScenarioError(name, value, rule)
        _check_pairs(self.packages, "packages", "folders by their names", (str, os.PathLike))
        _check_pairs(self.arguments, "arguments", "texts or numbers by name", (str, int, float))
        _check_between(self.tolerance, "tolerance", 0.0, 0.1)
        if self.scale is not None:
            _check_between(self.scale, "scale", 1e-4, 1e4)
        if self.ground_friction is not None:
            _check_between(self.ground_friction, "ground_friction", 0.0, 1e3)

    @property
    def given(self) -> dict[str, Any]:
        """What differs from the defaults, as `read_robot` takes it; folders as text."""
        usual = How()
        values = {each.name: getattr(self, each.name) for each in fields(self)}
        values["packages"] = {name: str(folder) for name, folder in self.packages.items()}
        return {name: value for name, value in values.items() if value != getattr(usual, name)}

    @property
    def leaves_out_missing(self) -> bool:
        """Whether what is not there is left out."""
        return self.missing == "leave_out"


def _check_pairs(pairs: object, path: str, what: str, kinds: tuple[type, ...]) -> None:
    if not isinstance(pairs, Mapping):
        raise ScenarioError(path, pairs, f"must be {what}")
    for name, value in pairs.items():
        if not isinstance(name, str) or not isinstance(value, kinds):
            raise ScenarioError(f"{path}[{name!r}]", value, f"must be {what}")


def _check_between(value: float, path: str, least: float, most: float) -> None:
    number = real_number(value, path)
    if not least <= number <= most:
        raise ScenarioError(path, number, f"must be between {least:g} and {most:g}")
