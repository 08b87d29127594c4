"""The belt with grousers in tables and pictures, and that it does not seize."""

from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.bodies import BodyKind
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.pictures.scenes import scene_of
from tests.pictures.reading import distance

ROBOT = c2d.robots.engineer(flippers=None).with_track(c2d.GrouserBeltTrack())


def test_contacts_lie_on_the_grousers_that_pictures_show() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.step(0.06), start=c2d.Start(track_phase=0.013))
    scene = scene_of(run)
    assert scene.kinds.count(BodyKind.GROUSER) == 22
    table = run.contacts
    assert set(table["body_kind"]) <= {BodyKind.BELT, BodyKind.BELLY, BodyKind.GROUSER}
    seen = set()
    for sample in range(50, run.time.size, 40):
        now = (table["time"] == run.time[sample]) & (table["body_kind"] == BodyKind.GROUSER)
        for row in np.flatnonzero(now):
            point = np.array([table["x"][row], table["y"][row]])
            # In half a step a grouser moves by 0.2 mm, its tip round an end by twice that.
            assert distance(point, scene.outline(table["body"][row], sample)) < 5e-4
            seen.add(int(table["body"][row]))
    assert len(seen) > 11


@pytest.mark.parametrize(
    ("count", "least"), [(60, 5), pytest.param(250, 30, marks=pytest.mark.soak)]
)
def test_nothing_seizes_a_closed_belt(count: int, least: int) -> None:
    rng = np.random.default_rng(8)
    scenarios = []
    for _ in range(count):
        kinds: list[Terrain] = [
            c2d.terrains.step(rng.uniform(0.05, 0.2)),
            c2d.terrains.barrier(rng.uniform(0.03, 0.1), rng.uniform(0.005, 0.1)),
            c2d.terrains.ridge(rng.uniform(0.04, 0.12), rng.uniform(0.3, 2.0)),
            c2d.terrains.gap(rng.uniform(0.05, 0.3)),
            c2d.terrains.random_stepfield(int(rng.integers(1000)), rise=rng.uniform(0.01, 0.04)),
        ]
        scenarios.append(Scenario(ROBOT, kinds[rng.integers(5)], duration=10.0))
    runs = c2d.simulate_many(scenarios, threads=2)
    stops = [run.diagnosis for run in runs if run.diagnosis is not None]
    assert len(stops) > least
    assert all(stop.outcome != "seized" for stop in stops)
    assert all(stop.mechanism not in ("straddled", "undercut") for stop in stops)


def test_a_slower_belt_runs_as_a_faster_one_on_the_level() -> None:
    for speed in (-0.4, 0.1, 1.0):
        run = c2d.simulate(
            ROBOT,
            c2d.terrains.from_points([[-9, 0], [9, 0]], goal=8.0),
            drive=c2d.Drive(speed=speed),
            duration=9.0,
        )
        # Distance: speeds of single samples scatter by 2 % when grousers strike.
        late = np.searchsorted(run.time, [7.0, 9.0])
        seconds = np.diff(run.time[late])
        assert np.diff(run.position[late, 0]) / seconds == pytest.approx(speed, rel=0.01)
        assert np.diff(run.track_position[late]) / seconds == pytest.approx(speed, rel=0.005)
        assert run.metrics["max_penetration"] < 1e-4


@pytest.mark.parametrize(
    ("change", "path"),
    [
        ({"robot.track.grouser_count": 0}, "robot.track.grouser_count"),
        ({"robot.track.grouser_count": 190}, "robot.track.grouser_count"),
        ({"robot.outline.grouser_height": 0.0}, "robot.outline.grouser_height"),
        ({"robot.outline.grouser_thickness": 0.0}, "robot.outline.grouser_thickness"),
        ({"robot.drivetrain.torque_sharing": "wheel"}, "robot.drivetrain.torque_sharing"),
    ],
)
def test_a_belt_that_cannot_be_is_refused_by_name(change: dict[str, Any], path: str) -> None:
    scenario = Scenario(ROBOT, c2d.terrains.flat()).replace(change)
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.simulate(scenario)
    assert caught.value.path == path
