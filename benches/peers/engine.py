"""The interface of an engine in the benchmark."""

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
        [s] Time of a step; 0 in crawler2d, which chooses it.
    substeps : int
        Substeps per step, in engines that have them.
    iterations : int
        Sweeps or solver iterations, in engines that have them; 0 is the engine's default.
    tuned : bool
        Whether lengths and stiffness suit parts of a few millimetres, or are defaults.
    ground : {"boxes", "profile"}
        What the ground is made of, in engines that offer both.
    accuracy : float
        [m] By which crawler2d chooses its steps; 0 in engines with steps of a given length.
    """

    time_step: float = 0.0
    substeps: int = 1
    iterations: int = 0
    tuned: bool = True
    ground: Literal["boxes", "profile"] = "boxes"
    accuracy: float = 0.0

    def __str__(self) -> str:
        """Describe it for a table."""
        step, accuracy = f"{self.time_step * 1e3:.4g} ms", f"accuracy {self.accuracy * 1e6:.4g} um"
        parts = [accuracy if self.accuracy else step]
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
    """One engine; only its own module needs the engine installed."""

    name: str
    """Name in tables."""
    version: str
    """Installed version."""
    defaults: Setting
    """Settings of the engine's own documentation or examples."""
    grid: Sequence[Setting]
    """Settings that the search for equal accuracy tries."""
    finest: Setting
    """The engine's finest setting, its own limit."""
    next_finest: Setting
    """Next finest setting, which shows whether the limit has converged."""

    def wall_time(self, scene: Scene, setting: Setting, duration: float) -> float:
        """[s] Time a run in the engine's fastest way from Python, without recording."""

    def record(self, scene: Scene, setting: Setting, duration: float, interval: float) -> Motion:
        """Run and sample all poses every `interval` [s], at most every step."""
