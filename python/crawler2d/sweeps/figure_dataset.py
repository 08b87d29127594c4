"""A data set with a figure of its own. It needs xarray, and is imported on first use."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import xarray
from xarray.plot.accessor import DatasetPlotAccessor

from crawler2d.errors import ScenarioError
from crawler2d.pictures import tables

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["FigureDataset"]


class _Plot(DatasetPlotAccessor):
    """What `FigureDataset.plot` does when it is called; xarray's own plots are its methods."""

    # xarray's own refuses to be called.
    def __call__(self, ax: Axes | None = None, **options: Any) -> Axes:  # type: ignore[override]
        """Draw the figure of this kind of data set; see `FigureDataset`."""
        name = self._ds.attrs.get("figure", "")
        if name not in tables.FIGURES:
            rule = "must be of a data set with a figure: use plot.scatter and the like"
            raise ScenarioError("plot", name or "none", rule)
        axes: Axes = tables.FIGURES[name](self._ds, ax, **options)
        return axes


class FigureDataset(xarray.Dataset):  # type: ignore[no-untyped-call] # xarray's subclass hook has no types
    """What `rate` and the studies return: an `xarray.Dataset` whose `plot` draws its figure.

    ``found.plot(ax=None)`` takes and returns one matplotlib Axes; None makes a figure. It works on
    a part of the data set, too, such as ``found.sel(model="belt")``.
    """

    __slots__ = ()

    @property
    def plot(self) -> _Plot:  # type: ignore[override] # an accessor of xarray's is no property
        """Draw it; xarray's own plots are methods of this."""
        return _Plot(self)
