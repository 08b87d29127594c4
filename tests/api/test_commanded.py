"""Simulations that are commanded by hand or by a function, and their runs."""

import _thread
import copy
import pickle
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.simulation import State

# With arms so short that they stay off the ground at the angles of these tests.
WHEELS = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4, wheel_radius=0.0608))
TWO_ENDS = (
    c2d.robots.engineer()
    .without_flippers()
    .with_flippers(
        c2d.Flippers(
            length=0.2,
            root_radius=0.03,
            tip_radius=0.02,
            mass=0.5,
            ends="both",
            torque_limit=20.0,
        )
    )
)


def test_a_simulation_that_is_left_alone_makes_the_run_of_its_scenario(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(1.25)
    run, expected = sim.to_run(), c2d.simulate(scenario, duration=1.25)
    for name in ("time", "position", "drive_force", "drive_positions"):
        assert np.array_equal(getattr(run, name), getattr(expected, name))
    assert run.metrics == expected.metrics
    assert dict(run.contacts).keys() == dict(expected.contacts).keys()


def test_a_run_repeats_every_command_and_every_piece(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    for duration, speed, push in ((0.3, 0.1, None), (0.017, None, -3.0), (0.5, -0.2, 0.0)):
        sim.advance(duration)
        sim.command(speed=speed, push=push)
    sim.advance(0.4)
    run, state = sim.to_run(), sim.state()
    assert run.metrics["time"] == sim.time
    for name in ("position", "velocity", "drive_positions", "flipper_angles"):
        assert np.array_equal(getattr(run, name)[-1], getattr(state, name))
    assert run.commanded_speed[0] == 0.0
    assert run.commanded_speed[-1] < 0.0


def test_a_refused_command_is_no_part_of_the_run(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.2)
    with pytest.raises(c2d.ScenarioError):
        sim.command(speed=1e3)
    sim.advance(0.2)
    assert np.array_equal(sim.to_run().position[-1], sim.state().position)


def test_a_run_repeats_an_advance_that_was_interrupted() -> None:
    sim = c2d.Simulation(Scenario(WHEELS, c2d.terrains.step(0.13)))
    threading.Timer(0.05, _thread.interrupt_main).start()
    with pytest.raises(KeyboardInterrupt):
        sim.advance(1e4)
    sim.command(speed=-0.1)
    sim.advance(0.013)
    run = sim.to_run()
    assert run.time[-1] == sim.time
    assert np.array_equal(run.position[-1], sim.state().position)


def test_a_run_of_a_copy_begins_where_it_was_copied(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.5)
    other = copy.copy(sim)
    other.advance(0.25)
    run = other.to_run()
    assert (run.time[0], run.time[-1]) == (0.5, 0.75)
    assert run.parent is not None
    assert run.parent[1] == 0.5
    assert np.array_equal(run.position[-1], other.state().position)


def test_a_run_after_a_reset_forgets_what_was_before(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    sim.command(speed=-0.3)
    sim.advance(0.5)
    sim.reset()
    sim.advance(0.2)
    run = sim.to_run()
    assert run.metrics["time"] == 0.2
    assert run.commanded_speed[-1] > 0.0


def test_a_stop_under_commands_is_explained_but_not_repeated() -> None:
    sim = c2d.Simulation(Scenario(WHEELS, c2d.terrains.step(0.1)))
    sim.command(speed=0.3)
    sim.advance(6.0)
    run = sim.to_run(trials=["friction x 2"])
    assert run.outcome == sim.state().outcome == c2d.Outcome.SEIZED
    assert run.diagnosis is not None
    assert "friction x 2" in [trial.name for trial in run.diagnosis.trials]
    for repeat in (run.branch, run.trials, run.escape_force, run.cross_check):
        with pytest.raises(c2d.ScenarioError, match="or a run of a Simulation"):
            repeat()


def test_a_run_under_commands_is_saved_and_drawn(scenario: Scenario, tmp_path: Path) -> None:
    sim = c2d.Simulation(scenario)
    sim.advance(0.3)
    sim.command(speed=0.1)
    sim.advance(0.3)
    run = sim.to_run()
    again = c2d.load(run.save(tmp_path / "by_hand.npz"))
    assert again.parent == run.parent
    assert again.plot().get_xlabel() == "x [m]"


def test_a_thread_that_commands_waits_for_the_one_that_advances(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario)
    thread = threading.Thread(target=sim.advance, args=(2.0,))
    thread.start()
    sim.command(speed=0.05)
    thread.join()
    assert np.array_equal(sim.to_run().position[-1], sim.state().position)


def test_the_side_view_of_an_instant_has_its_contacts() -> None:
    sim = c2d.Simulation(Scenario(TWO_ENDS, c2d.terrains.step(0.05)))
    sim.advance(1.0)
    ax = sim.plot()
    legend = ax.get_legend()
    assert legend is not None
    texts = [text.get_text() for text in legend.get_texts()]
    assert any(text.startswith("contact force") for text in texts)
    assert ax.get_title("left").endswith("step: 1.00 s")


def test_a_gait_may_be_a_function() -> None:
    def gait(state: State) -> tuple[float, float]:
        asked.append(state.time)
        return 0.5 * state.time, -0.3

    asked: list[float] = []
    drive = c2d.Drive(speed=0.1, gait=gait)
    sim = c2d.Simulation(Scenario(TWO_ENDS, c2d.terrains.flat(), drive=drive))
    for duration in (0.015, 0.0, 0.02, 0.2, 0.765):
        sim.advance(duration)
    assert sim.time == pytest.approx(1.0, abs=1e-12)
    assert asked == pytest.approx(np.arange(100) / 100.0, abs=1e-9)
    # The arms turn at 1 rad/s at most, and follow a ramp of half of that.
    front, rear = sim.state().flipper_angles
    assert front == pytest.approx(0.495, abs=0.01)
    assert rear == pytest.approx(-0.3, abs=0.01)
    assert np.array_equal(sim.to_run().position[-1], sim.state().position)


@pytest.mark.parametrize("gait", [c2d.Hold(0.4), lambda _: (0.4, 0.4)])
def test_a_command_overrides_the_gait_of_its_end_until_a_reset(gait: Any) -> None:
    drive = c2d.Drive(speed=0.0, gait=gait)
    sim = c2d.Simulation(Scenario(TWO_ENDS, c2d.terrains.flat(), drive=drive))
    sim.command(rear_flipper_angle=0.1)
    sim.advance(1.5)
    assert sim.state().flipper_angles == pytest.approx([0.4, 0.1], abs=0.01)
    sim.command(flipper_rate=0.0)
    sim.command(rear_flipper_rate=-0.2)
    sim.advance(0.5)
    assert sim.state().flipper_angles == pytest.approx([0.4, 0.0], abs=0.02)
    with pytest.raises(c2d.ScenarioError):
        sim.command(flipper_angle=100.0)
    sim.reset()
    sim.advance(1.5)
    assert sim.state().flipper_angles == pytest.approx([0.4, 0.4], abs=0.01)


def test_a_function_is_asked_again_after_a_reset() -> None:
    calls: list[float] = []
    drive = c2d.Drive(gait=lambda state: calls.append(state.time))
    sim = c2d.Simulation(Scenario(TWO_ENDS, c2d.terrains.flat(), drive=drive))
    sim.advance(0.05)
    sim.reset()
    sim.advance(0.05)
    assert len(calls) == 10
    assert calls[:5] == calls[5:]


@pytest.mark.parametrize("angles", [(0.1, 0.2, 0.3), ([0.1, 0.2], 0.3)])
def test_a_gait_that_returns_no_pair_of_numbers_is_refused(angles: Any) -> None:
    drive = c2d.Drive(gait=lambda _: angles)
    sim = c2d.Simulation(Scenario(TWO_ENDS, c2d.terrains.flat(), drive=drive))
    with pytest.raises(c2d.ScenarioError, match=r"drive\.gait must return an angle, a pair of"):
        sim.advance(0.1)


@pytest.mark.parametrize("duration", [np.inf, 1e9])
def test_an_endless_advance_with_a_gait_that_is_a_function_is_refused(duration: float) -> None:
    sim = c2d.Simulation(
        Scenario(TWO_ENDS, c2d.terrains.flat(), drive=c2d.Drive(gait=lambda _: 1 / 0))
    )
    with pytest.raises(c2d.ScenarioError) as caught:
        sim.advance(duration)
    assert caught.value.path == "duration"


def test_an_exception_of_a_gait_function_propagates_and_the_simulation_goes_on() -> None:
    def gait(state: State) -> float:
        if state.time == 0.0:
            raise ZeroDivisionError
        return 0.2

    sim = c2d.Simulation(Scenario(TWO_ENDS, c2d.terrains.flat(), drive=c2d.Drive(gait=gait)))
    with pytest.raises(ZeroDivisionError):
        sim.advance(0.1)
    sim.advance(0.1)
    assert sim.time == pytest.approx(0.1)


def test_a_function_is_for_a_simulation_alone(tmp_path: Path) -> None:
    scenario = Scenario(TWO_ENDS, c2d.terrains.flat(), drive=c2d.Drive(gait=lambda _: 0.1))
    sim = c2d.Simulation(scenario)
    refused = (
        scenario.to_json,
        lambda: scenario.identity,
        lambda: c2d.simulate(scenario),
        lambda: c2d.simulate_many([scenario]),
        lambda: c2d.sweep(scenario, {"start.approach": [0.1]}, repeats=1),
        lambda: c2d.sweep(scenario, {"start.approach": [0.1]}, store=tmp_path / "s", repeats=1),
        sim.snapshot,
        lambda: copy.copy(sim),
        lambda: pickle.dumps(sim),
    )
    for use in refused:
        with pytest.raises(c2d.ScenarioError, match=r"drive\.gait.*must not be a function"):
            use()


def test_a_robot_without_flippers_has_no_use_for_a_function(scenario: Scenario) -> None:
    sim = c2d.Simulation(scenario.replace({"drive.gait": lambda _: 1.0}))
    sim.advance(0.5)
    other = c2d.Simulation(scenario)
    other.advance(0.5)
    assert np.array_equal(sim.state().position, other.state().position)


def test_the_flippers_of_each_end_are_held_at_their_own_angle() -> None:
    gait = c2d.Hold(0.2, ((1.0, 0.6),), rear=-0.4)
    run = c2d.simulate(TWO_ENDS, c2d.terrains.flat(), drive=c2d.Drive(gait=gait), duration=2.0)
    before = np.searchsorted(run.time, 0.99)
    # While they hold, the motors yield by less than this under the weight of the arms.
    assert run.flipper_angles[before] == pytest.approx([0.2, -0.4], abs=1e-3)
    assert run.flipper_angles[-1] == pytest.approx([0.6, -0.4], abs=1e-3)


def test_angles_of_each_end_are_written_only_where_they_are_given() -> None:
    def text(gait: c2d.Hold) -> str:
        return Scenario(TWO_ENDS, c2d.terrains.flat(), drive=c2d.Drive(gait=gait)).to_json()

    assert '"front"' not in text(c2d.Hold(0.3)).partition('"gait"')[2].partition("}")[0]
    both = text(c2d.Hold(front=0.3, rear=-0.1))
    gait = Scenario.from_json(both).drive.gait
    assert gait == c2d.Hold(front=0.3, rear=-0.1)
    assert Scenario.from_json(both).to_json() == both


@pytest.mark.parametrize("end", ["front", "rear"])
def test_an_angle_of_one_end_has_the_limits_of_both(end: str) -> None:
    gait = c2d.Hold(front=7.0) if end == "front" else c2d.Hold(rear=7.0)
    scenario = Scenario(TWO_ENDS, c2d.terrains.flat(), drive=c2d.Drive(gait=gait))
    with pytest.raises(c2d.ScenarioError, match=rf"drive\.gait\.{end}.*6\.3"):
        scenario.validate()
