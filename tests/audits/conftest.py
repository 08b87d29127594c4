"""Audits that several tests use."""

from __future__ import annotations

import functools
from collections.abc import Iterator

import pytest

import crawler2d as c2d
from crawler2d.audits import audit as audit_module
from crawler2d.audits.page import chart
from tests.audits.seizing import QUIET, SEIZING, STEP, seizing_file


@pytest.fixture(scope="package", autouse=True)
def _charts_once() -> Iterator[None]:
    """Computing jams takes half the time of a page, and many pages have the same robots."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(chart, "_figure", functools.cache(chart._figure))
        yield


@pytest.fixture(scope="session")
def found() -> c2d.Audit:
    """Four touching wheels on a step of 75 mm, with only the start unknown."""
    return c2d.audit(SEIZING, STEP, unknown={}, repeats=20, **QUIET)


@pytest.fixture(scope="session")
def of_file(tmp_path_factory: pytest.TempPathFactory) -> c2d.Audit:
    """A cart file that seizes on one of two steps and clears the other."""
    path = tmp_path_factory.mktemp("cart") / "cart.urdf"
    path.write_text(seizing_file(), encoding="utf-8")
    steps = {**STEP, "step of 30 mm": c2d.terrains.step(0.03)}
    return c2d.audit(path, steps, samples=9, repeats=1, repair=False, seed=3, **QUIET)


@pytest.fixture
def one_obstacle(monkeypatch: pytest.MonkeyPatch) -> None:
    """One step as standard obstacles, for tests that do not depend on the obstacle."""
    monkeypatch.setattr(audit_module, "standard_obstacles", lambda *_: STEP)
