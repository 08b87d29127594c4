"""A chart of the studies: a row for each case, a dot for each series."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

__all__ = ["draw"]

# Okabe and Ito's palette, which colour-blind readers can tell apart; markers differ, too.
_COLORS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000")
_MARKERS = ("o", "s", "^", "D", "x")


def draw(
    rows: Mapping[str, Mapping[str, float]], label: str, path: Path, *, scale: str = "linear"
) -> None:
    """Write a chart as SVG; `rows` are values by series, the first row on top.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "chart.svg"
    ...     draw({"a": {"one": 1.0, "two": 2.0}, "b": {"one": 3.0}}, "length [m]", path)
    ...     "length [m]" in path.read_text("utf-8")
    True
    """
    series = list(dict.fromkeys(name for values in rows.values() for name in values))
    figure = Figure(figsize=(7.0, 1.2 + 0.28 * len(rows)), layout="constrained")
    ax = figure.subplots()
    for name, color, marker in zip(series, _COLORS, _MARKERS, strict=False):
        points = [(values[name], y) for y, values in enumerate(rows.values()) if name in values]
        x, y = zip(*points, strict=True)
        ax.plot(x, y, marker, color=color, label=name, markersize=6, alpha=0.8)
    ax.set(xlabel=label, xscale=scale, yticks=range(len(rows)), yticklabels=list(rows))
    ax.invert_yaxis()
    ax.grid(alpha=0.25)
    ax.spines[["top", "right"]].set_visible(False)
    figure.legend(loc="outside lower center", ncols=len(series), frameon=False)
    # Text stays text, and equal figures give equal files.
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": "crawler2d"}):
        figure.savefig(path, metadata={"Date": None})
