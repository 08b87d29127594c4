"""From a run to the data that its page draws: plain, compact and ready for JSON."""

from __future__ import annotations

import base64
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import read_instants
from crawler2d.common.bodies import BodyKind
from crawler2d.drawings.scene import relative
from crawler2d.parameters.flippers import reach_of
from crawler2d.pictures.scenes import ghosts, scene_of, usual_force, usual_speed

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from crawler2d.drawings.scene import Carrier, Circuit, Scene
    from crawler2d.parameters.robot import Robot
    from crawler2d.results.record import Record

__all__ = ["MOST_FRAMES", "pack", "recording"]

MOST_FRAMES = 3000
"""Samples in the page of a run, give or take the last one."""

# Finer than a pixel at any sensible zoom, coarse enough for 16 bits in a typical run.
_LENGTH, _ANGLE, _TIME, _SPEED = 1e-5, 1e-4, 1e-4, 1e-4
# The same for arrows, as a fraction of the usual size, which is drawn about 100 pixels long.
_ARROW = 1e-2

_SHAPE = 5e-6
"""[m] Resolution of outlines."""
_PLACE = 5e-5
"""[m] Resolution of positions on the chassis or a flipper; 16 bits suffice up to three metres."""
_RIM = 1e-4
"""[m] Resolution of a rotation, as the movement of a body's farthest point."""
_TURN = 1e-3
"""[rad] Resolution of angles along a belt."""


def recording(run: Record, time: float | None = None, *, most: int = MOST_FRAMES) -> dict[str, Any]:
    """Collect the data that the page of a run draws.

    Parameters
    ----------
    run : Run
        A run with history.
    time : float, optional
        [s] Instant to open at; None takes the end if the run ended in a stop, else the start.
    most : int
        Largest number of samples, give or take the last one; longer runs are thinned.

    Returns
    -------
    dict
        Plain data without non-finite numbers; arrays in the form of `pack`.
    """
    count = run.time.size
    every = max(1, math.ceil(count / most))
    kept = np.unique(np.append(np.arange(0, count, every), count - 1))
    if time is None:
        stops = run.events["end"][run.events["kind"] == "stop"]
        time = float(run.time[-1] if (stops == run.time[-1]).any() else run.time[0])
    instant = read_instants(time, "time", run.time, several=False)[0]
    scene = scene_of(run)
    return {
        "samples": count,
        "every": every,
        "first": int(np.abs(run.time[kept] - instant).argmin()),
        "extent": [_number(value) for value in scene.extent()],
        "frames": _frames(run, kept),
        "contacts": _contacts(run, kept),
        "events": _events(run, scene),
        "ground": {
            "lanes": [_lane(*lane, scene.edges) for lane in scene.lanes],
            "goal": _number(scene.goal),
        },
        "ghosts": [
            {"belt": each.is_belt, "frames": each.frames.round(5).tolist()} for each in ghosts(run)
        ],
        "robot": _Robot(run, scene, kept).data(),
    }


def _frames(run: Record, kept: NDArray[np.int64]) -> dict[str, Any]:
    return {
        "count": int(kept.size),
        "time": pack(run.time[kept], _TIME),
        "x": pack(run.position[kept, 0], _LENGTH),
        "y": pack(run.position[kept, 1], _LENGTH),
        "angle": pack(run.chassis_angle[kept], _ANGLE),
        "speed": pack(run.track_speed[kept], _SPEED),
        "commanded": pack(run.commanded_speed[kept], _SPEED),
    }


def _contacts(run: Record, kept: NDArray[np.int64]) -> dict[str, Any]:
    """Collect the contacts of the kept samples; `counts` has their number in each frame."""
    table = run.contacts
    frames = np.searchsorted(run.time, table["time"])
    rows = np.flatnonzero(np.isin(frames, kept))
    force, speed = usual_force(run), usual_speed(run)
    counts = np.bincount(frames[rows], minlength=run.time.size)
    return {
        "counts": pack(counts[kept], 1.0),
        "x": pack(table["x"][rows], _LENGTH),
        "y": pack(table["y"][rows], _LENGTH),
        "normal": pack(np.arctan2(table["normal_y"], table["normal_x"])[rows], _ANGLE),
        "normal_force": pack(table["normal_force"][rows], _ARROW * force),
        "friction_force": pack(table["friction_force"][rows], _ARROW * force),
        "surface_speed": pack(table["surface_speed"][rows], _ARROW * speed),
        "usual_force": force,
        "usual_speed": speed,
    }


