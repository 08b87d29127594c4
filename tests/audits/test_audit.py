"""An audit from end to end, on a robot with a known seizure, and its arguments."""

import json
import math
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import stats  # type: ignore[import-untyped]

import crawler2d as c2d
from crawler2d.audits import words
from crawler2d.audits.runs import LivePrinter, scenario_of
from crawler2d.audits.text import plain_of
from crawler2d.audits.verdicts import least_samples, proportion_of
from crawler2d.audits.words import repair_sentence, wheels_per_side, worst_rates
from crawler2d.errors import LimitError
from crawler2d.sweeps.statistics import wilson
from tests.audits.seizing import QUIET, SAID, SEIZING, STEP
from tests.kept import refusing
from tests.reading.carts import FILES, WHEELS, quietly, read, urdf


def test_touching_wheels_seize_on_a_step_that_the_belt_clears(found: c2d.Audit) -> None:
    (verdict,) = found.verdicts
    assert found.seizes
    assert (verdict.result, verdict.outcome, verdict.belt_outcome) == (
        "seizes",
        "seized",
        "cleared",
    )
    assert (verdict.seized.rate, verdict.belt_cleared.rate) == (1.0, 1.0)
    assert (verdict.jam_wheels, verdict.carrier) == ("1-2", "chassis")
    assert found.belt.reason == "BeltTrack, along the outline"


def test_a_closed_track_and_friction_free_it_and_torque_does_not(found: c2d.Audit) -> None:
    freed = {each.trial: each.freed for each in found.verdicts[0].freed}
    assert freed["closed track"] == freed["friction x 2"] == 9
    assert freed["torque x 2"] == 0


def test_a_fifth_wheel_is_the_smallest_repair(found: c2d.Audit) -> None:
    best = found.repairs[0]
    assert (best.kind, best.confirmed, best.change, best.wheels) == ("wheels", True, 1, 5)
    assert best.robot.track == c2d.LineOfWheels(5, wheel_radius=0.0608)
    assert replace(best.robot, track=SEIZING.track) == SEIZING
    assert best.seized["step of 75 mm"].rate == 0.0


def test_a_belt_is_a_repair_and_gears_are_tried(found: c2d.Audit) -> None:
    by_kind = {each.kind: each for each in found.repairs}
    assert set(by_kind) == {"wheels", "gears", "belt"}
    assert by_kind["belt"].confirmed
    assert by_kind["belt"].wheels == 0
    assert by_kind["gears"].seized["step of 75 mm"].rate == 0.0
    assert all(each.speed > 0.0 for each in found.repairs)


def test_repairs_are_confirmed_by_runs_that_the_search_has_not_had(found: c2d.Audit) -> None:
    assert found.repaired is not None
    fresh = set(found.repaired.table["scenario"].values.ravel().tolist())
    assert fresh & set(found.table["scenario"].values.ravel().tolist()) == {""}  # none was made


def test_the_table_has_the_runs_behind_the_verdicts(found: c2d.Audit) -> None:
    assert dict(found.table.sizes) == {"model": 2, "terrain": 1, "sample": 20, "repeat": 1}
    assert "start.approach" in found.table.attrs["vary"]
    ends = found.table["outcome"].sel(model="model")
    assert (ends == "seized").sum().item() == found.verdicts[0].jam_counts[1]


def test_an_obstacle_is_left_as_soon_as_its_verdict_is_certain(found: c2d.Audit) -> None:
    """The first nine runs seize while the belt clears, so the other eleven change nothing."""
    assert (found.table["outcome"] != "").sum("sample").values.ravel().tolist() == [9, 9]
    (verdict,) = found.verdicts
    assert verdict.seized.runs == verdict.belt_cleared.runs == 9
    assert (verdict.seized.low, verdict.seized.high) == c2d.sequential(9, 9)[1:]


def test_a_part_of_the_runs_is_the_same_as_in_an_audit_of_that_many(found: c2d.Audit) -> None:
    few = c2d.audit(SEIZING, STEP, unknown={}, repeats=9, repair=False, **QUIET)
    made = found.table.isel(sample=slice(9))
    for name in ("outcome", "final_x", "drawn_height", "speed"):
        assert np.array_equal(made[name].values, few.table[name].values)


