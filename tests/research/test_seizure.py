"""The study: its draws, counts and files, with a few runs."""

import csv
import html
import itertools
import math
from dataclasses import fields, replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import crawler2d as c2d
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.rates import rates_of
from research import seizure, stops
from research import seizure_tables as tables
from research.__main__ import main
from research.models import gear_pairs, study_models, study_robots
from research.seizure import QUICK, Design, Sweeps
from research.stops import FIGURES
from tests.shared import ROBOT

MODELS = study_models()
FEW = {name: MODELS[name] for name in ("belt", "line of 3", "line of 3 gears")}
TINY = Design(
    heights={"step": (0.06,), "barrier": (0.04,), "knife edge": (0.02,)},
    repeats=1,
    robot_heights=(0.09,),
    robot_repeats=1,
    ride_repeats=1,
    phase_fractions=(0.0, 1.0 / 3.0),
)


def sweeps(design: Design = TINY) -> Sweeps:
    return Sweeps(design=design, models=FEW, progress=False)


@pytest.fixture(scope="module")
def table() -> xr.Dataset:
    """Two models on four heights, ten runs per cell, with made-up outcomes."""
    outcomes = np.full((2, 4, 10), "cleared", dtype=object)
    outcomes[0, 1, :6] = "seized"  # a gap below a height that is cleared
    outcomes[0, 3, :] = "tipped_over"
    outcomes[1, :, :] = "stalled"
    outcomes[1, 0, 0] = "diverged"
    outcomes[1, 3, :2] = "cleared"  # where the first tipped over
    outcomes[1, 3, 2] = "seized"
    dims = ("track", "height", "repeat")
    zero = np.zeros(outcomes.shape)
    stopped = np.isin(outcomes.astype(str), ["seized", "stalled"])
    mechanisms = np.where(outcomes == "seized", "undercut", "")
    mechanisms[1, 1, :3] = "blocked"
    mechanisms[0, 1, 0] = "straddled"
    every_other = np.arange(10) % 2 == 0
    figures = {
        "time": zero + 10.0,
        "wall_time": zero + 0.1,
        "max_penetration": zero + np.array([[[1e-4]], [[3e-4]]]),
        "intrusion_depth": zero + np.arange(10) * 1e-3,
        "intrusion_root_depth": zero + np.arange(10) * 0.5e-3,
        "jammed": outcomes == "seized",
        "transient": outcomes == "timed_out",
        "freed_by_closed_track": stopped & every_other,
        "freed_by_closed_track_clear_of_the_ground": stopped & (np.arange(10) == 1),
        "freed_by_torque_x2": outcomes == "stalled",
        "freed_by_friction_x2": stopped & (outcomes == "seized") & every_other,
        "freed_by_no_belly": outcomes == "hung_up",
    }
    return xr.Dataset(
        {
            "outcome": (dims, outcomes.astype(str)),
            "mechanism": (dims, mechanisms),
            **{name: (dims, values) for name, values in figures.items()},
            # Three poses of each cell: 1.2 mm apart, in metres.
            "final_x": (dims, zero + 1.2e-3 * (np.arange(10) % 3)),
            "final_y": (dims, zero),
            "final_angle": (dims, zero),
        },
        coords={"track": ["first", "second"], "height": [0.02, 0.04, 0.06, 0.08]},
        attrs={"scenario": Scenario(ROBOT, c2d.terrains.step(0.05)).to_json()},
    )


def test_every_model_makes_a_valid_robot() -> None:
    for name, model in MODELS.items():
        Scenario(ROBOT.with_track(model.track), c2d.terrains.step(0.05)).validate()
        assert model.source == "ours" or any(c.isdigit() for c in model.source), name


def test_wheels_of_a_sixth_of_the_axle_distance_touch_in_a_line_of_four() -> None:
    track = MODELS["line of 4, touching"].track
    assert isinstance(track, c2d.LineOfWheels)
    assert track.wheel_radius == pytest.approx(0.365 / 3 / 2)


def test_the_wheels_of_the_hybrid_stand_on_one_level() -> None:
    wheels = ROBOT.with_track(MODELS["hybrid"].track).wheels()
    assert np.ptp(wheels["y"] - wheels["radius"]) < 1e-12


def test_each_robot_of_the_study_differs_from_the_preset_in_one_estimate() -> None:
    preset, *others = study_robots().values()
    assert preset == ROBOT
    for other in others:
        changed = [
            f.name for f in fields(Robot) if getattr(other, f.name) != getattr(preset, f.name)
        ]
        assert len(changed) == 1


