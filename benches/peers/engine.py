"""What the benchmark asks of an engine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

if TYPE_CHECKING:
    from collections.abc import Sequence

    from benches.peers.motion import Motion
    from benches.peers.scenes import Scene


@dataclass(frozen=True)
class Setting:
    """How finely an engine steps.

    Attributes
    ----------
    time_step : float
        [s] Time of a step.
    substeps : int
        Parts of a step, in engines that have them.
    iterations : int
        Sweeps or solver iterations, in engines that have them; 0 is the engine's default.
    tuned : bool
        Whether lengths and stiffness suit parts of a few millimetres, or are the engine's defaults.
    ground : {"boxes", "profile"}
        Of what the ground is made, in engines that offer both.
    """

    time_step: float
    substeps: int = 1
    iterations: int = 0
    tuned: bool = True
    ground: Literal["boxes", "profile"] = "boxes"

    def __str__(self) -> str:
        """Say it in a cell of a table."""
        parts = [f"{self.time_step * 1e3:.4g} ms"]
        if self.substeps > 1:
            parts.append(f"{self.substeps} substeps")
        if self.iterations > 1:
            parts.append(f"{self.iterations} iterations")
        if self.ground == "profile":
            parts.append("profile")
        return ", ".join(parts) if self.tuned else f"{', '.join(parts)}, defaults"

    def steps(self, duration: float) -> int:
        """Count the steps of a duration [s]."""
        return round(duration / self.time_step)

    def stride(self, interval: float) -> int:
        """Count the steps between samples that are at most an interval [s] apart, at least one."""
        return max(int(interval / self.time_step * (1.0 + 1e-9)), 1)


class Engine(Protocol):
    """One engine; importing its module needs the engine, and nothing else does."""

    name: str
    """Name in tables."""
    version: str
    """Of what is installed."""
    defaults: Setting
    """What the engine's own documentation or examples take."""
    grid: Sequence[Setting]
    """What the search for equal accuracy tries."""
    finest: Setting
    """The engine's own limit."""
    next_finest: Setting
    """What shows whether the limit has converged."""

    def wall_time(self, scene: Scene, setting: Setting, duration: float) -> float:
        """[s] Take the time of a run, in the engine's fastest way from Python, not recorded."""

    def record(self, scene: Scene, setting: Setting, duration: float, interval: float) -> Motion:
        """Run and sample all poses, at most `interval` [s] apart but no finer than each step."""
