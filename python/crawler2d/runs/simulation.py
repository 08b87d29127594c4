"""A simulation that the caller advances and commands step by step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d import _core
from crawler2d.common.arrays import ByValue, Table, freeze_array, real_number
from crawler2d.common.bodies import POSE_COLUMNS
from crawler2d.common.keywords import TakesKeywords, takes_keywords
from crawler2d.errors import ScenarioError, ignore_warnings
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.parameters.settings import Start
from crawler2d.results.diagnosis import Diagnosis
from crawler2d.results.outcome import Outcome
from crawler2d.results.record import Record
from crawler2d.runs.branch import Trials, check_recording, trial_names
from crawler2d.runs.run import Run

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from crawler2d.parameters.flippers import Flippers

__all__ = ["Simulation", "State"]

_BETWEEN_DECISIONS = 0.01
"""[s] Time between two calls of a gait function."""

_LONGEST = 1e5
"""[s] Longest single advance, as in the core."""

_SAME_TIME = 1e-9
"""[s] Smaller differences of times are rounding errors."""

_ANGLES = {"front": "flipper_angle", "rear": "rear_flipper_angle"}
"""Commands of a gait by the end of the flippers."""

_COMMANDS = ("drive.speed", *_ANGLES.values(), "flipper_rate", "rear_flipper_rate", "push")
"""Paths of all commands."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State(ByValue):
    """The state at one instant, named like the arrays of a `Run`.

    Attributes
    ----------
    time : float
        [s] Simulated time.
    position, velocity : ndarray, shape (2,)
        [m], [m/s] Position and velocity of the origin of the chassis frame.
    chassis_angle, angular_velocity : float
        [rad], [rad/s] Nose up > 0.
    commanded_speed : float
        [m/s] Set point of the drivetrain, after its acceleration limits.
    track_speed : float
        [m/s] Surface speed of the track, mean over the drives.
    track_position : float
        [m] Travel of the track surface, mean over the drives.
    drive_positions : ndarray, shape (d,)
        [m] The same for each of d drives.
    shoe_poses : ndarray, shape (s, 3)
        [m, m, rad] Midpoint between the pins and direction of travel, for each shoe of a chain.
    flipper_angles : ndarray, shape (k,)
        [rad] Angle of the flippers at each of k ends, front first, relative to the chassis, upwards
        > 0.
    contacts : Table
        Contacts at this instant, with the forces of the last step.
    outcome : Outcome or None
        The outcome, once it is certain; later commands do not change it.
    """

    time: float
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    chassis_angle: float
    angular_velocity: float
    commanded_speed: float
    track_speed: float
    track_position: float
    drive_positions: NDArray[np.float64]
    shoe_poses: NDArray[np.float64]
    flipper_angles: NDArray[np.float64]
    contacts: Table
    outcome: Outcome | None


