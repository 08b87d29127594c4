"""The laws of the engines: how each combines friction and drives joints."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Joint, Shape, Tree, Where
from crawler2d.parameters.drivetrain import PI, Drivetrain
from crawler2d.parameters.track import BeltTrack, LineOfWheels, Track
from crawler2d.reading.log import Telling, estimate, lines, named
from crawler2d.reading.parts import wheel_torques
from crawler2d.reading.running_gear import Pair, SideView
from crawler2d.reading.wheels import Runner

__all__ = [
    "ACTUATORS",
    "ENGINES",
    "FASTEST",
    "MARGIN",
    "WEIGHT",
    "Engine",
    "Note",
    "combined",
    "drivetrain_of",
    "resistance",
    "rotor_inertia",
    "tell_ignored",
    "tell_lost",
]

Engine = Literal["gz", "classic", "bullet", "mujoco", "isaac"]


_SAME = 1e-9  # [-] Coefficients are as written: no rounding lies between two that are meant equal.


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """How an engine combines the coefficients of two surfaces.

    Parameters
    ----------
    of_two : callable
        What it makes of both.
    word : str
        What that is called.
    usual : float
        [-] The coefficient of a surface of which a file says nothing.
    """

    of_two: Callable[[float, float], float]
    word: str
    usual: float


ENGINES: dict[str, Rule] = {
    # The smaller: DefaultContactSurfaceHandler of DART, which gz-sim runs, and ODEPhysics::Collide
    # of Gazebo Classic. In SDFormat, mu is 1.
    "gz": Rule(of_two=min, word="min", usual=1.0),
    "classic": Rule(of_two=min, word="min", usual=1.0),
    # btManifoldResult::calculateCombinedFriction; URDF's lateral_friction is 0.5 in UrdfParser.
    "bullet": Rule(of_two=lambda a, b: min(a * b, 10.0), word="product", usual=0.5),
    # MuJoCo's documentation, Computation, Contact parameters: the larger, element by element,
    # unless one geom has the higher priority. The default of geom/friction is 1.
    "mujoco": Rule(of_two=max, word="max", usual=1.0),
    # PhysX, PxMaterial: the combine mode is eAVERAGE by default. Isaac's material has 0.5.
    "isaac": Rule(of_two=lambda a, b: 0.5 * (a + b), word="mean", usual=0.5),
}
"""The rules by engine."""


def combined(
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
        [-] Between tracks and ground.
    source : str
        How it came about.
    places : list of Where
        The lines that state it; empty if none does.

    Raises
    ------
    ScenarioError
        If it differs from wheel to wheel, or has no limit.
    """
    rule = ENGINES[engine]
    first: tuple[float, str] | None = None
    places = []
    for runner, shape in [(each, shape) for each in runners for shape in each.surfaces]:
        own, priority, where = _along(runner, shape, view, rule.usual)
        wins = engine == "mujoco" and priority > 0
        value = own if wins else rule.of_two(own, ground)
        of_own = f"{own:g}" if where else f"{own:g}, the engine's default,"
        word = "of higher priority" if wins else f"{rule.word} with {ground:g} of the ground"
        if first is None:
            first = value, f"{of_own} along the track, {word}"
        if abs(value - first[0]) > _SAME:
            path = f"{where or shape.at}: friction[{runner.name}]"
            raise ScenarioError(path, value, f"must be that of all wheels, {first[0]:g}")
        if where is not None:
            places.append(where)
    assert first is not None  # a model without wheels has been refused
    if not math.isfinite(first[0]):
        raise ScenarioError(f"{places[0]}: friction", first[0], "must have a limit")
    return (*first, places)


def _along(
    runner: Runner, shape: Shape, view: SideView, usual: float
) -> tuple[float, int, Where | None]:
    """Return the coefficient along the track, its priority, and its line.

    A controller of tracks turns the first direction along the track. Else it is fdir1, in the frame
    of the collision; without one, an engine may turn it anywhere, and the smaller holds.
    """
    found = shape.friction
    if found is None:
        return usual, 0, None
    if runner.joint is None:
        is_first = True
    elif found.direction is None:
        is_first = found.first <= found.second
    else:
        is_first = bool(abs(found.direction @ view.left) <= math.sqrt(0.5))
    if is_first:
        return found.first, found.priority, found.first_at
    return found.second, found.priority, found.second_at


