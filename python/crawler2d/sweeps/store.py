"""Stores: SQLite files that keep the runs of any number of sweeps, and checks for damage."""

from __future__ import annotations

import contextlib
import json
import sqlite3
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from crawler2d._core import build_info
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import StoreError
from crawler2d.results.record import Row
from crawler2d.sweeps.database import (
    COLUMNS,
    INSERT,
    Kept,
    OtherBuild,
    Place,
    find_damage,
    open_to_read,
    open_to_write,
    read_checked,
    read_row,
    read_store_path,
    row_values,
    store_errors,
)

__all__ = ["Store", "check_store", "join_stores", "stored_rows"]

# Number of values that SQLite accepts in one query, in every version.
_AT_ONCE = 500


class Store:
    """An open store; this process is its only writer.

    The key of a row is the identity of its scenario, the build of the core and the requested
    trials, which together give the same bits. Rows are never changed. Once `add` has returned, its
    rows are kept, even if the process is killed.

    Parameters
    ----------
    path : str or path-like
        The file; created if missing.
    trials : collection of str
        Names of the trials of the rows that are read and added.

    Raises
    ------
    ScenarioError
        If it cannot be the path of a file.
    StoreError
        If it is not a store, is damaged, or another process writes to it.
    """

    def __init__(self, path: Place, trials: Collection[str] = ()) -> None:
        self.path = read_store_path(path)
        self._build = str(build_info()["build_id"])
        self._trials = json.dumps(sorted(trials))
        self._connection, self._lock = open_to_write(self.path)

    def __enter__(self) -> Self:
        """Return the store."""
        return self

    def __exit__(self, *error: object) -> None:
        """Close it."""
        self.close()

    def close(self) -> None:
        """Close the file; everything that was added is in it."""
        with contextlib.suppress(sqlite3.Error):
            self._connection.close()
        self._lock.close()

    def add(self, rows: Iterable[Row]) -> None:
        """Add finished runs, all or none; existing ones are skipped.

        Raises
        ------
        StoreError
            If the disk is full or the file cannot be written: earlier rows are kept. If the file
            was removed: none are kept.
        """
        with self._transaction() as connection:
            connection.executemany(
                INSERT, [row_values(row, self._build, self._trials) for row in rows]
            )

    def read(self, identities: Sequence[str]) -> dict[str, Row]:
        """Read the existing rows of some scenarios, by identity.

        Raises
        ------
        StoreError
            If one of them is damaged.
        """
        rows: dict[str, Row] = {}
        for begin in range(0, len(identities), _AT_ONCE):
            some = identities[begin : begin + _AT_ONCE]
            marks = ", ".join("?" * len(some))
            query = (
                f"SELECT rowid, {COLUMNS} FROM run"
                f" WHERE build = ? AND trials = ? AND identity IN ({marks})"
            )
            with store_errors(self.path):
                for number, *values in self._connection.execute(
                    query, (self._build, self._trials, *some)
                ):
                    kept = read_row(self.path, number, values)
                    if kept is not None:  # of this build, which can read it
                        rows[kept[0].identity] = kept[0]
        return rows

    def copy(self, place: Path) -> int:
        """Add the runs of another store, all or none; return how many were new.

        Raises
        ------
        StoreError
            If the other store is damaged, or the two have different results of a run.
        """
        added = 0
        with self._transaction() as connection:
            for _, values in _stored(place):
                new = connection.execute(INSERT, values).rowcount
                added += new
                if not new:
                    self._compare(values, place)
        return added

    def _compare(self, values: Sequence[Any], place: Path) -> None:
        identity, build, trials, *result = values[:5]
        query = "SELECT outcome, metrics FROM run WHERE identity = ? AND build = ? AND trials = ?"
        kept = self._connection.execute(query, (identity, build, trials)).fetchone()
        if kept != tuple(result):
            raise StoreError(
                f"{self.path} and {place} hold different results of the run {identity[:12]}: the"
                " same build gives the same bits, so one of the files was changed"
            )

    @contextlib.contextmanager
    def _transaction(self) -> Iterator[sqlite3.Connection]:
        """Make changes, all or none."""
        connection = self._connection
        try:
            with store_errors(self.path):
                self._lock.keep()
                connection.execute("BEGIN IMMEDIATE")
                yield connection
                connection.execute("COMMIT")
        finally:
            with contextlib.suppress(sqlite3.Error):
                connection.execute("ROLLBACK")  # does nothing after COMMIT
            # What SQLite writes to a removed file is lost when the file is closed.
            if not self._lock.is_there():
                raise StoreError(
                    f"{self.path} was removed, moved or replaced while it was written: its runs are"
                    " not kept. `runs` of this error has those of the last batch"
                )


