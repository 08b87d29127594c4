"""Small sweeps for several tests."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.sweep import sweep
from tests.kept import check_said
from tests.shared import ROBOT

SAID = Path(__file__).with_name("said.txt")

BASE = Scenario(ROBOT, c2d.terrains.step(0.03), duration=4.0)
BRIEF = BASE.replace({"duration": 0.05})
MODELS = {"belt": c2d.BeltTrack(), "line of 3": c2d.LineOfWheels(3)}


def quiet(base: Scenario, over: Any, **options: Any) -> xr.Dataset:
    """Sweep without a progress bar."""
    return sweep(base, over, **{"repeats": 2, "progress": False, **options})


def interrupt_after(count: int) -> Callable[[int, int], None]:
    """Return a progress that interrupts when more runs than this are finished."""

    def progress(done: int, _total: int) -> None:
        if done > count:
            raise KeyboardInterrupt

    return progress


def refusal(base: Any, over: Any, **options: Any) -> c2d.ScenarioError:
    """The error of a refused sweep, word for word; nothing may run before it."""
    calls: list[int] = []
    with pytest.raises(c2d.ScenarioError) as caught:
        sweep(base, over, **{"progress": lambda done, _: calls.append(done), **options})
    assert calls == []
    assert caught.value.rule.startswith("must")
    check_said(SAID, [str(caught.value)])
    return caught.value
