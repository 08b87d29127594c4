"""Many simulations that are commanded and advanced together, on all cores."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.common.keywords import TakesKeywords, takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.runs.progress import thread_count

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
        there are none. Torques are means over the last step.
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
    stopped: NDArray[np.bool_]
    outcome: tuple[str | None, ...]
    error: tuple[str | None, ...]


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

    def __init__(self, scenarios: Sequence[Scenario], *, threads: int | None = None) -> None:
        self._threads = thread_count(threads)
        self.scenarios = [check_scenario(each) for each in scenarios]
        if not self.scenarios:
            raise ScenarioError("scenarios", scenarios, "must be one or more")
        self._core = _core.Worlds(_texts(self.scenarios))

    def __len__(self) -> int:
        """Count them."""
        return len(self.scenarios)

    @takes_keywords
    def command(
        self,
        *,
        speed: ArrayLike | None = None,
        flipper_angle: ArrayLike | None = None,
        rear_flipper_angle: ArrayLike | None = None,
    ) -> None:
        """Give new commands, which the motors follow within their limits.

        Parameters
        ----------
        speed : float or array_like, shape (N,), optional
            [m/s] Track speeds; above 0 drives towards +x. NaN and None leave them unchanged.
        flipper_angle, rear_flipper_angle : float or array_like, shape (N,), optional
            [rad] Of the flippers at the front and at the rear, relative to the chassis, upwards >
            0. NaN and None leave them unchanged.

        Raises
        ------
        ScenarioError
            If an array has another shape, a speed exceeds the drivetrain's, or an angle a full turn
            or its end has no flippers. Then no command changes.
        """
        self._core.command(
            self._column(speed, "speed"),
            self._column(flipper_angle, "flipper_angle"),
            self._column(rear_flipper_angle, "rear_flipper_angle"),
        )

    @takes_keywords
    def advance(self, duration: float) -> None:
        """Advance all of them.

        Parameters
        ----------
        duration : float
            [s] By how much; the last step ends there.

        Raises
        ------
        ScenarioError
            If `duration` is not a number or out of range.
        KeyboardInterrupt
            On Ctrl-C; then they stand at different times, and are to be reset.
        """
        duration = real_number(duration, "duration")
        if not 0.0 <= duration <= 1e5:
            raise ScenarioError("duration", duration, "must be >= 0 s and <= 100000 s")
        self._core.advance(duration, self._threads)

    @takes_keywords
    def reset(
        self, which: ArrayLike | None = None, scenarios: Sequence[Scenario] | None = None
    ) -> None:
        """Set some out anew, bit by bit as if they were new.

        Parameters
        ----------
        which : array_like of int or of bool, optional
            Their places, or a mask of shape (N,). None takes all.
        scenarios : sequence of Scenario, optional
            Others in place of theirs, one for each.

        Raises
        ------
        ScenarioError
            If a place is out of range, or a scenario breaks a rule; then nothing changes.
        """
        places = np.arange(len(self)) if which is None else np.atleast_1d(np.asarray(which))
        if places.dtype == bool:
            places = np.flatnonzero(self._shaped(places, "which"))
        if places.size and not ((places >= 0) & (places < len(self))).all():
            raise ScenarioError("which", which, f"must be from 0 to {len(self) - 1}")
        if scenarios is None:
            self._core.reset(places.tolist(), None)
            return
        others = [check_scenario(each) for each in scenarios]
        if len(others) != len(places):
            raise ScenarioError("scenarios", len(others), f"must be {len(places)} of them")
        self._core.reset(places.tolist(), _texts(others))
        for place, scenario in zip(places.tolist(), others, strict=True):
            self.scenarios[place] = scenario

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
        """
        return self._core.heights(np.asarray(offsets, float).ravel().tolist())

    @takes_keywords
    def snapshot(self, place: int) -> bytes:
        """Write the complete state of one, for `Simulation.from_snapshot`."""
        if not 0 <= place < len(self):
            raise ScenarioError("place", place, f"must be from 0 to {len(self) - 1}")
        return bytes(self._core.snapshot(place))

    def _column(self, values: ArrayLike | None, name: str) -> NDArray[np.float64]:
        if values is None:
            return np.full(len(self), np.nan)
        try:
            array = np.asarray(values, float)
        except (TypeError, ValueError):
            raise ScenarioError(name, values, "must be numbers") from None
        return (
            np.ascontiguousarray(np.broadcast_to(array, len(self)))
            if array.ndim == 0
            else (self._shaped(array, name))
        )

    def _shaped(self, array: NDArray[Any], name: str) -> NDArray[Any]:
        if array.shape != (len(self),):
            rule = f"must be one for each of the {len(self)} simulations"
            raise ScenarioError(name, array.shape, rule)
        return np.ascontiguousarray(array)


def _texts(scenarios: Sequence[Scenario]) -> list[str]:
    for scenario in scenarios:
        if callable(scenario.drive.gait):
            rule = "must not be a function: command angles instead"
            raise ScenarioError("drive.gait", scenario.drive.gait, rule)
    return [scenario.to_json() for scenario in scenarios]