def test_repeats_of_a_robot_are_all_made() -> None:
    unknown = {"robot.mass": c2d.scaled(0.99, 1.01)}
    found = c2d.audit(SEIZING, STEP, unknown=unknown, samples=4, repeats=2, repair=False, **QUIET)
    assert (found.table["outcome"] != "").all()


def test_the_belt_does_not_drive_where_the_robot_clears() -> None:
    good = SEIZING.with_track(c2d.LineOfWheels(5, wheel_radius=0.0608))
    found = c2d.audit(good, STEP, unknown={}, repeats=36, **QUIET)
    assert (found.table["outcome"].sel(model="belt") == "").all()
    assert (found.table["outcome"].sel(model="model") == "cleared").all()
    row = next(line for line in str(found).splitlines() if line.startswith("  step of 75 mm"))
    assert row.split()[-5:] == ["-", "cleared", "does", "not", "seize"]
    assert "it clears 1 of 1 obstacles in at least 95 %" in found.summary


def test_facts_known_before_the_runs_are_shown_before_them() -> None:
    printed: list[str] = []

    class Recorder(LivePrinter):
        def print(self, text: str) -> None:
            printed.append(text)

        def __call__(self, done: int, total: int) -> None:
            assert done <= total
            printed.append("a run")

    steps = {**STEP, "kerb": c2d.terrains.step(0.03, edge_radius=0.02)}
    how: Any = {"samples": 3, "repair": False}
    found = c2d.audit(SEIZING, steps, **how, progress=Recorder(sys.stdout))
    assert "Lint: nothing found" in printed[0]
    assert "3 slots" in printed[0]
    first = next(index for index, text in enumerate(printed) if text.startswith("  step of 75 mm"))
    assert "a run" in printed[1:first]
    assert "a run" in printed[first:]
    assert "\n".join(text for text in printed if text != "a run") == found.summary


def test_a_quick_audit_has_fewer_samples_and_tries_round_wheels_alone() -> None:
    start = c2d.variability.of_start()
    found = c2d.audit(SEIZING, STEP, vary=start, quick=True, repeats=1, **QUIET)
    assert found.table.sizes["sample"] == 36
    assert {each.kind for each in found.repairs} == {"wheels", "belt"}
    assert {each.trial for each in found.verdicts[0].freed} <= {
        "closed track",
        "closed track, clear of the ground",
    }


@pytest.mark.parametrize(
    ("name", "value"),
    [("samples", 0), ("repeats", 0), ("threads", 0), ("repair", 1), ("quick", "no")],
)
def test_bad_numbers_are_refused_before_anything_is_shown(
    name: str, value: Any, capsys: Any
) -> None:
    bad: Any = {name: value}
    with pytest.raises((c2d.ScenarioError, LimitError), match=name):
        c2d.audit(SEIZING, STEP, **bad)
    assert capsys.readouterr() == ("", "")


def test_runs_take_a_tenth_a_third_and_all_of_the_speed_in_turn(found: c2d.Audit) -> None:
    assert found.repaired is not None
    top = 0.2 * math.sqrt(9.81 * 0.365)
    for table in (found.table, found.repaired.table):
        speeds = np.unique(table["speed"].values, return_counts=True)
        assert speeds[0] == pytest.approx([0.1 * top, top / 3.0, top], abs=1e-3)
        assert speeds[1].tolist() == [7, 7, 6]
        own = table.isel(model=0, terrain=0)
        assert own["drawn_speed"].values == pytest.approx(own["speed"].values, rel=0.03)
        usual = scenario_of(SEIZING, STEP["step of 75 mm"], None, None).duration
        times = (top / own["speed"].values + 2.0) / 3.0  # 4, 5/3 and 1
        assert own["drawn_duration"].values == pytest.approx(usual * times, rel=0.02)
        heights = own["drawn_height"].values
        assert 0.95 * 0.075 <= heights.min() < 0.97 * 0.075
        assert 1.03 * 0.075 < heights.max() <= 1.05 * 0.075
    said = "0.038, 0.126 and 0.378 m/s in turn, obstacle sizes times 0.95 to 1.05"
    text = " ".join(repr(found).split())
    assert f"Verdicts: at most 20 runs, at {said}" in text
    assert f"in new runs at {said}" in text
    assert found.repairs[0].seized_at["step of 75 mm"][0.038].rate == 0.0


