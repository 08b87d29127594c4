"""Which candidates of a repair can jam at all."""

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.audits.jams import _holds, free_of_jams

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


@pytest.mark.parametrize(
    ("depth", "friction", "holds"),
    [
        (0.01, 0.5, True),
        (0.01, 0.8, True),
        (0.01, 0.49, False),
        (0.01, 0.81, False),
        (0.001, 0.6, False),  # ground this shallow also holds a belt
        (0.00101, 0.6, True),
    ],
)
def test_a_jam_holds_from_its_least_friction_to_its_largest(
    depth: float, friction: float, holds: bool
) -> None:
    jams = {"depth": np.array([0.0, depth]), "low": np.array([0.0, 0.5]), "high": np.full(2, 0.8)}
    assert _holds(jams, friction) is holds


def test_frictions_are_computed_up_to_ten(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def ranges(texts: list[str], most: float) -> list[dict[str, np.ndarray]]:
        asked.append((len(texts), most))
        return [{name: np.zeros(0) for name in ("depth", "low", "high")}] * len(texts)

    monkeypatch.setattr("crawler2d._core.jam_ranges", ranges)
    assert free_of_jams(WHEELS, [STEP, STEP]) == [0, 1]
    assert asked == [(2, 10.0), (2, 10.0)]
