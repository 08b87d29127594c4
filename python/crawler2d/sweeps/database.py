"""The SQLite file of a store: one writer, checksums of rows, atomic changes."""

from __future__ import annotations

import contextlib
import hashlib
import json
import math
import os
import sqlite3
import sys
import threading
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from crawler2d._core import build_info
from crawler2d.common.arrays import Metrics
from crawler2d.common.units import RENAMED_METRICS
from crawler2d.errors import Crawler2dError, ScenarioError, SimulationDiverged, StoreError
from crawler2d.results.outcome import Outcome
from crawler2d.results.record import NO_RESULT, Row, diagnosis_json, read_diagnosis

__all__ = [
    "COLUMNS",
    "INSERT",
    "Kept",
    "OtherBuild",
    "Place",
    "find_damage",
    "open_to_read",
    "open_to_write",
    "read_checked",
    "read_row",
    "read_store_path",
    "row_values",
    "store_errors",
    "with_checksum",
]

COLUMNS = (
    "identity, build, trials, outcome, metrics, diagnosis, wall_time, error, scenario, checksum"
)
"""Columns in the order of `row_values`."""

Kept = tuple[Row, str, tuple[str, ...]]
"""A row, its build and its trials."""

_OUTCOMES = frozenset({*map(str, Outcome), *NO_RESULT})
# Errors that recur every time, so they are kept; no other name in a file becomes an object.
_ERRORS: dict[str, type[Crawler2dError]] = {"SimulationDiverged": SimulationDiverged}
# Errors raised when reading a text that is not a row.
_UNREADABLE = (AttributeError, LookupError, RecursionError, TypeError, ValueError)


def row_values(row: Row, build: str, trials: str) -> tuple[Any, ...]:
    """Return the values of a row, in the order of `COLUMNS`."""
    figures = {name: None if math.isnan(value) else value for name, value in row.metrics.items()}
    return with_checksum(
        (
            row.identity,
            build,
            trials,
            row.outcome,
            json.dumps(figures, separators=(",", ":")),
            None if row.diagnosis is None else diagnosis_json(row.diagnosis),
            None if math.isnan(row.wall_time) else row.wall_time,
            None if row.error is None else json.dumps([type(row.error).__name__, *row.error.args]),
            row.scenario,
        )
    )


def with_checksum(values: Sequence[Any]) -> tuple[Any, ...]:
    """Append their checksum to the values of a row."""
    # JSON separates values and their types. It cannot write the bytes of a damaged column, which no
    # intact row has.
    text = json.dumps(values, default=repr)
    return (*values, hashlib.sha256(text.encode()).hexdigest())


class OtherBuild(ValueError):
    """An intact row of another build that this one cannot read."""


def read_checked(values: Sequence[Any]) -> Kept:
    """Return run, build and trials of a row.

    Raises
    ------
    OtherBuild
        If it has outcomes or diagnoses of another build that this one does not know.
    ValueError
        If the row is damaged; the message says how.
    """
    if with_checksum(values[:-1]) != tuple(values):
        raise ValueError("its checksum is another")
    identity, build, trials, outcome, metrics, diagnosis, wall_time, error, scenario, _ = values
    # The stored text is canonical, so this holds for every build.
    if hashlib.sha256(str(scenario).encode()).hexdigest() != identity:
        raise ValueError("its scenario does not hash to its identity")
    try:
        if outcome not in _OUTCOMES or (error is None) == (outcome in NO_RESULT):
            with_error = "without" if error is None else "with"
            raise ValueError(f"{str(outcome)[:40]!r} is not an outcome {with_error} an error")
        row = Row(
            identity,
            scenario,
            outcome,
            Metrics(
                {
                    RENAMED_METRICS.get(name, name): _number(value)
                    for name, value in json.loads(metrics).items()
                }
            ),
            None if diagnosis is None else read_diagnosis(diagnosis),
            _number(wall_time),
            None if error is None else _read_error(*json.loads(error)),
        )
        row.read_diagnosis()
        return row, str(build), tuple(map(str, json.loads(trials)))
    except _UNREADABLE as fault:
        kind = ValueError if build == build_info()["build_id"] else OtherBuild
        raise kind(f"it cannot be read ({type(fault).__name__}: {fault})") from fault


