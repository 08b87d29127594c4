"""The same scenario in both engines: ends, time of separation, and statics."""

import math
import pickle
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.track import Track
from crawler2d.results.findings import Balance, Pull
from crawler2d.runs import cross_check
from crawler2d.runs.cross_check import STUDY, CrossCheck, agreement_of, compare_engines
from tests.shared import ROBOT, refused

STEP = c2d.terrains.step
SEIZING = c2d.Scenario(ROBOT.with_track(c2d.LineOfWheels(4)), STEP(0.10), duration=6.0)
STEADY = SEIZING.replace({"terrain": c2d.terrains.flat(), "duration": 1.0})


@pytest.fixture(scope="module")
def seized() -> c2d.Run:
    return c2d.simulate(SEIZING)


@pytest.fixture(scope="module")
def check(seized: c2d.Run) -> CrossCheck[c2d.Run]:
    return seized.cross_check(announce=False)


def test_round_wheels_stop_in_the_same_place(check: CrossCheck[c2d.Run]) -> None:
    assert check.run.outcome is check.other.outcome is c2d.Outcome.SEIZED
    assert check.same_outcome
    # Both strike the edge at the same speed; contacts of rapier are softer, by 0.02 mm in the end.
    assert check.distance < 1e-3
    assert abs(check.turn) < 1e-3


def test_scenarios_of_both_engines_differ_in_the_solver_only(check: CrossCheck[c2d.Run]) -> None:
    assert check.other.scenario == SEIZING.replace({"solver": c2d.Solver(engine="rapier")})
    back = check.other.cross_check()
    assert back.other.scenario == SEIZING
    assert (back.distance, back.turn) == (check.distance, -check.turn)
    assert np.array_equal(back.other.position, check.run.position)


@pytest.mark.parametrize("solver", [{"restitution": 0.5}, {"contact_frequency": 500.0}])
def test_a_setting_that_the_other_engine_does_not_hold_is_refused(solver: dict[str, Any]) -> None:
    run = c2d.simulate(STEADY.replace({"solver": c2d.Solver(**solver)}))
    assert refused(lambda: run.cross_check(announce=False)).path == f"solver.{next(iter(solver))}"


def test_each_stop_is_an_equilibrium_up_to_some_friction(
    check: CrossCheck[c2d.Run],
) -> None:
    highest = []
    for balance in check.balances:
        assert balance is not None
        assert balance.holds
        assert balance.pulls == ()
        assert balance.holds_between is not None
        low, high = balance.holds_between
        assert low < 1.0 < high
        highest.append(high)
    # Poses 0.02 mm apart; the search for the limit ends within some parts in ten thousand.
    assert highest[0] == pytest.approx(highest[1], rel=0.01)


def test_forces_of_the_stops_bear_the_robot(check: CrossCheck[c2d.Run]) -> None:
    weight = SEIZING.robot.mass * SEIZING.gravity
    for prefix in ("", "other_"):
        # A stop at rest: the rest is rounding of means over a window.
        assert check.forces[f"{prefix}force_y"].sum() == pytest.approx(weight, rel=1e-3)
        assert abs(check.forces[f"{prefix}force_x"].sum()) < 1e-3 * weight
    ours, theirs = check.forces["force_y"], check.forces["other_force_y"]
    assert ours == pytest.approx(theirs, abs=0.01 * weight)


def test_paths_part_at_the_first_sample_that_is_more_than_a_millimetre_apart(
    check: CrossCheck[c2d.Run],
) -> None:
    # Both were recorded every 10 ms, so that their samples are at the same times.
    count = min(check.run.time.size, check.other.time.size) - 1
    apart = np.hypot(*(check.run.position[:count] - check.other.position[:count]).T)
    assert check.parted_at == check.run.time[np.flatnonzero(apart > 1e-3)[0]]


def test_on_level_ground_paths_do_not_part() -> None:
    check = c2d.simulate(STEADY).cross_check()
    assert check.parted_at is None
    assert check.distance < 1e-4  # slip of wheels at the start in softer contacts
    assert check.balances == (None, None)
    assert len(check.forces) == 0
    assert "stay within 1 mm" in str(check)


def test_a_run_of_another_build_is_simulated_again(seized: c2d.Run) -> None:
    earlier = pickle.loads(pickle.dumps(seized))
    earlier.build = {**seized.build, "build_id": "an earlier one"}
    for run in (seized, earlier):
        scenarios: list[Scenario] = []

        def simulate(scenario: Scenario, scenarios: list[Scenario] = scenarios) -> c2d.Run:
            scenarios.append(scenario)
            return seized

        check = compare_engines(run, simulate, announce=False)
        assert check.run is seized
        engines = [scenario.solver.engine for scenario in scenarios]
        assert engines == (["rapier"] if run is seized else ["rapier", "own"])


