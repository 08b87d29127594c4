"""A store keeps every run: nothing is simulated twice, nothing is lost."""

import random
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.results.record import diagnosis_json, read_diagnosis
from crawler2d.sweeps.store import Store, stored_rows
from tests.kept import refusing
from tests.shared import NO_DASK
from tests.sweeps.small import BASE, MODELS, SAID, quiet
from tests.sweeps.stores import as_version_1, change, opened

OVER = {"robot.track": MODELS, "terrain.height": [0.03, 0.12]}


def counted(*args: Any, **options: Any) -> tuple[xr.Dataset, int]:
    """Return a sweep, and the number of runs that it simulated."""
    calls: list[tuple[int, int]] = []
    found = quiet(*args, progress=lambda done, total: calls.append((done, total)), **options)
    return found, calls[-1][1] - calls[0][0]


def test_a_sweep_from_a_store_is_the_one_that_was_simulated(tmp_path: Path) -> None:
    store = tmp_path / "study.sqlite"
    plain = quiet(BASE, OVER, repeats=3, wall_time=False)
    first, made = counted(BASE, OVER, repeats=3, store=store)
    again, then = counted(BASE, OVER, repeats=3, store=store)
    assert (made, then) == (12, 0)
    xr.testing.assert_identical(plain, first)
    xr.testing.assert_identical(first, again)
    assert set(first["outcome"].values.flat) > {"cleared"}  # stops, with their figures


def test_more_repeats_cells_and_models_simulate_only_what_is_new(tmp_path: Path) -> None:
    store = str(tmp_path / "study.sqlite")
    quiet(BASE, {"terrain.height": [0.03]}, repeats=2, store=store)
    _, more = counted(BASE, {"terrain.height": [0.03]}, repeats=5, store=store)
    _, cells = counted(BASE, {"terrain.height": [0.02, 0.03]}, repeats=5, store=store)
    assert (more, cells) == (3, 5)
    _, tried = counted(BASE, {"terrain.height": [0.03]}, repeats=2, store=store, trials="auto")
    assert tried == 2  # another question
    assert len(list(stored_rows(store))) == 12
    quiet(BASE, {"terrain.height": [0.01]}, repeats=2, store=store, trials="auto")
    _, plain = counted(BASE, {"terrain.height": [0.01]}, repeats=2, store=store)
    assert plain == 2


def test_equal_scenarios_run_once(tmp_path: Path) -> None:
    store = tmp_path / "a.sqlite"
    found = quiet(BASE, {}, repeats=4, vary={}, store=store)
    assert len(set(found["identity"].values)) == 1
    assert len(list(stored_rows(store))) == 1


def test_the_table_of_a_store_has_every_run(tmp_path: Path) -> None:
    store = tmp_path / "a.sqlite"
    found = quiet(BASE, OVER, repeats=2, store=store, trials=("torque x 2",))
    table = c2d.table(store)
    assert table.sizes == {"run": 8}
    assert set(table["identity"].values) == set(found["identity"].values.flat)
    assert set(table["trials"].values) == {"torque x 2"}
    assert set(table["build"].values) == {c2d.build_info()["build_id"]}
    assert (table["wall_time"] > 0.0).all()
    by_identity = dict(zip(table["identity"].values, table["tried_torque_x2"].values, strict=True))
    flat = zip(found["identity"].values.flat, found["tried_torque_x2"].values.flat, strict=True)
    assert all(by_identity[identity] == tried for identity, tried in flat)


def test_a_second_writer_gets_an_error_and_a_reader_does_not(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    quiet(BASE, {}, repeats=1, store=path)
    with Store(path):
        with pytest.raises(c2d.StoreError, match="is being written by another"):
            quiet(BASE, {}, repeats=1, store=path)
        assert c2d.table(path).sizes == {"run": 1}
    quiet(BASE, {}, repeats=1, store=path)


def test_a_full_disk_is_an_error_and_the_store_stays_readable(tmp_path: Path) -> None:
    path = tmp_path / "a.sqlite"
    with Store(path) as store:
        pages = store._connection.execute("PRAGMA page_count").fetchone()[0]
        store._connection.execute(f"PRAGMA max_page_count = {pages + 40}")
        rows = [row for row, *_ in _rows_of(tmp_path / "other.sqlite")]
        kept = []

        def fill() -> None:
            for row in rows:
                store.add([row])
                kept.append(row)

        with pytest.raises(c2d.StoreError, match="the disk is full"):
            fill()
        assert 0 < len(kept) < len(rows)
    assert c2d.table(path).sizes == {"run": len(kept)}
    _, missing = counted(BASE, {"terrain.height": [0.03]}, repeats=60, store=path)
    assert missing == 60 - len(kept)


def _rows_of(path: Path) -> Any:
    quiet(BASE, {"terrain.height": [0.03]}, repeats=60, store=path)
    return stored_rows(path)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"no database at all, but long enough to be read as one" * 20, "is not an SQLite file"),
        ("CREATE TABLE mine (x)", "no store"),
        ("CREATE VIEW mine AS SELECT 1", "no store"),
        ("PRAGMA application_id = 7", "no store"),
    ],
)
def test_a_file_that_is_no_store_is_refused_and_unchanged(
    tmp_path: Path, content: bytes | str, message: str
) -> None:
    path = tmp_path / "a.sqlite"
    if isinstance(content, str):
        with opened(path) as connection:
            connection.execute(content)
    else:
        path.write_bytes(content)
    before = path.read_bytes()
    with pytest.raises(c2d.StoreError, match=message):
        quiet(BASE, {}, repeats=1, store=path)
    with pytest.raises(c2d.StoreError, match=message):
        c2d.table(path)
    assert path.read_bytes() == before


