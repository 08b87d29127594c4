"""Axes for a drawing to scale, with title and legend, and dimensions as in a technical drawing."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text
    from numpy.typing import NDArray

    from crawler2d.drawings.scene import Extent

__all__ = [
    "Canvas",
    "arrange",
    "axes_or_new",
    "below_axis",
    "blank_axes",
    "check_axes",
    "draw_height",
    "draw_legend",
    "draw_length",
    "draw_radius",
    "moved",
    "set_title",
]

# [inch] Width of a new figure, margins left and right of its drawing, smallest and largest height.
_WIDTH, _LEFT, _RIGHT, _HEIGHTS = 9.0, 0.9, 0.15, (1.2, 6.0)
# [inch] Height of ticks and label below the drawing, and of the gap between rows.
_AXIS, _CLEAR = 0.45, 0.1

# Mean width of a character, as a fraction of the font's size.
_CHARACTER = 0.56
# [characters] A title narrower than this has only one paragraph.
_NARROW = 75

_COLOR = "#555555"
_TEXT: Any = {"color": _COLOR, "fontsize": "x-small", "zorder": 3, "textcoords": "offset points"}
_THIN: Any = {"color": _COLOR, "linestyle": "-", "linewidth": 0.4, "zorder": 1.8}
_ARROW = {"color": _COLOR, "linewidth": 0.7, "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 7}
# [point] From a line to its label.
_OFFSET = 3.0
# [-] End of a view, as a fraction of its width, where a label beside or over a line does not fit.
_LABEL = 0.06


class Canvas:
    """Axes for a drawing to scale, in metres.

    Parameters
    ----------
    ax : Axes or None
        The caller's Axes; None makes new ones.
    extent : tuple of 4 floats
        [m] Left, right, bottom and top.
    figure : Figure, optional
        The figure that new Axes fill; None makes a figure of pyplot.

    Attributes
    ----------
    ax : Axes
        Where to draw.
    title : Text
        The title that `caption` wrote above them.
    """

    title: Text

    def __init__(self, ax: Axes | None, extent: Extent, figure: Figure | None = None) -> None:
        left, right, bottom, top = extent
        self._figure: Figure | None = None
        if ax is None:
            self._figure = figure or extra("matplotlib.pyplot", "plot").figure()
            (ax,) = blank_axes(self._figure, extent)
        self.ax = check_axes(ax, "ax")
        self.ax.set(
            xlim=(left, right), ylim=(bottom, top), xlabel="x [m]", ylabel="y [m]", aspect="equal"
        )

    def caption(self, *paragraphs: str) -> Axes:
        """Write the title above the drawing and its legend below; return the Axes."""
        self.title = set_title(self.ax, *paragraphs)
        legend = draw_legend(self.ax, [self.ax])
        if self._figure is not None:
            arrange(self._figure, [self.ax], [self.title], legend)
        return self.ax


def blank_axes(
    figure: Figure, extent: Extent, count: int = 1, *, side_by_side: bool = False
) -> list[Axes]:
    """Add Axes of the size that drawings of an extent need, which `arrange` then positions.

    Parameters
    ----------
    figure : Figure
        The figure, which the Axes fill.
    extent : tuple of 4 floats
        [m] Left, right, bottom and top of each drawing.
    count : int
        Number of Axes.
    side_by_side : bool
        Whether they will be side by side instead of one above the other.
    """
    left, right, bottom, top = extent
    columns, rows = (count, 1) if side_by_side else (1, count)
    width = _WIDTH - _LEFT - _RIGHT
    height = min(max(width * (top - bottom) / (right - left), _HEIGHTS[0]), _HEIGHTS[1])
    figure.set_size_inches(columns * _WIDTH, rows * height)
    size = (0.0, 0.0, width / (columns * _WIDTH), 1.0 / rows)
    return [figure.add_axes(size, label=f"drawing {number}") for number in range(count)]


def arrange(
    figure: Figure, axes: list[Axes], titles: list[Text], legend: Any, *, side_by_side: bool = False
) -> None:
    """Put Axes with their titles beside or below each other, and the legend of all below."""
    columns, rows = (len(axes), 1) if side_by_side else (1, len(axes))
    above = max(_inches(title) for title in titles) + 2.0 * _CLEAR
    drawing = _inches(axes[0])
    below = _inches(legend) + 2.0 * _CLEAR
    cell = above + drawing + _AXIS
    whole = rows * cell + below
    figure.set_figheight(whole)
    width, height = (_WIDTH - _LEFT - _RIGHT) / (columns * _WIDTH), drawing / whole
    for number, ax in enumerate(axes):
        column, row = (number, 0) if side_by_side else (0, number)
        left = (column * _WIDTH + _LEFT) / (columns * _WIDTH)
        bottom = below + (rows - 1 - row) * cell + _AXIS
        ax.set_position((left, bottom / whole, width, height))


def draw_legend(ax: Axes, axes: list[Axes]) -> Any:
    """Draw a common legend of some Axes below one of them, in columns no wider than that."""
    explained: dict[str, Any] = {}
    for each in axes:
        handles, labels = each.get_legend_handles_labels()
        explained = dict(zip(labels, handles, strict=True)) | explained
    for columns in (4, 3, 2, 1):
        legend = ax.legend(
            list(explained.values()),
            list(explained),
            loc="upper center",
            bbox_to_anchor=(0.5, 0.0),
            bbox_transform=below_axis(ax, _AXIS),
            fontsize="small",
            ncols=columns,
            columnspacing=1.2,
            handlelength=1.6,
        )
        if legend.get_window_extent().width <= ax.bbox.width:
            break
    return legend


def _inches(artist: Any) -> float:
    """[inch] The height of an artist."""
    return float(artist.get_window_extent().height / artist.figure.dpi)


def axes_or_new(ax: Axes | None, size: tuple[float, float]) -> Axes:
    """Return the caller's Axes, or Axes of a new figure with this size [inch]."""
    if ax is None:
        _, ax = extra("matplotlib.pyplot", "plot").subplots(figsize=size, layout="constrained")
    return check_axes(ax, "ax")


