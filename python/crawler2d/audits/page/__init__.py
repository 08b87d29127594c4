"""Write an audit as one self-contained HTML page that replays runs."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crawler2d.audits import words
from crawler2d.audits.page import sections
from crawler2d.audits.page.chart import chart_section
from crawler2d.audits.runs import TRIED
from crawler2d.audits.verdicts import BELT, OWN, ObstacleRuns
from crawler2d.drawings.svg import escape
from crawler2d.errors import ignore_warnings
from crawler2d.parameters.scenario import Scenario
from crawler2d.pictures.page import fill_page, read_part
from crawler2d.pictures.page.pair import (
    INTERVAL,
    pair_data,
    pair_figure,
    pair_parts,
    pair_script,
    pair_style,
)
from crawler2d.results.outcome import Outcome
from crawler2d.runs.batch import simulate_many

if TYPE_CHECKING:
    from crawler2d.audits.record import AuditRecord
    from crawler2d.audits.verdicts import Verdict
    from crawler2d.runs.run import Run

__all__ = ["audit_page", "simulate_replays"]

_HERE = "crawler2d.audits.page"


class Replay(NamedTuple):
    """A run in the table of an audit, driven by the robot and perhaps another one.

    Parameters
    ----------
    verdict : Verdict
        Verdict on its obstacle.
    sample, repeat : int
        Its indices in the table.
    runs : list of Run
        Run of the robot, and of the repaired robot or the belt if that differs.
    other : str
        Description of the other robot.
    """

    verdict: Verdict
    sample: int
    repeat: int
    runs: list[Run]
    other: str = "the belt"

    def value(self, audit: AuditRecord, name: str) -> Any:
        """Return the row of this run."""
        runs = ObstacleRuns(audit.table, OWN, self.verdict.obstacle)
        return runs.column(name)[self.sample, self.repeat]


def simulate_replays(audit: AuditRecord, *, threads: int | None = None) -> list[Replay]:
    """Simulate one run again for each obstacle on which the robot seized, the worst first.

    It is one of the runs with the commonest jam; if possible one that the belt clears with the same
    draws; and the first at the highest speed, which is the shortest. If the robot seized nowhere,
    it is the run that came closest to a seizure.
    """
    seized = [each for each in audit.verdicts if each.jam_wheels]
    worst_first = sorted(seized, key=lambda each: (each.result != "seizes", -each.seized.rate))
    replays = [_seizure(audit, each) for each in worst_first] or _closest(audit)
    repair = sections.best_repair(audit)
    if repair is not None:
        name = f"{sections.change(audit, repair)} ({words.confirmation(repair)})"
        replays = [each._replace(other=name) for each in replays]
    scenarios = [_scenarios(audit, each) for each in replays]
    with ignore_warnings():  # they are in the lint
        runs = simulate_many(
            [scenario for pair in scenarios for scenario in pair],
            threads=threads,
            sample_interval=INTERVAL,
            trials=TRIED,
            on_error="record",  # the other robot may break a rule with these draws
        )
    each_run = iter(runs)
    for replay, pair in zip(replays, scenarios, strict=True):
        replay.runs.extend(itertools.islice(each_run, len(pair)))
    return replays


def _scenarios(audit: AuditRecord, replay: Replay) -> list[Scenario]:
    """Return the run of the robot, and that of the other one if there is one."""
    own = Scenario.from_json(str(replay.value(audit, "scenario")))
    repair = sections.best_repair(audit)
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


def _seizure(audit: AuditRecord, verdict: Verdict) -> Replay:
    """Choose the run that represents the seizures on an obstacle."""
    own, belt = (ObstacleRuns(audit.table, model, verdict.obstacle) for model in (OWN, BELT))
    there = own.seized & (own.column("stop_bodies") == verdict.jam_wheels)
    there &= own.column("stop_carrier") == verdict.carrier
    alone = there & belt.cleared
    chosen = alone if alone.any() else there
    fastest = np.where(chosen, np.abs(own.speeds), -1.0).argmax()
    sample, repeat = np.unravel_index(fastest, there.shape)
    return Replay(verdict, int(sample), int(repeat), [])


def _closest(audit: AuditRecord) -> list[Replay]:
    """Choose the run that came closest to a seizure, if any has a result.

    If possible one that fails where the belt clears; of these, the longest for its speed.
    """
    found = []
    for verdict in audit.verdicts if "time" in audit.table else ():
        own, belt = (ObstacleRuns(audit.table, model, verdict.obstacle) for model in (OWN, BELT))
        alone = ~own.cleared & belt.cleared
        lengths = np.abs(own.speeds) * own.column("time")
        for sample, repeat in np.argwhere(np.isfinite(lengths)).tolist():
            rank = bool(alone[sample, repeat]), float(lengths[sample, repeat])
            found.append((rank, Replay(verdict, sample, repeat, [])))
    return [max(found, key=lambda each: each[0])[1]] if found else []


def _replay_section(audit: AuditRecord, each: Replay, number: int) -> str:
    """Write the figures, the reason of the stop, and the draws."""
    figures = "".join(map(pair_figure, ("the model", each.other), each.runs))
    return (
        f'<div class="runs" id="replay-{number}"{" hidden" if number else ""}>'
        f'<div class="pair">{figures}</div>{_diagnosis(audit, each)}</div>'
    )


def _diagnosis(audit: AuditRecord, each: Replay) -> str:
    """Describe why the robot stopped; trials and draws are folded."""
    run, *others = each.runs
    why, _, tried = run.reason.partition(". Tried: ")
    jammed, seized = each.verdict.jam_counts
    among = f"; {jammed} of {seized} seizures on this obstacle are there" if seized else ""
    why = why or "it clears"
    text = f"{why[0].upper()}{why[1:]}."
    if not seized:
        text = f"It seized in no run; this is the one that came closest. {text}"
    if any(other.outcome == Outcome.SEIZED for other in others):
        text += " In this run the other robot seizes, too."
    draws = (
        f"Sample {each.sample}, repeat {each.repeat} of the runs, counted from 0{among}. Its random"
        f" values: {', '.join(_drawn(audit, each)) or 'none'}."
    )
    head = f"<p>Tried at the stop: {escape(tried)}.</p>" if tried else ""
    more = sections.fold("what was tried, and details of this run", f"{head}<p>{escape(draws)}</p>")
    return f'<p class="diagnosis">{escape(text)}</p>{more}'


def _drawn(audit: AuditRecord, replay: Replay) -> list[str]:
    """List the draws of a run: unknowns and variation."""
    found = []
    for name, variable in audit.table.data_vars.items():
        if str(name).startswith(("unknown_", "drawn_")):
            path, value = str(variable.attrs["path"]), float(replay.value(audit, str(name)))
            if not math.isnan(value):  # not a field of this obstacle
                number = f"{value:.0f}" if value.is_integer() else f"{value:.4g}"
                found.append(f"{sections.field_name(path)} {number}{words.unit_after(path)}")
    return found


def audit_page(
    audit: AuditRecord, diffs: Mapping[str, str] | None = None, *, threads: int | None = None
) -> str:
    """Write the page of an audit, with `diffs` by `Repair.description`; see `Audit.to_html`."""
    runs = simulate_replays(audit, threads=threads)
    repair = sections.best_repair(audit)
    repaired = [] if repair is None else [(sections.change(audit, repair), repair.robot)]
    return fill_page(
        "audit.html",
        pair_style() + read_part("audit.css", _HERE),
        pair_script(read_part("audit.js", _HERE)),
        _HERE,
        title=escape(f"{audit.robot.name}: audit"),
        name=escape(audit.robot.name),
        subject=escape(words.subject(audit).removeprefix(f"{audit.robot.name}: ")),
        reservation=escape(words.reservation(audit)),
        answer=sections.answer_section(audit),
        options=_options(runs),
        replays="".join(_replay_section(audit, each, number) for number, each in enumerate(runs)),
        verdicts=sections.verdict_section(
            audit, {each.verdict.obstacle: number for number, each in enumerate(runs)}
        ),
        chart=chart_section(audit.robot, repaired),
        population=escape(words.population(audit)),
        belt=escape(audit.belt.reason),
        lint=sections.lint_section(audit),
        repairs=sections.repair_section(audit, diffs or {}),
        robot=sections.robot_section(audit),
        command=escape(sections.command(audit)),
        made=sections.method_section(audit),
        data="\n".join(pair_data(each.runs, f"runs-{number}") for number, each in enumerate(runs)),
        **pair_parts(),
    )


def _options(runs: Sequence[Replay]) -> str:
    """List the obstacles that can be replayed."""
    return "".join(
        f'<option value="{number}">{escape(each.verdict.obstacle)}:'
        f" {words.percent(each.verdict.seized.rate)} seized</option>"
        for number, each in enumerate(runs)
    )
