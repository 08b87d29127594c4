"""Trials of a stopped robot, pushes, and their runs."""

import math
import pickle
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.results.findings import TrialResult
from crawler2d.runs.branch import EscapeForce
from tests.shared import GEAR, ROBOT, refused

SEIZING = c2d.Scenario(ROBOT.with_track(c2d.LineOfWheels(4)), c2d.terrains.step(0.10), duration=6.0)
ESCAPE = 5.0 + 0.05 / 0.4  # [s] escape_time and escape_distance at 0.4 m/s


@pytest.fixture(scope="module")
def seized() -> c2d.Run:
    return c2d.simulate(SEIZING)


def same(one: TrialResult, other: TrialResult) -> bool:
    return all(getattr(one, each.name) == getattr(other, each.name) for each in fields(TrialResult))


def test_trials_are_those_of_the_diagnosis_and_what_if_repeats_one(seized: c2d.Run) -> None:
    assert seized.diagnosis is not None
    trials = {trial.name: trial for trial in seized.trials()}
    for tried in seized.diagnosis.trials:
        assert same(trials[tried.name], tried)
    for name, trial in trials.items():
        assert same(seized.what_if(name), trial)


def test_a_trial_prints_what_was_changed_and_how_it_ended(seized: c2d.Run) -> None:
    trials = {trial.name: trial for trial in seized.trials()}
    assert str(trials["unchanged"]) == "Trial(unchanged: jammed)"
    free = trials["closed track"]
    assert str(free) == f"Trial(closed track: free after {free.time:.1f} s, then cleared)"
    assert str(trials["belt, from the start"]) == "Trial(belt, from the start: tipped over)"


def test_the_run_of_a_trial_shows_what_it_says(seized: c2d.Run) -> None:
    for trial in seized.trials():
        run = trial.run
        assert run is trial.run
        begin = 0.0 if trial.is_from_the_start else seized.time[-1]
        assert run.time[0] == pytest.approx(begin)
        assert run.time[-1] <= begin + trial.duration + 1e-9
        ahead = run.position[:, 0] - seized.position[:, 0].max()
        gets_away = ahead.max() > 0.05 or run.outcome is c2d.Outcome.CLEARED
        assert trial.freed == (gets_away and run.outcome is not c2d.Outcome.TIPPED_OVER), trial.name
        assert trial.distance == pytest.approx(ahead.max(), abs=1e-4)
        if trial.outcome is c2d.Outcome.CLEARED:
            assert run.outcome is c2d.Outcome.CLEARED
        if trial.freed:
            assert 0.0 < trial.time <= trial.duration


def test_the_run_of_a_trial_from_several_starts_is_one_that_ended_as_most_of_them() -> None:
    robot = ROBOT.with_track(c2d.GrouserBeltTrack())
    run = c2d.simulate(robot, c2d.terrains.step(0.095, friction=0.45), duration=6.0, trials=None)
    assert run.diagnosis is not None
    assert not run.diagnosis.stationary
    trials = [run.what_if("friction x 2"), run.what_if(friction=0.9)]
    for trial in trials:
        # The first start alone would give a different result.
        assert (trial.freed, trial.freeing, trial.starts) == (False, 2, 4)
        assert trial.run.time[0] > run.time[-1]
        assert trial.run.position[-1] == pytest.approx(trial.position, abs=1e-9)
        assert trial.run.chassis_angle[-1] == pytest.approx(trial.chassis_angle, abs=1e-9)
    assert same(replace(trials[1], name="friction x 2"), trials[0])


def test_a_run_remembers_the_trials_that_were_made_of_it() -> None:
    run = c2d.simulate(SEIZING, trials=None)
    assert run.diagnosis is not None
    before = [tried.name for tried in run.diagnosis.trials]
    assert "twice the friction" not in str(run.diagnosis)
    run.what_if("friction x 2")
    run.what_if(max_torque=20.0)
    assert [tried.name for tried in run.diagnosis.trials] == [*before, "friction x 2"]
    assert "twice the friction: " in str(run.diagnosis)
    trials = run.trials()
    assert [tried.name for tried in run.diagnosis.trials] == [trial.name for trial in trials]
    assert run.diagnosis.freed_by == tuple(trial.name for trial in trials if trial.freed)
    assert run.diagnosis.certificate == run.diagnosis.imbalance