def test_a_robot_that_seizes_only_when_it_is_slow_is_found_to_seize() -> None:
    edge = {"knife edge": c2d.terrains.barrier(0.0256, 0.0064)}
    how: Any = {"unknown": {}, "repeats": 12, "repair": False, **QUIET}
    (verdict,) = c2d.audit(SEIZING, edge, **how).verdicts
    assert [share.rate for share in verdict.seized_at.values()] == [1.0, 1.0, 0.0]
    assert verdict.result == "seizes"
    fast = c2d.variability.of_start() | c2d.variability.of_contact()
    (alone,) = c2d.audit(SEIZING, edge, vary=fast, **how).verdicts
    assert list(alone.seized_at) == [0.378]
    assert alone.seized.rate == 0.0


def test_a_schedule_of_speeds_is_driven_as_it_is() -> None:
    drive = c2d.Drive(speed=0.3, schedule=((1.0, 0.2),))
    found = c2d.audit(SEIZING, STEP, samples=3, repeats=1, repair=False, drive=drive, **QUIET)
    assert np.unique(found.table["speed"].values).tolist() == [0.3]
    assert "drawn_duration" not in found.table


def test_an_error_of_lint_stands_above_the_verdict() -> None:
    outline = replace(SEIZING.outline, axle_distance=3.65, front_radius=0.64, rear_radius=0.64)
    large = replace(SEIZING, outline=outline, moment_of_inertia=30.0, belly=None)
    large = large.with_track(c2d.LineOfWheels(4))
    how: Any = {"samples": 2, "repeats": 1, "repair": False, "duration": 0.1}
    found = c2d.audit(large, STEP, **how, **QUIET)
    said = "Lint has errors (size): the verdict holds for the robot as it is given"
    lines = found.summary.splitlines()
    assert lines[1].startswith(said)
    assert words.conclusion(found)[0].startswith(said)
    assert said in found.to_html()


def test_a_warning_of_a_later_draw_comes_after_the_runs(capsys: pytest.CaptureFixture[str]) -> None:
    """The friction of the second sample is above 3, which is usual at most."""
    few: Any = {"samples": 3, "repeats": 1, "seed": 0, "duration": 0.1, "repair": False}
    found = c2d.audit(SEIZING, STEP, **few, unknown={"terrain.friction": c2d.uniform(0.5, 6.0)})
    (finding,) = found.lint
    assert finding.message.startswith("terrain.friction is usually at most 3")
    shown = capsys.readouterr().err.split("step of 75 mm", maxsplit=1)[1]
    assert "Lint, warnings during the runs\n  warning, other: terrain.friction is usually" in shown


def test_without_an_error_of_lint_nothing_stands_above_the_verdict(found: c2d.Audit) -> None:
    assert "Lint has errors" not in found.summary


def test_the_short_form_has_every_result(found: c2d.Audit) -> None:
    text = repr(found)
    for part in (
        "step of 75 mm  9     0 % (0-53)      100 % (47-100)  100 %        seized        seizes",
        "step of 75 mm  1-2 of the chassis  9/9",
        "It seizes on 1 of 1 obstacles where the belt clears: step of 75 mm.",
        "confirmed: chassis: 5 wheels in place of 4",
        "Lint: nothing found",
        "not a verdict",
    ):
        assert part in text
    assert text == str(found) == found.summary
    assert max(map(len, text.splitlines())) <= 120


def test_as_plain_data_it_is_json(found: c2d.Audit) -> None:
    plain = json.loads(json.dumps(plain_of(found), allow_nan=False))
    assert plain["seizes"] is True
    assert plain["verdicts"][0]["result"] == "seizes"
    assert plain["repairs"][0]["robot"]["track"]["count"] == 5
    assert plain["pockets"][0]["depth"] is None  # a slot has no bottom


def test_a_robot_that_does_not_seize_is_not_repaired() -> None:
    good = SEIZING.with_track(c2d.LineOfWheels(5, wheel_radius=0.0608))
    found = c2d.audit(good, STEP, unknown={}, repeats=40, **QUIET)
    assert not found.seizes
    assert found.repaired is None
    assert found.repairs == ()
    assert found.verdicts[0].result == "does not seize"
    assert "It was not found to seize" in found.summary


def test_repairs_can_be_left_out() -> None:
    found = c2d.audit(SEIZING, STEP, unknown={}, repeats=2, repair=False, **QUIET)
    assert found.seizes
    assert found.repaired is None


