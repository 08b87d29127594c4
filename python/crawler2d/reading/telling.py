"""What is told about a robot that is read: sources, notes, doubts and its wheels."""

from __future__ import annotations

from dataclasses import dataclass, field

from crawler2d.models.where import Where
from crawler2d.reading.parts import Runner

__all__ = ["Doubt", "Telling", "place_of"]

Doubt = tuple[str, object, str]
"""Path, value and reason of a `ScenarioWarning`."""


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
