"""A simulation that the caller advances and commands step by step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.common.arrays import real_number
from crawler2d.common.frozen import read_only
from crawler2d.common.table import Table
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.results.diagnosis import Diagnosis
from crawler2d.results.outcome import Outcome

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

__all__ = ["Simulation", "State"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class State:
    """The state at one instant; the names are those of the arrays of a `Run`.

    Attributes
    ----------
    time : float
        [s] Simulated time.
    position, velocity : ndarray, shape (2,)
        [m], [m/s] Of the origin of the chassis frame.
    chassis_angle, angular_velocity : float
        [rad], [rad/s] Nose up > 0.
    commanded_speed : float
        [m/s] Set-point of the drivetrain, within its acceleration limits.
    track_speed : float
        [m/s] Surface speed, the mean of the drives.
    track_position : float
        [m] How far the surface has run, the mean of the drives.
    flipper_angles : ndarray, shape (k,)
        [rad] Of the flippers at each of k ends, the front first, over the chassis, upwards > 0.
    contacts : Table
        Contacts of this instant, forces of the last time step.
    outcome : Outcome or None
        The outcome, once it is certain.
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


class Simulation:
    """A scenario under way.

    Nothing ends it: it can be advanced beyond the scenario's duration and outcome. Any thread may
    use it, one at a time. A copy, also by `copy` or `pickle`, is independent, as by `snapshot`.

    Parameters
    ----------
    scenario : Scenario
        What to simulate; the robot stands at its start.

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
        if not isinstance(scenario, Scenario):
            raise ScenarioError("scenario", scenario, "must be a Scenario")
        self.scenario = scenario
        self._core = _core.Simulation(scenario.to_json())

    @property
    def time(self) -> float:
        """[s] Simulated time."""
        return self._core.time

    def advance(self, duration: float) -> None:
        """Simulate on.

        Parameters
        ----------
        duration : float
            [s] For how long, rounded to whole time steps.

        Raises
        ------
        ScenarioError
            If `duration` is no number or out of range.
        SimulationDiverged
            If the state became non-finite; the simulation cannot go on.
        """
        self._core.advance(real_number(duration, "duration"))

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
            [m/s] Track speed; above 0 drives towards +x, until the schedule has its next. None
            leaves it as it is.
        flipper_angle, rear_flipper_angle : float, optional
            [rad] Of the flippers at the front and at the rear, over the chassis, upwards > 0; from
            now on, whatever the gait. None leaves them as they are.
        push : float, optional
            [N] Horizontal force of the surroundings at the centre of mass, from now on; above 0
            pushes towards +x. None leaves it as it is.

        Raises
        ------
        ScenarioError
            If `speed` is no number or beyond the drivetrain's, an angle no number, beyond a full
            turn or of an end without flippers, or `push` no number or beyond 1e6 N. Then nothing
            is commanded.
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

    def snapshot(self) -> bytes:
        """Write everything that the future depends on.

        Returns
        -------
        bytes
            For `from_snapshot` of the same build of crawler2d: about 10 kB, and the scenario.
        """
        return self._core.snapshot()

    @classmethod
    def from_snapshot(cls, snapshot: bytes) -> Simulation:
        """Make the simulation of a snapshot; it goes on with the same bits.

        Parameters
        ----------
        snapshot : bytes
            What `snapshot` wrote.

        Returns
        -------
        Simulation
            Independent of the one that was written.

        Notes
        -----
        A snapshot from a stranger is worth what a scenario from one is. It runs no code, and what
        it holds is checked against its own robot and ground: nothing but what these could have come
        to. That they did is not known: where the robot stands and what its run has seen so far are
        what the stranger says.

        Raises
        ------
        ScenarioError
            If the bytes are no snapshot, are damaged, or were written by another build.

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
        """Copy and pickle by way of a snapshot: the twin is independent, of the same build."""
        return type(self).from_snapshot, (self.snapshot(),)

    def diagnosis(self) -> Diagnosis | None:
        """Say why the robot has stopped.

        Returns
        -------
        Diagnosis or None
            None while it has not.
        """
        why = self._core.diagnosis()
        return None if why is None else Diagnosis.from_core(why)

    def state(self) -> State:
        """Read the state of this instant.

        Returns
        -------
        State
            A copy, read-only; advancing the simulation does not change it.
        """
        state = self._core.state()
        for name in ("position", "velocity", "flipper_angles"):
            state[name] = read_only(state[name])
        state["contacts"] = Table(state["contacts"])
        state["outcome"] = None if state["outcome"] is None else Outcome(state["outcome"])
        return State(**state)

    def intrusions(self) -> Table:
        """Find what of the ground is inside the track now.

        Returns
        -------
        Table
            One row a connected piece of ground that lies deeper than `criteria.intrusion_depth`
            within the taut belt round the track's own bodies, from the left. Shallower ground, such
            as what a resting robot sinks into, neither counts nor joins two pieces. Columns: `lane`
            (0 under both tracks, 1 the left one, 2 the right one), `edge` (the edge that stands out
            and reaches deepest, the left of equally deep ones, -1 if none stands out), `edges` (all
            in the piece), `bodies` (on either side of the deepest point, in order of belt travel),
            `depth` and `root_depth` [m] (deepest reach below the belt round the circumscribed and
            the root circles), `area` [m^2] (of what lies deeper than the criterion), `x` and `y`
            [m] (the deepest point).

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
        """Say what is simulated and how far it is."""
        return f"Simulation({self.scenario.robot.name} at {self.time:.3f} s)"
