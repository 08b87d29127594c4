"""A data set with its own figure. Needs xarray, so it is imported on first use."""

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
    """The `plot` of `FigureDataset`; xarray's own plots are its methods."""

    # xarray's own cannot be called.
    def __call__(self, ax: Axes | None = None, **options: Any) -> Axes:  # type: ignore[override]
        """Draw the figure of this kind of data set; see `FigureDataset`."""
        name = self._ds.attrs.get("figure", "")
        if name not in tables.FIGURES:
            rule = "must be of a data set with a figure: use plot.scatter and the like"
            raise ScenarioError("plot", name or "none", rule)
        axes: Axes = tables.FIGURES[name](self._ds, ax, **options)
        return axes


class FigureDataset(xarray.Dataset):  # type: ignore[no-untyped-call] # xarray's subclass hook has no types
    """The result of `rate` and studies: an `xarray.Dataset` whose `plot` draws its figure.

    ``found.plot(ax=None)`` takes and returns one matplotlib Axes; None makes a figure. It also
    works on parts of the data set, such as ``found.sel(model="belt")``.
    """

    __slots__ = ()

    @property
    def plot(self) -> _Plot:  # type: ignore[override] # an accessor of xarray's is no property
        """Draw the figure; xarray's own plots are methods of this."""
        return _Plot(self)