def check_axes(ax: Any, name: str) -> Axes:
    """Refuse anything but Axes, such as a time or an array of Axes."""
    if not isinstance(ax, extra("matplotlib.axes", "plot").Axes):
        raise ScenarioError(name, ax, "must be an Axes of matplotlib")
    checked: Axes = ax
    return checked


def below_axis(ax: Axes, distance: float) -> Any:
    """Return the transform of the Axes, shifted down by a fixed distance [inch]."""
    move = extra("matplotlib.transforms", "plot").ScaledTranslation
    return ax.transAxes + move(0.0, -distance, ax.figure.dpi_scale_trans)


def moved(ax: Axes, aside: float) -> Any:
    """Return the transform of the data, shifted to the right by a distance [point] on paper."""
    move = extra("matplotlib.transforms", "plot").ScaledTranslation
    return ax.transData + move(aside / 72.0, 0.0, ax.figure.dpi_scale_trans)


def set_title(ax: Axes, *paragraphs: str) -> Text:
    """Write a title over Axes, no wider than them; over narrow ones only its first paragraph."""
    ax.apply_aspect()  # before this, the width is unknown
    title = ax.set_title("", loc="left", fontsize="small")
    # A robot's name may hold a $, which must not start a formula.
    title.set_parse_math(False)
    width = 72.0 * ax.bbox.width / ax.figure.dpi
    characters = int(width / (_CHARACTER * float(title.get_fontsize())))
    shown = paragraphs[:1] if characters < _NARROW else paragraphs
    title.set_text("\n".join(textwrap.fill(text, max(30, characters)) for text in shown))
    return title


def draw_length(
    ax: Axes,
    ends: tuple[NDArray[np.float64], NDArray[np.float64]],
    start: NDArray[np.float64],
    text: str = "",
) -> None:
    """Draw the distance between two points as an arrow next to them, with a label.

    Parameters
    ----------
    ax : Axes
        Where to draw.
    ends : tuple of 2 ndarrays
        [m] The points.
    start : ndarray
        [m] Start of the arrow, instead of the first point.
    text : str
        What to write before the length.
    """
    shift = start - ends[0]
    for point in ends:
        # A little beyond the arrow.
        ax.plot(*np.column_stack([point, point + 1.1 * shift]), **_THIN)
    arrow = {**_ARROW, "arrowstyle": "<|-|>"}
    ax.annotate("", _point(ends[0] + shift), _point(ends[1] + shift), arrowprops=arrow)
    along = ends[1] - ends[0]
    turn = float(np.degrees(np.arctan2(along[1], along[0])))
    # Readable from below or from the right, on the far side of the arrow.
    upright = (turn + 89.0) % 180.0 - 89.0
    up = np.array([-np.sin(np.radians(upright)), np.cos(np.radians(upright))])
    side = 1.0 if shift @ up > 0.0 else -1.0
    ax.annotate(
        f"{text} {np.hypot(*along):.3g} m".strip(),
        _point(0.5 * (ends[0] + ends[1]) + shift),
        xytext=_point(_OFFSET * side * up),
        rotation=upright,
        rotation_mode="anchor",
        ha="center",
        va="bottom" if side > 0.0 else "top",
        **_TEXT,
    )


def draw_radius(
    ax: Axes, center: NDArray[np.float64], length: float, foot: NDArray[np.float64]
) -> None:
    """Draw the radius [m] of a circle as an arrow towards its label at a point outside."""
    outwards = foot - center
    rim = center + length * outwards / np.hypot(*outwards)
    ax.plot(*np.column_stack([rim, foot]), **_THIN)
    ax.annotate("", _point(rim), _point(center), arrowprops={**_ARROW, "arrowstyle": "-|>"})
    side = 1.0 if outwards[0] > 0.0 else -1.0
    ax.annotate(
        f"radius {length:.3g} m",
        _point(foot),
        xytext=(_OFFSET * side, 0.0),
        ha="left" if side > 0.0 else "right",
        va="center",
        **_TEXT,
    )


def draw_height(ax: Axes, x: float, levels: tuple[float, float]) -> None:
    """Draw a rise or fall from one level [m] to another at x [m], with its label in the air."""
    start, end = levels
    ax.annotate("", (x, start), (x, end), arrowprops={**_ARROW, "arrowstyle": "<|-|>"})
    rises = end > start
    left, right = ax.get_xlim()
    # Near the right end of the view a label on the right would be partly outside.
    is_last = x > right - _LABEL * (right - left)
    beside = -_OFFSET if is_last else 0.0 if rises else _OFFSET
    ax.annotate(
        f"{abs(end - start):.3g} m",
        (x, end if rises else 0.5 * (start + end)),
        xytext=(beside, _OFFSET if rises else 0.0),
        ha="right" if is_last else "center" if rises else "left",
        va="bottom" if rises else "center",
        **_TEXT,
    )


def _point(place: NDArray[np.float64]) -> tuple[float, float]:
    return float(place[0]), float(place[1])
