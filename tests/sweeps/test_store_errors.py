"""Errors of unusable stores, word for word: file, reason and remedy."""

import hashlib
import os
import sqlite3
from collections.abc import Callable
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.sweeps import database
from crawler2d.sweeps.store import Store, stored_rows
from tests.sweeps.small import BRIEF, quiet
from tests.sweeps.stores import as_version_1, change, opened

TAKEN = (
    "{path} is being written by another process or session: wait for it, or give this one a file of"
    " its own and join both with join_stores"
)


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("store") / "a.sqlite"
    quiet(BRIEF, {}, repeats=2, store=path)
    return path


@pytest.fixture
def path(sound: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    path = tmp_path / "a.sqlite"
    path.write_bytes(sound.read_bytes())
    return path


def said(use: Callable[[Path], object], path: Path) -> str:
    """The error of an operation, with {path} for the file."""
    with pytest.raises(c2d.StoreError) as caught:
        use(path)
    return str(caught.value).replace(str(path), "{path}")


def executed(statement: str) -> Callable[[Path], None]:
    """Return a function that executes a statement in a store."""

    def execute(path: Path) -> None:
        with opened(path) as connection:
            connection.execute(statement)

    return execute


def replaced(content: bytes) -> Callable[[Path], None]:
    """Return a function that replaces the file by something else."""

    def replace(path: Path) -> None:
        path.write_bytes(content)

    return replace


CANNOT_BE_READ: dict[str, tuple[Callable[[Path], None], str]] = {
    "missing": (Path.unlink, "does not exist: a sweep with store= makes a store"),
    "empty": (replaced(b""), "is empty: no store was made there yet"),
    "a byte": (replaced(b"\0"), "is not an SQLite file, or is damaged (it has a single byte)"),
    "a text": (
        replaced(b"no database at all, but long enough to be read as one" * 20),
        "is not an SQLite file, or is damaged (file is not a database)",
    ),
    "another program's": (
        executed("PRAGMA application_id = 7"),
        "is an SQLite file, but no store of crawler2d",
    ),
    "newer": (
        executed("PRAGMA user_version = 3"),
        "was written by a newer crawler2d (version 3 of the format; this one reads 2): upgrade",
    ),
    "former": (
        as_version_1,
        "was written by an earlier crawler2d, in version 1 of the format: join_stores(path)"
        " converts it",
    ),
    "no version": (
        executed("PRAGMA user_version = 0"),
        "is damaged: no crawler2d makes such tables (format 0)",
    ),
    "other tables": (
        executed("ALTER TABLE run ADD COLUMN more TEXT"),
        "is damaged: no crawler2d makes such tables (format 2)",
    ),
}


@pytest.mark.parametrize("name", CANNOT_BE_READ)
def test_a_file_that_cannot_be_read_says_why(path: Path, name: str) -> None:
    spoil, why = CANNOT_BE_READ[name]
    spoil(path)
    for use in (c2d.table, c2d.check_store):
        assert said(use, path) == f"{{path}} {why}"


def test_a_place_that_cannot_be_written_says_why(path: Path, tmp_path: Path) -> None:
    assert said(Store, tmp_path) == "{path} cannot be opened: Is a directory"
    assert said(Store, Path(os.devnull)) == "{path} must be a file"
    assert said(Store, path / "b.sqlite") == "{path} cannot be opened: Not a directory"
    (tmp_path / "b.sqlite").hardlink_to(path)
    assert said(Store, path) == (
        "{path} has a second name, a hard link, and SQLite loses what is written under two names:"
        " make a copy of it"
    )


def test_a_store_that_is_in_use_says_what_helps(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with Store(path):
        assert said(Store, path) == TAKEN
    monkeypatch.setattr(database, "_PATIENCE", 0.1)
    with opened(path) as connection:
        connection.execute("PRAGMA locking_mode = EXCLUSIVE")
        connection.execute("BEGIN EXCLUSIVE")
        assert said(c2d.table, path) == TAKEN


def test_a_damaged_row_is_named_by_number_and_run(path: Path) -> None:
    identities = [row.identity for row, _, _ in stored_rows(path)]
    for column, value, why in (
        ("outcome", "flown", "'flown' is not an outcome without an error"),
        ("outcome", "diverged", "'diverged' is not an outcome without an error"),
        ("outcome", "y" * 50, f"'{'y' * 40}' is not an outcome without an error"),
        ("error", '["SimulationDiverged", "?"]', "'timed_out' is not an outcome with an error"),
        ("metrics", '{"time": "long"}', "'long' is not a number"),
    ):
        change(path, 2, **{column: value})
        fault = f"it cannot be read ({'TypeError' if column == 'metrics' else 'ValueError'}: {why})"
        assert [(each.row, each.message) for each in c2d.check_store(path)] == [(2, fault)]
        assert said(c2d.table, path) == (
            f"{{path}}: row 2 (run {identities[1][:12]}) is damaged: {fault}; check_store lists all"
            " damage"
        )
        for name, sound in (("outcome", "timed_out"), ("error", None), ("metrics", "{}")):
            change(path, 2, **{name: sound})
    change(path, 2, scenario="{}")
    (damage,) = c2d.check_store(path)
    assert damage.message == "its scenario does not hash to its identity"
    executed("UPDATE run SET wall_time = 7.5 WHERE rowid = 2")(path)
    assert [each.message for each in c2d.check_store(path)] == ["its checksum is another"]


def test_damage_of_the_file_is_said_in_sqlites_words(path: Path) -> None:
    with opened(path) as connection:
        connection.execute("CREATE INDEX mine ON run (build)")
        connection.execute("PRAGMA writable_schema = ON")
        connection.execute("UPDATE sqlite_master SET rootpage = 2 WHERE name = 'mine'")
    found = [each.message for each in c2d.check_store(path) if each.row is None]
    assert found
    assert said(c2d.table, path) == f"{{path}} is damaged ({found[0]}): check_store lists what is"
    assert said(Store, path) == f"{{path}} is damaged ({found[0]}): check_store lists what is"


def test_a_row_that_cannot_be_reached_ends_the_list_of_damage(path: Path) -> None:
    """The first page of the table is lost."""
    content = path.read_bytes()
    with opened(path) as connection:
        (page,) = connection.execute(
            "SELECT rootpage FROM sqlite_master WHERE name='run'"
        ).fetchone()
    size = int.from_bytes(content[16:18], "big")
    begin = size * (page - 1)
    path.write_bytes(content[:begin] + bytes(size) + content[begin + size :])
    found = c2d.check_store(path)
    assert {each.row for each in found} == {None}
    assert found[-1].message == "nothing can be read after row 0: database disk image is malformed"


def test_a_run_of_another_build_is_named_with_it(path: Path) -> None:
    identity = next(row.identity for row, _, _ in stored_rows(path))
    change(path, 1, build="0", diagnosis="{}")
    assert said(c2d.table, path) == (
        f"{{path}}: the run {identity[:12]} is from the build 0, with outcomes or diagnoses that"
        " this one cannot read: read it with that build"
    )


def test_two_results_of_one_run_are_named_with_both_files(path: Path, sound: Path) -> None:
    identity = next(row.identity for row, _, _ in stored_rows(path))
    change(path, 1, metrics="{}")
    assert said(lambda into: c2d.join_stores(into, sound), path) == (
        f"{{path}} and {sound} hold different results of the run {identity[:12]}: the same build"
        " gives the same bits, so one of the files was changed"
    )


def test_a_store_that_was_removed_says_what_is_lost(path: Path) -> None:
    with Store(path) as store:
        path.rename(path.with_name("b.sqlite"))
        assert said(lambda _: store.add([]), path) == (
            "{path} was removed, moved or replaced while it was written: its runs are not kept."
            " `runs` of this error has those of the last batch"
        )


def test_a_full_disk_says_that_nothing_is_lost(path: Path, tmp_path: Path) -> None:
    other = tmp_path / "b.sqlite"
    quiet(BRIEF, {"gravity": [9.0]}, repeats=200, store=other)
    rows = [row for row, _, _ in stored_rows(other)]
    with Store(path) as store:
        store._connection.execute("PRAGMA max_page_count = 12")
        assert said(lambda _: store.add(rows), path) == (
            "{path} cannot grow (database or disk is full): the disk is full or fails; the runs in"
            " it are kept. Free some space and call again: it goes on from there"
        )
    assert len(list(stored_rows(path))) == 2


OF_SQLITE = {
    "SQLITE_BUSY": TAKEN,
    "SQLITE_BUSY_SNAPSHOT": TAKEN,
    "SQLITE_LOCKED": TAKEN,
    **dict.fromkeys(
        ("SQLITE_FULL", "SQLITE_IOERR", "SQLITE_IOERR_WRITE"),
        "{path} cannot grow (why): the disk is full or fails; the runs in it are kept. Free some"
        " space and call again: it goes on from there",
    ),
    "SQLITE_CANTOPEN": "{path} cannot be made or opened: why",
    "SQLITE_READONLY": "{path} cannot be written: why",
    "SQLITE_READONLY_DBMOVED": "{path} cannot be written: why",
    "SQLITE_PERM": "{path} cannot be written: why",
    "SQLITE_NOTADB": "{path} is not an SQLite file, or is damaged (why)",
    "SQLITE_CORRUPT_INDEX": "{path} is not an SQLite file, or is damaged (why)",
    "SQLITE_ERROR": "{path} cannot be read: why",
    "": "{path} cannot be read: why",
}


@pytest.mark.parametrize("name", OF_SQLITE)
def test_every_error_of_sqlite_is_said_with_what_helps(path: Path, name: str) -> None:
    error = sqlite3.OperationalError("why")
    if name:
        error.sqlite_errorname = name

    def fail(place: Path) -> None:
        with database.store_errors(place):
            raise error

    assert said(fail, path) == OF_SQLITE[name]


def test_a_message_of_sqlite_that_is_no_text_is_damage(path: Path) -> None:
    def fail(place: Path) -> None:
        with database.store_errors(place):
            b"\xff".decode()

    assert said(fail, path) == (
        "{path} is damaged ('utf-8' codec can't decode byte 0xff in position 0: invalid start byte)"
    )


def test_a_store_is_marked_as_one_and_its_table_is_that_of_its_version(path: Path) -> None:
    """Other versions of crawler2d look for these, and refuse the file without them."""
    assert path.read_bytes()[68:72] == b"c2ds"
    with opened(path) as connection:
        assert connection.execute("PRAGMA user_version").fetchone() == (2,)
        assert connection.execute("PRAGMA journal_mode").fetchone() == ("wal",)
        ((table,),) = connection.execute("SELECT sql FROM sqlite_master WHERE type = 'table'")
    digest = hashlib.sha256(table.encode()).hexdigest()
    assert digest.startswith("2a3ba8f8d0fcc8ae"), "a table of another version: convert the former"
