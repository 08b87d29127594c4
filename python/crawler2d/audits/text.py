"""An audit in words: the short form that its command prints."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.audits.names import names_of
from crawler2d.audits.verdicts import CLEARS, SEIZES
from crawler2d.results.row import NO_RESULT
from crawler2d.variation.distributions import Distribution, Scaled, Shifted, Uniform
from crawler2d.variation.ranges import Ranges

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited
    from crawler2d.audits.pockets import Pocket
    from crawler2d.audits.repairs import Repair, Repaired
    from crawler2d.audits.share import Share
    from crawler2d.audits.verdicts import Verdict

__all__ = ["text_of"]

_WIDTH = 100


def text_of(audit: Audited) -> str:
    """Write an audit for a terminal: robot, lint, pockets, verdicts, repairs, and what follows."""
    parts = [_robot(audit), _lint(audit), _pockets(audit), _verdicts(audit), _conclusion(audit)]
    return "\n\n".join("\n".join(part) for part in parts)


def _robot(audit: Audited) -> Iterator[str]:
    robot, read = audit.robot, audit.reading
    yield robot.in_words if read is None else read.in_words
    outline = robot.outline
    x, y = robot.center_of_mass
    yield from _wrapped(
        f"{robot.mass:.4g} kg, axle distance {1e3 * outline.axle_distance:.0f} mm, radius"
        f" {1e3 * outline.front_radius:.0f} mm; centre of mass {_side(x, 'ahead of', 'behind')} the"
        f" middle and {_side(y, 'above', 'below')} the axles"
    )
    if read is not None:
        names = ", ".join(path.removeprefix("robot.") for path in read.sources.estimates)
        yield from _wrapped(f"estimates, for the file does not say: {names or 'none'}")
        for note in read.notes:
            yield from _wrapped(f"note: {note}")
    yield "  not known, and drawn for every sample:" if audit.unknown else "  nothing is unknown"
    sources = audit.unknown.sources if isinstance(audit.unknown, Ranges) else {}
    for path, distribution in audit.unknown.items():
        source = f" [{sources[path]}]" if path in sources else ""
        yield from _wrapped(f"{path.removeprefix('robot.')}: {_range(distribution)}{source}", 4)


def _lint(audit: Audited) -> Iterator[str]:
    yield "Lint" if audit.lint else "Lint: nothing found"
    for each in audit.lint:
        where = f" [{each.where}]" if each.where else ""
        yield from _wrapped(f"{each.severity}, {each.rule}: {each.what}{where}")


def _pockets(audit: Audited) -> Iterator[str]:
    if not audit.pockets:
        yield "Pockets: none, for there are no neighbouring wheels"
        return
    yield "Pockets and slots between wheels: a screen of geometry, no verdict"
    groups: dict[tuple[str, bool], list[Pocket]] = {}
    for each in audit.pockets:
        groups.setdefault((each.carrier, each.is_slot), []).append(each)
    for (carrier, is_slot), alike in groups.items():
        what = f"{len(alike)} {'slot' if is_slot else 'pocket'}{'s' * (len(alike) > 1)}"
        if is_slot:
            text = f"{_span([1e3 * p.gap for p in alike], '.1f')} mm open, an edge gets through"
        else:
            held = [p.friction for p in alike]
            deep = _span([1e3 * p.depth for p in alike], ".1f")
            text = f"{deep} mm deep, by their walls alone they hold below {_span(held, '.2f')}"
        yield from _wrapped(f"{carrier}: {what}, {text}")


def _verdicts(audit: Audited) -> Iterator[str]:
    samples, repeats = (audit.table.sizes[name] for name in ("sample", "repeat"))
    each = "1 run" if repeats == 1 else f"{repeats} runs"
    many = f"{samples} robots on floors, {each} each" if audit.unknown else f"{samples} runs"
    yield f"Verdicts: {many}, at {audit.drive.speed:g} m/s; intervals of 95 %"
    yield from _wrapped(f"belt: {audit.belt.reason}")
    ends = audit.table["outcome"].values
    lost = int(np.isin(ends, NO_RESULT).sum())
    if lost:
        yield from _wrapped(f"{lost} of {ends.size} runs have no result: see `error` in the table")
    rows = [("obstacle", "clears", "seizes", "belt clears", "most often", "verdict")]
    rows += [
        (
            each.obstacle,
            _share(each.cleared),
            _share(each.seized),
            _percent(each.belt_cleared.rate),
            each.outcome.replace("_", " "),
            each.word,
        )
        for each in audit.verdicts
    ]
    yield from _columns(rows)
    jammed = [each for each in audit.verdicts if each.where]
    if jammed:
        yield "  where most of its seizures are, and how many a change frees there:"
        yield from _columns(_jams(jammed))
        yield from _names(audit, jammed)


_SHORT = {"closed track": "belt", "closed track, clear of the ground": "belt set clear"}


def _jams(jammed: Sequence[Verdict]) -> list[tuple[str, ...]]:
    """Say where it is jammed, and what frees it: one row for each obstacle."""
    head = ("obstacle", "between wheels", "runs", "friction", "freed there by")
    rows: list[tuple[str, ...]] = [head]
    for each in jammed:
        low, high = each.friction
        at = "" if math.isnan(low) else f"{low:.2f}-{high:.2f}"
        freed = [
            f"{_SHORT.get(trial.trial, trial.trial)} {trial.freed}"
            for trial in each.freed
            if trial.freed
        ]
        place = f"{each.where} of the {each.carrier}"
        rows.append((each.obstacle, place, "/".join(map(str, each.there)), at, ", ".join(freed)))
    return rows


def _names(audit: Audited, jammed: Sequence[Verdict]) -> Iterator[str]:
    """Say what the file calls the wheels between which it is jammed."""
    if audit.reading is None:
        return
    names = names_of(audit.robot, audit.reading)
    bodies = {int(body) for each in jammed for body in each.where.split("-")}
    called = [f"{body} is {names[body]}" for body in sorted(bodies) if body in names]
    if called:
        yield from _wrapped(f"on the left, wheel {', '.join(called)}")


def _conclusion(audit: Audited) -> Iterator[str]:
    seizing = [each.obstacle for each in audit.verdicts if each.word == "seizes"]
    others = [
        f"{each.obstacle} ({each.instead} of {each.there[1]})"
        for each in audit.verdicts
        if each.word != "seizes" and each.seized.low > SEIZES
    ]
    count = len(audit.verdicts)
    if seizing:
        text = f"It seizes on {len(seizing)} of {count} obstacles that the belt clears"
        yield from _wrapped(f"{text}: {', '.join(seizing)}.", 0)
    else:
        clears = sum(each.belt_cleared.rate >= CLEARS for each in audit.verdicts)
        yield f"It was not found to seize where the belt clears, on {clears} of {count} obstacles."
    if others:
        text = (
            "It also seizes where the belt clears less than 95 % of its runs (in brackets, how many"
            " of the seized runs the belt clears with the same draws)"
        )
        yield from _wrapped(f"{text}: {', '.join(others)}.", 0)
    unsure = [each.obstacle for each in audit.verdicts if each.word == "not certain"]
    if unsure:
        yield from _wrapped(f"Not certain, for want of runs: {', '.join(unsure)}.", 0)
    if audit.repaired is not None:
        yield from _repairs(audit.repaired, seizing)


def _repairs(found: Repaired, seizing: Sequence[str]) -> Iterator[str]:
    if any(each.confirmed for each in found.repairs):
        yield f"Repairs: the best of {found.tried} candidates, in fresh runs"
    else:
        yield f"Repairs: none of {found.tried} candidates was confirmed in fresh runs"
    for each in found.repairs:
        yield from _wrapped(_repair(each, seizing))
    for kind in found.hopeless:
        yield f"  {kind}: no candidate cleared most of three runs in which it seized"


def _repair(repair: Repair, seizing: Sequence[str]) -> str:
    cleared = min((repair.cleared[name] for name in seizing), key=lambda share: share.rate)
    name, seized = max(repair.seized.items(), key=lambda item: (item[1].low, item[1].rate))
    where = f", most on {name}" if seized.rate > 0.0 else ""
    return (
        f"{'confirmed' if repair.confirmed else 'not confirmed'}: {repair.what}; clears at least"
        f" {_share(cleared)} where it seized; seizes at most {_share(seized)}{where};"
        f" {repair.wheels} wheels a side; simulated {repair.speed:.2g} times as fast"
    )


def _range(distribution: Distribution) -> str:
    """Write a range in words, as far as its kind is known."""
    match distribution:
        case Uniform(low, high):
            return f"{low:g} to {high:g}"
        case Scaled(low, high):
            return f"times {low:g} to {high:g}"
        case Shifted():
            of = str(distribution.of or "").rpartition(".")[2].replace("_", " ")
            unit = f" of the {of}" if of else ""
            return f"{distribution.low:+g} to {distribution.high:+g}{unit}"
    return str(distribution)


def _side(length: float, positive: str, negative: str) -> str:
    return f"{1e3 * abs(length):.0f} mm {positive if length >= 0.0 else negative}"


def _span(values: Sequence[float], form: str) -> str:
    low, high = (format(bound, form) for bound in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def _percent(rate: float) -> str:
    return "no result" if math.isnan(rate) else f"{100 * rate:.0f} %"


def _share(share: Share) -> str:
    """Write a rate with its interval, in percent."""
    return f"{_percent(share.rate)} ({100 * share.low:.0f}-{100 * share.high:.0f})"


def _columns(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        cells = (cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        yield f"  {'  '.join(cells)}".rstrip()


def _wrapped(text: str, indent: int = 2) -> list[str]:
    return textwrap.wrap(
        text,
        _WIDTH,
        initial_indent=" " * indent,
        subsequent_indent=" " * (indent + 4),
        break_long_words=False,
        break_on_hyphens=False,
    )
