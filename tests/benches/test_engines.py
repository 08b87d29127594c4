"""benches/engines: cells are valid, all engines get the same robot, and all runs are predicted."""

import re
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benches.adapters.ground import blocks_of, goal_of, turned
from benches.adapters.ode_process import GAZEBO, interpreter
from benches.adapters.robots import model_of_robot
from benches.adapters.space import Engine, drive, load, scene_of
from benches.engines import runs as running
from benches.engines import table, yaw
from benches.engines.cells import (
    DRIVES,
    GROUNDS,
    MODELS,
    ROBOTS,
    STARTS,
    Cell,
    read_cells,
    robot_of,
    write_cells,
)
from benches.engines.runs import (
    ENGINES,
    PREDICTIONS,
    check,
    compare_predictions,
    engine_of,
    hash_of,
    holds,
    pairs,
    predictions,
)
from benches.engines.table import apart, rate_of, same_outcome
from benches.models import runs as file_runs
from benches.shared.results import read, write
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import (
    Barrier,
    DiagonalBarrier,
    Flat,
    Lanes,
    RandomStepfield,
    Step,
    Terrain,
)
from research.tables import splice

CELL = Cell(
    group="plane",
    robot="engineer",
    model="line of 5",
    drive="60 N m, servos",
    ground="step",
    height=0.05,
    friction=0.9,
)


def engine(name: str) -> Engine:
    try:
        return engine_of(name)
    except ImportError as error:
        pytest.skip(str(error))


def test_there_are_cells_enough_and_half_of_those_in_the_plane_are_undecided() -> None:
    cells = read_cells()
    assert len({cell.label for cell in cells}) == len(cells) >= 120
    assert {cell.robot for cell in cells} == set(ROBOTS)
    assert {cell.model for cell in cells} == set(MODELS)
    assert {cell.drive for cell in cells} == set(DRIVES)
    assert {cell.ground for cell in cells} == set(GROUNDS)
    predicted = predictions()
    plane = [predicted[cell.label] for cell in cells if cell.group == "plane"]
    rates = np.array([np.mean([run["end"] == "cleared" for run in runs]) for runs in plane])
    assert np.mean((rates >= 0.1) & (rates <= 0.9)) >= 0.5


def test_the_predictions_are_for_these_cells_and_the_results_for_these_predictions() -> None:
    predicted = predictions()
    assert list(predicted) == [cell.label for cell in read_cells()]
    assert {len(runs) for runs in predicted.values()} == {STARTS}
    for name in ENGINES:
        results = read(running.RESULTS / f"{name}.json.xz")
        if results is not None:
            assert results["predictions"] == hash_of(), name
            assert set(results["runs"]) <= set(predicted), name


def test_predictions_made_again_are_compared_run_by_run(tmp_path: Path) -> None:
    def write_runs(name: str, *ends: str, x: float) -> Path:
        runs = [{"end": end, "x": x, "y": 0.0} for end in ends]
        cells = {"a; line of 3; b": runs, "a; 3 gears; b": runs[:1]}
        path = tmp_path / name
        write(path, {"cells": cells})
        return path

    kept = write_runs("kept", "cleared", "seized", "stalled", "timed_out", x=0.0)
    now = write_runs("now", "cleared", "cleared", "slipping", "timed_out", x=0.002)
    assert compare_predictions(now, kept).splitlines() == [
        "round wheels, 4 runs: 1 clear in one of both, 2 have another outcome; "
        "1 of 1 that stop in both do so more than 1 mm apart",
        "gear wheels, 1 runs: 0 clear in one of both, 0 have another outcome; "
        "0 of 0 that stop in both do so more than 1 mm apart",
    ]


