"""How much of the paper is repeated, and how its runs are made."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from crawler2d.studies.campaign import RateSampling, Sampling
from crawler2d.sweeps.sequential import Until

if TYPE_CHECKING:
    from crawler2d.sweeps.found import Found

__all__ = ["FULL", "QUICK", "Design", "Work"]

# [-] No interval is so narrow: the number of runs decides.
_NO_WIDTH = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """How much is simulated."""

    field_repeats: int
    """Runs per cell of Table 2; 20 in the paper."""
    field_layouts: tuple[str, ...]
    """Layouts of Table 2; () takes all."""
    heights: tuple[float, ...]
    """[m] Heights of the parallelepiped of Table 3."""
    height_repeats: int
    """Runs per model and height."""
    driving_repeats: int
    """Runs per model on level ground."""
    angles: tuple[float, ...]
    """[rad] Of the slopes; with the declared and the measured one of Table 1."""
    slope_repeats: int
    """Runs per model and slope."""
    computing_repeats: int
    """Measurements of the real-time factor."""
    claim_repeats: int
    """Runs per cell of an experiment on a claim."""


FULL = Design(
    field_repeats=100,
    field_layouts=(),
    heights=tuple(0.02 * step for step in range(2, 13)),
    height_repeats=10,
    driving_repeats=3,
    angles=tuple(map(math.radians, (35.0, 40.0, 42.0, 44.0, 45.0, 46.0))),
    slope_repeats=5,
    computing_repeats=5,
    claim_repeats=20,
)
QUICK = Design(
    field_repeats=5,
    field_layouts=(
        *("16 all round, spaced", "line of 3", "line of 3 gears", "16 gears all round, spaced"),
        *("belt", "belt with grousers", "line of 5 gears"),
    ),
    heights=(0.06, 0.10, 0.14, 0.20),
    height_repeats=3,
    driving_repeats=2,
    angles=tuple(map(math.radians, (35.0, 45.0))),
    slope_repeats=2,
    computing_repeats=1,
    claim_repeats=4,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """The reproduction as a whole: how much, and by what means."""

    store: Path
    """The file that keeps every run."""
    design: Design = FULL
    seed: int = 0
    """Of all draws."""
    threads: int | None = None
    """See `simulate_many`."""
    progress: bool = True
    """Whether to show a bar for each part."""
    tried: Counter[str] = field(default_factory=Counter)
    """How many "settings" the studies have tried, and with how many "runs"."""

    @property
    def sampling(self) -> Sampling:
        """The keywords of a study that measures."""
        return {
            "seed": self.seed,
            "threads": self.threads,
            "store": self.store,
            "progress": self.progress,
        }

    def how(self, repeats: int) -> RateSampling:
        """Return the keywords of a study of rates whose cells all have the same number of runs."""
        until = Until(width=_NO_WIDTH, least=repeats, most=repeats)
        return {**self.sampling, "until": until}

    def counted(self, found: Found) -> Found:
        """Count what a study has tried, and return it; what two studies share counts twice."""
        self.tried.update({name: found.attrs[name] for name in ("settings", "runs")})
        return found