def _events(run: Record, scene: Scene) -> list[dict[str, Any]]:
    events = run.events
    return [
        {
            "kind": str(events["kind"][row]),
            "start": _number(events["start"][row]),
            "end": _number(events["end"][row]),
            "lane": int(events["lane"][row]),
            "edge": int(events["edge"][row]),
            "bodies": [int(body) for body in events["bodies"][row]],
            "carrier": next((scene.carrier_of(body) for body in events["bodies"][row]), 0),
        }
        for row in range(len(events))
    ]


def _lane(lane: int, profile: NDArray[np.float64], edges: dict[str, Any]) -> dict[str, Any]:
    on_lane = edges["lane"] == lane
    # A rounded edge is marked on the ground, not where the sharp corner would be.
    corners = [
        int(np.hypot(profile[:, 0] - x, profile[:, 1] - y).argmin())
        for x, y in zip(edges["x"][on_lane], edges["y"][on_lane], strict=True)
    ]
    return {
        "lane": int(lane),
        "profile": pack(profile, _LENGTH / 100.0),
        "ids": edges["id"][on_lane].tolist(),
        "corners": corners,
        "convex": [bool(angle > 0.0) for angle in edges["angle"][on_lane]],
    }


def _length(robot: Robot) -> float:
    """[m] Length of robot to fit into the view: the track with one flipper stretched out."""
    outline, flippers = robot.outline, robot.flippers
    beyond = reach_of(flippers, robot.track)
    radius = max(outline.front_radius, outline.rear_radius)
    track = outline.axle_distance + outline.front_radius + outline.rear_radius
    return track + max(0.0, beyond - radius)


def _number(value: float) -> float | None:
    """Return None for non-finite numbers, which JSON does not have."""
    return float(value) if math.isfinite(value) else None


class _Robot:
    """A robot at selected samples of a run; equal columns and outlines are stored once."""

    def __init__(self, run: Record, scene: Scene, kept: NDArray[np.int64]) -> None:
        self.robot, self.scene, self.kept = run.scenario.robot, scene, kept
        self.columns, self.outlines = _UniqueArrays(), _UniqueArrays()

    def data(self) -> dict[str, Any]:
        """Collect the carriers of tracks, and everything that is drawn on each.

        Returns
        -------
        dict
            `carriers`: the chassis first, each with its bodies, in its own frame; `columns`: values
            of poses that change, referred to as `{"column": index}`; `outlines`: those of the
            bodies, referred to by index; `mass_center`: [m] in the chassis frame; `length`: [m] to
            fit into the view.
        """
        carriers = [self._carrier(carrier) for carrier in self.scene.carriers]
        center = self.scene.center_of_mass
        center = np.column_stack([center, np.zeros(len(center))])
        pose = self._pose(center, self.scene.carriers[0], 0.0)
        return {
            "carriers": carriers,
            "mass_center": [pose["x"], pose["y"]],
            "columns": self.columns.items,
            "outlines": self.outlines.items,
            "length": _length(self.robot),
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
        """Collect all bodies except the grousers of a belt; the pieces of a shoe are one body."""
        bodies: list[dict[str, Any]] = []
        shoes: dict[int, dict[str, Any]] = {}
        riders = set() if carrier.circuit is None else set(carrier.circuit.grousers.tolist())
        columns = self.scene.bodies
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
                "look": self.scene.looks[row].value,
                "outlines": [self._outline(row)],
            }
            if self.scene.kinds[row] == BodyKind.SHOE:
                shoes[shoe] = body
                # A plate reaches from pin to pin, and is equally thick on both sides of the pins.
                x, y = corners.min(axis=0).tolist()
                body |= {"pin": x, "pin_radius": -0.5 * y}
            bodies.append(body)
        return bodies

    def _circuit(self, circuit: Circuit) -> dict[str, Any]:
        x, y, angle = circuit.poses.T
        travel = self.scene.travels[self.kept, circuit.belt]
        return {
            "travel": self.columns.number(travel, _RIM),
            "ways": pack(circuit.ways, _PLACE),
            "length": float(circuit.ways[-1]),
            "x": pack(x, _SHAPE),
            "y": pack(y, _SHAPE),
            "angle": pack(angle, _TURN),
            "grousers": [self._outline(row) for row in circuit.grousers],
            "starts": circuit.starts.tolist(),
            "pitch": self.robot.outline.grouser_pitch,
        }

    def _belts(self, carrier: Carrier) -> dict[str, Any]:
        """Collect the envelopes of a carrier; a closed track has none, as nothing gets inside."""
        if carrier.closed:
            return {"envelope": None, "inner": None, "root": None}
        envelope, root = carrier.envelope, carrier.root_envelope
        return {
            "envelope": pack(envelope, _SHAPE),
            "inner": pack(carrier.inner, _SHAPE),
            "root": None if np.array_equal(root, envelope) else pack(root, _SHAPE),
        }

    def _pose(self, poses: NDArray[np.float64], carrier: Carrier, reach: float) -> dict[str, Any]:
        """[m, m, rad] Poses of a body with this reach [m], relative to its carrier."""
        x, y, angle = relative(poses, carrier.poses)[self.kept].T
        turn = _RIM / reach if reach > 0.0 else np.inf
        return {
            "x": self.columns.number(x, _PLACE),
            "y": self.columns.number(y, _PLACE),
            "angle": self.columns.number(angle, turn),
        }

    def _outline(self, body: int) -> int:
        return self.outlines.index(self.scene.bodies["outline"][body], _SHAPE)