def test_nothing_runs_without_its_prediction(tmp_path: Path) -> None:
    cells = read_cells()[:1]
    with pytest.raises(ValueError, match="predict before"):
        check(cells, {}, tmp_path / "predictions.json.xz")
    with pytest.raises(ValueError, match="not predicted"):
        check([replace(CELL, height=0.777)], {})
    with pytest.raises(ValueError, match="for predictions 0000"):
        check(cells, {"predictions": "0" * 64})
    assert check(cells, {"predictions": hash_of()}) == hash_of(PREDICTIONS)


def test_cells_are_read_as_they_were_written(tmp_path: Path) -> None:
    path = tmp_path / "cells.json"
    write_cells([CELL, replace(CELL, drive="6 N m, track")], path)
    assert read_cells(path)[0] == CELL
    assert [cell.is_coupled for cell in read_cells(path)] == [False, True]


def test_the_runs_of_a_cell_are_the_same_however_many_are_made() -> None:
    few, many = CELL.scenarios(2), CELL.scenarios(3)
    assert few == many[:2]
    assert len({scenario.start.approach for scenario in many}) == 3


def test_an_engine_without_gears_has_no_cell_where_one_motor_reaches_its_limit() -> None:
    coupled, oblique = replace(CELL, drive="6 N m, track"), replace(CELL, ground="oblique edge")
    assert [name for name in ENGINES if holds(name, coupled)] == ["pymunk", "rapier"]
    assert [name for name in ENGINES if not holds(name, oblique)] == ["pymunk", "rapier"]


@pytest.mark.parametrize("model", MODELS)
def test_the_robot_in_space_has_the_masses_of_the_robot_and_stands_on_its_wheels(
    model: str,
) -> None:
    robot = robot_of("engineer", model, "60 N m, servos")
    in_space = model_of_robot(robot)
    links = in_space.bodies
    assert in_space.mass == pytest.approx(robot.mass, rel=1e-12)
    center = sum(link["mass"] * np.array(link["center"]) for link in links) / robot.mass
    assert center == pytest.approx(
        [robot.center_of_mass[0], 0.0, robot.center_of_mass[1]], abs=1e-9
    )
    wheels = robot.wheels()
    found = [(wheel.axle[0], wheel.axle[2], wheel.radius) for wheel in in_space.wheels]
    expected = np.column_stack([wheels["x"], wheels["y"], wheels["radius"]])
    assert np.array(found) == pytest.approx(expected, abs=1e-9)
    # A gear wheel between two grousers stands lower than its radius.
    low = -min(y - radius for _, y, radius in found)
    assert 0.9 * low < -in_space.lowest(0.0) <= low + 1e-12


def test_a_motor_of_a_track_has_the_torque_of_all_its_wheels() -> None:
    servos, track, strong = (
        model_of_robot(robot_of("engineer", "line of 5", drive)).wheels[0].torque
        for drive in ("60 N m, servos", "60 N m, track", "100 N m a wheel")
    )
    # The sprocket's torque acts at the belt, 52 mm from the axle, a wheel's at 64 mm.
    assert servos == pytest.approx(60.0 / 5 * 64 / 52)
    assert track == pytest.approx(5 * servos)
    assert strong == pytest.approx(100.0)


def on(ground: Terrain) -> Scenario:
    return Scenario(robot_of("engineer", "line of 5", "60 N m, servos"), ground)


def test_an_oblique_edge_meets_the_left_track_first_at_0() -> None:
    gauge, yaw, thick = 0.2, 0.35, 0.01
    scenario = on(DiagonalBarrier(yaw, height=0.05, thickness=thick))
    level, edge = blocks_of(scenario)
    assert level.center[2] + 0.5 * level.size[2] == 0.0
    assert edge.center[2] + 0.5 * edge.size[2] == pytest.approx(0.05)
    # A point of the front face, in the frame of the block.
    away = np.array([0.0, 0.5 * gauge]) - edge.center[:2]
    assert away @ [np.cos(yaw), np.sin(yaw)] == pytest.approx(-0.5 * thick)
    assert goal_of(scenario) == pytest.approx(gauge * np.tan(yaw) + thick / np.cos(yaw))


