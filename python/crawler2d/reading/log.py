"""Log of reading a file: sources of figures, notes, warnings, and wheels in table order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice

from crawler2d.errors import ScenarioError, ScenarioWarning
from crawler2d.model_tree import Tree, Where
from crawler2d.reading.wheels import Runner

__all__ = [
    "ReadLog",
    "ReadingWarning",
    "Sources",
    "add_warnings",
    "estimate",
    "lines",
    "list_names",
    "span",
]

_MOST_LINES = 4  # listed individually
_MOST_NOTES = 10  # on one error

ReadingWarning = tuple[str, object, str]
"""Path, value and reason of a `ScenarioWarning`."""


class Sources(Mapping[str, str]):
    """Sources by path, such as ``robot.mass``; printing them shows a table.

    Parameters
    ----------
    entries : mapping of str to str
        File and lines, or the word "estimate" with its rule.

    Examples
    --------
    >>> Sources({"robot.mass": "cart.sdf:12", "robot.track_mass": "estimate: a hundredth"})
    robot.mass        cart.sdf:12
    robot.track_mass  estimate: a hundredth
    """

    __slots__ = ("_entries",)

    def __init__(self, entries: Mapping[str, str]) -> None:
        self._entries = tuple(entries.items())

    def __getitem__(self, path: str) -> str:
        """Return the source of a figure."""
        return dict(self._entries)[path]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the paths."""
        return (path for path, _ in self._entries)

    def __len__(self) -> int:
        """Count the figures."""
        return len(self._entries)

    def __repr__(self) -> str:
        """Write one line for each figure."""
        width = max((len(path) for path, _ in self._entries), default=0)
        return "\n".join(f"{path:{width}}  {source}" for path, source in self._entries)

    @property
    def estimates(self) -> tuple[str, ...]:
        """The paths of the figures that are estimates."""
        return tuple(path for path, source in self._entries if source.startswith("estimate"))


@dataclass(slots=True, kw_only=True)
class ReadLog:
    """Records made while a robot is built from a model by the rules of an engine.

    Parameters
    ----------
    tree : Tree
        The model.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine.
    sources : dict of str to str
        By path.
    notes : list of str
        Decisions.
    warnings : list of ReadingWarning
        Probable mistakes.
    rows : list of (str, Runner)
        All wheels and drums with their carriers, in table order.
    """

    tree: Tree
    engine: str
    sources: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    warnings: list[ReadingWarning] = field(default_factory=list)
    rows: list[tuple[str, Runner]] = field(default_factory=list)

    @property
    def at(self) -> Where:
        """Line of the model."""
        return self.tree.at

    def cite(self, path: str, **sources: str) -> None:
        """Record the sources of figures of a part of the robot."""
        self.sources |= {f"{path}.{name}": source for name, source in sources.items()}

    def add_warning(self, path: object, value: object, reason: str) -> None:
        """Record a probable mistake."""
        self.warnings.append((str(path), value, reason))


def estimate(rule: str) -> str:
    """Return the source of an estimated figure, with its rule."""
    return f"estimate: {rule}"


def lines(places: Iterable[Where], what: str = "") -> str:
    """List lines of a file; of many, the first, the last and their number.

    Examples
    --------
    >>> lines([Where("a.sdf", 7), Where("a.sdf", 3), Where("a.sdf", 7)])
    'a.sdf:3, 7'
    >>> lines([Where("a.sdf", line) for line in range(10, 70)], "sum")
    'a.sdf:10 to 69, sum of 60 lines'
    """
    by_file: dict[str, set[int]] = {}
    for place in places:
        by_file.setdefault(place.file, set()).add(place.line)
    parts = []
    for file, numbers in by_file.items():
        order = sorted(numbers)
        if len(order) <= _MOST_LINES:
            parts.append(f"{file}:{', '.join(str(number) for number in order)}")
            continue
        kind = f"{what} of {len(order)}" if what else f"{len(order)}"
        parts.append(f"{file}:{order[0]} to {order[-1]}, {kind} lines")
    return "; ".join(parts)


def span(values: Iterable[float]) -> str:
    """Write the smallest and the largest of some numbers, or the one that all are.

    Examples
    --------
    >>> span([0.9, 0.15, 0.4]), span([0.5, 0.5])
    ('0.15 to 0.9', '0.5')
    """
    order = sorted(values)
    low, high = f"{order[0]:g}", f"{order[-1]:g}"
    return low if low == high else f"{low} to {high}"


@contextmanager
def add_warnings(warnings: Iterable[ReadingWarning]) -> Iterator[None]:
    """Add earlier warnings to an error as notes, as parts left out may be its cause."""
    try:
        yield
    except ScenarioError as error:
        for warning in islice(warnings, _MOST_NOTES):
            error.add_note(str(ScenarioWarning(*warning)))
        raise


def list_names(names: Sequence[str], most: int = 3) -> str:
    """List names; of many, the first ones and how many more.

    Examples
    --------
    >>> list_names(["a", "b"]), list_names(["a", "b", "c", "d", "e"])
    ('a, b', 'a, b, c and 2 more')
    """
    more = len(names) - most
    shown = ", ".join(names[:most])
    return shown if more <= 0 else f"{shown} and {more} more"
