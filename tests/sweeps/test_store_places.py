"""Places of stores: readable without write access, written by one process, and not removed."""

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.sweeps import database
from crawler2d.sweeps.store import Store
from tests.kept import refusing
from tests.sweeps.small import BASE, SAID, quiet, refusal
from tests.sweeps.stores import opened, read, unprivileged

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="permissions and links of POSIX")


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder that every user can enter."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o777)
        yield folder
        folder.chmod(0o777)


@pytest.mark.parametrize(("of_file", "of_folder"), [(0o444, 0o555), (0o444, 0o777), (0o666, 0o555)])
def test_a_store_that_cannot_be_written_is_read(folder: Path, of_file: int, of_folder: int) -> None:
    path = folder / "a b#?%.sqlite"
    quiet(BASE, {}, repeats=3, store=path)
    path.chmod(of_file)
    folder.chmod(of_folder)
    with unprivileged():
        assert c2d.table(path).sizes == {"run": 3}
        assert c2d.check_store(path) == ()
        with pytest.raises(c2d.StoreError, match=r"cannot be (written|opened): "):
            quiet(BASE, {}, store=path)
    folder.chmod(0o777)
    assert c2d.join_stores(folder / "b.sqlite", path) == 3


def test_a_store_is_read_by_who_may_not_write_while_it_is_written(folder: Path) -> None:
    path = folder / "a.sqlite"
    quiet(BASE, {}, repeats=3, store=path)
    folder.chmod(0o755)
    with Store(path), unprivileged():
        assert c2d.table(path).sizes == {"run": 3}


def test_an_unreadable_log_is_an_error(folder: Path) -> None:
    path, copy = folder / "a.sqlite", folder / "b.sqlite"
    quiet(BASE, {}, repeats=3, store=path)
    with Store(path):
        for end in ("", "-wal"):
            shutil.copy(f"{path}{end}", f"{copy}{end}")
    assert Path(f"{copy}-wal").stat().st_size > 0
    folder.chmod(0o555)
    with unprivileged(), pytest.raises(c2d.StoreError, match=r"runs are in b\.sqlite-wal"):
        c2d.table(copy)
    folder.chmod(0o777)
    Path(f"{copy}-wal").write_bytes(b"")
    folder.chmod(0o555)
    with unprivileged():
        assert c2d.table(copy).sizes == {"run": 3}


def test_an_unreadable_file_is_an_error(folder: Path) -> None:
    path = folder / "a.sqlite"
    quiet(BASE, {}, repeats=1, store=path)
    path.chmod(0)
    with unprivileged(), pytest.raises(c2d.StoreError, match="cannot be made or opened"):
        c2d.table(path)
    folder.chmod(0)
    with unprivileged(), pytest.raises(c2d.StoreError, match=r"cannot be opened|does not exist"):
        c2d.table(path)


OPEN = """
import sys
from crawler2d.sweeps.store import Store
store = Store(sys.argv[1])
"""


def test_no_second_writer_gets_in_by_another_name(tmp_path: Path) -> None:
    path, link, other = (tmp_path / name for name in ("a.sqlite", "b.sqlite", "c.sqlite"))
    link.symlink_to(path)
    with Store(link):
        # Only SQLite's own files are next to it.
        beside = {each.name for each in tmp_path.iterdir()} - {"a.sqlite", "b.sqlite"}
        assert beside == {"a.sqlite-wal", "a.sqlite-shm"}
        assert read(path) == {}  # the end of which unlocks nothing
        for name in (path, link, tmp_path / "." / "a.sqlite"):
            with pytest.raises(c2d.StoreError, match="is being written by another"):
                Store(name)
            command = [sys.executable, "-c", OPEN, str(name)]
            told = subprocess.run(command, check=False, capture_output=True, text=True)
            assert "is being written by another" in told.stderr
    other.hardlink_to(path)
    for name in (path, other):
        with pytest.raises(c2d.StoreError, match="a hard link"):
            Store(name)
    assert read(other) == {}
    other.unlink()
    Store(path).close()