FASTEST = 100.0
"""[rad/s] and [m/s] Larger limits of speed are meant as none."""


_ALIKE = 0.01
"""[-] By how much rotors may differ, as a share of the largest: files round them."""


_LARGE = 0.1
"""[-] Of a torque: a loss of less lies within what is not known of a torque that a file states."""


_UNITS = {
    "effort": "N m",
    "velocity": "rad/s",
    "damping": "N m s/rad",
    "friction": "N m",
    "armature": "kg m^2",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Actuator:
    """How an engine drives a joint that is told a speed.

    Parameters
    ----------
    name : str
        Of the engine.
    command : str
        What a commanded speed of a wheel is.
    surface : str
        What a commanded speed of a belt is, whose surface is moved; empty if it moves none.
    basis : str
        What that rests on: whether it was run or read.
    has_gain : bool
        Whether the gain of a servo in the file is that of the motor.
    ignored : mapping of str to str
        The figures of a joint that play no part, each with the reason: "effort", "velocity",
        "damping", "friction", "armature".
    """

    name: str
    command: str
    surface: str
    basis: str
    has_gain: bool = False
    ignored: Mapping[str, str] = field(default_factory=dict)

    def in_words(self, *, is_belt: bool) -> str:
        """Say what its motors do."""
        if is_belt and not self.surface:
            return f"{self.name} moves no surface of a belt"
        if is_belt:
            return f"belts in {self.name}: {self.surface}"
        return f"motors in {self.name}: {self.command} ({self.basis})"


_WITHIN_A_STEP = "the commanded speed within one step, as far as the torque limit allows"


ACTUATORS: dict[str, Actuator] = {
    # gz-physics, dartsim/src: JointFeatures.cc makes a joint with a velocity command a SERVO of
    # DART, a constraint on its rate bounded by the effort limit; SDFFeatures.cc hands over effort,
    # velocity, damping and friction, each of which changed a run. SDFormat has no armature. The
    # header of gz-sim's TrackController: "Only velocity control is supported".
    "gz": Actuator(
        name="gz-sim",
        command=_WITHIN_A_STEP,
        surface="the commanded speed at any load, as contact surface motion (read in its source)",
        basis="run in DART 6.20 by itself",
        ignored={"armature": "SDF and DART have no rotor inertia"},
    ),
    # gazebo/physics: a velocity command is ODE's joint motor, dParamVel with dParamFMax. fmax is
    # the torque of the plugin that drives, or the effort limit with gazebo_ros_control.
    # Joint::CheckAndTruncateForce keeps the velocity limit for commanded forces only, and
    # SetParam("friction") is the same motor at rest. SimpleTrackedVehiclePlugin moves surfaces.
    "classic": Actuator(
        name="Gazebo Classic",
        command=_WITHIN_A_STEP,
        surface="the commanded speed at any load, as contact surface motion (read in its source)",
        basis="read in its source, not run",
        ignored={
            "velocity": "it holds for commanded forces only",
            "friction": "the motor of a commanded speed takes its place",
            "armature": "SDF and ODE have no rotor inertia",
        },
    ),
    # btMultiBodyJointMotor with the gains of VELOCITY_CONTROL, 0 for the position and 1 for the
    # velocity. The effort limit, the velocity limit and the friction of a URDF changed no run;
    # damping did; nor did the armature of MJCF.
    "bullet": Actuator(
        name="PyBullet",
        command=_WITHIN_A_STEP,
        surface="",
        basis="run in PyBullet 3.2.7",
        ignored={
            "effort": "only the argument force= limits a motor, which else has 100,000 N m",
            "velocity": "every joint has a limit of 100 rad/s instead",
            "friction": "it is loaded, and used nowhere",
            "armature": "it is not loaded",
        },
    ),
    # MuJoCo's XML reference, actuator/velocity, joint/armature, joint/frictionloss. xml_urdf.cc
    # takes effort as actuatorfrcrange: "no maxvel in MuJoCo".
    "mujoco": Actuator(
        name="MuJoCo",
        command="a torque of kv times the error of the speed, within forcerange",
        surface="the commanded speed at any load, as surfacevel of the geom (run in MuJoCo 4.0)",
        basis="run in MuJoCo 4.0",
        has_gain=True,
        ignored={
            "velocity": "MuJoCo has no limit of a joint's speed: ctrlrange limits the command"
        },
    ),
    # UrdfImporter.cpp of isaac-sim/urdf-importer-extension: effort is physics:maxForce, velocity
    # physxJoint:maxJointVelocity; a velocity target has stiffness 0 and as damping the strength
    # that the import is given. friction becomes physxJoint:jointFriction. PhysX's documentation,
    # PxArticulationDrive and PhysxJointAxisAPI: an implicit PD controller, armature.
    "isaac": Actuator(
        name="Isaac Sim",
        command="a torque of the drive's damping times the error of the speed, within maxForce;"
        " the import sets the damping, and here the speed is held",
        surface="",
        basis="read in its importer and its documentation, not run",
        ignored={
            "damping": "the strength of the drive, which the import sets, takes its place",
            "friction": "PhysX takes it as a coefficient of the load on the joint",
        },
    ),
}
"""The laws by engine."""


def rotor_inertia(
    told: Telling,
    path: str,
    shares: Sequence[float],
    joints: Sequence[Joint],
    *,
    engine: str,
    at: Where,
) -> float:
    """[kg m^2] Return the rotor inertia of one side as the engine has it, and tell its source.

    Parameters
    ----------
    told : Telling
        Takes source and doubts.
    path : str
        Of the figure.
    shares : sequence of float
        [kg m^2] What both sides state, or all wheels with motors of their own: their mean counts.
    joints : sequence of Joint
        What states it.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine.
    at : Where
        Line of the model, for a file that states none.
    """
    stating = [joint for joint in joints if joint.armature > 0.0]
    if not stating:
        told.note(path, f"{at}: none")
        return 0.0
    places = lines([joint.dynamics_at for joint in stating], "sum of one side")
    if "armature" in ACTUATORS[engine].ignored:
        told.note(path, f"{places}: none in {ACTUATORS[engine].name}")
        return 0.0
    told.note(path, places)
    if max(shares) - min(shares) > _ALIKE * max(shares):
        value = f"{min(shares):.4g} to {max(shares):.4g} kg m^2"
        told.doubts.append((path, value, "differs from motor to motor: the mean is used"))
    return sum(shares) / len(shares)


def tell_ignored(told: Telling, joints: Sequence[Joint], *, engine: str, is_mjcf: bool) -> None:
    """Doubt the figures of joints that the engine ignores, each once.

    Parameters
    ----------
    told : Telling
        Takes the doubts.
    joints : sequence of Joint
        Those of all wheels, or of all flippers.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine.
    is_mjcf : bool
        Whether the file is MJCF, whose speeds are limits of commands, which all engines keep.
    """
    actuator = ACTUATORS[engine]
    for name, reason in actuator.ignored.items():
        stating = [joint for joint in joints if _states(joint, name)]
        if stating and not (is_mjcf and name == "velocity"):
            first = stating[0]
            where = getattr(first, f"{name}_at", first.dynamics_at)
            path = f"{where}: {name}[{named([joint.name for joint in stating])}]"
            value = f"{getattr(first, name):.4g} {_UNITS[name]}"
            told.doubts.append((path, value, f"plays no part in {actuator.name}: {reason}"))


def tell_lost(
    told: Telling, joints: Sequence[Joint], lost: float, limit: float, *, engine: str
) -> None:
    """Tell of a torque that damping and friction take at full speed: no motor here has them.

    Parameters
    ----------
    told : Telling
        Takes a doubt if it is more than a tenth of the limit, or else a note.
    joints : sequence of Joint
        Of the motors.
    lost, limit : float
        [N m] What one side loses, and what it has.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine.
    """
    if not lost > 0.0:
        return
    first = next(joint for joint in joints if _states(joint, "damping", "friction"))
    path, name = f"{first.dynamics_at}: joint[{first.name}]", ACTUATORS[engine].name
    part = f"{lost:.3g} of {limit:.3g} N m of a side"
    if lost > _LARGE * limit:
        reason = f"takes a part of the torque by damping and friction in {name}, and none here"
        told.doubts.append((path, part, reason))
    else:
        told.notes.append(f"{path}: damping and friction take {part} in {name}, and none here")


def resistance(joint: Joint, rate: float, engine: str) -> float:
    """[N m] Return the torque that damping and friction take at a rate [rad/s], in an engine."""
    ignored = ACTUATORS[engine].ignored
    damping = 0.0 if "damping" in ignored else joint.damping * rate
    return damping + (0.0 if "friction" in ignored else joint.friction)


def _states(joint: Joint, *names: str) -> bool:
    values = [getattr(joint, name) or 0.0 for name in names]
    return any(
        0.0 < value <= (FASTEST if name == "velocity" else math.inf)
        for name, value in zip(names, values, strict=True)
    )


_SPEED, _ACCELERATION, _DECELERATION = 1.0, 1.0, 4.0  # those of Robot.simple


WEIGHT, MARGIN = 9.81, 1.6  # [m/s^2] and the margin of Robot.simple


Note = Callable[[str, str], None]


def drivetrain_of(
    told: Telling,
    tree: Tree,
    pairs: list[Pair],
    track: Track,
    *,
    engine: str,
    radius: float,
    torque: float,
) -> Drivetrain:
    """Return speed and torque of the tracks.

    Parameters
    ----------
    told : Telling
        Takes the sources of the figures, and what the engine ignores.
    tree : Tree
        The model.
    pairs : list of Pair
        Wheels of the chassis, or of the flippers if it has none; drums have no joint.
    track : Track
        The model of the track of the chassis.
    engine : {"gz", "classic", "bullet", "mujoco", "isaac"}
        The engine that drives it.
    radius : float
        [m] Of the rear end, at which the torque of a robot acts.
    torque : float
        [N m] The estimate for a motor without limit.
    """
    note = told.note
    told.notes.append(ACTUATORS[engine].in_words(is_belt=isinstance(track, BeltTrack)))
    speed, source = _speed(tree, pairs)
    note("robot.drivetrain.max_speed", source)
    for name in ("max_acceleration", "max_deceleration"):
        note(f"robot.drivetrain.{name}", estimate("that of Robot.simple"))
    sides = [_wheels(tree, pairs, side, engine) for side in ("left", "right")]
    joints = [joint for side in sides for joint, _ in side]
    efforts = [joint.effort for joint in joints if joint.effort]
    sharing = "track"
    if joints and len(efforts) == len(joints):
        # Every wheel has its own motor; the robot's figure is that of one side.
        torque = 0.5 * sum(
            (joint.effort or 0.0) * radius / own for side in sides for joint, own in side
        )
        places = [joint.effort_at for joint in joints]
        note("robot.drivetrain.max_torque", lines(places, "sum of one side"))
        sharing = "wheel" if isinstance(track, LineOfWheels) and len(set(efforts)) == 1 else "track"
        note("robot.drivetrain.torque_sharing", lines([joint.at for joint in joints]))
    else:
        note("robot.drivetrain.max_torque", estimate("that of Robot.simple: the file has no limit"))
        note("robot.drivetrain.torque_sharing", estimate("one speed, as motors without limit hold"))
    tell_ignored(told, joints, engine=engine, is_mjcf=tree.format == "MJCF")
    lost = 0.5 * sum(
        resistance(joint, speed / own, engine) * radius / own
        for side in sides
        for joint, own in side
    )
    tell_lost(told, joints, lost, torque, engine=engine)
    for name in ("no_load_speed", "torque_curve", "self_locking"):
        note(f"robot.drivetrain.{name}", f"{tree.at}: none")
    # At the sprocket a wheel's rotor counts by the square of the ratio of their rates.
    rotors = [[joint.armature * (radius / own) ** 2 for joint, own in side] for side in sides]
    shares = [sum(side) for side in rotors]
    if sharing == "wheel":
        shares = [len(side) * rotor for side in rotors for rotor in side]
    path = "robot.drivetrain.rotor_inertia"
    controller = _controller(told, sides, engine=engine, radius=radius, at=tree.at)
    firm = torque if controller is None else controller.gain * speed / radius
    if firm < torque and len(efforts) == len(joints):
        where = f"{joints[0].gain_at}: gain[{joints[0].name}]"
        value = f"{firm:.3g} of {torque:.3g} N m of a side"
        told.doubts.append((where, value, "is too soft for the torque limit, even at full speed"))
    return Drivetrain(
        max_speed=speed,
        max_acceleration=_ACCELERATION,
        max_deceleration=_DECELERATION,
        max_torque=torque,
        torque_sharing="wheel" if sharing == "wheel" else "track",
        rotor_inertia=rotor_inertia(told, path, shares, joints, engine=engine, at=tree.at),
        controller=controller,
    )


def _controller(
    told: Telling,
    sides: Sequence[Sequence[tuple[Joint, float]]],
    *,
    engine: str,
    radius: float,
    at: Where,
) -> PI | None:
    """Return the controller of one side: the servos of its wheels, if the engine has such."""
    wheels = [wheel for side in sides for wheel in side]
    gains = [(joint.gain or 0.0) * (radius / own) ** 2 for joint, own in wheels]
    if not ACTUATORS[engine].has_gain or not gains or not min(gains) > 0.0:
        told.note("robot.drivetrain.controller", f"{at}: none")
        return None
    places = lines([joint.gain_at for joint, _ in wheels], "sum of one side")
    told.note("robot.drivetrain.controller", places)
    return PI(gain=0.5 * sum(gains))


def _wheels(tree: Tree, pairs: Sequence[Pair], side: str, engine: str) -> list[tuple[Joint, float]]:
    """Return the joints of one side with the radii [m] of their wheels; drums have none."""
    # The differential drives of Gazebo Classic limit their motors by themselves.
    torques = wheel_torques(tree.plugins) if engine == "classic" else {}
    found = []
    for runner in [each for pair in pairs for each in getattr(pair, side)]:
        joint = runner.joint
        if joint is not None and joint.name in torques:
            effort, where = torques[joint.name]
            joint = replace(joint, effort=effort, effort_at=where)
        if joint is not None:
            found.append((joint, runner.radius))
    return found


def _speed(tree: Tree, pairs: list[Pair]) -> tuple[float, str]:
    """[m/s] Return the largest speed of the track: the slowest of its wheels sets it."""
    found: list[tuple[float, Where]] = [
        (wheel.joint.velocity * wheel.radius, wheel.joint.velocity_at)
        for pair in pairs
        for wheel in pair.both
        if wheel.joint is not None and wheel.joint.velocity
    ]
    found += [
        (drum.shape.surface_speed, drum.shape.at)
        for pair in pairs
        for drum in pair.both
        if drum.joint is None and drum.shape.surface_speed
    ]
    for plugin in tree.plugins:
        if "track" in plugin.name.lower() or "diff" in plugin.name.lower():
            for text, where in plugin.values("max_velocity", "max_linear_velocity"):
                try:
                    found.append((float(text), where))
                except ValueError:
                    continue
    found = [(speed, where) for speed, where in found if 0.0 < speed <= FASTEST]
    if not found:
        return _SPEED, estimate("that of Robot.simple: the file has no limit")
    speed = min(speed for speed, _ in found)
    return speed, lines([where for each, where in found if each == speed])
