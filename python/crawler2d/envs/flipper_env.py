"""One robot that a policy drives over obstacles, as an environment of Gymnasium."""

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
"""Of both environments; `metadata_of` has the `render_fps` of another `dt` than the default."""


_OF_ITSELF = ("num_envs", "render_mode", "autoreset_mode", "threads")
"""Arguments of an environment that are none of its task."""


class TakesMadeKeywords(TakesKeywords):
    """Base of what Gymnasium makes, which raises another of any TypeError, from its text alone."""

    def __new__(cls, *given: Any, **keywords: Any) -> Self:
        """Check the keywords; `__init__` takes them."""
        try:
            return super().__new__(cls, *given, **keywords)
        except ArgumentError as error:
            raise TypeError(str(error)) from None


class FlipperEnv(TakesMadeKeywords, gymnasium.Env, EzPickle):
    """A robot on obstacles whose tracks and flippers a policy commands.

    An action holds the speed of the tracks, as a share of the scenario's `drive.speed`, and of
    those flippers that there are, the front ones first, a rate as a share of their `rate_limit` or
    an angle as a share of half a turn: numbers from -1 to 1, shape (1 to 3,). Larger ones
    are clipped. The motors follow within their own limits.

    An observation holds pitch [rad], its rate [rad/s], the speed of the tracks [m/s], and of the
    flippers that there are the angles [rad] and the torques [N m], both sides together. A
    privileged one also holds 16 heights of the ground [m], over the origin of the chassis frame,
    from one axle distance behind it to two ahead. `observation_names` lists them.

    The reward of a step is by how much the robot comes closer to the goal [m]; less, times their
    weights, the height of a fall to a velocity as large as the change of its chassis' and the
    height to which the work of its motors would lift it; and 1 m at the end of an episode that
    clears, less 1 m at that of one that is terminated otherwise. ``info`` has the terms as
    `reward_progress`, `reward_shock`, `reward_effort` and `reward_ending`.

    An episode is terminated when the robot has cleared the obstacle, tipped over or left the
    terrain. It is truncated when the scenario's duration is over, when the simulation fails, of
    which ``info["error"]`` says why, and if asked for when the robot is stopped. Then
    ``info["outcome"]`` is `cleared`, `tipped_over`, `left_terrain`, `stopped`, `timed_out` or
    `diverged`; `run` says why it stopped.

    Parameters
    ----------
    scenario : Scenario or {"flipper_climb", "step_field"}
        Robot, ground, start and duration; its drive may have neither gait nor schedule. The first
        name has an Absolem on belts in front of a step of 0.1 to 0.4 m, the second one on random
        step fields.
    terrain : Terrain, optional
        Another ground.
    randomize : mapping of str to distribution, optional
        What differs from episode to episode, as `vary` of a sweep. None takes that of the named
        scenario, and ``variability.of_start() | variability.of_contact()`` for others and on
        another ground; ``{}`` takes nothing at all.
    dt : float
        [s] Between two actions, >= 0.001.
    observe : {"proprioception", "privileged"}
        What a policy sees.
    flipper_command : {"rate", "angle"}
        What it commands of the flippers.
    end_when_stopped : bool
        Whether a stop truncates an episode: by detection, nothing is tried.
    shock_weight, effort_weight : float
        [-] Of these terms of the reward, >= 0.
    render_mode : {"rgb_array"}, optional
        Whether `render` returns a picture; None in another engine than crawler2d's own.

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
        """Names of the numbers of an observation."""
        return self.task.names

    @property
    def state(self) -> States:
        """The present state, each array with one row; everything that a policy does not see."""
        return self._begun().states

    @property
    def run(self) -> Run:
        """The episode so far as a run, with its diagnosis: it is simulated once more."""
        return self._begun().run(0)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin an episode, with another draw.

        Parameters
        ----------
        seed : int, optional
            Of this and all later draws; None goes on with the present ones.
        options : dict, optional
            Without meaning.

        Returns
        -------
        observation : ndarray of float32, shape (n,)
        info : dict
            Empty.
        """
        super().reset(seed=seed, options=options)
        if self.np_random is not self._drawn_from:  # of a seed, or set from outside
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
        """Drive on for `dt`, or to the end of the duration if that comes before.

        Parameters
        ----------
        action : array_like, shape (1 to 3,)
            [-] Speed and flippers, from -1 to 1.

        Returns
        -------
        observation : ndarray of float32, shape (n,)
        reward : float
        terminated, truncated : bool
        info : dict
            The terms of the reward; at the end of the episode its outcome.

        Raises
        ------
        ScenarioError
            If the action has another shape or is not finite.
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
    """Read the task among the arguments of an environment."""
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
    """Frames per second of a video in real time: one a step."""
    return METADATA | {"render_fps": max(round(1.0 / task.dt), 1)}


def check_render_mode(mode: str | None, task: Task) -> str | None:
    """Refuse an unknown render mode, and any for what cannot be copied to be drawn."""
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
