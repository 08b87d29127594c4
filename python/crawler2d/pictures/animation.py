"""Videos of runs in side view with contact forces, as GIF or MP4."""

from __future__ import annotations

import io
import math
import os
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.arrays import real_number
from crawler2d.common.extras import extra
from crawler2d.common.files import part_of
from crawler2d.drawings.canvas import arrange, blank_axes, draw_legend, set_title
from crawler2d.drawings.palette import RED
from crawler2d.drawings.views import Outlines, draw_goal, scene_canvas
from crawler2d.errors import ScenarioError
from crawler2d.pictures.scenes import Envelopes, draw_forces, scene_of, usual_force

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Extent, Scene
    from crawler2d.results.record import Record

__all__ = ["Film", "animate", "palette_of"]

# [s] Additional time for which the last frame is shown.
_HOLD = 1.5
# Few enough for small files, and enough for smooth lines in all colours.
_COLORS = 63
# [lengths of the robot] In a wider view the robot would be too small.
_WIDEST = 5.0
# [lengths of the robot] Size of a view that follows the robot.
_WINDOW = (3.0, 1.6)
# More frames than this are assumed to be a mistake.
_MOST_FRAMES = 10_000
# [inch] Width of the figure, which becomes `width` pixels wide.
_FIGURE_WIDTH = 9.0


def animate(
    runs: Sequence[Record],
    path: str | os.PathLike[str],
    *,
    labels: Sequence[str],
    fps: float,
    speed: float,
    follow: bool | None,
    side_by_side: bool,
    width: int,
    counted: Callable[[int], AbstractContextManager[Callable[[int], None]]],
) -> Path:
    """Write runs as one video; see `Run.animate` and `crawler2d.animate`.

    `counted` takes the number of frames, and returns a context whose value is called with the
    number of frames drawn since its last call. The file appears once it is complete.
    """
    path = Path(path)
    write = {".gif": _write_gif, ".mp4": _write_mp4}.get(path.suffix.lower())
    if write is None:
        raise ScenarioError("path", str(path), "must end in .gif or .mp4")
    fps = _in_range(fps, "fps", (1.0, 50.0))
    speed = _in_range(speed, "speed", (1e-3, 1e3))
    width = round(_in_range(width, "width", (200.0, 4000.0)))
    start, end = min(float(run.time[0]) for run in runs), max(float(run.time[-1]) for run in runs)
    count = math.ceil((end - start) * fps / speed - 1e-9) + 1
    if count > _MOST_FRAMES:
        raise ScenarioError("speed", speed, f"must give at most {_MOST_FRAMES} frames, not {count}")
    times = np.minimum(start + np.arange(count) * speed / fps, end)
    about = "; ".join(run.provenance for run in runs)
    with part_of(path) as part:
        part.touch()  # fails here if the folder is not writable
        film = Film(
            runs,
            times,
            labels=labels,
            pace=speed,
            follow=follow,
            side_by_side=side_by_side,
            width=width,
        )
        with counted(count) as report:
            shown = 0

            def show(number: int) -> None:
                nonlocal shown
                film.show(number)
                if number == shown:  # some frames are needed twice, for the palette or to be held
                    shown += 1
                    report(1)

            write(part, film.figure, show, count, fps, about=about)
    return path


def _in_range(value: float, name: str, bounds: tuple[float, float]) -> float:
    number = real_number(value, name)
    if not bounds[0] <= number <= bounds[1]:
        raise ScenarioError(name, value, f"must be from {bounds[0]:g} to {bounds[1]:g}")
    return number


