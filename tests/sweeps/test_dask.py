"""Dask: a cluster of processes simulates for one store, and may lose workers."""

import os
import random
import signal
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

from crawler2d.sweeps.store import stored_rows
from tests.sweeps.small import BASE, MODELS, quiet

distributed = pytest.importorskip("distributed")

HEIGHTS = [0.03, 0.06, 0.09, 0.12]


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    options = {"dashboard_address": None, "silence_logs": 50}
    with distributed.LocalCluster(2, threads_per_worker=1, **options) as made:
        yield made


def swept(repeats: int, **options: Any) -> xr.Dataset:
    over = {"robot.track": MODELS, "terrain.height": HEIGHTS}
    return quiet(BASE, over, repeats=repeats, **options)


def test_rows_of_a_cluster_are_those_of_one_thread(cluster: Any, tmp_path: Path) -> None:
    store, calls = tmp_path / "a.sqlite", []
    with distributed.Client(cluster) as client:
        found = swept(
            10,
            executor=client.get_executor(),
            store=store,
            progress=lambda done, _total: calls.append(done),
        )
    xr.testing.assert_identical(found, swept(10, threads=1))
    assert len(list(stored_rows(store))) == found["outcome"].size
    assert (calls[0], calls[-1]) == (0, 80)
    assert calls == sorted(calls)


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")
@pytest.mark.parametrize(
    ("repeats", "kills"), [(15, 1), pytest.param(2500, 5, marks=pytest.mark.soak)]
)
def test_a_killed_worker_loses_nothing(
    cluster: Any, tmp_path: Path, repeats: int, kills: int
) -> None:
    runs = 2 * len(HEIGHTS) * repeats
    draw = random.Random(7)
    due = sorted(draw.uniform(0.1, 0.8) * runs for _ in range(kills))
    killed = []

    def kill(done: int, _total: int) -> None:
        while due and done >= due[0]:
            due.pop(0)
            alive = [worker.pid for worker in cluster.workers.values() if worker.pid]
            threading.Thread(target=os.kill, args=(draw.choice(alive), signal.SIGKILL)).start()
            killed.append(done)

    store = tmp_path / "a.sqlite"
    with distributed.Client(cluster) as client:
        found = swept(repeats, executor=client.get_executor(), store=store, progress=kill)
    assert len(killed) == kills
    xr.testing.assert_identical(found, swept(repeats))
    assert len(list(stored_rows(store))) == runs
