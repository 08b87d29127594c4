"""Several runs in one video, side by side or one above the other."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

from crawler2d.common.arrays import read_bool
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.runs.progress import Progress, reporter
from crawler2d.runs.run import Run

if TYPE_CHECKING:
    from os import PathLike
    from pathlib import Path

__all__ = ["animate"]

# More would be too small to see, or a file too large to send.
_MOST = 12


@takes_keywords
def animate(
    runs: Sequence[Run],
    path: str | PathLike[str],
    *,
    labels: Sequence[str] | None = None,
    fps: float = 25.0,
    speed: float = 1.0,
    follow: bool | None = None,
    side_by_side: bool = False,
    width: int = 800,
    progress: bool | Progress | None = True,
) -> Path:
    """Write one video of several runs, synchronised and to the same scale.

    Every run has its own side view with the contact forces. A run that has ended is frozen, with
    its outcome in the title, until the last one ends. A branch is frozen until the time at which it
    branched off.

    Parameters
    ----------
    runs : sequence of Run
        One to twelve runs with history.
    path : str or path-like
        File to write: a ``.gif`` or an ``.mp4``, see `Run.animate`.
    labels : sequence of str, optional
        Label of each run; None uses their track models.
    fps : float
        [1/s] Frames per second, from 1 to 50.
    speed : float
        [-] Playback speed relative to real time; below 1 is slow motion.
    follow : bool, optional
        Whether each view moves with its robot. False shows the whole area that they visit; None
        does so unless the robots would be too small to see.
    side_by_side : bool
        Whether the views are side by side; else they are one above the other.
    width : int
        [px] Width of each picture, from 200 to 4000.
    progress : bool or callable
        See `simulate_many`; counts frames.

    Returns
    -------
    Path
        The written file, which appears only when complete.

    Raises
    ------
    ScenarioError
        If `runs` is empty or holds anything but runs, the number of labels differs, the suffix is
        unknown, or a number is out of range.
    ImportError
        If matplotlib, or for an MP4 ffmpeg is missing; the message names the extra to install.
    AttributeError
        If a run was recorded with ``record="summary"``.
    OSError
        If the file cannot be written.

    Examples
    --------
    >>> import pathlib, tempfile
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None)
    >>> tracks = [c2d.BeltTrack(), c2d.LineOfWheels(4)]
    >>> runs = [
    ...     c2d.simulate(robot.with_track(track), c2d.terrains.step(0.1), duration=0.2)
    ...     for track in tracks
    ... ]
    >>> path = pathlib.Path(tempfile.mkdtemp(), "belt_and_wheels.gif")
    >>> c2d.animate(runs, path, width=300, progress=False).stat().st_size > 1000
    True
    """
    from crawler2d.pictures.animation import animate as write  # noqa: PLC0415 - optional

    batch = _read_runs(runs)
    return write(
        batch,
        path,
        labels=_read_labels(labels, batch),
        fps=fps,
        speed=speed,
        follow=None if follow is None else read_bool(follow, "follow"),
        side_by_side=read_bool(side_by_side, "side_by_side"),
        width=width,
        counted=partial(reporter, progress, unit="frame"),
    )


def _read_runs(runs: Any) -> list[Run]:
    """Take a sequence of runs, and refuse anything else."""
    if not isinstance(runs, (list, tuple)):
        raise ScenarioError("runs", runs, "must be a list of runs: for a single one, run.animate")
    if not 1 <= len(runs) <= _MOST:
        raise ScenarioError("runs", f"{len(runs)} runs", f"must be 1 to {_MOST} runs")
    for number, run in enumerate(runs):
        if not isinstance(run, Run):
            raise ScenarioError(f"runs[{number}]", run, "must be a Run")
    return list(runs)


def _read_labels(labels: Any, runs: list[Run]) -> list[str]:
    if labels is None:
        return [run.scenario.robot.track.description for run in runs]
    if not isinstance(labels, (list, tuple)) or not all(isinstance(each, str) for each in labels):
        raise ScenarioError("labels", labels, "must be a list of strings")
    if len(labels) != len(runs):
        raise ScenarioError("labels", f"{len(labels)} labels", f"must be {len(runs)}, one a run")
    return list(labels)
