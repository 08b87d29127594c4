"""A system call that fails while a file is written leaves either the old file or the new one."""

import errno
import platform
import shutil
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.results.record import Row
from crawler2d.sweeps.store import Store, join_stores, stored_rows
from tests.faults.calls import Ending, ends_with
from tests.sweeps.stores import TRIALS, read, sound

pytestmark = [
    pytest.mark.skipif(
        sys.platform != "linux" or platform.machine() != "x86_64",
        reason="registers of x86-64 are changed by ptrace",
    ),
    pytest.mark.filterwarnings("ignore:.*use of fork:DeprecationWarning"),
]

FAULTS = {"no space": errno.ENOSPC, "input or output": errno.EIO, "half of a write": 0}
REFUSALS = (OSError, c2d.StoreError)
"""What a user is told to expect; StoreError is one by itself."""

Work = Callable[[], object]

every_one = pytest.mark.parametrize("every", [7, pytest.param(1, marks=pytest.mark.soak)])
each_fault = pytest.mark.parametrize(
    "fault",
    # An error of the device takes the path of a full one.
    [pytest.param(f, marks=pytest.mark.soak if f == "input or output" else ()) for f in FAULTS],
)


def ways(work: Work, fault: str, every: int, check: Callable[[Ending], None]) -> list[str]:
    """Do some work with a fault at every n-th call, and check the files that it leaves.

    The first and the last ones all fail: a text is written in half a dozen, and what is complete
    takes its place at the end. Returns the calls that failed.
    """
    calls: list[str] = []

    def fails(at: int) -> bool:
        found = ends_with(work, at, FAULTS[fault], REFUSALS)
        assert found.ending in (Ending.DONE, Ending.REFUSED), (at, found)
        # Half of a write is no failure: the rest is written by another.
        assert found.ending is Ending.DONE or FAULTS[fault], (at, found)
        check(found.ending)
        if found.call:
            calls.append(found.call)
        return bool(found.call)

    for at in (*range(1, every), *range(every, 10_000, every)):
        if not fails(at):
            for last in range(at - every + 1, at) if at > every else ():
                fails(last)
            return calls
    raise AssertionError("it does not end")


ROBOT = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
RUN = c2d.simulate(c2d.Scenario(ROBOT, c2d.terrains.step(0.03), duration=1.0))

WRITERS: dict[str, Callable[[Path], object]] = {
    "run.npz": RUN.save,
    "page.html": RUN.to_html,
    "robot.sdf": ROBOT.to_sdf,
    "robot.urdf": ROBOT.to_urdf,
    "robot.xml": ROBOT.to_mjcf,
    "world.sdf": partial(ROBOT.to_world, terrain=c2d.terrains.step(0.05)),
    "film.gif": partial(RUN.animate, fps=5.0),
}


@each_fault
@every_one
@pytest.mark.parametrize(
    "name",
    # A film is drawn again for each of its calls.
    [pytest.param(n, marks=pytest.mark.soak if n == "film.gif" else ()) for n in WRITERS],
)
def test_a_file_is_the_old_one_or_the_new_one(
    name: str, every: int, fault: str, tmp_path: Path
) -> None:
    place, old = tmp_path / name, b"what was there"
    write = partial(WRITERS[name], place)
    write()
    new = place.read_bytes()

    def check(ending: Ending) -> None:
        found = place.read_bytes()
        assert found in (old, new)
        assert found == new or ending is Ending.REFUSED
        # No other file remains, unless its removal failed.
        assert len(list(tmp_path.iterdir())) <= 1 + (ending is Ending.REFUSED)
        for other in tmp_path.iterdir():
            other.unlink()
        place.write_bytes(old)

    check(Ending.DONE)
    calls = ways(write, fault, every, check)
    assert {"openat", "write", "rename"} <= set(calls)


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return sound(tmp_path_factory.mktemp("store") / "a.sqlite", 2)


@each_fault
@every_one
def test_a_store_keeps_what_it_had_and_goes_on(
    stored: Path, every: int, fault: str, tmp_path: Path
) -> None:
    rows: list[Row] = [row for row, _, _ in stored_rows(stored)]
    half = len(rows) // 2
    begun, place = tmp_path / "begun.sqlite", tmp_path / "b.sqlite"
    with Store(begun, TRIALS) as store:
        store.add(rows[:half])
    had = read(begun)

    def add() -> None:
        with Store(place, TRIALS) as store:
            for row in rows[half:]:
                store.add([row])

    def check(ending: Ending) -> None:
        assert c2d.check_store(place) == ()
        found = read(place)
        assert had.items() <= found.items()
        assert found.items() <= read(stored).items()
        assert ending is Ending.REFUSED or found == read(stored)
        with Store(place, TRIALS) as store:
            store.add(rows)
        assert read(place) == read(stored)
        renew()

    def renew() -> None:
        for path in tmp_path.glob("b.sqlite*"):
            path.unlink()
        shutil.copy(begun, place)

    renew()
    calls = ways(add, fault, every, check)
    assert every > 1 or {"openat", "pwrite64", "fdatasync"} <= set(calls)


@each_fault
@every_one
def test_a_new_store_is_none_or_empty_or_whole(
    stored: Path, every: int, fault: str, tmp_path: Path
) -> None:
    place = tmp_path / "new.sqlite"

    def check(ending: Ending) -> None:
        if ending is Ending.DONE:
            assert read(place) == read(stored)
        assert join_stores(place, stored) >= 0
        assert c2d.check_store(place) == ()
        assert read(place) == read(stored)
        for path in tmp_path.iterdir():
            path.unlink()

    calls = ways(partial(join_stores, place, stored), fault, every, check)
    assert len(calls) > 10 // every


def test_a_saved_run_that_was_written_through_faults_is_the_run(tmp_path: Path) -> None:
    place = tmp_path / "run.npz"
    found = ends_with(partial(RUN.save, place), 4, 0, REFUSALS)
    assert found.ending is Ending.DONE
    loaded = c2d.load(place)
    assert np.array_equal(loaded.position, RUN.position)
