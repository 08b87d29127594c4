"""How a run ended."""

from __future__ import annotations

from enum import StrEnum

__all__ = ["Outcome"]


class Outcome(StrEnum):
    """How a run ended; where several apply, the first of this list.

    Examples
    --------
    >>> [str(outcome) for outcome in Outcome if outcome.is_stop]
    ['seized', 'hung_up', 'stalled', 'slipping', 'cycling']
    """

    DETRACKED = "detracked"
    TIPPED_OVER = "tipped_over"
    LEFT_TERRAIN = "left_terrain"
    CLEARED = "cleared"
    SEIZED = "seized"
    HUNG_UP = "hung_up"
    STALLED = "stalled"
    SLIPPING = "slipping"
    CYCLING = "cycling"
    TIMED_OUT = "timed_out"

    @property
    def is_stop(self) -> bool:
        """Whether the robot got nowhere although commanded."""
        return self in _STOPS


_STOPS = (Outcome.SEIZED, Outcome.HUNG_UP, Outcome.STALLED, Outcome.SLIPPING, Outcome.CYCLING)
