"""Dask: a cluster of processes simulates for one store, and may misbehave."""

import contextlib
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.errors import InternalError
from crawler2d.sweeps import collect
from crawler2d.sweeps.store import stored_rows
from tests.sweeps.small import BASE, MODELS, quiet
from tests.sweeps.stores import bits, hash_of

distributed = pytest.importorskip("distributed")

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no SIGKILL")

Serial = Callable[[int], Path]

HEIGHTS = [0.03, 0.06, 0.09, 0.12]
OTHER_BUILD = "0123456789abcdef"


@contextlib.contextmanager
def started(**options: Any) -> Iterator[Any]:
    options = {"dashboard_address": ":0", "silence_logs": 50, "threads_per_worker": 1} | options
    import dask.config  # noqa: PLC0415 - optional

    # Imports of a worker take longest, and each has a successor, so they are forks of one process.
    with (
        dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"}),
        distributed.LocalCluster(2, **options) as made,
    ):
        yield made


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    with started() as made:
        yield made


def swept(repeats: int, **options: Any) -> xr.Dataset:
    over = {"robot.track": MODELS, "terrain.height": HEIGHTS}
    return quiet(BASE, over, repeats=repeats, **options)


def pids(cluster: Any) -> list[int]:
    return [worker.pid for worker in cluster.workers.values() if worker.pid]


@pytest.fixture(scope="module")
def serial(tmp_path_factory: pytest.TempPathFactory) -> Serial:
    """A store of the same sweep, simulated by this process."""

    @cache
    def simulated(repeats: int) -> Path:
        store = tmp_path_factory.mktemp("serial") / "a.sqlite"
        swept(repeats, store=store)
        return store

    return simulated


@pytest.fixture
def _small_chunks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small chunks, so that work remains whatever happens to the first tasks."""
    monkeypatch.setattr(collect, "_CHUNK", 5)


class Once:
    """Progress that calls a function in a separate thread after a fraction of the runs."""

    def __init__(self, action: Callable[[], object], *shares: float) -> None:
        self.action, self.shares = action, sorted(shares)
        self.threads: list[threading.Thread] = []

    def __call__(self, done: int, total: int) -> None:
        while self.shares and done >= self.shares[0] * total:
            self.shares.pop(0)
            self.threads.append(threading.Thread(target=self.action))
            self.threads[-1].start()

    def join(self) -> int:
        """Number of calls."""
        for thread in self.threads:
            thread.join()
        return len(self.threads)


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


@pytest.mark.parametrize(
    ("repeats", "kills"), [(15, 1), pytest.param(2500, 5, marks=pytest.mark.soak)]
)
def test_a_killed_worker_loses_nothing(
    cluster: Any, tmp_path: Path, repeats: int, kills: int
) -> None:
    draw = random.Random(7)
    kill = Once(
        lambda: os.kill(draw.choice(pids(cluster)), signal.SIGKILL),
        *(draw.uniform(0.1, 0.8) for _ in range(kills)),
    )
    store = tmp_path / "a.sqlite"
    with distributed.Client(cluster) as client:
        found = swept(repeats, executor=client.get_executor(), store=store, progress=kill)
    assert kill.join() == kills
    xr.testing.assert_identical(found, swept(repeats))
    assert len(list(stored_rows(store))) == 2 * len(HEIGHTS) * repeats


POISON = "0.0612345"


def die_of_poison(texts: Any, *args: Any) -> Any:
    """A chunk whose process is killed if it contains a certain run."""
    if any(POISON in text for text in texts):
        time.sleep(5.0)  # Dask does not restart a worker that dies during its start
        os.kill(os.getpid(), signal.SIGKILL)
    return collect.simulate_chunk(texts, *args)


@pytest.mark.soak
@pytest.mark.usefixtures("_small_chunks")
def test_a_run_that_kills_every_worker_is_the_only_one_without_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its short sibling is in test_executor.py."""
    store = tmp_path / "a.sqlite"
    over = {"terrain.height": [0.05, *(0.06 + 0.001 * k for k in range(10)), float(POISON)]}
    swept = partial(quiet, BASE, over, repeats=1, vary={}, store=store)
    with (
        started() as cluster,
        distributed.Client(cluster) as client,
        monkeypatch.context() as patch,
    ):
        cluster.scheduler.allowed_failures = 0
        patch.setattr(collect, "simulate_chunk", die_of_poison)
        with pytest.raises(InternalError, match=r"none of 3 attempts.*KilledWorker") as caught:
            swept(executor=client.get_executor())
    assert caught.value.__notes__ == [f"in cell[height={POISON}, repeat=0]"]
    assert len(bits(store)) == 11
    xr.testing.assert_identical(swept(), quiet(BASE, over, repeats=1, vary={}))


