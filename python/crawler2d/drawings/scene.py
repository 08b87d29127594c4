"""The drawing of a robot on its ground: outlines, poses and looks."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.bodies import POSE_COLUMNS, BodyKind, Lane, body_poses
from crawler2d.drawings.palette import BLACK, GRAY, GREEN

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "STYLES",
    "Carrier",
    "Circuit",
    "Extent",
    "Look",
    "Scene",
    "close_line",
    "extent_of",
    "inset",
    "place",
    "profile_between",
    "relative",
]

Extent = tuple[float, float, float, float]
"""[m] Left, right, bottom and top."""

_SLIVER = 2e-5
"""[m] Lines that coincide enclose slivers by rounding; anything shallower is no intrusion."""

_MARGIN = 0.05
"""[m] Margin round the extent of a run."""

_ROUND, _ABOVE = 0.03, 0.05
"""[-] Margin round a course, and above it, as a fraction of its width."""


class Look(Enum):
    """How a body is drawn, in drawing order."""

    BELLY = "belly"
    INSIDE = "inside"
    """A wheel inside a belt or chain, without contacts."""
    GUIDE = "guide"
    """The guide of shoes, hidden by them."""
    CHAIN_WHEEL = "chain wheel"
    """A wheel that shoes run around, hidden by them except for the sprocket's teeth."""
    HULL = "hull"
    """A belt with its grousers, or a skid."""
    WHEEL = "wheel"
    SHOE = "shoe"


@dataclass(frozen=True, slots=True)
class Style:
    """Colour of a body, opacity of its filling [-], and width of its line [pt]."""

    color: str
    fill: float = 0.0
    width: float = 1.0


STYLES = {
    Look.BELLY: Style(GREEN, fill=0.25),
    **dict.fromkeys((Look.INSIDE, Look.GUIDE, Look.CHAIN_WHEEL), Style(GRAY)),
    **dict.fromkeys((Look.HULL, Look.WHEEL), Style(BLACK)),
    Look.SHOE: Style(BLACK, fill=0.5, width=0.6),
}
"""Styles in figures and SVG; pages have the colours of their style sheet."""


