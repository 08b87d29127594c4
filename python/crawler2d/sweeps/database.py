"""The SQLite file of a store: one writer, a checksum in every row, atomic changes."""

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
"""In the order of the values of `row_values`."""

Kept = tuple[Row, str, tuple[str, ...]]
"""A row, the build that wrote it, and its trials."""

_OUTCOMES = frozenset({*map(str, Outcome), *NO_RESULT})
# What a run ends with every time, so that it is kept; nothing else is made of a name in a file.
_ERRORS: dict[str, type[Crawler2dError]] = {"SimulationDiverged": SimulationDiverged}
# What reading a text raises that is no such row.
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
    # JSON keeps apart where a value ends and of which type it is; what it does not know, such as
    # the bytes of a damaged column, is in no sound row.
    text = json.dumps(values, default=repr)
    return (*values, hashlib.sha256(text.encode()).hexdigest())


class OtherBuild(ValueError):
    """A row is as it was written, by another build, but this one cannot read it."""


def read_checked(values: Sequence[Any]) -> Kept:
    """Return the run in a row, its build and its trials.

    Raises
    ------
    OtherBuild
        If it has outcomes or diagnoses of another build, which this one does not know.
    ValueError
        If the row is not as it was written; it says why.
    """
    if with_checksum(values[:-1]) != tuple(values):
        raise ValueError("its checksum is another")
    identity, build, trials, outcome, metrics, diagnosis, wall_time, error, scenario, _ = values
    # What is stored is the canonical text, so this holds for every build.
    if hashlib.sha256(str(scenario).encode()).hexdigest() != identity:
        raise ValueError("its scenario does not hash to its identity")
    try:
        if outcome not in _OUTCOMES or (error is None) == (outcome in NO_RESULT):
            with_error = "without" if error is None else "with"
            raise ValueError(f"{str(outcome)[:40]!r} is no outcome {with_error} an error")
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
        raise TypeError(f"{value!r} is no number")
    return value


def _read_error(name: str, *arguments: Any) -> Crawler2dError:
    return _ERRORS[name](*arguments)


if sys.platform == "win32":
    import msvcrt
else:
    import fcntl


# Beyond the end of every file, and of what SQLite locks of it.
_BYTE = 2**62

# What this process has locked: the system's locks keep out other processes alone.
_locked: set[tuple[int, int]] = set()
_guard = threading.Lock()


def _forget_locks() -> None:
    """Begin anew in a fork: it has no lock of its parent, nor a thread that is taking one."""
    global _guard  # noqa: PLW0603 - of this module alone
    _guard = threading.Lock()
    _locked.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_locks)


class Lock:
    """Keeps every other writer out of a file, by whatever name it finds the file.

    It ends with this process, however that ends. There is no lock file that could be removed.
    Readers, and SQLite itself, are not affected.

    Parameters
    ----------
    file : Path
        It is made, empty, if it does not exist.

    Raises
    ------
    BlockingIOError
        If there is another writer.
    OSError
        If the file cannot be made or written.
    """

    def __init__(self, file: Path) -> None:
        self._file = file
        with _guard:
            # Not even opened: to close it again would undo what SQLite has locked in this process.
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
        """Lock the byte again; nothing happens if it is.

        Where a lock belongs to the process, whatever unlocks or closes the file undoes it: SQLite
        whenever it reads or writes without a log, another part of the program that copies it.

        Raises
        ------
        BlockingIOError
            If there is another writer by now.
        """
        if sys.platform != "win32":
            try:
                fcntl.lockf(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _BYTE)
            except PermissionError as error:  # so some systems call it
                raise BlockingIOError from error

    def is_there(self) -> bool:
        """Whether the file is still where it was."""
        try:
            return _key(self._file.stat()) == self._key
        except OSError:
            return False

    def close(self) -> None:
        """Let others write."""
        with _guard:
            if self._descriptor >= 0:
                _locked.discard(self._key)  # a fork has forgotten it
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
"""Adds the values of a row unless its key is there."""

# [s] How long another program that reads or writes the file is waited for.
_PATIENCE = 10.0
_TAKEN = (
    "is being written by another process or session: wait for it, or give this one a file of its"
    " own and join both with join_stores"
)

Place = str | os.PathLike[str]


def read_store_path(path: Place) -> Path:
    """Check that something can be the path of a file."""
    try:
        text = os.fspath(path)
        named = text not in ("", ":memory:") and b"\0" not in os.fsencode(text)
        if named and isinstance(text, str):
            return Path(text)
    except (TypeError, UnicodeEncodeError):
        pass
    raise ScenarioError("store", path, "must be the path of a file")


