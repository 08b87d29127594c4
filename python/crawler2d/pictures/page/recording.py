"""From a run to what its page draws: plain data, compact and fit for JSON."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.pictures.page.packed import packed
from crawler2d.pictures.shapes import (
    SLIVER,
    carrier_of,
    extent,
    inset,
    mass_share,
    pins,
    seen_lanes,
)

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.parameters.robot import Robot
    from crawler2d.results.record import Record

__all__ = ["MOST_FRAMES", "recording"]

MOST_FRAMES = 3000
"""Samples that a page holds at most, give or take the last; longer runs are thinned."""

# Finer than a pixel at any sensible zoom, wide enough for 16 bits in a usual run.
_LENGTH, _SHAPE, _ANGLE, _TIME = 1e-5, 5e-6, 1e-4, 1e-4
_SPEED = 1e-4
_WAY = 1e-4
# From the chassis, so that 16 bits do for a robot of three metres.
_PIN = 5e-5
# The same for arrows, as a share of the usual size, which is drawn some 100 pixels long.
_ARROW = 1e-2
# Impacts last one sample; arrows as long as theirs would leave all others unreadable.
_USUAL = 98.0


def recording(run: Record, time: float | None = None) -> dict[str, Any]:
    """Collect what the page of a run draws.

    Parameters
    ----------
    run : Record
        A run with history.
    time : float, optional
        [s] Instant to open at; None takes the end where the run stopped, else the beginning.

    Returns
    -------
    dict
        Plain data without non-finite numbers; arrays as of `packed`.
    """
    count = run.time.size
    every = max(1, math.ceil(count / MOST_FRAMES))
    kept = np.unique(np.append(np.arange(0, count, every), count - 1))
    if time is None:
        stops = run.events["end"][run.events["kind"] == "stop"]
        time = float(run.time[-1] if (stops == run.time[-1]).any() else run.time[0])
    geometry = _core.geometry(run.scenario.to_json())
    bounds = extent(run, geometry)
    return {
        "samples": count,
        "every": every,
        "first": int(np.abs(run.time[kept] - time).argmin()),
        "extent": [_number(value) for value in bounds],
        "frames": _frames(run, geometry, kept),
        "contacts": _contacts(run, kept),
        "events": _events(run, geometry),
        "ground": _ground(geometry),
        "robot": _robot(run, geometry),
    }


def _frames(run: Record, geometry: dict[str, Any], kept: NDArray[np.int64]) -> dict[str, Any]:
    rear_pins = _on_chassis(run, pins(run, geometry))
    return {
        "count": int(kept.size),
        "drives": int(run.drive_positions.shape[1]),
        "shoes": rear_pins.shape[1],
        "time": packed(run.time[kept], _TIME),
        "x": packed(run.position[kept, 0], _LENGTH),
        "y": packed(run.position[kept, 1], _LENGTH),
        "angle": packed(run.chassis_angle[kept], _ANGLE),
        "speed": packed(run.track_speed[kept], _SPEED),
        "commanded": packed(run.commanded_speed[kept], _SPEED),
        "ways": packed(run.drive_positions[kept], _WAY),
        "pins": packed(rear_pins[kept], _PIN),
        "flippers": packed(run.flipper_angles[kept], _ANGLE),
    }


def _on_chassis(run: Record, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """[m] Points at each of k samples, shape (k, n, 2), in the chassis frame."""
    x, y = np.moveaxis(points - run.position[:, None], 2, 0)
    cosine, sine = np.cos(run.chassis_angle)[:, None], np.sin(run.chassis_angle)[:, None]
    return np.stack([cosine * x + sine * y, cosine * y - sine * x], 2)


def _shoes(geometry: dict[str, Any]) -> list[list[dict[str, Any]]]:
    """Convex pieces of each shoe of the near track, in the order of the pins."""
    pieces: dict[int, list[dict[str, Any]]] = {}
    for shoe, corners in geometry["shoes"]:
        pieces.setdefault(shoe, []).append(packed(corners, _SHAPE))
    return [pieces[shoe] for shoe in sorted(pieces)]


def _contacts(run: Record, kept: NDArray[np.int64]) -> dict[str, Any]:
    """Contacts of the kept samples, as many a frame as `counts` says."""
    table = run.contacts
    frames = np.searchsorted(run.time, table["time"])
    rows = np.flatnonzero(np.isin(frames, kept))
    normal, friction = table["normal_force"][rows], table["friction_force"][rows]
    forces = np.hypot(normal, friction)
    weight = run.scenario.robot.mass * run.scenario.gravity
    speeds = table["surface_speed"][rows]
    force, speed = weight, abs(run.scenario.drive.speed)
    if rows.size:
        force = max(force, float(np.percentile(forces, _USUAL)))
        speed = max(speed, float(np.percentile(np.abs(speeds), _USUAL)))
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


def _events(run: Record, geometry: dict[str, Any]) -> list[dict[str, Any]]:
    events = run.events
    return [
        {
            "kind": str(events["kind"][row]),
            "start": _number(events["start"][row]),
            "end": _number(events["end"][row]),
            "edge": int(events["edge"][row]),
            "bodies": [int(body) for body in events["bodies"][row]],
            # The chassis, or one of the flippers counted from 1.
            "carrier": carrier_of(geometry, *events["bodies"][row][:1]),
        }
        for row in range(len(events))
    ]


def _ground(geometry: dict[str, Any]) -> dict[str, Any]:
    """Lanes from the farthest from the viewer, with their edges."""
    return {
        "lanes": [_lane(*lane, geometry["edges"]) for lane in seen_lanes(geometry)],
        "goal": _number(geometry["goal"]),
    }


def _lane(lane: int, profile: NDArray[np.float64], edges: dict[str, Any]) -> dict[str, Any]:
    on_lane = edges["lane"] == lane
    # Rounded edges are marked where they are on the ground, not where they would be sharp.
    corners = [
        int(np.hypot(profile[:, 0] - x, profile[:, 1] - y).argmin())
        for x, y in zip(edges["x"][on_lane], edges["y"][on_lane], strict=True)
    ]
    return {
        "profile": packed(profile, _LENGTH / 100.0),
        "corners": corners,
        "convex": [bool(angle > 0.0) for angle in edges["angle"][on_lane]],
    }


def _robot(run: Record, geometry: dict[str, Any]) -> dict[str, Any]:
    """Collect the tracks, each in the frame of what carries it, and what else is drawn."""
    robot = run.scenario.robot
    arms = robot.flippers
    flippers = [
        {
            **_track(run, flipper, moving=(arms.track or robot.track).kind != "force"),
            "pivot": [_number(value) for value in flipper["pivot"]],
            "arm": [_number(value) for value in flipper["arm"]],
            "sign": float(flipper["sign"]),
        }
        for flipper in geometry["flippers"]
        if arms is not None
    ]
    belly = geometry["belly"]
    return {
        **_track(run, geometry, moving=robot.track.kind != "force"),
        "flippers": flippers,
        "flipper_mass_share": mass_share(robot),
        "drive_radius": _number(geometry["drive_radius"]),
        "shoes": _shoes(geometry),
        "pin_radius": _pin_radius(geometry),
        "belly": packed(belly, _SHAPE) if len(belly) else None,
        "pitch": robot.outline.grouser_pitch,
        "length": _length(robot),
        "axles": robot.outline.axle_distance / 2.0,
        "mass_center": [_number(value) for value in robot.center_of_mass],
    }


def _track(run: Record, track: dict[str, Any], *, moving: bool) -> dict[str, Any]:
    """Shapes in the frame of the chassis or a flipper, and which drive moves each."""
    gears = track["gears"]
    wheels: list[dict[str, Any]] = [
        {
            "x": _number(x),
            "y": _number(y),
            "radius": _number(radius),
            "drive": int(drive),
            "body": int(body),
        }
        for (x, y, radius), drive, body in zip(
            track["circles"], track["drives"], track["bodies"], strict=True
        )
    ]
    for wheel, gear in zip(wheels, gears, strict=False):
        wheel["outline"] = packed(gear["outline"], _SHAPE)
    sprocket = track.get("sprocket")
    if sprocket:  # the first of the wheels in its chain, which all turn with it
        for wheel in wheels:
            wheel["drive"] = int(sprocket["drive"])
        outline = packed(sprocket["outline"], _SHAPE)
        wheels[0] |= {"radius": _number(sprocket["radius"]), "outline": outline}
    # Nothing gets inside a belt or a chain; wheels in a chain are seen in place of a hull.
    closed = bool(track["hull"])
    hull = closed and not sprocket
    envelope = track["envelope"]
    depth = max(run.scenario.criteria.intrusion_depth, SLIVER)
    shapes = {
        "hull": track["root_envelope"] if hull else None,
        "envelope": None if closed else envelope,
        "inner": None if closed else inset(envelope, depth),
        "root": track["root_envelope"] if gears else None,
    }
    return {
        "wheels": [] if hull else wheels,
        "ends": wheels if hull else [],
        "moving": hull and moving,
        "grousers": [packed(corners, _SHAPE) for corners in track["grousers"]],
        **{
            name: None if shape is None else packed(shape, _SHAPE) for name, shape in shapes.items()
        },
    }


def _length(robot: Robot) -> float:
    """[m] Of what is seen at once: the track with one flipper stretched out."""
    outline, flippers = robot.outline, robot.flippers
    beyond = 0.0 if flippers is None else flippers.length + flippers.tip_radius
    radius = max(outline.front_radius, outline.rear_radius)
    track = outline.axle_distance + outline.front_radius + outline.rear_radius
    return track + max(0.0, beyond - radius)


def _pin_radius(geometry: dict[str, Any]) -> float:
    """[m] Half of what would fill the plate, which is as thick inwards of its pins as outwards."""
    inwards = [-corners[:, 1].min() for _, corners in geometry["shoes"]]
    return 0.5 * float(max(inwards, default=0.0))


def _number(value: float) -> float | None:
    """Take a number as JSON has it: the others are none."""
    return float(value) if math.isfinite(value) else None
