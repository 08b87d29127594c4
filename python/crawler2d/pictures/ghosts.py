"""Ghosts: where the robot ended in each trial of a stop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.pictures.shapes import closed, placed, relative
from crawler2d.results.glossary import TRIALS
from crawler2d.results.sentence import told

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.parameters.robot import Robot
    from crawler2d.pictures.shapes import Scene
    from crawler2d.results.findings import Tried
    from crawler2d.results.record import Record

__all__ = ["Ghost", "ghost_lines", "ghosts"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Ghost:
    """The robot at the end of a trial.

    Parameters
    ----------
    change, said, meaning : str
        What was changed; the same and what came of it; what that change is.
    freed : bool
        Whether it freed the robot.
    is_belt : bool
        Whether a belt ran round its bodies.
    frames : ndarray, shape (k, 3)
        [m, m, rad] Poses of its carriers, the chassis first.
    """

    change: str
    said: str
    meaning: str
    freed: bool
    is_belt: bool
    frames: NDArray[np.float64]


def ghosts(run: Record) -> list[Ghost]:
    """Collect the trials of a run that changed something."""
    trials = () if run.diagnosis is None else run.diagnosis.trials
    return [
        Ghost(
            change=told(tried).partition(":")[0],
            said=told(tried),
            meaning=TRIALS[tried.name],
            freed=tried.freed,
            is_belt=tried.name.startswith("closed"),
            frames=_frames(run.scenario.robot, tried),
        )
        for tried in trials
        if told(tried)
    ]


def ghost_lines(scene: Scene, ghost: Ghost) -> Iterator[NDArray[np.float64]]:
    """[m] Yield the closed outlines of a ghost: its bodies but shoes, and a belt round them."""
    for carrier, frame in zip(scene.carriers, ghost.frames, strict=True):
        if (ghost.is_belt and not carrier.closed) or any(map(scene.is_shoe, carrier.bodies)):
            yield placed(closed(carrier.envelope), frame)
        for row in carrier.bodies:
            if not scene.is_shoe(row):
                (pose,) = relative(scene.poses[-1:, row], carrier.poses[-1:])
                outline = placed(closed(scene.bodies["outline"][row]), pose)
                yield placed(outline, frame)


def _frames(robot: Robot, tried: Tried) -> NDArray[np.float64]:
    chassis = np.array([*tried.position, tried.chassis_angle])
    frames = [chassis]
    arms = robot.flippers
    if arms is not None:
        ends = {"front": (1.0,), "rear": (-1.0,), "both": (1.0, -1.0)}[arms.ends]
        half = 0.5 * robot.outline.axle_distance
        for end, angle in zip(ends, tried.flipper_angles, strict=True):
            reach = 0.5 * arms.length
            middle = np.array([end * (half + reach * np.cos(angle)), reach * np.sin(angle)])
            turn = tried.chassis_angle + end * angle
            frames.append(np.array([*placed(middle, chassis), turn]))
    return np.array(frames)
