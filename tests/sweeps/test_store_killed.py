"""A store stays intact if its process is killed or its disk is full at any moment."""

import itertools
import os
import random
import resource
import sys
from functools import partial
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.results.record import Row
from crawler2d.sweeps.store import Store, stored_rows
from tests.sweeps.kills import is_killed
from tests.sweeps.stores import TRIALS, read, sound, told

pytestmark = [
    pytest.mark.skipif(sys.platform != "linux", reason="system calls are stopped at by ptrace"),
    pytest.mark.filterwarnings("ignore:.*use of fork:DeprecationWarning"),
]


@pytest.fixture(scope="module")
def rows(tmp_path_factory: pytest.TempPathFactory) -> list[Row]:
    store = sound(tmp_path_factory.mktemp("store") / "a.sqlite", 2)
    return [row for row, _, _ in stored_rows(store)]


# The kernel stops it some 280 times.
@pytest.mark.parametrize("every", [11, pytest.param(1, marks=pytest.mark.soak)])
def test_a_store_killed_while_created_is_opened_again(tmp_path: Path, every: int) -> None:
    found = []
    for stop in itertools.count(0, every):
        path = tmp_path / f"{stop}.sqlite"
        killed = is_killed(partial(Store, path), stop)
        try:
            found.append(f"has {len(read(path))} runs")
        except c2d.StoreError as error:
            found.append(str(error).removeprefix(f"{path} ").partition(":")[0])
        Store(path).close()
        assert c2d.check_store(path) == ()
        if not killed:
            break
    assert list(dict.fromkeys(found)) == ["does not exist", "is empty", "has 0 runs"]
    assert len(found) > 100 / every


def fill(path: Path, rows: list[Row], limit: int = resource.RLIM_INFINITY) -> None:
    """Add rows one by one, and count them in another file; files can grow to a limit [bytes]."""
    count = os.open(path.with_suffix(".count"), os.O_CREAT | os.O_WRONLY)
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, resource.RLIM_INFINITY))
    try:
        with Store(path, TRIALS) as store:
            for added, row in enumerate(rows, 1):
                store.add([row])
                os.pwrite(count, b"%4d" % added, 0)
    except c2d.StoreError as error:
        resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
        os.pwrite(count, str(error).encode(), 4)


def filled(path: Path) -> tuple[int, str]:
    """The number of added rows, and the reason why there were no more."""
    try:
        text = path.with_suffix(".count").read_text()
    except FileNotFoundError:
        return 0, ""
    return int(text[:4].strip("\0") or 0), text[4:]


def holds(path: Path, rows: list[Row]) -> int:
    """Return the number of rows of a store, check that they are the first, and continue it."""
    with Store(path, TRIALS) as store:
        found = store.read([row.identity for row in rows])
        first = {row.identity: told(row) for row in rows[: len(found)]}
        assert {identity: told(row) for identity, row in found.items()} == first
        store.add(rows)
    assert list(read(path)) == [row.identity for row in rows]
    return len(found)


@pytest.mark.parametrize("kills", [12, pytest.param(2000, marks=pytest.mark.soak)])
def test_a_killed_process_loses_no_finished_row(
    tmp_path: Path, rows: list[Row], kills: int
) -> None:
    stops = 100
    while is_killed(partial(fill, tmp_path / f"whole{stops}.sqlite", rows), stops):
        stops += 100
    draw, counts = random.Random(1), []
    for number in range(kills):
        path = tmp_path / f"{number}.sqlite"
        is_killed(partial(fill, path, rows), draw.randrange(stops))
        finished, _ = filled(path)
        assert finished <= holds(path, rows) <= finished + 1
        counts.append(finished)
    assert min(counts) < 3 < max(counts)


@pytest.mark.parametrize("every", [8, pytest.param(1, marks=pytest.mark.soak)])
def test_a_disk_that_is_full_at_any_size_keeps_what_was_added(
    tmp_path: Path, rows: list[Row], every: int
) -> None:
    counts = []
    for pages in range(0, 40, every):
        path = tmp_path / f"{pages}.sqlite"
        # A write that does not fit is done in part.
        is_killed(partial(fill, path, rows, 4096 * pages + 100), 10**6)
        added, why = filled(path)
        assert "the disk is full or fails" in why or (added, why) == (len(rows), "")
        assert holds(path, rows) == added
        counts.append(added)
    assert counts == sorted(counts)
    assert counts[0] < 3 < counts[-1]