def test_every_model_gets_the_same_draws() -> None:
    found = sweeps(replace(TINY, repeats=2)).on_obstacle("step")
    for name in ("drawn_approach", "drawn_track_phase", "drawn_speed", "drawn_friction"):
        assert np.ptp(found[name].to_numpy(), axis=0).max() == 0.0
        assert np.ptp(found[name].to_numpy(), axis=2).min() > 0.0


def test_the_obstacles_are_those_of_the_design() -> None:
    for obstacle, thickness in (("barrier", 0.1), ("knife edge", 0.01)):
        text = sweeps().on_obstacle(obstacle)["scenario"].to_numpy().flat[0]
        terrain = Scenario.from_json(text).terrain
        assert isinstance(terrain, c2d.terrains.barrier)
        assert (terrain.thickness, terrain.height) == (thickness, TINY.heights[obstacle][0])


def test_cells_count_successes_failures_and_runs_without_a_result(table: xr.Dataset) -> None:
    cells = tables.cells(table, "step")
    assert [cell.cleared for cell in cells] == [10, 4, 10, 0, 0, 0, 0, 2]
    assert [cell.count for cell in cells] == [10, 10, 10, 10, 9, 10, 10, 10]
    assert cells[1].others == "6 seized"
    assert cells[4].others == "9 stalled, 1 diverged"
    assert (cells[1].rate, cells[1].low, cells[1].high) == c2d.wilson(4, 10)
    assert "7 stalled, 1 seized" in tables.rates_text(cells)


def test_a_climb_has_the_greatest_height_and_the_gaps_below_it(table: xr.Dataset) -> None:
    first, second = tables.climbs(table, "step")
    assert (first.highest, first.gaps) == (0.06, (0.04,))
    assert math.isnan(second.highest)
    assert second.gaps == ()
    assert (first.simulated_time, first.computing_time) == pytest.approx((400.0, 4.0))
    assert second.max_penetration == 3e-4
    models = {"first": MODELS["belt"], "second": MODELS["line of 3"]}
    lines = tables.climbs_text(models, [first, second]).splitlines()
    assert lines[-2].split() == ["first", "ours", "60", "(not", "40)", "100", "0.10"]
    assert lines[-1].split() == ["second", "Fig.", "3", "none", "100", "0.30"]


def test_stops_have_outcomes_mechanisms_and_trials(table: xr.Dataset) -> None:
    first, second = stops.stops(table, "step", belt="first")
    assert (first.count, first.cleared, first.seized, first.stopped) == (40, 24, 6, 6)
    assert (first.mechanism, first.of_mechanism) == ("undercut", 5)
    assert (first.jammed, first.unnatural_stops, first.unnatural_passes) == (6, 4, 0)
    assert (first.freed_by_torque, first.freed_by_friction, first.freed_by_no_belly) == (0, 3, 0)
    assert (first.transient, second.transient) == (0, 0)
    assert first.depth == pytest.approx(2.5e-3)  # of 0 to 5 mm
    assert first.root_depth == pytest.approx(1.25e-3)
    assert (second.count, second.cleared, second.seized, second.stalled) == (39, 2, 1, 36)
    assert (second.mechanism, second.of_mechanism) == ("", 33)
    assert (second.jammed, second.freed_by_torque, second.unnatural_passes) == (1, 36, 2)
    assert (second.hung_up, second.slipping, second.cycling) == (0, 0, 0)
    *_, one, other = stops.stops_text([first, second]).splitlines()
    assert one.split()[:6] == ["first", "step", "40", "24", "6", "-"]
    assert "undercut, 5" in one
    assert one.split()[-8:] == ["100", "67", "0", "50", "0", "-", "2.5", "1.2"]
    assert "none, 33" in other
    assert other.split()[-3:] == ["2", "2.0", "1.0"]


def test_a_model_that_never_stops_has_no_shares_of_stops(table: xr.Dataset) -> None:
    (row,) = stops.stops(table.sel(track=["first"], height=[0.02]), "step", belt="first")
    assert (row.stopped, row.mechanism, row.of_mechanism) == (0, "", 0)
    assert math.isnan(row.depth)
    line = stops.stops_text([row]).splitlines()[-1]
    assert line.split() == ["first", "step", "10", "10", *["-"] * 14]