def open_to_write(path: Path) -> tuple[sqlite3.Connection, Lock]:
    """Open a store, or make it, for one writer; the lock is to be closed last.

    Raises
    ------
    StoreError
        If it is no store, is damaged, cannot be written, or another process writes into it.
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
        # One transaction: whenever the process is killed, the file is empty or whole.
        connection.execute("BEGIN IMMEDIATE")
        if _is_blank(connection):
            connection.execute(f"PRAGMA application_id = {_APPLICATION}")
            connection.execute(f"PRAGMA user_version = {_VERSION}")
            connection.execute(_TABLE)
        version = _version(connection, path)
        _check(connection, path)
        if version < _VERSION:
            _convert(connection, path)
        # Written even if it is unchanged: a file that cannot be written fails before the first run.
        connection.execute(f"PRAGMA user_version = {_VERSION}")
        connection.execute("COMMIT")
        connection.execute("PRAGMA journal_mode = WAL")
        # What is committed outlives this process, though not a loss of power.
        connection.execute("PRAGMA synchronous = NORMAL")
        # While SQLite has the log open it leaves the lock alone.
        connection.execute("PRAGMA schema_version").fetchone()
        lock.keep()
        stack.pop_all()
    return connection, lock


def open_to_read(path: Path, *, checked: bool = True) -> sqlite3.Connection:
    """Open a store as it is now, even while it is written, or in a read-only folder.

    Raises
    ------
    StoreError
        If there is no such file, it is no store, or, if that is `checked`, damaged.
    """
    with store_errors(path):
        real = Path(os.path.realpath(path))
        if not real.is_file():
            raise StoreError(f"{path} does not exist: a sweep with store= makes a store")
        try:
            return _snapshot(_connect(real, "rw"), path, checked)
        except sqlite3.OperationalError as error:
            # SQLite reads a file with a log only in a folder that can be written. Without a log the
            # file is whole, and where nobody can write it does not change while it is read.
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
    """List damage that SQLite finds in the structure of the file: pages, index, empty values."""
    try:
        texts = [text for (text,) in connection.execute("PRAGMA integrity_check")]
    except sqlite3.DatabaseError as error:
        return [str(error)]
    return [] if texts == ["ok"] else texts


def read_row(path: Path, number: int, values: Sequence[Any]) -> Kept | None:
    """Return what a row holds; None if another build wrote it and this one cannot read it.

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
    """Turn an error of SQLite, or of the system, into one that says what helps."""
    try:
        yield
    except StoreError:
        raise
    except BlockingIOError:
        raise StoreError(f"{path} {_TAKEN}") from None
    except OSError as error:
        raise StoreError(f"{path} cannot be opened: {error.strerror}") from error
    except UnicodeDecodeError as error:  # of SQLite's message, which cites a name from the file
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
                why = f"is no SQLite file, or is damaged ({error})"
            case _:
                why = f"cannot be read: {error}"
        raise StoreError(f"{path} {why}") from error


def _kind(error: sqlite3.Error) -> str:
    """Return the kind of an error without its details: IOERR of SQLITE_IOERR_WRITE."""
    return f"{getattr(error, 'sqlite_errorname', '')}__".split("_")[1]


def _connect(real: Path, mode: str) -> sqlite3.Connection:
    if real.stat().st_size == 1:  # which SQLite takes for an empty file, and overwrites
        raise StoreError(f"{real} is no SQLite file, or is damaged (it has a single byte)")
    uri = f"{real.as_uri()}?mode={mode}"
    connection = sqlite3.connect(uri, uri=True, timeout=_PATIENCE, isolation_level=None)
    # Damaged text is for the checksum to find.
    connection.text_factory = lambda text: text.decode(errors="backslashreplace")
    return connection


def _snapshot(connection: sqlite3.Connection, path: Path, checked: bool) -> sqlite3.Connection:
    """Begin to read what is in the file now."""
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
    """Whether nothing is in the file; one that lost its first page alone has others."""
    (pages,) = connection.execute("PRAGMA page_count").fetchone()
    (tables,) = connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    return pages <= 1 and tables == 0 and application in (0, _APPLICATION)


def _version(connection: sqlite3.Connection, path: Path) -> int:
    """Check that the file is a store; returns the version of its format."""
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
    """Give the rows of version 1 their checksums."""
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
