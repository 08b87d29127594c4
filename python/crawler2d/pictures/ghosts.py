"""Ghosts: where the robot ended in each trial of a stop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.bodies import moved
from crawler2d.drawings.plane import closed, placed, relative
from crawler2d.results.glossary import TRIALS
from crawler2d.results.sentence import told

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Scene
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
    from_the_start : bool
        Whether the robot drove from the start of its run, not from the stop.
    is_belt : bool
        Whether a belt ran round its bodies.
    frames : ndarray, shape (k, 3)
        [m, m, rad] Poses of its carriers, the chassis first.
    """

    change: str
    said: str
    meaning: str
    freed: bool
    from_the_start: bool
    is_belt: bool
    frames: NDArray[np.float64]


def ghosts(run: Record) -> list[Ghost]:
    """Collect the trials of a run that changed something."""
    why = run.diagnosis
    if why is None:
        return []
    said = {tried: text for tried in why.trials if (text := told(why, tried))}
    return [
        Ghost(
            change=text.partition(":")[0],
            said=text,
            meaning=TRIALS[tried.name],
            freed=tried.freed,
            from_the_start=tried.is_from_the_start,
            is_belt=tried.name.startswith(("closed", "belt")),
            frames=frames,
        )
        for (tried, text), frames in zip(said.items(), _frames(run, list(said)), strict=True)
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


def _frames(run: Record, trials: list[Tried]) -> NDArray[np.float64]:
    """[m, m, rad] Poses of the carriers at the ends of n trials, shape (n, k, 3)."""
    chassis = np.array([(*tried.position, tried.chassis_angle) for tried in trials]).reshape(-1, 3)
    # What runs round the carriers moves none of them.
    last = {name: getattr(run, name)[-1:] for name in ("drive_positions", "shoe_poses")}
    columns = {
        "position": chassis[:, :2],
        "chassis_angle": chassis[:, 2],
        "flipper_angles": np.array([tried.flipper_angles for tried in trials]),
        **{name: np.repeat(values, len(trials), axis=0) for name, values in last.items()},
    }
    arms = moved(run.scenario.to_json(), columns)["arms"]
    return np.concatenate([chassis[:, None], arms], axis=1)
