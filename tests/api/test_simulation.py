"""A simulation under the caller's control."""

import copy
import pickle
import threading
import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario


@pytest.fixture
def seizing() -> Scenario:
    track = c2d.LineOfWheels(4, wheel_radius=0.0608)
    return Scenario(c2d.robots.engineer(flippers=None, track=track), c2d.terrains.step(0.1))


def test_an_advance_gives_the_run_and_ends_at_the_requested_time(scenario: Scenario) -> None:
    run = c2d.simulate(scenario, duration=1.2345)
    sim = c2d.Simulation(scenario)
    sim.advance(1.2345)
    state = sim.state()
    assert sim.time == state.time == run.time[-1] == 1.2345
    assert np.array_equal(state.position, run.position[-1])
    assert np.array_equal(state.velocity, run.velocity[-1])
    assert state.chassis_angle == run.chassis_angle[-1]
    assert state.track_position == run.track_position[-1]


def test_an_advance_in_pieces_ends_where_one_in_one_piece_does(scenario: Scenario) -> None:
    sim, whole = c2d.Simulation(scenario), c2d.Simulation(scenario)
    whole.advance(1.0)
    for duration in (0.1, 0.25, 0.001, 0.0, 0.149, 0.5):
        sim.advance(duration)
    state = sim.state()
    assert sim.time == whole.time == 1.0
    assert sim.snapshot() != whole.snapshot()  # other steps
    # On level ground a steady acceleration is followed exactly, except for the contacts' softness.
    for name in ("position", "velocity", "chassis_angle", "track_position"):
        assert getattr(state, name) == pytest.approx(getattr(whole.state(), name), abs=1e-9)


def test_a_new_simulation_stands_at_the_start(scenario: Scenario) -> None:
    state = c2d.Simulation(scenario).state()
    outline = scenario.robot.outline
    nose = state.position[0] + 0.5 * outline.axle_distance + outline.front_radius
    assert state.time == 0.0
    assert nose == pytest.approx(-scenario.start.approach)
    assert state.velocity.tolist() == [0.0, 0.0]
    assert state.outcome is None


def test_a_command_is_followed_within_the_limits_of_the_drivetrain(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario.replace({"terrain": c2d.terrains.flat(), "drive.speed": 0.0}))
    sim.advance(0.5)
    assert sim.state().commanded_speed == 0.0
    sim.command(speed=0.1)
    sim.advance(0.25)
    assert sim.state().commanded_speed == pytest.approx(0.05)  # 0.2 m/s^2
    sim.command()
    sim.advance(1.0)
    assert sim.state().track_speed == pytest.approx(0.1, rel=1e-6)
    sim.command(speed=-0.1)
    sim.advance(2.0)
    assert sim.state().velocity[0] == pytest.approx(-0.1, rel=1e-3)


@pytest.mark.parametrize("at", [0.0, 0.5])
def test_a_command_at_the_instant_of_an_entry_takes_its_place(
    scenario: Scenario, at: float
) -> None:
    drive = replace(scenario.drive, schedule=((at, 0.3), (1.5, 0.2)))
    sim = c2d.Simulation(replace(scenario, drive=drive))
    sim.advance(at)
    sim.command(speed=0.1)
    sim.advance(0.5)
    assert sim.state().commanded_speed == 0.1
    sim.advance(1.6)
    assert sim.state().commanded_speed == 0.2


