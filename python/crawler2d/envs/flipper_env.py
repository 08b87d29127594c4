"""A Gymnasium environment in which a policy drives one robot over obstacles."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Self

import gymnasium
import numpy as np
from gymnasium.utils import EzPickle

from crawler2d.common.keywords import TakesKeywords
from crawler2d.envs.episodes import Episodes, Step
from crawler2d.envs.supply import Supply
from crawler2d.envs.task import FlipperCommand, Observe, Task
from crawler2d.errors import ArgumentError, ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.runs.run import Run

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.runs.simulations import States

__all__ = [
    "METADATA",
    "FlipperEnv",
    "TakesMadeKeywords",
    "check_render_mode",
    "metadata_of",
    "spaces_of",
    "task_of",
]

METADATA: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": 20}
"""Metadata of both environments; `metadata_of` sets `render_fps` for other values of `dt`."""


_OF_ITSELF = ("num_envs", "render_mode", "autoreset_mode", "threads")
"""Arguments of an environment that do not belong to its task."""


class TakesMadeKeywords(TakesKeywords):
    """Base of objects that Gymnasium makes, which re-raises any TypeError from its text alone."""

    def __new__(cls, *given: Any, **keywords: Any) -> Self:
        """Check the keywords; `__init__` takes them."""
        try:
            return super().__new__(cls, *given, **keywords)
        except ArgumentError as error:
            raise TypeError(str(error)) from None


class FlipperEnv(TakesMadeKeywords, gymnasium.Env, EzPickle):
    """A robot on obstacles; a policy commands its tracks and flippers.

    An action holds the track speed, as a fraction of the scenario's `drive.speed`, then for each
    end with flippers, front first, a rate as a fraction of their `rate_limit` or an angle as a
    fraction of half a turn: numbers from -1 to 1, shape (1 to 3,), clipped to that range. The
    motors follow within their own limits.

    An observation holds pitch [rad], its rate [rad/s], track speed [m/s], and for each end with
    flippers their angle [rad] and torque [N m], the sum of both sides. A privileged one also holds
    16 heights of the ground [m], relative to the origin of the chassis frame, from one axle
    distance behind it to two ahead. `observation_names` lists them.

    The reward of a step is the progress towards the goal [m], minus two weighted penalties: shock,
    the height of a free fall that reaches the change of the chassis' velocity, and effort, the
    height to which the work of the motors would lift the robot. The end of an episode adds 1 m if
    it clears, and subtracts 1 m if it is terminated otherwise. ``info`` has the terms as
    `reward_progress`, `reward_shock`, `reward_effort` and `reward_ending`.

    An episode is terminated when the robot has cleared the obstacle, tipped over or left the
    terrain. It is truncated when the scenario's duration is over, when the simulation fails
    (``info["error"]`` says why) and, with `end_when_stopped`, when the robot is stopped. Then
    ``info["outcome"]`` is `cleared`, `tipped_over`, `left_terrain`, `stopped`, `timed_out` or
    `diverged`; `run` says why it stopped.

    Parameters
    ----------
    scenario : Scenario or {"flipper_climb", "step_field"}
        Robot, ground, start and duration; its drive must have no gait and no schedule. The first
        name is an Absolem on belts in front of a step of 0.1 to 0.4 m, the second the same robot on
        random step fields.
    terrain : Terrain, optional
        Replaces the scenario's ground.
    randomize : mapping of str to distribution, optional
        Distributions to draw from for each episode, see `vary` of `sweep`. None takes those of the
        named scenario; for other scenarios or another ground it takes ``variability.of_start() |
        variability.of_contact()``. ``{}`` varies nothing.
    dt : float
        [s] Time between two actions, >= 0.001.
    observe : {"proprioception", "privileged"}
        What the policy observes.
    flipper_command : {"rate", "angle"}
        What it commands for the flippers.
    end_when_stopped : bool
        Whether a detected stop truncates an episode; no trials are made.
    shock_weight, effort_weight : float
        [-] Weights of these penalties, >= 0.
    render_mode : {"rgb_array"}, optional
        Whether `render` returns a picture; must be None in rapier.

    Raises
    ------
    ScenarioError
        If an argument breaks a rule.

    Examples
    --------
    Flippers that keep level in front and push behind as the nose rises:

    >>> from crawler2d.envs import FlipperEnv
    >>> env = FlipperEnv()
    >>> env.observation_names[:5]
    ['pitch', 'pitch_rate', 'track_speed', 'front_angle', 'rear_angle']
    >>> seen, info = env.reset(seed=1)
    >>> ended = False
    >>> while not ended:
    ...     pitch, front, rear = seen[[0, 3, 4]]
    ...     action = [1.0, 1.2 - 3.0 * (pitch + front), 0.9 - 3.0 * (2.0 * pitch + rear)]
    ...     seen, reward, terminated, truncated, info = env.step(action)
    ...     ended = terminated or truncated
    >>> info["outcome"], str(env.run.outcome)
    ('cleared', 'cleared')
    """

    metadata: dict[str, Any] = METADATA

    def __init__(
        self,
        scenario: Scenario | str = "flipper_climb",
        *,
        terrain: Terrain | None = None,
        randomize: Mapping[str, Any] | None = None,
        dt: float = 0.05,
        observe: Observe = "proprioception",
        flipper_command: FlipperCommand = "rate",
        end_when_stopped: bool = False,
        shock_weight: float = 1.0,
        effort_weight: float = 0.1,
        render_mode: str | None = None,
    ) -> None:
        given = {name: value for name, value in locals().items() if name != "self"}
        EzPickle.__init__(self, **given)
        self.task = task_of(given)
        self.render_mode = check_render_mode(render_mode, self.task)
        self.metadata = metadata_of(self.task)
        self.observation_space, self.action_space = spaces_of(self.task)
        self._episodes: Episodes | None = None
        self._ended, self._supply = False, Supply(self.task, 1)
        self._drawn_from: np.random.Generator | None = None

    @property
    def observation_names(self) -> list[str]:
        """Names of the numbers in an observation."""
        return self.task.names

    @property
    def state(self) -> States:
        """The complete current state; each array has one row."""
        return self._begun().states

    @property
    def run(self) -> Run:
        """The episode so far as a run with its diagnosis, simulated again."""
        return self._begun().run(0)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start an episode with a new draw.

        Parameters
        ----------
        seed : int, optional
            Seed of this and all later draws; None continues the current ones.
        options : dict, optional
            Ignored.

        Returns
        -------
        observation : ndarray of float32, shape (n,)
        info : dict
            Empty.
        """
        super().reset(seed=seed, options=options)
        if self.np_random is not self._drawn_from:  # seeded, or set from outside
            self._supply.forget(0)
            self._drawn_from = self.np_random
        scenarios = self._supply.take([0], [self.np_random])
        if self._episodes is None:
            self._episodes = Episodes(self.task, scenarios, 1)
        else:
            self._episodes.reset(np.array([0]), scenarios)
        self._ended = False
        return self._episodes.observe()[0], {}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Drive for `dt`, or to the end of the duration if that is earlier.

        Parameters
        ----------
        action : array_like, shape (1 to 3,)
            [-] Track speed and flippers, from -1 to 1.

        Returns
        -------
        observation : ndarray of float32, shape (n,)
        reward : float
        terminated, truncated : bool
        info : dict
            The terms of the reward; at the end of an episode also its outcome.

        Raises
        ------
        ScenarioError
            If the action has the wrong shape or is not finite.
        gymnasium.error.ResetNeeded
            If the episode has ended.
        """
        episodes = self._begun()
        if self._ended:
            raise gymnasium.error.ResetNeeded("the episode has ended: call reset()")
        step = episodes.step([action])
        self._ended = bool(step.ended[0])
        info = _info(step)
        reward = float(step.rewards.total[0])
        return step.observations[0], reward, bool(step.terminated[0]), bool(step.truncated[0]), info

    def render(self) -> NDArray[np.uint8] | None:
        """Draw the robot on its ground.

        Returns
        -------
        ndarray of uint8, shape (360, 640, 3), or None
            None without a render mode.
        """
        return None if self.render_mode is None else self._begun().render(0)

    def _begun(self) -> Episodes:
        if self._episodes is None:
            raise gymnasium.error.ResetNeeded("there is no episode yet: call reset()")
        return self._episodes


def task_of(given: Mapping[str, Any]) -> Task:
    """Make the task from the arguments of an environment."""
    return Task.read(**{name: value for name, value in given.items() if name not in _OF_ITSELF})


def spaces_of(task: Task) -> tuple[gymnasium.spaces.Box, gymnasium.spaces.Box]:
    """Return the spaces of observations and actions."""
    bounds = task.bounds
    count = 1 + len(task.ends)
    return (
        gymnasium.spaces.Box(-bounds, bounds, dtype=np.float32),
        gymnasium.spaces.Box(-1.0, 1.0, (count,), dtype=np.float32),
    )


def metadata_of(task: Task) -> dict[str, Any]:
    """Frames per second of a real-time video: one per step."""
    return METADATA | {"render_fps": max(round(1.0 / task.dt), 1)}


def check_render_mode(mode: str | None, task: Task) -> str | None:
    """Refuse unknown render modes, and any for engines whose state cannot be copied."""
    modes = METADATA["render_modes"]
    if mode is not None and mode not in modes:
        raise ScenarioError("render_mode", mode, f"must be None or one of {modes}")
    engine = task.scenario.solver.engine
    if mode is not None and engine != "own":
        rule = f"must be None where solver.engine is {engine}: draw the run of an episode"
        raise ScenarioError("render_mode", mode, rule)
    return mode


def _info(step: Step) -> dict[str, Any]:
    info: dict[str, Any] = {
        "reward_progress": float(step.rewards.progress[0]),
        "reward_shock": float(step.rewards.shock[0]),
        "reward_effort": float(step.rewards.effort[0]),
        "reward_ending": float(step.rewards.ending[0]),
    }
    for name, values in (("outcome", step.outcomes), ("error", step.errors)):
        if values[0] is not None:
            info[name] = values[0]
    return info