def test_a_robot_on_belts_is_its_own_belt() -> None:
    found = c2d.audit(c2d.robots.engineer(flippers=None), STEP, samples=2, repeats=1, **QUIET)
    assert found.belt.robot == found.robot
    assert found.pockets == ()
    assert found.belt.reason == "the robot itself, which is on belts"


def test_equal_calls_give_equal_audits() -> None:
    pair = [c2d.audit(SEIZING, STEP, samples=3, repeats=1, repair=False, **QUIET) for _ in "ab"]
    assert pair[0].verdicts == pair[1].verdicts
    assert pair[0].table["final_x"].identical(pair[1].table["final_x"])


def test_unknowns_given_by_the_user_are_drawn() -> None:
    unknown = {"robot.mass": c2d.scaled(0.9, 1.1)}
    found = c2d.audit(SEIZING, STEP, unknown=unknown, samples=2, repeats=1, repair=False, **QUIET)
    assert "unknown_mass" in found.table
    assert "unknown_friction" not in found.table


@pytest.mark.parametrize(
    ("unknown", "many"),
    [
        (
            {"robot.drivetrain.max_torque": c2d.uniform(3.0, 6.0)},
            "2 samples of the robot, 1 run each",
        ),
        ({"terrain.friction": c2d.uniform(0.5, 1.0)}, "2 samples of the floor, 1 run each"),
    ],
)
def test_only_values_that_differ_are_reported_as_drawn(unknown: Any, many: str) -> None:
    few = c2d.audit(SEIZING, STEP, unknown=unknown, samples=2, repair=False, **QUIET)
    assert f"Verdicts: at most {many}" in str(few)


def test_columns_stand_below_their_heads_whatever_the_obstacles_are_called() -> None:
    grounds = {"s": c2d.terrains.step(0.02)}
    few = c2d.audit(SEIZING, grounds, unknown={}, vary={}, repair=False, **QUIET)
    lines = str(few).splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith("  obstacle"))
    columns = [(found.start(), found[0]) for found in re.finditer(r"\S+(?: \S+)*", lines[at + 1])]
    assert columns[1] == (lines[at].index("runs"), "1")
    assert columns[-1] == (lines[at].index("verdict"), few.verdicts[0].result)


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ({"vary": {}}, "at 0.378 m/s"),
        ({"vary": {"drive.speed": c2d.uniform(0.1, 0.4)}}, "at 0.1 to 0.4 m/s"),
        ({"vary": c2d.variability.of_contact()}, "at 0.378 m/s, times 0.98 to 1.02"),
        ({"vary": {"drive.speed": stats.norm(0.3, 0.01)}}, "at norm(0.3, 0.01)"),
        (
            {"drive": c2d.Drive(schedule=((0.0, 0.3),))},
            "at the speeds of its schedule, obstacle sizes times 0.95 to 1.05",
        ),
    ],
)
def test_an_audit_says_at_which_speeds_it_drove(how: Any, said: str) -> None:
    few = c2d.audit(SEIZING, STEP, unknown={}, repair=False, **how, **QUIET)
    assert f"Verdicts: at most 1 run, {said}; 95 % intervals" in " ".join(str(few).split())


def test_terrains_of_a_users_own_keep_their_friction() -> None:
    found = c2d.audit(SEIZING, STEP, samples=2, repeats=1, repair=False, **QUIET)
    assert "terrain.friction" not in found.unknown
    assert "robot.center_of_mass[0]" in found.unknown


@pytest.mark.usefixtures("one_obstacle")
def test_the_floor_of_the_standard_obstacles_is_not_known() -> None:
    found = c2d.audit(SEIZING, samples=2, repeats=1, repair=False, **QUIET)
    assert "terrain.friction" in found.unknown


def test_a_store_keeps_the_runs(tmp_path: Path) -> None:
    made: list[int] = []
    how: Any = {"samples": 2, "repeats": 1, "repair": False, "store": tmp_path / "runs.sqlite"}
    for _ in range(2):
        c2d.audit(SEIZING, STEP, **how, progress=lambda done, _: made.append(done))
    assert made.count(4) >= 2
    assert len(c2d.table(tmp_path / "runs.sqlite")["outcome"]) == 4


