"""The runs that the page of an audit replays, side by side with the same draws."""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crawler2d.audits import words
from crawler2d.audits.page.figures import field_name, folded
from crawler2d.audits.page.found import best, change
from crawler2d.audits.runs import TRIED, column
from crawler2d.audits.verdicts import BELT, OWN
from crawler2d.common.markup import escaped
from crawler2d.common.units import unit_of
from crawler2d.errors import ScenarioWarning
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import simulate_many

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.audits.audited import Audited
    from crawler2d.audits.verdicts import Verdict
    from crawler2d.runs.run import Run

__all__ = ["Replayed", "replay", "replayed"]

_INTERVAL = 0.04
"""[s] Between samples: 25 pictures a second, a quarter of the usual."""


class _Place(NamedTuple):
    """Where a run stands in the table of an audit."""

    verdict: Verdict
    sample: int
    repeat: int

    def column(self, audit: Audited, name: str, model: str = OWN) -> NDArray[Any]:
        """Return all runs of a model on this obstacle, shape (samples, repeats)."""
        return column(audit.table, name, model=model, terrain=self.verdict.obstacle)

    def value(self, audit: Audited, name: str, model: str = OWN) -> Any:
        """Return what the table has of this run."""
        return self.column(audit, name, model)[self.sample, self.repeat]


class Replayed(NamedTuple):
    """A run of the robot, and beside it, if that is another one, the repaired robot or the belt."""

    place: _Place
    runs: list[Run]
    beside: str


def replayed(audit: Audited, *, threads: int | None = None) -> list[Replayed]:
    """Simulate one run again for each obstacle on which the robot seized, the worst first.

    It is one of those that are jammed where most are; if there are any, of those that the belt
    clears with the same draws; and of these the first of the fastest, which is the shortest. If it
    seized nowhere it is that run of all which came closest to it.
    """
    seized = [each for each in audit.verdicts if each.where]
    worst_first = sorted(seized, key=lambda each: (each.word != "seizes", -each.seized.rate))
    places = [_seizure(audit, each) for each in worst_first] or _closest(audit)
    repair = best(audit)
    name = "the belt"
    if repair is not None:
        name = f"{change(audit, repair)} ({words.confirmed(repair)})"
    scenarios = [_scenarios(audit, each) for each in places]
    with warnings.catch_warnings():
        # What the core doubts is in the lint.
        warnings.simplefilter("ignore", ScenarioWarning)
        flat = [scenario for pair in scenarios for scenario in pair]
        made = simulate_many(
            flat,
            threads=threads,
            sample_interval=_INTERVAL,
            trials=TRIED,
            on_error="record",  # what is beside the robot may break a rule with these draws
        )
    runs = iter(made)
    return [
        Replayed(place, [next(runs) for _ in pair], name)
        for place, pair in zip(places, scenarios, strict=True)
    ]


def _scenarios(audit: Audited, place: _Place) -> list[Scenario]:
    """Return the run of the robot, and that of what is beside it, which need not have driven it."""
    own = Scenario.from_json(str(place.value(audit, "scenario")))
    repair = best(audit)
    if repair is None and audit.belt.robot == audit.robot:
        return [own]
    other = audit.belt.robot if repair is None else repair.robot
    tracks: dict[str, Any] = {
        "robot.track": other.track,
        "robot.drivetrain.torque_sharing": other.drivetrain.torque_sharing,
    }
    if other.flippers is not None:
        tracks["robot.flippers.track"] = other.flippers.track
    return [own, own.replace(tracks)]


def _seizure(audit: Audited, verdict: Verdict) -> _Place:
    """Return the run that stands for the seizures on an obstacle."""
    on = _Place(verdict, 0, 0)
    there = on.column(audit, "outcome") == Outcome.SEIZED
    there &= on.column(audit, "stop_bodies") == verdict.where
    there &= on.column(audit, "stop_carrier") == verdict.carrier
    telling = there & (on.column(audit, "outcome", BELT) == Outcome.CLEARED)
    chosen = telling if telling.any() else there
    sample, repeat = np.unravel_index(np.where(chosen, _speeds(audit), -1.0).argmax(), there.shape)
    return _Place(verdict, int(sample), int(repeat))


