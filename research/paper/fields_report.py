"""The paper's Table 2 beside ours in Markdown, with what was chosen for it, and the failures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from research.columns import percent
from research.markdown import markdown_table
from research.paper.agreement import WITHIN
from research.paper.layouts import READINGS, layouts
from research.paper.settings import SETTINGS

if TYPE_CHECKING:
    from research.paper.failures import Failures
    from research.paper.fields import Beside, FieldCell

__all__ = ["chosen_text", "failures_text", "layouts_text", "table_2_text"]


def chosen_text() -> str:
    """List what was chosen before any run: layouts for rows, and settings."""
    readings = [(each.row, each.layout, each.reason) for each in READINGS]
    settings = [
        (
            each.name,
            f"{each.max_torque:g} N m a {'wheel' if each.a_wheel else 'sprocket'}",
            f"{each.friction:g}",
            each.reason,
        )
        for each in SETTINGS
    ]
    return "\n\n".join(
        (
            markdown_table(("row of the paper", "layout", "why"), readings),
            markdown_table(("setting", "motors", "friction", "why"), settings),
            "Without wheels that is the torque of the sprocket.",
        )
    )


def table_2_text(rows: Sequence[Beside]) -> str:
    """Set the paper's Table 2 beside ours: counts, difference with its interval, verdict."""
    settings = list(dict.fromkeys(row.setting for row in rows))
    table = []
    for obstacle, model in dict.fromkeys((row.obstacle, row.model) for row in rows):
        own = {row.setting: row for row in rows if (row.obstacle, row.model) == (obstacle, model)}
        share = percent(next(iter(own.values())).paper)
        table.append((obstacle, model, share, *(_beside(own.get(s)) for s in settings)))
    head = ("field", "layout", "paper [%]", *settings)
    note = (
        "Cells: our runs that cleared; the difference from the paper's rate in percentage points,"
        " with Newcombe's 95 % interval (20 runs of the paper); the verdict. *Agrees*: within"
        f" {100 * WITHIN:.0f} points. Otherwise *differs* if the interval excludes 0, *open* if it"
        " contains 0."
    )
    return f"{note}\n\n{markdown_table(head, table)}"


def layouts_text(rows: Sequence[FieldCell]) -> str:
    """List the rates of all layouts, fields side by side."""
    settings = list(dict.fromkeys(row.setting for row in rows))
    obstacles = list(dict.fromkeys(row.obstacle for row in rows))
    known = layouts()
    table = []
    for model in (name for name in known if any(row.model == name for row in rows)):
        cells = []
        for setting in settings:
            own = [
                row
                for obstacle in obstacles
                for row in rows
                if (row.model, row.setting, row.obstacle) == (model, setting, obstacle)
            ]
            cells.append(" / ".join(percent(row.rate) for row in own))
        table.append((model, known[model].source, *cells))
    counts = sorted({row.count for row in rows})
    widest = max((max(row.rate - row.low, row.high - row.rate) for row in rows), default=0.0)
    note = (
        f"Runs that cleared [%], of {' or '.join(map(str, counts))} a cell: {', '.join(obstacles)}."
        f" Wilson's 95 % intervals, in `paper_table_2.csv`, reach at most {percent(widest)} points"
        " either way."
    )
    return f"{note}\n\n{markdown_table(('layout', 'from', *settings), table)}"


def failures_text(rows: Sequence[Failures], models: Iterable[str]) -> str:
    """Tell where and why runs failed: a sum for every setting, and rows for some layouts."""
    wanted, sums = set(models), []
    settings = list(dict.fromkeys(row.setting for row in rows))
    for setting in settings:
        own = [row for row in rows if row.setting == setting]
        with_barrier = [row for row in own if row.has_barrier]
        before, count = (
            sum(getattr(row, name) for row in with_barrier) for name in ("before", "count")
        )
        sums.append(
            f"- {setting}: {sum(row.count for row in own)} runs of all layouts failed; of the"
            f" {count} with a barrier, {before} ended before it."
        )
    table = [
        (
            row.setting,
            row.obstacle,
            row.model,
            str(row.count),
            str(row.before) if row.has_barrier else "-",
            row.outcomes,
            row.mechanisms or "-",
            str(row.in_flippers or "-"),
        )
        for row in sorted(rows, key=lambda row: settings.index(row.setting))
        if row.model in wanted
    ]
    head = (
        *("setting", "field", "layout", "failures", "before the barrier"),
        *("outcomes", "how the ground is held", "by a flipper's track"),
    )
    note = (
        "A run ended *before the barrier* if its tracks had not reached it; flippers may have."
        " `paper_failures.csv` has every failure with its place and its sentence."
    )
    return "\n\n".join((note, "\n".join(sums), markdown_table(head, table)))


def _beside(row: Beside | None) -> str:
    if row is None:
        return ""
    points = [f"{100 * each:+.0f}" for each in (row.difference, row.low, row.high)]
    return (
        f"{row.cleared} of {row.count}; {points[0]} ({points[1]} to {points[2]}): **{row.verdict}**"
    )