def _number(value: float | None) -> float:
    if value is None:
        return math.nan
    if type(value) not in {float, int}:
        raise TypeError(f"{value!r} is not a number")
    return value


def _read_error(name: str, *arguments: Any) -> Crawler2dError:
    return _ERRORS[name](*arguments)


if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


# Beyond the end of every file, and beyond SQLite's own locks.
_BYTE = 2**62

# Locks of this process, as the system's locks only exclude other processes.
_locked: set[tuple[int, int]] = set()
_guard = threading.Lock()


def _forget_locks() -> None:
    """Start afresh in a fork, which inherits neither locks nor threads."""
    global _guard  # noqa: PLW0603 - of this module alone
    _guard = threading.Lock()
    _locked.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_locks)


class Lock:
    """Excludes other writers of a file, whatever name they use for it.

    The lock ends with this process, even if it is killed. There is no lock file to be removed.
    Readers and SQLite itself are not affected.

    Parameters
    ----------
    file : Path
        The file; created empty if missing.

    Raises
    ------
    BlockingIOError
        If there is another writer.
    OSError
        If the file cannot be created or written.
    """

    def __init__(self, file: Path) -> None:
        self._file = file
        with _guard:
            # Not even opened: closing it would release SQLite's locks in this process.
            if file.exists() and _key(file.stat()) in _locked:
                raise BlockingIOError
            self._descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
            try:
                if sys.platform == "win32":
                    os.lseek(self._descriptor, _BYTE, os.SEEK_SET)
                    msvcrt.locking(self._descriptor, msvcrt.LK_NBLCK, 1)
                self.keep()
            except BaseException:
                os.close(self._descriptor)
                raise
            self._key = _key(os.fstat(self._descriptor))
            _locked.add(self._key)

    def keep(self) -> None:
        """Lock the byte again if necessary.

        If locks belong to the process, anything that unlocks or closes the file releases them:
        SQLite when it reads or writes without a log, or other code that copies the file.

        Raises
        ------
        BlockingIOError
            If there is another writer now.
        """
        if sys.platform != "win32":
            try:
                fcntl.lockf(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _BYTE)
            except PermissionError as error:  # raised on some systems
                raise BlockingIOError from error

    def is_there(self) -> bool:
        """Whether the file is still at its path."""
        try:
            return _key(self._file.stat()) == self._key
        except OSError:
            return False

    def close(self) -> None:
        """Release the lock."""
        with _guard:
            if self._descriptor >= 0:
                _locked.discard(self._key)  # a fork has cleared it
                os.close(self._descriptor)
                self._descriptor = -1


def _key(status: os.stat_result) -> tuple[int, int]:
    return status.st_dev, status.st_ino


# "c2ds": distinguishes the file from those of other programs.
_APPLICATION = 0x63326473
_VERSION = 2
_TABLE = """CREATE TABLE run (
    identity TEXT NOT NULL,  -- SHA-256 of the scenario, which is canonical JSON
    build TEXT NOT NULL,     -- what computed it
    trials TEXT NOT NULL,    -- what was tried at a stop, as JSON
    outcome TEXT NOT NULL,
    metrics TEXT NOT NULL,   -- as JSON; what is not known is null
    diagnosis TEXT,          -- of a stop, as JSON
    wall_time REAL,          -- [s]
    error TEXT,              -- class and arguments as JSON, without a result
    scenario TEXT NOT NULL,  -- as JSON
    checksum TEXT NOT NULL,  -- SHA-256 of the other columns
    PRIMARY KEY (identity, build, trials)
)"""
INSERT = f"INSERT OR IGNORE INTO run ({COLUMNS}) VALUES (?{', ?' * COLUMNS.count(',')})"
"""Inserts a row unless its key exists."""

# [s] Time to wait for another program that reads or writes the file.
_PATIENCE = 10.0
_TAKEN = (
    "is being written by another process or session: wait for it, or give this one a file of its"
    " own and join both with join_stores"
)

Place = str | os.PathLike[str]


