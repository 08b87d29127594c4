"""What a scenario says besides robot and ground: command, start, solver, criteria."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

from crawler2d.parameters.gaits import Gait
from crawler2d.parameters.plain import Parameters

__all__ = ["Drive", "SeizureCriteria", "Solver", "Start"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Drive(Parameters):
    """What a driver commands: the speed of the tracks, and how the flippers move.

    Parameters
    ----------
    speed : float
        [m/s] Track speed; above 0 drives towards +x.
    schedule : array_like, shape (n, 2), optional
        Times [s], rising, and the speeds [m/s] that hold from then on.
    gait : Hold or Climb, optional
        How the flippers move; None holds them where they start. A robot without flippers has
        nothing to move, so that a sweep may leave them off and keep the gait.

    Examples
    --------
    Back after five seconds:

    >>> Drive(speed=0.4, schedule=[(5.0, -0.4)]).schedule
    ((5.0, -0.4),)
    """

    place: ClassVar[str] = "drive"

    speed: float = 0.4
    schedule: tuple[tuple[float, float], ...] | None = None
    gait: Gait | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Start(Parameters):
    """How the robot stands at time 0: at rest, touching the ground.

    Parameters
    ----------
    approach : float
        [m] From the robot's foremost point to the first edge at or beyond x = 0.
    track_phase : float
        [m] Common advance of all wheels, or of the belt.
    angle : float
        [rad] Chassis angle, nose up > 0.
    """

    place: ClassVar[str] = "start"

    approach: float = 0.10
    track_phase: float = 0.0
    angle: float = 0.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Solver(Parameters):
    """How the equations of motion are solved; the defaults come from a convergence study.

    Parameters
    ----------
    contact : {"own", "reference"}
        Who finds the contacts: our own exact geometry, or the engine's queries of convex pieces on
        one polyline, which are slower and cut rounded edges into facets; these are there to compare
        with.
    time_step : float
        [s] Time between two looks for contacts.
    substeps : int
        Substeps of a step; one in which a part strikes the ground is cut there.
    iterations : int, optional
        Largest number of rounds in search of the forces that all contacts agree on, each a few
        guesses and a descent; None takes 30. One is enough as a rule. A chain of shoes is solved in
        another way, in one round of at most 16 steps: it takes no number.
    contact_frequency : float
        [Hz] Natural frequency of the contact softness.
    contact_damping_ratio : float
        [-] Damping ratio of the contact softness.
    max_push_speed : float
        [m/s] Fastest push out of a penetration.
    prediction_distance : float
        [m] Contacts are looked for up to this gap.
    """

    place: ClassVar[str] = "solver"

    contact: Literal["own", "reference"] = "own"
    time_step: float = 1e-3
    substeps: int = 2
    iterations: int | None = None
    contact_frequency: float = 1000.0
    contact_damping_ratio: float = 5.0
    max_push_speed: float = 0.5
    prediction_distance: float = 0.001


@dataclass(frozen=True, slots=True, kw_only=True)
class SeizureCriteria(Parameters):
    """When a run ends, and when a stop counts as one.

    Parameters
    ----------
    stop_window : float
        [s] Shortest time without progress that is a stop.
    stop_pitches : float
        [-] Grouser pitches at the commanded speed that must pass without progress.
    stop_progress : float
        [-] Share of the commanded distance below which there is no progress.
    stationary_distance : float
        [m] Largest change of pose of a stationary state.
    stationary_windows : int
        Windows for which a state must be stationary to end the run early.
    clear_time : float
        [s] Time for which the goal must be held.
    clear_angle : float
        [rad] Largest angle between chassis and ground at the goal.
    tip_over_angle : float
        [rad] Chassis angle at which the robot has tipped over.
    intrusion_depth : float
        [m] Ground inside the envelope of the track is an intrusion beyond this depth, 0 to 0.1. The
        default lies above what round wheels and belts sink in when they strike an edge (0.2 mm).
        With 0 the ground that the robot rests on joins the pieces under it.
    intrusion_load : float
        [-] Share of the weight from which an intrusion is loaded; less is a touch in passing.
    belly_load : float
        [-] Share of the weight on the belly from which a stop without a seizure is a hang-up: what
        is missing below the tracks is then more than the friction number is usually known to.
    sliding_speed : float
        [-] Share of the commanded speed from which a surface slides, or a drive turns. A solver's
        sticking contact creeps by a thousandth of that.
    torque_limit : float
        [-] Share of the torque limit from which a motor is at its limit, in the mean.
    cycling_distance : float
        [m] A robot that moves to and fro by this much within a stop window is cycling: more than
        jammed grousers rattle, less than the spacing of any wheels.
    imbalance : float
        [-] Share of the weight that an equilibrium of a stationary state may leave unbalanced.
    mean_imbalance : float
        [-] The same for the means of a state that rattles on.
    creep_from, creep_to : float
        [-] Shares of the commanded distance between which the robot creeps.
    escape_distance : float
        [m] Advance that counts as getting away from a stop.
    escape_time : float
        [s] Time that a closed belt is given to get away from a stop.
    """

    place: ClassVar[str] = "criteria"

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
