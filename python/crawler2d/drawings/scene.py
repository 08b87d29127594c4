"""What is drawn of a robot on its ground: outlines in order, poses, extents and colours."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.bodies import POSE_COLUMNS, BodyKind, Lane, body_poses

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = [
    "BLACK",
    "BLUE",
    "GRAY",
    "GREEN",
    "GROUND",
    "ORANGE",
    "PURPLE",
    "RED",
    "SKY",
    "SLIVER",
    "VIOLET",
    "Carrier",
    "Circuit",
    "Look",
    "Scene",
    "at_start",
    "closed",
    "course",
    "inset",
    "on_chassis",
    "placed",
    "relative",
    "robot_box",
]

BLACK, ORANGE, SKY, GREEN = "#222222", "#E69F00", "#56B4E9", "#009E73"
BLUE, RED, PURPLE = "#0072B2", "#D55E00", "#CC79A7"
# Dark enough for a thin line on what is filled with it.
VIOLET = "#A3327B"
GRAY, GROUND = "#AAAAAA", "#D9D2C5"


SLIVER = 2e-5
"""[m] Lines that coincide enclose slivers by rounding; anything shallower is not an intrusion."""


def placed(points: NDArray[np.float64], poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Points of a frame, shape (..., 2), moved by the poses of that frame, shape (..., 3)."""
    (x, y), (left, up, angle) = np.moveaxis(points, -1, 0), np.moveaxis(poses, -1, 0)
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.stack([left + cosine * x - sine * y, up + sine * x + cosine * y], axis=-1)


def relative(poses: NDArray[np.float64], frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m, m, rad] Poses at n samples, shape (n, 3), relative to frames with these poses."""
    (x, y), angle = (poses - frames).T[:2], frames[:, 2]
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.column_stack([cosine * x + sine * y, cosine * y - sine * x, poses[:, 2] - angle])


def closed(polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] A polygon as a line that ends where it began."""
    return np.vstack([polygon, polygon[:1]])


def inset(belt: NDArray[np.float64], depth: float) -> NDArray[np.float64]:
    """[m] A closed convex line, counter-clockwise, offset inwards by a depth."""
    way = np.roll(belt, -1, axis=0) - belt
    belt = belt[np.hypot(*way.T) > 1e-9]  # drops coincident corners
    way = np.roll(belt, -1, axis=0) - belt
    inwards = np.column_stack([-way[:, 1], way[:, 0]])
    inwards /= np.hypot(*way.T)[:, None]
    inwards = inwards + np.roll(inwards, 1, axis=0)
    line: NDArray[np.float64] = belt + depth * inwards / np.hypot(*inwards.T)[:, None]
    return line


_MARGIN = 0.05  # [m] round the extent


class Look(Enum):
    """How a body is drawn."""

    BELLY = "belly"
    HINT = "hint"
    """Faintly: shoes or a belt run over it, and hide it."""
    LINE = "line"
    SHOE = "shoe"


@dataclass(frozen=True, slots=True)
class Circuit:
    """The path of a belt, and the grousers on it.

    Parameters
    ----------
    belt : int
        Index of the belt's body.
    ways : ndarray, shape (k,)
        [m] Distances along the belt, all the way round; poses between them may be interpolated.
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
    """What carries a track: the chassis, or the flippers at one end.

    Parameters
    ----------
    name : str
        Its name in `Run.bodies`.
    circles : ndarray, shape (k, 3)
        [m] Centres and radii of the circles that the envelope runs round, in its own frame.
    closed : bool
        Whether nothing gets inside: it carries a belt, skids or a chain.
    envelope, root_envelope : ndarray, shape (k, 2)
        [m] Taut belts round the circumscribed circles and round the root circles.
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
    circuit: Circuit | None
    bodies: NDArray[np.int64]
    poses: NDArray[np.float64]


