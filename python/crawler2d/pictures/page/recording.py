"""From a run to the data that its page draws: plain, compact and ready for JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.pictures.arrows import usual_size
from crawler2d.pictures.ghosts import ghosts
from crawler2d.pictures.page.drawn import drawn
from crawler2d.pictures.page.packed import packed
from crawler2d.pictures.scenes import scene_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Scene
    from crawler2d.parameters.robot import Robot
    from crawler2d.results.record import Record

__all__ = ["MOST_FRAMES", "recording"]

MOST_FRAMES = 3000
"""Samples in the page of a run, give or take the last one."""

# Finer than a pixel at any sensible zoom, coarse enough for 16 bits in a typical run.
_LENGTH, _ANGLE, _TIME = 1e-5, 1e-4, 1e-4
_SPEED = 1e-4
# The same for arrows, as a share of the typical size, which is drawn about 100 pixels long.
_ARROW = 1e-2


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
        Plain data without non-finite numbers; arrays in the form of `packed`.
    """
    count = run.time.size
    every = max(1, math.ceil(count / most))
    kept = np.unique(np.append(np.arange(0, count, every), count - 1))
    if time is None:
        stops = run.events["end"][run.events["kind"] == "stop"]
        time = float(run.time[-1] if (stops == run.time[-1]).any() else run.time[0])
    scene = scene_of(run)
    return {
        "samples": count,
        "every": every,
        "first": int(np.abs(run.time[kept] - time).argmin()),
        "extent": [_number(value) for value in scene.extent()],
        "frames": _frames(run, kept),
        "contacts": _contacts(run, kept),
        "events": _events(run, scene),
        "ground": _ground(scene),
        "ghosts": [
            {"belt": each.is_belt, "frames": each.frames.round(5).tolist()} for each in ghosts(run)
        ],
        "robot": {**drawn(run, scene, kept), "length": _length(run.scenario.robot)},
    }


def _frames(run: Record, kept: NDArray[np.int64]) -> dict[str, Any]:
    return {
        "count": int(kept.size),
        "time": packed(run.time[kept], _TIME),
        "x": packed(run.position[kept, 0], _LENGTH),
        "y": packed(run.position[kept, 1], _LENGTH),
        "angle": packed(run.chassis_angle[kept], _ANGLE),
        "speed": packed(run.track_speed[kept], _SPEED),
        "commanded": packed(run.commanded_speed[kept], _SPEED),
    }


def _contacts(run: Record, kept: NDArray[np.int64]) -> dict[str, Any]:
    """Collect the contacts of the kept samples; `counts` holds how many each frame has."""
    table = run.contacts
    frames = np.searchsorted(run.time, table["time"])
    rows = np.flatnonzero(np.isin(frames, kept))
    normal, friction = table["normal_force"][rows], table["friction_force"][rows]
    forces = np.hypot(normal, friction)
    weight = run.scenario.robot.mass * run.scenario.gravity
    speeds = table["surface_speed"][rows]
    force = usual_size(forces, weight)
    speed = usual_size(np.abs(speeds), abs(run.scenario.drive.speed))
    counts = np.bincount(frames[rows], minlength=run.time.size)
    return {
        "counts": packed(counts[kept], 1.0),
        "x": packed(table["x"][rows], _LENGTH),
        "y": packed(table["y"][rows], _LENGTH),
        "normal": packed(np.arctan2(table["normal_y"], table["normal_x"])[rows], _ANGLE),
        "normal_force": packed(normal, _ARROW * force),
        "friction_force": packed(friction, _ARROW * force),
        "surface_speed": packed(speeds, _ARROW * speed),
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


def _ground(scene: Scene) -> dict[str, Any]:
    """Collect the lanes with their edges, starting with the one farthest from the viewer."""
    return {
        "lanes": [_lane(*lane, scene.edges) for lane in scene.lanes],
        "goal": _number(scene.goal),
    }


def _lane(lane: int, profile: NDArray[np.float64], edges: dict[str, Any]) -> dict[str, Any]:
    on_lane = edges["lane"] == lane
    # A rounded edge is marked on the ground, not where the sharp corner would be.
    corners = [
        int(np.hypot(profile[:, 0] - x, profile[:, 1] - y).argmin())
        for x, y in zip(edges["x"][on_lane], edges["y"][on_lane], strict=True)
    ]
    return {
        "lane": int(lane),
        "profile": packed(profile, _LENGTH / 100.0),
        "ids": edges["id"][on_lane].tolist(),
        "corners": corners,
        "convex": [bool(angle > 0.0) for angle in edges["angle"][on_lane]],
    }


def _length(robot: Robot) -> float:
    """[m] Length of robot to fit into the view: the track with one flipper stretched out."""
    outline, flippers = robot.outline, robot.flippers
    beyond = 0.0 if flippers is None else flippers.length + flippers.tip_radius
    radius = max(outline.front_radius, outline.rear_radius)
    track = outline.axle_distance + outline.front_radius + outline.rear_radius
    return track + max(0.0, beyond - radius)


def _number(value: float) -> float | None:
    """Return None for non-finite numbers, which JSON does not have."""
    return float(value) if math.isfinite(value) else None
