"""How an audit was made, as part of its page: runs, draws, versions, and what makes it again."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from crawler2d import _core
from crawler2d.audits import words
from crawler2d.audits.call import command_of
from crawler2d.audits.page.figures import unknowns
from crawler2d.audits.page.grid import grid
from crawler2d.common.markup import escaped

if TYPE_CHECKING:
    from crawler2d.audits.audited import Audited

__all__ = ["made"]

_LONG = re.compile(r"\d+\.\d{4,}")
"""Numbers with more digits than are worth reading."""


def made(audit: Audited) -> str:
    """Write how the audit was made."""
    parts = (
        _table(("what", "how"), _rows(audit), "how it was made"),
        f"<details><summary>obstacles</summary>{_obstacles(audit)}</details>",
        "<h3>What differed from run to run</h3>",
        unknowns(audit.vary, "what differed from run to run"),
        "<h3>What makes it again</h3>",
        f'<pre tabindex="0">{escaped(_again(audit))}</pre>',
    )
    return "".join(parts)


def _rows(audit: Audited) -> Iterator[tuple[str, str]]:
    yield "runs behind the verdicts", f"{audit.table['outcome'].size}: {words.population(audit)}"
    if audit.repaired is not None:
        fresh = audit.repaired.table["outcome"].size
        yield "runs that confirm repairs", f"{fresh}, with draws that nothing before has had"
    yield "belt beside it", audit.belt.reason
    yield "drive", str(audit.drive)
    yield "seed of the draws", str(audit.call.seed)
    if audit.reading is not None:
        yield "file", f"{audit.reading.tree.file}, {audit.reading.tree.format}"
        yield "rule of friction", f"that of {audit.reading.engine}"
    build = _core.build_info()
    yield "crawler2d", ", ".join(f"{name} {value}" for name, value in build.items())


def _obstacles(audit: Audited) -> str:
    """List the obstacles with their measures [m], [rad]."""
    rows = (
        (name, _LONG.sub(lambda found: f"{float(found[0]):.4g}", str(each)))
        for name, each in audit.obstacles.items()
    )
    return _table(("obstacle", "measures [m], [rad]"), rows, "obstacles")


def _table(head: tuple[str, str], rows: Iterable[tuple[str, str]], label: str) -> str:
    return grid(head, [(escaped(name), escaped(value)) for name, value in rows], label=label)


def _again(audit: Audited) -> str:
    """Write the command that makes the audit again, or else the call."""
    call, read = audit.call, audit.reading
    command = None if read is None else command_of(call, str(read.path))
    if command is not None:
        return command
    arguments = ["robot" if read is None else repr(str(read.path))]
    arguments += [f"{name}=..." for name in call.own]
    arguments += [f"{name}={value!r}" for name, value in call.reading.items()]
    arguments += [
        f"{name}={getattr(call, name)}" for name in ("samples", "repeats", "seed", "repair")
    ]
    return f"crawler2d.audit({', '.join(arguments)}).to_html(path)"