def test_a_one_sided_edge_is_under_the_left_track_alone() -> None:
    scenario = on(Lanes(Barrier(0.05, 0.01), Flat()))
    edge = blocks_of(scenario)[1]
    assert edge.center[1] - 0.5 * edge.size[1] == 0.0
    assert goal_of(scenario) == 0.01
    assert goal_of(on(Step(0.05))) == 0.0


def test_a_step_field_has_a_row_of_posts_for_each_track() -> None:
    scenario = on(RandomStepfield(seed=3, posts=6, rise=0.03))
    blocks = blocks_of(scenario)
    tops = [block.center[2] + 0.5 * block.size[2] for block in blocks]
    assert {round(top / 0.03, 9) for top in tops} <= {0.0, 1.0, 2.0, 3.0, 4.0}
    for side in (-1.0, 1.0):
        mine = [block for block in blocks if block.center[1] * side > 0.0]
        assert {abs(block.center[1]) - 0.5 * block.size[1] for block in mine} == {0.0}
        ends = [block.center[0] + 0.5 * block.size[0] for block in mine]
        starts = [block.center[0] - 0.5 * block.size[0] for block in mine]
        assert starts[1:] == pytest.approx(ends[:-1])
    left, right = (
        [top for top, block in zip(tops, blocks, strict=True) if block.center[1] * side > 0.0]
        for side in (1.0, -1.0)
    )
    assert left != right
    assert goal_of(scenario) == pytest.approx(0.6)


def test_turned_ground_has_its_edge_at_the_pivot_still() -> None:
    front, behind = turned(blocks_of(on(Step(0.05))), 0.1, 0.0)
    normal = np.array([np.cos(0.1), np.sin(0.1)])
    for block, side in ((front, -1.0), (behind, 1.0)):
        assert block.yaw == 0.1
        assert block.center[:2] @ normal == pytest.approx(0.5 * side * block.size[0])


def test_the_jams_of_the_results_are_those_that_are_drawn() -> None:
    kept = read(running.RESULTS / "yaw.json.xz")["jams"]
    for model, jams in kept.items():
        label, _, stop, push = next(yaw.draw_jams(model))
        assert jams[0]["label"] == label
        assert jams[0]["x"] == pytest.approx(stop.position[0], abs=1e-5)  # up to its rounding
        assert jams[0]["push"] == pytest.approx(push, abs=1e-4)
        assert len({jam["label"] for jam in jams}) == len(jams) == 20


def test_bullet_moves_a_robot_out_of_the_ground_by_no_more_than_it_is_in_there() -> None:
    pytest.importorskip("pybullet")
    bullet: Any = load("Bullet")
    scene = scene_of(replace(CELL, model="line of 3").scenarios(1)[0])
    moved = bullet.clear(replace(scene, z=scene.z - 0.01))
    # Out of level ground straight up; 0.05 of that on top, which keeps it from going to and fro.
    assert moved.x == pytest.approx(scene.x, abs=1e-6)
    assert 0.0 <= moved.z - scene.z <= 6e-4
    assert bullet.clear(moved).z == moved.z


@pytest.mark.parametrize("name", [name for name in ENGINES if name != "rapier"])
@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_an_engine_drives_robots_forward_at_their_speed(name: str) -> None:
    made = engine(name)
    for model in ("line of 3", "5 gears"):
        cell = replace(CELL, model=model)
        scenario = cell.scenarios(1)[0].replace(
            {"terrain": Flat(friction=0.9), "start.track_phase": 0.013, "duration": 0.5}
        )
        found = drive(made, scenario)
        assert found["end"] == "timed out"
        # 0.2 m/s, reached at 1 m/s^2: 0.08 m in half a second, minus slip of wheels; grousers roll
        # more slowly than their circles.
        assert found["x"] - scene_of(scenario).x == pytest.approx(0.08, abs=0.006), model
        assert max(found["yaw"], found["roll"], abs(found["angle"])) < 0.03, model


