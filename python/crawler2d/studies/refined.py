"""A grid of cells that is made finer, and simulated only where one kind may meet another."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.studies.campaign import Tally

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Grid"]

_AROUND = [(j, i) for j in (-1, 0, 1) for i in (-1, 0, 1) if (j, i) != (0, 0)]
"""The neighbours of a cell."""


class Grid:
    """Cells by model, y and x, of which some are simulated.

    Parameters
    ----------
    shape : tuple of 3 ints
        Of the finest grid.
    simulate : callable
        Given the places of cells, returns the tallies of each by sample.
    judge : callable
        Given the tallies of a cell, returns its rate, the number of its kind, 0 for one that is not
        to be taken for its neighbours, and whether that is certain.

    Attributes
    ----------
    rates, kinds, certain : ndarray, shape (models, y, x)
        [-] What `judge` says of a cell. Of a cell that is not simulated they are taken from those
        around it, and certain if all of these are; nan where nothing is known yet.
    """

    def __init__(
        self,
        shape: tuple[int, int, int],
        simulate: Callable[[Sequence[tuple[int, ...]]], list[list[Tally]]],
        judge: Callable[[Sequence[Tally]], tuple[float, int, bool]],
    ) -> None:
        self.rates, self.kinds, self.certain = (np.full(shape, np.nan) for _ in range(3))
        self._tallies: dict[tuple[int, ...], list[Tally]] = {}
        self._simulate, self._judge = simulate, judge

    def refine(self, stride: int, *, whole: bool) -> None:
        """Simulate, of every so many cells, the whole grid, or what is not clear from the rest."""
        part = np.s_[:, ::stride, ::stride]
        if whole:
            self._add(np.ones(self.kinds[part].shape, bool), stride)
            return
        # What was not simulated before stays open: it may get neighbours of another kind.
        while (due := self._open(stride) & ~self._agrees(stride)).any():
            self._add(due, stride)
        fill = np.isnan(self.kinds[part])
        around = _neighbours(self.rates[part])
        known = np.isfinite(around)
        mean = np.where(known, around, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
        self.rates[part][fill] = mean[fill]
        self.kinds[part][fill] = np.fmax.reduce(_neighbours(self.kinds[part]))[fill]
        self.certain[part][fill] = np.fmin.reduce(_neighbours(self.certain[part]))[fill]

    @property
    def tried(self) -> NDArray[np.bool_]:
        """Which cells have been simulated, shape (models, y, x)."""
        found = np.zeros(self.kinds.shape, bool)
        found[tuple(np.array(list(self._tallies)).T)] = True
        return found

    @property
    def tallies(self) -> list[list[Tally]]:
        """The tallies of all cells by sample; those of one that was not simulated are empty."""
        some = next(iter(self._tallies.values()))
        none = [Tally(replace(t.world, own={}, sampled={}), t.until, t.counts) for t in some]
        return [self._tallies.get(place, none) for place in np.ndindex(self.kinds.shape)]

    def _open(self, stride: int) -> NDArray[np.bool_]:
        return ~self.tried[:, ::stride, ::stride]

    def _agrees(self, stride: int) -> NDArray[np.bool_]:
        """Tell where all that is known of a cell and its neighbours is one certain kind."""
        own = self.kinds[:, ::stride, ::stride]
        around = np.concatenate([_neighbours(own), own[None]])
        low, high = np.fmin.reduce(around), np.fmax.reduce(around)
        agree: NDArray[np.bool_] = (low == high) & (low != 0.0)
        return agree

    def _add(self, due: NDArray[np.bool_], stride: int) -> None:
        places = [(m, stride * j, stride * i) for m, j, i in np.argwhere(due).tolist()]
        for place, tallies in zip(places, self._simulate(places), strict=True):
            self._tallies[place] = tallies
            found = self._judge(tallies)
            self.rates[place], self.kinds[place], self.certain[place] = found


def _neighbours(grid: NDArray[np.float64]) -> NDArray[np.float64]:
    """Stack what the eight neighbours of every cell have; nan beyond the rim."""
    _, rows, columns = grid.shape
    padded = np.pad(grid, ((0, 0), (1, 1), (1, 1)), constant_values=np.nan)
    return np.stack([padded[:, 1 + j : 1 + j + rows, 1 + i : 1 + i + columns] for j, i in _AROUND])
