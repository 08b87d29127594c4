"""The runs of the paper's Table 2: the fields, the counts, and where and why runs fail."""

import math
from dataclasses import replace
from pathlib import Path

import pytest

import crawler2d as c2d
from research.paper.design import QUICK, SETTINGS, Work
from research.paper.table_2 import (
    FIELDS,
    PLACES,
    barrier_of,
    cells,
    cross_fields,
    failures,
    failures_text,
    layouts_text,
    place_of,
)

NAMES = ["line of 3", "belt"]


def work(folder: Path) -> Work:
    return Work(
        store=folder / "paper.sqlite",
        design=replace(QUICK, field_repeats=2),
        threads=1,
        progress=False,
    )


def test_the_barrier_is_one_of_150_by_100_millimetres() -> None:
    plain, across, askew = FIELDS.values()
    assert (plain.post, plain.rise, plain.barrier_height) == (0.1, 0.025, 0.0)
    for field in (across, askew):
        assert (field.barrier_height, field.barrier_thickness) == (0.15, 0.1)
    assert askew.barrier_yaw == math.radians(45.0)


def test_the_barrier_begins_and_ends_where_the_ground_has_it() -> None:
    robot = c2d.robots.engineer(flippers=None)
    for name in ("horizontal barrier", "diagonal barrier"):
        field = FIELDS[name]
        run = c2d.simulate(c2d.Scenario(robot, field, duration=0.5), record="summary")
        high = run.edges["x"][run.edges["y"] > 0.149]  # posts reach 0.1 m
        found = barrier_of(field, robot.gauge)
        assert found == pytest.approx((high.min(), high.max()), abs=1e-9)
    assert barrier_of(FIELDS["random RSE"], robot.gauge) is None


def test_a_robot_is_before_at_or_beyond_the_barrier() -> None:
    barrier = (0.45, 0.55)
    assert [place_of(x, 0.25, barrier) for x in (0.19, 0.21, 0.79, 0.81)] == [
        *("before", "at", "at", "beyond")
    ]
    assert place_of(0.0, 0.25, None) == ""


def test_the_fields_are_the_same_for_every_layout_and_setting(tmp_path: Path) -> None:
    made = list(cross_fields(work(tmp_path), NAMES))
    assert [setting for setting, _ in made] == list(SETTINGS)
    seeds = {tuple(found["drawn_terrain_seed"].to_numpy().ravel()[:2]) for _, found in made}
    assert len(seeds) == 1
    for setting, found in made:
        for text in found["scenario"].to_numpy().ravel():
            scenario = c2d.Scenario.from_json(text)
            assert isinstance(scenario.terrain, c2d.terrains.random_stepfield)
            assert scenario.terrain.friction == pytest.approx(setting.friction, rel=0.021)
            assert scenario.drive.gait == c2d.Climb()

    rows = [row for setting, found in made for row in cells(setting, found)]
    assert len(rows) == len(SETTINGS) * len(NAMES) * len(FIELDS)
    assert all(
        row.count == 2 and (row.rate, row.low, row.high) == c2d.wilson(row.cleared, 2)
        for row in rows
    )
    assert all(row.cleared == 2 for row in rows if row.model == "belt")
    assert "| line of 3 | Fig. 3 |" in layouts_text(rows)

    failed = failures(made, work(tmp_path).store)
    assert len(failed) == sum(row.count - row.cleared for row in rows) > 0
    for each in failed:
        assert each.model == "line of 3"
        assert each.place in (("",) if each.obstacle == "random RSE" else PLACES)
        assert each.outcome == "timed_out" or each.sentence.startswith(each.outcome.split("_")[0])
    text = failures_text(failed, ["line of 3"])
    assert "- preset:" in text
    sums = [line.split(" | ") for line in text.splitlines() if "| line of 3 |" in line]
    assert len(sums) == len({(each.setting, each.obstacle) for each in failed})
    assert sum(int(count) for _, _, _, count, *_ in sums) == len(failed)
    assert all(before == "-" or int(before) <= int(count) for _, _, _, count, before, *_ in sums)


def test_a_second_call_reads_the_store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def run() -> list[str]:
        _, found = next(cross_fields(work(tmp_path), ["belt"]))
        return found["identity"].to_numpy().ravel().tolist()

    first = run()
    from crawler2d import _core  # noqa: PLC0415 - only this test needs it

    simulated: list[int] = []
    real = _core.simulate_many

    def counted(scenarios: list[c2d.Scenario], *others: object) -> object:
        simulated.append(len(scenarios))
        return real(scenarios, *others)  # type: ignore[arg-type]

    monkeypatch.setattr(_core, "simulate_many", counted)
    assert run() == first
    assert sum(simulated) == 0