def stored_rows(path: Place) -> Iterator[Kept]:
    """Read every row of a store with its build and trials, even while it is written.

    Raises
    ------
    StoreError
        If the file is missing, not a store, or damaged.
    """
    place = read_store_path(path)
    for kept, (identity, build, *_) in _stored(place):
        if kept is None:
            raise StoreError(
                f"{place}: the run {identity[:12]} is from the build {build}, with outcomes or"
                " diagnoses that this one cannot read: read it with that build"
            )
        yield kept


@takes_keywords
def join_stores(into: Place, *others: Place) -> int:
    """Copy the runs of other stores into one, except those that it already has.

    Parameters
    ----------
    into : str or path-like
        The store to extend; created if missing, and converted if an earlier version of crawler2d
        wrote it.
    *others : str or path-like
        The stores to read; they are not changed.

    Returns
    -------
    int
        Number of runs added.

    Raises
    ------
    ScenarioError
        If an argument cannot be the path of a file.
    StoreError
        If a file is not a store or is damaged, another process writes to `into`, or two stores have
        different results of the same run; nothing is added from the store that fails.

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
    places = [read_store_path(other) for other in others]
    for place in places:
        open_to_read(place).close()
    with Store(into) as store:
        return sum(map(store.copy, places))


def _stored(place: Path) -> Iterator[tuple[Kept | None, list[Any]]]:
    """Read every row of a store, also as its values."""
    with store_errors(place), contextlib.closing(open_to_read(place)) as connection:
        query = f"SELECT rowid, {COLUMNS} FROM run ORDER BY rowid"
        for number, *values in connection.execute(query):
            yield read_row(place, number, values), values


@dataclass(frozen=True, slots=True)
class Damage:
    """Damage in a store.

    Attributes
    ----------
    row : int, optional
        Number of the row, in the order of writing; None for the whole file.
    message : str
        What is wrong.
    """

    row: int | None
    message: str


def check_store(path: Place) -> tuple[Damage, ...]:
    """Check a store: its structure, the checksum of every row, and that each row is a run.

    Sweeps, `table` and `join_stores` refuse damaged stores and rows; this function lists all
    damage. It changes nothing, and may be called while a sweep writes.

    Parameters
    ----------
    path : str or path-like
        The file.

    Returns
    -------
    tuple of Damage
        Empty if the store is intact.

    Raises
    ------
    ScenarioError
        If it cannot be the path of a file.
    StoreError
        If the file is missing or cannot be opened as a store.

    Examples
    --------
    >>> import os, tempfile
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     store = os.path.join(folder, "a.sqlite")
    ...     _ = c2d.sweep(base, {}, repeats=2, store=store, progress=False)
    ...     c2d.check_store(store)
    ()
    """
    with contextlib.closing(open_to_read(read_store_path(path), checked=False)) as connection:
        found = [Damage(None, message) for message in find_damage(connection)]
        number = 0
        try:
            for number, *values in connection.execute(f"SELECT rowid, {COLUMNS} FROM run"):
                try:
                    read_checked(values)
                except OtherBuild:
                    pass  # it is as it was written
                except ValueError as fault:
                    found.append(Damage(number, str(fault)))
        except sqlite3.DatabaseError as error:
            found.append(Damage(None, f"nothing can be read after row {number}: {error}"))
    return tuple(found)