def place(points: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Transform points, shape (..., 2), from the frame with these poses, shape (..., 3)."""
    (x, y), (left, up, angle) = np.moveaxis(points, -1, 0), np.moveaxis(poses, -1, 0)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([left + cosine * x - sine * y, up + sine * x + cosine * y], axis=-1)


def relative(poses: NDArray[np.float64], frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m, m, rad] Express the poses at n samples, shape (n, 3), relative to moving frames."""
    (x, y), angle = (poses - frames).T[:2], frames[:, 2]
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack([cosine * x + sine * y, cosine * y - sine * x, poses[:, 2] - angle])


def close_line(polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Return a polygon as a closed line, which ends where it began."""
    return np.vstack([polygon, polygon[:1]])


def inset(belt: NDArray[np.float64], depth: float) -> NDArray[np.float64]:
    """[m] Offset a closed convex line, counter-clockwise, inwards by a depth."""
    side = np.roll(belt, -1, axis=0) - belt
    belt = belt[np.hypot(*side.T) > 1e-9]  # drops coincident corners
    side = np.roll(belt, -1, axis=0) - belt
    inwards = np.column_stack([-side[:, 1], side[:, 0]])
    inwards /= np.hypot(*side.T)[:, None]
    inwards = inwards + np.roll(inwards, 1, axis=0)
    line: NDArray[np.float64] = belt + depth * inwards / np.hypot(*inwards.T)[:, None]
    return line


def profile_between(profile: NDArray[np.float64], left: float, right: float) -> NDArray[np.float64]:
    """[m] Cut a profile at two positions on level or sloping ground."""
    inner = profile[(profile[:, 0] > left) & (profile[:, 0] < right)]
    start, end = np.interp([left, right], *profile.T)
    return np.vstack([(left, start), inner, (right, end)])


def extent_of(*points: NDArray[np.float64], margin: float = 0.0) -> Extent:
    """[m] Return the extent of arrays of points, with a margin as a fraction of their width."""
    every = np.concatenate(points)
    (left, bottom), (right, top) = every.min(axis=0).tolist(), every.max(axis=0).tolist()
    room = margin * (right - left)
    return left - room, right + room, bottom - room, top + room


@dataclass(frozen=True, slots=True)
class Circuit:
    """The path of a belt, and the grousers on it.

    Parameters
    ----------
    belt : int
        Index of the belt's body.
    ways : ndarray, shape (k,)
        [m] Distances along the belt, once round; poses between them may be interpolated.
    poses : ndarray, shape (k, 3)
        [m, m, rad] Poses there, in the carrier's frame; the last is the first after a full turn.
    grousers : ndarray of int
        Indices of its grousers' bodies.
    starts : ndarray
        [m] Positions of the grousers along the belt before it has moved.
    """

    belt: int
    ways: NDArray[np.float64]
    poses: NDArray[np.float64]
    grousers: NDArray[np.int64]
    starts: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Carrier:
    """A carrier of a track: the chassis, or the flippers at one end.

    Parameters
    ----------
    name : str
        Its name in `Run.bodies`.
    circles : ndarray, shape (k, 3)
        [m] Centres and radii of the circles that the envelope runs round, in its own frame.
    closed : bool
        Whether ground cannot get inside: it carries a belt, skids or a chain.
    envelope, root_envelope : ndarray, shape (k, 2)
        [m] Taut belts round the circumscribed circles and round the root circles.
    inner : ndarray, shape (k, 2)
        [m] The envelope, offset inwards by the depth from which ground in it is an intrusion.
    circuit : Circuit or None
        The path of its belt, if it has one.
    bodies : ndarray of int
        Indices of the bodies of the near track, and of the belly.
    poses : ndarray, shape (n, 3)
        [m, m, rad] Poses of its frame at each sample.
    """

    name: str
    circles: NDArray[np.float64]
    closed: bool
    envelope: NDArray[np.float64]
    root_envelope: NDArray[np.float64]
    inner: NDArray[np.float64]
    circuit: Circuit | None
    bodies: NDArray[np.int64]
    poses: NDArray[np.float64]


class Scene:
    """Everything that is drawn of a robot and its ground, as provided by the core.

    Parameters
    ----------
    text : str
        The scenario in JSON.
    columns : mapping of str to ndarray
        The robot's state at n samples: the columns of a run in `POSE_COLUMNS`.

    Attributes
    ----------
    lanes : list of tuple of int and ndarray
        Lanes under the tracks with their profiles [m], the farthest from the viewer (left) first.
    edges : dict of str to ndarray
        Corners of the ground.
    goal : float
        [m] Position that the robot's rear end has to reach.
    bodies : dict of str to ndarray
        Columns of `Run.bodies`.
    poses : ndarray, shape (n, k, 3)
        [m, m, rad] Poses of the bodies.
    travels : ndarray, shape (n, k)
        [m] Distance that the surface of each body has moved relative to its carrier.
    center_of_mass : ndarray, shape (n, 2)
        [m] Centre of mass of the whole robot.
    carriers : list of Carrier
        The chassis, then the front flippers, then the rear ones.
    looks : dict of int to Look
        Visible bodies of the near track, in drawing order.
    """

    def __init__(self, text: str, columns: Mapping[str, NDArray[np.float64]]) -> None:
        geometry = _core.geometry(text)
        found = body_poses(text, columns)
        self.lanes: list[tuple[int, NDArray[np.float64]]] = [
            lane for lane in geometry["lanes"] if lane[0] != Lane.MIDDLE
        ]
        self.edges = geometry["edges"]
        self.goal = float(geometry["goal"])
        self.bodies: dict[str, Any] = geometry["bodies"]
        self.poses = found["bodies"]
        self.travels = found["travels"]
        self.center_of_mass = found["center_of_mass"]
        self.kinds = [BodyKind(kind) for kind in self.bodies["kind"]]
        chassis = np.column_stack([columns["position"], columns["chassis_angle"]])
        frames = [chassis, *np.moveaxis(found["arms"], 1, 0)]
        depth = max(json.loads(text)["criteria"]["intrusion_depth"], _SLIVER)
        self.carriers = [
            self._carrier(each, poses, depth)
            for each, poses in zip(geometry["carriers"], frames, strict=True)
        ]
        order = list(Look)
        looks = {int(body): self._look(int(body)) for each in self.carriers for body in each.bodies}
        self.looks = dict(sorted(looks.items(), key=lambda item: order.index(item[1])))

    @classmethod
    def at_start(cls, text: str) -> Scene:
        """Make the scene of a scenario in JSON at time 0, its only sample."""
        return cls(text, _first_sample(text))

    @classmethod
    def of_robot(cls, text: str) -> Scene:
        """Make the same scene in the chassis frame, for a drawing of the robot alone."""
        columns = _first_sample(text)
        frame = np.column_stack([columns["position"], columns["chassis_angle"]])
        shoes = relative(columns["shoe_poses"][0], frame)[None]
        still = {name: np.zeros_like(columns[name]) for name in ("position", "chassis_angle")}
        return cls(text, {**columns, **still, "shoe_poses": shoes})

    def _carrier(self, shapes: dict[str, Any], poses: NDArray[np.float64], depth: float) -> Carrier:
        near = self.lanes[-1][0]
        is_seen = [
            carrier == shapes["name"] and (lane == near or kind == BodyKind.BELLY)
            for carrier, lane, kind in zip(
                self.bodies["carrier"], self.bodies["lane"], self.kinds, strict=True
            )
        ]
        names = ("name", "circles", "closed", "envelope", "root_envelope")
        return Carrier(
            **{name: shapes[name] for name in names},
            inner=inset(shapes["envelope"], depth),
            circuit=None if shapes["circuit"] is None else Circuit(**shapes["circuit"]),
            bodies=np.flatnonzero(is_seen),
            poses=poses,
        )

    def _look(self, body: int) -> Look:
        kind = self.kinds[body]
        if kind == BodyKind.BELLY:
            return Look.BELLY
        if self.bodies["shoe"][body] >= 0:
            return Look.SHOE
        if kind == BodyKind.GUIDE:
            return Look.GUIDE
        if self.bodies["body"][body] < 0:
            return Look.INSIDE
        if kind in (BodyKind.WHEEL, BodyKind.SPROCKET):
            return Look.WHEEL
        return Look.CHAIN_WHEEL if kind.is_in_chain else Look.HULL

    def outline(self, body: int, sample: int) -> NDArray[np.float64]:
        """[m] The closed outline of a body at a sample."""
        return place(close_line(self.bodies["outline"][body]), self.poses[sample, body])

    def outlines(self, sample: int) -> list[NDArray[np.float64]]:
        """[m] The closed outlines of all visible bodies at a sample."""
        return [self.outline(body, sample) for body in self.seen]

    @property
    def seen(self) -> dict[int, Look]:
        """Looks of the visible bodies: all except wheels inside belts."""
        return {body: look for body, look in self.looks.items() if look != Look.INSIDE}

    def carrier_of(self, body: int) -> int:
        """Find the index of the carrier of a body, of either track."""
        names = [carrier.name for carrier in self.carriers]
        return names.index(self.bodies["carrier"][body])

    def surfaces(self, left: float, right: float) -> list[NDArray[np.float64]]:
        """[m] Surfaces of the lanes between two positions, the farthest from the viewer first."""
        return [profile_between(profile, left, right) for _, profile in self.lanes]

    def extent(self) -> Extent:
        """[m] The stretch of ground that the robot visits."""
        chassis, *arms = self.carriers
        centers, radii = chassis.circles[:, :2], chassis.circles[:, 2]
        reach = float((np.hypot(*centers.T) + radii).max()) + _MARGIN
        x, y, _ = chassis.poses.T
        left, right = float(x.min()) - reach, float(x.max()) + reach
        low, high = float(y.min()) - float(radii.max()), float(y.max()) + reach
        for arm in arms:
            for *center, radius in arm.circles:
                x, y = place(np.array(center), arm.poses).T
                left = min(left, float(x.min()) - radius - _MARGIN)
                right = max(right, float(x.max()) + radius + _MARGIN)
                low = min(low, float(y.min()) - radius)
                high = max(high, float(y.max()) + radius + _MARGIN)
        _, _, lowest, highest = extent_of(*self.surfaces(left, right))
        return left, right, min(lowest, low) - _MARGIN, max(highest, high)

    def robot_extent(self) -> Extent:
        """[m] Extent of the robot at the first sample."""
        return extent_of(*self.outlines(0))

    def course(self) -> Extent:
        """[m] Extent of the robot and the ground up to the goal, with a margin."""
        left, right, bottom, top = self.robot_extent()
        length = right - left
        left, right = min(left, self.goal - length), max(right, self.goal + length)
        _, _, lowest, highest = extent_of(*self.surfaces(left, right))
        width = right - left
        margin = _ROUND * width
        bottom, top = min(bottom, lowest) - margin, max(top, highest) + _ABOVE * width
        return left - margin, right + margin, bottom, top


def _first_sample(text: str) -> dict[str, NDArray[np.float64]]:
    """Compute the pose of a scenario's robot at time 0."""
    start = json.dumps({**json.loads(text), "duration": 0.0})
    trace = _core.simulate(start, 1.0, "full", [])["trace"]
    return {name: trace[name] for name in POSE_COLUMNS}
