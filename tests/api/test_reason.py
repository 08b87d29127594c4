"""Why a run did not clear, whatever its outcome."""

import dataclasses
import math

import numpy as np
import pytest

import crawler2d as c2d

ROBOT = c2d.robots.engineer(flippers=None)


@pytest.fixture(scope="module")
def tipped() -> c2d.Run:
    return c2d.simulate(ROBOT, c2d.terrains.step(0.11))


def test_a_robot_that_tips_over_says_which_way_and_about_what(tipped: c2d.Run) -> None:
    assert tipped.outcome is c2d.Outcome.TIPPED_OVER
    assert tipped.reason.startswith("tipped over backwards: its centre of mass passed behind its")
    assert tipped.reason in str(tipped.tip_over())
    found = tipped.tip_over()
    assert found.backwards
    assert found.time < found.end == tipped.metrics["time"]
    # As in its pose and the contacts of the run, up to the motion in a sample of 10 ms.
    at = int(np.searchsorted(tipped.time, found.time))
    angle, (x, y) = tipped.chassis_angle[at], tipped.position[at]
    along, up = ROBOT.center_of_mass
    center = (
        x + math.cos(angle) * along - math.sin(angle) * up,
        y + math.sin(angle) * along + math.cos(angle) * up,
    )
    assert found.chassis_angle == pytest.approx(angle, abs=0.03)
    assert found.center_of_mass == pytest.approx(center, abs=2e-3)
    now = tipped.contacts["time"] == tipped.time[at]
    assert found.pivot[0] == pytest.approx(tipped.contacts["x"][now].min(), abs=2e-3)


def test_changes_that_prevent_tipping_over_are_tried(tipped: c2d.Run) -> None:
    found = tipped.tip_over()
    changes = [change for change, _ in found.tried]
    assert changes[:2] == ["half the speed", "a tenth of the speed"]
    assert found.prevented_by == (changes[-1],) == ("centre of mass 36 mm further forward",)
    assert str(found).endswith("centre of mass 36 mm further forward: clears")
    x, y = ROBOT.center_of_mass
    shift = 0.1 * ROBOT.outline.axle_distance
    moved = dataclasses.replace(ROBOT, center_of_mass=(x + shift, y))
    assert c2d.simulate(moved, c2d.terrains.step(0.11)).outcome is c2d.Outcome.CLEARED


def test_a_slower_robot_moves_its_flippers_at_the_same_places() -> None:
    """Flippers that are lowered beyond the edge are too late at any speed."""
    late = c2d.Drive(speed=0.4, gait=c2d.Hold(1.5, ((3.0, 0.3),)))
    run = c2d.simulate(c2d.robots.engineer(), c2d.terrains.step(0.1), drive=late, duration=5e4)
    ends = dict(run.tip_over().tried)  # the longest duration is 1e5 s
    assert ends["half the speed"] is ends["a tenth of the speed"] is c2d.Outcome.TIPPED_OVER


def test_a_robot_tips_over_forwards_down_a_cliff() -> None:
    cliff = c2d.terrains.from_points([(-3, 0), (1, 0), (1, -3), (9, -3)], goal=8, friction=0.9)
    run = c2d.simulate(ROBOT, cliff)
    assert run.outcome is c2d.Outcome.TIPPED_OVER
    assert run.reason.startswith("tipped over forwards: its centre of mass passed beyond its fore")
    found = run.tip_over()
    assert found.pivot == pytest.approx((1.0, 0.0), abs=1e-3)
    assert [end for change, end in found.tried if "further back" in change]


def test_every_run_that_does_not_clear_has_a_reason(tipped: c2d.Run) -> None:
    short = c2d.simulate(ROBOT, c2d.terrains.step(0.05), duration=1.0)
    assert short.reason == "timed out after 1.00 s, still driving at 99 % of the commanded speed"
    end = c2d.terrains.from_points([(-3, 0), (0, 0), (1, 0)], goal=0.9, friction=0.9)
    with pytest.warns(c2d.ScenarioWarning, match="cannot be cleared"):
        fallen = c2d.simulate(ROBOT, end)
    assert fallen.outcome is c2d.Outcome.LEFT_TERRAIN
    assert fallen.reason.startswith("left the terrain after")
    stopped = c2d.simulate(ROBOT, c2d.terrains.step(0.3, friction=0.3))
    assert stopped.reason == str(stopped.diagnosis)
    cleared = c2d.simulate(ROBOT, c2d.terrains.step(0.05))
    assert cleared.reason == ""
    with pytest.raises(c2d.ScenarioError, match="must have tipped over, not cleared"):
        cleared.tip_over()
    with pytest.raises(c2d.ScenarioError, match="in a stop, not as tipped_over"):
        tipped.trials()
    branch = tipped.branch(1.0)
    assert branch.reason.startswith("tipped over backwards after ")


