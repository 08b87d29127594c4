"""Rules of the engines: how each combines friction and drives joints."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Friction, Joint, Shape, Tree, Where
from crawler2d.parameters.drivetrain import PI, Drivetrain
from crawler2d.parameters.track import BeltTrack, LineOfWheels, Track
from crawler2d.reading.log import ReadLog, estimate, lines, list_names
from crawler2d.reading.parts import wheel_torques
from crawler2d.reading.running_gear import Pair, SideView
from crawler2d.reading.speeds import (
    ALIKE,
    FASTEST,
    SIDES,
    acceleration_of,
    deceleration_of,
    speed_of,
    warn_of_controllers,
    warn_of_speeds,
)
from crawler2d.reading.wheels import Runner

__all__ = [
    "ENGINES",
    "MARGIN",
    "WEIGHT",
    "Engine",
    "combine_friction",
    "drivetrain_of",
    "is_first_along",
    "report_losses",
    "resistance",
    "rotor_inertia",
    "warn_ignored",
]

Engine = Literal["gz", "classic", "bullet", "mujoco", "isaac"]
_SAME = 1e-9  # [-] Coefficients are as written, so equal ones differ by no more than this.

_LARGE = 0.1
"""[-] Smaller losses of torque are within the uncertainty of a stated torque."""

_UNITS = {
    "effort": "N m",
    "gain": "N m s/rad",
    "velocity": "rad/s",
    "damping": "N m s/rad",
    "friction": "N m",
    "armature": "kg m^2",
}

_WITHIN_A_STEP = "the commanded speed is reached within one step, if the torque limit allows"
_AT_ANY_LOAD = "the commanded speed at any load, as contact surface motion (from its source code)"
WEIGHT, MARGIN = 9.81, 1.6  # [m/s^2] and the margin of Robot.simple


@dataclass(frozen=True, slots=True, kw_only=True)
class EngineLaws:
    """How an engine combines friction and drives a speed-controlled joint.

    Parameters
    ----------
    name : str
        Name of the engine.
    friction : callable
        Combines the coefficients of two surfaces.
    combination : str
        Name of the combination.
    usual_friction : float
        [-] Default coefficient of a surface.
    command : str
        Effect of a commanded wheel speed.
    surface : str
        Effect of a commanded belt speed; "" if it cannot move surfaces.
    basis : str
        Evidence: whether it was run or read.
    has_gain : bool
        Whether the motor uses the gain of a servo in the file.
    ignored : mapping of str to str
        Ignored figures of a joint with the reasons: "effort", "velocity", "damping", "friction",
        "armature".
    """

    name: str
    friction: Callable[[float, float], float]
    combination: str
    usual_friction: float
    command: str
    surface: str
    basis: str
    has_gain: bool = False
    ignored: Mapping[str, str] = field(default_factory=dict)

    def description(self, *, is_belt: bool) -> str:
        """Describe its motors."""
        if is_belt and not self.surface:
            return f"{self.name} moves no surface of a belt"
        if is_belt:
            return f"belts in {self.name}: {self.surface}"
        return f"motors in {self.name}: {self.command} ({self.basis})"


ENGINES: dict[str, EngineLaws] = {
    # Friction: the smaller, by DART's DefaultContactSurfaceHandler; in SDFormat, mu is 1.
    # gz-physics, dartsim/src: JointFeatures.cc makes a joint with a velocity command a SERVO of
    # DART, a constraint on its rate bounded by the effort limit; SDFFeatures.cc passes on effort,
    # velocity, damping and friction, each of which changed a run. SDFormat has no armature. The
    # header of gz-sim's TrackController: "Only velocity control is supported".
    "gz": EngineLaws(
        name="gz-sim",
        friction=min,
        combination="min",
        usual_friction=1.0,
        command=_WITHIN_A_STEP,
        surface=_AT_ANY_LOAD,
        basis="tested in DART 6.20 alone",
        ignored={"armature": "SDF and DART have no rotor inertia"},
    ),
    # Friction: the smaller, by ODEPhysics::Collide.
    # gazebo/physics: a velocity command is ODE's joint motor, dParamVel with dParamFMax. fmax is
    # the torque of the plugin that drives, or the effort limit with gazebo_ros_control.
    # Joint::CheckAndTruncateForce enforces the velocity limit for commanded forces only, and
    # SetParam("friction") is the same motor at rest. SimpleTrackedVehiclePlugin moves surfaces.
    "classic": EngineLaws(
        name="Gazebo Classic",
        friction=min,
        combination="min",
        usual_friction=1.0,
        command=_WITHIN_A_STEP,
        surface=_AT_ANY_LOAD,
        basis="from its source code, not tested",
        ignored={
            "velocity": "it holds for commanded forces only",
            "friction": "the motor of a commanded speed takes its place",
            "armature": "SDF and ODE have no rotor inertia",
        },
    ),
    # btManifoldResult::calculateCombinedFriction; URDF's lateral_friction is 0.5 in UrdfParser.
    # btMultiBodyJointMotor with the gains of VELOCITY_CONTROL, 0 for the position and 1 for the
    # velocity. The effort limit, the velocity limit and the friction of a URDF changed no run;
    # damping did; nor did the armature of MJCF.
    "bullet": EngineLaws(
        name="PyBullet",
        friction=lambda a, b: min(a * b, 10.0),
        combination="product",
        usual_friction=0.5,
        command=_WITHIN_A_STEP,
        surface="",
        basis="tested in PyBullet 3.2.7",
        ignored={
            "effort": "only the argument force= limits a motor, which else has 100,000 N m",
            "velocity": "every joint has a limit of 100 rad/s instead",
            "friction": "it is loaded, and used nowhere",
            "armature": "it is not loaded",
        },
    ),
    # MuJoCo's documentation, Computation, Contact parameters: the larger, element by element,
    # unless one geom has the higher priority. The default of geom/friction is 1.
    # MuJoCo's XML reference, actuator/velocity, joint/armature, joint/frictionloss. xml_urdf.cc
    # takes effort as actuatorfrcrange: "no maxvel in MuJoCo".
    "mujoco": EngineLaws(
        name="MuJoCo",
        friction=max,
        combination="max",
        usual_friction=1.0,
        command="a torque of kv times the error of the speed, within forcerange",
        surface="the commanded speed at any load, as surfacevel of the geom (tested in MuJoCo 4.0)",
        basis="tested in MuJoCo 4.0",
        has_gain=True,
        ignored={
            "velocity": "MuJoCo has no limit of a joint's speed: ctrlrange limits the command"
        },
    ),
    # PhysX, PxMaterial: the combine mode is eAVERAGE by default. Isaac's material has 0.5.
    # UrdfImporter.cpp of isaac-sim/urdf-importer-extension: effort is physics:maxForce, velocity
    # physxJoint:maxJointVelocity; a velocity target has stiffness 0 and as damping the strength
    # that the import is given. friction becomes physxJoint:jointFriction. PhysX's documentation,
    # PxArticulationDrive and PhysxJointAxisAPI: an implicit PD controller, armature.
    "isaac": EngineLaws(
        name="Isaac Sim",
        friction=lambda a, b: 0.5 * (a + b),
        combination="mean",
        usual_friction=0.5,
        command="a torque of the drive's damping times the error of the speed, within maxForce;"
        " the import sets the damping, and here the speed is held",
        surface="",
        basis="from its importer and documentation, not tested",
        ignored={
            "damping": "the strength of the drive, which the import sets, takes its place",
            "friction": "PhysX takes it as a coefficient of the load on the joint",
        },
    ),
}
"""Rules by engine."""


def combine_friction(
    runners: list[Runner], view: SideView, engine: str, ground: float
) -> tuple[float, str, list[Where]]:
    """Combine the friction of every wheel with that of the ground.

    Parameters
    ----------
    runners : list of Runner
        All wheels and drums, at least one.
    view : SideView
        The side view, for the direction of the coefficients.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine.
    ground : float
        [-] Coefficient of the ground's own surface.

    Returns
    -------
    friction : float
        [-] Friction between tracks and ground.
    source : str
        Its derivation.
    places : list of Where
        Lines that state it; empty if none does.

    Raises
    ------
    ScenarioError
        If it differs between wheels, or has no limit.
    """
    laws = ENGINES[engine]
    values: list[tuple[float, str]] = []
    places = []
    for runner, shape in [(each, shape) for each in runners for shape in each.surfaces]:
        own, priority, where = _friction_along(runner, shape, view, laws.usual_friction)
        value = laws.friction(own, ground)
        word = f"{laws.combination} with {ground:g} of the ground"
        if engine == "mujoco" and priority > 0:
            value, word = own, "of higher priority"
        elif engine == "mujoco" and priority < 0:
            value, word = ground, f"of lower priority than {ground:g} of the ground"
        of_own = f"{own:g}" if where else f"{own:g}, the engine's default,"
        values.append((value, f"{of_own} along the track, {word}"))
        if abs(value - values[0][0]) > _SAME:
            path = f"{where or shape.at}: friction[{runner.name}]"
            raise ScenarioError(path, value, f"must be that of all wheels, {values[0][0]:g}")
        if where is not None:
            places.append(where)
    (friction, source), *_ = values  # a model without wheels has been refused
    if not math.isfinite(friction):
        raise ScenarioError(f"{places[0]}: friction", friction, "must have a limit")
    return friction, source, places


def rotor_inertia(
    log: ReadLog, path: str, inertias: Sequence[float], joints: Sequence[Joint]
) -> float:
    """[kg m^2] Return the rotor inertia of one side in the engine, and log its source.

    Parameters
    ----------
    log : ReadLog
        Takes source and warnings.
    path : str
        Of the figure.
    inertias : sequence of float
        [kg m^2] Rotor inertias of both sides, or of all wheels with their own motors; the mean is
        used.
    joints : sequence of Joint
        The joints of the motors.
    """
    laws = ENGINES[log.engine]
    stating = [joint for joint in joints if joint.armature > 0.0]
    places = lines([joint.dynamics_at for joint in stating], "sum of one side")
    if not stating or "armature" in laws.ignored:
        where = f"{places}: none in {laws.name}" if stating else f"{log.at}: none"
        log.sources[path] = where
        return 0.0
    log.sources[path] = places
    if not math.isclose(min(inertias), max(inertias), rel_tol=ALIKE):
        value = f"{min(inertias):.4g} to {max(inertias):.4g} kg m^2"
        log.add_warning(path, value, "differs from motor to motor: the mean is used")
    return sum(inertias) / len(inertias)


def warn_ignored(log: ReadLog, joints: Sequence[Joint]) -> None:
    """Warn of the figures of joints of all wheels, or all flippers, that the engine ignores."""
    laws = ENGINES[log.engine]
    for name, reason in laws.ignored.items():
        stating = [joint for joint in joints if _states(joint, name)]
        # Speeds in MJCF limit commands, which applies in all engines.
        if stating and not (log.tree.format == "MJCF" and name == "velocity"):
            first = stating[0]
            where = getattr(first, f"{name}_at", first.dynamics_at)
            path = f"{where}: {name}[{list_names([joint.name for joint in stating])}]"
            value = f"{getattr(first, name):.4g} {_UNITS[name]}"
            log.add_warning(path, value, f"has no effect in {laws.name}: {reason}")


def report_losses(log: ReadLog, joints: Sequence[Joint], lost: float, limit: float) -> None:
    """Report the torque lost to damping and friction at full speed, which motors here lack.

    Parameters
    ----------
    log : ReadLog
        Gets a warning if it exceeds a tenth of the limit, else a note.
    joints : sequence of Joint
        Of the motors.
    lost, limit : float
        [N m] Loss and limit of one side.
    """
    if not lost > 0.0:
        return
    first = next(joint for joint in joints if _states(joint, "damping", "friction"))
    path, name = f"{first.dynamics_at}: joint[{first.name}]", ENGINES[log.engine].name
    part = f"{lost:.3g} of {limit:.3g} N m of a side"
    if lost > _LARGE * limit:
        log.add_warning(path, part, f"is lost to damping and friction in {name}, but not here")
    else:
        log.notes.append(f"{path}: damping and friction take {part} in {name}, and none here")


def resistance(joint: Joint, rate: float, engine: str) -> float:
    """[N m] Return the torque lost to damping and friction at a rate [rad/s] in an engine."""
    ignored = ENGINES[engine].ignored
    damping = 0.0 if "damping" in ignored else joint.damping * rate
    return damping + (0.0 if "friction" in ignored else joint.friction)


def drivetrain_of(
    log: ReadLog,
    pairs: list[Pair],
    on_flippers: list[Pair],
    tracks: Sequence[Track],
    *,
    radius: float,
    torque: float,
) -> Drivetrain:
    """Return speed and torque of the tracks.

    Parameters
    ----------
    log : ReadLog
        Gets the sources of figures, and warnings about ignored figures.
    pairs : list of Pair
        Wheels of the chassis, or of the flippers if it has none; drums have no joint.
    on_flippers : list of Pair
        Wheels that share torque and speed with those of the chassis.
    tracks : sequence of Track
        The models of the tracks, that of the chassis first.
    radius : float
        [m] Radius of the rear end, where the torque of a robot acts.
    torque : float
        [N m] The estimate for a motor without limit.
    """
    tree, engine = log.tree, log.engine
    log.notes.append(ENGINES[engine].description(is_belt=isinstance(tracks[0], BeltTrack)))
    speed, speed_source = speed_of(tree, [*pairs, *on_flippers])
    warn_of_speeds(log, [*pairs, *on_flippers], speed)
    warn_of_controllers(log)
    alone, _ = speed_of(tree, pairs)
    if speed < alone:
        log.notes.append(
            f"wheels on flippers limit the speed of all tracks to {speed:.3g} m/s: here these run"
            f" at one speed, and those of the chassis alone could at {alone:.3g} m/s"
        )
    sides = [_wheels(tree, pairs, side, engine) for side in SIDES]
    of_chassis = [wheel for side in sides for wheel in side]
    if of_chassis:  # not just a belt, whose force wheels on flippers do not state
        arms = [_wheels(tree, on_flippers, side, engine) for side in SIDES]
        sides = [[*own, *more] for own, more in zip(sides, arms, strict=True)]
    wheels = [wheel for side in sides for wheel in side]
    joints = [joint for joint, _ in wheels]
    # Freely rolling wheels have no motor, whatever limit their joints state.
    motors = [wheel for wheel in wheels if wheel[0].name in tree.driven] or wheels
    if not all(joint.effort for joint, _ in motors):  # wheels on flippers may state none
        motors = [wheel for wheel in motors if wheel in of_chassis] or motors
    forces = [joint.effort / own for joint, own in motors if joint.effort]
    has_limits = bool(motors) and len(forces) == len(motors)
    torque_source = estimate("that of Robot.simple: the file has no limit")
    sharing_source = estimate("one speed, as motors without limit hold")
    if has_limits:
        # Each wheel has its own motor; the robot's figure is the sum of one side.
        torque = 0.5 * sum(forces) * radius
        torque_source = lines([joint.effort_at for joint, _ in motors], "sum of one side")
        sharing_source = lines([joint.at for joint in joints])
        pulls = {joint.name: (joint.effort or 0.0) * radius / own for joint, own in motors}
        _warn_of_sides(log, "effort", pulls, sides)
    sharing = _sharing(log, motors, tracks) if has_limits and motors == wheels else "track"
    none = f"{tree.at}: none"
    gaining, gaining_source = acceleration_of(tree)
    slowing, slowing_source = deceleration_of(tree)
    log.cite("robot.drivetrain", max_speed=speed_source)
    log.cite("robot.drivetrain", max_acceleration=gaining_source, max_deceleration=slowing_source)
    log.cite("robot.drivetrain", max_torque=torque_source, torque_sharing=sharing_source)
    log.cite("robot.drivetrain", no_load_speed=none, torque_curve=none, self_locking=none)
    warn_ignored(log, joints)
    lost = 0.5 * sum(resistance(joint, speed / own, engine) * radius / own for joint, own in wheels)
    report_losses(log, joints, lost, torque)
    # Reflected to the sprocket, a wheel's rotor counts by the square of the ratio of their rates.
    rotors = [[joint.armature * (radius / own) ** 2 for joint, own in side] for side in sides]
    inertias = [sum(side) for side in rotors]
    if sharing == "wheel":
        inertias = [len(side) * rotor for side in rotors for rotor in side]
    controller = _controller(log, motors, of_chassis, sides, radius)
    gain_torque = torque if controller is None else controller.gain * speed / radius
    if gain_torque < torque and has_limits:
        path = f"{motors[0][0].gain_at}: gain[{motors[0][0].name}]"
        value = f"{gain_torque:.3g} of {torque:.3g} N m of a side"
        log.add_warning(path, value, "is too soft for the torque limit, even at full speed")
    return Drivetrain(
        max_speed=speed,
        max_acceleration=gaining,
        max_deceleration=slowing,
        max_torque=torque,
        torque_sharing=sharing,
        rotor_inertia=rotor_inertia(log, "robot.drivetrain.rotor_inertia", inertias, joints),
        controller=controller,
    )


def _friction_along(
    runner: Runner, shape: Shape, view: SideView, usual: float
) -> tuple[float, int, Where | None]:
    """Return the coefficient along the track, its priority, and its line."""
    friction = shape.friction
    if friction is None:
        return usual, 0, None
    if is_first_along(runner, friction, view):
        return friction.first, friction.priority, friction.first_at
    return friction.second, friction.priority, friction.second_at


def is_first_along(runner: Runner, friction: Friction, view: SideView) -> bool:
    """Whether the first direction of a surface, instead of the second, is along the track.

    A track controller turns it there. Otherwise it is fdir1, in the frame of the collision; without
    fdir1 an engine may choose any direction, so the smaller coefficient counts.
    """
    if runner.joint is None:
        return True
    if friction.direction is None:
        return friction.first <= friction.second
    return bool(abs(friction.direction @ view.left) <= math.sqrt(0.5))


def _states(joint: Joint, *names: str) -> bool:
    values = [getattr(joint, name) or 0.0 for name in names]
    return any(
        0.0 < value <= (FASTEST if name == "velocity" else math.inf)
        for name, value in zip(names, values, strict=True)
    )


def _warn_of_sides(
    log: ReadLog,
    name: str,
    figures: Mapping[str, float],
    sides: Sequence[Sequence[tuple[Joint, float]]],
) -> None:
    """Warn if the sums of both sides differ, as one drive turns both.

    Parameters
    ----------
    log : ReadLog
        Takes the warning.
    name : {"effort", "gain"}
        What is summed.
    figures : mapping of str to float
        It by the name of each joint, at the radius of the robot's rear end.
    sides : sequence of sequence of (Joint, float)
        The joints of the left and of the right side, in the same order.
    """
    left, right = (sum(figures.get(joint.name, 0.0) for joint, _ in side) for side in sides)
    if math.isclose(left, right, rel_tol=ALIKE):
        return
    unlike = [
        joint
        for (one, _), (other, _) in zip(*sides, strict=False)
        for joint in (one, other)
        if not math.isclose(*(figures.get(each.name, 0.0) for each in (one, other)))
    ]
    names = list_names([joint.name for joint in unlike])
    path = f"{lines([getattr(joint, f'{name}_at') for joint in unlike])}: {name}[{names}]"
    value = f"{left:.4g} {_UNITS[name]} left and {right:.4g} {_UNITS[name]} right"
    log.add_warning(path, value, "differs from side to side: the mean of their sums is used")


def _wheels(tree: Tree, pairs: Sequence[Pair], side: str, engine: str) -> list[tuple[Joint, float]]:
    """Return the joints of one side with the radii [m] of their wheels; drums have none."""
    # Differential drives of Gazebo Classic have their own motor limits.
    torques = wheel_torques(tree.plugins) if engine == "classic" else {}
    wheels = []
    for runner in (each for pair in pairs for each in getattr(pair, side)):
        joint = runner.joint
        if joint is not None and joint.name in torques:
            effort, where = torques[joint.name]
            joint = replace(joint, effort=effort, effort_at=where)
        if joint is not None:
            wheels.append((joint, runner.radius))
    return wheels


def _sharing(
    log: ReadLog, motors: Sequence[tuple[Joint, float]], tracks: Sequence[Track]
) -> Literal["track", "wheel"]:
    """Return how motors, with the radii [m] of their wheels, share the torque of a side.

    Equal motors of a line of wheels share it by wheel, unless flippers have belts; a note tells if
    equal torques give different forces.
    """
    track, *others = tracks
    efforts = [joint.effort for joint, _ in motors if joint.effort]  # of all: they have limits
    forces = [effort / own for effort, (_, own) in zip(efforts, motors, strict=True)]
    is_even = math.isclose(min(forces), max(forces), rel_tol=ALIKE)
    has_belt = any(isinstance(other, BeltTrack) for other in others)
    is_line = isinstance(track, LineOfWheels) and not has_belt
    if not is_line or not (is_even or len(set(efforts)) == 1):
        return "track"
    if not is_even:
        mean = sum(forces) / len(forces)
        low, high = mean / max(forces), mean / min(forces)
        log.notes.append(
            "wheels of all sizes share the torque of a side as equal forces:"
            f" each has {low:.3g} to {high:.3g} times the force that the file gives it"
        )
    return "wheel"


def _controller(
    log: ReadLog,
    wheels: Sequence[tuple[Joint, float]],
    of_chassis: Sequence[tuple[Joint, float]],
    sides: Sequence[Sequence[tuple[Joint, float]]],
    radius: float,
) -> PI | None:
    """Return the controller of one side: the servos of its wheels, if the engine has them.

    All wheels of the chassis need a servo. Motors on flippers without one add nothing to the gain.
    """
    servos = [wheel for wheel in wheels if (wheel[0].gain or 0.0) > 0.0]
    others = [wheel for wheel in wheels if wheel not in servos]
    if not ENGINES[log.engine].has_gain or not servos or any(each in of_chassis for each in others):
        log.cite("robot.drivetrain", controller=f"{log.at}: none")
        return None
    gains = {joint.name: (joint.gain or 0.0) * (radius / own) ** 2 for joint, own in servos}
    _warn_of_sides(log, "gain", gains, sides)
    places = lines([joint.gain_at for joint, _ in servos], "sum of one side")
    log.sources["robot.drivetrain.controller"] = places
    if others:
        names = list_names([joint.name for joint, _ in others])
        reason = "have no servo of their speed: the gain of a side is that of its other wheels"
        log.add_warning(others[0][0].gain_at, names, reason)
    return PI(gain=0.5 * sum(gains.values()))
