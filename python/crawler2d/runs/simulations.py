"""Command and advance many simulations together, on all cores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import ByValue, is_iterable, real_number, whole_number
from crawler2d.common.keywords import TakesKeywords, takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.runs.branch import Trials, check_recording, trial_names
from crawler2d.runs.progress import thread_count
from crawler2d.runs.run import Run

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

__all__ = ["Simulations", "States"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class States(ByValue):
    """The states of N simulations at an instant.

    Attributes
    ----------
    time : ndarray of float, shape (N,)
        [s] Simulated time.
    position, velocity : ndarray of float, shape (N, 2)
        [m], [m/s] Position and velocity of the origin of the chassis frame.
    chassis_angle, angular_velocity : ndarray of float, shape (N,)
        [rad], [rad/s] Nose up > 0.
    track_speed : ndarray of float, shape (N,)
        [m/s] Mean surface speed of the tracks; above 0 drives towards +x.
    flipper_angles, flipper_rates, flipper_torques : ndarray of float, shape (N, 2)
        [rad], [rad/s], [N m] Angle, rate and torque of the front and rear flippers, upwards > 0;
        NaN if there are none. Torques are the sum of both sides, averaged over the last step.
    to_goal : ndarray of float, shape (N,)
        [m] Distance along x from the rear of the robot to the goal; below 0 beyond it.
    drive_work : ndarray of float, shape (N,)
        [J] Work of the track motors so far, without the flipper motors.
    stopped : ndarray of bool, shape (N,)
        Whether the robot is stopped by `SeizureCriteria`; no trials find out why.
    outcome : tuple of str or None, length N
        How each ended, such as `cleared` or `tipped_over`; None while it drives or is stopped.
    error : tuple of str or None, length N
        Why it cannot continue, such as a state that became non-finite.
    """

    time: NDArray[np.float64]
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    chassis_angle: NDArray[np.float64]
    angular_velocity: NDArray[np.float64]
    track_speed: NDArray[np.float64]
    flipper_angles: NDArray[np.float64]
    flipper_rates: NDArray[np.float64]
    flipper_torques: NDArray[np.float64]
    to_goal: NDArray[np.float64]
    drive_work: NDArray[np.float64]
    stopped: NDArray[np.bool_]
    outcome: tuple[str | None, ...]
    error: tuple[str | None, ...]

    @property
    def ended(self) -> list[int]:
        """Indices of those that have an outcome."""
        return [index for index, outcome in enumerate(self.outcome) if outcome is not None]

    @property
    def failed(self) -> list[int]:
        """Indices of those that cannot continue."""
        return [index for index, error in enumerate(self.error) if error is not None]


class Simulations(TakesKeywords):
    """Many independent `Simulation` objects in one, for training and control.

    Each gives bit by bit the result of a single `Simulation`, for any number of threads. If one
    fails, its state says why, and the others continue.

    Parameters
    ----------
    scenarios : sequence of Scenario
        What to simulate; every robot begins at its start.
    threads : int, optional
        Largest number of threads; None takes one per core.

    Raises
    ------
    ScenarioError
        If there are no scenarios, or one breaks a rule or has a gait function.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None)
    >>> heights = (0.05, 0.1)
    >>> many = c2d.Simulations([c2d.Scenario(robot, c2d.terrains.step(h)) for h in heights])
    >>> many.command(speed=[0.2, 0.3])
    >>> many.advance(6.0)
    >>> many.state().outcome
    ('cleared', 'tipped_over')
    """

    def __init__(
        self, scenarios: Sequence[Scenario | _core.PreparedScenario], *, threads: int | None = None
    ) -> None:
        self._threads = thread_count(threads)
        prepared = _prepared(scenarios)
        if not prepared:
            raise ScenarioError("scenarios", scenarios, "must be one or more")
        self._core, self._count = _core.Worlds(prepared), len(prepared)

    def __reduce__(self) -> NoReturn:
        """Refuse a copy, which would advance the same robots."""
        raise TypeError("Simulations cannot be copied or pickled; a Simulation can")

    def __len__(self) -> int:
        """Count them."""
        return self._count

    @takes_keywords
    def scenario(self, index: int) -> Scenario:
        """Return the scenario of one simulation."""
        return Scenario.from_json(self._core.scenario(self._index(index)).text)

    @takes_keywords
    def command(
        self,
        *,
        speed: ArrayLike | None = None,
        flipper_angle: ArrayLike | None = None,
        rear_flipper_angle: ArrayLike | None = None,
        flipper_rate: ArrayLike | None = None,
        rear_flipper_rate: ArrayLike | None = None,
    ) -> None:
        """Change the commands, which the motors follow within their limits.

        Parameters
        ----------
        speed : float or array_like, shape (N,), optional
            [m/s] Track speeds; above 0 drives towards +x. NaN and None leave them unchanged.
        flipper_angle, rear_flipper_angle : float or array_like, shape (N,), optional
            [rad] Angle of the front and rear flippers, relative to the chassis, upwards > 0. NaN
            and None leave them unchanged.
        flipper_rate, rear_flipper_rate : float or array_like, shape (N,), optional
            [rad/s] Turning rate, instead of an angle; at 0 the flippers keep their angle.

        Raises
        ------
        ScenarioError
            If an array has the wrong shape, a speed exceeds the drivetrain's limit, an angle a full
            turn or a rate the flippers' limit, or an end has no flippers or gets both angle and
            rate. Then no command changes.
        """
        angles, rates = (
            np.column_stack([self._column(front, name), self._column(rear, f"rear_{name}")])
            for name, front, rear in (
                ("flipper_angle", flipper_angle, rear_flipper_angle),
                ("flipper_rate", flipper_rate, rear_flipper_rate),
            )
        )
        both = ~np.isnan(angles) & ~np.isnan(rates)
        if both.any():
            name = "flipper_rate" if both[:, 0].any() else "rear_flipper_rate"
            rule = "must not be given together with an angle"
            raise ScenarioError(name, rates[both][0], rule)
        self._core.command(self._column(speed, "speed"), angles, rates)

    @takes_keywords
    def advance(self, duration: float, which: ArrayLike | None = None) -> None:
        """Advance the simulations.

        Parameters
        ----------
        duration : float
            [s] Time to advance; the last step ends exactly there.
        which : array_like of int or of bool, optional
            Their indices, or a mask of shape (N,). None takes all.

        Raises
        ------
        ScenarioError
            If `duration` is not a number, it or an index is out of range, or an index is given
            twice.
        KeyboardInterrupt
            On Ctrl-C; the simulations are then at different times and must be reset.
        """
        duration = real_number(duration, "duration")
        if not 0.0 <= duration <= 1e5:
            raise ScenarioError("duration", duration, "must be >= 0 s and <= 100000 s")
        self._core.advance(self._indices(which), duration, self._threads)

    @takes_keywords
    def reset(
        self,
        which: ArrayLike | None = None,
        scenarios: Sequence[Scenario | _core.PreparedScenario] | None = None,
    ) -> None:
        """Reset simulations to their start: bit by bit like new ones.

        Parameters
        ----------
        which : array_like of int or of bool, optional
            Their indices, or a mask of shape (N,). None takes all.
        scenarios : sequence of Scenario, optional
            New scenarios, one for each.

        Raises
        ------
        ScenarioError
            If an index is out of range or given twice, or a scenario breaks a rule; then nothing
            changes.
        """
        indices = self._indices(which)
        others = None if scenarios is None else _prepared(scenarios)
        if others is not None and len(others) != len(indices):
            raise ScenarioError("scenarios", len(others), f"must be {len(indices)} of them")
        self._core.reset(indices, others)

    def state(self) -> States:
        """Return a copy of all states; advancing does not change it."""
        columns = self._core.states()
        outcome, error = (tuple(columns.pop(name)) for name in ("outcome", "error"))
        return States(outcome=outcome, error=error, **columns)

    @takes_keywords
    def heights(self, offsets: ArrayLike) -> NDArray[np.float64]:
        """Return the height of the ground near each robot.

        Parameters
        ----------
        offsets : array_like, shape (K,)
            [m] Distances from the origin of the chassis frame along x, ahead > 0.

        Returns
        -------
        ndarray of float, shape (N, K)
            [m] Heights: the upper end of a vertical face, and the ground under the left track if
            the tracks are on different ground.

        Raises
        ------
        ScenarioError
            If an offset is not a finite number.
        """
        array = _numbers(offsets, "offsets").ravel()
        if not np.isfinite(array).all():
            raise ScenarioError("offsets", array[~np.isfinite(array)][0], "must be finite")
        return self._core.heights(array.tolist())

    @takes_keywords
    def snapshot(self, index: int) -> bytes:
        """Write the complete state of one simulation, for `Simulation.from_snapshot`."""
        return bytes(self._core.snapshot(self._index(index)))

    @takes_keywords
    def to_run(self, index: int, *, sample_interval: float = 0.01, trials: Trials = None) -> Run:
        """Return everything that one did since its start as a run, see `Simulation.to_run`.

        Parameters
        ----------
        index : int
            Its index.
        sample_interval : float
            [s] Time between samples of the history.
        trials : {"auto", "all"}, sequence of str or None
            Trials to make if the robot has stopped, see `simulate`.

        Raises
        ------
        ScenarioError
            If the index is out of range.
        SimulationDiverged
            If the state became non-finite.
        """
        kept, _ = check_recording(sample_interval, "full")
        index = self._index(index)
        result = self._core.to_run(index, kept, list(trial_names(trials)))
        scenario = self.scenario(index)
        return Run(scenario, result, parent=(scenario, 0.0))

    def _index(self, index: int) -> int:
        return whole_number(index, "index", 0, len(self) - 1)

    def _indices(self, which: ArrayLike | None) -> list[int]:
        if which is None:
            return list(range(len(self)))
        try:
            indices = np.atleast_1d(np.asarray(which))
        except ValueError:  # of NumPy, where rows have unlike lengths
            indices = np.array([which], object)
        if indices.dtype == bool:
            indices = np.flatnonzero(self._shaped(indices, "which"))
        is_whole = indices.size == 0 or np.issubdtype(indices.dtype, np.integer)
        # An index given twice would be advanced twice.
        is_list = is_whole and indices.ndim == 1 and np.unique(indices).size == indices.size
        if not is_list or not ((indices >= 0) & (indices < len(self))).all():
            rule = f"must be different indices from 0 to {len(self) - 1}, or a mask"
            raise ScenarioError("which", which, rule)
        found: list[int] = indices.tolist()
        return found

    def _column(self, values: ArrayLike | None, name: str) -> NDArray[np.float64]:
        if values is None:
            return np.full(len(self), np.nan)
        array = _numbers(values, name)
        return self._shaped(np.broadcast_to(array, len(self)) if array.ndim == 0 else array, name)

    def _shaped(self, array: NDArray[Any], name: str) -> NDArray[Any]:
        if array.shape != (len(self),):
            rule = f"must be one for each of the {len(self)} simulations"
            raise ScenarioError(name, array.shape, rule)
        return np.ascontiguousarray(array)


def _numbers(values: ArrayLike, name: str) -> NDArray[np.float64]:
    """Read real numbers; refuse strings and masked values, which NumPy accepts."""
    if isinstance(values, np.ma.MaskedArray):
        raise ScenarioError(name, values, "must not be masked")
    try:
        array = np.asarray(values)
    except (TypeError, ValueError):
        raise ScenarioError(name, values, "must be real numbers") from None
    if array.size and array.dtype.kind not in "iuf":
        raise ScenarioError(name, values, "must be real numbers")
    return array.astype(float)


def _prepared(
    scenarios: Sequence[Scenario | _core.PreparedScenario],
) -> list[_core.PreparedScenario]:
    """Validate the scenarios unless already done; build equal robots and grounds once."""
    if not is_iterable(scenarios):
        raise ScenarioError("scenarios", scenarios, "must be several: give them in a list")
    found: list[_core.PreparedScenario] = []
    for each in scenarios:
        if isinstance(each, _core.PreparedScenario):
            found.append(each)
            continue
        gait = check_scenario(each).drive.gait
        if callable(gait):
            rule = "must not be a function: command angles instead"
            raise ScenarioError("drive.gait", gait, rule)
        found.append(_core.PreparedScenario(each.to_json(), found[-1] if found else None))
    return found