def _closest(audit: Audited) -> list[_Place]:
    """Return the run that came closest to a seizure, if any has a result.

    That is one which fails where the belt clears, if there are any, and of these the one which took
    the longest for its speed.
    """
    found = []
    for verdict in audit.verdicts:
        on = _Place(verdict, 0, 0)
        ends, belt = (on.column(audit, "outcome", model) for model in (OWN, BELT))
        alone = (ends != Outcome.CLEARED) & (belt == Outcome.CLEARED)
        ways = _speeds(audit) * on.column(audit, "time")
        for sample, repeat in np.argwhere(np.isfinite(ways)).tolist():
            rank = bool(alone[sample, repeat]), float(ways[sample, repeat])
            found.append((rank, _Place(verdict, sample, repeat)))
    return [max(found, key=lambda each: each[0])[1]] if found else []


def _speeds(audit: Audited) -> NDArray[np.float64]:
    """[m/s] How fast each run drove, without its scatter, shape (samples, repeats)."""
    speeds = audit.table["speed"].transpose("sample", "repeat")
    return np.asarray(np.abs(speeds.values))


def replay(audit: Audited, each: Replayed, number: int) -> str:
    """Write the place of the pictures, what stopped the robot, and what was drawn."""
    figures = "".join(map(_figure, ("the model", each.beside), each.runs))
    return (
        f'<div class="runs" id="replay-{number}"{" hidden" if number else ""}>'
        f'<div class="pair">{figures}</div>{_told(audit, each)}</div>'
    )


def _figure(name: str, run: Run) -> str:
    if run.error is not None:
        return f"<p><b>{escaped(name)}</b> no result: {escaped(str(run.error))}</p>"
    end = f"{words.end(run)} after {run.metrics['time']:.1f} s"
    look = {"seized": "bad", "cleared": "good"}.get(words.end(run), "quiet")
    return (
        f'<figure><figcaption><b>{escaped(name)}</b> <strong class="{look}">{end}</strong>'
        f'</figcaption><canvas tabindex="0" role="img" aria-label="{escaped(name)}, side view:'
        f' {end}" aria-describedby="keys"></canvas></figure>'
    )


def _told(audit: Audited, each: Replayed) -> str:
    """Say why the robot stopped, and, folded, what was tried there and drawn for the run."""
    place, (run, *others) = each.place, each.runs
    why, _, tried = run.reason.partition(". Tried: ")
    there, seized = place.verdict.there
    among = f"; {there} of {seized} seizures on this obstacle are there" if seized else ""
    why = why or "it clears"
    said = f"{why[0].upper()}{why[1:]}."
    if not seized:
        said = f"It seized in no run; this is the one that came closest. {said}"
    if any(other.outcome == Outcome.SEIZED for other in others):
        said += " In this very run the robot beside it seizes, too."
    draws = (
        f"Sample {place.sample}, repeat {place.repeat} of the runs, counted from 0{among}. Drawn"
        f" for it: {', '.join(_drawn(audit, place)) or 'nothing'}."
    )
    head = f"<p>Tried at the stop: {escaped(tried)}.</p>" if tried else ""
    more = folded("what was tried, and which run it is", f"{head}<p>{escaped(draws)}</p>")
    return f'<p class="diagnosis">{escaped(said)}</p>{more}'


def _drawn(audit: Audited, place: _Place) -> list[str]:
    """Say what a run has of what is not known, and of what differs from run to run."""
    found = []
    for name, variable in audit.table.data_vars.items():
        if str(name).startswith(("unknown_", "drawn_")):
            path, value = str(variable.attrs["path"]), float(place.value(audit, str(name)))
            if not math.isnan(value):  # this obstacle has no such field
                unit = unit_of(path)
                number = f"{value:.0f}" if value.is_integer() else f"{value:.4g}"
                after = "" if unit in (None, "1") else f" {unit}"
                found.append(f"{field_name(path)} {number}{after}")
    return found
