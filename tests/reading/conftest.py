"""Children of the reader that stand ready, for tests of many files."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from tests.fuzz.standing_child import StandingChildren


@pytest.fixture(scope="session")
def children() -> Iterator[StandingChildren]:
    from tests.fuzz.standing_child import StandingChildren  # noqa: PLC0415 - not on Windows

    children = StandingChildren()
    yield children
    children.stop()


@pytest.fixture
def standing_children(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Pay for imports once, a third of a second a file: for tests of what is read alone."""
    if sys.platform != "win32":
        children: StandingChildren = request.getfixturevalue("children")
        monkeypatch.setattr("crawler2d.reading.parsing.subprocess.run", children.run)
