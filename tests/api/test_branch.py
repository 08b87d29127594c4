"""The same instant with something changed."""

import functools
import math
import pickle
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.runs.dataset import UNITS
from tests.shared import GEAR, ROBOT, refused

WHEELS = ROBOT.with_track(c2d.LineOfWheels(4))
SEIZING = c2d.Scenario(WHEELS, c2d.terrains.step(0.10), duration=6.0)
GEARED = c2d.Scenario(
    ROBOT.with_track(c2d.LineOfWheels(4, wheel=GEAR)), c2d.terrains.step(0.10), duration=4.0
)
CLEARING = c2d.Scenario(ROBOT, c2d.terrains.step(0.05), duration=6.0)
LONGEST_STEP = 0.016  # [s]


@pytest.fixture(scope="module")
def seized() -> c2d.Run:
    return c2d.simulate(SEIZING)


@pytest.mark.parametrize("scenario", [SEIZING, GEARED, CLEARING], ids=["line", "gears", "belt"])
@pytest.mark.parametrize("at", [0.0, 0.51, 1.9])
def test_a_branch_with_nothing_changed_is_the_rest_of_the_run(
    scenario: c2d.Scenario, at: float
) -> None:
    run = c2d.simulate(scenario)
    branch = run.branch(at=at, duration=2.0)
    begin, end = branch.time[[0, -1]]
    assert at <= begin < at + LONGEST_STEP
    # Its last two steps are cut to end with it.
    last = end - 2.0 * LONGEST_STEP
    now, then = ((r.time > begin) & (r.time <= last) for r in (branch, run))
    assert branch.time[now].tolist() == run.time[then].tolist()
    assert np.count_nonzero(now) > 90
    of_intervals = {"drive_force", "drive_forces", "tractive_effort"}  # the first is cut short
    for name in UNITS:
        first = int(name in of_intervals)
        ours, theirs = getattr(branch, name)[now], getattr(run, name)[then]
        assert np.array_equal(ours[first:], theirs[first:]), name


def test_a_branch_counts_from_the_end_of_the_step_at_its_instant(seized: c2d.Run) -> None:
    branch = seized.branch(at=1.0, duration=1.5)
    assert 1.0 <= branch.time[0] < 1.0 + LONGEST_STEP
    assert branch.metrics["time"] == branch.time[-1] == branch.time[0] + 1.5
    assert branch.parent == (seized.scenario, 1.0)
    assert branch.scenario == seized.scenario.replace({"duration": 1.5})
    way = branch.position[-1, 0] - branch.position[0, 0]
    assert branch.metrics["distance"] == pytest.approx(way, abs=1e-12)
    assert seized.parent is None


@pytest.mark.parametrize("at", [0.3, 0.6, 2.0])  # whole steps miss a sample by rounding
def test_a_branch_that_begins_with_a_sample_has_it_once(at: float) -> None:
    run = c2d.simulate(SEIZING.replace({"solver.time_step": 1e-3}))
    branch = run.branch(at=at, duration=0.5, sample_interval=0.1)
    assert branch.time == pytest.approx(at + 0.1 * np.arange(6), abs=1e-9)


def test_a_stop_is_the_instant_of_the_diagnosis(seized: c2d.Run) -> None:
    assert seized.diagnosis is not None
    branch = seized.branch(duration=0.1)
    assert branch.parent is not None
    assert branch.parent[1] == branch.time[0] == seized.diagnosis.time
    assert np.array_equal(branch.position[0], seized.position[-1])
    assert branch.chassis_angle[0] == seized.chassis_angle[-1]


def test_a_seized_robot_stays_seized_and_gets_away_on_a_belt(seized: c2d.Run) -> None:
    assert seized.branch(duration=4.0).outcome is c2d.Outcome.SEIZED
    freed = seized.branch(track=c2d.BeltTrack(), duration=4.0)
    assert freed.outcome is c2d.Outcome.CLEARED
    assert freed.scenario.robot.track == c2d.BeltTrack()
    # Ground inside the belt is let out without a push: the robot is no faster than its track.
    assert np.hypot(*freed.velocity.T).max() < 1.2
    assert np.array_equal(freed.position[0], seized.position[-1])


