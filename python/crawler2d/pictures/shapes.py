"""Shapes of a robot as pictures need them: placed, turned, inset; and what a run visits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.parameters.robot import Robot
    from crawler2d.results.record import Record

__all__ = [
    "SLIVER",
    "Carrier",
    "carrier_of",
    "carriers",
    "circle",
    "closed",
    "extent",
    "grousers",
    "inset",
    "mass_center",
    "mass_share",
    "outlines",
    "pins",
    "placed",
    "seen_lanes",
    "shoes",
]

SLIVER = 2e-5
"""[m] Lines that coincide enclose slivers of rounding; an intrusion is deeper."""


_MIDDLE = 3  # under the belly
_MARGIN = 0.05  # [m] of the extent


@dataclass(frozen=True, slots=True)
class Carrier:
    """What carries a track, the chassis or a flipper, over the n samples of a run.

    Parameters
    ----------
    track : dict
        Its shapes, in the carrier's own frame.
    origin : ndarray, shape (n, 2)
        [m] Where that frame is.
    angle : ndarray, shape (n,)
        [rad] How it is turned.
    ways : ndarray, shape (n, k)
        [m] How far the surface of each drive has run over the carrier.
    """

    track: dict[str, Any]
    origin: NDArray[np.float64]
    angle: NDArray[np.float64]
    ways: NDArray[np.float64]

    def placed(self, sample: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """[m] Points of its frame, shape (n, 2), where they are at a sample."""
        return _moved(points, self.angle[sample], self.origin[sample])


def carriers(run: Record, geometry: dict[str, Any]) -> list[Carrier]:
    """List what carries a track: the chassis, then the flippers, the front first."""
    chassis = Carrier(geometry, run.position, run.chassis_angle, run.drive_positions)
    found = [chassis]
    for flipper, angle in zip(geometry["flippers"], run.flipper_angles.T, strict=True):
        turn = flipper["sign"] * angle
        pivot = _directed(run.chassis_angle, flipper["pivot"])
        arm = _directed(run.chassis_angle + turn, flipper["arm"])
        # The sprocket turns with the chassis: over a flipper that turns it turns back.
        ways = run.drive_positions + geometry["drive_radius"] * turn[:, None]
        origin = run.position + pivot + arm
        found.append(Carrier(flipper, origin, run.chassis_angle + turn, ways))
    return found


def carrier_of(geometry: dict[str, Any], body: int = 0) -> int:
    """Which of the carriers a body of either track belongs to."""
    # Of two tracks the near one comes second; the guide of a chain comes after its shoes.
    first = int(geometry["bodies"][0]) - len(geometry["shoes"])
    near = body if body >= first else body + first
    holders = (k for k, flipper in enumerate(geometry["flippers"], 1) if near in flipper["bodies"])
    return next(holders, 0)


def mass_share(robot: Robot) -> float:
    """Share of the mass of a robot that the flippers at one end have."""
    return 0.0 if robot.flippers is None else 2.0 * robot.flippers.mass / robot.mass


def mass_center(run: Record, geometry: dict[str, Any], sample: int) -> NDArray[np.float64]:
    """[m] The centre of mass, in the chassis frame; it moves with the flippers."""
    robot = run.scenario.robot
    center = np.array(robot.center_of_mass)  # with the flippers at angle 0
    for flipper, angle in zip(geometry["flippers"], run.flipper_angles[sample], strict=True):
        arm = np.array(flipper["arm"])
        center += mass_share(robot) * (_rotation(flipper["sign"] * angle) @ arm - arm)
    return center


def seen_lanes(geometry: dict[str, Any]) -> list[tuple[int, NDArray[np.float64]]]:
    """Lanes under tracks with their profiles [m], from the farthest from the viewer: the left."""
    return [lane for lane in geometry["lanes"] if lane[0] != _MIDDLE]


def extent(run: Record, geometry: dict[str, Any]) -> tuple[float, float, float, float]:
    """[m] Left, right, bottom and top of what the run visits, with the obstacle's beginning."""
    circles = geometry["circles"]
    reach = float((np.hypot(circles[:, 0], circles[:, 1]) + circles[:, 2]).max()) + _MARGIN
    x, y = run.position.T
    left, right = float(x.min()) - reach, float(x.max()) + reach
    low, high = float(y.min()) - float(circles[:, 2].max()), float(y.max()) + reach
    for flipper in carriers(run, geometry)[1:]:
        for *center, radius in flipper.track["circles"]:
            x, y = (flipper.origin + _directed(flipper.angle, center)).T
            left = min(left, float(x.min()) - radius - _MARGIN)
            right = max(right, float(x.max()) + radius + _MARGIN)
            low = min(low, float(y.min()) - radius)
            high = max(high, float(y.max()) + radius + _MARGIN)
    visited = []
    for _, profile in seen_lanes(geometry):
        visited.append(profile[(profile[:, 0] > left) & (profile[:, 0] < right), 1])
        visited.append(np.interp([left, right], profile[:, 0], profile[:, 1]))
    ground = np.concatenate(visited)
    bottom = min(float(ground.min()), low) - _MARGIN
    return left, right, bottom, max(float(ground.max()), high)


