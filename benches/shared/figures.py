"""What the figures of the studies have in common, and a chart of dots."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

# Okabe and Ito's palette, which colour-blind readers can distinguish; markers differ, too.
COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000")
MARKERS = ("o", "s", "^", "D", "x")
GREY = "#666666"


def save(figure: Figure, path: Path) -> None:
    """Write a figure as SVG."""
    # Text stays text, and equal figures give equal files.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "crawler2d"}):
        figure.savefig(path, metadata={"Date": None})


def light_grid(ax: Axes) -> None:
    """Draw a grid, and no frame at the top and right."""
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)


def draw_dots(
    rows: Mapping[str, Mapping[str, float]], label: str, path: Path, *, scale: str = "linear"
) -> None:
    """Write a chart with a row for each case and a dot for each series, as SVG.

    The first of the `rows`, which are values by series, is on top.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "chart.svg"
    ...     draw_dots({"a": {"one": 1.0, "two": 2.0}, "b": {"one": 3.0}}, "length [m]", path)
    ...     "length [m]" in path.read_text("utf-8")
    True
    """
    series = list(dict.fromkeys(name for values in rows.values() for name in values))
    figure = Figure(figsize=(7.0, 1.2 + 0.28 * len(rows)), layout="constrained")
    ax = figure.subplots()
    for name, color, marker in zip(series, COLORS, MARKERS, strict=False):
        points = [(values[name], y) for y, values in enumerate(rows.values()) if name in values]
        x, y = zip(*points, strict=True)
        ax.plot(x, y, marker, color=color, label=name, markersize=6, alpha=0.8)
    ax.set(xlabel=label, xscale=scale, yticks=range(len(rows)), yticklabels=list(rows))
    ax.invert_yaxis()
    light_grid(ax)
    figure.legend(loc="outside lower center", ncols=len(series), frameon=False)
    save(figure, path)