class _UniqueArrays:
    """Arrays that are sent only once, however often they occur."""

    def __init__(self) -> None:
        self.items: list[dict[str, Any]] = []
        self._indices: dict[str, int] = {}

    def index(self, values: NDArray[np.float64], resolution: float) -> int:
        item = pack(values, resolution)
        index = self._indices.setdefault(repr(item), len(self.items))
        if index == len(self.items):
            self.items.append(item)
        return index

    def number(self, values: NDArray[np.float64], resolution: float) -> float | dict[str, int]:
        """Replace a column that does not change by a number."""
        if np.ptp(values) <= resolution:
            return float(values[0])
        return {"column": self.index(values, resolution)}


def pack(values: ArrayLike, resolution: float) -> dict[str, Any]:
    """Pack numbers for the page, flattened row by row; `unpack` in data.js reverses it.

    Parameters
    ----------
    values : array_like
        Numbers; non-finite ones are kept.
    resolution : float
        Largest quantization step that the page may show, in the unit of the values.

    Returns
    -------
    dict
        `bits` per number and `data`; also `start` and `step` if the numbers are integer multiples.

    Examples
    --------
    >>> pack([0.0, 0.5, 1.0], resolution=0.1)
    {'bits': 8, 'data': 'AID/', 'start': 0.0, 'step': 0.00392156862745098}
    >>> pack([0.0, 1.0], resolution=1e-9)
    {'bits': 32, 'data': 'AAAAAAAAgD8='}
    """
    numbers = np.asarray(values, dtype=np.float64).ravel()
    low, high = (float(numbers.min()), float(numbers.max())) if numbers.size else (0.0, 0.0)
    for bits in (8, 16):
        step = (high - low) / (2**bits - 1)  # not finite if any number is not
        if step <= resolution:
            counts = np.rint((numbers - low) / step) if step > 0.0 else np.zeros(numbers.size)
            data = _text(counts.astype(f"<u{bits // 8}"))
            return {"bits": bits, "data": data, "start": low, "step": step}
    with np.errstate(over="ignore"):
        return {"bits": 32, "data": _text(numbers.astype("<f4"))}


def _text(array: np.ndarray[Any, Any]) -> str:
    return base64.b64encode(array.tobytes()).decode("ascii")
