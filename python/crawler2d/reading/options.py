"""How a model file is read: what the user may decide, its unit of length, and rules of friction.

Model files in another unit of length: every length is multiplied in the text, before it is read.

So the lines stay those of the file, and a changed file is written in metres.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, fields
from typing import Any, Literal, get_args

from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Shape, Where
from crawler2d.reading.running_gear import SideView
from crawler2d.reading.shapes import MeshRule
from crawler2d.reading.wheels import Runner
from crawler2d.writing.document import Document, Span

__all__ = ["ENGINES", "TOLERANCE", "Engine", "How", "combined", "scaled"]

Engine = Literal["gz", "classic", "bullet", "mujoco", "isaac"]

_SAME = 1e-9  # [-] Coefficients are as written: no rounding lies between two that are meant equal.


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """How an engine combines the coefficients of two surfaces.

    Parameters
    ----------
    of_two : callable
        What it makes of both.
    word : str
        What that is called.
    usual : float
        [-] The coefficient of a surface of which a file says nothing.
    """

    of_two: Callable[[float, float], float]
    word: str
    usual: float


ENGINES: dict[str, Rule] = {
    # The smaller: DefaultContactSurfaceHandler of DART, which gz-sim runs, and ODEPhysics::Collide
    # of Gazebo Classic. In SDFormat, mu is 1.
    "gz": Rule(of_two=min, word="min", usual=1.0),
    "classic": Rule(of_two=min, word="min", usual=1.0),
    # btManifoldResult::calculateCombinedFriction; URDF's lateral_friction is 0.5 in UrdfParser.
    "bullet": Rule(of_two=lambda a, b: min(a * b, 10.0), word="product", usual=0.5),
    # MuJoCo's documentation, Computation, Contact parameters: the larger, element by element,
    # unless one geom has the higher priority. The default of geom/friction is 1.
    "mujoco": Rule(of_two=max, word="max", usual=1.0),
    # PhysX, PxMaterial: the combine mode is eAVERAGE by default. Isaac's material has 0.5.
    "isaac": Rule(of_two=lambda a, b: 0.5 * (a + b), word="mean", usual=0.5),
}
"""The rules by engine."""


def combined(
    runners: list[Runner], view: SideView, engine: str, ground: float
) -> tuple[float, str, list[Where]]:
    """Combine the friction of every wheel with that of the ground.

    Parameters
    ----------
    runners : list of Runner
        All wheels and drums, at least one.
    view : SideView
        The side view, for the direction of the coefficients.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine.
    ground : float
        [-] Coefficient of the ground's own surface.

    Returns
    -------
    friction : float
        [-] Between tracks and ground.
    source : str
        How it came about.
    places : list of Where
        The lines that state it; empty if none does.

    Raises
    ------
    ScenarioError
        If it differs from wheel to wheel, or has no limit.
    """
    rule = ENGINES[engine]
    first: tuple[float, str] | None = None
    places = []
    for runner, shape in [(each, shape) for each in runners for shape in each.surfaces]:
        own, priority, where = _along(runner, shape, view, rule.usual)
        wins = engine == "mujoco" and priority > 0
        value = own if wins else rule.of_two(own, ground)
        of_own = f"{own:g}" if where else f"{own:g}, the engine's default,"
        word = "of higher priority" if wins else f"{rule.word} with {ground:g} of the ground"
        if first is None:
            first = value, f"{of_own} along the track, {word}"
        if abs(value - first[0]) > _SAME:
            path = f"{where or shape.at}: friction[{runner.name}]"
            raise ScenarioError(path, value, f"must be that of all wheels, {first[0]:g}")
        if where is not None:
            places.append(where)
    assert first is not None  # a model without wheels has been refused
    if not math.isfinite(first[0]):
        raise ScenarioError(f"{places[0]}: friction", first[0], "must have a limit")
    return (*first, places)


def _along(
    runner: Runner, shape: Shape, view: SideView, usual: float
) -> tuple[float, int, Where | None]:
    """Return the coefficient along the track, its priority, and its line.

    A controller of tracks turns the first direction along the track. Else it is fdir1, in the frame
    of the collision; without one, an engine may turn it anywhere, and the smaller holds.
    """
    found = shape.friction
    if found is None:
        return usual, 0, None
    if runner.joint is None:
        is_first = True
    elif found.direction is None:
        is_first = found.first <= found.second
    else:
        is_first = bool(abs(found.direction @ view.left) <= math.sqrt(0.5))
    if is_first:
        return found.first, found.priority, found.first_at
    return found.second, found.priority, found.second_at


_SIZES = {
    "box": ("size",),
    "capsule": ("radius", "length"),
    "cone": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "ellipsoid": ("radii",),
    "heightmap": ("size", "pos"),
    "mesh": ("scale",),
    "plane": ("size",),
    "polyline": ("point", "height"),
    "sphere": ("radius",),
}
"""What has lengths in a shape, as attributes in URDF, as elements in SDF."""

_INERTIA = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
_SLIDE = ("lower", "upper", "velocity")


def scaled(data: bytes, scale: float, file: str) -> bytes:
    """Multiply the lengths of an SDF or URDF text.

    Places, sizes and limits of slides by the scale, moments of inertia by its square. Masses,
    torques and settings of plugins and sensors stay what they are.

    Parameters
    ----------
    data : bytes
        The text, which has been parsed.
    scale : float
        [-] Such as 0.001 for a file in millimetres.
    file : str
        Its name, for errors.

    Raises
    ------
    ScenarioError
        If the text is not in UTF-8.
    """
    try:
        document = Document(data.decode("utf-8"))
    except UnicodeDecodeError:
        raise ScenarioError(file, "another encoding", "must be UTF-8, to be scaled") from None
    for span in document.root.within():
        _scale(document, span, scale)
    return document.text.encode()


def _scale(document: Document, span: Span, scale: float) -> None:
    by = (scale,) * 3
    if span.tag == "pose" and not span.children:  # of a joint's limits and plugins, too
        document.multiply(span, by)
    elif span.tag == "origin":
        document.multiply(span, by, "xyz")
    elif span.tag in _SIZES:
        if span.tag == "mesh" and "scale" not in span.attributes and not span.only("scale"):
            _add_scale(document, span, scale)
        for name in _SIZES[span.tag]:
            document.multiply(span, by, name)
            for inner in span.all(name):
                document.multiply(inner, by)
    elif span.tag == "inertia":
        for name in _INERTIA:
            document.multiply(span, (scale**2,), name, is_exact=True)
            document.multiply(span.only(name), (scale**2,), is_exact=True)
    elif span.tag == "limit" and _is_of_slide(span):
        for name in _SLIDE:
            document.multiply(span, (scale,), name)
            document.multiply(span.only(name), (scale,))


def _add_scale(document: Document, mesh: Span, scale: float) -> None:
    text = f"{scale:.12g} {scale:.12g} {scale:.12g}"
    if mesh.children:  # SDF
        document.append(mesh, f"<scale>{text}</scale>", is_inline=True)
    else:
        document.set_attribute(mesh, "scale", text)


def _is_of_slide(limit: Span) -> bool:
    joint = limit.parent
    while joint is not None and joint.tag != "joint":
        joint = joint.parent
    return joint is not None and joint.attributes.get("type") == "prismatic"


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
