"""Wheels, round or with grousers, drums and flippers of a model, and how they are recognized."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from crawler2d.model_tree import Array, Joint, Link, Shape, Tree, Where

__all__ = [
    "ALIKE",
    "PARALLEL",
    "UPRIGHT",
    "Arm",
    "Grousers",
    "Runner",
    "RunningGear",
    "corners_of",
    "farthest",
    "grousers_on",
    "is_parallel",
    "radius_about",
    "subtrees",
    "wheel_shapes",
    "why_no_wheel",
]

PARALLEL = 0.05
"""[rad] Axes within this angle count as parallel: files have 3.1415 for pi, or toe-in."""

UPRIGHT = 0.5
"""[-] An axis with a larger upward component is not an axle, but belongs to a lidar, say."""

# Largest offset of a wheel from its axis, relative to its radius: rounding.
_OFF_AXIS = 0.02

# The hull of a mesh counts as round if its extents differ by at most this fraction.
_OUT_OF_ROUND = 0.05

_DIRECTIONS = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)

ALIKE = 2e-3
"""[-] Allowed difference between grousers, relative to the radius: files round to 0.1 mm."""

_SHARP = 1e-5
"""[-] Corners closer than this, relative to their distance from the axle, coincide in side view:
those on both sides of a prism, which MuJoCo stores as float32."""

_MOST_CORNERS = 64  # A prism has eight; its mesh may repeat each for every facet.
_COUNT = range(3, 201)  # of grousers of a gear wheel


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Grousers:
    """The grousers of a gear wheel.

    Parameters
    ----------
    count : int
        Their number.
    radius : float
        [m] Distance of their tips from the axle.
    height, tip_thickness, base_thickness : float
        [m] See `GearWheel`.
    direction : ndarray, shape (3,)
        Direction from the axle to one of them.
    shapes : tuple of Shape
        Their shapes.
    """

    count: int
    radius: float
    height: float
    tip_thickness: float
    base_thickness: float
    direction: Array
    shapes: tuple[Shape, ...]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Runner:
    """A wheel, or a drum of a track.

    Parameters
    ----------
    name : str
        Name of its link, followed by that of its shape if the link has several.
    x, y, z : float
        [m] Position of its middle: forward, up and to the left.
    radius : float
        [m] Its radius, to the tips of grousers if it has any.
    link : Link
        Its link.
    shape : Shape
        Its shape, or the largest of several.
    joint : Joint, optional
        The joint on which it turns; None for a drum, which is fixed while its surface moves.
    mass : float
        [kg] Mass of all that turns; 0 for a drum.
    inertia : float
        [kg m^2] Moment of inertia of the same about its axis.
    grousers : Grousers, optional
        The grousers of a gear wheel.
    """

    name: str
    x: float
    y: float
    z: float
    radius: float
    link: Link
    shape: Shape
    joint: Joint | None = None
    mass: float = 0.0
    inertia: float = 0.0
    grousers: Grousers | None = None

    @property
    def surfaces(self) -> tuple[Shape, ...]:
        """Its shape and its grousers."""
        return (self.shape, *(self.grousers.shapes if self.grousers else ()))

    @property
    def path(self) -> str:
        """Its line and name, for errors."""
        return f"{self.shape.at}: {'drum' if self.joint is None else 'wheel'}[{self.name}]"

    @property
    def pose_at(self) -> Where:
        """The line that gives its position."""
        return self.shape.pose_at if self.joint is None else self.link.pose_at


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Arm:
    """The parts that turn about the pivot of a flipper.

    Parameters
    ----------
    joint : Joint
        The pivot.
    pivot : ndarray, shape (3,)
        [m] Position of the pivot in the side view.
    links : tuple of Link
        All links that turn with it.
    runners : tuple of Runner
        Its wheels or drums.
    shapes : tuple of (Link, Shape)
        Its other shapes.
    """

    joint: Joint
    pivot: Array
    links: tuple[Link, ...]
    runners: tuple[Runner, ...]
    shapes: tuple[tuple[Link, Shape], ...]


@dataclass(slots=True, eq=False)
class RunningGear:
    """The running gear of a model.

    Parameters
    ----------
    runners : list of Runner
        Wheels and drums of the chassis.
    bars : list of (Link, Shape)
        Shapes of the chassis with a moving surface, except drums.
    arms : list of Arm
        The flippers.
    shapes : list of (Link, Shape)
        Other shapes that are fixed to the chassis.
    moving : list of (Joint, Link, Shape)
        Shapes of other moving parts, such as a lidar or a manipulator.
    passive : set of str
        Names of wheels that are not driven, if others are.
    """

    runners: list[Runner] = field(default_factory=list)
    bars: list[tuple[Link, Shape]] = field(default_factory=list)
    arms: list[Arm] = field(default_factory=list)
    shapes: list[tuple[Link, Shape]] = field(default_factory=list)
    moving: list[tuple[Joint, Link, Shape]] = field(default_factory=list)
    passive: set[str] = field(default_factory=set)

    @property
    def every_runner(self) -> list[Runner]:
        """Wheels and drums of the chassis and of the flippers."""
        return [*self.runners, *(runner for arm in self.arms for runner in arm.runners)]

    def remove_castors(self, middle: float, tolerance: float) -> list[Runner]:
        """Turn the undriven wheels in the middle into skids of the chassis, and return them."""
        castors = [
            wheel
            for wheel in self.runners
            if wheel.name in self.passive and abs(wheel.z - middle) <= tolerance
        ]
        self.runners = [wheel for wheel in self.runners if wheel not in castors]
        self.shapes += [(castor.link, castor.shape) for castor in castors]
        return castors


def corners_of(shape: Shape) -> Array:
    """[m] Return the corners of a box or hull in the frame of the model, shape (n, 3)."""
    if shape.kind == "hull":
        return shape.points
    signs = np.array([[i, j, k] for i in (-0.5, 0.5) for j in (-0.5, 0.5) for k in (-0.5, 0.5)])
    return shape.pose.at(signs * shape.size)


def farthest(shape: Shape, point: Array) -> float:
    """[m] Return an upper bound for the distance from a point to any point of a shape."""
    if shape.kind in ("box", "hull"):
        return float(np.linalg.norm(corners_of(shape) - point, axis=1).max())
    own = math.hypot(shape.radius, 0.5 * shape.length)
    own += shape.radius if shape.kind == "capsule" else 0.0
    return float(np.linalg.norm(shape.pose.place - point)) + own


def subtrees(tree: Tree) -> dict[str, list[str]]:
    """Return the links in the subtree of each link, itself first."""
    names: dict[str, list[str]] = {link.name: [link.name] for link in tree.links}
    for link in reversed(tree.links):  # children before their parents
        if (joint := tree.joints.get(link.name)) is not None:
            names[joint.parent].extend(names[link.name])
    return names


def is_parallel(first: Array, second: Array) -> bool:
    """Whether two directions are parallel or opposite, within a tolerance."""
    return _area(first, second) <= math.sin(PARALLEL)


def _area(first: Array, second: Array) -> float:
    """Return the length of the cross product; numpy takes sixty times as long."""
    (a, b, c), (x, y, z) = first.tolist(), second.tolist()
    return math.hypot(b * z - c * y, c * x - a * z, a * y - b * x)


def radius_about(shape: Shape, point: Array, axis: Array) -> float | None:
    """[m] Return the radius of a shape about an axis; None if it is not round about it."""
    if shape.kind == "hull":
        flat = (shape.points - point) @ plane_across(axis)
        reach = (flat @ np.stack([np.cos(_DIRECTIONS), np.sin(_DIRECTIONS)])).max(axis=0)
        largest = float(reach.max())
        return largest if reach.min() >= (1.0 - _OUT_OF_ROUND) * largest > 0.0 else None
    if not shape.is_round or (shape.kind != "sphere" and not is_parallel(shape.axis, axis)):
        return None
    offset = _area(shape.pose.place - point, axis)
    return shape.radius if offset <= _OFF_AXIS * shape.radius else None


def plane_across(axis: Array) -> Array:
    """Return two unit vectors perpendicular to an axis and to each other, shape (3, 2)."""
    seed = np.eye(3)[int(np.argmin(np.abs(axis)))]
    first = np.cross(axis, seed)
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(axis, first)], axis=1)


def grousers_on(shapes: list[Shape], joint: Joint) -> Grousers | None:
    """Return the grousers of a wheel, with their mean sizes; None if it has none.

    Each grouser is a lateral box or prism that reaches down into the wheel. Its cross-section has a
    straight tip and two flanks, symmetric about the line from the axle through its middle.

    Parameters
    ----------
    shapes : list of Shape
        All shapes that turn.
    joint : Joint
        The joint on which they turn.
    """
    radii = [radius_about(shape, joint.place, joint.axis) for shape in shapes]
    root = max((radius for radius in radii if radius is not None), default=0.0)
    others = [shape for shape, radius in zip(shapes, radii, strict=True) if radius is None]
    if root <= 0.0 or len(others) not in _COUNT:
        return None
    plane = plane_across(joint.axis)
    rows = [row for shape in others if (row := _grouser(shape, joint, plane, root)) is not None]
    if len(rows) < len(others):
        return None
    tip, base, radius, angles = np.array(rows).T
    tolerance = ALIKE * float(radius.max())
    slots, off = _spaced(angles)
    if max(np.ptp(each) for each in (tip, base, radius, radius * off)) > tolerance:
        return None
    if sorted(slots) != list(range(len(others))):
        return None
    first = float(angles[0] + np.mean(off))
    return Grousers(
        count=len(others),
        radius=float(radius.mean()),
        height=float(radius.mean()) - root,
        tip_thickness=float(tip.mean()),
        base_thickness=max(float(tip.mean()), float(base.mean())),
        direction=plane @ (math.cos(first), math.sin(first)),
        shapes=tuple(others),
    )


def wheel_shapes(tree: Tree) -> dict[str, list[tuple[Link, Shape]]]:
    """Return the shapes of each wheel, by the name of its link.

    A wheel turns without limit about an axle that is not upright. Everything that turns with it is
    round about the axis, or is one of equal, evenly spaced grousers.
    """
    hanging, links = subtrees(tree), tree.by_name
    wheels = {}
    for child, joint in tree.joints.items():
        names = hanging[child]
        is_axle = joint.is_unlimited and abs(joint.axis[2]) <= UPRIGHT
        if not is_axle or any(not tree.joints[n].is_locked for n in names[1:]):
            continue
        pairs = [(links[name], shape) for name in names for shape in links[name].shapes]
        shapes = [shape for _, shape in pairs]
        is_round = all(radius_about(each, joint.place, joint.axis) is not None for each in shapes)
        if pairs and (is_round or grousers_on(shapes, joint) is not None):
            wheels[child] = pairs
    return wheels


def why_no_wheel(tree: Tree) -> str:
    """Say why a round shape is no wheel of a robot that has none; empty if there is none.

    Of several, it is about the first on a joint that moves.
    """
    reasons = [
        (joint is None, f"{link.name} {next(_faults(link, shape, joint, tree))}")
        for link in tree.links
        for shape in link.shapes
        if shape.is_round
        for joint in (_moved_by(link.name, tree),)
    ]
    return min(reasons, key=lambda each: each[0])[1] if reasons else ""


def _moved_by(name: str, tree: Tree) -> Joint | None:
    """Return the joint that moves a link, on which others may hold it; None if none does."""
    joint = tree.joints.get(name)
    while joint is not None and joint.is_locked:
        joint = tree.joints.get(joint.parent)
    return joint


def _faults(link: Link, shape: Shape, joint: Joint | None, tree: Tree) -> Iterator[str]:
    """Yield the conditions of a wheel that a round shape does not meet, the first one first."""
    if joint is None:
        yield "is moved by no joint"
        return
    if joint.kind != "hinge":
        yield f"is on a joint that is no hinge: {joint.kind}"
    if not joint.is_unlimited:
        yield f"turns by at most {math.degrees(joint.upper - joint.lower):.0f} degrees"
    if abs(joint.axis[2]) > UPRIGHT:
        yield "turns about an axis that is not level"
    if shape.kind != "sphere" and not is_parallel(shape.axis, joint.axis):
        angle = math.degrees(math.acos(min(1.0, abs(float(shape.axis @ joint.axis)))))
        yield f"is tilted by {angle:.3g} degrees against the axis on which it turns"
    if radius_about(shape, joint.place, joint.axis) is None:
        off = _area(shape.pose.place - joint.place, joint.axis)
        yield f"has its centre {1e3 * off:.3g} mm off the axis on which it turns"
    if any(each.parent == link.name and not each.is_locked for each in tree.joints.values()):
        yield "carries another joint that moves"
    yield "turns with shapes that are not round about its axis"


def _grouser(
    shape: Shape, joint: Joint, plane: Array, root: float
) -> tuple[float, float, float, float] | None:
    """Return the thickness at tip and root and the tip radius [m], and the direction [rad]."""
    corners = _section(shape, joint, plane)
    if corners is None:
        return None
    tolerance = ALIKE * root
    distances = np.hypot(*corners.T)
    order = np.argsort(distances, kind="stable")
    distances = distances[order]
    third, fourth, *tip = corners[order]
    out = tip[0] + tip[1]
    length = math.hypot(*out)
    if distances[2] <= root + tolerance or length <= tolerance:
        return None
    out /= length
    side = np.array([-out[1], out[0]])
    # Half of the cross-section, radial and lateral coordinates: tip, then base.
    half_tip = np.array([0.5 * length, 0.5 * abs(float((tip[0] - tip[1]) @ side))])
    half_base = np.array([float((third + fourth) @ out), abs(float((third - fourth) @ side))]) / 2.0
    lopsided = abs(float((third + fourth) @ side))
    if max(distances[3] - distances[2], lopsided, distances[1] - root) > tolerance:
        return None
    base = _at_root(half_tip, half_base, root)
    if base < half_tip[1] - tolerance:
        return None
    angle = math.atan2(out[1], out[0])
    return 2.0 * float(half_tip[1]), 2.0 * base, float(distances[2:].mean()), angle


def _section(shape: Shape, joint: Joint, plane: Array) -> Array | None:
    """[m] Return the four corners of a cross-section, shape (4, 2); None if it has not four."""
    if shape.kind == "box":
        along = np.abs(shape.pose.turn.T @ joint.axis)
        across = int(along.argmax())
        if along[across] < math.cos(PARALLEL):
            return None
        half = [0.5 * shape.size[k] * shape.pose.turn[:, k] for k in range(3) if k != across]
        points = [shape.pose.place + i * half[0] + j * half[1] for i in (-1, 1) for j in (-1, 1)]
        corners: Array = (np.array(points) - joint.place) @ plane
        return corners
    if shape.kind != "hull" or len(shape.points) > _MOST_CORNERS:
        return None
    flat = (shape.points - joint.place) @ plane
    near = _SHARP * float(np.abs(flat).max(initial=0.0))
    distinct: list[Array] = []
    for point in flat:
        if all(math.hypot(*(point - other)) > near for other in distinct):
            distinct.append(point)
        if len(distinct) > 4:
            return None
    return np.array(distinct) if len(distinct) == 4 else None


def _at_root(tip: Array, base: Array, root: float) -> float:
    """[m] Return the lateral coordinate where a flank from tip to base meets the root circle."""
    along = base - tip
    square, half, beyond = along @ along, tip @ along, tip @ tip - root**2
    under = half**2 - square * beyond
    fraction = 1.0 if under < 0.0 else min(1.0, (-half - math.sqrt(under)) / square)
    return float(tip[1] + fraction * along[1])


def _spaced(angles: Array) -> tuple[list[int], Array]:
    """Return the nearest of evenly spaced slots for each angle, and the distance from it [rad].

    The first slot is at the first angle.
    """
    count, step = len(angles), 2.0 * math.pi / len(angles)
    away = (angles - angles[0]) / step
    slots = np.round(away)
    return [int(slot) % count for slot in slots], (away - slots) * step