def test_a_store_that_another_process_writes_is_refused_until_it_has_ended(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    command = [sys.executable, "-c", f"{OPEN}print('opened', flush=True); input()", str(path)]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as writer:
        assert writer.stdout is not None
        assert writer.stdout.readline() == "opened\n"
        before = _next_descriptor()
        with pytest.raises(c2d.StoreError, match="is being written by another"):
            Store(path)
        assert _next_descriptor() == before  # refused files are closed
        writer.communicate("")
    Store(path).close()


def _next_descriptor() -> int:
    """The number of the next file that is opened: the lowest one that is free."""
    descriptor = os.open(os.devnull, os.O_RDONLY)
    os.close(descriptor)
    return descriptor


def test_closing_the_file_elsewhere_lets_no_second_writer_in_for_long(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    command = [sys.executable, "-c", f"{OPEN}print('opened', flush=True); input()", str(path)]
    with Store(path) as store:
        path.read_bytes()  # which releases every lock of this process
        store.add([])
        told = subprocess.run(command, check=False, capture_output=True, text=True)
        assert "is being written by another" in told.stderr
        path.read_bytes()
        with subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        ) as second:
            assert second.stdout is not None
            assert second.stdout.readline() == "opened\n"
            with pytest.raises(c2d.StoreError, match="is being written by another"):
                store.add([])
            second.communicate("")
        store.add([])


def test_a_store_locked_by_another_program_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.sqlite"
    Store(path).close()
    monkeypatch.setattr(database, "_PATIENCE", 0.1)
    with opened(path) as connection:
        connection.execute("PRAGMA locking_mode = EXCLUSIVE")
        connection.execute("BEGIN EXCLUSIVE")
        for use in (c2d.table, c2d.check_store, c2d.join_stores):
            with pytest.raises(c2d.StoreError, match="is being written by another"):
                use(path)
    assert read(path) == {}


WRITE = """
import dataclasses, hashlib, itertools, sys
from crawler2d.sweeps.store import Store, stored_rows
row = next(row for row, *_ in stored_rows(sys.argv[1]))
with Store(sys.argv[1]) as store:
    print("opened", flush=True)
    for number in itertools.count():
        text = row.scenario + " " * (1 + number)
        identity = hashlib.sha256(text.encode()).hexdigest()
        store.add([dataclasses.replace(row, identity=identity, scenario=text)])
        print("added", flush=True)
"""


@pytest.mark.parametrize("tries", [100, pytest.param(5000, marks=pytest.mark.soak)])
def test_a_writer_keeps_the_store_against_all_who_try(tmp_path: Path, tries: int) -> None:
    path = tmp_path / "a.sqlite"
    quiet(BASE, {}, repeats=1, store=path)
    command = [sys.executable, "-c", WRITE, str(path)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as writer:
        assert writer.stdout is not None
        assert writer.stdout.readline() == "opened\n"
        for _ in range(tries):
            assert writer.stdout.readline() == "added\n"
            with pytest.raises(c2d.StoreError, match="is being written by another"):
                Store(path)
        assert writer.poll() is None
        writer.send_signal(signal.SIGKILL)
    Store(path).close()
    assert len(read(path)) > tries


def test_a_folder_deleted_during_a_sweep_is_an_error_that_has_the_runs(
    tmp_path: Path,
) -> None:
    path = tmp_path / "folder" / "a.sqlite"
    path.parent.mkdir()
    plain = quiet(BASE, {}, repeats=300)

    def delete(done: int, _total: int) -> None:
        if done > 0 and path.parent.exists():
            shutil.rmtree(path.parent)

    with pytest.raises(c2d.StoreError, match="its runs are not kept") as caught:
        quiet(BASE, {}, repeats=300, store=path, progress=delete, threads=1)
    assert not path.parent.exists()
    errors = [run.error for run in caught.value.runs]
    assert {type(error) for error in errors} <= {type(None), c2d.RunUnfinished}
    found = c2d.table(caught.value.runs)["final_x"].values
    finished = ~np.isnan(found)
    assert 0 < finished.sum() == errors.count(None)
    assert (found == plain["final_x"].values)[finished].all()


def test_a_file_replaced_during_a_sweep_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    with Store(path) as store:
        path.rename(tmp_path / "b.sqlite")
        with pytest.raises(c2d.StoreError, match="removed, moved or replaced"):
            store.add([])
        path.write_bytes(b"")
        with pytest.raises(c2d.StoreError, match="removed, moved or replaced"):
            store.add([])
    assert read(tmp_path / "b.sqlite") == {}


def test_the_error_of_a_full_disk_has_the_simulated_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(path: Path) -> Any:
        connection, lock = database.open_to_write(path)
        (pages,) = connection.execute("PRAGMA page_count").fetchone()
        connection.execute(f"PRAGMA max_page_count = {pages + 20}")
        return connection, lock

    monkeypatch.setattr("crawler2d.sweeps.store.open_to_write", full)
    with pytest.raises(c2d.StoreError, match="the disk is full") as caught:
        quiet(BASE, {}, repeats=60, store=tmp_path / "a.sqlite")
    kept = read(tmp_path / "a.sqlite")
    finished = [run for run in caught.value.runs if run.error is None]
    assert {run.scenario.identity for run in finished} > set(kept)


@pytest.mark.parametrize("name", ["", ":memory:", "a\0b", b"a.sqlite", 7, "\ud800"])
def test_an_invalid_path_of_a_store_is_refused_by_name(name: Any) -> None:
    assert refusal(BASE, {}, store=name).path == "store"
    for use in (c2d.check_store, c2d.join_stores, lambda name: c2d.join_stores("a", name)):
        with refusing(SAID, "store must be the path of a file"):
            use(name)
    if isinstance(name, str):
        with refusing(SAID, "store must be the path of a file"):
            c2d.table(name)


@pytest.mark.parametrize("name", [".", "/", "/dev/null", "/dev/full", "x" * 300, "none/a.sqlite"])
def test_a_place_where_no_store_can_be_is_refused_before_anything_runs(name: str) -> None:
    calls: list[int] = []
    with pytest.raises(c2d.StoreError, match=r"cannot be opened|must be a file"):
        quiet(BASE, {}, store=name, progress=lambda done, _: calls.append(done))
    assert calls == []
    with pytest.raises(c2d.StoreError, match=r"does not exist|cannot be opened"):
        c2d.table(name)