def test_a_robot_that_shall_stand_does_not_drive_on() -> None:
    step = c2d.terrains.step(0.05)
    parked = c2d.simulate(ROBOT, step, drive=c2d.Drive(speed=0.0), duration=0.1, record="summary")
    assert parked.reason == "timed out after 0.10 s, with a commanded speed of 0"
    at_once = c2d.simulate(ROBOT, step, duration=0.0)
    assert at_once.reason == "timed out after 0.00 s, before a whole stop window was over"
    halted = c2d.Drive(speed=0.3, schedule=((1.2, 0.0), (9.0, 0.3)))
    for record in ("full", "summary"):
        run = c2d.simulate(ROBOT, step, drive=halted, duration=1.5, record=record)
        assert run.reason == "timed out after 1.50 s, with a commanded speed of 0"


def test_the_meaning_of_timing_out_includes_robots_that_shall_stand() -> None:
    assert "was to stand" in c2d.Outcome.TIMED_OUT.meaning


def test_progress_before_the_first_stop_window_is_over_is_not_known() -> None:
    pushing = c2d.simulate(ROBOT, c2d.terrains.step(0.3), duration=0.5)
    assert pushing.reason == "timed out after 0.50 s, before a whole stop window was over"


def test_a_title_says_when_the_goal_was_reached_as_the_metric_does() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.step(0.05))
    assert run.metrics["time_to_clear"] < run.metrics["time"]
    assert run.title.endswith(f"cleared after {run.metrics['time_to_clear']:.2f} s")


def test_a_simulation_that_goes_on_says_when_the_robot_tipped_over() -> None:
    sim = c2d.Simulation(c2d.Scenario(ROBOT, c2d.terrains.step(0.11)))
    sim.advance(5.0)
    run = sim.to_run()
    assert run.outcome is c2d.Outcome.TIPPED_OVER
    assert run.reason == "tipped over backwards after 2.60 s"
    assert run.title.endswith(": tipped_over after 2.60 s")
    end = c2d.terrains.from_points([(-3, 0), (0, 0), (9, 0)], goal=8.0, friction=0.9)
    sim = c2d.Simulation(c2d.Scenario(ROBOT, end, drive=c2d.Drive(speed=-1.0)))
    sim.advance(6.0)
    assert sim.to_run().reason.startswith("left the terrain within 6.00 s: an end axle was")


def test_a_title_says_when_a_stop_began_not_when_the_run_ended() -> None:
    wheels = ROBOT.without_rotors().with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
    run = c2d.simulate(wheels, c2d.terrains.step(0.075), record="summary")
    assert run.outcome is c2d.Outcome.SEIZED
    assert run.diagnosis is not None
    began = run.metrics["time"] - run.metrics["stopped_time"]
    assert began < run.metrics["time"] - 3.0
    assert run.diagnosis.since == pytest.approx(began, abs=1e-9)
    assert run.title == f"engineer, line, step: seized at {began:.2f} s"


def test_a_goal_that_no_robot_clears_on_the_ground_gets_a_warning() -> None:
    ground = c2d.terrains.step(0.05)
    scenario = c2d.Scenario(ROBOT, ground, duration=300.0)
    with pytest.warns(c2d.ScenarioWarning, match="goal cannot be cleared: beyond .* the ground"):
        scenario.replace({"goal": 99.8}).validate()
    points = [(-3.0, 0.0), (0.0, 0.0), (0.0, 0.02), (2.0, 0.02)]
    ends = scenario.replace({"terrain": c2d.terrains.from_points(points, goal=2.0)})
    with pytest.warns(c2d.ScenarioWarning, match=r"terrain\.goal cannot be cleared: beyond 1\."):
        ends.validate()


def test_the_reason_of_a_stop_includes_trials_made_after_its_first_reading() -> None:
    stopped = c2d.simulate(ROBOT, c2d.terrains.step(0.3, friction=0.3), trials=None)
    before = stopped.reason
    stopped.what_if("torque x 2")
    assert "twice the torque" not in before
    assert stopped.reason == str(stopped.diagnosis) != before
