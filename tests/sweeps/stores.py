"""Stores for damage by tests, and readers of their contents."""

import contextlib
import hashlib
import os
import sqlite3
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import crawler2d as c2d
from crawler2d.results.record import Row
from crawler2d.sweeps.database import COLUMNS, with_checksum
from crawler2d.sweeps.store import Store, stored_rows
from tests.sweeps.small import BASE, MODELS, quiet

TRIALS = ("torque x 2",)


def sound(path: Path, repeats: int = 5) -> Path:
    """Make a store with runs that clear, stop, and diverge."""
    over = {"robot.track": MODELS, "terrain.height": [0.03, 0.12]}
    quiet(BASE, over, repeats=repeats, store=path, trials=TRIALS)
    scenario = BASE.replace({"duration": 4.5})
    error = c2d.SimulationDiverged("chassis is not finite", step=7, body="chassis")
    with Store(path, TRIALS) as store:
        store.add([Row.of_error(error, scenario.identity, c2d._core.canonical(scenario.to_json()))])
    return path


def read(path: Path) -> dict[str, str]:
    """The data for the rows of `table`, as text, by identity."""
    kept = [(row.identity, told(row, build, trials)) for row, build, trials in stored_rows(path)]
    assert len(dict(kept)) == len(kept)
    return dict(kept)


def bits(path: Path) -> dict[str, str]:
    """The same without the computing time, which differs between computations."""
    return {
        row.identity: told(replace(row, wall_time=0.0), build, trials)
        for row, build, trials in stored_rows(path)
    }


def hash_of(path: Path) -> str:
    """Hash these rows, sorted by identity."""
    return hashlib.sha256(repr(sorted(bits(path).items())).encode()).hexdigest()


def told(row: Row, *more: Any) -> str:
    """A row as text; no error equals another."""
    return repr((row, None if row.error is None else vars(row.error), more))


@contextlib.contextmanager
def opened(path: Path) -> Iterator[sqlite3.Connection]:
    """Open the file like any other program."""
    with contextlib.closing(sqlite3.connect(path)) as connection, connection:
        yield connection


def change(path: Path, number: int, **columns: Any) -> None:
    """Change columns of a row, and write the checksum that belongs to them."""
    with opened(path) as connection:
        for name, value in columns.items():
            connection.execute(f"UPDATE run SET {name} = ? WHERE rowid = ?", (value, number))
        query = f"SELECT {COLUMNS} FROM run WHERE rowid = ?"
        *values, _ = connection.execute(query, (number,)).fetchone()
        checksum = with_checksum(values)[-1]
        connection.execute("UPDATE run SET checksum = ? WHERE rowid = ?", (checksum, number))


def as_version_1(path: Path) -> None:
    """Convert a store to the former format."""
    columns = COLUMNS.removesuffix(", checksum")
    with opened(path) as connection:
        connection.executescript(f"""
            ALTER TABLE run RENAME TO present;
            CREATE TABLE run (
                identity TEXT NOT NULL, build TEXT NOT NULL, trials TEXT NOT NULL,
                outcome TEXT NOT NULL, metrics TEXT NOT NULL, diagnosis TEXT, wall_time REAL,
                error TEXT, scenario TEXT NOT NULL, PRIMARY KEY (identity, build, trials)
            );
            INSERT INTO run ({columns}) SELECT {columns} FROM present;
            DROP TABLE present;
            PRAGMA user_version = 1;
        """)


@contextlib.contextmanager
def unprivileged() -> Iterator[None]:
    """Become a user who is subject to permissions."""
    c2d.table([])  # imports modules that this user may not be able to read
    assert all(getattr(c2d, name) for name in c2d.__all__)
    root = os.geteuid() == 0
    if root:
        os.seteuid(65534)
    try:
        yield
    finally:
        if root:
            os.seteuid(0)
