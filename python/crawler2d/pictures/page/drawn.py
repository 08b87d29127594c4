"""The robot as the page gets it: each outline once, and the poses at every frame, packed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.bodies import BodyKind
from crawler2d.drawings.plane import SLIVER, inset, relative
from crawler2d.pictures.page.packed import packed

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Carrier, Circuit, Scene
    from crawler2d.results.record import Record

__all__ = ["drawn"]

_SHAPE = 5e-6
"""[m] Resolution of outlines."""
_PLACE = 5e-5
"""[m] Resolution of positions on the chassis or a flipper; 16 bits suffice up to three metres."""
_RIM = 1e-4
"""[m] Resolution of a rotation, as the movement of a body's farthest point."""
_TURN = 1e-3
"""[rad] Resolution of angles along a belt."""


def drawn(run: Record, scene: Scene, kept: NDArray[np.int64]) -> dict[str, Any]:
    """Collect the carriers of tracks, and all that is drawn on each, at selected samples of a run.

    Returns
    -------
    dict
        `carriers`: the chassis first, each with its bodies, in its own frame; `columns`: values
        of poses that change, referred to as `{"column": index}`; `outlines`: those of the bodies,
        referred to by index; `mass_center`: [m] in the chassis frame.
    """
    return _Drawing(run, scene, kept).whole()


class _Drawing:
    """A robot at selected samples; what several bodies share is stored once."""

    def __init__(self, run: Record, scene: Scene, kept: NDArray[np.int64]) -> None:
        self.robot, self.criteria = run.scenario.robot, run.scenario.criteria
        self.scene, self.kept = scene, kept
        self.columns, self.outlines = _Once(), _Once()

    def whole(self) -> dict[str, Any]:
        carriers = [self._carrier(carrier) for carrier in self.scene.carriers]
        center = self.scene.center_of_mass
        center = np.column_stack([center, np.zeros(len(center))])
        pose = self._pose(center, self.scene.carriers[0], 0.0)
        return {
            "carriers": carriers,
            "mass_center": [pose["x"], pose["y"]],
            "columns": self.columns.items,
            "outlines": self.outlines.items,
        }

    def _carrier(self, carrier: Carrier) -> dict[str, Any]:
        chassis, flippers = self.scene.carriers[0], self.robot.flippers
        axles = [end[:2] for end in self.robot.outline.ends]
        if carrier is not chassis and flippers is not None:
            half = flippers.length / 2.0
            axles = [(-half, 0.0), (half, 0.0)]
        reach = float(np.hypot(*carrier.envelope.T).max())
        return {
            **self._pose(carrier.poses, chassis, reach),
            "axles": axles,
            "bodies": self._bodies(carrier),
            "circuit": None if carrier.circuit is None else self._circuit(carrier.circuit),
            **self._belts(carrier),
        }

    def _bodies(self, carrier: Carrier) -> list[dict[str, Any]]:
        """Collect all bodies but the grousers of a belt; the pieces of a shoe are one body."""
        bodies: list[dict[str, Any]] = []
        shoes: dict[int, dict[str, Any]] = {}
        riders = set() if carrier.circuit is None else set(carrier.circuit.grousers.tolist())
        columns, kinds = self.scene.bodies, self.scene.kinds
        for row in carrier.bodies.tolist():
            if row in riders:
                continue
            corners, shoe = columns["outline"][row], int(columns["shoe"][row])
            if shoe in shoes:
                shoes[shoe]["outlines"].append(self._outline(row))
                continue
            reach = float(np.hypot(*corners.T).max())
            body = {
                **self._pose(self.scene.poses[:, row], carrier, reach),
                "body": int(columns["body"][row]),
                "kind": kinds[row].name.lower(),
                "outlines": [self._outline(row)],
            }
            if kinds[row] == BodyKind.SHOE:
                shoes[shoe] = body
                # A plate reaches from pin to pin and is as thick inwards of the pins as outwards.
                x, y = corners.min(axis=0).tolist()
                body |= {"pin": x, "pin_radius": -0.5 * y}
            bodies.append(body)
        return bodies

    def _circuit(self, circuit: Circuit) -> dict[str, Any]:
        x, y, angle = circuit.poses.T
        travel = self.scene.travels[self.kept, circuit.belt]
        return {
            "travel": self.columns.number(travel, _RIM),
            "ways": packed(circuit.ways, _PLACE),
            "length": float(circuit.ways[-1]),
            "x": packed(x, _SHAPE),
            "y": packed(y, _SHAPE),
            "angle": packed(angle, _TURN),
            "grousers": [self._outline(row) for row in circuit.grousers],
            "starts": circuit.starts.tolist(),
            "pitch": self.robot.outline.grouser_pitch,
        }

    def _belts(self, carrier: Carrier) -> dict[str, Any]:
        """Collect the envelopes of a carrier; a closed track has none: nothing gets inside."""
        if carrier.closed:
            return {"envelope": None, "inner": None, "root": None}
        depth = max(self.criteria.intrusion_depth, SLIVER)
        envelope, root = carrier.envelope, carrier.root_envelope
        return {
            "envelope": packed(envelope, _SHAPE),
            "inner": packed(inset(envelope, depth), _SHAPE),
            "root": None if np.array_equal(root, envelope) else packed(root, _SHAPE),
        }

    def _pose(self, poses: NDArray[np.float64], carrier: Carrier, reach: float) -> dict[str, Any]:
        """[m, m, rad] Poses of a body with this reach [m], relative to what carries it."""
        x, y, angle = relative(poses, carrier.poses)[self.kept].T
        turn = _RIM / reach if reach > 0.0 else np.inf
        return {
            "x": self.columns.number(x, _PLACE),
            "y": self.columns.number(y, _PLACE),
            "angle": self.columns.number(angle, turn),
        }

    def _outline(self, body: int) -> int:
        return self.outlines.index(self.scene.bodies["outline"][body], _SHAPE)


class _Once:
    """Arrays that are sent only once, however often they occur."""

    def __init__(self) -> None:
        self.items: list[dict[str, Any]] = []
        self._indices: dict[str, int] = {}

    def index(self, values: NDArray[np.float64], resolution: float) -> int:
        item = packed(values, resolution)
        index = self._indices.setdefault(repr(item), len(self.items))
        if index == len(self.items):
            self.items.append(item)
        return index

    def number(self, values: NDArray[np.float64], resolution: float) -> float | dict[str, int]:
        """Replace a column that does not change by a number."""
        if np.ptp(values) <= resolution:
            return float(values[0])
        return {"column": self.index(values, resolution)}
