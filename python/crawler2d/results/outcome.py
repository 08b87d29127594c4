"""How a run ended."""

from __future__ import annotations

from enum import StrEnum

from crawler2d import _core

__all__ = ["Outcome"]


class Outcome(StrEnum):
    """How a run ended; if several apply, the first in this list.

    Examples
    --------
    >>> [str(outcome) for outcome in Outcome if outcome.is_stop]
    ['cycling', 'seized', 'hung_up', 'stalled', 'slipping']
    """

    DETRACKED = "detracked"
    TIPPED_OVER = "tipped_over"
    LEFT_TERRAIN = "left_terrain"
    CLEARED = "cleared"
    CYCLING = "cycling"
    SEIZED = "seized"
    HUNG_UP = "hung_up"
    STALLED = "stalled"
    SLIPPING = "slipping"
    TIMED_OUT = "timed_out"

    @property
    def is_stop(self) -> bool:
        """Whether the robot made no progress although commanded to move."""
        return self in _STOPS


_STOPS = frozenset(_core.kinds()["stop"])
