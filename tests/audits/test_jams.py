"""Which candidates of a repair can be held at all."""

import crawler2d as c2d
from crawler2d.audits.jams import free_of_jams

ROBOT = c2d.robots.engineer(flippers=None)
STEP = c2d.Scenario(ROBOT, c2d.terrains.step(0.075))
WHEELS = [{"robot.track": c2d.LineOfWheels(count, wheel_radius=0.0608)} for count in (4, 5)]


def test_candidates_that_can_jam_in_one_of_the_runs_are_left_out() -> None:
    assert free_of_jams(WHEELS, [STEP]) == [1]
    higher = STEP.replace({"terrain.height": 0.11})
    assert free_of_jams(WHEELS, [STEP, higher]) == []


def test_the_friction_of_the_run_counts() -> None:
    low = STEP.replace({"terrain.height": 0.05})
    assert free_of_jams(WHEELS[:1], [low.replace({"terrain.friction": 0.9})]) == []
    assert free_of_jams(WHEELS[:1], [low.replace({"terrain.friction": 1.3})]) == [0]


def test_grounds_and_wheels_without_computed_jams_exclude_no_candidate() -> None:
    lanes = c2d.Scenario(ROBOT, c2d.terrains.diagonal_barrier(0.2))
    assert free_of_jams(WHEELS, [lanes]) == []
    assert free_of_jams(WHEELS, [lanes, STEP]) == [1]
    gears = [{"robot.track": c2d.LineOfWheels(5, wheel=c2d.GearWheel())}]
    assert free_of_jams(gears, [STEP]) == []
