"""Many simulations at once."""

import copy
import math
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d

ROBOT = c2d.robots.absolem()
HEIGHTS = (0.03, 0.08, 0.12, 0.2)
DRIVE = c2d.Drive(speed=0.2)
SCENARIOS = [c2d.Scenario(ROBOT, c2d.terrains.step(height), drive=DRIVE) for height in HEIGHTS]


def driven(many: c2d.Simulations, seconds: int = 20) -> c2d.Simulations:
    for k in range(seconds):
        angle = 0.5 * np.sin(0.3 * k + np.arange(len(many)))
        many.command(speed=0.1 + 0.01 * k, flipper_angle=angle, rear_flipper_angle=-angle)
        many.advance(0.05)
    return many


@pytest.mark.parametrize("threads", [1, 3])
def test_each_simulation_has_the_bits_that_it_has_alone(threads: int) -> None:
    state = driven(c2d.Simulations(SCENARIOS, threads=threads)).state()
    for index, scenario in enumerate(SCENARIOS):
        alone = c2d.Simulation(scenario)
        for k in range(20):
            angle = 0.5 * np.sin(0.3 * k + index)
            speed = 0.1 + 0.01 * k
            alone.command(speed=speed, flipper_angle=angle, rear_flipper_angle=-angle)
            alone.advance(0.05)
        own = alone.state()
        assert (state.position[index] == own.position).all()
        assert (state.velocity[index] == own.velocity).all()
        assert state.chassis_angle[index] == own.chassis_angle
        assert (state.flipper_angles[index] == own.flipper_angles).all()
        assert state.time[index] == own.time


def test_a_reset_one_is_as_new_and_the_others_go_on() -> None:
    many, other = (driven(c2d.Simulations(SCENARIOS)) for _ in range(2))
    many.reset([0, 2])
    assert many.state().time.tolist() == pytest.approx([0.0, 1.0, 0.0, 1.0])
    driven(many)
    driven(other)
    fresh = driven(c2d.Simulations(SCENARIOS)).state().position
    assert (many.state().position[[0, 2]] == fresh[[0, 2]]).all()
    assert (many.state().position[[1, 3]] == other.state().position[[1, 3]]).all()
    many.reset(np.array([False, True, False, False]), [SCENARIOS[3]])
    assert many.scenario(1) == SCENARIOS[3]
    assert many.state().time[1] == 0.0


def test_one_goes_on_alone_from_its_snapshot() -> None:
    many = driven(c2d.Simulations(SCENARIOS))
    alone = c2d.Simulation.from_snapshot(many.snapshot(1))
    many.advance(0.5)
    alone.advance(0.5)
    assert (alone.state().position == many.state().position[1]).all()


def test_outcomes_and_stops_are_seen_without_trials() -> None:
    robot = c2d.robots.engineer(flippers=None)
    wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608)).without_rotors()
    low, high = c2d.terrains.step(0.03), c2d.terrains.step(0.075)
    many = c2d.Simulations([c2d.Scenario(robot, low), c2d.Scenario(wheels, high)])
    many.advance(10.0)
    state = many.state()
    assert state.outcome == ("cleared", None)
    assert state.stopped.tolist() == [False, True]
    assert np.isnan(state.flipper_angles).all()


def test_heights_are_those_of_the_ground() -> None:
    many = c2d.Simulations(SCENARIOS)
    x = many.state().position[:, 0]
    found = many.heights([-0.1, 2.0])
    expected = [step.terrain.height_at([x[0] - 0.1, x[0] + 2.0]) for step in SCENARIOS]
    assert found == pytest.approx(np.array(expected))
    assert many.heights([1e9])[:, 0].tolist() == pytest.approx(HEIGHTS)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"speed": [0.1, 0.2]}, r"speed must be one for each of the 4"),
        ({"speed": "fast"}, r"speed must be real numbers"),
        ({"speed": 100.0}, r"drive\.speed"),
        ({"flipper_angle": 7.0}, r"flipper_angle must be"),
    ],
)
def test_commands_that_break_a_rule_change_nothing(given: dict[str, object], message: str) -> None:
    many = c2d.Simulations(SCENARIOS)
    with pytest.raises(c2d.ScenarioError, match=message):
        many.command(**given)  # type: ignore[arg-type]


def test_if_one_command_is_invalid_none_is_applied() -> None:
    many, other = c2d.Simulations(SCENARIOS), c2d.Simulations(SCENARIOS)
    with pytest.raises(c2d.ScenarioError, match=r"drive\.speed"):
        many.command(speed=[0.1, 0.1, 0.1, 100.0])
    for each in (many, other):
        each.advance(1.0)
    assert (many.state().position == other.state().position).all()


def test_what_cannot_be_simulated_is_refused() -> None:
    with pytest.raises(c2d.ScenarioError, match=r"scenarios must be one or more"):
        c2d.Simulations([])
    own = SCENARIOS[0].replace({"drive": c2d.Drive(speed=0.2, gait=lambda _: 0.0)})
    with pytest.raises(c2d.ScenarioError, match=r"drive\.gait must not be a function"):
        c2d.Simulations([own])
    many = c2d.Simulations(SCENARIOS)
    with pytest.raises(c2d.ScenarioError, match=r"which must be different indices from 0 to 3"):
        many.reset([4])
    with pytest.raises(c2d.ScenarioError, match=r"duration must be"):
        many.advance(-1.0)