def test_gear_wheels_are_compared_with_round_ones_with_intervals(table: xr.Dataset) -> None:
    rows = stops.compare_wheels(table, "step", {"second": "first"}, belt="first")
    assert len(rows) == 4 * len(FIGURES)
    assert [row.wheel for row in rows[:: len(FIGURES)]] == ["round", "gear"] * 2
    by_place = {(row.model, row.wheel, row.figure): row for row in rows}
    for wheel, model, found, count in (("round", "first", 6, 40), ("gear", "second", 1, 39)):
        for name in (model, "all of these"):
            row = by_place[name, wheel, "seized"]
            assert (row.found, row.count) == (found, count)
            assert row.rate == found / count
            # The runs of a repeat, at all heights, share their draws.
            cell = rates_of(table.sel(track=model), "seized", dim=["height", "repeat"])
            bounds = (cell["low"].item(), cell["high"].item())
            assert (row.low, row.high) == pytest.approx(bounds)
    assert by_place["second", "gear", "stopped"].found == 37
    text = stops.wheels_text(rows)
    assert "15 (6 to 32)" in text
    assert text.count("all of these") == 2


def test_the_pairs_differ_in_their_wheels_alone() -> None:
    pairs = gear_pairs(MODELS)
    assert len(pairs) == 4
    for gear, plain in pairs.items():
        ours, theirs = MODELS[gear].track, MODELS[plain].track
        assert isinstance(ours, (c2d.LineOfWheels, c2d.CircumferentialWheels, c2d.HybridWheels))
        assert ours.wheel == c2d.GearWheel()
        assert replace(ours, wheel=c2d.RoundWheel()) == theirs


def test_every_way_to_stop_has_a_replay_and_so_has_a_belt(tmp_path: Path) -> None:
    models = {name: MODELS[name] for name in ("belt", "line of 4, touching", "24 gears all round")}
    design = replace(TINY, heights={"step": (0.06, 0.08), "knife edge": (0.04,)})
    own = Sweeps(design=design, models=models, progress=False)
    tables_of = {name: own.on_obstacle(name) for name in design.heights}
    folder = tmp_path / "replays"
    folder.mkdir()
    (folder / "old.html").write_text("of a former study")
    found = stops.write_replays(tables_of, folder)
    assert sorted(path.name for path in folder.iterdir()) == sorted(replay.file for replay in found)
    ways = {
        (outcome, mechanism)
        for table in tables_of.values()
        for outcome, mechanism in zip(
            table["outcome"].to_numpy().flat, table["mechanism"].to_numpy().flat, strict=True
        )
        if c2d.Outcome(outcome).is_stop
    }
    *stopped, belt = found
    assert {(replay.outcome, replay.mechanism) for replay in stopped} == ways
    assert len(stopped) == len(ways) >= 3
    assert (belt.model, belt.outcome, belt.sentence) == ("belt", "cleared", "")
    for replay in stopped:
        assert replay.sentence.startswith(replay.outcome.replace("_", " "))
        text = (folder / replay.file).read_text(encoding="utf-8")
        assert html.escape(replay.sentence) in text
        assert f"{folder}/{replay.file}" in stops.replays_text(found, str(folder))


def test_odometry_of_round_wheels_is_exact_and_that_of_gears_reads_too_much() -> None:
    rides = {ride.model: ride for ride in tables.rides(sweeps().on_the_flat())}
    assert rides["line of 3"].over_reading == pytest.approx(0.0, abs=1e-4)
    assert rides["line of 3"].vertical_acceleration < 0.01
    assert rides["line of 3 gears"].over_reading > 0.005
    assert rides["line of 3 gears"].vertical_acceleration > 1.0


def test_wheels_that_turn_together_shake_up_and_down_but_do_not_rock() -> None:
    phases = tables.phases(sweeps().over_phases())
    by_place = {(phase.count, phase.phase_fraction): phase for phase in phases}
    for count in (3, 4, 5):
        together, turned = by_place[count, 0.0], by_place[count, 1.0 / 3.0]
        assert together.vertical_acceleration > turned.vertical_acceleration
        assert together.angular_velocity < 0.1 * turned.angular_velocity


def test_the_post_enters_the_slot_of_the_public_wheel_model() -> None:
    runs = tables.public_wheel_model()
    assert {place: str(run.outcome) for place, run in runs.items()} == {
        (0.03, True): "cleared",
        (0.05, True): "seized",
        (0.08, True): "hung_up",
        (0.03, False): "cleared",
        (0.05, False): "seized",
        (0.08, False): "seized",
    }
    found = tables.posts(runs)
    for (height, belly), run in runs.items():
        own = [post for post in found if (post.height, post.belly) == (height, belly)]
        # The last of two slots that it enters equally deep.
        deepest = max(own, key=lambda post: (round(post.depth, 5), post.end))
        first, second = map(int, deepest.bodies.split())
        # A post as high as the wheels' radius ends halfway between the runs of the belt.
        is_halfway = height == 0.08 and not belly
        assert first == second + 1 or (is_halfway and second == first + 1)
        # The belly hangs 50 mm above the ground between the wheels.
        reach = min(height, 0.05) if belly else height
        assert deepest.depth == pytest.approx(reach, abs=1e-3)
        assert run.outcome is not None
        assert (deepest.end == run.metrics["time"]) == run.outcome.is_stop


