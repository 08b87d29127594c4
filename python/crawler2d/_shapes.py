"""Shapes of a robot as pictures need them: placed, turned, inset; and what a run visits."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.run import Run

__all__ = [
    "SLIVER",
    "circle",
    "closed",
    "extent",
    "grousers",
    "inset",
    "pins",
    "placed",
    "seen_lanes",
    "shoes",
    "turned",
]

SLIVER = 2e-5
"""[m] Lines that coincide enclose slivers of rounding; an intrusion is deeper."""


_MIDDLE = 3  # under the belly


def seen_lanes(geometry: dict[str, Any]) -> list[tuple[int, NDArray[np.float64]]]:
    """Lanes under tracks with their profiles [m], from the farthest from the viewer: the left."""
    return [lane for lane in geometry["lanes"] if lane[0] != _MIDDLE]


def extent(run: Run, geometry: dict[str, Any]) -> tuple[float, float, float, float]:
    """[m] Left, right, bottom and top of what the run visits, with the obstacle's beginning."""
    circles = geometry["circles"]
    reach = float((np.hypot(circles[:, 0], circles[:, 1]) + circles[:, 2]).max()) + 0.05
    x, y = run.position.T
    left, right = float(x.min()) - reach, float(x.max()) + reach
    visited = []
    for _, profile in seen_lanes(geometry):
        visited.append(profile[(profile[:, 0] > left) & (profile[:, 0] < right), 1])
        visited.append(np.interp([left, right], profile[:, 0], profile[:, 1]))
    ground = np.concatenate(visited)
    bottom = min(float(ground.min()), float(y.min()) - float(circles[:, 2].max()))
    return left, right, bottom - 0.05, max(float(ground.max()), float(y.max()) + reach)


def circle(x: float, y: float, radius: float) -> NDArray[np.float64]:
    """[m] A circle as a closed line, shape (n, 2)."""
    angles = np.linspace(0.0, 2.0 * np.pi, 181)
    line: NDArray[np.float64] = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    line += (x, y)
    return line


def placed(run: Run, sample: int, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Points of the chassis frame, shape (n, 2), where they are at a sample."""
    there: NDArray[np.float64] = points @ _rotation(run.chassis_angle[sample]).T
    there += run.position[sample]
    return there


def _rotation(angle: float) -> NDArray[np.float64]:
    cosine, sine = np.cos(angle), np.sin(angle)
    return np.array([[cosine, -sine], [sine, cosine]])


def turned(gear: dict[str, Any], positions: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Outline of a gear in the chassis frame, turned as far as its drive has run."""
    angle = 0.0 if gear["drive"] is None else -positions[gear["drive"]] / gear["radius"]
    outline: NDArray[np.float64] = gear["outline"] @ _rotation(angle).T + gear["center"]
    return closed(outline)


def grousers(geometry: dict[str, Any], run: float) -> list[NDArray[np.float64]]:
    """[m] Outlines of the grousers of a belt that has run so far, in the chassis frame."""
    belt, shapes = geometry["root_envelope"], geometry["grousers"]
    line = closed(belt)  # counter-clockwise; its last side is the lower run
    sides = np.diff(line, axis=0)
    lengths = np.hypot(*sides.T)
    ways = np.concatenate([[0.0], np.cumsum(lengths)])
    outlines = []
    for index, corners in enumerate(shapes):
        # They start at the rear end of the lower run, and the belt runs clockwise.
        way = (ways[-2] - index / len(shapes) * ways[-1] - run) % ways[-1]
        side = min(int(np.searchsorted(ways, way, side="right")) - 1, len(sides) - 1)
        along = sides[side] / lengths[side]
        outward = np.array([along[1], -along[0]])
        place = line[side] + (way - ways[side]) * along
        outlines.append(closed(place - corners[:, :1] * along + corners[:, 1:] * outward))
    return outlines


def shoes(run: Run, geometry: dict[str, Any], sample: int) -> list[NDArray[np.float64]]:
    """[m] Outlines of the pieces of the shoes of the near track where they are at a sample."""
    outlines = []
    for shoe, corners in geometry["shoes"]:
        x, y, angle = run.shoe_poses[sample, shoe]
        outlines.append(closed(corners @ _rotation(angle).T + (x, y)))
    return outlines


def pins(run: Run, geometry: dict[str, Any]) -> NDArray[np.float64]:
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
