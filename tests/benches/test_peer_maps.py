"""benches/peers: a drawn scene agrees with its scenario, and the report with the figures."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benches.adapters.own import nominal
from benches.adapters.planar import Scene, load_scene
from benches.peers import maps
from benches.peers.maps import scene_of
from crawler2d.parameters.scenario import Scenario
from research.tables import splice

NOMINAL, BASE = load_scene("lwa5-round-step"), nominal("lwa5-round-step")


def of(changes: dict[str, Any]) -> Scene:
    return scene_of(NOMINAL, BASE, BASE.replace(changes))


def center(scene: Scene) -> np.ndarray[Any, Any]:
    at = np.array([(body.x, body.y) for body in scene.bodies])
    return np.asarray(np.average(at, axis=0, weights=[body.mass for body in scene.bodies]))


def test_an_unchanged_scenario_is_the_scene_itself() -> None:
    same = of({})
    for own, before in zip(same.bodies, NOMINAL.bodies, strict=True):
        assert (own.x, own.y, own.mass) == (before.x, before.y, before.mass)
        assert own.inertia == pytest.approx(before.inertia, rel=1e-9)  # as written
    assert same.joints == NOMINAL.joints
    assert same.friction == NOMINAL.friction
    assert all(map(np.array_equal, same.boxes, NOMINAL.boxes))


def test_centre_of_mass_and_inertia_are_those_of_the_robot_as_a_whole() -> None:
    moved = of({"robot.center_of_mass": (0.03, -0.01)})
    assert center(moved) - center(NOMINAL) == pytest.approx([0.03, -0.01], abs=1e-12)
    places = [(body.x, body.y) for body in moved.bodies[1:]]
    assert places == [(body.x, body.y) for body in NOMINAL.bodies[1:]]
    pins = [np.add(joint.pa, (moved.bodies[0].x, moved.bodies[0].y)) for joint in moved.joints]
    assert np.allclose(pins, places)
    offsets = np.array([(body.x, body.y) for body in moved.bodies]) - center(moved)
    inertia = sum(
        body.inertia + body.mass * float(offset @ offset)
        for body, offset in zip(moved.bodies, offsets, strict=True)
    )
    assert inertia == pytest.approx(BASE.robot.moment_of_inertia, rel=1e-9)


def test_the_rest_is_scaled_and_moved() -> None:
    base: Scenario = BASE
    torque = base.robot.drivetrain.max_torque
    changed = of(
        {
            "robot.drivetrain.max_torque": 0.5 * torque,
            "terrain.points[2][1]": 0.1,
            "terrain.points[3][1]": 0.1,
            "terrain.friction": 0.6,
            "drive.speed": 0.39,
            "start.approach": base.start.approach + 0.01,
        }
    )
    assert changed.joints[0].torque == 0.5 * NOMINAL.joints[0].torque
    assert changed.joints[0].speed == pytest.approx(NOMINAL.joints[0].speed * 0.39 / 0.4)
    assert changed.profile()[:, 1].tolist() == [0.0, 0.0, 0.1, 0.1]
    assert changed.friction == pytest.approx(0.6)
    assert changed.bodies[0].x == pytest.approx(NOMINAL.bodies[0].x - 0.01)


def test_the_report_takes_the_cheapest_setting_that_agrees_with_the_finest() -> None:
    loops = [
        {"setting": name, "wall": wall, "simulated": 3.0, "as_finest": same, "as_ours": same}
        for name, wall, same in (("coarse", 0.01, 45), ("fine", 0.05, 50), ("finest", 1.0, 50))
    ]
    machine = {"date": "d", "processor": "p", "cores": 2, "load": 0.1, "system": "s", "python": "3"}
    found = {
        "machine": {**machine, "versions": {}},
        "took": 60.0,
        "cells": [2, 2],
        "repeats": 5,
        "samples": 5,
        "runs": 100,
        "wall": 1.0,
        "in_core": 0.97,
        "simulated": 3.0,
        "outcomes": {"cleared": 100},
        "looped": 50,
        "own": 0.02,
        "loops": loops,
        "agrees": 0.99,
    }
    parts = maps.render(found)
    page = (Path(__file__).parents[2] / "docs" / "studies" / "maps.md").read_text("utf-8")
    assert all(text in splice(page, parts) for text in parts.values())
    text = " ".join(" ".join(parts.values()).split())
    assert "100 runs a second" in text
    assert "3.0 % of the time" in text
    assert "99 % of 50 of these runs is fine: 50.0 ms per run, **2.5 times** crawler2d's" in text
    assert "crawler2d's 20.0 ms for the same runs" in text


def test_the_loop_has_runs_of_all_robots_and_draws(monkeypatch: pytest.MonkeyPatch) -> None:
    looped: list[Scenario] = []

    def loops(_: Scenario, texts: list[str]) -> dict[Any, list[maps.Ended]]:
        looped.extend(map(Scenario.from_json, texts))
        return {maps._FINEST: [maps.Ended(0.01, 1.0, cleared=True)] * len(texts)}

    monkeypatch.setattr(maps, "_loops", loops)
    found = maps.maps(samples=2, repeats=3, every=7, cells=3)
    assert len(looped) == found["looped"] == 8  # of 9 cells with 6 runs each
    assert len({scenario.robot.drivetrain.max_torque for scenario in looped}) == 2
    assert len({scenario.drive.speed for scenario in looped}) >= 5
    assert 0.0 < found["own"] < 10.0 * found["wall"] / found["runs"]
