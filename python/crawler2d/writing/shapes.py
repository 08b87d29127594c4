"""Build convex collision shapes in three dimensions: wheels, gear wheels, belts and the belly."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crawler2d.model_tree import Array, Friction, Pose, Shape, Tree, from_rpy

__all__ = [
    "Solids",
    "belly_shapes",
    "belt_shapes",
    "gear_shapes",
    "grousers_of",
    "in_space",
    "lowest",
]

_UPRIGHT = from_rpy((-0.5 * math.pi, 0.0, 0.0))
"""Turns the axis of a cylinder, its z, to the left."""

_SAME = 1e-9  # [-] relative to the radius: difference of equal lengths by rounding
_THIN = 0.001  # [m] Depth of the box behind an edge with a corner sharper than a right angle.
_DEPTH = 0.05  # largest value of that depth, relative to the height of the belly over the edge
_LEVELS = 64  # depths that are tried for the largest box


@dataclass(frozen=True, slots=True, kw_only=True)
class Solids:
    """Builds shapes of one width at one lateral position.

    Parameters
    ----------
    name : str
        First part of their names.
    across, width : float
        [m] Lateral position of the middle, positive to the left, and width.
    friction : float
        [-] Coefficient of friction of their surfaces.
    speed : float
        [m/s] Speed of their surfaces.
    """

    name: str
    across: float
    width: float
    friction: float
    speed: float = 0.0

    def cylinder(self, number: int, center: Array, radius: float) -> Shape:
        """Return the cylinder of a disc in side view."""
        pose = Pose(place=in_space(center, self.across), turn=_UPRIGHT.turn)
        return self._shape(number, "cylinder", pose, radius=radius, length=self.width)

    def box(
        self, number: int, center: Array, direction: Array, length: float, height: float
    ) -> Shape:
        """Return the box of a rectangle in side view, with its length along a direction."""
        (x, z), up = direction, (-direction[1], direction[0])
        turn = np.array([[x, 0.0, up[0]], [0.0, 1.0, 0.0], [z, 0.0, up[1]]])
        pose = Pose(place=in_space(center, self.across), turn=turn)
        return self._shape(number, "box", pose, size=np.array([length, self.width, height]))

    def prism(self, number: int, corners: Array) -> Shape:
        """Return the prism of a convex polygon in side view, shape (n, 2)."""
        half = 0.5 * self.width
        sides = [self.across - half, self.across + half]
        points = np.array([in_space(corner, side) for side in sides for corner in corners])
        # The origin of a mesh is at its middle.
        pose = Pose(place=points.mean(axis=0))
        return self._shape(number, "hull", pose, points=points)

    def _shape(self, number: int, kind: str, pose: Pose, **sizes: object) -> Shape:
        return Shape(
            name=f"{self.name}_{number}",
            kind=kind,
            pose=pose,
            friction=Friction(first=self.friction, second=self.friction),
            surface_speed=self.speed,
            **sizes,  # type: ignore[arg-type]
        )


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Run:
    """A straight run of a belt, from one disc to the next, counter-clockwise.

    Parameters
    ----------
    start, end : int
        Indices of the discs.
    normal : ndarray, shape (2,)
        Outward direction.
    """

    start: int
    end: int
    normal: Array


def in_space(point: Array, across: float) -> Array:
    """[m] Transform a point of the side view to a model: x forward, y to the left, z up."""
    return np.array([point[0], across, point[1]])


def lowest(tree: Tree) -> float:
    """[m] Return the height of the lowest point of all shapes."""
    return min((_bottom(shape) for link in tree.links for shape in link.shapes), default=0.0)


def grousers_of(outline: Array) -> tuple[float, Array]:
    """[m] Find the root radius and the grousers in the exact outline of a gear wheel.

    Parameters
    ----------
    outline : ndarray, shape (n, 2)
        [m] About the axle, counter-clockwise: arcs of the root circle between trapezoids.

    Returns
    -------
    tuple of float and ndarray, shape (k, 4, 2)
        [m] Radius of the root circle; the corners of each grouser, from its base up one flank,
        over the tip and down to its base.
    """
    radii = np.hypot(*outline.T)
    tip = radii.max()
    at_tip = radii >= tip * (1.0 - _SAME)
    if at_tip.all():  # grousers no higher than rounding errors
        return float(tip), np.zeros((0, 4, 2))
    first = np.flatnonzero(at_tip & ~np.roll(at_tip, 1))
    count = len(outline)
    corners = outline[(first[:, None] + np.array([-1, 0, 1, 2])) % count]
    return float(np.hypot(*corners[0, 0])), corners


def gear_shapes(
    outline: Array, solids: Solids, center: Array, *, hulls: bool
) -> list[Shape] | None:
    """Return the parts of a gear wheel, whose union has its exact outline.

    Parameters
    ----------
    outline : ndarray, shape (n, 2)
        [m] Relative to the axle, at the initial angle of the wheel.
    solids : Solids
        Builds the shapes.
    center : ndarray, shape (2,)
        [m] Its axle.
    hulls : bool
        Whether the format has convex hulls. Without them a grouser must be a box.

    Returns
    -------
    list of Shape or None
        None if the grousers taper, but the format has only boxes.
    """
    root, grousers = grousers_of(outline)
    shapes = [solids.cylinder(0, center, root)]
    for number, corners in enumerate(grousers, 1):
        base, tip = corners[3] - corners[0], corners[2] - corners[1]
        wide, thick = math.hypot(*base), math.hypot(*tip)
        if abs(wide - thick) <= _SAME * root:
            low, high = corners[[0, 3]].mean(axis=0), corners[[1, 2]].mean(axis=0)
            middle, height = 0.5 * (low + high), math.hypot(*(high - low))
            # The outline runs from right to left over the root, which the box has to follow.
            shapes.append(solids.box(number, center + middle, -base / wide, thick, height))
        elif hulls:
            shapes.append(solids.prism(number, center + corners))
        else:
            return None
    return shapes


def runs_round(discs: Array) -> list[Run]:
    """Find the straight runs of a taut belt round discs, given as centres and radii [m]."""
    centers, radii = discs[:, :2], discs[:, 2]
    tolerance = _SAME * float(np.abs(discs).max())
    runs = []
    for start in range(len(discs)):
        for end in range(len(discs)):
            normal = _tangent(discs[start], discs[end])
            if start == end or normal is None:
                continue
            reach = centers @ normal + radii
            if reach.max() > reach[start] + tolerance:
                continue
            # If several discs are on one run, the first and the last are its ends.
            touching = np.flatnonzero(reach >= reach[start] - tolerance)
            along = centers[touching] @ np.array([-normal[1], normal[0]])
            if start == touching[along.argmin()] and end == touching[along.argmax()]:
                runs.append(Run(start=start, end=end, normal=normal))
    return runs


def belt_shapes(discs: Array, solids: Solids) -> list[Shape]:
    """Return the parts of a belt, whose union has its exact outline.

    The middle of each box is as deep as the distance of its surface from the axis of rotation.
    """
    # Boxes between two equal discs belong to their upper run, and so are not rotated.
    runs = sorted(runs_round(discs), key=lambda run: -float(run.normal[1]))
    ends = sorted({number for run in runs for number in (run.start, run.end)})
    shapes = [
        solids.cylinder(number, discs[end, :2], float(discs[end, 2]))
        for number, end in enumerate(ends)
    ]
    middles: list[Array] = []
    for run in runs:
        first, last = discs[run.start], discs[run.end]
        # Its inner corners are still inside both discs.
        depth = 2.0 * float(min(first[2], last[2]))
        from_, to = (disc[:2] + disc[2] * run.normal for disc in (first, last))
        middle = 0.5 * (from_ + to) - 0.5 * depth * run.normal
        if any(math.hypot(*(middle - other)) <= _SAME * depth for other in middles):
            continue  # the box between two equal discs covers both runs
        middles.append(middle)
        length = math.hypot(*(to - from_))
        # z points outwards, so x points against the direction of travel.
        along = np.array([run.normal[1], -run.normal[0]])
        shapes.append(solids.box(len(shapes), middle, along, length, depth))
    return shapes


def belly_shapes(polygons: Sequence[Array], solids: Solids, *, hulls: bool) -> list[Shape]:
    """Return the parts of the belly.

    Without hulls, boxes along its edges fill it partly. A corner sharper than a right angle is cut
    off to make room for a thin box.

    Parameters
    ----------
    polygons : sequence of ndarray, each of shape (n, 2)
        [m] Convex polygons, counter-clockwise.
    solids : Solids
        Builds the shapes.
    hulls : bool
        Whether the format has convex hulls.
    """
    shapes: list[Shape] = []
    for corners in polygons:
        first = len(shapes)
        edges = [_Edge(corners, number) for number in range(len(corners))]
        if len(corners) == 4 and all(edge.is_square for edge in edges):
            shapes.append(edges[0].box(first, edges[0].height, solids))
        elif hulls:
            shapes.append(solids.prism(first, corners))
        else:
            most = max(edges, key=lambda edge: edge.largest[0])
            shapes.append(most.box(first, most.largest[1], solids))
            along = enumerate(edges, first + 1)
            shapes += [edge.box(number, edge.depth, solids) for number, edge in along]
    return shapes


def _bottom(shape: Shape) -> float:
    if shape.kind == "hull":
        return float(shape.points[:, 2].min())
    if shape.kind == "cylinder":
        return float(shape.pose.place[2]) - shape.radius
    reach: Array = np.abs(shape.pose.turn[2]) @ shape.size
    return float(shape.pose.place[2] - 0.5 * reach)


def _tangent(start: Array, end: Array) -> Array | None:
    """Return the normal of the outer tangent from one disc to another, on its right."""
    (x, y), narrower = end[:2] - start[:2], start[2] - end[2]
    distance = math.hypot(x, y)
    if distance <= abs(narrower):
        return None
    along, out = narrower / distance, math.sqrt(1.0 - (narrower / distance) ** 2)
    way, right = np.array([x, y]) / distance, np.array([y, -x]) / distance
    normal: Array = along * way + out * right
    return normal


class _Edge:
    """An edge of a convex polygon, with the rectangles on it that are inside the polygon."""

    def __init__(self, corners: Array, number: int) -> None:
        self.start = corners[number]
        way = corners[(number + 1) % len(corners)] - self.start
        self.length = math.hypot(*way)
        self.along = way / self.length
        self.inward = np.array([-self.along[1], self.along[0]])
        out = corners - self.start
        self.places = np.stack([out @ self.along, out @ self.inward], axis=1)
        self.height = float(self.places[:, 1].max())

    def within(self, depth: float) -> tuple[float, float]:
        """[m] Return the range along the edge in which a rectangle of this depth fits."""
        crossed = []
        for (x0, y0), (x1, y1) in zip(self.places, np.roll(self.places, -1, axis=0), strict=True):
            if y0 == y1 == depth:
                crossed += [x0, x1]
            elif y0 != y1 and min(y0, y1) <= depth <= max(y0, y1):
                crossed.append(x0 + (depth - y0) / (y1 - y0) * (x1 - x0))
        if not crossed:
            return 0.0, 0.0
        return max(0.0, min(crossed)), min(self.length, max(crossed))

    @property
    def is_square(self) -> bool:
        """Whether the rectangle on it fills the whole polygon."""
        low, high = self.within(self.height)
        return high - low >= self.length * (1.0 - _SAME) and self.places[:, 0].max() <= (
            self.length * (1.0 + _SAME)
        )

    @property
    def largest(self) -> tuple[float, float]:
        """[m^2, m] Return area and depth of the largest rectangle on it."""
        depths = np.linspace(0.0, self.height, _LEVELS + 1)[1:]
        areas = [(high - low) * d for d in depths for low, high in [self.within(float(d))]]
        best = int(np.argmax(areas))
        return areas[best], float(depths[best])

    @property
    def depth(self) -> float:
        """[m] Depth of the deepest rectangle as long as the edge, or of a thin, shorter one."""
        low, high = 0.0, self.height
        for _ in range(60):
            middle = 0.5 * (low + high)
            left, right = self.within(middle)
            fits = right - left >= self.length * (1.0 - _SAME)
            low, high = (middle, high) if fits else (low, middle)
        thin = min(_THIN, _DEPTH * self.height)
        return max(low, thin)

    def box(self, number: int, depth: float, solids: Solids) -> Shape:
        """Return the box of the rectangle with this depth."""
        low, high = self.within(depth)
        middle = self.start + 0.5 * (low + high) * self.along + 0.5 * depth * self.inward
        return solids.box(number, middle, self.along, high - low, depth)
