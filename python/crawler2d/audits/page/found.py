"""What an audit found, as parts of its page: the answer, lint, verdicts, repairs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from crawler2d.audits import words
from crawler2d.audits.page.drawn import robot_drawn
from crawler2d.audits.page.figures import folded, grid
from crawler2d.common.markup import escaped

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited
    from crawler2d.audits.finding import Finding
    from crawler2d.audits.repairs import Repair

__all__ = ["answer", "best", "change", "lint", "repairs", "verdicts"]

_JAMS = (
    "the last columns tell of the runs that seized: between which wheels most are jammed, and how"
    " many of all; how often it seizes at each speed, the slowest first; between which frictions of"
    " the floor they are; and how many a change frees:"
    " a belt closed round the wheels in this pose, or the same set clear of the ground, twice the"
    " torque, twice the friction"
)


def best(audit: Audited) -> Repair | None:
    """Return the repair to show: by wheels, which a file can be given, before belts."""
    return min(
        audit.repairs, key=lambda each: (not each.confirmed, each.kind == "belt"), default=None
    )


def change(audit: Audited, repair: Repair) -> str:
    """Say what a repair changes; why the belts are those that they are stands elsewhere."""
    return repair.what.removesuffix(f" ({audit.belt.reason})")


def answer(audit: Audited) -> str:
    """Say in a sentence or two where the robot seizes, and what ends that."""
    every, repair = audit.verdicts, best(audit)
    judged = [each for each in every if each.word == "seizes"]
    seized = judged or [each for each in every if each.where]
    if not seized:
        unsure = sum(each.word == "not certain" for each in every)
        but = f"; {unsure} of them take more runs to be certain of" if unsure else ""
        return (
            f'<strong class="good">It seized in no run over {len(every)} obstacles</strong>{but}.'
        )
    worst = max(seized, key=lambda each: each.seized.rate)
    said = f"It seizes on {len(seized)} of {len(every)} obstacles where a belt clears"
    if not judged:
        runs = f"in runs over {len(seized)} of {len(every)} obstacles"
        said = f"By the rule it seizes nowhere, but {runs}"
    wheels = " and ".join(worst.where.split("-"))
    text = (
        f'<strong class="{"bad" if judged else "warning"}">{said}</strong>'
        f"{', most often on' if len(seized) > 1 else ':'} {escaped(worst.obstacle)}"
        f" ({words.percent(worst.seized.rate)} of the runs), between wheels {wheels} of the"
        f" {worst.carrier}."
    )
    if repair is None:
        return text
    if repair.confirmed:
        what = escaped(change(audit, repair))
        return f"{text} What ends that, confirmed in fresh runs: <strong>{what}</strong>."
    return f"{text} No repair was confirmed."


def lint(audit: Audited) -> str:
    """List what lint found: errors, and the rest folded."""
    if not audit.lint:
        return "<p>Nothing found.</p>"
    errors = [each for each in audit.lint if each.severity == "error"]
    others = [each for each in audit.lint if each.severity != "error"]
    counts = Counter(each.severity for each in others)
    head = ", ".join(f"{count} {kind}{'s' * (count > 1)}" for kind, count in counts.items())
    return _findings(errors) + (folded(head, _findings(others)) if others else "")


def _findings(found: Sequence[Finding]) -> str:
    rows = "".join(
        f'<li><strong class="{escaped(each.severity)}">{escaped(each.severity)}</strong>'
        f" <b>{escaped(each.rule)}</b>: {escaped(each.what)}"
        f"{f' <code>{escaped(each.where)}</code>' if each.where else ''}</li>"
        for each in found
    )
    return f'<ul class="lint">{rows}</ul>' if rows else ""


def verdicts(audit: Audited, replays: Mapping[str, int]) -> str:
    """Write the verdicts, each with where it jams, what frees it, and the way to its replay."""
    jams = any(each.where for each in audit.verdicts)
    head = (*words.VERDICT_HEAD, *(words.JAM_HEAD[1:] if jams else ()))
    rows = []
    for each in audit.verdicts:
        name, *cells = (escaped(cell) for cell in words.verdict(each))
        if each.obstacle in replays:
            name = f'<a href="#replay-{replays[each.obstacle]}">{name}</a>'
        cells[-1] = f'<strong class="{_class(each.word)}">{cells[-1]}</strong>'
        if jams:
            jam = words.jam(each)[1:] if each.where else ("",) * len(words.JAM_HEAD[1:])
            cells += map(escaped, jam)
        rows.append((name, *cells))
    notes = [each for each in words.conclusion(audit) if each != words.reservation(audit)]
    notes += map(_sentence, (words.calls(audit), words.lost(audit), _JAMS if jams else ""))
    below = "".join(f"<p>{escaped(note)}</p>" for note in notes if note)
    table = grid(head, rows, label="verdicts", look="wide")
    return table + folded("in words, and what the columns tell", below)


def repairs(audit: Audited, diffs: Mapping[str, str]) -> str:
    """Write what came of each repair, the robot with it, and what of `diffs` it has, by `what`."""
    found = audit.repaired
    if found is None:
        asked = (
            "Nothing seizes, so none were searched for."
            if not audit.seizes
            else "None were searched for."
        )
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
    text = f"<p>{escaped(_sentence(words.repairs_found(found, audit.vary)))}</p>"
    drawn = "".join(_picture(each, diffs.get(each.what)) for each in found.repairs)
    return (
        f'{text}{grid(head, rows, label="repairs", look="many")}<div class="repairs">{drawn}</div>'
    )


def _picture(repair: Repair, diff: str | None) -> str:
    picture = robot_drawn(repair.robot, f"the robot: {repair.what}", width=560.0, height=200.0)
    change = ""
    if diff is not None:
        change = folded("what changes in the file", f'<pre tabindex="0">{escaped(diff)}</pre>')
    return (
        f'<figure class="robot">{picture}<figcaption>{escaped(repair.what)}</figcaption>{change}'
        "</figure>"
    )


def _sentence(text: str) -> str:
    return f"{text[0].upper()}{text[1:]}." if text else ""


def _class(word: str) -> str:
    return {"seizes": "bad", "does not seize": "good"}.get(word, "quiet")