def test_each_trial_changes_one_thing(seized: c2d.Run) -> None:
    own = SEIZING
    runs = {trial.name: trial.run.scenario for trial in seized.trials()}
    robot, limit = own.robot, own.robot.drivetrain.max_torque
    assert runs["unchanged"] == runs["rebuilt"] == own
    closed = replace(own, robot=robot.with_track(c2d.ClosedTrack(c2d.LineOfWheels(4))))
    assert runs["closed track"] == runs["closed track, clear of the ground"] == closed
    assert runs["torque x 2"] == own.replace({"robot.drivetrain.max_torque": 2.0 * limit})
    assert runs["torque x 10"] == own.replace({"robot.drivetrain.max_torque": 10.0 * limit})
    assert runs["friction x 2"] == own.replace({"terrain.friction": 1.8})
    assert runs["no belly"] == own.replace({"robot.belly": None})
    assert runs["closed track, from the start"] == closed
    on_belts = replace(own, robot=robot.with_track(c2d.BeltTrack()))
    assert runs["belt"] == runs["belt, from the start"] == on_belts
    assert len(runs) == 11


def test_grousers_flippers_and_motors_have_trials_of_their_own() -> None:
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(3, wheel=GEAR))
    robot = replace(robot, drivetrain=replace(robot.drivetrain, torque_sharing="wheel"))
    run = c2d.simulate(robot, c2d.terrains.step(0.5, friction=0.4), duration=12.0)
    names = [trial.name for trial in run.trials()]
    assert {"closed smooth track", "one motor", "flippers level"} <= set(names)
    belt = c2d.simulate(ROBOT, c2d.terrains.step(0.3, friction=0.5), duration=8.0)
    assert [trial.name for trial in belt.trials()] == [
        *("unchanged", "rebuilt", "torque x 2", "torque x 10", "friction x 2", "no belly")
    ]


def test_a_custom_change_is_tried_like_the_named_trials(seized: c2d.Run) -> None:
    twice = 2.0 * SEIZING.robot.drivetrain.max_torque
    by_name, by_hand = seized.what_if("torque x 2"), seized.what_if(max_torque=twice)
    assert by_hand.name == "changed"
    assert same(replace(by_hand, name="torque x 2"), by_name)
    assert seized.what_if(track=c2d.BeltTrack()).freed
    assert seized.what_if(track="closed").freed
    assert not seized.what_if().freed
    pushed = seized.what_if(push=(100.0, 0.5))
    assert pushed.freed
    assert pushed.run.time[-1] <= seized.time[-1] + ESCAPE + 1e-9
    assert pushed.run.position[:, 0].max() > 0.05


def test_entries_of_a_schedule_after_the_stop_change_neither_trials_nor_their_runs() -> None:
    drive = SEIZING.drive
    later = [(drive, 8.0), (replace(drive, schedule=((7.0, -drive.speed),)), 7.0 - 1e-9)]
    stops = [c2d.simulate(replace(SEIZING, drive=each, duration=end)) for each, end in later]
    (one, other) = (stop.what_if(track=c2d.BeltTrack()) for stop in stops)
    assert other.freed
    assert other.outcome is one.outcome is c2d.Outcome.CLEARED
    assert other.distance == pytest.approx(one.distance, abs=1e-4)
    assert other.run.outcome is c2d.Outcome.CLEARED
    ahead = other.run.position[:, 0].max() - stops[1].position[:, 0].max()
    assert other.distance == pytest.approx(ahead, abs=0.01)  # of a step


def test_entries_of_a_gait_after_the_stop_change_no_trial() -> None:
    robot = c2d.robots.engineer().with_track(c2d.LineOfWheels(4))
    assert robot.flippers is not None
    robot = replace(robot, flippers=replace(robot.flippers, ends="both", angle=0.3))
    stands = c2d.Scenario(
        robot,
        c2d.terrains.step(0.12, friction=0.9),
        drive=c2d.Drive(speed=0.3, gait=c2d.Hold(0.3)),
        start=c2d.Start(approach=0.1),
        duration=8.0,
    )
    lowers = replace(
        stands, drive=replace(stands.drive, gait=c2d.Hold(0.3, schedule=((8.0, -0.8),)))
    )
    stops = [c2d.simulate(each) for each in (stands, lowers)]
    assert stops[0].outcome is stops[1].outcome
    freed = [{trial.name: trial.freed for trial in stop.trials()} for stop in stops]
    assert freed[0] == freed[1]


