"""The study: what it draws, counts and writes, on a few runs."""

import csv
from pathlib import Path

import pytest

import crawler2d as c2d
from conftest import ROBOT
from crawler2d import experiments
from crawler2d.scenario import Scenario


def test_repeats_are_drawn_by_seed_and_index_only() -> None:
    low = Scenario(ROBOT, c2d.terrains.step(0.02))
    high = Scenario(ROBOT.with_track(c2d.LineOfWheels(3)), c2d.terrains.step(0.1))
    first, second = experiments.repeat(low, 3, 0), experiments.repeat(high, 3, 0)
    assert first.start == second.start
    assert first.drive == second.drive
    assert first == experiments.repeat(low, 3, 0)
    assert first != experiments.repeat(low, 4, 0)
    assert first != experiments.repeat(low, 3, 1)


def test_repeats_stay_in_their_ranges() -> None:
    base = Scenario(ROBOT, c2d.terrains.step(0.05))
    for index in range(200):
        drawn = experiments.repeat(base, index, 0)
        assert 0.05 <= drawn.start.approach < 0.15
        assert 0.0 <= drawn.start.track_phase < 0.048
        assert drawn.drive.speed == pytest.approx(0.4, rel=0.02)
        assert getattr(drawn.terrain, "friction", 0.0) == pytest.approx(0.9, rel=0.02)


def test_wheels_of_a_sixth_of_the_axle_distance_touch_in_a_line_of_four() -> None:
    track = experiments.models(0.365)["line of 4, touching"]
    assert isinstance(track, c2d.LineOfWheels)
    assert track.wheel_radius == pytest.approx(0.365 / 3 / 2)


def test_the_quick_study_writes_its_tables_and_its_picture(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(experiments, "QUICK_HEIGHTS", (0.03, 0.15))
    monkeypatch.setattr(experiments, "QUICK_REPEATS", 2)
    assert experiments.main(["--quick", "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert "belt" in printed
    assert "2/2" in printed
    with (tmp_path / "out" / "study.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 6 * 2 * 2
    assert {row["outcome"] for row in rows} <= {str(outcome) for outcome in c2d.Outcome}
    with (tmp_path / "out" / "rates.csv").open(newline="") as file:
        rates = list(csv.DictReader(file))
    assert len(rates) == 6 * 2
    for rate in rates:
        of_cell = [
            row for row in rows if (row["model"], row["height"]) == (rate["model"], rate["height"])
        ]
        assert int(rate["cleared"]) == sum(row["outcome"] == "cleared" for row in of_cell)
    assert (tmp_path / "out" / "study.png").stat().st_size > 10_000


def test_a_cell_counts_failures_and_distinct_poses() -> None:
    stuck = c2d.simulate(ROBOT.with_track(c2d.ForceTrack()), c2d.terrains.step(0.1))
    cleared = c2d.simulate(ROBOT, c2d.terrains.step(0.03))
    (cell,) = experiments.summarise({("both", 0.1): [stuck, stuck, cleared]})
    assert (cell.cleared, cell.count, cell.poses) == (1, 3, 2)
    assert cell.failures == {"stopped": 2}
    assert cell.rate == c2d.wilson(1, 3)
    assert "2 stopped" in experiments.table([cell])
