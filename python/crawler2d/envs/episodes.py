"""Episodes of a task: one for `FlipperEnv`, many for `FlipperVectorEnv`."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d import _core
from crawler2d.common.extras import extra
from crawler2d.envs.task import Rewards, Task
from crawler2d.errors import ScenarioError
from crawler2d.results.outcome import Outcome
from crawler2d.runs.branch import Trials
from crawler2d.runs.run import Run
from crawler2d.runs.simulation import Simulation
from crawler2d.runs.simulations import Simulations, States

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Episodes", "Step"]

_STOPPED, _DIVERGED = "stopped", "diverged"
"""Outcomes without trials: any stop, and no result."""

_SAME_TIME = 1e-9
"""[s] Smaller differences of times are rounding errors."""

_BELOW, _HIGH = 0.12, 0.45
"""[-] Depth of the view below the start, and its height, as fractions of its width."""

_PICTURE, _DOTS_PER_INCH = (6.4, 3.6), 100
"""[inch] Size of a rendered picture, and its resolution [dpi]."""


@dataclass(frozen=True, slots=True)
class Step:
    """The result of a step of N episodes.

    Attributes
    ----------
    observations : ndarray of float32, shape (N, n)
        What a policy sees.
    rewards : Rewards
        The rewards of this step.
    terminated, truncated : ndarray of bool, shape (N,)
        Whether each episode was ended by the robot's state, or by time, a stop or an error.
    outcomes, errors : tuple of str or None, length N
        Outcome of each ended episode, and reason of each failed one.
    """

    observations: NDArray[np.float32]
    rewards: Rewards
    terminated: NDArray[np.bool_]
    truncated: NDArray[np.bool_]
    outcomes: tuple[str | None, ...]
    errors: tuple[str | None, ...]

    @property
    def ended(self) -> NDArray[np.bool_]:
        """Whether an episode has ended."""
        return self.terminated | self.truncated


class Episodes:
    """N episodes of a task; each gives bit by bit the result of a single one."""

    def __init__(
        self, task: Task, scenarios: Sequence[_core.PreparedScenario], threads: int | None
    ) -> None:
        self._task, self._many = task, Simulations(scenarios, threads=threads)
        self._full_speeds = np.array([each.speed for each in scenarios])
        self._durations = np.array(_durations_of(scenarios))
        self._states = self._many.state()
        self._starts = _positions(self._states)

    @property
    def states(self) -> States:
        """The current states."""
        return self._states

    def reset(self, indices: NDArray[np.intp], scenarios: Sequence[_core.PreparedScenario]) -> None:
        """Start new episodes at some indices."""
        self._many.reset(indices, scenarios)
        self._full_speeds[indices] = [each.speed for each in scenarios]
        self._durations[indices] = _durations_of(scenarios)
        self._states = self._many.state()
        self._starts[indices] = _positions(self._states)[indices]

    def observe(self) -> NDArray[np.float32]:
        """Return what a policy sees, shape (N, n)."""
        return self._task.observe(self._many, self._states)

    def step(self, actions: ArrayLike, which: NDArray[np.bool_] | None = None) -> Step:
        """Command and advance the episodes, or those of a mask, but not beyond their durations.

        Raises
        ------
        ScenarioError
            If actions have the wrong shape, or those of driven episodes are not finite.
        """
        task, before, count = self._task, self._states, len(self._many)
        driven = np.ones(count, bool) if which is None else which
        speeds, flippers = task.commands(self._read(actions, driven), self._full_speeds)
        given = np.where(driven[:, None], np.column_stack([speeds, flippers]), np.nan)
        kind = "angle" if task.commands_angles else "rate"
        names = ("speed", f"flipper_{kind}", f"rear_flipper_{kind}")
        self._many.command(**dict(zip(names, given.T, strict=True)))
        self._advance(driven)
        after = self._states = self._many.state()
        return self._judged(task.rewards(before, after), after)

    def _advance(self, driven: NDArray[np.bool_]) -> None:
        """Advance by `dt`, or to the end of the duration if that is earlier."""
        left = self._durations - self._states.time
        whole = driven & (left > self._task.dt - _SAME_TIME)
        self._many.advance(self._task.dt, whole)
        for rest in np.unique(left[driven & ~whole]).tolist():
            self._many.advance(rest, driven & (left == rest))

    def _judged(self, rewards: Rewards, states: States) -> Step:
        """Find which episodes have ended, and how."""
        count = len(self._many)
        terminated, failed = np.zeros(count, bool), np.zeros(count, bool)
        terminated[states.ended] = True
        failed[states.failed] = True
        terminated &= ~failed
        truncated = failed | (states.time >= self._durations - _SAME_TIME)
        if self._task.ends_when_stopped:
            truncated |= states.stopped
        truncated &= ~terminated
        outcomes: list[str | None] = [None] * count
        for index in np.flatnonzero(terminated | truncated).tolist():
            without = _STOPPED if states.stopped[index] else str(Outcome.TIMED_OUT)
            outcomes[index] = _DIVERGED if failed[index] else states.outcome[index] or without
        return Step(self.observe(), rewards, terminated, truncated, tuple(outcomes), states.error)

    def _read(self, actions: ArrayLike, driven: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Clip actions to their range, whatever those of episodes that are not driven."""
        try:
            array = np.asarray(actions, float)
        except (TypeError, ValueError):
            raise ScenarioError("action", actions, "must be numbers") from None
        shape = (len(self._many), 1 + len(self._task.ends))
        if array.shape != shape:
            each = f" for each of {shape[0]} robots" if shape[0] > 1 else ""
            rule = f"must be {shape[1]} numbers{each}"
            is_of_one = array.shape[:1] == (1,) == shape[:1]
            given = array.shape[1:] if is_of_one else array.shape
            raise ScenarioError("action", f"shape {given}", rule)
        array = np.where(driven[:, None], array, 0.0)
        if not np.isfinite(array).all():
            raise ScenarioError("action", array[~np.isfinite(array)][0], "must be finite")
        clipped: NDArray[np.float64] = np.clip(array, -1.0, 1.0)
        return clipped

    def run(self, index: int, trials: Trials = "auto") -> Run:
        """Return one episode as a run, with trials if the robot is stopped.

        Raises
        ------
        SimulationDiverged
            If the state became non-finite.
        """
        return self._many.to_run(index, trials=trials)

    def render(self, index: int) -> NDArray[np.uint8]:
        """Draw the current state of one episode, shape (height, width, 3).

        Raises
        ------
        ImportError
            If matplotlib is missing; the message names the extra to install.
        """
        figures = extra("matplotlib.figure", "plot")
        agg = extra("matplotlib.backends.backend_agg", "plot")
        figure = figures.Figure(figsize=_PICTURE, dpi=_DOTS_PER_INCH, layout="constrained")
        canvas = agg.FigureCanvasAgg(figure)
        ax = Simulation.from_snapshot(self._many.snapshot(index)).plot(figure.subplots())
        if legend := ax.get_legend():
            legend.remove()
        # The view stays the same for a whole episode: from behind the start to beyond the goal.
        robot = self._task.scenario.robot
        reach = robot.outline.axle_distance + (robot.flippers.length if robot.flippers else 0.0)
        x, y, to_goal = self._starts[index]
        left, right = x - 1.5 * reach, x + to_goal + 1.5 * reach
        bottom = y - _BELOW * (right - left)
        ax.set(xlim=(left, right), ylim=(bottom, bottom + _HIGH * (right - left)))
        canvas.draw()
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _durations_of(scenarios: Sequence[_core.PreparedScenario]) -> list[float]:
    """[s] Return the durations of episodes; models, obstacles and draws may differ in them."""
    return [json.loads(each.text)["duration"] for each in scenarios]


def _positions(states: States) -> NDArray[np.float64]:
    """[m] Return the positions of the robots and their distances to the goal, shape (N, 3)."""
    return np.column_stack([states.position, states.to_goal])
