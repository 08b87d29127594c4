"""The real-time factor is simulated time over processor time of this thread."""

import time
from typing import Any

import pytest

import crawler2d as c2d
from tests.shared import ROBOT

STEP = c2d.Scenario(ROBOT, c2d.terrains.step(0.03))
MODELS = {"belt": c2d.BeltTrack(), "gears": c2d.LineOfWheels(4, wheel=c2d.GearWheel())}


def factor_of(**how: Any) -> Any:
    return c2d.studies.real_time_factor(STEP, **{"repeats": 3, "progress": False, **how})


def test_it_is_simulated_time_by_the_time_of_the_processor(monkeypatch: pytest.MonkeyPatch) -> None:
    ticks = iter(range(1_000_000))
    monkeypatch.setattr(time, "thread_time", lambda: 0.25 * next(ticks))
    found = factor_of(duration=2.0)
    assert found["factor_each"].values.ravel().tolist() == [8.0] * 6


def test_standing_costs_less_than_driving_and_a_belt_less_than_gear_wheels() -> None:
    found = factor_of(models=MODELS)
    factor = found["factor"]
    assert factor.dims == ("model", "motion")
    # Four times and more on an idle machine.
    assert factor.sel(model="gears", motion="standing") > factor.sel(
        model="gears", motion="driving"
    )
    assert factor.sel(model="belt", motion="driving") > factor.sel(model="gears", motion="driving")
    assert (found["factor_low"] <= factor).all()
    assert (factor <= found["factor_high"]).all()
    assert (found["moved"].sel(motion="driving") > 0.5).all()
    assert (abs(found["moved"].sel(motion="standing")) < 1e-3).all()


def test_it_says_of_which_machine_and_build_it_is() -> None:
    found = factor_of(repeats=1, duration=0.5)
    assert found.attrs["processor"]
    assert found.attrs["build_build_id"] == c2d.build_info()["build_id"]
    assert found.attrs["duration"] == 0.5


def test_invalid_arguments_are_refused_by_name() -> None:
    cases: list[tuple[dict[str, Any], str]] = [
        ({"store": "a.sqlite"}, "store"),
        ({"executor": None}, "executor"),
        ({"threads": 2}, "threads"),
        ({"vary": {}}, "vary"),
        ({"duration": 0.0}, "duration"),
        ({"repeats": 0}, "repeats"),
    ]
    for how, path in cases:
        with pytest.raises(c2d.ScenarioError) as caught:
            factor_of(**how)
        assert caught.value.path == path


def test_the_figure_has_a_line_at_real_time() -> None:
    from matplotlib import pyplot as plt  # noqa: PLC0415

    calls: list[tuple[int, int]] = []
    found = factor_of(repeats=1, progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (4, 4)
    ax = found.plot()
    assert ax.get_xscale() == "log"
    assert [label.get_text() for label in ax.get_legend().get_texts()] == ["standing", "driving"]
    assert ax.texts[0].get_text().startswith("drove")
    plt.close("all")


@pytest.mark.parametrize("motion", ["standing", "driving"])
def test_the_figure_shows_one_motion_alone(motion: str) -> None:
    ax = factor_of(repeats=1).sel(motion=motion).plot()
    told = [text.get_text().partition(" ")[0] for text in ax.texts]
    assert told == (["drove"] if motion == "driving" else [""])
