"""Refusals of sweeps, and stored runs after failures and interrupts."""

import os
import signal
import sys
import threading
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.units import METRICS
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.record import Row
from crawler2d.sweeps.collect import Collector
from crawler2d.variation.distributions import scaled, uniform
from tests.kept import refusing
from tests.shared import ROBOT
from tests.sweeps.small import BASE, BRIEF, MODELS, SAID, quiet, refusal


@pytest.mark.parametrize(
    ("over", "path", "hint"),
    [
        ({"terrain.hight": [0.1]}, "cell[hight=0.1].terrain.hight", "did you mean height?"),
        (
            {"robot.track": MODELS, "robot.track.count": [3]},
            "cell[track=belt, robot_track_count=3].robot.track.count",
            "BeltTrack has no fields",
        ),
        ({"terrain.height": [0.1, -0.1]}, "cell[height=-0.1].terrain.height", "> 0 m"),
        ({"terrain.height": [0.1, np.nan]}, "cell[height=nan].terrain.height", "must be"),
        ({"terrain.height": ["high"]}, "cell[height=high].terrain.height", "a number"),
        (
            {"robot.track": MODELS, "drive.speed": [0.4, 2.0]},
            "cell[track=belt, speed=2.0].drive.speed",
            "max_speed = 1.39",
        ),
        ({"terrain": {"wall": "brick"}}, "cell[terrain=wall].terrain", "must be a Flat or"),
        ({"robot": {"none": None}}, "cell[robot=none].robot", "must be a Robot"),
    ],
)
def test_a_broken_cell_is_named_before_anything_runs(over: Any, path: str, hint: str) -> None:
    error = refusal(BASE, over)
    assert error.path == path
    assert hint in error.rule


def test_a_draw_that_breaks_a_rule_names_cell_and_repeat() -> None:
    vary = {"drive.speed": scaled(4.0, 4.0)}
    error = refusal(BASE, {"robot.track": MODELS}, vary=vary)
    assert error.path == "cell[track=belt, repeat=0].drive.speed"
    error = refusal(BASE, {"robot.track": MODELS}, vary={"robot.track.count": scaled(1.0, 1.0)})
    assert error.path == "cell[track=belt].robot.track.count"


@pytest.mark.parametrize(
    ("argument", "value", "path"),
    [
        ("repeats", 0, "repeats"),
        ("repeats", -1, "repeats"),
        ("repeats", 10**6 + 1, "repeats"),
        ("repeats", 2.0, "repeats"),
        ("repeats", True, "repeats"),
        ("repeats", None, "repeats"),
        ("repeats", "20", "repeats"),
        ("seed", -1, "seed"),
        ("seed", 2**64, "seed"),
        ("seed", 1.5, "seed"),
        ("seed", None, "seed"),
        ("seed", False, "seed"),
        ("seed", np.float64(1.0), "seed"),
        ("seed", [1], "seed"),
        ("vary", "start.approach", "vary"),
        ("vary", {"terrain.height": uniform(0.0, 0.1)}, "vary['terrain.height']"),
        ("vary", {"start.approach": 0.1}, "vary['start.approach']"),
        ("on_error", "ignore", "on_error"),
        ("wall_time", 1, "wall_time"),
        ("progress", "yes", "progress"),
    ],
)
def test_a_wrong_argument_is_refused_by_name(argument: str, value: Any, path: str) -> None:
    assert refusal(BASE, {"terrain.height": [0.1]}, **{argument: value}).path == path


@pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")
def test_a_draw_that_breaks_a_rule_leaves_the_other_draws_alone() -> None:
    slippery = BRIEF.replace({"terrain.friction": 100.0})
    plain, found = quiet(BRIEF, {}, repeats=20), quiet(slippery, {}, repeats=20)
    for name in ("drawn_approach", "drawn_track_phase", "drawn_speed"):
        assert found[name].equals(plain[name])


def test_an_invalid_scenario_is_refused() -> None:
    assert refusal(ROBOT, {"terrain.height": [0.1]}).path == "scenario"
    broken = BASE.replace({"robot.mass": -1.0})
    assert refusal(broken, {"terrain.height": [0.1]}).path == "robot.mass"
    with pytest.raises(c2d.LimitError):
        quiet(BASE, {"terrain.height": [0.1]}, threads=0)


def test_a_refused_cell_can_be_recorded_without_affecting_the_others() -> None:
    over = {"terrain.height": [0.03, -0.1]}
    found = quiet(BASE, over, on_error="record")
    alone = quiet(BASE, {"terrain.height": [0.03]})
    good = found.sel(height=[0.03])
    for name in alone.data_vars:
        assert good[name].equals(alone[name]), name
    bad = found.sel(height=-0.1)
    assert bad["outcome"].values.tolist() == ["refused"] * 2
    assert bad["error"].values[1].startswith("cell[height=-0.1].terrain.height must be > 0 m")
    assert bad["scenario"].values.tolist() == bad["identity"].values.tolist() == [""] * 2
    for name in [*METRICS, "drawn_speed"]:
        assert bad[name].isnull().all()
    poses = c2d.rate(found)["distinct"]
    assert poses.sel(height=0.03) > 0
    assert poses.sel(height=-0.1) == 0


