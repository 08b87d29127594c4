"""The geometry that pictures draw: the ground, the bodies of the near track, and their poses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.results.bodies import BodyKind, Lane, moved

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.results.record import Record

__all__ = ["SLIVER", "Carrier", "Circuit", "Scene", "closed", "inset", "placed", "relative"]

SLIVER = 2e-5
"""[m] Lines that coincide enclose slivers by rounding; anything shallower is not an intrusion."""

_MARGIN = 0.05  # [m] round the extent


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
    """Everything that pictures draw of a run, as the core provides it.

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

    def __init__(self, run: Record) -> None:
        scenario = run.scenario
        geometry = _core.geometry(scenario.to_json())
        columns = ("position", "chassis_angle", "drive_positions", "shoe_poses", "flipper_angles")
        found = moved(scenario, {name: getattr(run, name) for name in columns})
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
        chassis = np.column_stack([run.position, run.chassis_angle])
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

    def carrier_of(self, body: int) -> int:
        """Find the index of the carrier of a body, of either track."""
        names = [carrier.name for carrier in self.carriers]
        return names.index(self.bodies["carrier"][body])

    def is_shoe(self, body: int) -> bool:
        """Tell whether a body is a piece of a shoe."""
        return bool(self.bodies["shoe"][body] >= 0)

    def extent(self) -> tuple[float, float, float, float]:
        """[m] Left, right, bottom and top of the stretch that the run visits."""
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
        visited = []
        for _, profile in self.lanes:
            visited.append(profile[(profile[:, 0] > left) & (profile[:, 0] < right), 1])
            visited.append(np.interp([left, right], profile[:, 0], profile[:, 1]))
        ground = np.concatenate(visited)
        bottom = min(float(ground.min()), low) - _MARGIN
        return left, right, bottom, max(float(ground.max()), high)


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
