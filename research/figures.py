"""Common parts of figures: panels, legends, rates, and a chart of dots."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crawler2d.common.extras import extra
from crawler2d.drawings.palette import look_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

GREY = "#666666"


def make_panels(
    rows: int, columns: int, size: tuple[float, float], **options: Any
) -> tuple[Figure, NDArray[Any]]:
    """Make a figure of a size [in] with its axes, shape (rows, columns).

    Raises
    ------
    ImportError
        If matplotlib is missing; the message names the extra to install.
    """
    figure: Figure = extra("matplotlib.figure", "plot").Figure(size, layout="constrained")
    return figure, figure.subplots(rows, columns, squeeze=False, **options)


def add_legend(figure: Figure, ax: Axes, place: str, **more: Any) -> None:
    """Put one legend, with the labels of one panel, outside all panels."""
    handles, labels = ax.get_legend_handles_labels()
    options: Any = {"loc": f"outside {place}", "ncols": len(labels)} | more
    figure.legend(handles, labels, **options)


def join_legends(figure: Figure, axes: Sequence[Axes]) -> None:
    """Replace the legends of drawings by a common one below them, without measured values."""
    shown: dict[str, Any] = {}
    for ax in axes:
        for handle, label in zip(*ax.get_legend_handles_labels(), strict=True):
            shown.setdefault(re.split(r", up to|: \d", label)[0], handle)
        if (own := ax.get_legend()) is not None:
            own.remove()
    figure.legend(shown.values(), shown, loc="outside lower center", ncols=2, fontsize="small")


def light_grid(ax: Axes) -> None:
    """Draw a grid, and no frame at the top and right."""
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)


def draw_rates(ax: Axes, cells: Sequence[Any], *, alpha: float, **line: Any) -> None:
    """Draw rates over heights, with their intervals as a band."""
    heights = [1e3 * cell.height for cell in cells]
    lows, highs = [1e2 * cell.low for cell in cells], [1e2 * cell.high for cell in cells]
    ax.fill_between(heights, lows, highs, color=line["color"], alpha=alpha, linewidth=0.0)
    ax.plot(heights, [1e2 * cell.rate for cell in cells], **line)
    ax.grid(alpha=0.25)


def save_svg(figure: Figure, path: Path) -> None:
    """Write a figure as SVG with text as text; equal figures give equal files."""
    fixed = {"svg.fonttype": "none", "svg.hashsalt": "crawler2d"}
    with extra("matplotlib", "plot").rc_context(fixed):
        figure.savefig(path, metadata={"Date": None})


def draw_dots(
    rows: Mapping[str, Mapping[str, float]], label: str, path: Path, *, scale: str = "linear"
) -> None:
    """Write a chart with a row for each case and a dot for each series, as SVG.

    `rows` have values by series; the first row is on top.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "chart.svg"
    ...     draw_dots({"a": {"one": 1.0, "two": 2.0}, "b": {"one": 3.0}}, "length [m]", path)
    ...     "length [m]" in path.read_text("utf-8")
    True
    """
    figure, ((ax,),) = make_panels(1, 1, (7.0, 1.2 + 0.28 * len(rows)))
    series = list(dict.fromkeys(name for values in rows.values() for name in values))
    for index, name in enumerate(series):
        points = [(values[name], y) for y, values in enumerate(rows.values()) if name in values]
        x, y = zip(*points, strict=True)
        dots = look_of(index) | {"linestyle": ""}
        ax.plot(x, y, **dots, label=name, markersize=6, alpha=0.8)
    ax.set(xlabel=label, xscale=scale, yticks=range(len(rows)), yticklabels=list(rows))
    ax.invert_yaxis()
    light_grid(ax)
    figure.legend(loc="outside lower center", ncols=len(series), frameon=False)
    save_svg(figure, path)
