"""What frees a robot that has stopped: trials, in which one thing is changed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any, Generic, Literal, NamedTuple, Self, TypeVar

from crawler2d import _core
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.findings import Tried
from crawler2d.results.record import Record

__all__ = [
    "EscapeForce",
    "Trial",
    "Trials",
    "escape_force_at",
    "run_of_trial",
    "trial_at",
    "trial_names",
    "trials_at",
    "variant_tried_at",
]

Trials = Literal["auto", "all"] | Sequence[str] | None
R = TypeVar("R", bound=Record)

_ALL = tuple(_core.kinds()["trial"])
_AUTO = ("torque x 2", "friction x 2")


def trial_names(trials: Trials) -> tuple[str, ...]:
    """List the trials that are asked for, besides those that the outcome needs."""
    if trials is None:
        return ()
    if isinstance(trials, str) and trials in ("auto", "all"):
        return _AUTO if trials == "auto" else _ALL
    if isinstance(trials, str) or not isinstance(trials, Sequence):
        rule = 'must be "auto", "all", None or a sequence of names'
        raise ScenarioError("trials", trials, rule)
    return tuple(_known(name, "trials") for name in trials)


def _known(name: object, path: str) -> str:
    if name not in _ALL:
        names = ", ".join(f'"{known}"' for known in _ALL)
        raise ScenarioError(path, name, f"must be one of {names}")
    return str(name)


@dataclass(frozen=True, kw_only=True, eq=False)
class Trial(Tried, Generic[R]):
    """What came of one change at a stop, and the run that shows it; see `Run.trials`.

    One thing is changed in the pose of the stop, and the robot drives on for `criteria.escape_time`
    plus the time in which it would drive `criteria.escape_distance` as commanded; or the run begins
    anew. Torque, friction,
    belly and a push leave the rest of the state as it is. Another track takes over pose and speeds,
    and ground inside it is let out without a push.

    Attributes
    ----------
    name, freed, starts, freeing, distance, time, outcome, jammed, intrusion, duration
        See `Tried`.
    position, chassis_angle, flipper_angles
        See `Tried`.
    run : Run
        How it went from the instant of the stop; simulated again when it is first asked for.
    """

    show: Callable[[], R] = field(repr=False)

    @classmethod
    def of(cls, tried: Tried, show: Callable[[], R]) -> Trial[R]:
        """Add the way to the run."""
        return cls(**{each.name: getattr(tried, each.name) for each in fields(Tried)}, show=show)

    @cached_property
    def run(self) -> R:
        """How it went from the instant of the stop."""
        return self.show()


class _Levels(NamedTuple):
    low: float
    high: float


class EscapeForce(_Levels):
    """The push that moves a robot on, in the commanded direction; see `Run.escape_force`.

    Attributes
    ----------
    low : float
        [N] The last level that did not move it on; 0 if the first did.
    high : float
        [N] The first level with which it got ahead of where it had come before by
        `criteria.escape_distance`; inf if ten weights were not enough.
    tips : bool
        Whether that push tipped it over within two seconds.
    """

    tips: bool

    def __new__(cls, low: float, high: float, tips: bool = False) -> Self:
        """Keep the two levels as a tuple."""
        found = super().__new__(cls, low, high)
        found.tips = tips
        return found


def trials_at(run: Record, time: float, names: tuple[str, ...]) -> tuple[Tried, ...]:
    """Make trials at a stop; those that make no sense for the robot are left out."""
    found = _core.trials(run.scenario.to_json(), time, list(names))
    return tuple(map(Tried.from_core, found))


def trial_at(run: Record, time: float, name: str) -> Tried:
    """Make one trial at a stop."""
    found = trials_at(run, time, (_known(name, "name"),))
    if not found:
        raise ScenarioError("name", name, "must make sense for the robot: it has nothing to change")
    return found[0]


def run_of_trial(run: Record, time: float, name: str) -> tuple[Scenario, dict[str, Any]]:
    """Simulate a trial with its history."""
    found = _core.run_of_trial(run.scenario.to_json(), time, name, 0.01, "full")
    if found is None:
        raise ScenarioError("name", name, "must make sense for the robot: it has nothing to change")
    text, result = found
    return Scenario.from_json(text), result


def variant_tried_at(
    run: Record, time: float, variant: Scenario, push: tuple[float, float]
) -> Tried:
    """Try to continue from a stop as another scenario."""
    found = _core.what_if(run.scenario.to_json(), time, variant.to_json(), push)
    if found is None:
        raise ScenarioError("run", run, "must have stopped")
    return Tried.from_core(found)


def escape_force_at(run: Record, time: float) -> EscapeForce:
    """Measure the push that moves the robot on from a stop."""
    return EscapeForce(*_core.escape_force(run.scenario.to_json(), time))
