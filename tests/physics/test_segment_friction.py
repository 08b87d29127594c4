"""Ground whose friction differs from segment to segment."""

from dataclasses import replace

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Points
from tests.shared import ROBOT

LEVEL = [(-6.0, 0.0), (-3.0, 0.0), (0.0, 0.0), (2.0, 0.0)]
STEP = [(-3.0, 0.0), (0.0, 0.0), (0.0, 0.08), (3.0, 0.08)]


@pytest.mark.parametrize("track", [c2d.BeltTrack(), c2d.LineOfWheels(4)], ids=["belt", "line"])
def test_equal_segments_are_ground_of_one_friction(track: c2d.BeltTrack | c2d.LineOfWheels) -> None:
    one = c2d.terrains.from_points(STEP, goal=0.0, friction=0.6)
    three = c2d.terrains.from_points(STEP, goal=0.0, friction=0.1, segment_friction=[0.6] * 3)
    runs = [c2d.simulate(ROBOT.with_track(track), ground) for ground in (one, three)]
    assert runs[0].metrics == runs[1].metrics
    assert np.array_equal(runs[0].position, runs[1].position)


@pytest.mark.parametrize(("approach", "friction"), [(0.5, 0.1), (3.5, 0.3)])
def test_a_track_that_slips_accelerates_with_the_friction_under_it(
    approach: float, friction: float
) -> None:
    ground = c2d.terrains.from_points(LEVEL, goal=1.0, segment_friction=[0.3, 0.1, 0.5])
    scenario = Scenario(ROBOT, ground, start=c2d.Start(approach=approach))
    sim = c2d.Simulation(scenario.replace({"robot.drivetrain.max_acceleration": 100.0}))
    sim.advance(0.1)
    run = sim.to_run()
    begin, end = np.searchsorted(run.time, (0.019, 0.059))
    gained = run.velocity[end, 0] - run.velocity[begin, 0]
    rate = gained / (run.time[end] - run.time[begin])
    # mu g while it slips; contacts as soft as these change it by some 0.1 %.
    assert rate == pytest.approx(friction * 9.81, rel=2e-3)
    assert run.velocity[end, 0] < 0.2, "it still slips"


def test_a_wheel_climbs_a_face_by_its_friction_alone() -> None:
    robot = ROBOT.with_track(c2d.LineOfWheels(5))

    def outcome(face: float) -> c2d.Outcome | None:
        ground = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=[0.9, face, 0.9])
        return c2d.simulate(robot, ground).outcome

    # The face is higher than the wheels' centres: without friction nothing lifts the first one.
    assert outcome(0.0) == c2d.Outcome.SLIPPING
    assert outcome(0.9) == c2d.simulate(robot, c2d.terrains.step(0.08, friction=0.9)).outcome


def test_twice_the_friction_doubles_that_of_every_segment() -> None:
    robot = ROBOT.with_track(c2d.LineOfWheels(5))
    ground = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=[0.5, 0.2, 0.5])
    run = c2d.simulate(robot, ground)
    trial = run.what_if("friction x 2")
    twice = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=[1.0, 0.4, 1.0])
    scaled = trial.run.scenario.terrain
    assert isinstance(scaled, Points)
    assert scaled.segment_friction == twice.segment_friction


def test_a_belly_between_two_lanes_slides_with_the_friction_at_its_place() -> None:
    belly = ((-0.18, -0.08), (0.18, -0.08), (0.18, 0.05), (-0.18, 0.05))
    robot = replace(ROBOT, belly=belly)
    speeds = []
    for lower in (0.0, 1e-3):
        points = [[[x, y] for x, _ in LEVEL] for y in (0.0, -lower)]
        grounds = (
            c2d.terrains.from_points(each, goal=1.0, segment_friction=[0.0, 0.0, 0.9])
            for each in points
        )
        scenario = Scenario(
            robot,
            c2d.terrains.lanes(*grounds),
            drive=c2d.Drive(speed=0.0),
            start=c2d.Start(approach=1.0),
        )
        sim = c2d.Simulation(scenario)
        sim.command(push=40.0)
        sim.advance(1.0)
        speeds.append(sim.state().velocity[0])
    assert speeds == pytest.approx([40.0 / robot.mass] * 2)


def test_lanes_may_differ_in_their_segments() -> None:
    left = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=[0.9, 0.3, 0.9])
    ground = c2d.terrains.lanes(left, c2d.terrains.from_points(STEP, goal=0.0))
    scenario = Scenario(ROBOT, ground)
    assert Scenario.from_json(scenario.to_json()) == scenario
    assert c2d.simulate(scenario, duration=0.5).metrics["time"] == 0.5


