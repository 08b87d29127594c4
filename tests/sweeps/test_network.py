"""Sweeps on a simulated cluster give the rows of one thread, whatever happens there."""

import random
from collections import Counter
from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.errors import InternalError
from crawler2d.sweeps import collect
from tests.sweeps.network import FATES, OTHER_BUILD, Network, garbage
from tests.sweeps.small import BRIEF, MODELS, quiet
from tests.sweeps.stores import bits, hash_of

swept = partial(quiet, BRIEF, {"robot.track": MODELS, "terrain.height": [0.03, 0.06]}, repeats=6)
RUNS = 24
ENDS = ("executor failed", "another build of crawler2d", "attempts gave a result")


@pytest.fixture(autouse=True)
def _tasks_of_four_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each is computed once for all schedules."""
    simulate = cache(collect.simulate_chunk)
    monkeypatch.setattr(
        collect,
        "simulate_chunk",
        lambda texts, trials, build: simulate(tuple(texts), tuple(trials), build),
    )
    monkeypatch.setattr(collect, "_CHUNK", 4)


def troubled(
    seed: int,
    path: Path,
    sound: dict[str, str],
    happened: Counter[str],
    patch: pytest.MonkeyPatch,
) -> xr.Dataset:
    """Call a sweep until it is complete; every row in its store is valid at any time."""
    draw, table = random.Random(seed), None
    trouble, refusal = draw.uniform(0.0, 1.5), draw.choice([0.0, 0.05])
    while table is None or "failed" in table["outcome"]:
        network = Network(draw.random(), trouble, refusal, happened)
        patch.setattr(collect, "wait", network.wait)
        counts: list[int] = []
        try:
            table = swept(
                store=path,
                executor=network,
                on_error=draw.choice(["raise", "record"]),
                progress=lambda done, _, counts=counts: counts.append(done),
            )
            assert counts[-1] == RUNS
        except c2d.BatchInterrupted:
            happened["the sweep is interrupted"] += 1
        except InternalError as error:
            (end,) = [end for end in ENDS if end in str(error)]
            happened[f"the sweep ends: {end}"] += 1
        network.end()
        assert counts == sorted(counts)
        assert bits(path).items() <= sound.items()
    return table


@pytest.mark.parametrize("schedules", [20, pytest.param(1000, marks=pytest.mark.soak)])
def test_rows_of_any_schedule_are_those_of_one_thread(
    schedules: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, say: Callable[[str], None]
) -> None:
    serial = tmp_path / "serial.sqlite"
    plain = swept(threads=1, store=serial)
    sound, expected, happened = bits(serial), hash_of(serial), Counter[str]()
    for seed in range(schedules):
        path = tmp_path / f"{seed}.sqlite"
        table = troubled(seed, path, sound, happened, monkeypatch)
        assert (seed, hash_of(path)) == (seed, expected)
        xr.testing.assert_identical(table, plain)
    say(f"{schedules} schedules, seeds from 0: {dict(happened.most_common())}")
    assert {*FATES, "arrives late", "refuses a task"} <= happened.keys()
    assert {f"the sweep ends: {end}" for end in ENDS} <= happened.keys()


class Answering(Network):
    """A cluster that changes the answers to some tasks."""

    def __init__(self, change: Callable[[Any, int], Any]) -> None:
        super().__init__(0, 0.0, 0.0, Counter())
        self.change, self.count = change, 0

    def submit(self, call: Any, /, *args: Any, **options: Any) -> Any:
        self.count += 1
        number = self.count
        return super().submit(lambda: self.change(call(*args, **options), number))


def answered(change: Callable[[Any, int], Any], patch: pytest.MonkeyPatch, **options: Any) -> Any:
    network = Answering(change)
    patch.setattr(collect, "wait", network.wait)
    return swept(executor=network, **options)


def test_rows_of_another_task_were_stored_under_the_wrong_identity(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    answers: list[Any] = []

    def stale(answer: Any, _number: int) -> Any:
        answers.append(answer)
        return answers[0]

    table = answered(stale, monkeypatch, store=tmp_path / "a.sqlite", on_error="record")
    failed = table["outcome"].to_numpy() == "failed"
    assert failed.sum() == RUNS - 4
    errors = set(table["error"].to_numpy()[failed])
    assert all("it is of the run" in text or "shorter" in text for text in errors)
    swept(store=tmp_path / "serial.sqlite")
    assert len(bits(tmp_path / "a.sqlite")) == 4
    assert bits(tmp_path / "a.sqlite").items() <= bits(tmp_path / "serial.sqlite").items()


def test_garbage_is_never_accepted_as_a_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    count = len(garbage("", [("", {"metrics": {"time": 0.0}})]))
    for kind in range(count):
        store = tmp_path / f"{kind}.sqlite"

        def spoilt(answer: Any, _number: int, kind: int = kind) -> Any:
            return garbage(*answer)[kind]

        with pytest.raises(InternalError, match="3 attempts gave a result: its answer") as caught:
            answered(spoilt, monkeypatch, store=store)
        assert caught.value.__notes__[0].startswith("in cell[")
        assert bits(store) == {}


def test_a_worker_of_another_build_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also one that simulated nevertheless; earlier results are kept."""
    own = str(c2d._core.build_info()["build_id"])
    assert collect.simulate_chunk([BRIEF.to_json()], (), OTHER_BUILD) == (own, [])

    def other(answer: Any, number: int) -> Any:
        return answer if number < 3 else (OTHER_BUILD, answer[1])

    store = tmp_path / "a.sqlite"
    for _ in range(2):
        with pytest.raises(InternalError, match=f"another build.*{OTHER_BUILD}, not {own}"):
            answered(other, monkeypatch, store=store)
    assert len(bits(store)) in (0, 4, 8, 12, 16)
    swept(store=tmp_path / "serial.sqlite")
    assert bits(store).items() <= bits(tmp_path / "serial.sqlite").items()
