"""A store: one SQLite file that keeps the runs of any number of sweeps, one row a run."""

from __future__ import annotations

import contextlib
import json
import math
import sqlite3
from collections.abc import Collection, Iterable, Iterator, Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any, Self

from crawler2d import errors
from crawler2d._core import build_info
from crawler2d.errors import Crawler2dError, ScenarioError, StoreError
from crawler2d.results.row import Row, diagnosis_json, read_diagnosis

__all__ = ["Store", "join_stores", "stored_rows"]

# "c2ds": what tells the file from those of other programs.
_APPLICATION = 0x63326473
_VERSION = 1
_TABLE = """
CREATE TABLE run (
    identity TEXT NOT NULL,  -- SHA-256 of the scenario's canonical JSON
    build TEXT NOT NULL,     -- what computed it
    trials TEXT NOT NULL,    -- what was tried at a stop, as JSON
    outcome TEXT NOT NULL,
    metrics TEXT NOT NULL,   -- as JSON; what is not known is null
    diagnosis TEXT,          -- of a stop, as JSON
    wall_time REAL,          -- [s]
    error TEXT,              -- class and arguments as JSON, without a result
    scenario TEXT NOT NULL,  -- as JSON
    PRIMARY KEY (identity, build, trials)
)
"""
_COLUMNS = "identity, scenario, outcome, metrics, diagnosis, wall_time, error"
# SQLite takes so many values in one query, in every version.
_AT_ONCE = 500

Place = str | PathLike[str]