class Simulation(TakesKeywords):
    """A running simulation of a scenario.

    It can be advanced beyond the scenario's duration and outcome. Any thread may use it, one at a
    time. Copies, by `copy` or `pickle`, are independent.

    Parameters
    ----------
    scenario : Scenario
        What to simulate; the robot begins at its start.

    Raises
    ------
    ScenarioError
        If the scenario breaks a rule.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> sim = c2d.Simulation(c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat()))
    >>> sim.advance(0.5)
    >>> sim.command(speed=0.1)
    >>> sim.advance(1.5)
    >>> round(sim.state().track_speed, 3)
    0.1

    A custom gait raises the front flippers to compensate the chassis angle:

    >>> def keep_level(state):
    ...     return 0.6 - state.chassis_angle, 0.0
    >>> drive = c2d.Drive(gait=keep_level)
    >>> sim = c2d.Simulation(c2d.Scenario(c2d.robots.engineer(), c2d.terrains.flat(), drive=drive))
    >>> sim.advance(2.0)
    >>> sim.state().flipper_angles.round(2).tolist()
    [0.6]
    """

    def __init__(self, scenario: Scenario) -> None:
        self._set_out(check_scenario(scenario))

    def _set_out(self, scenario: Scenario) -> None:
        """Place the robot of a scenario at its start."""
        gait = scenario.drive.gait
        function = gait if callable(gait) else None
        simulated = scenario if function is None else scenario.replace({"drive.gait": None})
        self._core = _core.Simulation(simulated.to_json())
        self.scenario, self._simulated = scenario, simulated
        self._since, self._gait, self._decisions = 0.0, function, 0
        self._by_hand: frozenset[str] = frozenset()

    @property
    def time(self) -> float:
        """[s] Simulated time."""
        return self._core.time

    @takes_keywords
    def advance(self, duration: float) -> None:
        """Advance the simulation.

        Parameters
        ----------
        duration : float
            [s] Time to advance; the last step ends exactly there. Splitting it differently changes
            the steps, and so the state slightly.

        Raises
        ------
        ScenarioError
            If `duration` is not a number or out of range.
        SimulationDiverged
            If the state became non-finite; the simulation cannot continue.
        """
        duration = real_number(duration, "duration")
        gait, flippers = self._gait, self._simulated.robot.flippers
        if gait is None or flippers is None or not 0.0 < duration <= _LONGEST:
            self._core.advance(duration)  # checks the range
            return
        end = self.time + duration
        while (left := end - self.time) > _SAME_TIME:
            ahead = self._decisions * _BETWEEN_DECISIONS - self.time
            if ahead <= _SAME_TIME:
                self._follow(gait, flippers)
                ahead = self._decisions * _BETWEEN_DECISIONS - self.time
            self._core.advance(left if left < ahead + _SAME_TIME else ahead)

    def _follow(self, gait: Callable[[State], Any], flippers: Flippers) -> None:
        """Call a gait function and command the angles that it returns."""
        self._decisions += 1
        angles = gait(self.state())
        if angles is None:
            return
        try:
            both = list(angles) if np.ndim(angles) else [angles, angles]
        except ValueError:  # of NumPy, where the two have unlike shapes
            both = []
        if len(both) != 2:
            rule = "must return an angle, a pair of angles (front, rear), or None"
            raise ScenarioError("drive.gait", angles, rule)
        given = zip(("front", "rear"), both, strict=True)
        at, by_hand = flippers.ends, self._by_hand
        self._give(
            {
                _ANGLES[end]: angle
                for end, angle in given
                if at in (end, "both") and end not in by_hand
            }
        )

    @takes_keywords
    def command(
        self,
        *,
        speed: float | None = None,
        flipper_angle: float | None = None,
        rear_flipper_angle: float | None = None,
        flipper_rate: float | None = None,
        rear_flipper_rate: float | None = None,
        push: float | None = None,
    ) -> None:
        """Change the commands, which the motors follow within their limits, or push the robot.

        Parameters
        ----------
        speed : float, optional
            [m/s] Track speed; above 0 drives towards +x, until the next entry of the schedule.
            None leaves it unchanged.
        flipper_angle, rear_flipper_angle : float, optional
            [rad] Angle of the front and rear flippers, relative to the chassis, upwards > 0; from
            now on, overriding the gait. None leaves them unchanged.
        flipper_rate, rear_flipper_rate : float, optional
            [rad/s] Turning rate, instead of an angle; at 0 the flippers keep their angle.
        push : float, optional
            [N] Horizontal external force at the chassis' centre of mass, from now on; above 0
            pushes towards +x. None leaves it unchanged.

        Raises
        ------
        ScenarioError
            If a value is not a number, `speed` exceeds the drivetrain's limit, an angle a full turn
            or a rate the flippers' limit, an end has no flippers or gets both angle and rate, or
            `push` exceeds 1e15 N. Then no command changes.
        """
        given = {
            "drive.speed": speed,
            "flipper_angle": flipper_angle,
            "rear_flipper_angle": rear_flipper_angle,
            "flipper_rate": flipper_rate,
            "rear_flipper_rate": rear_flipper_rate,
            "push": push,
        }
        self._give(given)
        fronts, rears = (flipper_angle, flipper_rate), (rear_flipper_angle, rear_flipper_rate)
        self._by_hand |= {
            end
            for end, commands in (("front", fronts), ("rear", rears))
            if any(each is not None for each in commands)
        }

    def _give(self, given: Mapping[str, Any]) -> None:
        """Check commands by path, and pass them to the core."""
        speed, front, rear, front_rate, rear_rate, push = (
            None if given.get(name) is None else real_number(given[name], name)
            for name in _COMMANDS
        )
        for name, angle, rate in (("", front, front_rate), ("rear_", rear, rear_rate)):
            if angle is not None and rate is not None:
                rule = f"must not be given together with {name}flipper_angle"
                raise ScenarioError(f"{name}flipper_rate", rate, rule)
        self._core.command(speed, push, (front, rear), (front_rate, rear_rate))

    @takes_keywords
    def reset(self, start: Start | None = None) -> None:
        """Return to time 0 and forget all commands: bit by bit like a new simulation.

        Parameters
        ----------
        start : Start, optional
            New start, which replaces that of `scenario`. None keeps it.

        Raises
        ------
        ScenarioError
            If the start breaks a rule; then nothing changes.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> sim = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.step(0.05)))
        >>> for approach in (0.1, 0.5):
        ...     sim.reset(c2d.Start(approach=approach))
        ...     sim.advance(4.0)
        ...     print(sim.state().outcome)
        cleared
        None
        """
        if start is not None:
            self._set_out(self.scenario.replace({"start": start}))
            return
        with ignore_warnings():  # given before, by the constructor
            self._set_out(self.scenario)

    @takes_keywords
    def to_run(self, *, sample_interval: float = 0.01, trials: Trials = None) -> Run:
        """Return everything up to now as a run with history.

        The simulation is repeated with the same commands, so the run is the same bit by bit. If it
        continues from a snapshot, as copies do, the history starts there; metrics and events cover
        everything.

        Parameters
        ----------
        sample_interval : float
            [s] Time between samples of the history.
        trials : {"auto", "all"}, sequence of str or None
            Trials to make if the robot has stopped, see `simulate`.

        Returns
        -------
        Run
            Can be plotted, saved and explained like any other. Its scenario does not contain the
            commands, so it cannot be repeated: `branch` and `trials` raise an error. `parent` says
            where it started.

        Raises
        ------
        SimulationDiverged
            If the state became non-finite.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> sim = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.step(0.05)))
        >>> sim.advance(1.0)
        >>> sim.command(speed=-0.2)
        >>> sim.advance(1.0)
        >>> run = sim.to_run()
        >>> bool((run.position[-1] == sim.state().position).all()), run.time.size
        (True, 201)
        """
        kept, _ = check_recording(sample_interval, "full")
        result = self._core.to_run(kept, list(trial_names(trials)))
        return Run(self._simulated, result, parent=(self._simulated, self._since))

    @takes_keywords
    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the side view at this instant: ground, robot, contact forces and slip.

        Parameters
        ----------
        ax : Axes, optional
            Where to draw; None makes a figure.

        Returns
        -------
        Axes
            With x and y in metres, at equal scale.

        Raises
        ------
        ImportError
            If matplotlib is missing; the message names the extra to install.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> sim = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.step(0.05)))
        >>> sim.advance(1.5)
        >>> sim.plot().get_xlabel()
        'x [m]'
        """
        from crawler2d.pictures.side_view import plot_instant  # noqa: PLC0415 - optional

        state = self.state()
        trace = {name: np.array([getattr(state, name)]) for name in ("time", *POSE_COLUMNS)}
        result = {"outcome": Outcome.TIMED_OUT, "trace": trace, "contacts": state.contacts}
        return plot_instant(Record(self._simulated, result), ax)

    def snapshot(self) -> bytes:
        """Write the complete state.

        Returns
        -------
        bytes
            Input of `from_snapshot` of the same build of crawler2d: 3 to 40 kB plus the scenario.

        Raises
        ------
        ScenarioError
            If its gait is a function, or its engine is rapier.
        """
        if self._gait is not None:
            rule = "must not be a function for a snapshot or a copy, which hold no code"
            raise ScenarioError("drive.gait", self._gait, rule)
        return self._core.snapshot()

    @classmethod
    def from_snapshot(cls, snapshot: bytes) -> Simulation:
        """Restore a simulation from a snapshot; it continues identically, bit by bit.

        Parameters
        ----------
        snapshot : bytes
            Output of `snapshot`.

        Returns
        -------
        Simulation
            Independent of the original.

        Notes
        -----
        Snapshots from strangers are as safe to load as scenarios: no code runs, and the state is
        checked to be possible for its robot and ground. Whether a simulation really led to that
        state cannot be checked: pose and history are whatever the snapshot says.

        Raises
        ------
        ScenarioError
            If the bytes are not a snapshot, are damaged, or were written by another build.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None)
        >>> sim = c2d.Simulation(c2d.Scenario(robot, c2d.terrains.step(0.05)))
        >>> sim.advance(1.0)
        >>> copy = c2d.Simulation.from_snapshot(sim.snapshot())
        >>> for each in (sim, copy):
        ...     each.advance(1.0)
        >>> bool((sim.state().position == copy.state().position).all())
        True
        """
        if not isinstance(snapshot, (bytes, bytearray, memoryview)):
            raise ScenarioError("snapshot", snapshot, "must be bytes")
        simulation = cls.__new__(cls)
        core = _core.Simulation.from_snapshot(bytes(snapshot))
        simulation.scenario = simulation._simulated = Scenario.from_json(core.scenario())
        simulation._core, simulation._since = core, core.time
        simulation._gait, simulation._decisions, simulation._by_hand = None, 0, frozenset()
        return simulation

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle as a snapshot: copies are independent and need the same build."""
        return type(self).from_snapshot, (self.snapshot(),)

    def diagnosis(self) -> Diagnosis | None:
        """Explain why the robot has stopped.

        Returns
        -------
        Diagnosis or None
            None if it has not stopped.
        """
        result = self._core.diagnosis([])
        return None if result is None else Diagnosis.from_core(result)

    def state(self) -> State:
        """Return the current state.

        Returns
        -------
        State
            A read-only copy; advancing the simulation does not change it.
        """
        state = self._core.state()
        for name in ("position", "velocity", "drive_positions", "shoe_poses", "flipper_angles"):
            state[name] = freeze_array(state[name])
        state["contacts"] = Table(state["contacts"].columns)
        state["outcome"] = None if state["outcome"] is None else Outcome(state["outcome"])
        return State(**state)

    def intrusions(self) -> Table:
        """Find the ground that is currently inside the track.

        Returns
        -------
        Table
            One row per connected piece of ground deeper than `criteria.intrusion_depth` inside the
            taut belt round the track's own bodies, from left to right. Shallower ground, such as
            the penetration of a resting robot, does not count, and does not connect two pieces.
            Columns: `lane` (0 under both tracks, 1 the left one, 2 the right one), `edge` (the
            deepest convex edge, the leftmost of several, -1 if there is none), `edges` (all edges
            of the piece), `bodies` (on either side of the deepest point, in order of belt travel),
            `depth` and `root_depth` [m] (largest depth inside the belt round the circumscribed
            circles and round the root circles), `area` [m^2] (of the ground deeper than the
            criterion), `x` and `y` [m] (the deepest point).

        Examples
        --------
        A block 20 mm high and 10 mm thick between two wheels:

        >>> import crawler2d as c2d
        >>> blade = [(-0.36, 0), (-0.36, 0.02), (-0.35, 0.02), (-0.35, 0)]
        >>> points = [(-2, 0), *blade, (0, 0), (0, 0.1), (2, 0.1)]
        >>> ground = c2d.terrains.from_points(points, goal=0.0)
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(2))
        >>> sim = c2d.Simulation(c2d.Scenario(robot, ground))
        >>> inside = sim.intrusions()
        >>> inside["bodies"].tolist(), inside["depth"].tolist(), inside["edges"].tolist()
        ([(1, 0)], [0.02], [(1, 2)])
        """
        return Table(self._core.intrusions())

    def __repr__(self) -> str:
        """Show the robot and the simulated time."""
        return f"Simulation({self.scenario.robot.name} at {self.time:.3f} s)"