@pytest.mark.filterwarnings("ignore:terrain.*friction")
@pytest.mark.parametrize(
    "track",
    [c2d.BeltTrack(), c2d.LineOfWheels(4), c2d.SegmentalTrack()],
    ids=["belt", "line", "chain"],
)
def test_a_trial_can_make_the_ground_of_two_tracks_alike(track: Any) -> None:
    walls = [c2d.terrains.step(0.3, friction=friction) for friction in (60.0, 80.0)]
    stop = c2d.Scenario(
        ROBOT.with_track(track),
        c2d.terrains.lanes(*walls),
        drive=c2d.Drive(speed=0.3),
        start=c2d.Start(approach=0.1),
        duration=4.0,
    )
    # Friction is at most 100.
    trial = c2d.simulate(stop, trials=["friction x 2"]).what_if("friction x 2")
    assert not trial.freed
    ground: Any = trial.run.scenario.terrain
    assert ground.left == ground.right


def test_the_time_of_a_trial_follows_the_criteria_and_the_command() -> None:
    for changes, expected in (
        ({"criteria.escape_time": 0.02}, 0.02 + 0.05 / 0.4),
        ({"criteria.escape_distance": 0.4}, 5.0 + 1.0),
    ):
        run = c2d.simulate(SEIZING.replace(changes), record="summary")
        for trial in run.trials():
            of_a_run = trial.is_from_the_start
            assert trial.duration == pytest.approx(SEIZING.duration if of_a_run else expected)
    # A schedule commands another speed than the run began with.
    scheduled = SEIZING.replace({"drive": c2d.Drive(speed=0.4, schedule=((0.0, 0.4), (2.0, 0.2)))})
    trial = c2d.simulate(scheduled, record="summary").what_if("torque x 2")
    assert trial.duration == pytest.approx(5.0 + 0.05 / 0.2)
    hasty = c2d.simulate(SEIZING.replace({"criteria.escape_time": 0.01}), record="summary")
    assert (hasty.what_if("closed track").freed, hasty.outcome) == (False, "slipping")


def test_trials_that_do_not_apply_to_the_robot_are_refused(seized: c2d.Run) -> None:
    for name in ("flippers level", "one motor", "closed smooth track"):
        error = refused(lambda name=name: seized.what_if(name))
        assert (error.path, error.value) == ("name", name)
        assert "changes something on the robot" in error.rule
    error = refused(lambda: seized.what_if("torque x 3"))
    assert error.path == "name"
    assert '"torque x 2"' in error.rule


def test_a_robot_holds_the_lower_level_and_leaves_at_the_upper_one(seized: c2d.Run) -> None:
    found = seized.escape_force()
    low, high = found
    assert (found.low, found.high) == (low, high)
    assert high == pytest.approx(1.1 * low)
    assert not found.tips
    twin = pickle.loads(pickle.dumps(EscapeForce(low, high, tips=True)))
    assert (twin, twin.tips) == ((low, high), True)
    for force, leaves in ((low, False), (high, True)):
        sim = c2d.Simulation(SEIZING)
        sim.advance(seized.time[-1])
        start = np.array(sim.state().position)
        for share in np.linspace(0.0, 1.0, 500):
            sim.command(push=share * force)
            sim.advance(0.01)
        sim.advance(2.0)
        assert (np.hypot(*(sim.state().position - start)) > 5e-3) == leaves


def test_a_robot_at_a_wall_without_friction_is_moved_by_no_push() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.step(0.5, friction=0.05), duration=8.0)
    found = run.escape_force()
    assert found.low > 9.0 * ROBOT.mass * 9.81
    assert (found.high, found.tips) == (math.inf, False)


def test_trials_end_for_a_robot_that_is_commanded_to_stop(seized: c2d.Run) -> None:
    still = seized.what_if(drive=c2d.Drive(speed=0.0))
    assert not still.freed
    assert still.duration == pytest.approx(ESCAPE)
    # Ahead means ahead of the stop, whatever direction is commanded.
    back = seized.what_if(drive=c2d.Drive(speed=-0.4))
    assert not back.freed
    assert back.position[0] < seized.position[-1, 0] - 0.5
    # A command that ends soon after the stop.
    drive = c2d.Drive(speed=0.4, schedule=((float(seized.time[-1]) + 0.05, 0.0),))
    paused = c2d.simulate(SEIZING.replace({"drive": drive}), trials="all")
    assert paused.outcome in ("seized", "slipping", "timed_out")


@pytest.mark.parametrize(
    "change",
    [
        {"track": c2d.BeltTrack()},
        {"friction": 0.5},
        {"max_torque": 50.0},
        {"belly": None},
        {"drive": c2d.Drive(speed=0.1)},
        {"push": (10.0, 1.0)},
    ],
)
def test_a_named_trial_with_a_change_is_refused(seized: c2d.Run, change: Any) -> None:
    error = refused(lambda: seized.what_if("torque x 2", **change))
    assert error.path == next(iter(change))
    assert error.rule == "must not be given together with the name of a trial"