class Store:
    """An open store, of which this process is the only writer.

    A row is found again by the identity of its scenario, the build of the core and the trials that
    were asked for: what gives the same bits. Rows are never changed. Whatever kills the process,
    the rows that `add` has returned from are there.

    Parameters
    ----------
    path : str or path-like
        The file; it is made if it does not exist.
    trials : collection of str
        Names of the trials of the rows that are read and added.

    Raises
    ------
    StoreError
        If it is no store, or another process writes into it.
    """

    def __init__(self, path: Place, trials: Collection[str] = ()) -> None:
        self.path = Path(_text(path))
        self._build = str(build_info()["build_id"])
        self._trials = json.dumps(sorted(trials))
        self._lock = _locked(self.path)
        try:
            self._connection = _connected(self.path)
        except BaseException:
            self._lock.close()
            raise

    def __enter__(self) -> Self:
        """Return the store."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """End; everything that was added is in the file."""
        with contextlib.suppress(sqlite3.Error):
            self._connection.close()
        self._lock.close()

    def add(self, rows: Iterable[Row]) -> None:
        """Add finished runs, all or none; those that are there already are left.

        Raises
        ------
        StoreError
            If the disk is full or the file cannot be written; earlier rows are kept.
        """
        values = [self._values(row) for row in rows]
        with _told(self.path, self._connection):
            self._connection.executemany(
                f"INSERT OR IGNORE INTO run ({_COLUMNS}, build, trials)"
                " VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?)",
                values,
            )
            self._connection.commit()

    def found(self, identities: Sequence[str]) -> dict[str, Row]:
        """Read the rows of these scenarios that are there, by identity."""
        found: dict[str, Row] = {}
        for begin in range(0, len(identities), _AT_ONCE):
            some = identities[begin : begin + _AT_ONCE]
            marks = ", ".join("?" * len(some))
            query = (
                f"SELECT {_COLUMNS} FROM run"
                f" WHERE build = ? AND trials = ? AND identity IN ({marks})"
            )
            with _told(self.path, self._connection):
                for values in self._connection.execute(query, (self._build, self._trials, *some)):
                    row = _row(values)
                    found[row.identity] = row
        return found

    def copy(self, place: Path) -> int:
        """Add the runs of another store, all or none; returns how many were new."""
        with _told(self.path, self._connection):
            self._connection.execute("ATTACH ? AS other", (str(place),))
            try:
                added = _copied(self._connection, self.path, place)
                self._connection.commit()
            except BaseException:
                self._connection.rollback()
                raise
            finally:
                self._connection.execute("DETACH other")
        return added

    def _values(self, row: Row) -> tuple[Any, ...]:
        figures = {name: value if value == value else None for name, value in row.metrics.items()}  # noqa: PLR0124 - nan
        return (
            row.identity,
            row.scenario,
            row.outcome,
            json.dumps(figures, separators=(",", ":")),
            None if row.diagnosis is None else diagnosis_json(row.diagnosis),
            None if math.isnan(row.wall_time) else row.wall_time,
            None if row.error is None else _error_json(row.error),
            self._build,
            self._trials,
        )


def stored_rows(path: Place) -> Iterator[tuple[Row, str, tuple[str, ...]]]:
    """Read every row of a store with its build and its trials, also while it is written.

    Raises
    ------
    StoreError
        If there is no such file, or it is no store.
    """
    place = Path(_text(path))
    if not place.is_file():
        raise StoreError(f"{place} is not there: a sweep with store= makes a store")
    with contextlib.closing(_connected(place, made=False)) as connection, _told(place):
        query = f"SELECT {_COLUMNS}, build, trials FROM run ORDER BY rowid"
        for *values, build, trials in connection.execute(query):
            yield _row(values), build, tuple(json.loads(trials))


def join_stores(into: Place, *others: Place) -> int:
    """Copy the runs of other stores into one; what it holds already is left.

    Parameters
    ----------
    into : str or path-like
        The store that grows; it is made if it does not exist.
    *others : str or path-like
        The stores to read; they are not changed.

    Returns
    -------
    int
        Number of runs added.

    Raises
    ------
    StoreError
        If one of the files is no store, `into` is written by another process, or two hold different
        results of the same run; then nothing of that other one is added.

    Examples
    --------
    >>> import os, tempfile
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     first, second = os.path.join(folder, "a.sqlite"), os.path.join(folder, "b.sqlite")
    ...     _ = c2d.sweep(base, {}, repeats=2, store=first, progress=False)
    ...     _ = c2d.sweep(base, {}, repeats=3, store=second, progress=False)
    ...     c2d.join_stores(first, second)
    1
    """
    places = [Path(_text(other)) for other in others]
    for place in places:
        if not place.is_file():
            raise StoreError(f"{place} is not there")
        _connected(place, made=False).close()
    with Store(into) as store:
        return sum(map(store.copy, places))


def _copied(connection: sqlite3.Connection, into: Path, place: Path) -> int:
    same = "a.identity = b.identity AND a.build = b.build AND a.trials = b.trials"
    differs = "a.outcome <> b.outcome OR a.metrics <> b.metrics"
    query = f"SELECT b.identity FROM run a JOIN other.run b ON {same} WHERE {differs} LIMIT 1"
    conflict = connection.execute(query).fetchone()
    if conflict is not None:
        raise StoreError(
            f"{into} and {place} hold different results of the run {conflict[0][:12]}: the same"
            " build gives the same bits, so one of the files was changed"
        )
    columns = f"{_COLUMNS}, build, trials"
    cursor = connection.execute(
        f"INSERT OR IGNORE INTO run ({columns}) SELECT {columns} FROM other.run ORDER BY rowid"
    )
    return cursor.rowcount


def _text(path: Place) -> str:
    try:
        return str(fspath(path))
    except TypeError:
        raise ScenarioError("store", path, "must be the path of a file") from None


def _locked(path: Path) -> sqlite3.Connection:
    """Hold a lock that ends with this process, however that ends.

    SQLite itself locks on every system; a file beside the store leaves that open to readers.
    """
    lock = path.with_name(f"{path.name}-lock")
    connection = None
    try:
        connection = sqlite3.connect(lock, timeout=0.0)
        connection.execute("PRAGMA locking_mode = EXCLUSIVE")
        connection.execute("BEGIN EXCLUSIVE")
    except sqlite3.Error as error:
        if connection is not None:
            connection.close()
        if "locked" in str(error):
            raise StoreError(
                f"{path} is being written by another process or session: wait for it, or give this"
                " one a file of its own and join both with join_stores"
            ) from None
        raise StoreError(f"{path} cannot be made or written: {error}") from None
    return connection


def _connected(path: Path, *, made: bool = True) -> sqlite3.Connection:
    """Open the file, and check or make what is in it."""
    connection = None
    with _told(path):
        try:
            connection = sqlite3.connect(path, timeout=10.0)
            application = connection.execute("PRAGMA application_id").fetchone()[0]
            tables = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
            if made and application == 0 and tables == 0:
                connection.execute("PRAGMA journal_mode = WAL")
                connection.execute(f"PRAGMA application_id = {_APPLICATION}")
                connection.execute(f"PRAGMA user_version = {_VERSION}")
                connection.execute(_TABLE)
                connection.commit()
            elif application != _APPLICATION:
                raise StoreError(f"{path} is an SQLite file, but no store of crawler2d")
            version = connection.execute("PRAGMA user_version").fetchone()[0]
            if version > _VERSION:
                raise StoreError(
                    f"{path} was written by a newer crawler2d (version {version} of the format;"
                    f" this one reads {_VERSION}): upgrade"
                )
            # What is committed outlives this process, though not a loss of power.
            connection.execute("PRAGMA synchronous = NORMAL")
        except BaseException:
            if connection is not None:
                connection.close()
            raise
    return connection


@contextlib.contextmanager
def _told(path: Path, connection: sqlite3.Connection | None = None) -> Iterator[None]:
    """Turn an error of SQLite into one that says what helps; the open transaction is undone."""
    try:
        yield
    except sqlite3.Error as error:
        if connection is not None:
            with contextlib.suppress(sqlite3.Error):
                connection.rollback()
        text = str(error)
        if "full" in text or "disk I/O" in text:
            raise StoreError(
                f"{path} cannot grow ({text}): the disk is full or fails; the runs in it are kept."
                " Free some space and call again: it goes on from there"
            ) from error
        if "not a database" in text or "malformed" in text:
            raise StoreError(f"{path} is no SQLite file, or is damaged ({text})") from error
        raise StoreError(f"{path}: {text}") from error


def _row(values: Sequence[Any]) -> Row:
    identity, scenario, outcome, metrics, diagnosis, wall_time, error = values
    figures = {k: math.nan if v is None else v for k, v in json.loads(metrics).items()}
    return Row(
        identity,
        scenario,
        outcome,
        figures,
        None if diagnosis is None else read_diagnosis(diagnosis),
        math.nan if wall_time is None else wall_time,
        None if error is None else _error(error),
    )


def _error_json(error: Crawler2dError) -> str:
    return json.dumps([type(error).__name__, *error.args])


def _error(text: str) -> Crawler2dError:
    name, *arguments = json.loads(text)
    error: Crawler2dError = getattr(errors, name)(*arguments)
    return error