class Scene:
    """Everything that is drawn of a robot and its ground, as the core provides it.

    Parameters
    ----------
    text : str
        The scenario in JSON.
    columns : mapping of str to ndarray
        Where the robot is at n samples: the columns of a run that `POSE_COLUMNS` names.

    Attributes
    ----------
    lanes : list of tuple of int and ndarray
        Lanes under the tracks with their profiles [m], the farthest from the viewer (left) first.
    edges : dict of str to ndarray
        Corners of the ground.
    goal : float
        [m] Position that the rear end has to reach.
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
        self.carriers = [
            self._carrier(each, poses)
            for each, poses in zip(geometry["carriers"], frames, strict=True)
        ]

    def _carrier(self, shapes: dict[str, Any], poses: NDArray[np.float64]) -> Carrier:
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
            circuit=None if shapes["circuit"] is None else Circuit(**shapes["circuit"]),
            bodies=np.flatnonzero(is_seen),
            poses=poses,
        )

    def outline(self, body: int, sample: int) -> NDArray[np.float64]:
        """[m] The closed outline of a body at a sample."""
        return placed(closed(self.bodies["outline"][body]), self.poses[sample, body])

    def parts(self, *, hidden: bool = False) -> list[tuple[int, Look]]:
        """List the bodies that are seen with their looks, in the order of drawing.

        With `hidden`, it has the wheels within belts, too, which meet nothing.
        """
        looks = {int(body): self._look(int(body)) for each in self.carriers for body in each.bodies}
        order = list(Look)
        return sorted(
            ((body, look) for body, look in looks.items() if hidden or self._is_met(body)),
            key=lambda part: order.index(part[1]),
        )

    def _look(self, body: int) -> Look:
        kind = self.kinds[body]
        if kind == BodyKind.BELLY:
            return Look.BELLY
        if self.is_shoe(body):
            return Look.SHOE
        # What shoes run on is hidden by them, except for the teeth of the sprocket.
        is_hint = kind.is_in_chain and (kind != BodyKind.SPROCKET or not self._is_met(body))
        return Look.HINT if is_hint else Look.LINE

    def _is_met(self, body: int) -> bool:
        """Tell whether something can touch a body: ground, or the shoes of a chain."""
        return bool(self.bodies["body"][body] >= 0)

    def carrier_of(self, body: int) -> int:
        """Find the index of the carrier of a body, of either track."""
        names = [carrier.name for carrier in self.carriers]
        return names.index(self.bodies["carrier"][body])

    def is_shoe(self, body: int) -> bool:
        """Tell whether a body is a piece of a shoe."""
        return bool(self.bodies["shoe"][body] >= 0)

    def extent(self) -> tuple[float, float, float, float]:
        """[m] Left, right, bottom and top of the stretch that the robot visits."""
        chassis, *arms = self.carriers
        centers, radii = chassis.circles[:, :2], chassis.circles[:, 2]
        reach = float((np.hypot(*centers.T) + radii).max()) + _MARGIN
        x, y, _ = chassis.poses.T
        left, right = float(x.min()) - reach, float(x.max()) + reach
        low, high = float(y.min()) - float(radii.max()), float(y.max()) + reach
        for arm in arms:
            for *center, radius in arm.circles:
                x, y = placed(np.array(center), arm.poses).T
                left = min(left, float(x.min()) - radius - _MARGIN)
                right = max(right, float(x.max()) + radius + _MARGIN)
                low = min(low, float(y.min()) - radius)
                high = max(high, float(y.max()) + radius + _MARGIN)
        ground = self.heights(left, right)
        bottom = min(float(ground.min()), low) - _MARGIN
        return left, right, bottom, max(float(ground.max()), high)

    def heights(self, left: float, right: float) -> NDArray[np.float64]:
        """[m] Heights of the corners of all lanes between two places, and of the lanes there."""
        found = []
        for _, profile in self.lanes:
            found.append(profile[(profile[:, 0] > left) & (profile[:, 0] < right), 1])
            found.append(np.interp([left, right], profile[:, 0], profile[:, 1]))
        return np.concatenate(found)


def at_start(text: str) -> dict[str, NDArray[np.float64]]:
    """Find where the robot of a scenario in JSON stands at time 0: one sample for a `Scene`."""
    start = json.dumps({**json.loads(text), "duration": 0.0})
    trace = _core.simulate(start, 1.0, "full", [])["trace"]
    return {name: trace[name] for name in POSE_COLUMNS}


def on_chassis(columns: Mapping[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Turn a sample so that the frame of the chassis is that of the drawing."""
    frame = np.column_stack([columns["position"], columns["chassis_angle"]])
    shoes = relative(columns["shoe_poses"][0], frame)[None]
    still = {name: np.zeros_like(columns[name]) for name in ("position", "chassis_angle")}
    return {**columns, **still, "shoe_poses": shoes}


# Of the width of the view: room round what is shown, and above it.
_ROUND, _ABOVE = 0.03, 0.05


def robot_box(scene: Scene) -> tuple[float, float, float, float]:
    """[m] Left, right, bottom and top of what is seen of the robot at the first sample."""
    points = np.concatenate([scene.outline(body, 0) for body, _ in scene.parts()])
    (left, bottom), (right, top) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    return left, right, bottom, top


def course(scene: Scene) -> tuple[float, float, float, float]:
    """[m] The same of the robot and of the ground that it has to cross to be past the goal."""
    left, right, bottom, top = robot_box(scene)
    length = right - left
    left, right = min(left, scene.goal - length), max(right, scene.goal + length)
    ground = scene.heights(left, right)
    width = right - left
    bottom, top = min(bottom, float(ground.min())), max(top, float(ground.max()))
    margin = _ROUND * width
    return left - margin, right + margin, bottom - margin, top + _ABOVE * width