def circle(x: float, y: float, radius: float) -> NDArray[np.float64]:
    """[m] A circle as a closed line, shape (n, 2)."""
    angles = np.linspace(0.0, 2.0 * np.pi, 181)
    line: NDArray[np.float64] = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    line += (x, y)
    return line


def placed(run: Record, sample: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Points of the chassis frame, shape (n, 2), where they are at a sample."""
    return _moved(points, run.chassis_angle[sample], run.position[sample])


def _moved(points: NDArray[np.float64], angle: float, origin: Any) -> NDArray[np.float64]:
    """[m] Points of a frame that is turned by an angle [rad] about an origin [m]."""
    there: NDArray[np.float64] = points @ _rotation(angle).T
    there += origin
    return there


def _rotation(angle: float) -> NDArray[np.float64]:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]])


def _directed(angles: NDArray[np.float64], vector: Any) -> NDArray[np.float64]:
    """One vector turned by each of n angles [rad], shape (n, 2)."""
    (x, y), cosine, sine = vector, np.cos(angles), np.sin(angles)
    return np.column_stack([cosine * x - sine * y, sine * x + cosine * y])


def outlines(carrier: Carrier, sample: int) -> list[NDArray[np.float64]]:
    """[m] What runs round a carrier, where it is: gears, or a belt with grousers, or wheels.

    Of what a chain runs on, the sprocket comes first.
    """
    track, ways = carrier.track, carrier.ways[sample]
    sprocket = track.get("sprocket")
    if sprocket:
        others = [circle(x, y, radius) for x, y, radius in track["circles"][1:]]
        lines = [_turned(sprocket, ways), *others]
    elif track["gears"]:
        lines = [_turned(gear, ways) for gear in track["gears"]]
    elif track["hull"]:
        belt = closed(track["root_envelope"])
        lines = [belt, *grousers(track, float(ways[int(track["drives"][0])]))]
    else:
        lines = [circle(x, y, radius) for x, y, radius in track["circles"]]
    return [carrier.placed(sample, line) for line in lines]


def _turned(gear: dict[str, Any], ways: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Outline of a gear in the frame of its carrier, turned as far as its drive has run."""
    angle = 0.0 if gear["drive"] is None else -ways[gear["drive"]] / gear["radius"]
    return closed(_moved(gear["outline"], angle, gear["center"]))


def grousers(geometry: dict[str, Any], run: float) -> list[NDArray[np.float64]]:
    """[m] Outlines of the grousers of a belt that has run so far, in its carrier's frame."""
    belt, shapes = geometry["root_envelope"], geometry["grousers"]
    line = closed(belt)  # counter-clockwise; its last side is the lower run
    sides = np.diff(line, axis=0)
    lengths = np.hypot(*sides.T)
    ways = np.concatenate([[0.0], np.cumsum(lengths)])
    lines = []
    for index, corners in enumerate(shapes):
        # They start at the rear end of the lower run, and the belt runs clockwise.
        way = (ways[-2] - index / len(shapes) * ways[-1] - run) % ways[-1]
        side = min(int(np.searchsorted(ways, way, side="right")) - 1, len(sides) - 1)
        along = sides[side] / lengths[side]
        outward = np.array([along[1], -along[0]])
        place = line[side] + (way - ways[side]) * along
        lines.append(closed(place - corners[:, :1] * along + corners[:, 1:] * outward))
    return lines


def shoes(run: Record, geometry: dict[str, Any], sample: int) -> list[NDArray[np.float64]]:
    """[m] Outlines of the pieces of the shoes of the near track where they are at a sample."""
    lines = []
    for shoe, corners in geometry["shoes"]:
        *place, angle = run.shoe_poses[sample, shoe]
        lines.append(closed(_moved(corners, angle, place)))
    return lines


def pins(run: Record, geometry: dict[str, Any]) -> NDArray[np.float64]:
    """[m] Rear pins of the n shoes of the near track at each of k samples, shape (k, n, 2).

    The front pin of a shoe is the rear pin of the next one; of the last, that of the first.
    """
    near = sorted({shoe for shoe, _ in geometry["shoes"]})
    # Plates reach from pin to pin.
    half = max((corners[:, 0].max() for _, corners in geometry["shoes"]), default=0.0)
    x, y, angle = np.moveaxis(run.shoe_poses[:, near], 2, 0)
    there: NDArray[np.float64] = np.stack([x - half * np.cos(angle), y - half * np.sin(angle)], 2)
    return there


def closed(polygon: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] A polygon as a line that ends where it began."""
    return np.vstack([polygon, polygon[:1]])


def inset(belt: NDArray[np.float64], depth: float) -> NDArray[np.float64]:
    """[m] A closed convex line, counter-clockwise, moved inwards by a depth."""
    way = np.roll(belt, -1, axis=0) - belt
    belt = belt[np.hypot(*way.T) > 1e-9]  # without corners that coincide
    way = np.roll(belt, -1, axis=0) - belt
    inwards = np.column_stack([-way[:, 1], way[:, 0]])
    inwards /= np.hypot(*way.T)[:, None]
    inwards = inwards + np.roll(inwards, 1, axis=0)
    moved: NDArray[np.float64] = belt + depth * inwards / np.hypot(*inwards.T)[:, None]
    return moved
