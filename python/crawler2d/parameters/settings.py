"""Settings of a scenario: command, gait, start, solver and criteria."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar, Literal

from crawler2d.common.arrays import whole_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.parameters.fields import Parameters, to_dict

__all__ = ["Climb", "Drive", "Gait", "Hold", "ScenarioBase", "SeizureCriteria", "Solver", "Start"]


@dataclass(frozen=True, slots=True)
class Hold(Parameters, kind="hold", path="drive.gait"):
    """Hold the flippers at an angle, which a schedule can change.

    Parameters
    ----------
    angle : float
        [rad] Angle of all flippers relative to the chassis, upwards > 0.
    schedule : array_like, shape (n, 2), optional
        Up to 10,000 increasing times [s], and the angle [rad] that applies from each on.
    front, rear : float, optional
        [rad] Constant angle of the flippers at that end; None follows `angle` and `schedule`.

    Examples
    --------
    The front flippers go down after three seconds; the rear ones stay:

    >>> Hold(0.8, [(3.0, 0.0)], rear=-0.3).schedule
    ((3.0, 0.0),)
    """

    omitted_defaults: ClassVar[tuple[str, ...]] = ("front", "rear")

    angle: float = 0.0
    schedule: tuple[tuple[float, float], ...] | None = None
    _: KW_ONLY
    front: float | None = None
    rear: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Climb(Parameters, kind="climb", path="drive.gait"):
    """Reach up with the flippers to meet an obstacle, then sweep down to lift the chassis.

    The gait uses only what an operator could see from a distance: the angle of the chassis, and
    whether a flipper touches something beyond its root. It looks every 10 ms, and what a flipper
    has touched since the last look counts. The front flippers stay at `reach_angle` until they
    touch something, then sweep down to `sweep_angle`. As soon as the chassis is raised by more than
    `level_angle`, the rear ones push down to `push_angle` and lift it from behind. All return when
    the chassis is level again and nothing touches the rear ones, or when the nose has pointed down
    by more than `level_angle` for a second: the front ones to `reach_angle`, the rear ones to their
    starting angle. The tracks keep the speed of the `Drive`; the gait never reverses them.

    Parameters
    ----------
    reach_angle : float
        [rad] Relative to the chassis, upwards > 0.
    sweep_angle, push_angle : float
        [rad] Relative to the horizontal, upwards > 0.
    level_angle : float
        [rad] Chassis angle above which the chassis counts as raised.
    """

    reach_angle: float = 0.8
    sweep_angle: float = 0.0
    push_angle: float = -0.8
    level_angle: float = 0.1


Gait = Hold | Climb
"""Any gait."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive(Parameters, path="drive"):
    """The driver's command: track speed and flipper gait.

    Parameters
    ----------
    speed : float
        [m/s] Track speed; above 0 drives towards +x. At most the `max_speed` of the drivetrain.
    schedule : array_like, shape (n, 2), optional
        Up to 10,000 increasing times [s], and the speed [m/s] that applies from each on.
    gait : Hold, Climb or callable, optional
        How the flippers move; None keeps their initial angle. Ignored on a robot without flippers,
        so a sweep may remove the flippers and keep the gait. A function works only in a
        `Simulation`, which calls it with its `State` every 10 ms of simulated time. It returns one
        angle [rad] for all flippers or a pair (front, rear); None leaves the command unchanged.

    Examples
    --------
    Back after five seconds:

    >>> Drive(speed=0.4, schedule=[(5.0, -0.4)]).schedule
    ((5.0, -0.4),)
    """

    speed: float = 0.4
    schedule: tuple[tuple[float, float], ...] | None = None
    gait: Gait | Callable[..., Any] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Start(Parameters, path="start"):
    """Position and angle of the robot at time 0: at rest, touching the ground.

    Parameters
    ----------
    approach : float
        [m] Distance from the robot's foremost point to the first edge at or beyond x = 0, or to the
        first edge of a barrier that begins before its step field. The ground must reach under the
        whole robot.
    track_phase : float
        [m] Initial advance of all wheels, or of the belt.
    angle : float
        [rad] Chassis angle, nose up > 0.
    """

    approach: float = 0.10
    track_phase: float = 0.0
    angle: float = 0.0