@pytest.mark.parametrize(
    "names",
    [
        pytest.param(("belt", "line of 3", "line of 4, touching", "line of 3 gears"), id="some"),
        pytest.param(tuple(MODELS), id="all", marks=pytest.mark.soak),
    ],
)
def test_the_quick_study_writes_its_tables_and_its_pictures(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    names: tuple[str, ...],
) -> None:
    models = {name: MODELS[name] for name in names}
    # An edge on which wheels that touch seize.
    design = replace(TINY, heights={**TINY.heights, "knife edge": (0.04,)})
    monkeypatch.setattr(seizure, "QUICK", design)
    monkeypatch.setattr(seizure, "Sweeps", partial(Sweeps, models=models))
    out = tmp_path / "out"
    assert main(["seizure", "--out", str(out)]) == 0
    printed = capsys.readouterr().out
    assert "torque 6.0 N m per sprocket" in printed
    text = (out / "study.txt").read_text(encoding="utf-8")
    assert set(text.splitlines()) <= set(printed.splitlines())
    for name in models:
        assert name in text
    with (out / "rates.csv").open(newline="") as file:
        rates = list(csv.DictReader(file))
    assert len(rates) == len(models) * (3 + len(study_robots()))
    with (out / "runs_step.csv").open(newline="") as file:
        runs = list(csv.DictReader(file))
    assert {run["outcome"] for run in runs} <= {str(outcome) for outcome in c2d.Outcome}
    for row in rates:
        if (row["robot"], row["obstacle"]) == ("preset", "step") and row["height"] == "0.06":
            own = [run for run in runs if run["track"] == row["model"]]
            assert int(row["cleared"]) == sum(run["outcome"] == "cleared" for run in own)
    with (out / "replays.csv").open(newline="") as file:
        replays = list(csv.DictReader(file))
    assert replays
    for replay in replays:
        assert (out / "replays" / replay["file"]).exists()
        assert f"{out}/replays/{replay['file']}" in text
    assert "Gear wheels beside round ones on steps" in text
    for picture in ("rates.png", "phases.png", "posts.png"):
        assert (out / picture).stat().st_size > 10_000
    # The answer comes first.
    assert text.index("Greatest height [mm]") < text.index("other outcomes")

    assert main(["stops", "--out", str(tmp_path / "stops")]) == 0
    for name in ("stops.csv", "gear_against_round.csv", "replays.csv"):
        assert (tmp_path / "stops" / name).read_bytes() == (out / name).read_bytes()
    assert "Runs to look at" in (tmp_path / "stops" / "stops.txt").read_text(encoding="utf-8")


def test_ctrl_c_ends_the_study_with_its_own_exit_code(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted(_sweeps: Sweeps, _obstacle: str) -> xr.Dataset:
        raise c2d.BatchInterrupted([])

    monkeypatch.setattr(Sweeps, "on_obstacle", interrupted)
    assert main(["seizure", "--out", str(tmp_path)]) == 130
    assert "Traceback" not in capsys.readouterr().err


def test_our_models_stand_below_their_row_of_the_paper(table: xr.Dataset) -> None:
    models = {"first": MODELS["line of 3"], "second": MODELS["24 gears all round"]}
    climbs = [climb for obstacle in QUICK.heights for climb in tables.climbs(table, obstacle)]
    lines = tables.paper_text(models, climbs).splitlines()
    below = {line.split("  ")[0]: following for line, following in itertools.pairwise(lines)}
    assert "ours: first" in below["LWA, large standard fixed wheels"]
    assert "ours: second" in below["CWA, small gear wheels"]


def test_the_pictures_have_a_panel_a_model_and_a_line_a_count(table: xr.Dataset) -> None:
    cells = [*tables.cells(table, "step"), *tables.cells(table, "barrier")]
    first, second = tables.plot_rates(cells).axes
    assert (first.get_title(), second.get_title()) == ("first", "second")
    assert len(first.lines) == 2
    phases = [
        tables.Phase(count=count, phase_fraction=f, vertical_acceleration=1.0, angular_velocity=0.1)
        for count in (3, 4, 5)
        for f in (0.0, 0.5, 1.0)
    ]
    for ax in tables.plot_phases(phases).axes:
        assert len(ax.lines) == 3 + 1  # the last marks eq. (1)
