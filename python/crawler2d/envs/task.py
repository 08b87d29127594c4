"""The task of a policy: actions to commands, states to observations and rewards."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, cast, get_args

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import read_bool, real_number
from crawler2d.common.keywords import read_choice
from crawler2d.envs.scenarios import read_scenario
from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.results.outcome import Outcome
from crawler2d.runs.simulations import Simulations, States
from crawler2d.sweeps.plan import Planner, World
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["ENDING", "FlipperCommand", "Observe", "Rewards", "Task", "flipper_ends"]

Observe = Literal["proprioception", "privileged"]
FlipperCommand = Literal["rate", "angle"]
_VIEWS, _COMMANDS = get_args(Observe), get_args(FlipperCommand)

_FASTEST_TURN = 20.0
"""[rad/s] Limit of the observed rate of the chassis."""
_FARTHEST_HEIGHT = 5.0
"""[m] Limit of the observed heights, relative to the chassis."""

ENDING = 1.0
"""[m] Reward for clearing and cost of tipping over: about the distance of an episode."""

_HEIGHTS = np.linspace(-1.0, 2.0, 16)
"""[-] Positions of a privileged policy's heights, in axle distances from the chassis frame."""


@dataclass(frozen=True, slots=True)
class Rewards:
    """The terms of N rewards; each reward is their sum.

    Attributes
    ----------
    progress : ndarray, shape (N,)
        [m] Progress towards the goal.
    shock : ndarray, shape (N,)
        [m] Minus the height of a free fall that reaches the change of the chassis' velocity.
    effort : ndarray, shape (N,)
        [m] Minus the height to which the work of all motors would lift the robot.
    ending : ndarray, shape (N,)
        [m] `ENDING` after clearing, minus `ENDING` after any other termination.
    """

    progress: NDArray[np.float64]
    shock: NDArray[np.float64]
    effort: NDArray[np.float64]
    ending: NDArray[np.float64]

    @property
    def total(self) -> NDArray[np.float64]:
        """[m] Their sum."""
        return self.progress + self.shock + self.effort + self.ending