@pytest.mark.parametrize(("every", "more"), [(6, 1), pytest.param(2, 3, marks=pytest.mark.soak)])
def test_a_belt_with_grousers_has_the_grip_that_a_smooth_one_lacks(every: int, more: int) -> None:
    """Gears and a smooth belt slip at a step; grousers grip in half of 48 starts."""
    gears = c2d.LineOfWheels(4, wheel=c2d.GearWheel())
    robot = ROBOT.with_track(gears)
    terrain = c2d.terrains.step(0.105, friction=0.7)
    starts = [c2d.Start(track_phase=phase * 1e-3) for phase in range(0, 48, every)]
    coarse = c2d.Solver(accuracy=1e-5)
    runs = [c2d.simulate(robot, terrain, start=start, solver=coarse) for start in starts]
    smooth = sum(run.what_if("closed smooth track").freed for run in runs)
    assert sum(run.what_if("closed track").freed for run in runs) > smooth + more


def test_the_friction_of_a_branch_is_that_of_all_lanes_and_segments() -> None:
    def lanes(friction: float) -> Any:
        step, flat = c2d.terrains.step(0.1, friction=friction), c2d.terrains.flat(friction=friction)
        return c2d.terrains.lanes(step, flat, middle=flat)

    def points(*frictions: float) -> Any:
        places = [(-3.0, 0.0), (0.0, 0.0), (3.0, 0.0)]
        return c2d.terrains.from_points(places, goal=1.0, segment_friction=frictions)

    for before, after in ((lanes(0.9), lanes(0.3)), (points(0.9, 0.5), points(0.3, 0.3))):
        run = c2d.simulate(c2d.Scenario(ROBOT, before, duration=0.2))
        assert run.branch(at=0.1, friction=0.3, duration=0.1).scenario.terrain == after


def test_friction_and_command_can_be_changed(seized: c2d.Run) -> None:
    slippery = seized.branch(at=0.5, friction=0.05, duration=3.0)
    assert slippery.scenario.terrain == c2d.terrains.step(0.10, friction=0.05)
    assert slippery.outcome is c2d.Outcome.SLIPPING
    backwards = seized.branch(drive=c2d.Drive(speed=-0.4), duration=3.0)
    assert backwards.metrics["distance"] < -0.3
    standing = seized.branch(drive=c2d.Drive(speed=0.0), duration=3.0)
    assert standing.outcome is c2d.Outcome.TIMED_OUT
    assert abs(standing.metrics["distance"]) < 0.1


def test_more_torque_changes_nothing_else() -> None:
    """The state continues bit by bit, and so does the run if the same torque is given again."""
    run = c2d.simulate(CLEARING.replace({"robot.drivetrain.max_torque": 1.0}))
    assert run.outcome is c2d.Outcome.STALLED
    same = run.branch(max_torque=1.0, duration=1.0)
    rest = run.branch(duration=1.0)
    assert np.array_equal(same.position, rest.position)
    strong = run.branch(max_torque=20.0)
    assert strong.scenario.robot.drivetrain.max_torque == 20.0
    assert strong.outcome is c2d.Outcome.CLEARED
    a_little = run.branch(max_torque=1.0 + 1e-9, duration=1.0)
    assert np.abs(a_little.position - rest.position).max() < 1e-7


def test_the_belly_can_be_removed() -> None:
    """A blade between the tracks stops only the belly."""
    flat, blade = c2d.terrains.flat(), c2d.terrains.knife_edge(0.06)
    lanes = c2d.terrains.lanes(flat, flat, middle=blade)
    run = c2d.simulate(c2d.Scenario(ROBOT, lanes, goal=1.0))
    assert run.outcome in (c2d.Outcome.HUNG_UP, c2d.Outcome.SLIPPING)
    assert (run.contacts["body_kind"] == c2d.BodyKind.BELLY).any()
    off = run.branch(belly=None)
    assert off.scenario.robot.belly is None
    assert np.array_equal(off.position[0], run.position[-1])
    assert not (off.contacts["body_kind"] == c2d.BodyKind.BELLY).any()
    assert off.outcome is c2d.Outcome.CLEARED
    on = run.branch(belly=ROBOT.belly, duration=1.0)
    assert np.array_equal(on.position, run.branch(duration=1.0).position)


