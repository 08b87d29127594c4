"""What is told about a robot that is read: sources, notes, doubts and its wheels."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice

from crawler2d.errors import ScenarioError, ScenarioWarning
from crawler2d.models.where import Where
from crawler2d.reading.parts import Runner

__all__ = ["Doubt", "Telling", "named", "noted", "place_of"]

Doubt = tuple[str, object, str]
"""Path, value and reason of a `ScenarioWarning`."""

_MOST_NOTES = 10


@dataclass(slots=True, kw_only=True)
class Telling:
    """Gathers what is told while a robot is made.

    Parameters
    ----------
    at : Where
        Line of the model.
    sources : dict of str to str
        By path.
    notes : list of str
        What was decided.
    doubts : list of Doubt
        What is hardly meant.
    rows : list of (str, Runner)
        All wheels and drums, each with its carrier, in the order of the table.
    """

    at: Where
    sources: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    doubts: list[Doubt] = field(default_factory=list)
    rows: list[tuple[str, Runner]] = field(default_factory=list)

    def note(self, path: str, source: str) -> None:
        """Keep the source of a figure."""
        self.sources[path] = source


def place_of(runner: Runner) -> Where:
    """Return the line that says where a wheel or drum is."""
    return runner.link.pose_at if runner.joint is not None else runner.shape.pose_at


@contextmanager
def noted(doubts: Iterable[Doubt]) -> Iterator[None]:
    """Add to a refusal what was done without before it, which may be its cause, as notes."""
    try:
        yield
    except ScenarioError as error:
        for doubt in islice(doubts, _MOST_NOTES):
            error.add_note(str(ScenarioWarning(*doubt)))
        raise


def named(names: Sequence[str], most: int = 3) -> str:
    """List names; of many, the first and how many more.

    Examples
    --------
    >>> named(["a", "b"]), named(["a", "b", "c", "d", "e"])
    ('a, b', 'a, b, c and 2 more')
    """
    more = len(names) - most
    shown = ", ".join(names[:most])
    return shown if more <= 0 else f"{shown} and {more} more"