@dataclass(frozen=True, kw_only=True)
class Task:
    """A task, the same for any number of episodes.

    Attributes
    ----------
    scenario : Scenario
        The scenario before any draw.
    planner, world : Planner, World
        Distributions for each episode, and the nominal values.
    dt : float
        [s] Time between two actions; the last one may be shorter.
    sees_heights : bool
        Whether the policy observes the ground.
    commands_angles : bool
        Whether it commands flipper angles instead of rates.
    ends_when_stopped : bool
        Whether a stop ends an episode.
    weights : tuple of float
        [-] Weights of shock and effort.
    """

    scenario: Scenario
    planner: Planner
    world: World
    dt: float
    sees_heights: bool
    commands_angles: bool
    ends_when_stopped: bool
    weights: tuple[float, float]

    @classmethod
    def read(
        cls,
        scenario: Scenario | str,
        *,
        terrain: Terrain | None,
        randomize: Mapping[str, Any] | None,
        dt: float,
        observe: Observe,
        flipper_command: FlipperCommand,
        end_when_stopped: bool,
        shock_weight: float,
        effort_weight: float,
    ) -> Task:
        """Read the arguments of an environment, see `FlipperEnv`.

        Raises
        ------
        ScenarioError
            If an argument breaks a rule.
        """
        scenario, vary = read_scenario(scenario, terrain, randomize)
        varied = Variation.read(scenario, vary, (), "randomize")
        planner = Planner(varied, unknowns=Variation({}), seed=0)
        (world,) = planner.worlds(scenario, ())
        middle = dict.fromkeys(varied.distributions, np.array([0.5]))
        for each in (world.checked, *planner.draw(world, middle, 1)[0]):
            if isinstance(each, ScenarioError):
                raise each
        dt = real_number(dt, "dt")
        if not 1e-3 <= dt <= scenario.duration:
            rule = f"must be >= 0.001 s and <= the duration, {scenario.duration:g} s"
            raise ScenarioError("dt", dt, rule)
        if not scenario.gravity > 0.0:
            rule = "must be > 0 m/s^2: shock and effort are measured in it"
            raise ScenarioError("gravity", scenario.gravity, rule)
        return cls(
            scenario=scenario,
            planner=planner,
            world=world,
            dt=dt,
            sees_heights=read_choice(observe, "observe", _VIEWS) == "privileged",
            commands_angles=read_choice(flipper_command, "flipper_command", _COMMANDS) == "angle",
            ends_when_stopped=read_bool(end_when_stopped, "end_when_stopped"),
            weights=(
                _weight(shock_weight, "shock_weight"),
                _weight(effort_weight, "effort_weight"),
            ),
        )

    @functools.cached_property
    def ends(self) -> list[int]:
        """Columns of the existing flippers: 0 front, 1 rear."""
        return flipper_ends(self.scenario.robot)

    @functools.cached_property
    def offsets(self) -> NDArray[np.float64]:
        """[m] Positions of a privileged policy's heights, along x from the chassis frame."""
        return self.scenario.robot.outline.axle_distance * _HEIGHTS

    @functools.cached_property
    def names(self) -> list[str]:
        """Names of the observed numbers."""
        ends = [("front", "rear")[k] for k in self.ends]
        names = ["pitch", "pitch_rate", "track_speed"]
        names += [f"{end}_{what}" for what in ("angle", "torque") for end in ends]
        return names + [f"height[{x:+.2f} m]" for x in self.offsets if self.sees_heights]

    @functools.cached_property
    def bounds(self) -> NDArray[np.float32]:
        """Limits of the observed numbers."""
        robot = self.scenario.robot
        bounds = [np.pi, _FASTEST_TURN, 2.0 * robot.drivetrain.max_speed]
        if robot.flippers:
            bounds += [np.pi] * len(self.ends)
            bounds += [2.0 * robot.flippers.torque_limit] * len(self.ends)
        bounds += [_FARTHEST_HEIGHT] * (len(self.names) - len(bounds))
        return np.array(bounds, np.float32)

    def draw(self, generators: list[np.random.Generator]) -> list[_core.PreparedScenario]:
        """Draw the scenario of one episode from each generator.

        Raises
        ------
        ScenarioError
            If a drawn scenario breaks a rule.
        """
        paths = self.planner.variation.distributions
        rows = np.array([each.random(len(paths)) for each in generators])
        numbers = dict(zip(paths, rows.T, strict=True))
        drawn, _ = self.planner.draw(self.world, numbers, len(generators))
        for each in drawn:
            if isinstance(each, ScenarioError):
                raise each
        return cast("list[_core.PreparedScenario]", drawn)

    def commands(
        self, actions: NDArray[np.float64], full: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], ...]:
        """Return speeds, shape (N,), and angles or rates of the flippers, shape (N, 2).

        `full` are the speeds of full actions [m/s].
        """
        flippers = self.scenario.robot.flippers
        values = np.full((len(actions), 2), np.nan)
        if flippers is not None:
            most = np.pi if self.commands_angles else flippers.rate_limit
            values[:, self.ends] = most * actions[:, 1:]
        return actions[:, 0] * full, values

    def observe(self, many: Simulations, states: States) -> NDArray[np.float32]:
        """Return the observations, shape (N, number of names), with 0 for non-finite numbers."""
        ends, (count,) = self.ends, states.time.shape
        seen = np.empty((count, len(self.names)))
        seen[:, 0] = _wrapped(states.chassis_angle)
        seen[:, 1] = states.angular_velocity
        seen[:, 2] = states.track_speed
        past = 3 + 2 * len(ends)
        if ends:
            seen[:, 3 : 3 + len(ends)] = _wrapped(states.flipper_angles[:, ends])
            seen[:, 3 + len(ends) : past] = states.flipper_torques[:, ends]
        if self.sees_heights:
            seen[:, past:] = many.heights(self.offsets) - states.position[:, 1:]
        seen[states.failed] = 0.0
        np.clip(seen, -self.bounds, self.bounds, out=seen)
        return seen.astype(np.float32)

    def rewards(self, before: States, after: States) -> Rewards:
        """Return the terms of the rewards of a step; 0 for an episode that failed in it."""
        robot, gravity = self.scenario.robot, self.scenario.gravity
        of_shock, of_effort = self.weights
        change = ((after.velocity - before.velocity) ** 2).sum(axis=1)
        work = after.drive_work - before.drive_work
        if self.ends:
            power = after.flipper_torques[:, self.ends] * after.flipper_rates[:, self.ends]
            work += np.abs(power).sum(axis=1) * (after.time - before.time)
        ending = np.zeros(len(work))
        for index in after.ended:
            ending[index] = ENDING if after.outcome[index] == Outcome.CLEARED else -ENDING
        terms = Rewards(
            np.maximum(before.to_goal, 0.0) - np.maximum(after.to_goal, 0.0),
            change * (-of_shock / (2.0 * gravity)),
            work * (-of_effort / (robot.mass * gravity)),
            ending,
        )
        failed = after.failed
        for each in (terms.progress, terms.shock, terms.effort, terms.ending):
            each[failed] = 0.0
        return terms


def flipper_ends(robot: Robot) -> list[int]:
    """Return the columns of a robot's flippers: 0 front, 1 rear."""
    names = ("front", "rear")
    return [k for k in (0, 1) if robot.flippers and robot.flippers.ends in ("both", names[k])]


def _wrapped(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """[rad] Wrap angles to the range from -pi to pi."""
    wrapped: NDArray[np.float64] = np.remainder(angles + np.pi, 2.0 * np.pi) - np.pi
    return wrapped


def _weight(value: float, name: str) -> float:
    weight = real_number(value, name)
    if not 0.0 <= weight < np.inf:
        raise ScenarioError(name, weight, "must be >= 0 and finite")
    return weight
