"""How a robot tipped over, and what would have kept it upright."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from crawler2d import _core
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Hold
from crawler2d.results.diagnosis import end_text
from crawler2d.results.outcome import Outcome

__all__ = ["TipOver", "find_tip_over"]

_SLOWER = {"half the speed": 0.5, "a tenth of the speed": 0.1}
"""[-] Fractions of the commanded speed."""
_LONGEST = 1e5
"""[s] Longest duration of a scenario."""
_SHIFTS = (0.02, 0.05, 0.1, 0.2)
"""[-] Shifts of the centre of mass as fractions of the axle distance."""


@dataclass(frozen=True, kw_only=True)
class TipOver:
    """How a robot tipped over, and what would have prevented it; see `Run.tip_over`.

    ``str(tip_over)`` summarises it in a few sentences. `time` is the last instant at which the
    centre of mass was ahead of the rearmost contact (for a fall forwards: behind the foremost one).
    It may be the end of the run, if the robot is driven over without losing its balance.

    Attributes
    ----------
    backwards : bool
        Whether it tipped over its rear, nose up.
    time : float
        [s] When it lost its balance.
    end : float
        [s] When the chassis tilted by more than `criteria.tip_over_angle`, and the run ended.
    chassis_angle : float
        [rad] Chassis angle at `time`, nose up > 0.
    center_of_mass : tuple of float
        [m] Centre of mass of the whole robot at `time`.
    pivot : tuple of float
        [m] The outermost load-bearing contact at `time`, on the side to which it fell.
    tried : tuple of (str, Outcome)
        Each change, made from the start of the run, and the outcome of that run: half and a tenth
        of the speed, and the centre of mass moved away from the pivot by 2, 5, 10 and 20 % of the
        axle distance, until the robot stayed upright.
    """

    backwards: bool
    time: float
    end: float
    chassis_angle: float
    center_of_mass: tuple[float, float]
    pivot: tuple[float, float]
    tried: tuple[tuple[str, Outcome], ...] = ()

    @property
    def prevented_by(self) -> tuple[str, ...]:
        """The changes that kept it from tipping over, whether it then cleared or not."""
        return tuple(change for change, end in self.tried if end is not Outcome.TIPPED_OVER)

    def __str__(self) -> str:
        """Describe it in a few sentences."""
        direction, nose = ("backwards", "up") if self.backwards else ("forwards", "down")
        beyond, last = ("behind", "rearmost") if self.backwards else ("beyond", "foremost")
        did = f"passed {beyond}" if self.time < self.end else f"did not get {beyond}"
        (_, y), (pivot, ground) = self.center_of_mass, self.pivot
        text = (
            f"tipped over {direction}: its centre of mass {did} its {last} contact,"
            f" {1e3 * (y - ground):.0f} mm below it at x = {pivot:z.3f} m, after {self.time:.2f} s,"
            f" {math.degrees(abs(self.chassis_angle)):.0f} degrees nose {nose}"
        )
        tried = "; ".join(f"{change}: {end_text(end)}" for change, end in self.tried)
        return f"{text}. Tried from the start: {tried}" if tried else text


def find_tip_over(scenario: Scenario, *, try_changes: bool) -> TipOver | None:
    """Simulate a scenario and find how it tipped over; None if it did not.

    Parameters
    ----------
    scenario : Scenario
        What is simulated.
    try_changes : bool
        Whether to try what would have prevented it, which takes up to six more runs.
    """
    fields = _core.tip_over(scenario.to_json())
    if fields is None:
        return None
    tried = _try_changes(scenario, backwards=fields["backwards"]) if try_changes else ()
    return TipOver(**fields, tried=tuple(tried))


def _try_changes(scenario: Scenario, *, backwards: bool) -> Iterator[tuple[str, Outcome]]:
    """Yield each change and the outcome of its run."""
    for change, fraction in _SLOWER.items():
        yield change, _outcome(_slower(scenario, fraction))
    length = scenario.robot.outline.axle_distance
    x = scenario.robot.center_of_mass[0]
    for fraction in _SHIFTS:
        shift = fraction * length * (1.0 if backwards else -1.0)
        end = _outcome(scenario.replace({"robot.center_of_mass[0]": x + shift}))
        direction = "forward" if backwards else "back"
        yield f"centre of mass {1e3 * abs(shift):.0f} mm further {direction}", end
        if end is not Outcome.TIPPED_OVER:
            return


def _slower(scenario: Scenario, fraction: float) -> Scenario:
    """Drive the same route in more time: flippers also move at the same positions."""
    drive = scenario.drive
    changes: dict[str, Any] = {
        "drive.speed": fraction * drive.speed,
        "duration": min(scenario.duration / fraction, _LONGEST),
    }
    if drive.schedule is not None:
        slowed = [(t, fraction * speed) for t, speed in drive.schedule]
        changes["drive.schedule"] = _stretched(slowed, fraction)
    if isinstance(drive.gait, Hold) and drive.gait.schedule is not None:
        changes["drive.gait.schedule"] = _stretched(drive.gait.schedule, fraction)
    return scenario.replace(changes)


def _stretched(schedule: Sequence[tuple[float, float]], fraction: float) -> Any:
    """Stretch the times of a schedule; None if all are later than a run can last."""
    return [(t / fraction, to) for t, to in schedule if t / fraction <= _LONGEST] or None


def _outcome(scenario: Scenario) -> Outcome:
    return Outcome(_core.simulate(scenario.to_json(), 0.01, "summary", [])["outcome"])