def test_each_of_300_runs_on_a_step_field_meets_a_field_of_its_own_as_does_the_belt() -> None:
    fields = {"step field": c2d.terrains.random_stepfield(0)}
    how: Any = {"samples": 150, "repeats": 2, "duration": 0.1, "repair": False}
    table = c2d.audit(SEIZING, fields, **how, **QUIET).table
    seeds = table["drawn_terrain_seed"]
    own, belt = (seeds.sel(model=name).values.ravel() for name in ("model", "belt"))
    assert len(set(own.tolist())) == 300
    assert own.tolist() == belt.tolist()


# Bad input


@pytest.mark.parametrize(
    ("arguments", "how", "path"),
    [
        ((3.0,), {}, "robot"),
        ((SEIZING, {}), {}, "obstacles"),
        ((SEIZING, {"a": 1.0}), {}, "obstacles['a']"),
        ((SEIZING, {1: c2d.terrains.step(0.1)}), {}, "obstacles"),
        ((SEIZING, {"level ground": c2d.terrains.step(0.1)}), {}, "obstacles"),
        ((SEIZING, STEP), {"engine": "gz"}, "engine"),
        ((SEIZING, STEP), {"samples": 0}, "samples"),
        ((SEIZING, STEP), {"repeats": 0}, "repeats"),
        ((SEIZING, STEP), {"seed": -1}, "seed"),
        ((SEIZING, STEP), {"drive": 0.4}, "drive"),
        ((SEIZING, STEP), {"drive": c2d.Drive(speed=0)}, "drive.speed"),
        ((SEIZING, STEP), {"drive": c2d.Drive(speed=0, schedule=((1, 0),))}, "drive.speed"),
        ((SEIZING, STEP), {"duration": -1.0}, "duration"),
        ((FILES / "cart.urdf",), {"engines": "gz"}, "engines"),
        ((FILES / "cart.urdf",), {"engine": "ode"}, "engine"),
        (("no_such_file.sdf",), {}, ""),
    ],
)
def test_bad_input_is_refused(arguments: Any, how: Any, path: str) -> None:
    with refusing(SAID) as caught:
        c2d.audit(*arguments, **{**QUIET, **how})
    assert path in caught.value.path


def test_reading_an_audited_file_is_quiet() -> None:
    """Warnings of the reader are in the lint and not issued: warnings are errors here."""
    assert quietly(FILES / "cart.urdf").warnings == ()


@pytest.mark.usefixtures("one_obstacle")
@pytest.mark.parametrize("how", [{"engine": "isaac"}, {"ground_friction": 0.4}])
def test_a_reading_is_audited_as_it_was_read(how: Any) -> None:
    path = FILES / "cart.urdf"
    # Only robots and grounds differ, from the start.
    few: Any = {"samples": 2, "repeats": 1, "duration": 0.5, "repair": False, **QUIET}
    reading = quietly(path, **how)
    of_file, of_reading = c2d.audit(path, **few, **how), c2d.audit(reading, **few)
    assert of_reading.reading is reading
    assert plain_of(of_reading) == plain_of(of_file)
    assert of_reading.call == of_file.call
    assert of_reading.call.reading == how


def test_a_reading_is_not_read_again(tmp_path: Path) -> None:
    """Nor for its friction on other floors: its file may be gone."""
    reading = read(tmp_path, urdf(WHEELS))
    (tmp_path / "cart.urdf").unlink()
    few: Any = {"samples": 1, "repeats": 1, "duration": 0.1, "repair": False, **QUIET}
    assert c2d.audit(reading, **few).reading is reading
    with refusing(SAID, "engine must not be given without a file"):
        c2d.audit(reading, engine="gz")


def test_a_belt_is_no_count_of_wheels(found: c2d.Audit) -> None:
    assert "0 wheels a side" not in found.summary
    for each in found.repairs:
        expected = "belt" if each.kind == "belt" else f"{each.wheels} wheels a side"
        assert wheels_per_side(each) == expected
    assert any(each.kind == "belt" for each in found.repairs)


def test_a_repair_is_as_good_as_on_the_obstacle_that_it_clears_least(found: c2d.Audit) -> None:
    all_runs = np.ones((20, 1), bool)
    every_other = np.arange(20)[:, None] % 2 == 0
    often, seldom = (proportion_of(cleared, all_runs) for cleared in (all_runs, every_other))
    repair = replace(found.repairs[0], cleared_given_belt={"gap": often, "step": seldom})
    assert worst_rates(repair)[0] == seldom


