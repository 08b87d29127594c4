"""Many simulations that are commanded and advanced together, on all cores."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import real_number, whole_number
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
class States:
    """The states of N simulations at an instant.

    Attributes
    ----------
    time : ndarray of float, shape (N,)
        [s] Simulated time.
    position, velocity : ndarray of float, shape (N, 2)
        [m], [m/s] Of the origin of the chassis frame.
    chassis_angle, angular_velocity : ndarray of float, shape (N,)
        [rad], [rad/s] Nose up > 0.
    track_speed : ndarray of float, shape (N,)
        [m/s] Mean surface speed of the tracks; above 0 drives towards +x.
    flipper_angles, flipper_rates, flipper_torques : ndarray of float, shape (N, 2)
        [rad], [rad/s], [N m] Of the flippers at the front and at the rear, upwards > 0; NaN where
        there are none. Torques are of both sides together, means over the last step.
    to_goal : ndarray of float, shape (N,)
        [m] How far the rear of the robot still has to the goal along x; below 0 beyond it.
    drive_work : ndarray of float, shape (N,)
        [J] Work of the motors of the tracks so far, without those of the flippers.
    stopped : ndarray of bool, shape (N,)
        Whether the robot is stopped, by `SeizureCriteria`; nothing is tried to find out why.
    outcome : tuple of str or None, length N
        How it ended, such as `cleared` or `tipped_over`; None while it drives or stands.
    error : tuple of str or None, length N
        Why it cannot go on, such as a state that became non-finite.
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
        """Places of those that have an outcome."""
        return [place for place, outcome in enumerate(self.outcome) if outcome is not None]

    @property
    def failed(self) -> list[int]:
        """Places of those that cannot go on."""
        return [place for place, error in enumerate(self.error) if error is not None]


