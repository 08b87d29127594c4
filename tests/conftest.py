"""Fixtures of all tests: length of the tests, a scenario, a run."""

from __future__ import annotations

import gc
import os
import signal
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

import hypothesis
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.shared import ROBOT, SOAK

if TYPE_CHECKING:
    from tests.fuzz.standing_child import StandingChildren

# A background process of a shell ignores Ctrl-C, and so would its child processes.
signal.signal(signal.SIGINT, signal.default_int_handler)

# The first of many processes that import the package writes its byte code for all others.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
# The next run of the tests need not rewrite their assertions again.
sys.dont_write_bytecode = False
# While tests are collected, there is hardly any garbage, and searching for it takes a fifth of the
# time.
_USUAL = gc.get_threshold()
gc.set_threshold(50_000, 20, 20)

hypothesis.settings.register_profile("test", max_examples=30, deadline=None, derandomize=True)
hypothesis.settings.register_profile("soak", max_examples=10_000, deadline=None)
hypothesis.settings.load_profile("soak" if SOAK else "test")


def pytest_collection_finish() -> None:
    """Keep the garbage collector from scanning thousands of tests repeatedly."""
    gc.set_threshold(*_USUAL)
    gc.collect()
    gc.freeze()


@pytest.fixture
def scenario() -> Scenario:
    """A short run that clears."""
    return Scenario(ROBOT, c2d.terrains.step(0.03), duration=6.0)


@pytest.fixture(scope="session")
def run() -> c2d.Run:
    """A finished run with its history."""
    return c2d.simulate(
        c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(3)), c2d.terrains.step(0.05)
    )


@pytest.fixture
def say(capsys: pytest.CaptureFixture[str]) -> Callable[[str], None]:
    """Print a measured value even if the test passes."""

    def print_now(text: str) -> None:
        with capsys.disabled():
            print(f"\n  {text}")

    return print_now


@pytest.fixture(autouse=True)
def _no_thread_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep the developer's own limit out of the tests."""
    monkeypatch.delenv("CRAWLER2D_THREADS", raising=False)


@pytest.fixture(scope="session")
def children() -> Iterator[StandingChildren]:
    """Standing child processes of the reader."""
    from tests.fuzz.standing_child import StandingChildren  # noqa: PLC0415 - not on Windows

    children = StandingChildren()
    yield children
    children.stop()


@pytest.fixture
def children_of_its_own() -> None:
    """The reader starts a process for each file, as usual, for tests of these processes."""


@pytest.fixture(autouse=True)
def _standing_children(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Import the reader's modules once, which saves a second per file."""
    if sys.platform != "win32" and "children_of_its_own" not in request.fixturenames:
        children: StandingChildren = request.getfixturevalue("children")
        monkeypatch.setattr("crawler2d.reading.parsing.subprocess.run", children.run)