def read_store_path(path: Place) -> Path:
    """Check that an argument can be the path of a file."""
    try:
        text = os.fspath(path)
        named = text not in ("", ":memory:") and b"\0" not in os.fsencode(text)
        if named and isinstance(text, str):
            return Path(text)
    except (TypeError, UnicodeEncodeError):
        pass
    raise ScenarioError("store", path, "must be the path of a file")


def open_to_write(path: Path) -> tuple[sqlite3.Connection, Lock]:
    """Open or create a store for one writer; close the lock last.

    Raises
    ------
    StoreError
        If it is not a store, is damaged or cannot be written, or another process writes to it.
    """
    with store_errors(path), contextlib.ExitStack() as stack:
        real = Path(os.path.realpath(path))
        lock = stack.enter_context(contextlib.closing(Lock(real)))
        if not real.is_file():
            raise StoreError(f"{path} must be a file")
        if real.stat().st_nlink > 1:
            raise StoreError(
                f"{path} has a second name, a hard link, and SQLite loses what is written under two"
                " names: make a copy of it"
            )
        connection = stack.enter_context(contextlib.closing(_connect(real, "rw")))
        # One transaction: if the process is killed, the file is either empty or complete.
        connection.execute("BEGIN IMMEDIATE")
        if _is_blank(connection):
            connection.execute(f"PRAGMA application_id = {_APPLICATION}")
            connection.execute(f"PRAGMA user_version = {_VERSION}")
            connection.execute(_TABLE)
        version = _version(connection, path)
        _check(connection, path)
        if version < _VERSION:
            _convert(connection, path)
        # Written even if unchanged: a read-only file fails before the first run.
        connection.execute(f"PRAGMA user_version = {_VERSION}")
        connection.execute("COMMIT")
        connection.execute("PRAGMA journal_mode = WAL")
        # Commits survive the end of this process, but not a power failure.
        connection.execute("PRAGMA synchronous = NORMAL")
        # While SQLite has the log open, it does not touch the lock.
        connection.execute("PRAGMA schema_version").fetchone()
        lock.keep()
        stack.pop_all()
    return connection, lock


def open_to_read(path: Path, *, checked: bool = True) -> sqlite3.Connection:
    """Open the current state of a store, even while it is written, or in a read-only folder.

    Raises
    ------
    StoreError
        If the file is missing or not a store, or, if `checked`, damaged.
    """
    with store_errors(path):
        real = Path(os.path.realpath(path))
        if not real.is_file():
            raise StoreError(f"{path} does not exist: a sweep with store= makes a store")
        try:
            return _snapshot(_connect(real, "rw"), path, checked)
        except sqlite3.OperationalError as error:
            # SQLite reads a file with a log only in a writable folder. Without a log the file is
            # complete, and in a read-only folder it does not change while it is read.
            log = Path(f"{real}-wal")
            if _kind(error) not in {"CANTOPEN", "READONLY"}:
                raise
            if log.exists() and log.stat().st_size > 0:
                raise StoreError(
                    f"{path} was not closed, and its last runs are in {log.name}, which cannot be"
                    " read in a folder that cannot be written: copy both into another"
                ) from error
        return _snapshot(_connect(real, "ro&immutable=1"), path, checked)


def find_damage(connection: sqlite3.Connection) -> list[str]:
    """List damage that SQLite finds in the file's structure: pages, index, empty values."""
    try:
        texts = [text for (text,) in connection.execute("PRAGMA integrity_check")]
    except sqlite3.DatabaseError as error:
        return [str(error)]
    return [] if texts == ["ok"] else texts


def read_row(path: Path, number: int, values: Sequence[Any]) -> Kept | None:
    """Return the content of a row; None if it is of another build and unreadable here.

    Raises
    ------
    StoreError
        If it is damaged.
    """
    try:
        return read_checked(values)
    except OtherBuild:
        return None
    except ValueError as fault:
        raise StoreError(
            f"{path}: row {number} (run {str(values[0])[:12]}) is damaged: {fault}; check_store"
            " lists all damage"
        ) from None


