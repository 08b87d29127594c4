"""From an audit to one self-contained HTML page, with the runs that it replays."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crawler2d.audits import words
from crawler2d.audits.page.parts import (
    answer_section,
    best,
    change,
    command,
    field_name,
    figures,
    folded,
    lint_section,
    made,
    pockets_drawn,
    repair_section,
    robot_drawn,
    unknowns,
    verdict_section,
    wheels,
)
from crawler2d.audits.runs import TRIED, column
from crawler2d.audits.verdicts import BELT, OWN
from crawler2d.common.units import unit_of
from crawler2d.drawings.svg import escaped
from crawler2d.errors import ScenarioWarning
from crawler2d.parameters.scenario import Scenario
from crawler2d.pictures.page import as_json, fill_page, read_part, scene_script
from crawler2d.pictures.page.recording import recording
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import simulate_many

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.audits.audited import Audited
    from crawler2d.audits.verdicts import Verdict
    from crawler2d.runs.run import Run

__all__ = ["Replayed", "audit_page", "replay", "replayed"]

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


_HERE = "crawler2d.audits.page"
_MOST = 300
"""Samples of a run in the page: those of slow and of long runs are farther apart."""


def audit_page(
    audit: Audited, diffs: Mapping[str, str] | None = None, *, threads: int | None = None
) -> str:
    """Write the page of an audit, with `diffs` by `Repair.what`; see `Audit.to_html`."""
    runs = replayed(audit, threads=threads)
    return fill_page(
        "audit.html",
        read_part("replay.css") + read_part("audit.css", _HERE),
        scene_script(read_part("audit.js", _HERE)),
        _HERE,
        title=escaped(f"{audit.robot.name}: audit"),
        name=escaped(audit.robot.name),
        subject=escaped(words.subject(audit).removeprefix(f"{audit.robot.name}: ")),
        reservation=escaped(words.reservation(audit)),
        answer=answer_section(audit),
        options=_options(runs),
        replays="".join(replay(audit, each, number) for number, each in enumerate(runs)),
        verdicts=verdict_section(
            audit, {each.place.verdict.obstacle: number for number, each in enumerate(runs)}
        ),
        population=escaped(words.population(audit)),
        belt=escaped(audit.belt.reason),
        lint=lint_section(audit),
        repairs=repair_section(audit, diffs or {}),
        robot=_robot(audit),
        command=escaped(command(audit)),
        made=made(audit),
        data="\n".join(_data(each, number) for number, each in enumerate(runs)),
    )


def _options(runs: Sequence[Replayed]) -> str:
    """List the obstacles that can be replayed."""
    return "".join(
        f'<option value="{number}">{escaped(place.verdict.obstacle)}:'
        f" {words.percent(place.verdict.seized.rate)} seized</option>"
        for number, (place, *_) in enumerate(runs)
    )


def _data(each: Replayed, number: int) -> str:
    """Write what is drawn of runs as inert text."""
    shown = [recording(run, most=_MOST) for run in each.runs if run.error is None]
    return f'<script type="application/json" id="runs-{number}">{as_json(shown)}</script>'


def _robot(audit: Audited) -> str:
    """Draw the robot over the shapes of its file; its figures are folded."""
    read = audit.reading
    shapes = () if read is None else read.silhouettes
    drawn = (
        '<span class="swatch belly"></span> belly; + centre of mass. Wheels have the numbers that'
        " verdicts and replays name, those of the left side."
    )
    if read is not None:
        drawn = (
            '<span class="swatch collision"></span> collision shapes of the file, all joints at'
            f' zero; <span class="swatch"></span> the robot that was read from them; {drawn}'
        )
    picture = robot_drawn(audit.robot, "side view of the robot", shapes)
    parts = [
        f'<figure class="robot">{picture}<figcaption>{drawn}</figcaption></figure>',
        wheels(audit),
        folded("pockets and slots between wheels", pockets_drawn(audit.robot, audit.pockets)),
        figures(audit),
        unknowns(audit.unknown, "not known, and drawn for every sample"),
    ]
    if read is not None and read.notes:
        notes = "".join(f"<li>{escaped(note)}</li>" for note in read.notes)
        parts.append(folded("decided while reading", f"<ul>{notes}</ul>"))
    return f"<p>{escaped(words.robot_sentence(audit))}</p>{''.join(parts)}"