def test_a_sweep_of_refused_cells_alone_has_no_metrics() -> None:
    found = quiet(BASE, {"terrain.height": [-0.1]}, on_error="record")
    assert found["outcome"].values.tolist() == [["refused"] * 2]
    assert "final_x" not in found


def diverging(monkeypatch: pytest.MonkeyPatch, index: int) -> None:
    """Let one run of every batch diverge."""

    whole = Collector.rows

    def rows_of(*given: Any) -> list[Row]:
        rows = whole(*given)
        error = c2d.SimulationDiverged("chassis is not finite", step=7, body="chassis")
        rows[index] = Row.of_error(error, rows[index].identity, rows[index].scenario)
        return rows

    monkeypatch.setattr(Collector, "rows", rows_of)


def test_a_run_that_diverged_can_be_recorded(monkeypatch: pytest.MonkeyPatch) -> None:
    diverging(monkeypatch, 3)
    found = quiet(BRIEF, {"robot.track": MODELS}, on_error="record")
    assert found["outcome"].values.tolist() == [["timed_out"] * 2, ["timed_out", "diverged"]]
    assert found["error"].values.tolist() == [["", ""], ["", "chassis is not finite"]]
    assert np.isnan(found["final_x"].values).tolist() == [[False, False], [False, True]]
    assert c2d.rate(found)["count"].values.tolist() == [2, 1]
    Scenario.from_json(found["scenario"].values[1, 1]).validate()


def test_a_run_that_diverged_is_named_in_a_note(monkeypatch: pytest.MonkeyPatch) -> None:
    diverging(monkeypatch, 3)
    with pytest.raises(c2d.SimulationDiverged, match="not finite") as caught:
        quiet(BRIEF, {"robot.track": MODELS})
    assert caught.value.__notes__ == ["in cell[track=line of 3, repeat=1]"]


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to itself")
def test_ctrl_c_keeps_the_finished_runs() -> None:
    solver = c2d.Solver(time_step=1e-3)  # steps with an accuracy would soon be at the end
    long = Scenario(ROBOT, c2d.terrains.flat(length=900.0), goal=800.0, solver=solver)
    over = {"duration": [0.1, 10_000.0]}
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    try:
        with pytest.raises(c2d.BatchInterrupted) as caught:
            quiet(long, over, threads=2)
    finally:
        timer.cancel()
    runs = caught.value.runs
    assert [run.outcome is not None for run in runs] == [True, True, False, False]
    assert [run.scenario.duration for run in runs] == [0.1, 0.1, 10_000.0, 10_000.0]
    assert runs[2].scenario != runs[3].scenario  # with its draws


def test_a_missing_xarray_names_its_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ImportError, match=r"pip install 'crawler2d\[analysis\]'"):
        quiet(BRIEF, {"terrain.height": [0.1]})


@pytest.mark.parametrize(
    ("drive", "how"),
    [
        (c2d.Drive(schedule=((0.0, 0.1),)), {"over": {"drive.speed": [0.1, 0.3]}}),
        (c2d.Drive(schedule=((0.0, 0.1),)), {"vary": {"drive.speed": c2d.uniform(0.1, 0.3)}}),
        (c2d.Drive(schedule=((0.0, 0.1),)), {"unknown": {"drive.speed": c2d.scaled(0.5, 1.0)}}),
        (
            c2d.Drive(gait=c2d.Hold(0.0, ((0.0, 0.2),))),
            {"over": {"drive.gait.angle": [0.1, 0.3], "terrain.height": [0.01, 0.02]}},
        ),
    ],
)
def test_a_command_that_a_schedule_replaces_is_not_swept(drive: c2d.Drive, how: Any) -> None:
    """All rows would be equal: a schedule that begins at 0 s leaves no time for another speed."""
    base = BASE.replace({"robot": c2d.robots.engineer(), "drive": drive, "duration": 0.05})
    with refusing(SAID, "must not be swept or drawn where drive") as caught:
        quiet(base, **{"over": {}, **how})
    assert caught.value.path in {"drive.speed", "drive.gait.angle"}
    assert "schedule begins at 0 s and sets it, got ((0.0, 0." in str(caught.value)
    later = {"drive.schedule": ((0.01, 0.1),)} if drive.schedule else {"drive.gait": c2d.Hold()}
    quiet(base.replace(later), **{"over": {}, **how})
    quiet(
        base, {"drive.schedule": {"none": None, "some": ((0.0, 0.1),)}, "drive.speed": [0.1, 0.2]}
    )
    quiet(base, {})  # the usual draws may vary the speed
