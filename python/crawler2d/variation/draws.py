"""Draws of a cell: from distributions by path to values of fields, from numbers all cells share."""

from __future__ import annotations

import functools
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.parameters.fields import expand_path, is_whole, json_pointer, read_path
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Lanes
from crawler2d.variation.distributions import Distribution, Levels, Ranges, read_distribution
from crawler2d.variation.variability import of_contact, of_start

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["Drawn", "Variation", "uniform_numbers"]

_FRICTION = "terrain.friction"


@functools.lru_cache(maxsize=256)  # all cells of a sweep share them
def uniform_numbers(path: str, seed: int, count: int, *, kind: str = "") -> NDArray[np.float64]:
    """Draw numbers from 0 to 1 for a path, shape (count,).

    Each depends only on kind, path, seed and its place, not on other paths or the count.
    """
    numbers = np.random.default_rng((seed, *kind.encode(), *path.encode())).random(count)
    numbers.flags.writeable = False
    return numbers


@dataclass(frozen=True, slots=True)
class Drawn:
    """What was drawn for one cell.

    Attributes
    ----------
    values : mapping of str to ndarray, shape (n,)
        By path of a field, one value a draw.
    shown : mapping of str to ndarray, shape (n,)
        By path as it was given; of one that stands for several fields, the value of the first.
    whole : mapping of str to bool
        Whether a field takes whole numbers.
    """

    values: Mapping[str, NDArray[np.float64]]
    shown: Mapping[str, NDArray[np.float64]]
    whole: Mapping[str, bool]

    @property
    def fields(self) -> list[tuple[str, bool]]:
        """The fields as the core takes them."""
        return [(json_pointer(path), self.whole[path]) for path in self.values]

    @property
    def rows(self) -> NDArray[np.float64]:
        """One row a draw, one column a field."""
        return np.column_stack(list(self.values.values()))


@dataclass(frozen=True, slots=True)
class Variation:
    """Distributions by path, ready to be drawn from."""

    distributions: Mapping[str, Distribution]
    gives_way: Collection[str] = ()
    """Paths that are left out where a cell lacks them, and whose draws are dropped if they break a
    rule."""
    text: str = ""
    """What was given, for the attributes of a table."""

    @classmethod
    def of(
        cls, scenario: Scenario, given: object, swept: Collection[str], name: str = "vary"
    ) -> Variation:
        """Read the argument `vary` or `unknown`.

        Parameters
        ----------
        scenario : Scenario
            Whose lengths count.
        given : mapping of str to distribution
            None takes the variability of start and contact.
        swept : collection of str
            Paths that have values already.
        name : str
            Of the argument.

        Raises
        ------
        ScenarioError
            If it is not a mapping from paths to distributions, or replaces what is swept.
        """
        if given is None:
            given = of_start() | of_contact()
        if not isinstance(given, Mapping):
            raise ScenarioError(name, given, "must be a mapping from paths to distributions")
        gives_way = given.gives_way if isinstance(given, Ranges) else frozenset()
        found: dict[str, Distribution] = {}
        texts = []
        for path, each in given.items():
            if not isinstance(path, str):
                raise ScenarioError(name, path, "must have dotted paths as keys")
            place = f"{name}[{path!r}]"
            distribution = read_distribution(each, place)
            replaces = path in swept and not distribution.is_relative
            if path in gives_way and (replaces or _is_set(path, swept)):
                continue
            if replaces:
                rule = (
                    "must not replace the values of `over`; scaled(low, high) and"
                    " shifted(low, high) vary about them"
                )
                raise ScenarioError(place, distribution, rule)
            found[path] = distribution.on(scenario)
            texts.append(f"{path}: {distribution}")
        return cls(found, gives_way, "; ".join(texts))

    def numbers(
        self, seed: int, count: int, *, kind: str = "", first: int = 0
    ) -> dict[str, NDArray[np.float64]]:
        """Draw the numbers from 0 to 1 of every path, which all cells share.

        Another `kind` draws others: it tells samples from repeats, and the repeats of one sample
        from those of the next. Levels are taken in turn, beginning with the number `first`.
        """
        found = {}
        for path, each in self.distributions.items():
            if isinstance(each, Levels):
                numbers = uniform_numbers(each.along or path, seed, count, kind=kind)
                found[path] = each.in_turn(numbers, first)
            else:
                found[path] = uniform_numbers(path, seed, count, kind=kind)
        return found

    def draw(
        self,
        cell: Scenario,
        numbers: Mapping[str, NDArray[np.float64]],
        own: Mapping[str, float] | None = None,
    ) -> Drawn:
        """Map the numbers to the values of a cell.

        Parameters
        ----------
        cell : Scenario
            Whose own values count.
        numbers : mapping of str to ndarray, shape (n,)
            From 0 to 1, by path.
        own : mapping of str to float, optional
            Values that take the place of the cell's own.

        Raises
        ------
        ScenarioError
            If the cell lacks a path, or has no number there to vary about, or a whole number there
            and the distribution gives others.
        """
        values: dict[str, NDArray[np.float64]] = {}
        shown: dict[str, NDArray[np.float64]] = {}
        whole: dict[str, bool] = {}
        for path, distribution in self.distributions.items():
            if path in self.gives_way and not _has(cell, path):
                continue
            for field in _fields(cell, path):
                held = read_path(cell, field)
                nominal = held if own is None else own.get(field, held)
                whole[field] = _checked(cell, field, distribution, nominal)
                # A whole number may be too long for the arithmetic of arrays.
                start = float(nominal) if distribution.is_relative else nominal
                values[field] = distribution.values(numbers[path], start)
                shown.setdefault(path, values[field])
        return Drawn(values, shown, whole)


def _is_set(path: str, swept: Collection[str]) -> bool:
    """Whether a path of the start is swept, or the start as a whole."""
    return path.startswith("start.") and (path in swept or "start" in swept)


@functools.lru_cache(maxsize=256)  # every sample asks; to find the name that was meant takes long
def _has(cell: Scenario, path: str) -> bool:
    try:
        for field in _fields(cell, path):
            read_path(cell, field)
    except ScenarioError:
        return False
    return True


def _fields(cell: Scenario, path: str) -> list[str]:
    """List the fields that a path stands for; the friction of lanes is that of every lane."""
    if path == _FRICTION and isinstance(cell.terrain, Lanes):
        sides = ("left", "right") if cell.terrain.middle is None else ("left", "right", "middle")
        return [f"terrain.{side}.friction" for side in sides]
    return expand_path(cell, path)


def _checked(cell: Scenario, field: str, distribution: Distribution, own: Any) -> bool:
    """Check that a field can be drawn so, and tell whether it takes whole numbers."""
    whole = is_whole(cell, field)
    if whole and not distribution.is_whole:
        rule = "must be drawn with uniform_int(low, high), because it is a whole number"
        raise ScenarioError(field, distribution, rule)
    if distribution.is_relative and type(own) not in (int, float):
        raise ScenarioError(field, own, "must be a number, because it is to be varied about")
    return whole
