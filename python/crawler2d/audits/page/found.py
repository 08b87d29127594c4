"""What an audit found, as parts of a page: lint, verdicts with their replays, repairs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from crawler2d.audits import words
from crawler2d.audits.page.figures import field_name
from crawler2d.audits.page.grid import grid
from crawler2d.audits.page.robot_drawn import robot_drawn
from crawler2d.common.markup import escaped
from crawler2d.common.units import unit_of

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited
    from crawler2d.audits.page.replayed import Replayed
    from crawler2d.audits.repairs import Repair

__all__ = ["lint", "repairs", "replays", "verdicts"]


_JAMS = (
    "the last columns tell of the runs that seized: between which wheels most are jammed, and how"
    " many of all; how often it seizes at each speed, the slowest first; between which frictions of"
    " the floor they are; and how many a change frees:"
    " a belt closed round the wheels in this pose, or the same set clear of the ground, twice the"
    " torque, twice the friction"
)


def lint(audit: Audited) -> str:
    """List what lint found, errors first."""
    if not audit.lint:
        return "<p>Nothing found.</p>"
    rows = "".join(
        f'<li><strong class="{escaped(each.severity)}">{escaped(each.severity)}</strong>'
        f" <b>{escaped(each.rule)}</b>: {escaped(each.what)}"
        f"{f' <code>{escaped(each.where)}</code>' if each.where else ''}</li>"
        for each in audit.lint
    )
    return f'<ul class="lint">{rows}</ul>'


def verdicts(audit: Audited, replayed: Sequence[Replayed]) -> str:
    """Write the verdicts, each with where it jams, what frees it, and the way to its replay."""
    numbers = {each.verdict.obstacle: number for number, each in enumerate(replayed)}
    head = (*words.VERDICT_HEAD, *words.JAM_HEAD[1:], "replay")
    rows = []
    for each in audit.verdicts:
        cells = [escaped(cell) for cell in words.verdict(each)]
        cells[-1] = f'<strong class="{_class(each.word)}">{cells[-1]}</strong>'
        jam = words.jam(each)[1:] if each.where else ("",) * len(words.JAM_HEAD[1:])
        number = numbers.get(each.obstacle)
        link = "" if number is None else f'<a href="#replay-{number}">replay</a>'
        rows.append((*cells, *(escaped(cell) for cell in jam), link))
    notes = [words.calls(audit), words.lost(audit)]
    if numbers:
        notes.insert(0, _JAMS)
    below = "".join(f"<p>{escaped(note[0].upper() + note[1:])}.</p>" for note in notes if note)
    short = (*words.VERDICT_HEAD, "runs", "slow to fast", "friction", "replay")
    return grid(head, rows, label="verdicts", short=short) + below


def replays(replayed: Sequence[Replayed]) -> str:
    """Write a closed box for each replay, which the script of the page fills when it is opened."""
    if not replayed:
        return "<p>It seized in no run.</p>"
    return "".join(_replay(number, each) for number, each in enumerate(replayed))


def _replay(number: int, each: Replayed) -> str:
    where = f"{each.verdict.where} of the {each.verdict.carrier}"
    there, seized = each.verdict.there
    draw = (
        f"Sample {each.sample}, repeat {each.repeat} of the runs, counted from 0; {there} of"
        f" {seized} seizures on this obstacle are there."
        f"{_drawn('Of the robot and its floor', each.of_robot)}{_drawn('Of this run', each.of_run)}"
    )
    boxes = _box(number, "model", f"the model: {words.end(each.run)}")
    if each.belt is not None:
        title = f"the belt with the same draws: {words.end(each.belt)}"
        boxes += _box(number, "belt", title)
    return (
        f'<details class="replay" id="replay-{number}"><summary>{escaped(each.verdict.obstacle)}:'
        f" jammed between wheels {escaped(where)}</summary><p>{escaped(draw)}</p>"
        f'<div class="pair">{boxes}</div></details>'
    )


def _drawn(of: str, values: Mapping[str, float]) -> str:
    """Say which values a run has of what is not known, or of what differs from run to run."""
    return f" {of}: {', '.join(map(_said, values.items()))}." if values else ""


def _said(drawn: tuple[str, float]) -> str:
    path, value = drawn
    unit = unit_of(path)
    number = f"{value:.0f}" if value.is_integer() else f"{value:.4g}"
    return f"{field_name(path)} {number}{'' if unit in (None, '1') else f' {unit}'}"


def _box(number: int, model: str, title: str) -> str:
    data = f"replay-{number}-{model}"
    return (
        f'<section aria-label="{escaped(title)}"><h3>{escaped(title)}</h3>'
        f'<div class="frame" data-replay="{data}" data-title="{escaped(title)}"></div></section>'
    )


def repairs(audit: Audited, diffs: Mapping[str, str]) -> str:
    """Write the repairs: what came of each, the robot with it, and what changes in the file.

    Parameters
    ----------
    audit : Audited
        The audit.
    diffs : mapping of str to str
        Changes of the audited file as text, by `Repair.what`; a repair without one shows none.
    """
    found = audit.repaired
    if found is None:
        asked = "It seizes nowhere by the rule." if not audit.seizes else "None were searched for."
        return f"<p>{asked}</p>"
    head = (
        "repair",
        "in fresh runs",
        "clears at least, of what the belt clears where it seized",
        "seizes at most",
        "most on",
        "wheels a side",
        "simulated speed",
    )
    rows = []
    for each in found.repairs:
        cleared, seized, where = words.worst(each)
        kind = "good" if each.confirmed else "quiet"
        rows.append(
            (
                escaped(each.what),
                f'<strong class="{kind}">{words.confirmed(each)}</strong>',
                words.share(cleared) if cleared.runs else escaped(words.beside(each)),
                words.share(seized),
                escaped(where),
                str(each.wheels or "belt"),
                f"{each.speed:.2g} times",
            )
        )
    said = [words.repairs_found(found, audit.vary), *map(words.hopeless, found.hopeless)]
    text = "".join(f"<p>{escaped(line[0].upper() + line[1:])}.</p>" for line in said)
    drawn = "".join(_picture(each, diffs.get(each.what)) for each in found.repairs)
    table = grid(head, rows, label="repairs", short=head[1:4])
    return f'{text}{table}<div class="repairs">{drawn}</div>'


def _picture(repair: Repair, diff: str | None) -> str:
    picture = robot_drawn(repair.robot, f"the robot: {repair.what}", width=560.0, height=300.0)
    change = ""
    if diff is not None:
        change = (
            "<details><summary>what changes in the file</summary>"
            f'<pre tabindex="0">{escaped(diff)}</pre></details>'
        )
    return (
        f'<figure class="robot">{picture}<figcaption>{escaped(repair.what)}</figcaption>{change}'
        "</figure>"
    )


def _class(word: str) -> str:
    return {"seizes": "bad", "does not seize": "good"}.get(word, "quiet")
