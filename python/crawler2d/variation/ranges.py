"""Distributions by path, each with where its range comes from."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

from crawler2d.variation.distributions import Distribution, read_distribution

__all__ = ["Ranges"]


class Ranges(Mapping[str, Distribution]):
    """What varies, or is not known: a distribution for each path, and its source.

    It takes the place of a plain mapping in `vary` and `unknown`. Two are joined with ``|``, also
    with a plain mapping; of equal paths the right one counts.

    Parameters
    ----------
    distributions : mapping of str to distribution
        By path.
    sources : mapping of str to str, optional
        Where each range comes from, by path.
    gives_way : collection of str
        Paths that are left out where they are swept, and where the scenario has none; a draw that
        breaks a rule is dropped, and the run keeps its own value.

    Examples
    --------
    >>> from crawler2d.variation.distributions import shifted, uniform
    >>> found = Ranges({"terrain.friction": uniform(0.5, 1.0)}, {"terrain.friction": "a guess"})
    >>> list(found | {"robot.mass": shifted(-1.0, 1.0)})
    ['terrain.friction', 'robot.mass']
    """

    def __init__(
        self,
        distributions: Mapping[str, Any],
        sources: Mapping[str, str] | None = None,
        gives_way: Collection[str] = (),
    ) -> None:
        self._distributions = {
            path: read_distribution(given, f"[{path!r}]") for path, given in distributions.items()
        }
        self.sources = dict(sources or {})
        self.gives_way = frozenset(gives_way)

    def __getitem__(self, path: str) -> Distribution:
        """Return the distribution of a path."""
        return self._distributions[path]

    def __iter__(self) -> Iterator[str]:
        """Go through the paths in order."""
        return iter(self._distributions)

    def __len__(self) -> int:
        """Count the paths."""
        return len(self._distributions)

    def __or__(self, other: object) -> Ranges:
        """Join with more, which count where both have a path."""
        if not isinstance(other, Mapping):
            return NotImplemented
        return _joined(self, other)

    def __ror__(self, other: object) -> Ranges:
        """Join with what stands before, whose paths these replace."""
        if not isinstance(other, Mapping):
            return NotImplemented
        return _joined(other, self)

    def __repr__(self) -> str:
        """Show a line for each path: its distribution, and where that comes from."""
        lines = [
            f"  {path}: {distribution}" + _indented(self.sources.get(path))
            for path, distribution in self.items()
        ]
        return "\n".join(["Ranges", *lines])


def _indented(source: str | None) -> str:
    return "" if source is None else f"\n      {source}"


def _joined(first: Mapping[str, Any], second: Mapping[str, Any]) -> Ranges:
    sources = {**getattr(first, "sources", {})}
    for path in second:
        sources.pop(path, None)
    sources.update(getattr(second, "sources", {}))
    kept: frozenset[str] = getattr(first, "gives_way", frozenset())
    added: frozenset[str] = getattr(second, "gives_way", frozenset())
    return Ranges({**first, **second}, sources, (kept - set(second)) | added)