@pytest.mark.parametrize("given", [SCENARIOS[0], 5, None])
def test_anything_but_a_list_of_scenarios_is_refused(given: Any) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"scenarios must be several"):
        c2d.Simulations(given)
    if given is not None:  # which keeps theirs
        with pytest.raises(c2d.ScenarioError, match=r"scenarios must be several"):
            c2d.Simulations(SCENARIOS).reset([0], given)


@pytest.mark.parametrize("which", [[[0, 1]], [[0], [1, 2]], [0.5], "first", {}, [0, 1, 0]])
def test_invalid_places_are_refused(which: Any) -> None:
    many = c2d.Simulations(SCENARIOS)
    with pytest.raises(c2d.ScenarioError, match=r"which must be different indices from 0 to 3"):
        many.advance(0.1, which)
    with pytest.raises(c2d.ScenarioError, match=r"which must be different indices from 0 to 3"):
        many.reset(which)


@pytest.mark.parametrize("offsets", [[0.1, math.nan], math.inf, "ahead", None, [[1.0], [1.0, 2.0]]])
def test_heights_are_asked_for_at_finite_offsets(offsets: Any) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"offsets must be"):
        c2d.Simulations(SCENARIOS).heights(offsets)


def test_flippers_turn_at_commanded_rates_alone_and_side_by_side() -> None:
    many = c2d.Simulations(SCENARIOS)
    many.command(speed=0.0, flipper_rate=[0.1, 0.2, 0.3, 0.4], rear_flipper_rate=-0.1)
    many.advance(1.0)
    start = ROBOT.flippers.angle if ROBOT.flippers else 0.0
    turned = many.state().flipper_angles - start
    # The motors take some hundredths of a second to get up to their rates.
    assert turned[:, 0] == pytest.approx([0.1, 0.2, 0.3, 0.4], rel=0.05)
    assert turned[:, 1] == pytest.approx(-0.1, rel=0.05)
    alone = c2d.Simulation(SCENARIOS[2])
    alone.command(speed=0.0, flipper_rate=0.3, rear_flipper_rate=-0.1)
    alone.advance(1.0)
    assert (many.state().flipper_angles[2] == alone.state().flipper_angles).all()


@pytest.mark.parametrize(
    ("commands", "path"),
    [
        ({"flipper_rate": 0.1, "flipper_angle": 0.1}, "flipper_rate"),
        ({"rear_flipper_rate": 0.1, "rear_flipper_angle": 0.1}, "rear_flipper_rate"),
        ({"flipper_rate": 1.0}, "flipper_rate"),
        ({"rear_flipper_rate": -1.0}, "rear_flipper_rate"),
    ],
)
def test_a_rate_is_no_faster_than_its_motor_and_not_beside_an_angle(
    commands: dict[str, float], path: str
) -> None:
    for each in (c2d.Simulations(SCENARIOS), c2d.Simulation(SCENARIOS[0])):
        with pytest.raises(c2d.ScenarioError) as failure:
            each.command(**commands)
        assert failure.value.path == path


def test_simulations_in_a_mask_advance_and_the_others_do_not() -> None:
    many = c2d.Simulations(SCENARIOS)
    many.advance(0.2, [True, False, True, False])
    many.advance(0.1, [1])
    assert many.state().time.tolist() == pytest.approx([0.2, 0.1, 0.2, 0.0])
    for wrong in ([4], [True], [0.5]):
        with pytest.raises(c2d.ScenarioError, match="which"):
            many.advance(0.1, wrong)


@pytest.mark.parametrize(
    ("given", "rule"),
    [
        ("0.2", "must be real numbers"),
        (["0.1", "0.2"], "must be real numbers"),
        ([True, False], "must be real numbers"),
        (np.array([0.1 + 2.0j, 0.1]), "must be real numbers"),
        (np.ma.array([0.3, 0.1], mask=[True, False]), "must not be masked"),
    ],
)
def test_values_that_numpy_would_convert_are_no_commands(given: Any, rule: str) -> None:
    robot = c2d.robots.engineer(flippers=None)
    two = c2d.Simulations([c2d.Scenario(robot, c2d.terrains.flat())] * 2)
    for use in (lambda: two.command(speed=given), lambda: two.heights(given)):
        with pytest.raises(c2d.ScenarioError, match=rule):
            use()


def test_simulations_and_heights_for_which_there_is_no_memory_are_refused(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    robot = c2d.robots.engineer(flippers=None)
    flat = c2d.Scenario(robot, c2d.terrains.flat())
    two = c2d.Simulations([flat] * 2)
    monkeypatch.setenv("CRAWLER2D_MEMORY", "0.05")
    assert two.heights(np.zeros(1000)).shape == (2, 1000)
    with pytest.raises(c2d.LimitError, match="heights of the ground"):
        two.heights(np.zeros(2_000_000))
    with pytest.raises(c2d.LimitError, match="simulations side by side"):
        c2d.Simulations([flat] * 1000)


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, pickle.dumps])
def test_many_are_not_copied(copied: Callable[[object], object]) -> None:
    """A shallow copy advanced the robots of the original."""
    many = c2d.Simulations(SCENARIOS[:1])
    with pytest.raises(TypeError, match="Simulations cannot be copied or pickled"):
        copied(many)