def test_an_outcome_is_reported_and_does_not_end_the_simulation(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(6.0)
    assert sim.state().outcome is c2d.Outcome.CLEARED
    before = sim.state().position[0]
    sim.advance(1.0)
    assert sim.state().position[0] > before + 0.3


def test_the_outcome_of_a_run_that_has_ended_is_judged_once(seizing: Scenario) -> None:
    """Judging a stop takes trials of 40 to 90 ms."""
    sim = c2d.Simulation(seizing)
    sim.advance(10.0)
    assert sim.state().outcome is c2d.Outcome.SEIZED
    begin = time.process_time()
    for _ in range(100):
        sim.advance(0.01)
        assert sim.state().outcome is c2d.Outcome.SEIZED
    assert time.process_time() - begin < 1.0


@pytest.mark.parametrize("asked_before", [True, False])
def test_commands_after_the_end_do_not_change_the_outcome(
    seizing: Scenario, asked_before: bool
) -> None:
    sim = c2d.Simulation(seizing)
    sim.advance(10.0)
    if asked_before:
        assert sim.state().outcome is c2d.Outcome.SEIZED
    before = sim.state().position[0] if asked_before else None
    sim.command(speed=-0.4)
    sim.advance(3.0)
    state = sim.state()
    assert state.velocity[0] < -0.3
    assert before is None or state.position[0] < before - 0.3
    assert state.outcome is c2d.Outcome.SEIZED


def test_contacts_of_a_state_are_those_of_its_instant_whenever_they_are_read(
    scenario: Scenario,
) -> None:
    sim, twin = c2d.Simulation(scenario), c2d.Simulation(scenario)
    for each in (sim, twin):
        each.advance(1.0)
    late, now = sim.state().contacts, dict(twin.state().contacts)
    sim.advance(1.0)
    copied = pickle.loads(pickle.dumps(late))
    assert list(late) == list(now) == list(copied)
    for name, column in now.items():
        assert np.array_equal(late[name], column)
        assert np.array_equal(copied[name], column)
    assert late["x"] is late["x"]


def test_a_state_does_not_change_afterwards(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.5)
    state = sim.state()
    x, contacts = state.position[0], len(state.contacts)
    sim.advance(0.5)
    assert (state.position[0], len(state.contacts)) == (x, contacts)
    assert contacts > 0
    with pytest.raises(ValueError, match="read-only"):
        state.position[0] = 0.0


@pytest.mark.parametrize("duration", [-1.0, np.nan, np.inf, 1e9, "1", None, True, 1j, [1.0]])
def test_an_impossible_duration_is_refused(scenario: Scenario, duration: Any) -> None:
    sim = c2d.Simulation(scenario)
    with pytest.raises(c2d.ScenarioError) as caught:
        sim.advance(duration)
    assert caught.value.path == "duration"
    half: Any = np.float32(0.5)
    sim.advance(half)
    assert sim.time == pytest.approx(0.5)


@pytest.mark.parametrize("speed", [np.nan, np.inf, 1.4, -1.4, "0.1", True])
def test_an_impossible_speed_is_refused_and_changes_nothing(scenario: Scenario, speed: Any) -> None:
    sim, twin = c2d.Simulation(scenario), c2d.Simulation(scenario)
    with pytest.raises(c2d.ScenarioError) as caught:
        sim.command(speed=speed)
    assert caught.value.path == "drive.speed"
    sim.advance(0.5)
    twin.advance(0.5)
    assert np.array_equal(sim.state().position, twin.state().position)


@pytest.mark.parametrize("wrong", ["scenario", None, c2d.robots.engineer(flippers=None)])
def test_what_is_no_scenario_is_refused(wrong: Any) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.Simulation(wrong)
    assert caught.value.path == "scenario"


def test_a_broken_scenario_is_refused(scenario: Scenario) -> None:
    with pytest.raises(c2d.ScenarioError) as caught:
        c2d.Simulation(scenario.replace({"robot.mass": 0.0}))
    assert caught.value.path == "robot.mass"


def pickled(sim: c2d.Simulation) -> c2d.Simulation:
    twin: c2d.Simulation = pickle.loads(pickle.dumps(sim))
    return twin


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickled])
def test_a_copied_simulation_goes_its_own_way(scenario: Scenario, copied: Any) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.5)
    before = sim.snapshot()
    twin = copied(sim)
    assert type(twin) is c2d.Simulation
    assert twin.scenario == scenario
    assert twin.snapshot() == before
    twin.command(speed=-0.1)
    twin.advance(0.5)
    assert sim.snapshot() == before
    assert sim.time == pytest.approx(0.5)


