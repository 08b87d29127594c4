"""A figure whose drawing changes, written as a GIF or an MP4."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

__all__ = ["checked_path", "palette_of", "write_film"]

# [s] How much longer the last frame is shown.
_HOLD = 1.5
# Few enough for small files, and enough for smooth lines in all colours.
_COLORS = 63
_SUFFIXES = (".gif", ".mp4")


def checked_path(path: str | os.PathLike[str]) -> Path:
    """Refuse a path that does not say what to write."""
    checked = Path(path)
    if checked.suffix.lower() not in _SUFFIXES:
        raise ScenarioError("path", str(path), f"must end in {' or '.join(_SUFFIXES)}")
    return checked


def write_film(
    path: Path, figure: Figure, show: Callable[[int], None], *, count: int, fps: float
) -> None:
    """Write a film; the file appears once it is complete.

    Parameters
    ----------
    path : Path
        Where to write it; its suffix says what.
    figure : Figure
        What is filmed, on a canvas of Agg.
    show : callable
        Draws a frame, by its number.
    count : int
        Number of frames.
    fps : float
        [1/s] Frames per second.
    """
    write = _write_gif if path.suffix.lower() == ".gif" else _write_mp4
    with _completed(path) as partial:
        write(partial, figure, show, count, fps)


@contextmanager
def _completed(path: Path) -> Iterator[Path]:
    """Give a path beside another one, and put what was written there in its place in the end."""
    partial = path.with_name(f".{path.stem}-{os.getpid()}{path.suffix}")
    partial.touch()  # here it fails if nothing can be written
    try:
        yield partial
        partial.replace(path)
    finally:
        partial.unlink(missing_ok=True)


def _write_gif(
    partial: Path, figure: Any, show: Callable[[int], None], count: int, fps: float
) -> None:
    """Write a GIF with one palette for all frames, so that what stands still costs nothing."""
    images = extra("PIL.Image", "animation")

    def shot(number: int) -> Any:
        show(number)
        figure.canvas.draw()
        return images.fromarray(np.asarray(figure.canvas.buffer_rgba())[..., :3])

    probes = [np.asarray(shot(number)) for number in {0, count // 2, count - 1}]
    plain = {"palette": palette_of(images, np.concatenate(probes)), "dither": images.Dither.NONE}
    frames = (shot(number).quantize(**plain) for number in range(count))
    # A GIF counts in hundredths of a second; rounded like this they add up to the right time.
    ends = np.round(100.0 * np.arange(1, count + 1) / fps).astype(int)
    durations = 10 * np.diff(ends, prepend=0)
    durations[-1] += round(1e3 * _HOLD)
    first = next(frames)
    first.save(partial, save_all=True, append_images=frames, duration=durations.tolist(), loop=0)


def palette_of(images: Any, pixels: NDArray[np.uint8]) -> Any:
    """Take the most frequent colours as they are: those of surfaces, then those of most edges."""
    weights = np.array([1 << 16, 1 << 8, 1], np.uint32)
    codes, counts = np.unique(pixels.reshape(-1, 3) @ weights, return_counts=True)
    codes = codes[np.argsort(-counts)]
    colors = (codes[:, None] // weights) % 256
    # Of colours that Pillow takes for one it might choose the wrong one, such as a dirty white.
    _, first = np.unique(colors // 8 @ weights, return_index=True)
    palette = images.new("P", (1, 1))
    palette.putpalette(colors[np.sort(first)[:_COLORS]].ravel().tolist())
    return palette


def _write_mp4(
    partial: Path, figure: Figure, show: Callable[[int], None], count: int, fps: float
) -> None:
    """Write an MP4 that browsers can play, with any ffmpeg."""
    matplotlib = extra("matplotlib", "animation")
    writers = extra("matplotlib.animation", "animation")
    options = {"savefig.bbox": "standard"}
    if not writers.FFMpegWriter.isAvailable():
        brought = extra("imageio_ffmpeg", "animation")
        options["animation.ffmpeg_path"] = brought.get_ffmpeg_exe()
    held = [count - 1] * round(fps * _HOLD)
    with matplotlib.rc_context(options):
        writer = writers.FFMpegWriter(fps=fps, codec="h264")
        with writer.saving(figure, partial, dpi=figure.dpi):
            for number in [*range(count), *held]:
                show(number)
                writer.grab_frame()
