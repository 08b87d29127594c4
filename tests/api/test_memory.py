"""Requests beyond the available memory are refused; none ends the interpreter."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = Path(__file__).with_name("memory_requests.py")

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="needs a limit of address space")


def told(count: int, seed: int) -> dict[str, int]:
    done = subprocess.run(
        [sys.executable, str(PROGRAM), str(count), str(seed)],
        capture_output=True,
        text=True,
        check=False,
        # OpenBLAS reserves memory for each of its threads, and interrupts the process without it.
        env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
    )
    assert done.returncode == 0, done.stderr[-2000:]
    ends: dict[str, int] = json.loads(done.stdout)
    print("", *(f"  {end}: {times}" for end, times in sorted(ends.items())), sep="\n")
    return ends


def check(ends: dict[str, int]) -> None:
    for request in ("many_histories", "forty_large_grounds", "many_threads", "a_long_text"):
        assert f"{request}: LimitError" in ends
    assert "many_grousers: ScenarioError" in ends
    for request in ("an_ordinary_run", "an_ordinary_sweep", "a_chain"):
        assert f"{request}: done" in ends


def test_requests_beyond_half_a_gigabyte_are_refused_and_ordinary_ones_run() -> None:
    check(told(13, seed=0))  # all but the last two, which take as long as many of them


@pytest.mark.soak
def test_three_hundred_requests_beyond_half_a_gigabyte_abort_nothing() -> None:
    ends = told(300, seed=1)
    check(ends)
    assert sum(ends.values()) == 300