def test_threads_take_turns_on_one_simulation(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)

    def work() -> None:
        for _ in range(50):
            sim.advance(0.002)
            sim.state()

    threads = [threading.Thread(target=work) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(timeout=60.0)
    assert sim.time == pytest.approx(4 * 50 * 0.002)
    alone = c2d.Simulation(scenario)
    for _ in range(4 * 50):
        alone.advance(0.002)
    assert alone.snapshot() == sim.snapshot()


def test_the_repr_says_how_far_it_is(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.25)
    assert repr(sim) == "Simulation(engineer at 0.250 s)"


def used(scenario: Scenario) -> c2d.Simulation:
    """A simulation that has been driven, commanded and pushed."""
    sim = c2d.Simulation(scenario)
    sim.advance(1.0)
    sim.command(speed=-0.2, push=20.0)
    sim.advance(0.5)
    return sim


def test_after_a_reset_it_goes_the_way_of_a_new_one_bit_by_bit(scenario: Scenario) -> None:
    sim, new = used(scenario), c2d.Simulation(scenario)
    assert sim.snapshot() != new.snapshot()
    sim.reset()
    assert sim.time == 0.0
    for _ in range(2):
        assert sim.snapshot() == new.snapshot()
        for each in (sim, new):
            each.advance(1.5)


def test_a_reset_forgets_the_outcome(seizing: Scenario) -> None:
    sim = c2d.Simulation(seizing)
    sim.advance(10.0)
    assert sim.state().outcome is c2d.Outcome.SEIZED
    sim.reset()
    assert sim.state().outcome is None


def test_a_reset_can_change_the_start_and_keeps_it(scenario: Scenario) -> None:
    start = c2d.Start(approach=0.3, track_phase=0.01)
    sim, new = used(scenario), c2d.Simulation(scenario.replace({"start": start}))
    sim.reset(start)
    assert sim.scenario == new.scenario
    assert sim.snapshot() == new.snapshot()
    sim.advance(1.0)
    sim.reset()
    assert sim.snapshot() == new.snapshot()


def test_a_restored_simulation_can_be_reset_to_its_start(scenario: Scenario) -> None:
    sim = c2d.Simulation.from_snapshot(used(scenario).snapshot())
    sim.reset()
    assert sim.snapshot() == c2d.Simulation(scenario).snapshot()


@pytest.mark.parametrize(
    ("start", "path"), [(c2d.Start(approach=-1.0), "start.approach"), (0.3, "start")]
)
def test_an_impossible_start_is_refused_and_changes_nothing(
    scenario: Scenario, start: Any, path: str
) -> None:
    sim = used(scenario)
    before = sim.snapshot()
    with pytest.raises(c2d.ScenarioError) as caught:
        sim.reset(start)
    assert caught.value.path == path
    assert sim.snapshot() == before
    assert sim.scenario == scenario


def test_warnings_are_given_once_and_not_at_every_reset(scenario: Scenario) -> None:
    heavy = scenario.replace({"gravity": 40.0})
    with pytest.warns(c2d.ScenarioWarning, match="gravity"):
        sim = c2d.Simulation(heavy)
    sim.reset()  # warnings are errors
    with pytest.warns(c2d.ScenarioWarning, match="gravity"):
        sim.reset(c2d.Start())


def test_metrics_of_a_copy_count_all_that_it_has_done(seizing: Scenario) -> None:
    original = c2d.Simulation(seizing)
    original.advance(1.0)
    twin = copy.copy(original)
    for sim in (original, twin):
        sim.advance(0.5)
    whole, later = original.to_run(), twin.to_run()
    assert later.time[0] == 1.0
    assert later.metrics == whole.metrics
    assert later.metrics["distance"] == whole.position[-1, 0] - whole.position[0, 0]


@pytest.mark.parametrize("speed", [0.0, -0.4, 1e-6])
def test_after_another_command_there_is_no_stop_until_the_robot_has_stopped_again(
    seizing: Scenario, speed: float
) -> None:
    sim = c2d.Simulation(seizing)
    sim.advance(5.0)
    found = sim.diagnosis()
    assert found is not None
    sim.command(speed=speed)
    if speed > 0.0:
        # A slower command in the same direction frees nothing; its trials last as long as allowed.
        assert sim.to_run(trials=()).diagnosis is not None
    else:
        assert sim.diagnosis() is None


def test_without_gravity_an_escape_force_is_refused() -> None:
    robot = c2d.robots.engineer(flippers=None, track=c2d.BeltTrack())
    still = replace(robot, drivetrain=replace(robot.drivetrain, max_torque=0.0))
    run = c2d.simulate(c2d.Scenario(still, c2d.terrains.flat(), gravity=0.0, duration=6.0))
    with pytest.raises(c2d.ScenarioError, match="gravity must be > 0 for an escape force"):
        run.escape_force()