_ACCURACY = 3e-7
_STEP_IN_RAPIER = 1.25e-4


@dataclass(frozen=True, slots=True, kw_only=True)
class Solver(Parameters, path="solver"):
    """Settings of the solver of the equations of motion; a convergence study gave the defaults.

    Either `accuracy` controls the length of the steps, or `time_step` fixes it. Setting one by
    path, as in ``scenario.replace({"solver.time_step": 1e-3})``, clears the other; with
    `dataclasses.replace`, also set the other to None.

    Parameters
    ----------
    engine : {"own", "rapier"}
        What moves the robot: "own" is crawler2d's own dynamics; "rapier" builds the same robot from
        bodies, joints and motors of the game engine rapier, for comparison (see
        docs/decisions/0016). It supports only lines of wheels, circumferential and hybrid wheels
        and force tracks, without arms; no snapshots; and no accuracy: its steps are 0.125 ms unless
        `time_step` is given. All other settings must keep their defaults, and drives have no
        rotors, no torque that falls with speed, no controllers and no self-locking gears.
    contact : {"own", "reference"}
        How contacts are found: "own" uses our own exact geometry; "reference", for comparison,
        takes the contacts of wheels from rapier's queries of convex pieces on one polyline. It is
        slower and cuts rounded edges into facets.
    accuracy : float, optional
        [m] Local error of a step: the difference between its motion and the mean of the velocities
        at its ends times its length, the largest over all points of the robot and all driven
        surfaces. Steps are as long as this allows, 20 us to 16 ms. It limits the error of one step,
        not that of the whole path. None takes 0.3 um, unless a time step is given.
    time_step : float, optional
        [s] Fixed length of a step, instead of an accuracy, for comparison. Steps are shorter only
        where something strikes the ground, a command changes or a run ends. No wheel at the largest
        speed of the tracks, and no flipper, may turn by more than 0.7 rad in a step.
    iterations : int, optional
        Largest number of rounds in the search for forces that satisfy all contacts; each round
        pivots until the states of all contacts and motors fit, and settles. None takes 8; usually
        none is needed.
    contact_frequency : float
        [Hz] Natural frequency of the contact softness.
    contact_damping_ratio : float
        [-] Damping ratio of the contact softness.
    max_push_speed : float
        [m/s] Largest speed at which a penetration is pushed out.
    prediction_distance : float
        [m] Smallest gap up to which contacts are searched for; in a fast or long step, the distance
        that the robot moves in it, if larger.
    restitution : float
        [-] Coefficient of restitution: the fraction of the impulses of an impact that contacts
        return, 0 to 1 (Poisson's hypothesis, for normal and friction impulses alike). With 0, the
        default, an impact on edges that jam each other stops the robot at once; with 1 contacts
        return the whole impulse, like springs without dampers. An outcome that differs between the
        two depends on the restitution, which rigid-body mechanics does not determine. Not for
        chains or rapier.

    Examples
    --------
    >>> Solver(time_step=1e-3).accuracy is None
    True
    """

    exclusive: ClassVar[tuple[str, ...]] = ("accuracy", "time_step")
    omitted_defaults: ClassVar[tuple[str, ...]] = ("engine", "restitution")

    engine: Literal["own", "rapier"] = "own"
    contact: Literal["own", "reference"] = "own"
    accuracy: float | None = None
    time_step: float | None = None
    iterations: int | None = None
    contact_frequency: float = 1000.0
    contact_damping_ratio: float = 5.0
    max_push_speed: float = 0.5
    prediction_distance: float = 0.0002
    restitution: float = 0.0

    def __post_init__(self) -> None:
        """Set the default accuracy, or rapier's default step, if neither is given."""
        Parameters.__post_init__(self)
        if self.time_step is None and self.accuracy in (None, _ACCURACY):
            in_rapier = self.engine == "rapier"
            object.__setattr__(self, "accuracy", None if in_rapier else _ACCURACY)
            object.__setattr__(self, "time_step", _STEP_IN_RAPIER if in_rapier else None)