def test_a_check_says_when_a_run_cleared_and_not_when_it_ended() -> None:
    run = c2d.simulate(SEIZING.replace({"terrain.height": 0.03}))
    assert run.metrics["time"] > run.metrics["time_to_clear"] + 0.4
    text = str(compare_engines(run, lambda _: run, announce=False))
    assert f": cleared after {run.metrics['time_to_clear']:.2f} s" in text


def test_a_run_that_did_not_stop_has_neither_balance_nor_forces(seized: c2d.Run) -> None:
    check = compare_engines(
        seized, lambda other: c2d.simulate(other.replace({"duration": 1.0})), announce=False
    )
    assert not check.same_outcome
    assert check.balances[0] is not None
    assert check.balances[1] is None
    assert np.isfinite(check.forces["force_y"]).all()
    assert np.isnan(check.forces["other_force_y"]).all()
    assert "rapier: timed out after 1.00 s." in str(check)


def test_a_run_without_history_is_checked_alike(check: CrossCheck[c2d.Run]) -> None:
    def simulate(scenario: c2d.Scenario) -> c2d.Run:
        return check.other if scenario == check.other.scenario else c2d.simulate(scenario)

    bare = c2d.simulate(SEIZING, record="summary")
    other = compare_engines(bare, simulate, announce=False)
    assert (other.distance, other.turn, other.parted_at) == (
        check.distance,
        check.turn,
        check.parted_at,
    )
    assert str(other) == str(check)


def test_a_sentence_says_who_stopped_where_and_what_holds(
    check: CrossCheck[c2d.Run],
) -> None:
    said = str(check)
    assert said.startswith("crawler2d's own dynamics: seized at x = ")
    assert "; rapier: seized at x = " in said
    assert "The paths first part by 1 mm at " in said
    assert "an equilibrium up to 1.36 times the friction" in said


def test_scenarios_that_rapier_cannot_simulate_are_refused_by_field() -> None:
    belt = c2d.simulate(ROBOT.with_track(c2d.BeltTrack()), STEP(0.02), duration=0.1)
    error = refused(belt.cross_check)
    assert error.path == "robot.track.kind"
    assert "solver.engine" in error.rule


def test_branches_and_runs_without_a_result_are_refused(seized: c2d.Run) -> None:
    branch = seized.branch(at=1.0, duration=0.1)
    assert "take the original run" in refused(branch.cross_check).rule
    diverged = c2d.Run(SEIZING, {}, c2d.SimulationDiverged("chassis is not finite"))
    assert "not finite" in refused(diverged.cross_check).rule


def test_branches_of_a_run_in_rapier_are_moved_by_our_own_dynamics() -> None:
    coarse = c2d.Solver(engine="rapier", time_step=1e-3)  # which takes an eighth of the time
    run = c2d.simulate(SEIZING.replace({"solver": coarse}))
    branch = run.branch(track=c2d.BeltTrack())
    assert branch.outcome is c2d.Outcome.CLEARED
    solver = branch.scenario.solver
    assert (solver.engine, solver.time_step) == ("own", run.scenario.solver.time_step)
    assert run.what_if(track="closed").run.scenario.solver.engine == "own"
    assert run.branch(at=1.0, duration=0.1).scenario.solver.engine == "own"


def test_engines_are_swept_like_any_field() -> None:
    how: Any = {"repeats": 2, "threads": 1, "progress": False}
    own, rapier = (c2d.Solver(engine=engine, time_step=1e-3) for engine in ("own", "rapier"))
    steady = STEADY.replace({"solver": own})
    found = c2d.sweep(steady, {"solver.engine": ["own", "rapier"]}, **how)
    compared = c2d.compare(steady, {"own": {}, "rapier": rapier}, **how)
    for table in (found, compared):
        assert set(table["outcome"].values.ravel()) == {"timed_out"}
        of_own, of_rapier = table["final_x"].values.reshape(2, 2)
        assert (of_own != of_rapier).all()
        assert of_own == pytest.approx(of_rapier, abs=1e-3)  # softer contacts, as above


