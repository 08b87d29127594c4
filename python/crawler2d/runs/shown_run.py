"""Output of a run: pictures, videos, pages, data sets, files."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, overload

from crawler2d.common.arrays import read_bool
from crawler2d.common.keywords import takes_keywords
from crawler2d.results.record import Record
from crawler2d.runs.progress import Progress, reporter

if TYPE_CHECKING:
    from collections.abc import Sequence
    from os import PathLike
    from pathlib import Path

    import xarray
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from crawler2d.pictures.replay import Replay

__all__ = ["ShownRun"]


class ShownRun(Record):
    """The methods of `Run` that show or write it."""

    def to_xarray(self) -> xarray.Dataset:
        """Copy the history to a labelled dataset.

        Returns
        -------
        xarray.Dataset
            One variable per array, units in the attributes; outcome, metrics and scenario are
            attributes of the dataset. Dimensions: `time`, `axis` ("x", "y") and `drive`; `flipper`,
            and of a chain `shoe` and `pose` ("x", "y", "angle").

        Raises
        ------
        ImportError
            If xarray is missing; the message names the extra to install.
        AttributeError
            If the run was recorded with ``record="summary"``.
        """
        from crawler2d.runs.dataset import to_dataset  # noqa: PLC0415 - optional

        return to_dataset(self)

    @takes_keywords
    def plot(
        self, ax: Axes | None = None, *, time: ArrayLike | None = None, trials: bool = True
    ) -> Axes:
        """Draw the side view: ground, robot at some instants, and contacts at the last of them.

        Parameters
        ----------
        ax : Axes, optional
            Where to draw; None makes a figure.
        time : array_like, shape (k,), optional
            [s] Times at which to draw the robot, within the run; None draws it about every robot
            length.
        trials : bool
            Whether to draw the end of each trial that freed the robot, if its stop is drawn.

        Returns
        -------
        Axes
            With x and y in metres, at equal scale.

        Raises
        ------
        ScenarioError
            If `time` is not a number within the run, or `trials` not True or False.
        ImportError
            If matplotlib is missing; the message names the extra to install.
        AttributeError
            If the run was recorded with ``record="summary"``.

        Examples
        --------
        Side view and history in one figure:

        >>> import matplotlib.pyplot as plt
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> run = c2d.simulate(robot, c2d.terrains.step(0.05))
        >>> figure, (side, *history) = plt.subplots(4, figsize=(8, 9), layout="constrained")
        >>> run.plot(side) is side
        True
        >>> angle, speed, force = run.plot_history(history)
        >>> speed.get_ylabel()
        'speed [m/s]'
        """
        from crawler2d.pictures.side_view import plot_run  # noqa: PLC0415 - optional

        return plot_run(self, ax, time, trials=read_bool(trials, "trials"))

    @takes_keywords
    def plot_history(self, axes: Sequence[Axes] | None = None) -> tuple[Axes, Axes, Axes]:
        """Plot chassis angle, speeds and drive force over time, with stops shaded.

        Parameters
        ----------
        axes : sequence of 3 Axes, optional
            Where to draw; None makes a figure.

        Returns
        -------
        tuple of 3 Axes
            Chassis angle; commanded speed, speed of the track and of the chassis; drive force.

        Raises
        ------
        ImportError
            If matplotlib is missing; the message names the extra to install.
        AttributeError
            If the run was recorded with ``record="summary"``.
        """
        from crawler2d.pictures.side_view import plot_history  # noqa: PLC0415 - optional

        return plot_history(self, axes)

    @takes_keywords
    def animate(
        self,
        path: str | PathLike[str],
        *,
        fps: float = 25.0,
        speed: float = 1.0,
        follow: bool | None = None,
        width: int = 800,
        progress: bool | Progress | None = True,
    ) -> Path:
        """Write a video of the side view with contact forces; it ends with the outcome.

        `crawler2d.animate` puts several runs into one video. The file's comment is `provenance`.

        Parameters
        ----------
        path : str or path-like
            File to write. The suffix sets the format: ``.gif`` for slides and web pages, ``.mp4``
            for a smaller file that can be paused.
        fps : float
            [1/s] Frames per second, from 1 to 50.
        speed : float
            [-] Playback speed relative to real time; below 1 is slow motion.
        follow : bool, optional
            Whether the view moves with the robot. False shows the whole area that it visits; None
            does so unless the robot would be too small to see.
        width : int
            [px] Width of the video, from 200 to 4000.
        progress : bool or callable
            See `simulate_many`; counts frames.

        Returns
        -------
        Path
            The written file, which appears only when complete.

        Raises
        ------
        ScenarioError
            If the suffix is unknown, or a number is out of range.
        ImportError
            If matplotlib, or for an MP4 ffmpeg is missing; the message names the extra to install.
        AttributeError
            If the run was recorded with ``record="summary"``.
        OSError
            If the file cannot be written.
        """
        from crawler2d.pictures.animation import animate  # noqa: PLC0415 - optional

        return animate(
            [self],
            path,
            labels=[self.subject],
            fps=fps,
            speed=speed,
            follow=None if follow is None else read_bool(follow, "follow"),
            side_by_side=False,
            width=width,
            counted=partial(reporter, progress, unit="frame"),
        )

    @overload
    def to_html(self, path: None = None, *, time: float | None = None) -> str: ...

    @overload
    def to_html(self, path: str | PathLike[str], *, time: float | None = None) -> Path: ...

    @takes_keywords
    def to_html(
        self, path: str | PathLike[str] | None = None, *, time: float | None = None
    ) -> str | Path:
        """Write one self-contained HTML page that replays the run.

        A run of more than 3000 samples is thinned to at most 3000, and the page says so.

        Parameters
        ----------
        path : str or path-like, optional
            File to write; None returns the text.
        time : float, optional
            [s] Time at which the page opens; None takes the end if the run stopped, else the
            beginning.

        Returns
        -------
        str or Path
            The text, or the path of the written file.

        Raises
        ------
        ScenarioError
            If `time` is not a number within the run.
        OSError
            If the file cannot be written.
        AttributeError
            If the run was recorded with ``record="summary"``.
        """
        # Imported only when used.
        from crawler2d.common.files import write_text  # noqa: PLC0415
        from crawler2d.pictures.page import replay_page  # noqa: PLC0415

        text = replay_page(self, time)
        return text if path is None else write_text(path, text)

    @takes_keywords
    def save(self, path: str | PathLike[str]) -> Path:
        """Write the run to one file, which `crawler2d.load` reads.

        The file is a NumPy ``.npz``: the scenario as JSON, every array and table, metrics,
        diagnosis and `build`. An existing file is replaced only when the new one is complete.

        Parameters
        ----------
        path : str or path-like
            File to write, with the suffix ``.npz`` or none.

        Returns
        -------
        Path
            The written file.

        Raises
        ------
        ScenarioError
            If the run has no result, see `error`, or the suffix is wrong.
        OSError
            If the file cannot be written.

        Examples
        --------
        NumPy alone reads the history:

        >>> import tempfile
        >>> import numpy as np
        >>> import crawler2d as c2d
        >>> run = c2d.simulate(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
        >>> path = run.save(f"{tempfile.mkdtemp()}/step.npz")
        >>> np.load(path)["trace/position"].shape == run.position.shape
        True
        """
        # Imported only when used.
        from pathlib import Path  # noqa: PLC0415

        from crawler2d.results.run_file import check_suffix, write_run  # noqa: PLC0415

        check_suffix(Path(path), "path")
        write_run(self, Path(path))
        return Path(path)

    @takes_keywords
    def widget(self, *, time: float | None = None) -> Replay:
        """Replay the run in a widget of a live notebook; its time can be read and set.

        Parameters
        ----------
        time : float, optional
            [s] Time at which it opens; None takes the end if the run stopped, else the beginning.

        Returns
        -------
        Replay
            A widget. Its `time` [s] is the displayed instant, for `observe` and `jslink` of
            ipywidgets; `show` replaces the run.

        Raises
        ------
        ScenarioError
            If `time` is not a number within the run.
        ImportError
            If anywidget is missing; the message names the extra to install.
        AttributeError
            If the run was recorded with ``record="summary"``.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> replay = c2d.simulate(robot, c2d.terrains.step(0.05)).widget()
        >>> replay.time = 1.5
        """
        from crawler2d.pictures.replay import Replay  # noqa: PLC0415 - optional

        return Replay(self, time)

    def _repr_html_(self) -> str:
        """Replay the run in a notebook, or show its metrics if there is no history."""
        from crawler2d.pictures.page import embed  # noqa: PLC0415 - costs nothing until used

        return embed(self)
