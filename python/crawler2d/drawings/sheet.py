"""A sheet to draw on in metres, to one scale, that becomes inline SVG without any other package."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from crawler2d.common.markup import escaped

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Sheet"]


class Sheet:
    """A part of the plane, as large as fits into a width and a height.

    Parameters
    ----------
    extent : tuple of 4 floats
        [m] Left, right, bottom and top.
    width, height : float
        [px] The most that it may have.

    Examples
    --------
    >>> sheet = Sheet((0.0, 2.0, -0.5, 0.5), width=100.0, height=100.0)
    >>> sheet.line([(0.0, 0.0), (1.0, 0.0), (1.0, 0.5)], 'fill="none"', is_closed=False)
    >>> sheet.svg()
    '<svg xmlns="http://www.w3.org/2000/svg" width="100" height="50" viewBox="0 0 100.0 50.0"\
 role="img"><path d="M0 25l50 0l0 -25" fill="none"/></svg>'
    """

    def __init__(
        self, extent: tuple[float, float, float, float], width: float, height: float
    ) -> None:
        left, right, bottom, top = extent
        self.extent = extent
        self.scale = min(width / (right - left), height / (top - bottom))
        self._size = self.scale * (right - left), self.scale * (top - bottom)
        self._drawn: list[str] = []

    def pixels(self, points: ArrayLike) -> NDArray[np.float64]:
        """[px] Return where points are, shape (..., 2), from the upper left corner."""
        left, _, _, top = self.extent
        moved: NDArray[np.float64] = self.scale * (np.asarray(points) - (left, top)) * (1.0, -1.0)
        return moved

    def line(self, points: ArrayLike, look: str, *, is_closed: bool = True) -> None:
        """Draw a line through points [m]; `look` are attributes of SVG."""
        self._drawn.append(f'<path d="{_steps(self.pixels(points))}{"Z" * is_closed}" {look}/>')

    def circle(self, center: ArrayLike, radius: float, look: str) -> None:
        """Draw a circle [m]."""
        x, y = self.pixels(center)
        self._drawn.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{self.scale * radius:.1f}" {look}/>'
        )

    def cross(self, place: ArrayLike, look: str) -> None:
        """Mark a point [m] by a cross."""
        x, y = self.pixels(place)
        self._drawn.append(f'<path d="M{x - 4:.1f} {y:.1f}h8m-4 -4v8" {look}/>')

    def label(self, place: ArrayLike, text: str, look: str) -> None:
        """Write a text, its baseline at a point [m]."""
        x, y = self.pixels(place)
        self._drawn.append(f'<text x="{x:.1f}" y="{y:.1f}" {look}>{escaped(text)}</text>')

    def svg(self, title: str = "") -> str:
        """Return one element; `title` says what it shows to those who cannot see it."""
        width, height = self._size
        named = f' aria-label="{escaped(title)}"' if title else ""
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0f}" height="{height:.0f}"'
            f' viewBox="0 0 {width:.1f} {height:.1f}" role="img"{named}>'
            f"{''.join(self._drawn)}</svg>"
        )


def _steps(pixels: NDArray[np.float64]) -> str:
    """Write a line as moves in tenths of a pixel; corners that fall together are left out."""
    corners = np.round(pixels, 1)
    moves = np.round(np.diff(corners, axis=0), 1)
    steps = "".join(f"l{x:g} {y:g}" for x, y in moves if x or y)
    return f"M{corners[0, 0]:g} {corners[0, 1]:g}{steps}"