def test_a_push_rises_evenly_to_its_force() -> None:
    """On ice the speed is the impulse over the mass: half the force while it rises, then all."""
    ice = c2d.Scenario(ROBOT, c2d.terrains.flat(friction=0.0), drive=c2d.Drive(speed=0.0))
    run = c2d.simulate(ice, duration=1.0)
    force, rise = 8.0, 0.5
    pushed = run.branch(at=0.5, push=(force, rise), duration=1.0)
    time = pushed.time - pushed.time[0]
    impulse = np.where(time < rise, 0.5 * force * time**2 / rise, force * (time - 0.5 * rise))
    # Within a step the force is its mean: half a step on, its impulse is off by an eighth of h^2.
    off = force / rise * LONGEST_STEP**2 / 8.0 / ROBOT.mass
    assert pushed.velocity[:, 0] == pytest.approx(impulse / ROBOT.mass, abs=off)
    assert pushed.velocity[-1, 0] == pytest.approx(impulse[-1] / ROBOT.mass, abs=1e-9)


def test_a_belt_in_place_of_wheels_with_motors_of_their_own_has_one() -> None:
    run = c2d.simulate(SEIZING.replace({"robot.drivetrain.torque_sharing": "wheel"}))
    (trial,) = (each for each in run.trials() if each.name == "belt")
    changed = run.what_if(track=c2d.BeltTrack())
    assert changed.run.scenario.robot.drivetrain.torque_sharing == "track"
    assert (changed.freed, changed.position) == (trial.freed, trial.position)


def test_a_braked_robot_holds_a_push_up_to_its_friction() -> None:
    stands = c2d.Scenario(ROBOT, c2d.terrains.flat(friction=0.5), drive=c2d.Drive(speed=0.0))
    strong = stands.replace({"robot.drivetrain.max_torque": 100.0})
    run = c2d.simulate(strong, duration=0.5)
    limit = 0.5 * ROBOT.mass * strong.gravity
    for share, slides in ((0.98, False), (1.02, True)):
        pushed = run.branch(at=0.2, push=(share * limit, 0.5), duration=2.0)
        assert (pushed.metrics["distance"] > 1e-3) == slides


def test_its_own_track_can_be_closed(seized: c2d.Run) -> None:
    closed = seized.branch(track="closed", duration=4.0)
    assert closed.scenario.robot.track == c2d.ClosedTrack(c2d.LineOfWheels(4))
    assert closed.outcome is c2d.Outcome.CLEARED


def test_an_unchanged_command_goes_on_where_it_is() -> None:
    """A schedule that has already changed the speed does not start again."""
    drive = c2d.Drive(speed=0.1, schedule=((0.5, 0.3),))
    run = c2d.simulate(c2d.Scenario(ROBOT, c2d.terrains.flat(), drive=drive, duration=4.0))
    branch = run.branch(at=3.0, duration=0.5)
    assert branch.commanded_speed[-1] == pytest.approx(0.3)
    slower = run.branch(at=3.0, drive=c2d.Drive(speed=0.1), duration=1.0)
    assert slower.commanded_speed[-1] == pytest.approx(0.1)


def test_schedules_of_another_command_count_from_the_start_of_the_run(seized: c2d.Run) -> None:
    stopping = c2d.Drive(speed=0.4, schedule=((1.5, 0.0),))
    branch = seized.branch(at=1.0, drive=stopping, duration=1.0)
    whole = c2d.simulate(SEIZING.replace({"drive": stopping, "duration": 2.0}))
    assert branch.position[-1] == pytest.approx(whole.position[-1], abs=1e-9)


def test_a_branch_can_keep_its_summary_alone(seized: c2d.Run) -> None:
    whole = seized.branch(at=1.0, duration=1.0, sample_interval=0.05)
    assert np.diff(whole.time)[1:-1] == pytest.approx(0.05)
    assert whole.time[1:-1] / 0.05 == pytest.approx(np.round(whole.time[1:-1] / 0.05))
    summary = seized.branch(at=1.0, duration=1.0, record="summary")
    assert (summary.outcome, summary.metrics) == (whole.outcome, whole.metrics)
    with pytest.raises(AttributeError, match="record='summary'"):
        _ = summary.time


def test_a_pickled_or_summarised_run_has_the_same_branches(seized: c2d.Run) -> None:
    summary = c2d.simulate(SEIZING, record="summary")
    ends = [
        each.branch(track=c2d.BeltTrack(), duration=1.0).position[-1].tolist()
        for each in (seized, summary, pickle.loads(pickle.dumps(seized)))
    ]
    assert ends[0] == ends[1] == ends[2]