@pytest.mark.parametrize(
    ("given", "path", "rule"),
    [
        ([0.9, 0.9], "terrain.segment_friction", "one number for each of 3 segments"),
        ([0.9, -0.1, 0.9], "terrain.segment_friction[1]", ">= 0"),
        ([0.9, np.nan, 0.9], "terrain.segment_friction[1]", "finite"),
    ],
)
def test_frictions_that_fit_no_segments_are_refused(
    given: list[float], path: str, rule: str
) -> None:
    ground = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=given)
    with pytest.raises(c2d.ScenarioError) as refused:
        Scenario(ROBOT, ground).validate()
    assert refused.value.path == path
    assert rule in refused.value.rule


@pytest.mark.parametrize("given", [[[0.9, 0.9, 0.9]], 0.9, ["a", "b", "c"], [0.9, [0.9], 0.9]])
def test_frictions_of_another_shape_are_refused_at_once(given: object) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"terrain\.segment_friction"):
        c2d.terrains.from_points(STEP, goal=0.0, segment_friction=given)


def test_one_segment_can_be_varied() -> None:
    ground = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=[0.9, 0.2, 0.9])
    base = Scenario(ROBOT.with_track(c2d.LineOfWheels(5)), ground)
    data = c2d.sweep(base, {"terrain.segment_friction[1]": [0.0, 0.9]}, repeats=1, progress=False)
    assert str(data["outcome"].values.ravel()[0]) == "slipping"


def test_rapier_holds_one_friction_for_a_lane() -> None:
    ground = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=[0.9, 0.2, 0.9])
    robot = ROBOT.with_track(c2d.LineOfWheels(5))
    scenario = Scenario(robot, ground, solver=c2d.Solver(engine="rapier"))
    with pytest.raises(c2d.ScenarioError, match="one friction each") as refused:
        scenario.validate()
    assert refused.value.path == "terrain.segment_friction"


WET = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=[0.9, 0.2, 0.8])


def test_a_friction_that_is_set_is_that_of_all_segments() -> None:
    scenario = Scenario(ROBOT.with_track(c2d.BeltTrack()), WET)
    dry = scenario.replace({"terrain.friction": 0.7})
    assert dry.terrain == c2d.terrains.from_points(STEP, goal=0.0, friction=0.7)
    over = {"terrain.friction": [0.1, 0.7]}
    swept = c2d.sweep(scenario, over, vary={}, repeats=1, progress=False)
    slips, dries = swept["drive_work"].values.ravel()
    assert dries == c2d.simulate(dry).metrics["drive_work"]
    assert slips != dries


def test_segments_and_a_friction_may_be_set_together() -> None:
    fields = {"terrain.friction": 0.7, "terrain.segment_friction": [0.1, 0.2, 0.3]}
    terrain = Scenario(ROBOT, WET).replace(fields).terrain
    assert isinstance(terrain, Points)
    assert (terrain.friction, terrain.segment_friction) == (0.7, (0.1, 0.2, 0.3))


@pytest.mark.parametrize("whole", ["terrain.friction", "terrain.segment_friction[*]"])
def test_a_segment_with_draws_of_its_own_has_these(whole: str) -> None:
    one = {"terrain.segment_friction[1]": c2d.uniform(0.0, 0.1)}
    every = {whole: c2d.scaled(0.5, 0.5)}
    scenario = Scenario(ROBOT.with_track(c2d.BeltTrack()), WET)
    for vary in (one | every, every | one):
        drawn = c2d.sweep(scenario, {}, vary=vary, repeats=1, progress=False)
        terrain = Scenario.from_json(drawn["scenario"].item()).terrain
        assert isinstance(terrain, Points)
        own = drawn["drawn_segment_friction_1"].item()
        assert terrain.segment_friction == (0.45, own, 0.4)


@pytest.mark.parametrize("is_lane", [False, True])
def test_a_drawn_friction_is_drawn_for_every_segment(is_lane: bool) -> None:
    ground = c2d.terrains.lanes(left=WET, right=WET) if is_lane else WET
    vary = {"terrain.friction": c2d.scaled(0.5, 0.5)}
    scenario = Scenario(ROBOT.with_track(c2d.BeltTrack()), ground)
    over = {"drive.speed": [0.4]}
    drawn = c2d.sweep(scenario, over, vary=vary, repeats=1, progress=False)
    half = c2d.terrains.from_points(STEP, goal=0.0, segment_friction=[0.45, 0.1, 0.4])
    halves = c2d.terrains.lanes(left=half, right=half) if is_lane else half
    by_hand = c2d.simulate(scenario.replace({"terrain": halves, "drive.speed": 0.4}))
    assert drawn["drive_work"].item() == by_hand.metrics["drive_work"]
