"""A Gymnasium vector environment in which a policy drives many robots over obstacles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import gymnasium
import numpy as np
from gymnasium.utils import EzPickle, seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from crawler2d.common.arrays import is_iterable, whole_number
from crawler2d.envs.episodes import Episodes, Step
from crawler2d.envs.flipper_env import (
    TakesMadeKeywords,
    check_render_mode,
    metadata_of,
    spaces_of,
    task_of,
)
from crawler2d.envs.supply import Supply
from crawler2d.envs.task import FlipperCommand, Observe
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.runs.progress import thread_count
from crawler2d.runs.run import Run

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from crawler2d.runs.simulations import States

__all__ = ["FlipperVectorEnv"]

_MOST = 100_000


class FlipperVectorEnv(TakesMadeKeywords, VectorEnv, EzPickle):
    """Many `FlipperEnv`, advanced together on all cores.

    Environment k with seed s gives bit by bit the results of `FlipperEnv` with seed s + k, for any
    number of environments and threads. If one fails, its episode ends and the others continue.

    Parameters
    ----------
    num_envs : int
        Number of environments, 1 to 100,000.
    scenario, terrain, randomize, dt, observe, flipper_command, end_when_stopped
        See `FlipperEnv`.
    shock_weight, effort_weight, render_mode
        See `FlipperEnv`.
    autoreset_mode : AutoresetMode or str
        When a new episode follows one that has ended, see `gymnasium.vector.AutoresetMode`:
        "NextStep", which ignores the action of that step; "SameStep", with `final_obs` and
        `final_info` in ``info``; or "Disabled", which needs `reset` with a mask.
    threads : int, optional
        Largest number of threads; None takes one per core.

    Raises
    ------
    ScenarioError
        If an argument breaks a rule.

    Examples
    --------
    >>> import numpy as np
    >>> from crawler2d.envs import FlipperVectorEnv
    >>> many = FlipperVectorEnv(64, autoreset_mode="SameStep")
    >>> observations, infos = many.reset(seed=0)
    >>> for _ in range(100):
    ...     ahead = np.tile([1.0, 0.0, 0.0], (64, 1))
    ...     observations, rewards, terminated, truncated, infos = many.step(ahead)
    >>> observations.shape, rewards.shape
    ((64, 7), (64,))
    """

    def __init__(
        self,
        num_envs: int = 1,
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
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int | None = None,
    ) -> None:
        given = {name: value for name, value in locals().items() if name != "self"}
        EzPickle.__init__(self, **given)
        self.num_envs = whole_number(num_envs, "num_envs", 1, _MOST)
        self.task = task_of(given)
        self.render_mode = check_render_mode(render_mode, self.task)
        self.metadata = metadata_of(self.task) | {"autoreset_mode": _read_mode(autoreset_mode)}
        spaces = spaces_of(self.task)
        self.single_observation_space, self.single_action_space = spaces
        self.observation_space, self.action_space = (
            batch_space(space, self.num_envs) for space in spaces
        )
        self._threads, self._supply = thread_count(threads), Supply(self.task, self.num_envs)
        self._episodes: Episodes | None = None
        self._ended = np.zeros(self.num_envs, bool)
        self._generators: list[np.random.Generator] = []
        self._seeds: list[int] = []

    @property
    def observation_names(self) -> list[str]:
        """Names of the numbers in an observation."""
        return self.task.names

    @property
    def state(self) -> States:
        """The complete current states."""
        return self._begun().states

    @property  # type: ignore[misc] # the base class has a setter
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override] # one each
        """Random generators of the draws."""
        self._seed([None] * self.num_envs)
        return tuple(self._generators)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override] # one each
        """Seeds of the generators."""
        self._seed([None] * self.num_envs)
        return tuple(self._seeds)

    def run(self, index: int) -> Run:
        """Return the current episode of one environment as a run, see `FlipperEnv.run`.

        With "SameStep", an episode that has ended is already replaced by the new one.
        """
        return self._begun().run(whole_number(index, "index", 0, self.num_envs - 1))

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Start episodes, each with a new draw.

        Parameters
        ----------
        seed : int or sequence of int or None, optional
            One seed, to which environment k adds k, or one per environment.
        options : dict, optional
            `reset_mask`, of shape (N,), selects the environments to reset; without it, all.

        Returns
        -------
        observations : ndarray of float32, shape (N, n)
        infos : dict
            Empty.
        """
        seeds: list[int | None] = [None] * self.num_envs
        if isinstance(seed, int):
            seeds = [seed + k for k in range(self.num_envs)]
        elif is_iterable(seed):
            seeds = list(seed)
            if len(seeds) != self.num_envs:
                raise ScenarioError("seed", len(seeds), f"must be one or {self.num_envs}")
        elif seed is not None:
            raise ScenarioError("seed", seed, "must be an int, or one each")
        if options is not None and not isinstance(options, Mapping):
            raise ScenarioError("options", options, "must be a mapping, or None")
        mask = np.asarray((options or {}).get("reset_mask", np.ones(self.num_envs, bool)))
        if mask.dtype != bool or mask.shape != (self.num_envs,) or not mask.any():
            rule = f"must be a mask of shape ({self.num_envs},) with at least one True"
            raise ScenarioError("options['reset_mask']", mask.tolist(), rule)
        if self._episodes is None and not mask.all():
            raise gymnasium.error.ResetNeeded("the first reset is of all: without a mask")
        self._seed([each if m else None for each, m in zip(seeds, mask, strict=True)])
        self._begin(mask)
        return self._begun().observe(), {}

    def step(
        self, actions: NDArray[np.float32]
    ) -> tuple[
        NDArray[np.float32],
        NDArray[np.float64],
        NDArray[np.bool_],
        NDArray[np.bool_],
        dict[str, Any],
    ]:
        """Drive for `dt`, or to the end of the duration if that is earlier.

        Parameters
        ----------
        actions : array_like, shape (N, 1 to 3)
            [-] Track speeds and flippers, from -1 to 1.

        Returns
        -------
        observations : ndarray of float32, shape (N, n)
        rewards : ndarray, shape (N,)
        terminated, truncated : ndarray of bool, shape (N,)
        infos : dict
            The terms of the rewards, and outcomes of ended episodes, each with a mask.

        Raises
        ------
        ScenarioError
            If the actions have the wrong shape or are not finite.
        gymnasium.error.ResetNeeded
            If an episode has ended and there is no automatic reset.
        KeyboardInterrupt
            On Ctrl-C; reset before continuing.
        """
        episodes, mode = self._begun(), self.metadata["autoreset_mode"]
        over = self._ended
        if mode is AutoresetMode.DISABLED and over.any():
            raise gymnasium.error.ResetNeeded("episodes have ended: reset them by a mask")
        step = episodes.step(actions, ~over)
        observations, ended = step.observations, step.ended & ~over
        rewards = np.where(over, 0.0, step.rewards.total)
        terminated, truncated = step.terminated & ~over, step.truncated & ~over
        infos = _infos(step, ~over, ended)
        if over.any():
            self._begin(over)
            observations = episodes.observe()
        self._ended = ended
        if mode is AutoresetMode.SAME_STEP and ended.any():
            infos = _infos(step, ~ended, np.zeros_like(ended))
            infos |= {"final_obs": _rows(observations, ended), "_final_obs": ended.copy()}
            infos |= {"final_info": _infos(step, ended, ended), "_final_info": ended.copy()}
            self._begin(ended)
            observations = episodes.observe()
        return observations, rewards, terminated, truncated, infos

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Draw each robot on its ground; None without a render mode."""
        if self.render_mode is None:
            return None
        return tuple(self._begun().render(index) for index in range(self.num_envs))

    def _begin(self, mask: NDArray[np.bool_]) -> None:
        """Start the episodes selected by a mask."""
        indices = np.flatnonzero(mask)
        scenarios = self._supply.take(indices.tolist(), self._generators)
        if self._episodes is None:
            self._episodes = Episodes(self.task, scenarios, self._threads)
        else:
            self._episodes.reset(indices, scenarios)
        self._ended = self._ended & ~mask

    def _seed(self, seeds: list[int | None]) -> None:
        """Make generators for given seeds, and for environments that have none yet."""
        if not self._generators:
            pairs = [seeding.np_random(seed) for seed in seeds]
            self._generators = [generator for generator, _ in pairs]
            self._seeds = [seed for _, seed in pairs]
            return
        for index, seed in enumerate(seeds):
            if seed is not None:
                self._generators[index], self._seeds[index] = seeding.np_random(seed)
                self._supply.forget(index)

    def _begun(self) -> Episodes:
        if self._episodes is None:
            raise gymnasium.error.ResetNeeded("there are no episodes yet: call reset()")
        return self._episodes


def _read_mode(given: AutoresetMode | str) -> AutoresetMode:
    try:
        return AutoresetMode(given)
    except ValueError:
        names = [mode.value for mode in AutoresetMode]
        raise ScenarioError("autoreset_mode", given, f"must be one of {names}") from None


def _infos(step: Step, shown: NDArray[np.bool_], ended: NDArray[np.bool_]) -> dict[str, Any]:
    """Return the infos of a step as arrays with masks, as Gymnasium does."""
    infos: dict[str, Any] = {}
    if not shown.any():
        return infos
    rewards = step.rewards
    for name in ("progress", "shock", "effort", "ending"):
        infos[f"reward_{name}"] = np.where(shown, getattr(rewards, name), 0.0)
        infos[f"_reward_{name}"] = shown.copy()
    for name, values in (("outcome", step.outcomes), ("error", step.errors)):
        mask = ended & [value is not None for value in values] if ended.any() else ended
        if mask.any():
            infos[name] = np.array(values, dtype=object)
            infos[name][~mask] = None
            infos[f"_{name}"] = mask
    return infos


def _rows(observations: NDArray[np.float32], mask: NDArray[np.bool_]) -> NDArray[np.object_]:
    """Return the rows selected by a mask as an array of objects, with None elsewhere."""
    rows = np.full(len(mask), None, dtype=object)
    for index in np.flatnonzero(mask):
        rows[index] = observations[index].copy()
    return rows