def test_a_repair_without_belt_runs_to_compare_with_says_so(found: c2d.Audit) -> None:
    repair = found.repairs[0]
    none = proportion_of(np.zeros((20, 1), bool), np.zeros((20, 1), bool))
    alone = replace(repair, cleared_given_belt={**repair.cleared_given_belt, "gap 90 mm": none})
    assert worst_rates(alone)[0] == none
    text = repair_sentence(alone)
    assert "the belt clears none of the new runs on gap 90 mm (0 to compare with)" in text
    assert "nan" not in text
    assert found.repaired is not None
    changed = replace(found, repaired=found.repaired._replace(repairs=(alone,)))
    assert "none of the new runs on gap 90 mm" in changed.summary
    assert "none of the new runs on gap 90 mm" in changed.to_html()


def test_an_audit_says_when_runs_are_too_few_to_show_no_seizure(found: c2d.Audit) -> None:
    least = least_samples()
    assert wilson(0, least).high < 0.10 <= wilson(0, least - 1).high
    assert found.table["outcome"].size < 2 * least  # of the model and its belt
    assert f'"does not seize" takes {least} or more' in str(found)


@pytest.mark.parametrize("argument", ["vary", "unknown"])
def test_a_field_that_a_later_obstacle_lacks_is_refused_before_any_run(argument: str) -> None:
    obstacles: Any = {"step": c2d.terrains.step(0.03), "gap": c2d.terrains.gap(0.1)}
    given: Any = {"unknown": {}, argument: {"terrain.height": c2d.scaled(0.9, 1.1)}}
    made: list[int] = []
    with pytest.raises(c2d.ScenarioError, match=r"terrain=gap\].terrain.height must be a known"):
        c2d.audit(SEIZING, obstacles, progress=lambda done, _: made.append(done), **given)
    assert not made


@pytest.mark.parametrize(("argument", "runs"), [("vary", 9), ("unknown", 1)])
def test_a_field_of_the_obstacle_is_drawn_where_repairs_are_searched(
    argument: str, runs: int
) -> None:
    """Repairs are timed on level ground, which has no height."""
    given: Any = {"unknown": {}, argument: {"terrain.height": c2d.scaled(0.98, 1.02)}}
    found = c2d.audit(SEIZING, STEP, samples=9, repeats=runs, quick=True, **given, **QUIET)
    assert found.repairs[0].description == "chassis: 5 wheels in place of 4"
    assert all(each.speed > 0.0 for each in found.repairs)
    assert found.repaired is not None
    assert dict(found.repaired.table.sizes)["terrain"] == 2


@pytest.mark.parametrize("most", [0.2996, 4e-4])
def test_a_slow_robot_is_not_driven_faster_than_it_can(most: float) -> None:
    slow = replace(SEIZING, drivetrain=replace(SEIZING.drivetrain, max_speed=most))
    speed = scenario_of(slow, c2d.terrains.step(0.03), None, None).drive.speed
    assert most - 0.001 < speed <= most
    assert speed > 0.0


def test_the_speeds_of_a_robot_that_creeps_are_told_apart() -> None:
    """A tenth of 4 mm/s, and 0.4 mm/s itself, were rounded to 0."""
    slow = replace(SEIZING, drivetrain=replace(SEIZING.drivetrain, max_speed=4e-4))
    found = c2d.audit(
        slow, STEP, duration=0.01, samples=9, repeats=1, repair=False, seed=2, **QUIET
    )
    speeds = np.unique(found.table["speed"].values).tolist()
    assert speeds == pytest.approx([4e-5, 4e-4 / 3.0, 4e-4], rel=0.05)
    assert len(found.verdicts[0].seized_at) == 3
    assert "at 4e-05, 0.000133 and 0.0004 m/s in turn" in words.population(found)


def test_an_audit_without_any_result_has_a_page() -> None:
    refused: Any = {"terrain.friction": c2d.uniform(-2.0, -1.0)}
    found = c2d.audit(SEIZING, STEP, vary=refused, unknown={}, repeats=1, repair=False, **QUIET)
    assert words.missing_results(found).startswith("2 of 2 runs have no result")
    assert "It seized in no run" in found.to_html()