@pytest.mark.usefixtures("_small_chunks")
def test_ctrl_c_ends_a_sweep_whose_workers_hang(
    cluster: Any, serial: Serial, tmp_path: Path
) -> None:
    store, hanging = tmp_path / "a.sqlite", list[int]()

    def hang() -> None:
        hanging.extend(pids(cluster))
        for pid in hanging:
            os.kill(pid, signal.SIGSTOP)
        time.sleep(0.3)
        os.kill(os.getpid(), signal.SIGINT)

    progress = Once(hang, 0.1)
    with distributed.Client(cluster) as client:
        try:
            with pytest.raises(c2d.BatchInterrupted, match=r"of 80 runs; .*a\.sqlite keeps them"):
                swept(10, executor=client.get_executor(), store=store, progress=progress)
        finally:
            progress.join()
            for pid in hanging:
                os.kill(pid, signal.SIGCONT)
        kept = bits(store)
        assert 8 <= len(kept) < 80
        swept(10, executor=client.get_executor(), store=store)
    assert kept.items() <= bits(serial(10)).items()
    assert hash_of(store) == hash_of(serial(10))


@pytest.mark.soak
@pytest.mark.usefixtures("_small_chunks")
def test_dask_itself_replaces_a_worker_that_hangs(serial: Serial, tmp_path: Path) -> None:
    """After its time to live, by default five minutes."""
    import dask.config  # noqa: PLC0415 - optional

    store = tmp_path / "a.sqlite"
    with (
        dask.config.set({"distributed.scheduler.worker-ttl": "3s"}),
        started() as cluster,
        distributed.Client(cluster) as client,
    ):
        hang = Once(lambda: os.kill(pids(cluster)[0], signal.SIGSTOP), 0.3)
        swept(20, executor=client.get_executor(), store=store, progress=hang)
        assert hang.join() == 1
    assert hash_of(store) == hash_of(serial(20))


def pretend(build: str) -> None:
    """Pretend to be a worker of another build."""
    collect._build = lambda: build


@pytest.mark.usefixtures("_small_chunks")
def test_a_worker_of_another_build_is_refused(cluster: Any, serial: Serial, tmp_path: Path) -> None:
    own, store = collect._build(), tmp_path / "a.sqlite"
    with distributed.Client(cluster) as client:
        some = list(client.scheduler_info()["workers"])[:1]
        client.run(pretend, OTHER_BUILD, workers=some)
        try:
            with pytest.raises(InternalError, match=f"another build .*{OTHER_BUILD}, not {own}"):
                swept(10, executor=client.get_executor(), store=store)
        finally:
            client.run(pretend, own, workers=some)
        kept = bits(store)
        swept(10, executor=client.get_executor(), store=store)
    assert kept.items() <= bits(serial(10)).items()
    assert hash_of(store) == hash_of(serial(10))


@pytest.mark.usefixtures("_small_chunks")
def test_a_sweep_waited_for_ever_for_workers_that_were_restarted(
    cluster: Any, serial: Serial, tmp_path: Path
) -> None:
    """For a result that was finished, but not fetched; Dask cancels the other tasks."""
    store = tmp_path / "a.sqlite"
    with distributed.Client(cluster) as client:
        restart = Once(client.restart, 0.2)
        swept(10, executor=client.get_executor(), store=store, progress=restart)
        assert restart.join() == 1
    assert hash_of(store) == hash_of(serial(10))


@pytest.mark.soak
@pytest.mark.usefixtures("_small_chunks")
@pytest.mark.parametrize("returns", [True, False])
def test_a_scheduler_that_is_killed_loses_nothing(
    returns: bool, serial: Serial, tmp_path: Path
) -> None:
    """If it returns, the sweep continues; else it ends with an error, and the store continues."""
    store, port = tmp_path / "a.sqlite", 28786
    address = f"tcp://127.0.0.1:{port}"
    parts: list[subprocess.Popen[bytes]] = []

    def start(name: str, *args: str) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", f"distributed.cli.dask_{name}", "--no-dashboard", *args]
        parts.append(subprocess.Popen(command, stderr=subprocess.DEVNULL, cwd=tmp_path))
        return parts[-1]

    def start_all() -> subprocess.Popen[bytes]:
        scheduler = start("scheduler", "--host", "127.0.0.1", "--port", str(port))
        for _ in range(2):
            start("worker", address, "--nthreads", "1", "--no-nanny", "--death-timeout", "20")
        return scheduler

    def kill() -> None:
        parts[0].kill()
        parts[0].wait()
        if returns:
            start_all()

    try:
        start_all()
        with distributed.Client(address, timeout=30) as client:
            client.wait_for_workers(2, timeout=60)
            progress = Once(kill, 0.2)
            options = {"executor": client.get_executor(), "store": store, "progress": progress}
            if returns:
                swept(20, **options)
            else:
                with pytest.raises(InternalError, match=r"executor failed .*continues from there"):
                    swept(20, **options)
            assert progress.join() == 1
    finally:
        for part in parts:
            part.kill()
            part.wait()
    kept = bits(store)
    assert 32 <= len(kept) <= 160
    assert kept.items() <= bits(serial(20)).items()
    swept(20, store=store)
    assert hash_of(store) == hash_of(serial(20))