@dataclass(frozen=True, slots=True, kw_only=True)
class SeizureCriteria(Parameters, path="criteria"):
    """When a run ends, and what counts as a stop.

    Parameters
    ----------
    stop_window : float
        [s] Shortest time without progress that counts as a stop.
    stop_pitches : float
        [-] Grouser pitches at the commanded speed that must pass without progress.
    stop_progress : float
        [-] Fraction of the commanded distance below which there is no progress.
    stationary_distance : float
        [m] Largest change of pose that still counts as stationary.
    stationary_windows : int
        Stop windows for which a state must be stationary to end the run early.
    clear_time : float
        [s] Time that the robot must stay beyond the goal.
    clear_angle : float
        [rad] Largest deviation of the angle between chassis and ground, at the goal, from that of
        the track standing on level ground.
    tip_over_angle : float
        [rad] Chassis angle at which the robot has tipped over.
    intrusion_depth : float
        [m] Ground inside the envelope of the track is an intrusion if deeper than this, 0 to 0.1.
        It is less than the smallest radius of the track model, without grousers. The default
        exceeds the penetration of round wheels and belts that strike an edge (0.2 mm). With 0, the
        ground that the robot rests on joins the pieces under it.
    intrusion_load : float
        [-] Fraction of the weight above which an intrusion counts as loaded.
    belly_load : float
        [-] Fraction of the weight on the belly that makes a stop without a seizure a hang-up. The
        default exceeds the usual uncertainty of the friction coefficient.
    sliding_speed : float
        [-] Fraction of the commanded speed above which a surface counts as sliding, or a drive as
        turning. A sticking contact creeps in the solver by a thousandth of that.
    torque_limit : float
        [-] Fraction of the torque limit above which, on average, a motor counts as at its limit.
    cycling_distance : float
        [m] A robot that moves back and forth by this much within a stop window is cycling. The
        default is more than the rattle of jammed grousers and less than the spacing of any wheels.
    imbalance : float
        [-] Largest imbalance of a stationary state in equilibrium, as a fraction of the weight.
    mean_imbalance : float
        [-] The same for the mean forces of a rattling state.
    creep_from, creep_to : float
        [-] Fractions of the commanded distance between which the robot counts as creeping.
    escape_distance : float
        [m] Advance that counts as escaping from a stop.
    escape_time : float
        [s] Time for a robot in a trial to escape from a stop, in addition to the time needed to
        drive `escape_distance` as commanded.
    """

    stop_window: float = 1.0
    stop_pitches: float = 3.0
    stop_progress: float = 0.05
    stationary_distance: float = 1e-6
    stationary_windows: int = 3
    clear_time: float = 0.5
    clear_angle: float = math.radians(5.0)
    tip_over_angle: float = math.pi / 2.0
    intrusion_depth: float = 5e-4
    intrusion_load: float = 0.02
    belly_load: float = 0.10
    sliding_speed: float = 0.02
    torque_limit: float = 0.98
    cycling_distance: float = 0.02
    imbalance: float = 1e-3
    mean_imbalance: float = 0.02
    creep_from: float = 0.02
    creep_to: float = 0.20
    escape_distance: float = 0.05
    escape_time: float = 5.0


@dataclass(frozen=True, slots=True)
class ScenarioBase(Parameters):
    """Base of `Scenario`, for modules that `Scenario` imports, such as `robot`.

    Parameters
    ----------
    robot, terrain, drive, start, goal, gravity, duration, solver, criteria, schema
        See `Scenario`.
    """

    robot: Parameters
    terrain: Parameters
    _: KW_ONLY
    drive: Drive = Drive()
    start: Start = Start()
    goal: float | None = None
    gravity: float = 9.81
    duration: float = 15.0
    solver: Solver = Solver()
    criteria: SeizureCriteria = SeizureCriteria()
    schema: int = 2

    @takes_keywords
    def to_json(self, *, indent: int | None = None) -> str:
        """Write the scenario as JSON, with every field and exact numbers.

        Parameters
        ----------
        indent : int, optional
            Spaces per level, from 0 to 16; None writes one line.

        Returns
        -------
        str
            The text. It is not validated: see `validate`.

        Raises
        ------
        ScenarioError
            If `indent` is anything else.
        """
        if indent is not None:
            indent = whole_number(indent, "indent", 0, 16)
        separators = (",", ":") if indent is None else (",", ": ")
        return json.dumps(to_dict(self), allow_nan=False, indent=indent, separators=separators)
