"""Where each figure of a robot comes from: lines of its file, or an estimate with its rule."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from crawler2d.models.where import Where

__all__ = ["Sources", "estimate", "lines"]

_MOST = 4  # lines that are listed one by one


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


def estimate(rule: str) -> str:
    """Say that a figure is an estimate, and by which rule."""
    return f"estimate: {rule}"


def lines(places: Iterable[Where], what: str = "") -> str:
    """Write lines of a file; of many, how many and from where to where.

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
        if len(order) <= _MOST:
            parts.append(f"{file}:{', '.join(str(number) for number in order)}")
            continue
        kind = f"{what} of {len(order)}" if what else f"{len(order)}"
        parts.append(f"{file}:{order[0]} to {order[-1]}, {kind} lines")
    return "; ".join(parts)
