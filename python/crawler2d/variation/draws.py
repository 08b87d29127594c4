"""Draw the fields of a cell from their distributions, with random numbers shared by all cells."""

from __future__ import annotations

import functools
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import (
    excluded,
    expand_path,
    in_proportion,
    is_whole,
    json_pointer,
    read_path,
)
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Lanes
from crawler2d.variation.distributions import Distribution, Levels, Ranges, read_distribution
from crawler2d.variation.variability import of_contact, of_start

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Draws", "Variation", "fields_at", "uniform_numbers"]

_FRICTION = "terrain.friction"


@functools.lru_cache(maxsize=256)  # all cells of a sweep share them
def uniform_numbers(path: str, seed: int, count: int, *, kind: str = "") -> NDArray[np.float64]:
    """Draw numbers from 0 to 1 for a path, shape (count,).

    Each depends only on kind, path, seed and its index, not on other paths or the count.
    """
    numbers = np.random.default_rng((seed, *kind.encode(), *path.encode())).random(count)
    numbers.flags.writeable = False
    return numbers


@dataclass(frozen=True, slots=True)
class Draws:
    """Values drawn for one cell.

    Attributes
    ----------
    values : mapping of str to ndarray, shape (n,)
        One value per draw, by path of a field.
    shown : mapping of str to ndarray, shape (n,)
        By path as given; for several fields, the value of the first.
    whole : mapping of str to bool
        Whether a field takes whole numbers.
    """

    values: Mapping[str, NDArray[np.float64]]
    shown: Mapping[str, NDArray[np.float64]]
    whole: Mapping[str, bool]

    @property
    def fields(self) -> list[tuple[str, bool]]:
        """The fields in the form that the core takes."""
        return [(json_pointer(path), self.whole[path]) for path in self.values]

    @property
    def rows(self) -> NDArray[np.float64]:
        """One row per draw, one column per field."""
        return np.column_stack(list(self.values.values()))


@dataclass(frozen=True, slots=True)
class Variation:
    """Distributions by path, ready to draw from."""

    distributions: Mapping[str, Distribution]
    optional: Collection[str] = ()
    """Paths ignored if a cell lacks them; draws of these that break a rule are dropped."""
    text: str = ""
    """The distributions as text, for the attributes of a table."""

    @classmethod
    def read(
        cls, scenario: Scenario, given: object, swept: Collection[str], name: str = "vary"
    ) -> Variation:
        """Read the argument `vary` or `unknown`.

        Parameters
        ----------
        scenario : Scenario
            The scenario with the lengths used as units.
        given : mapping of str to distribution
            Distributions by path; None takes the variability of start and contact.
        swept : collection of str
            Paths that are swept or drawn elsewhere.
        name : str
            Name of the argument.

        Raises
        ------
        ScenarioError
            If it is not a mapping from paths to distributions, or replaces a swept value.
        """
        if given is None:
            given = of_start() | of_contact()
        if not isinstance(given, Mapping):
            raise ScenarioError(name, given, "must be a mapping from paths to distributions")
        optional = given.optional if isinstance(given, Ranges) else frozenset()
        distributions: dict[str, Distribution] = {}
        texts = []
        for path, each in given.items():
            if not isinstance(path, str):
                raise ScenarioError(name, path, "must have dotted paths as keys")
            distribution = read_distribution(each, f"{name}[{path!r}]")
            replaces = path in swept and not distribution.is_relative
            is_start_swept = path.startswith("start.") and not {path, "start"}.isdisjoint(swept)
            if path in optional and (replaces or is_start_swept):
                continue
            if replaces:
                rule = (
                    "must not replace the values of `over` or `unknown`; scaled(low, high) and"
                    " shifted(low, high) vary about them"
                )
                raise ScenarioError(f"{name}[{path!r}]", distribution, rule)
            distributions[path] = distribution.resolve(scenario)
            texts.append(f"{path}: {distribution}")
        return cls(distributions, optional, "; ".join(texts))

    def numbers(
        self, seed: int, count: int, *, kind: str = "", first: int = 0
    ) -> dict[str, NDArray[np.float64]]:
        """Draw the numbers from 0 to 1 for every path, shared by all cells.

        Each `kind` has its own numbers: one for the samples, and one for the repeats of each
        sample. Levels are taken in turn, starting with number `first`.
        """
        numbers = {}
        for path, each in self.distributions.items():
            key = each.along or path if isinstance(each, Levels) else path
            own = uniform_numbers(key, seed, count, kind=kind)
            numbers[path] = each.cycle(own, first) if isinstance(each, Levels) else own
        return numbers

    def draw(
        self,
        cell: Scenario,
        numbers: Mapping[str, NDArray[np.float64]],
        own: Mapping[str, float] | None = None,
    ) -> Draws:
        """Map the numbers to the values of a cell.

        Parameters
        ----------
        cell : Scenario
            The cell, with its own values.
        numbers : mapping of str to ndarray, shape (n,)
            Numbers from 0 to 1, by path.
        own : mapping of str to float, optional
            Values to use instead of the cell's own.

        Raises
        ------
        ScenarioError
            If the cell lacks a path, has no number there to vary around, or takes whole numbers
            there and the distribution gives others.
        """
        values: dict[str, NDArray[np.float64]] = {}
        shown: dict[str, NDArray[np.float64]] = {}
        whole: dict[str, bool] = {}
        for path, distribution in self.distributions.items():
            if path in self.optional and not _has_path(cell, path):
                continue
            for field in fields_at(cell, path):
                if field != path and field in self.distributions:
                    continue  # drawn separately
                nominal = read_path(cell, field, distribution)
                if own is not None:
                    nominal = own.get(field, nominal)
                whole[field] = is_whole(cell, field)
                if whole[field] and not distribution.is_whole:
                    rule = "must be drawn as a whole number; use uniform_int(low, high)"
                    raise ScenarioError(field, distribution, rule)
                if distribution.is_relative:
                    if type(nominal) not in (int, float):
                        rule = "must be a number for a distribution to vary about"
                        raise ScenarioError(field, nominal, rule)
                    nominal = float(nominal)  # a whole number may be too large for NumPy
                values[field] = distribution.values(numbers[path], nominal)
                shown.setdefault(path, values[field])
        cleared = {other for field in values for other in excluded(cell, field)}
        for field in list(values):
            for column, rows in in_proportion(cell, field).items():
                factors = values[field] / read_path(cell, field)
                for i, (_, number) in enumerate(() if column in cleared else rows):
                    values[f"{column}[{i}][1]"] = factors * number
                    whole[f"{column}[{i}][1]"] = False
        return Draws(values, shown, whole)


@functools.lru_cache(maxsize=256)  # called for every sample; a missing path is slow to check
def _has_path(cell: Scenario, path: str) -> bool:
    try:
        for field in fields_at(cell, path):
            read_path(cell, field)
    except ScenarioError:
        return False
    return True


def fields_at(cell: Scenario, path: str) -> list[str]:
    """List the fields of a path: friction is that of all lanes and segments."""
    if path != _FRICTION:
        return expand_path(cell, path)
    lanes = ["terrain"]
    if isinstance(cell.terrain, Lanes):
        sides = ("left", "right") if cell.terrain.middle is None else ("left", "right", "middle")
        lanes = [f"terrain.{side}" for side in sides]
    return [field for lane in lanes for field in _frictions(cell, lane)]


def _frictions(cell: Scenario, lane: str) -> list[str]:
    segments = getattr(read_path(cell, lane), "segment_friction", None)
    if segments is None:
        return [f"{lane}.friction"]
    return [f"{lane}.segment_friction[{i}]" for i in range(len(segments))]