@pytest.mark.skipif(interpreter() is None, reason="no interpreter has ODE")
def test_ode_has_the_geometry_of_the_robot_and_pushes_it_up_no_farther_than_gazebo_does() -> None:
    scenario = replace(CELL, model="line of 3").scenarios(1)[0]
    scene = scene_of(scenario)
    world = load("ODE", **GAZEBO).world(scene)
    try:
        start = world.pose()
        assert start.place == pytest.approx([scene.x, 0.0, scene.z], abs=1e-12)
        assert start.turn == pytest.approx(np.eye(3), abs=1e-12)
        world.advance([0.0] * 500)
        # Wheels penetrate by the compliance of contacts: gravity for a step, less than 0.1 mm.
        assert world.pose().place == pytest.approx([scene.x, 0.0, scene.z], abs=1e-4)
    finally:
        world.close()


def test_rates_have_their_intervals_and_pairs_the_same_draw() -> None:
    stops, clears = {"end": "stopped"}, {"end": "cleared"}
    assert rate_of([clears] * 8) == "8/8 (68 to 100)"  # Wilson, 95 %
    assert rate_of([]) == ""
    assert rate_of([{"end": "refused: robot.track"}]) == "refused"
    found = list(pairs([CELL], {CELL.label: [stops, clears, clears]}, {CELL.label: [stops, stops]}))
    assert len(found) == 2
    assert same_outcome(found) == "1 of 2"
    assert apart([stops] * 8, [clears] * 8)
    assert not apart([stops] * 2, [clears] * 1)


def test_only_runs_that_stop_in_both_say_how_far_apart_stops_are() -> None:
    def runs(*ends: str, x: float) -> dict[str, list[dict[str, object]]]:
        return {CELL.label: [{"end": end, "x": x, "y": 0.0, "angle": 0.0} for end in ends]}

    predicted = runs("seized", "slipping", "timed_out", "tipped_over", "cleared", x=0.0)
    found = runs("stopped", "tipped over", "stopped", "stopped", "stopped", x=0.5)
    found[CELL.label][0]["x"] = 0.002
    *_, row = table._poses([CELL], predicted, {"ode": found}).splitlines()
    kinds = row.count("| 1 | 2.00, 2.00 | 0.00, 0.00 |"), row.count("| 0 |  |  |")
    assert kinds == (1, 1)


@pytest.mark.parametrize(
    "left_out",
    [
        # Computed again, for all cells of a file.
        pytest.param("stops", id="but stops at jams"),
        pytest.param("", id="all", marks=pytest.mark.soak),
    ],
)
def test_the_page_has_the_tables_of_the_results(
    left_out: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    if left_out:
        monkeypatch.setattr(file_runs, left_out, lambda _: [])
    page = (Path(__file__).parents[2] / "docs" / "engines.md").read_text("utf-8")
    files = [file_runs.RESULTS / f"{name}.json.xz" for name in file_runs.ENGINES]
    parts = {**table.parts(read_cells(), running.RESULTS), **file_runs.parts(files)}
    assert set(re.findall("<!-- end of (.+) -->", page)) <= set(parts)
    parts.pop(left_out, None)
    assert splice(page, parts) == page


def test_a_run_that_is_there_is_not_made_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = []

    def one_run(_: str, __: object) -> dict[str, str]:
        made.append(1)
        return {"end": "stopped"}

    monkeypatch.setattr(running, "_runner", lambda _: (None, "an engine"))
    monkeypatch.setattr(running, "_run_by_name", one_run)
    cells = [cell for cell in read_cells() if holds("ode", cell)][:3]
    with ThreadPoolExecutor() as threads:
        running.run("ode", cells, 1, threads, tmp_path)
        running.run("ode", cells, 2, threads, tmp_path)
    assert len(made) == 6
    results = read(tmp_path / "ode.json.xz")
    assert {len(runs) for runs in results["runs"].values()} == {2}
