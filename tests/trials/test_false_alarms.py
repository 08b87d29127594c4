"""Known seizures and false alarms of public robots."""

from dataclasses import replace
from typing import Any

import pytest

import crawler2d as c2d

# The public Engineer has arms with only the wheel at the tip.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")

FRICTION = 0.5  # of the wheels in the public model
STEPS = (0.085, 0.09, 0.095, 0.10, 0.11, 0.12, 0.13)  # [m]
KNIVES = (0.075, 0.08, 0.09, 0.095, 0.10, 0.11, 0.12)  # [m]


def held(angle: float, torque: float, height: float) -> c2d.Scenario:
    """The Engineer on its public wheels with weak motors and fixed flippers."""
    robot = c2d.robots.engineer(track="public")
    robot = replace(robot, drivetrain=replace(robot.drivetrain, max_torque=torque))
    drive = c2d.Drive(gait=c2d.Hold(angle))
    return c2d.Scenario(robot, c2d.terrains.step(height), drive=drive, duration=15.0)


def test_a_front_wheel_at_a_wall_is_not_in_the_pocket_of_the_flipper_beside_it() -> None:
    heights = (0.09, 0.10, 0.11, 0.12, 0.13)
    cases = [held(a, t, h) for a in (0.2, 0.3, 0.4) for t in (1.0, 2.0) for h in heights]
    runs = c2d.simulate_many(cases, record="summary")
    assert len(runs) == 30
    assert {str(run.outcome) for run in runs} == {"stalled"}


@pytest.mark.parametrize("kind", ["steps", "knife edges", "barriers", "fields"])
def test_absolem_seizes_in_the_pockets_of_its_flippers(kind: str) -> None:
    """No belt gets into these poses; moved clear of the ground, one gets free."""
    on = c2d.terrains
    grounds: dict[str, list[Any]] = {
        "steps": [on.step(h, friction=FRICTION) for h in STEPS],
        "knife edges": [on.knife_edge(h, friction=FRICTION) for h in KNIVES],
        "barriers": [on.barrier(h, 0.1, friction=FRICTION) for h in STEPS],
        "fields": [on.random_stepfield(seed, friction=FRICTION) for seed in (0, 1, 3, 4, 5, 6)],
    }
    drive = c2d.Drive(speed=0.3, gait=c2d.Climb())
    robot = c2d.robots.absolem(track="public")
    runs = c2d.simulate_many(
        [c2d.Scenario(robot, g, drive=drive, duration=25.0) for g in grounds[kind]],
        record="summary",
    )
    for run in runs:
        assert run.outcome is c2d.Outcome.SEIZED, run.scenario.terrain
        why = run.diagnosis
        assert why is not None
        assert why.intrusion is not None
        assert why.intrusion.carrier == "front flipper"
        assert "closed track, clear of the ground" in why.freed_by
    assert isinstance(robot.track, c2d.LineOfWheels)
    closed = robot.with_track(c2d.ClosedTrack(robot.track))
    belts = [replace(run.scenario, robot=closed) for run in runs]
    for run in c2d.simulate_many(belts, record="summary"):
        assert run.outcome is c2d.Outcome.CLEARED, run.scenario.terrain
