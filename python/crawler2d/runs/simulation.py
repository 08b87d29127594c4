"""A simulation that the caller advances and commands step by step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.common.arrays import Table, freeze_array, real_number
from crawler2d.common.keywords import TakesKeywords, takes_keywords
from crawler2d.errors import ScenarioError, ignore_doubts
from crawler2d.parameters.scenario import Scenario, check_scenario
from crawler2d.parameters.settings import Start
from crawler2d.results.diagnosis import Diagnosis
from crawler2d.results.outcome import Outcome

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Simulation", "State"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """The state at one instant, with the names of the arrays of a `Run`.

    Attributes
    ----------
    time : float
        [s] Simulated time.
    position, velocity : ndarray, shape (2,)
        [m], [m/s] Position and velocity of the origin of the chassis frame.
    chassis_angle, angular_velocity : float
        [rad], [rad/s] Nose up > 0.
    commanded_speed : float
        [m/s] Set-point of the drivetrain, within its acceleration limits.
    track_speed : float
        [m/s] Surface speed of the track, mean over the drives.
    track_position : float
        [m] How far the track surface has run, mean over the drives.
    flipper_angles : ndarray, shape (k,)
        [rad] Of the flippers at each of k ends, front first, relative to the chassis, upwards > 0.
    contacts : Table
        Contacts at this instant, with the forces of the last step.
    outcome : Outcome or None
        The outcome, once it is certain; whatever is commanded then does not change it.
    """

    time: float
    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    chassis_angle: float
    angular_velocity: float
    commanded_speed: float
    track_speed: float
    track_position: float
    flipper_angles: NDArray[np.float64]
    contacts: Table
    outcome: Outcome | None


class Simulation(TakesKeywords):
    """A running simulation of a scenario.

    It has no end: it can be advanced beyond the scenario's duration and outcome. Any thread may use
    it, one at a time. A copy, also one made by `copy` or `pickle`, is independent.

    Parameters
    ----------
    scenario : Scenario
        What to simulate; the robot is at its start.

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
    """

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = check_scenario(scenario)
        self._core = _core.Simulation(scenario.to_json())

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
            [s] By how much; the last step ends there. In pieces of other lengths the steps are
            others, and the state differs a little.

        Raises
        ------
        ScenarioError
            If `duration` is not a number or out of range.
        SimulationDiverged
            If the state became non-finite; the simulation cannot continue.
        """
        self._core.advance(real_number(duration, "duration"))

    @takes_keywords
    def command(
        self,
        *,
        speed: float | None = None,
        flipper_angle: float | None = None,
        rear_flipper_angle: float | None = None,
        push: float | None = None,
    ) -> None:
        """Give new commands, which the motors follow within their limits, or push the robot.

        Parameters
        ----------
        speed : float, optional
            [m/s] Track speed; above 0 drives towards +x, until the next entry of the schedule.
            None leaves it unchanged.
        flipper_angle, rear_flipper_angle : float, optional
            [rad] Of the flippers at the front and at the rear, relative to the chassis, upwards >
            0; from now on, overriding the gait. None leaves them unchanged.
        push : float, optional
            [N] Horizontal external force at the centre of mass, from now on; above 0 pushes towards
            +x. None leaves it unchanged.

        Raises
        ------
        ScenarioError
            If a value is not a number, `speed` exceeds the drivetrain's, an angle exceeds a full
            turn or its end has no flippers, or `push` exceeds 1e15 N. Then no command changes.
        """
        given = {
            "drive.speed": speed,
            "flipper_angle": flipper_angle,
            "rear_flipper_angle": rear_flipper_angle,
            "push": push,
        }
        self._core.command(
            *(None if value is None else real_number(value, name) for name, value in given.items())
        )

    @takes_keywords
    def reset(self, start: Start | None = None) -> None:
        """Go back to time 0 and forget all commands: as if it were new, bit by bit.

        Parameters
        ----------
        start : Start, optional
            Another start, which becomes that of `scenario`. None takes the scenario's.

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
        if start is None:
            with ignore_doubts():  # they were given when it was made
                self._core = _core.Simulation(self.scenario.to_json())
            return
        changed = type(self)(self.scenario.replace({"start": start}))
        self.scenario, self._core = changed.scenario, changed._core

    def snapshot(self) -> bytes:
        """Write the complete state.

        Returns
        -------
        bytes
            For `from_snapshot` of the same build of crawler2d: about 10 kB plus the scenario.
        """
        return self._core.snapshot()

    @classmethod
    def from_snapshot(cls, snapshot: bytes) -> Simulation:
        """Restore a simulation from a snapshot; it continues bit by bit the same.

        Parameters
        ----------
        snapshot : bytes
            What `snapshot` wrote.

        Returns
        -------
        Simulation
            Independent of the original.

        Notes
        -----
        A snapshot from a stranger is as safe to load as a scenario from one: it runs no code, and
        its state is checked to be possible for its own robot and ground. Whether a simulation
        really led to that state cannot be checked: the pose and the history so far are whatever the
        snapshot says.

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
        simulation._core = _core.Simulation.from_snapshot(bytes(snapshot))
        simulation.scenario = Scenario.from_json(simulation._core.scenario())
        return simulation

    def __reduce__(self) -> tuple[Any, ...]:
        """Copy and pickle as a snapshot: the copy is independent, and needs the same build."""
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
        for name in ("position", "velocity", "flipper_angles"):
            state[name] = freeze_array(state[name])
        state["contacts"] = Table(state["contacts"].columns)
        state["outcome"] = None if state["outcome"] is None else Outcome(state["outcome"])
        return State(**state)

    def intrusions(self) -> Table:
        """Find the ground that is inside the track now.

        Returns
        -------
        Table
            One row per connected piece of ground deeper than `criteria.intrusion_depth` inside the
            taut belt round the track's own bodies, from left to right. Shallower ground, such as
            what a resting robot sinks into, neither counts nor connects two pieces. Columns: `lane`
            (0 under both tracks, 1 the left one, 2 the right one), `edge` (the convex edge that
            reaches deepest, the left one of several, -1 if there is none), `edges` (all edges of
            the piece), `bodies` (on either side of the deepest point, in order of belt travel),
            `depth` and `root_depth` [m] (largest depth inside the belt round the circumscribed
            circles and round the root circles), `area` [m^2] (of the ground deeper than the
            criterion), `x` and `y` [m] (the deepest point).

        Examples
        --------
        A blade, 20 mm high and 10 mm thick, between two wheels:

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