def test_a_pose_out_of_equilibrium_is_reported() -> None:
    pull = Pull(body=2, point=(0.1, 0.2), force=22.4)
    none = Balance(imbalance=0.123, tolerance=1e-3, holds_between=None, pulls=(pull,))
    assert not none.holds
    assert str(none) == (
        "no equilibrium: the smallest residual is 12 % of the weight; body 2 would have to pull "
        "with 22 N; no friction from 0.02 to 5 times makes it one"
    )
    later = Balance(imbalance=0.1, tolerance=1e-3, holds_between=(1.4, math.inf), pulls=())
    assert str(later).endswith("it would be one from 1.40 times the friction on")
    both = Balance(imbalance=0.0, tolerance=1e-3, holds_between=(0.0, math.inf), pulls=())
    assert str(both) == "an equilibrium at any friction tried"


ROUND = c2d.CircumferentialWheels(24)
GEARED = c2d.GearWheel(grouser_count=12)


@pytest.mark.parametrize(
    ("track", "models", "figures"),
    [
        (c2d.LineOfWheels(6), 4, (512, 512, 344, 344)),
        (c2d.LineOfWheels(4, wheel=GEARED), 2, (256, 252, 160, 162)),
        (ROUND, 1, (128, 102, 60, 60)),
        (c2d.CircumferentialWheels(24, wheel=c2d.GearWheel()), 1, (128, 93, 49, 70)),
        (c2d.CircumferentialWheels(16, wheel_radius=0.012), 1, (128, 128, 16, 16)),
        (c2d.HybridWheels(((0.0, 0.0, 0.06),)), 1, (128, 126, 18, 16)),
        (c2d.ForceTrack(), 2, (256, 256, 64, 64)),
        (c2d.CircumferentialWheels(16, wheel_radius=0.012, wheel=GEARED), 0, (0, 0, 0, 0)),
    ],
)
def test_a_check_says_how_often_both_engines_ended_alike_with_such_a_model(
    track: Track, models: int, figures: tuple[int, ...]
) -> None:
    found = agreement_of(ROBOT.with_track(track))
    assert len(found.models) == models
    assert (found.runs, found.agreeing, found.own, found.rapier) == figures
    said = f"{found.agreeing} of {found.runs} runs" if models else "not studied"
    assert said in str(found)


def test_figures_of_the_agreement_are_those_of_its_page() -> None:
    page = (Path(__file__).parents[2] / "docs" / "studies" / "agreement.md").read_text("utf-8")
    table = page.partition("<!-- study -->")[2].partition("<!-- end of study -->")[0]
    rows = [
        [cell.strip() for cell in row.split("|")[1:-1]] for row in table.split("\n") if "|" in row
    ]
    found = {
        row[0]: (int(row[1]), int(row[2]), *map(int, row[4].split(",")))
        for row in rows[2:]
        if row[0] != "all"
    }
    assert found == STUDY


def test_a_check_ends_with_the_counts_of_both_engines(check: CrossCheck[c2d.Run]) -> None:
    assert str(check).endswith("344 got over in crawler2d's own dynamics, 344 in rapier.")


def test_a_check_says_before_it_starts_how_long_it_will_take(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """24 round wheels took 0.02 s here and 23 s in rapier, without a message."""
    run = c2d.simulate(STEADY.replace({"robot.track": ROUND, "duration": 30.0}), goal=0.0)
    told: list[tuple[float, float]] = []

    def stop(likely: float, most: float) -> None:
        told.append((likely, most))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run.cross_check(announce=stop)
    ((likely, most),) = told
    assert most == pytest.approx(likely * 30.0 / run.metrics["time"])
    # What rapier needs for a fifth of a second, judged by a tenth; others use the machine, too.
    begin = time.perf_counter()
    c2d.simulate(run.scenario.replace({"solver": c2d.Solver(engine="rapier"), "duration": 0.2}))
    took = time.perf_counter() - begin
    assert took / 4.0 < most * 0.2 / 30.0 < took * 4.0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(("most", "is_told"), [(1.0, False), (20.0, True)])
def test_only_long_checks_are_announced(
    most: float, is_told: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    cross_check._announce("rapier", 1.0, most)
    said = capsys.readouterr().err
    assert said == (
        "cross_check: rapier will take about 1 s if its run ends when this one did,"
        " up to about 20 s if it lasts\n"
        if is_told
        else ""
    )


def test_an_invalid_announcement_is_refused_by_name(seized: c2d.Run) -> None:
    wrong: Any = "yes"
    with pytest.raises(c2d.ScenarioError, match=r"^announce must be"):
        seized.cross_check(announce=wrong)