@contextlib.contextmanager
def store_errors(path: Path) -> Iterator[None]:
    """Convert an error of SQLite or the system into one that says how to fix it."""
    try:
        yield
    except StoreError:
        raise
    except BlockingIOError:
        raise StoreError(f"{path} {_TAKEN}") from None
    except OSError as error:
        raise StoreError(f"{path} cannot be opened: {error.strerror}") from error
    except UnicodeDecodeError as error:  # from SQLite's message, which cites a name from the file
        raise StoreError(f"{path} is damaged ({error})") from error
    except sqlite3.Error as error:
        match _kind(error):
            case "BUSY" | "LOCKED":
                why = _TAKEN
            case "FULL" | "IOERR":
                why = (
                    f"cannot grow ({error}): the disk is full or fails; the runs in it are kept."
                    " Free some space and call again: it goes on from there"
                )
            case "CANTOPEN":
                why = f"cannot be made or opened: {error}"
            case "READONLY" | "PERM":
                why = f"cannot be written: {error}"
            case "NOTADB" | "CORRUPT":
                why = f"is not an SQLite file, or is damaged ({error})"
            case _:
                why = f"cannot be read: {error}"
        raise StoreError(f"{path} {why}") from error


def _kind(error: sqlite3.Error) -> str:
    """Return the kind of an error without its details: IOERR of SQLITE_IOERR_WRITE."""
    name = str(getattr(error, "sqlite_errorname", None))  # not every error has one
    return name.removeprefix("SQLITE_").partition("_")[0]


def _connect(real: Path, mode: str) -> sqlite3.Connection:
    if real.stat().st_size == 1:  # SQLite would treat it as empty and overwrite it
        raise StoreError(f"{real} is not an SQLite file, or is damaged (it has a single byte)")
    uri = f"{real.as_uri()}?mode={mode}"
    connection = sqlite3.connect(uri, uri=True, timeout=_PATIENCE, isolation_level=None)
    # Let the checksum find damaged text.
    connection.text_factory = lambda text: text.decode(errors="backslashreplace")
    return connection


def _snapshot(connection: sqlite3.Connection, path: Path, checked: bool) -> sqlite3.Connection:
    """Start reading the current content of the file."""
    with contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.closing(connection))
        connection.execute("BEGIN")
        if _is_blank(connection):
            raise StoreError(f"{path} is empty: no store was made there yet")
        if _version(connection, path) < _VERSION:
            raise StoreError(
                f"{path} was written by an earlier crawler2d, in version 1 of the format:"
                " join_stores(path) converts it"
            )
        if checked:
            _check(connection, path)
        stack.pop_all()
    return connection


def _is_blank(connection: sqlite3.Connection) -> bool:
    """Whether the file is empty; one that lost only its first page has others."""
    (pages,) = connection.execute("PRAGMA page_count").fetchone()
    (tables,) = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    return pages <= 1 and tables == 0 and application in (0, _APPLICATION)


def _version(connection: sqlite3.Connection, path: Path) -> int:
    """Check that the file is a store; return the version of its format."""
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    if application != _APPLICATION:
        raise StoreError(f"{path} is an SQLite file, but no store of crawler2d")
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    if version > _VERSION:
        raise StoreError(
            f"{path} was written by a newer crawler2d (version {version} of the format;"
            f" this one reads {_VERSION}): upgrade"
        )
    tables = [sql for (sql,) in connection.execute("SELECT sql FROM sqlite_master")]
    if version < 1 or (version == _VERSION and _TABLE not in tables):
        raise StoreError(f"{path} is damaged: no crawler2d makes such tables (format {version})")
    return version


def _check(connection: sqlite3.Connection, path: Path) -> None:
    damage = find_damage(connection)
    if damage:
        raise StoreError(f"{path} is damaged ({damage[0]}): check_store lists what is")


def _convert(connection: sqlite3.Connection, path: Path) -> None:
    """Add checksums to the rows of version 1."""
    connection.execute("ALTER TABLE run RENAME TO former")
    connection.execute(_TABLE)
    former = connection.execute(
        f"SELECT rowid, {COLUMNS.removesuffix(', checksum')} FROM former ORDER BY rowid"
    )
    for number, *values in former:
        row = with_checksum(values)
        read_row(path, number, row)
        connection.execute(INSERT, row)
    connection.execute("DROP TABLE former")
