"""The Axes that a drawing goes into: the caller's, or those of a new figure of the right shape."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

__all__ = ["Canvas", "checked_axes", "set_title"]

# [inch] Width of a new figure, what is left and right of its drawing, least and most height.
_WIDTH, _LEFT, _RIGHT, _HEIGHTS = 9.0, 0.9, 0.15, (1.2, 6.0)
# [inch] Height of ticks and label of the axis below it, and between what is above each other.
_AXIS, _CLEAR = 0.45, 0.1

# Mean width of a character, as a share of the font's size.
_CHARACTER = 0.56
# Narrower titles have room for one paragraph only.
_NARROW = 75


class Canvas:
    """Axes for a drawing to scale, in metres.

    Parameters
    ----------
    ax : Axes or None
        Those of the caller; None makes some.
    extent : tuple of 4 floats
        [m] Left, right, bottom and top.
    figure : Figure, optional
        Where to make them, all of it; None makes a figure of pyplot.

    Attributes
    ----------
    ax : Axes
        Where to draw.
    title : Text
        What `caption` wrote above them.
    """

    title: Text

    def __init__(
        self,
        ax: Axes | None,
        extent: tuple[float, float, float, float],
        figure: Figure | None = None,
    ) -> None:
        left, right, bottom, top = extent
        self._figure: Figure | None = None
        if ax is None:
            figure = figure or extra("matplotlib.pyplot", "plot").figure()
            self._figure = figure
            width = _WIDTH - _LEFT - _RIGHT
            height = min(max(width * (top - bottom) / (right - left), _HEIGHTS[0]), _HEIGHTS[1])
            figure.set_size_inches(_WIDTH, height)
            ax = figure.add_axes((0.0, 0.0, width / _WIDTH, 1.0))
        self.ax = checked_axes(ax, "ax")
        self.ax.set(
            xlim=(left, right), ylim=(bottom, top), xlabel="x [m]", ylabel="y [m]", aspect="equal"
        )

    def caption(self, *paragraphs: str) -> Axes:
        """Write the title above the drawing and its legend below, where they hide nothing."""
        ax, legend = self.ax, self._legend()
        self.title = set_title(ax, *paragraphs)
        if self._figure is not None:
            above, below = (_inches(each) + 2.0 * _CLEAR for each in (self.title, legend))
            below += _AXIS
            drawing = _inches(ax)
            whole = above + drawing + below
            self._figure.set_figheight(whole)
            width = (_WIDTH - _LEFT - _RIGHT) / _WIDTH
            ax.set_position((_LEFT / _WIDTH, below / whole, width, drawing / whole))
        return ax

    def _legend(self) -> Any:
        """Explain what is drawn, in as many columns as are no wider than the drawing."""
        transforms = extra("matplotlib.transforms", "plot")
        ax = self.ax
        # Ticks and label of the axis take the same height, however large the drawing is.
        down = transforms.ScaledTranslation(0.0, -_AXIS, ax.figure.dpi_scale_trans)
        for columns in (4, 3, 2, 1):
            legend = ax.legend(
                loc="upper center",
                bbox_to_anchor=(0.5, 0.0),
                bbox_transform=ax.transAxes + down,
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


def checked_axes(ax: Any, name: str) -> Axes:
    """Refuse what is no Axes, such as a time or an array of Axes."""
    if not isinstance(ax, extra("matplotlib.axes", "plot").Axes):
        raise ScenarioError(name, ax, "must be an Axes of matplotlib")
    checked: Axes = ax
    return checked


def set_title(ax: Axes, *paragraphs: str) -> Text:
    """Write a title over Axes, no wider than these; in narrow ones its first paragraph alone."""
    ax.apply_aspect()  # only then the width is known
    title = ax.set_title("", loc="left", fontsize="small")
    # A robot's name may hold a $, which must not start a formula.
    title.set_parse_math(False)
    width = 72.0 * ax.bbox.width / ax.figure.dpi
    characters = int(width / (_CHARACTER * float(title.get_fontsize())))
    shown = paragraphs[:1] if characters < _NARROW else paragraphs
    title.set_text("\n".join(textwrap.fill(text, max(30, characters)) for text in shown))
    return title