def test_a_place_where_no_file_can_be_is_refused(tmp_path: Path) -> None:
    with pytest.raises(c2d.StoreError, match="cannot be opened: No such"):
        quiet(BASE, {}, repeats=1, store=tmp_path / "nowhere" / "a.sqlite")
    with refusing(SAID, "must be the path of a file"):
        quiet(BASE, {}, repeats=1, store=7)
    with pytest.raises(c2d.StoreError, match="does not exist"):
        c2d.table(tmp_path / "none.sqlite")


@pytest.mark.parametrize("build", ["0", "f" * 16, "zzzz"])
def test_runs_of_another_build_stay_but_are_not_taken(tmp_path: Path, build: str) -> None:
    path = tmp_path / "a.sqlite"
    quiet(BASE, {}, repeats=2, store=path)
    change(path, 1, build=build)
    _, made = counted(BASE, {}, repeats=2, store=path)
    assert made == 1
    builds = [build for _, build, _ in stored_rows(path)]
    own = c2d.build_info()["build_id"]
    assert builds == [build, own, own]


def test_a_run_with_a_diagnosis_of_another_build_is_no_damage(tmp_path: Path) -> None:
    path, other, former = (tmp_path / f"{name}.sqlite" for name in "abc")
    quiet(BASE, {}, repeats=2, store=path)
    change(path, 1, build="0", diagnosis='{"of": "another form"}')
    assert c2d.check_store(path) == ()
    assert c2d.join_stores(other, path) == 2
    former.write_bytes(path.read_bytes())
    as_version_1(former)
    assert c2d.join_stores(former, other) == 0
    for store in (path, other, former):
        _, missing = counted(BASE, {}, repeats=2, store=store)
        assert missing == 1
        with pytest.raises(c2d.StoreError, match="is from the build 0, with outcomes or diagnoses"):
            c2d.table(store)


def test_stores_join_and_a_conflicting_run_is_an_error(tmp_path: Path) -> None:
    one, other, third = (tmp_path / f"{name}.sqlite" for name in "abc")
    quiet(BASE, OVER, repeats=2, store=one)
    quiet(BASE, OVER, repeats=3, store=other)
    assert c2d.join_stores(third, one, other) == 12
    assert c2d.join_stores(third, one, other) == 0
    _, missing = counted(BASE, OVER, repeats=3, store=third)
    assert missing == 0
    change(one, 1, metrics='{"time":0.5}')
    with pytest.raises(c2d.StoreError, match="hold different results of the run"):
        c2d.join_stores(third, one)
    with pytest.raises(c2d.StoreError, match="does not exist"):
        c2d.join_stores(third, tmp_path / "none.sqlite")


SWEEP = """
import crawler2d as c2d
base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.03), duration=2.0)
over = {"terrain.height": [0.01 * k for k in range(1, 11)]}
def swept(store, repeats):
    c2d.sweep(base, over, repeats=repeats, store=store, progress=False, threads=2)
"""
IN_A_PROCESS = f"{NO_DASK}{SWEEP}swept(sys.argv[1], int(sys.argv[2]))"


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
def test_a_killed_sweep_goes_on_where_it_was(tmp_path: Path) -> None:
    path, whole, repeats = tmp_path / "a.sqlite", tmp_path / "b.sqlite", 40
    counts, draw = [], random.Random(1)
    for _ in range(3):
        process = subprocess.Popen([sys.executable, "-c", IN_A_PROCESS, str(path), str(repeats)])
        while not path.is_file():
            time.sleep(0.01)
        before = _count(path)
        while _count(path) == before and process.poll() is None:
            time.sleep(0.005)
        time.sleep(draw.uniform(0.0, 0.01))
        assert process.poll() is None
        process.kill()
        process.wait()
        counts.append(_count(path))
    assert counts == sorted(counts)
    assert 0 < counts[0] < counts[-1]
    names: dict[str, Any] = {}
    exec(SWEEP, names)
    for store in (path, whole):
        names["swept"](store, repeats)
    assert _figures(path) == _figures(whole)
    assert _count(path) == 10 * repeats
    print(f"rows at each kill: {counts}")


def _count(path: Path) -> int:
    try:
        return len(list(stored_rows(path)))
    except c2d.StoreError:  # not made yet
        return 0


def _figures(path: Path) -> dict[str, tuple[str, str]]:
    return {row.identity: (row.outcome, repr(row.metrics)) for row, *_ in stored_rows(path)}


def test_the_diagnosis_of_a_seizure_comes_back_as_it_was(tmp_path: Path) -> None:
    path = tmp_path / "seized.sqlite"
    wheels = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
    base = c2d.Scenario(wheels, c2d.terrains.step(0.1))
    quiet(base, {}, repeats=1, vary={}, store=path, trials="all")
    ((row, _, _),) = stored_rows(path)
    assert row.diagnosis is not None
    again = c2d.Diagnosis.from_core(row.diagnosis)
    run = c2d.simulate(base, trials="all", record="summary")
    assert run.diagnosis is not None
    assert again.trials == run.diagnosis.trials
    assert any(tried.intrusion for tried in again.trials)
    assert len(set(again.trials)) == len(again.trials)  # they have hashes
    assert str(again) == str(run.diagnosis)
    # The diagnosis of a former build for ground under the belly only.
    text = diagnosis_json(again.to_dict()).replace(
        '"mechanism":"straddled"', '"mechanism":"bellied"'
    )
    assert read_diagnosis(text)["mechanism"] is None
