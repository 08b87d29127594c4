"""How a run in three dimensions ends: one rule for all engines."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

__all__ = ["ENDS", "Judge"]

ENDS = ("cleared", "stopped", "tipped over", "turned", "timed out")
"""How a run can end."""

_CLEAR_ANGLE, _CLEAR_TIME = math.radians(5.0), 0.5  # as in crawler2d, criteria
_NO_ADVANCE, _STOP_TIME = 0.005, 3.0
_TIPPED, _TURNED = math.radians(90.0), math.radians(45.0)


@dataclass(slots=True)
class Judge:
    """Watch a run, and say when and how it ends.

    *cleared*: the rear end axle is its radius past the goal, as in crawler2d, and the chassis level
    within 5 degrees, both for 0.5 s. *stopped*: within 3 s it has not got 5 mm farther than it had
    ever been. *tipped over*: pitch or roll beyond 90 degrees; *turned*: yaw beyond 45 degrees, so
    that the run is no longer one in side view. *timed out*: none of these.

    Parameters
    ----------
    goal : float
        [m] Where the rear end axle must get.
    duration : float
        [s] Longest time.

    Examples
    --------
    >>> judge = Judge(goal=1.0, duration=10.0)
    >>> [judge.end(0.5 * step, rear=0.3 * step, angles=(0.0, 0.0, 0.0)) for step in range(6)]
    ['', '', '', '', '', 'cleared']
    """

    goal: float
    duration: float
    farthest: float = field(default=-math.inf, init=False)
    reached_at: float = field(default=0.0, init=False)
    clear_since: float = field(default=math.inf, init=False)

    def end(self, time: float, rear: float, angles: tuple[float, float, float]) -> str:
        """Return how the run ends now, or "" if it goes on.

        Parameters
        ----------
        time : float
            [s] Now.
        rear : float
            [m] Where the rear end axle is.
        angles : tuple of float
            [rad] Roll, pitch and yaw.
        """
        roll, pitch, yaw = angles
        if rear > self.farthest + _NO_ADVANCE:
            self.farthest, self.reached_at = rear, time
        is_clear = rear > self.goal and abs(pitch) <= _CLEAR_ANGLE
        self.clear_since = min(self.clear_since, time) if is_clear else math.inf
        if time - self.clear_since >= _CLEAR_TIME:
            return "cleared"
        if abs(pitch) > _TIPPED or abs(roll) > _TIPPED:
            return "tipped over"
        if abs(yaw) > _TURNED:
            return "turned"
        if time - self.reached_at >= _STOP_TIME:
            return "stopped"
        return "timed out" if time >= self.duration else ""