def test_a_branch_survives_pickling_with_its_parent(seized: c2d.Run) -> None:
    branch = seized.branch(at=1.0, duration=0.1)
    twin = pickle.loads(pickle.dumps(branch))
    assert twin.parent == branch.parent
    assert twin.metrics == branch.metrics


@pytest.mark.parametrize("at", [-1, 6.1, 1e9, math.nan, math.inf, None, "stopp", "", True, 1j, [1]])
def test_a_time_outside_of_the_run_is_refused(seized: c2d.Run, at: Any) -> None:
    error = refused(lambda: seized.branch(at=at))
    assert error.path == "at"
    end = seized.metrics["time"]
    assert error.rule == f'must be "stop" or a time from 0 to {end:.6g} s'


def test_a_run_that_did_not_stop_has_no_stop_to_branch_at() -> None:
    run = c2d.simulate(CLEARING, record="summary")
    error = refused(run.branch)
    assert (error.path, error.value) == ("at", "stop")
    assert error.rule.startswith("must be a time from 0 to")
    for call in (run.trials, run.what_if, run.escape_force):
        error = refused(call)
        assert error.path == "run"
        assert error.rule.startswith("must have ended in a stop, not as cleared")
    assert run.branch(at=1.0, duration=0.1).outcome is c2d.Outcome.TIMED_OUT


def test_a_branch_is_not_branched_again(seized: c2d.Run) -> None:
    branch = seized.branch(at=1.0, duration=0.5)
    for call in (lambda: branch.branch(at=1.2), branch.trials, branch.what_if, branch.escape_force):
        error = refused(call)
        assert error.path == "run"
        assert "take the original run" in error.rule


def test_a_run_without_a_result_is_not_branched() -> None:
    wrong = SEIZING.replace({"terrain.height": -1.0})
    (invalid,) = c2d.simulate_many([wrong], on_error="record")
    diverged = c2d.Run(SEIZING, {}, c2d.SimulationDiverged("chassis is not finite"))
    for run, why in ((invalid, "terrain.height must be > 0 m"), (diverged, "not finite")):
        at_once = functools.partial(run.branch, at=0.0)
        for call in (run.branch, at_once, run.trials, run.what_if, run.escape_force):
            error = refused(call)
            assert error.path == "run"
            assert why in error.rule


@pytest.mark.parametrize(
    ("changes", "path"),
    [
        ({"track": "belt"}, "robot.track"),
        ({"track": c2d.BeltTrack}, "robot.track"),
        ({"track": ROBOT}, "robot.track"),
        ({"track": c2d.LineOfWheels(1)}, "robot.track.count"),
        ({"friction": -0.1}, "terrain.friction"),
        ({"friction": math.nan}, "terrain.friction"),
        ({"friction": "0.5"}, "terrain.friction"),
        ({"drive": 0.4}, "drive"),
        ({"drive": c2d.Drive(speed=9.0)}, "drive.speed"),
        ({"max_torque": -1.0}, "robot.drivetrain.max_torque"),
        ({"belly": [(0, 0), (1, 0)]}, "robot.belly"),
        ({"push": 5.0}, "push"),
        ({"push": (5.0,)}, "push"),
        ({"push": (math.nan, 1.0)}, "push"),
        ({"push": (1e17, 1.0)}, "push"),
        ({"push": (5.0, -1.0)}, "push.rise_time"),
        ({"duration": -1.0}, "duration"),
        ({"duration": math.inf}, "duration"),
        ({"sample_interval": 0.0}, "sample_interval"),
        ({"record": "all"}, "record"),
    ],
)
def test_an_impossible_change_is_refused_by_name(
    seized: c2d.Run, changes: dict[str, Any], path: str
) -> None:
    assert refused(lambda: seized.branch(at=1.0, **changes)).path == path


def test_a_branch_goes_on_while_its_push_rises(seized: c2d.Run) -> None:
    """A robot that stands still under a small push may leave under a larger one."""
    low, high = seized.escape_force()
    for force, leaves in ((0.9 * low, False), (1.2 * high, True)):
        branch = seized.branch(push=(force, 6.0), duration=12.0)
        assert branch.time[-1] - branch.time[0] > 8.0 or branch.outcome is c2d.Outcome.CLEARED
        assert (np.hypot(*(branch.position - branch.position[0]).T).max() > 5e-3) == leaves