class Simulations(TakesKeywords):
    """Running simulations side by side, as `Simulation` is one: for training and for control.

    Each is independent, and bit by bit what it would be alone, whatever the number of threads. One
    that fails stands still, says why in its state, and the others go on.

    Parameters
    ----------
    scenarios : sequence of Scenario
        What to simulate; every robot is at its start.
    threads : int, optional
        Most threads; None takes one a core.

    Raises
    ------
    ScenarioError
        If there are no scenarios, one breaks a rule, or has a gait that is a function.

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

    def __len__(self) -> int:
        """Count them."""
        return self._count

    @takes_keywords
    def scenario(self, place: int) -> Scenario:
        """Return the scenario of one."""
        return Scenario.from_json(self._core.scenario(self._place(place)).text)

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
        """Give new commands, which the motors follow within their limits.

        Parameters
        ----------
        speed : float or array_like, shape (N,), optional
            [m/s] Track speeds; above 0 drives towards +x. NaN and None leave them unchanged.
        flipper_angle, rear_flipper_angle : float or array_like, shape (N,), optional
            [rad] Of the flippers at the front and at the rear, relative to the chassis, upwards >
            0. NaN and None leave them unchanged.
        flipper_rate, rear_flipper_rate : float or array_like, shape (N,), optional
            [rad/s] The same by the rates at which they turn, in place of an angle; at 0 they stay
            where they are.

        Raises
        ------
        ScenarioError
            If an array has another shape, a speed exceeds the drivetrain's, an angle a full turn or
            a rate the flippers' own, its end has no flippers, or is given both. Then no command
            changes.
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
        """Advance them.

        Parameters
        ----------
        duration : float
            [s] By how much; the last step ends there.
        which : array_like of int or of bool, optional
            Their places, or a mask of shape (N,). None takes all.

        Raises
        ------
        ScenarioError
            If `duration` is not a number, it or a place is out of range, or a place stands twice.
        KeyboardInterrupt
            On Ctrl-C; then they stand at different times, and are to be reset.
        """
        duration = real_number(duration, "duration")
        if not 0.0 <= duration <= 1e5:
            raise ScenarioError("duration", duration, "must be >= 0 s and <= 100000 s")
        self._core.advance(self._places(which), duration, self._threads)

    @takes_keywords
    def reset(
        self,
        which: ArrayLike | None = None,
        scenarios: Sequence[Scenario | _core.PreparedScenario] | None = None,
    ) -> None:
        """Reset some to their start, bit by bit as if they were new.

        Parameters
        ----------
        which : array_like of int or of bool, optional
            Their places, or a mask of shape (N,). None takes all.
        scenarios : sequence of Scenario, optional
            Others in place of theirs, one for each.

        Raises
        ------
        ScenarioError
            If a place is out of range or stands twice, or a scenario breaks a rule; then nothing
            changes.
        """
        places = self._places(which)
        others = None if scenarios is None else _prepared(scenarios)
        if others is not None and len(others) != len(places):
            raise ScenarioError("scenarios", len(others), f"must be {len(places)} of them")
        self._core.reset(places, others)

    def state(self) -> States:
        """Return their states: copies, which advancing does not change."""
        columns = self._core.states()
        outcome, error = (tuple(columns.pop(name)) for name in ("outcome", "error"))
        return States(outcome=outcome, error=error, **columns)

    @takes_keywords
    def heights(self, offsets: ArrayLike) -> NDArray[np.float64]:
        """Find the height of the ground near each robot.

        Parameters
        ----------
        offsets : array_like, shape (K,)
            [m] Distances from the origin of the chassis frame along x, ahead > 0.

        Returns
        -------
        ndarray of float, shape (N, K)
            [m] At a vertical face that of its upper end; of grounds that differ that under the left
            track.

        Raises
        ------
        ScenarioError
            If an offset is no number, or not finite.
        """
        array = _numbers(offsets, "offsets").ravel()
        if not np.isfinite(array).all():
            raise ScenarioError("offsets", array[~np.isfinite(array)][0], "must be finite")
        return self._core.heights(array.tolist())

    @takes_keywords
    def snapshot(self, place: int) -> bytes:
        """Write the complete state of one, for `Simulation.from_snapshot`."""
        return bytes(self._core.snapshot(self._place(place)))

    @takes_keywords
    def to_run(self, place: int, *, sample_interval: float = 0.01, trials: Trials = None) -> Run:
        """Return all that one has done since it set out as a run, see `Simulation.to_run`.

        Parameters
        ----------
        place : int
            Which one.
        sample_interval : float
            [s] Time between samples of the history.
        trials : {"auto", "all"}, sequence of str or None
            As for `simulate`: what to try if the robot has stopped.

        Raises
        ------
        ScenarioError
            If the place is out of range.
        SimulationDiverged
            If the state became non-finite.
        """
        kept, _ = check_recording(sample_interval, "full")
        place = self._place(place)
        result = self._core.to_run(place, kept, list(trial_names(trials)))
        scenario = self.scenario(place)
        return Run(scenario, result, parent=(scenario, 0.0))

    def _place(self, place: int) -> int:
        return whole_number(place, "place", 0, len(self) - 1)

    def _places(self, which: ArrayLike | None) -> list[int]:
        if which is None:
            return list(range(len(self)))
        try:
            places = np.atleast_1d(np.asarray(which))
        except ValueError:  # of NumPy, where rows have unlike lengths
            places = np.array([which], object)
        if places.dtype == bool:
            places = np.flatnonzero(self._shaped(places, "which"))
        is_whole = places.size == 0 or np.issubdtype(places.dtype, np.integer)
        # A place that is given twice would be advanced twice.
        is_list = is_whole and places.ndim == 1 and np.unique(places).size == places.size
        if not is_list or not ((places >= 0) & (places < len(self))).all():
            rule = f"must be different places from 0 to {len(self) - 1}, or a mask"
            raise ScenarioError("which", which, rule)
        found: list[int] = places.tolist()
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
    """Read real numbers: no texts, no masked ones, which NumPy would take as numbers."""
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
    """Validate them, if that has not been done; equal robots and grounds are built once."""
    if not isinstance(scenarios, Iterable):
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
