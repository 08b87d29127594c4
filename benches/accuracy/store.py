"""The finished runs, in one SQLite file: nothing is lost on Ctrl-C, and no run is made twice."""

from __future__ import annotations

import hashlib
import json
import sqlite3
from collections.abc import Iterable
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Self

import crawler2d as c2d
from benches.accuracy.cells import Cell, Setting
from benches.accuracy.ensemble import Row

_TABLE = """
create table if not exists runs (
    build text, cell text, name text, setting text, repeat integer, outcome text,
    x real, y real, angle real, time real, solves real, processor real,
    primary key (build, cell, setting, repeat)
)
"""


class Store:
    """The runs of any cells with any settings.

    Parameters
    ----------
    path : Path
        The file; it is made if it is not there.
    any_build : bool
        Whether runs of other builds of the core count as well, for a build that moves no run.
    """

    def __init__(self, path: Path, *, any_build: bool = False) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        self._file = sqlite3.connect(path)
        self._build = str(c2d.build_info()["build_id"])
        self._builds = "%" if any_build else self._build
        with self._file as transaction:
            transaction.execute(_TABLE)

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close the file."""
        self._file.close()

    def rows(self, cell: Cell, setting: Setting) -> dict[int, Row]:
        """Read the runs of a cell with a setting, by repeat."""
        asked = (
            "select repeat, outcome, x, y, angle, time, solves, processor from runs"
            " where build like ? and cell = ? and setting = ? order by build = ?, repeat"
        )
        wanted = (self._builds, key(cell), _text(setting), self._build)
        with closing(self._file.execute(asked, wanted)) as found:
            return {row[0]: Row(*row) for row in found}

    def add(self, cell: Cell, setting: Setting, rows: Iterable[Row]) -> None:
        """Keep finished runs, all of them or none."""
        place = (self._build, key(cell), cell.name, _text(setting))
        with self._file as transaction:
            transaction.executemany(
                f"insert or replace into runs values ({', '.join('?' * 12)})",
                [(*place, *row) for row in rows],
            )

    def builds(self) -> list[str]:
        """List the builds whose runs count."""
        asked = "select distinct build from runs where build like ? order by build"
        with closing(self._file.execute(asked, (self._builds,))) as found:
            return [build for (build,) in found]


def key(cell: Cell) -> str:
    """Tell cells apart by all that their runs depend on."""
    fields = {name: value for name, value in asdict(cell).items() if name != "found"}
    return hashlib.sha256(_text(fields).encode()).hexdigest()[:16]


def _text(fields: Setting) -> str:
    return json.dumps(fields, sort_keys=True)
