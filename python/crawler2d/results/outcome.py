"""How a run ended."""

from __future__ import annotations

from enum import StrEnum

from crawler2d import _core
from crawler2d.results.glossary import OUTCOMES, listed

__all__ = ["Outcome"]


class Outcome(StrEnum):
    """How a run ended; if several apply, the first in this list.

    Examples
    --------
    >>> [str(outcome) for outcome in Outcome if outcome.is_stop]
    ['seized', 'cycling', 'hung_up', 'stalled', 'slipping']
    """

    DETRACKED = "detracked"
    TIPPED_OVER = "tipped_over"
    LEFT_TERRAIN = "left_terrain"
    CLEARED = "cleared"
    SEIZED = "seized"
    CYCLING = "cycling"
    HUNG_UP = "hung_up"
    STALLED = "stalled"
    SLIPPING = "slipping"
    TIMED_OUT = "timed_out"

    @property
    def is_stop(self) -> bool:
        """Whether the robot made no progress although commanded to move."""
        return self in _STOPS

    @property
    def meaning(self) -> str:
        """What it means, in a few words."""
        return OUTCOMES[self.value]


if Outcome.__doc__ is not None:  # not so with python -OO
    Outcome.__doc__ += "\n" + listed(OUTCOMES)

_STOPS = frozenset(_core.kinds()["stop"])