def _write_gif(
    part: Path, figure: Any, show: Callable[[int], None], count: int, fps: float, *, about: str
) -> None:
    """Write a GIF with one palette for all frames, so that unchanged parts take no space."""
    images = extra("PIL.Image", "animation")

    def shot(number: int) -> Any:
        show(number)
        figure.canvas.draw()
        return images.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])

    probes = [np.asarray(shot(number)) for number in {0, count // 2, count - 1}]
    options = {"palette": palette_of(images, np.concatenate(probes)), "dither": images.Dither.NONE}
    frames = (shot(number).quantize(**options) for number in range(count))
    # A GIF counts in hundredths of a second; rounded like this, the total time is right.
    ends = np.round(100.0 * np.arange(1, count + 1) / fps).astype(int)
    durations = 10 * np.diff(ends, prepend=0)
    durations[-1] += round(1e3 * _HOLD)
    first = next(frames)
    timing: Any = {"duration": durations.tolist(), "loop": 0}
    # Pillow assumes that a partial write to a file was complete.
    whole = io.BytesIO()
    first.save(whole, "GIF", save_all=True, append_images=frames, comment=about, **timing)
    part.write_bytes(whole.getvalue())


def palette_of(images: Any, pixels: NDArray[np.uint8]) -> Any:
    """Return a palette of the most frequent colours unchanged: of surfaces, then of most edges."""
    weights = np.array([1 << 16, 1 << 8, 1], np.uint32)
    codes, counts = np.unique(pixels.reshape(-1, 3) @ weights, return_counts=True)
    codes = codes[np.argsort(-counts)]
    colors = (codes[:, None] // weights) % 256
    # Of colours that Pillow does not distinguish, it might choose a wrong one, as a dirty white.
    _, first = np.unique(colors // 8 @ weights, return_index=True)
    palette = images.new("P", (1, 1))
    palette.putpalette(colors[np.sort(first)[:_COLORS]].ravel().tolist())
    return palette


def _write_mp4(
    part: Path,
    figure: Figure,
    show: Callable[[int], None],
    count: int,
    fps: float,
    *,
    about: str,
) -> None:
    """Write an MP4 that browsers can play, with any ffmpeg."""
    matplotlib = extra("matplotlib", "animation")
    writers = extra("matplotlib.animation", "animation")
    options = {"savefig.bbox": "standard"}
    if not writers.FFMpegWriter.isAvailable():
        ffmpeg = extra("imageio_ffmpeg", "animation")
        options["animation.ffmpeg_path"] = ffmpeg.get_ffmpeg_exe()
    held = [count - 1] * round(fps * _HOLD)
    with matplotlib.rc_context(options):
        writer = writers.FFMpegWriter(fps=fps, codec="h264", metadata={"comment": about})
        with writer.saving(figure, part, dpi=figure.dpi):
            for number in [*range(count), *held]:
                show(number)
                writer.grab_frame()


class Film:
    """A figure with the side views of runs at one of several instants.

    All have the same scales, also for forces, and show the same stretch of ground.

    Parameters
    ----------
    runs : sequence of Run
        Runs with history.
    times : ndarray, shape (k,)
        [s] The instants; before its begin and after its end a run stands still.
    labels : sequence of str
        Name of each run.
    pace : float
        [-] Speed of the film relative to real time.
    follow, side_by_side, width
        See `crawler2d.animate`.
    """

    def __init__(
        self,
        runs: Sequence[Record],
        times: NDArray[np.float64],
        *,
        labels: Sequence[str],
        pace: float,
        follow: bool | None,
        side_by_side: bool,
        width: int,
    ) -> None:
        figures = extra("matplotlib.figure", "animation")
        agg = extra("matplotlib.backends.backend_agg", "animation")
        self.figure = figures.Figure(dpi=width / _FIGURE_WIDTH)
        agg.FigureCanvasAgg(self.figure)
        scenes = [scene_of(run, np.clip(times, run.time[0], run.time[-1])) for run in runs]
        extents = np.array([scene.extent() for scene in scenes])
        left, bottom = extents[:, ::2].min(axis=0).tolist()
        right, top = extents[:, 1::2].max(axis=0).tolist()
        views = _views(scenes, (left, right, bottom, top), follow=follow)
        axes = blank_axes(self.figure, tuple(views[0][0]), len(runs), side_by_side=side_by_side)
        # The length of arrows is relative to that of their robots, so forces are scaled by it.
        sizes = [run.scenario.robot.outline.axle_distance for run in runs]
        scale = max(usual_force(run) / size for run, size in zip(runs, sizes, strict=True))
        forces = f"contact forces, the longest {scale * max(sizes):.0f} N or more"
        note = "" if pace == 1.0 else f" ({pace:g} x real time)"
        self._pictures = [
            _Picture(run, scene, of_run, ax, most=scale * size, label=label, times=times, note=note)
            for run, scene, of_run, ax, size, label in zip(
                runs, scenes, views, axes, sizes, labels, strict=True
            )
        ]
        axes[0].plot([], [], "-", color=RED, linewidth=2.5, label=forces)
        legend = draw_legend(axes[0] if side_by_side else axes[-1], axes)
        titles = [picture.title for picture in self._pictures]
        arrange(self.figure, axes, titles, legend, side_by_side=side_by_side)

    def show(self, number: int) -> None:
        """Draw a frame."""
        for picture in self._pictures:
            picture.show(number)


class _Picture:
    """One run of a film in Axes, with a view [m] for each frame; see `Film`."""

    def __init__(
        self,
        run: Record,
        scene: Scene,
        views: NDArray[np.float64],
        ax: Axes,
        *,
        most: float,
        label: str,
        times: NDArray[np.float64],
        note: str,
    ) -> None:
        self._run, self._views, self._ax, self._most = run, views, ax, most
        self._label, self._times, self._note = label, times, note
        self._samples = np.searchsorted(0.5 * (run.time[1:] + run.time[:-1]), times)
        scene_canvas(scene, tuple(views[0]), ax)
        draw_goal(scene.goal, ax)
        self._moving: list[Outlines | Envelopes] = [Outlines(scene, ax), Envelopes(scene, ax)]
        self._arrows: list[Any] = []
        self.title = set_title(ax, f"{label}: {run.ending}")

    def show(self, number: int) -> None:
        """Draw a frame."""
        left, right, bottom, top = self._views[number]
        self._ax.set(xlim=(left, right), ylim=(bottom, top))
        for each in self._moving:
            each.show(number)
        # Arrows cannot be updated: their number changes.
        for arrow in self._arrows:
            arrow.remove()
        self._arrows = draw_forces(self._run, int(self._samples[number]), self._ax, self._most)
        time, run = float(self._times[number]), self._run
        now = run.ending if time >= run.time[-1] else f"{time:.2f} s{self._note}"
        self.title.set_text(f"{self._label}: {now}")


def _views(
    scenes: Sequence[Scene], extent: Extent, *, follow: bool | None
) -> list[NDArray[np.float64]]:
    """[m] Return left, right, bottom and top of the view of each frame of each run."""
    left, right, bottom, top = extent
    length = max(end - start for start, end, _, _ in (scene.robot_extent() for scene in scenes))
    if follow is None:
        follow = right - left > _WIDEST * length
    places = [scene.carriers[0].poses[:, :2] for scene in scenes]
    if not follow:
        return [np.tile(extent, (len(each), 1)) for each in places]
    return [
        np.column_stack(
            [
                _window(each[:, 0], (left, right), _WINDOW[0] * length),
                _window(each[:, 1], (bottom, top), _WINDOW[1] * length),
            ]
        )
        for each in places
    ]


def _window(
    middle: NDArray[np.float64], whole: tuple[float, float], size: float
) -> NDArray[np.float64]:
    """[m] Return the ends of windows round positions, within the whole range, shape (k, 2)."""
    least, most = whole
    size = min(size, most - least)
    starts = np.clip(middle - 0.5 * size, least, most - size)
    return np.column_stack([starts, starts + size])
