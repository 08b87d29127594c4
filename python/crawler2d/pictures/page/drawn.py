"""What a page draws of a robot: outlines once, poses at every frame, as short as they can be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.pictures.page.packed import packed
from crawler2d.pictures.shapes import SLIVER, inset, relative
from crawler2d.results.bodies import BodyKind

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.pictures.shapes import Carrier, Circuit, Scene
    from crawler2d.results.record import Record

__all__ = ["drawn"]

_SHAPE = 5e-6
"""[m] Resolution of outlines, ..."""
_PLACE = 5e-5
"""... of places on the chassis or a flipper: 16 bits do for a robot of three metres, ..."""
_RIM = 1e-4
"""... and of the way of what is farthest from the middle of a body that turns."""


def drawn(run: Record, scene: Scene, kept: NDArray[np.int64]) -> dict[str, Any]:
    """Collect the carriers of tracks, and all that is drawn on each, at some samples of a run.

    Returns
    -------
    dict
        `carriers`: the chassis first, each with its bodies, in its own frame; `columns`: what of
        their poses changes, and is there a number or `{"column": index}`; `outlines`: those of the
        bodies, there by their indices; `mass_center`: [m] in the chassis frame.
    """
    robot = run.scenario.robot
    changing, outlines = _Once(), _Once()
    chassis = scene.carriers[0].poses[kept]
    center = np.column_stack([scene.center_of_mass, np.zeros(run.time.size)])[kept]
    halves = [robot.outline.axle_distance / 2.0]
    if robot.flippers is not None:
        halves += [robot.flippers.length / 2.0] * (len(scene.carriers) - 1)
    carriers = []
    for carrier, half in zip(scene.carriers, halves, strict=True):
        frames = carrier.poses[kept]
        reach = float(np.hypot(*carrier.envelope.T).max())
        carriers.append(
            {
                **changing.pose(relative(frames, chassis), reach),
                "half": half,
                "bodies": _bodies(scene, carrier, kept, changing, outlines),
                "circuit": _circuit(run, scene, carrier.circuit, kept, changing, outlines),
                **_belts(run, carrier),
            }
        )
    mass_center = changing.pose(relative(center, chassis), 0.0)
    return {
        "carriers": carriers,
        "mass_center": [mass_center["x"], mass_center["y"]],
        "columns": changing.items,
        "outlines": outlines.items,
    }


class _Once:
    """Arrays that are sent once, however often they occur."""

    def __init__(self) -> None:
        self.items: list[dict[str, Any]] = []
        self._indices: dict[str, int] = {}

    def add(self, values: NDArray[np.float64], resolution: float) -> int:
        item = packed(values, resolution)
        index = self._indices.setdefault(repr(item), len(self.items))
        if index == len(self.items):
            self.items.append(item)
        return index

    def column(self, values: NDArray[np.float64], resolution: float) -> float | dict[str, int]:
        if np.ptp(values) <= resolution:
            return float(values[0])
        return {"column": self.add(values, resolution)}

    def pose(self, poses: NDArray[np.float64], reach: float) -> dict[str, Any]:
        """Of a body that reaches so far [m] from its origin."""
        x, y, angle = poses.T
        turn = _RIM / reach if reach > 0.0 else np.inf
        return {
            "x": self.column(x, _PLACE),
            "y": self.column(y, _PLACE),
            "angle": self.column(angle, turn),
        }


def _bodies(
    scene: Scene,
    carrier: Carrier,
    kept: NDArray[np.int64],
    changing: _Once,
    outlines: _Once,
) -> list[dict[str, Any]]:
    """Collect all but the grousers of a belt; the pieces of a shoe are one body."""
    bodies: list[dict[str, Any]] = []
    of_shoes: dict[int, dict[str, Any]] = {}
    riders = set() if carrier.circuit is None else set(carrier.circuit.grousers.tolist())
    columns = scene.bodies
    for row in carrier.bodies.tolist():
        if row in riders:
            continue
        corners, shoe = columns["outline"][row], int(columns["shoe"][row])
        outline = outlines.add(corners, _SHAPE)
        if shoe in of_shoes:
            of_shoes[shoe]["outlines"].append(outline)
            continue
        reach = float(np.hypot(*corners.T).max())
        poses = relative(scene.poses[kept, row], carrier.poses[kept])
        body = {
            **changing.pose(poses, reach),
            "body": int(columns["body"][row]),
            "kind": scene.kinds[row].name.lower(),
            "radius": float(columns["radius"][row]) if columns["radius"][row] > 0.0 else None,
            "outlines": [outline],
        }
        if scene.kinds[row] == BodyKind.SHOE:
            of_shoes[shoe] = body
            # Plates reach from pin to pin, and are as thick inwards of these as outwards.
            body |= {"pin": float(corners[:, 0].min()), "pin_radius": -0.5 * corners[:, 1].min()}
        bodies.append(body)
    return bodies


def _circuit(
    run: Record,
    scene: Scene,
    circuit: Circuit | None,
    kept: NDArray[np.int64],
    changing: _Once,
    outlines: _Once,
) -> dict[str, Any] | None:
    if circuit is None:
        return None
    x, y, angle = circuit.poses.T
    grousers = [outlines.add(scene.bodies["outline"][row], _SHAPE) for row in circuit.grousers]
    return {
        "length": circuit.length,
        "travel": changing.column(scene.travels[kept, circuit.belt], _RIM),
        "x": packed(x, _SHAPE),
        "y": packed(y, _SHAPE),
        "angle": packed(angle, 1e-3),
        "grousers": grousers,
        "starts": [float(start) for start in circuit.starts],
        "pitch": run.scenario.robot.outline.grouser_pitch,
    }


def _belts(run: Record, carrier: Carrier) -> dict[str, Any]:
    """Collect the taut belts round the wheels of a carrier; nothing gets inside others."""
    depth = max(run.scenario.criteria.intrusion_depth, SLIVER)
    belts = {
        "envelope": carrier.envelope,
        "inner": inset(carrier.envelope, depth),
        "root": carrier.root_envelope,
    }
    if carrier.closed:
        return dict.fromkeys(belts)
    if np.array_equal(carrier.root_envelope, carrier.envelope):
        belts.pop("root")
    return {"root": None, **{name: packed(belt, _SHAPE) for name, belt in belts.items()}}
