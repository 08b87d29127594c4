"""Links, joints and collision shapes of a robot, independent of the file format.

Everything is in the frame of the model, z up, with all joints at zero, in metres, kilograms and
radians. None means not given.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "NOWHERE",
    "TWO_TURNS",
    "Array",
    "Friction",
    "Joint",
    "Link",
    "Plugin",
    "Pose",
    "Shape",
    "Tree",
    "Unread",
    "Where",
    "from_quaternion",
    "from_rpy",
    "unit",
]


@dataclass(frozen=True, slots=True)
class Where:
    """A line of a file.

    Parameters
    ----------
    file : str
        Its name.
    line : int
        Number of the line, from 1.

    Examples
    --------
    >>> print(Where("robot.sdf", 12))
    robot.sdf:12
    """

    file: str
    line: int

    def __str__(self) -> str:
        """Return file and line as compilers write them."""
        return f"{self.file}:{self.line}"


NOWHERE = Where("", 0)
"""Line of parts that do not come from a file."""

TWO_TURNS = 4.0 * math.pi * (1.0 - 1e-3)
"""[rad] A range this large counts as no limit, as for wheels; files round it."""

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Pose:
    """Pose of a frame in another one.

    Parameters
    ----------
    place : ndarray, shape (3,)
        [m] Its origin.
    turn : ndarray, shape (3, 3)
        [-] Its axes, as columns.

    Examples
    --------
    >>> import math
    >>> ahead = Pose(place=np.array([1.0, 0.0, 0.0]))
    >>> ahead.then(from_rpy((0.0, 0.0, math.pi / 2))).at((1.0, 0.0, 0.0)).round(9).tolist()
    [1.0, 1.0, 0.0]
    """

    place: Array = field(default_factory=lambda: np.zeros(3))
    turn: Array = field(default_factory=lambda: np.eye(3))

    def then(self, inner: Pose) -> Pose:
        """Return the pose of a frame given in this one, in the parent frame."""
        return Pose(place=self.at(inner.place), turn=self.turn @ inner.turn)

    def seen_from(self, frame: Pose) -> Pose:
        """Return this pose relative to another one; both are given in the same frame."""
        return Pose(place=frame.turn.T @ (self.place - frame.place), turn=frame.turn.T @ self.turn)

    @property
    def rpy(self) -> tuple[float, float, float]:
        """[rad] Roll about x, then pitch about y, then yaw about z, about fixed axes."""
        turn = self.turn
        level = math.hypot(turn[0, 0], turn[1, 0])
        pitch = math.atan2(-turn[2, 0], level)
        if level < 1e-9:  # x points up or down: roll and yaw have the same axis
            return math.atan2(-turn[1, 2], turn[1, 1]), pitch, 0.0
        roll = math.atan2(turn[2, 1], turn[2, 2])
        return roll, pitch, math.atan2(turn[1, 0], turn[0, 0])

    @property
    def quaternion(self) -> tuple[float, float, float, float]:
        """[-] The rotation as a quaternion, real part first."""
        cr, cp, cy = (math.cos(0.5 * angle) for angle in self.rpy)
        sr, sp, sy = (math.sin(0.5 * angle) for angle in self.rpy)
        return (
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        )

    def at(self, point: Sequence[float] | Array) -> Array:
        """[m] Transform a point of this frame, shape (3,), or several, shape (n, 3)."""
        moved: Array = np.asarray(point, dtype=float) @ self.turn.T + self.place
        return moved

    def along(self, direction: Sequence[float] | Array) -> Array:
        """Transform a direction of this frame."""
        turned: Array = self.turn @ np.asarray(direction, dtype=float)
        return turned


def from_rpy(angles: Sequence[float], place: Sequence[float] = (0.0, 0.0, 0.0)) -> Pose:
    """Rotate by roll about x, then pitch about y, then yaw about z [rad], about fixed axes."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in angles)
    turn = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    return Pose(place=np.array(place, dtype=float), turn=turn)


def from_quaternion(wxyz: Sequence[float], place: Sequence[float] = (0.0, 0.0, 0.0)) -> Pose:
    """Rotate by a quaternion of any non-zero length, real part first."""
    w, x, y, z = np.asarray(wxyz, dtype=float) / math.hypot(*wxyz)
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
    return Pose(place=np.array(place, dtype=float), turn=turn)


def unit(vector: Sequence[float] | Array) -> Array | None:
    """Return the unit vector; None for a zero vector."""
    length = math.hypot(*vector)
    return None if length < 1e-9 else np.asarray(vector, dtype=float) / length


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Friction:
    """The friction of a shape as its file states it.

    Parameters
    ----------
    first, second : float
        [-] Coefficients along the first direction and across it.
    direction : ndarray, shape (3,), optional
        The first direction; None leaves it to the engine.
    priority : int
        Priority of this shape's coefficients over those of others, in MuJoCo.
    first_at, second_at : Where
        The lines of both.
    slips : tuple of (float, Where)
        [m/s per N] Slip along both directions in proportion to the force, and its lines.
    """

    first: float
    second: float
    direction: Array | None = None
    priority: int = 0
    first_at: Where = NOWHERE
    second_at: Where = NOWHERE
    slips: tuple[tuple[float, Where], ...] = ()


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Shape:
    """A collision shape.

    Parameters
    ----------
    name : str
        As in the file.
    kind : {"box", "cylinder", "capsule", "sphere", "hull"}
        A "hull" is the convex hull of `points`.
    pose : Pose
        Pose of its frame; the axis of cylinders and capsules is z.
    radius : float
        [m] Radius of a cylinder, capsule or sphere.
    length : float
        [m] Length of a cylinder, or of a capsule without its caps.
    size : ndarray, shape (3,)
        [m] Size of a box.
    points : ndarray, shape (n, 3)
        [m] Points of a hull, in the frame of the model.
    friction : Friction, optional
        Friction of its surface.
    surface_speed : float
        [m/s] Speed at which the file itself moves the surface; 0 if it does not.
    at : Where
        Its line.
    pose_at, size_at : Where
        Lines of its pose and of its radius or size, if different.
    """

    name: str
    kind: str
    pose: Pose
    radius: float = 0.0
    length: float = 0.0
    size: Array = field(default_factory=lambda: np.zeros(3))
    points: Array = field(default_factory=lambda: np.zeros((0, 3)))
    friction: Friction | None = None
    surface_speed: float = 0.0
    at: Where = NOWHERE
    pose_at: Where = NOWHERE
    size_at: Where = NOWHERE

    def __post_init__(self) -> None:
        """Take the line of the shape where none is given."""
        _default_lines(self, "pose_at", "size_at")

    @property
    def axis(self) -> Array:
        """Direction of a cylinder or capsule."""
        turned: Array = self.pose.turn[:, 2]
        return turned

    @property
    def is_round(self) -> bool:
        """Whether it has a radius."""
        return self.kind in ("cylinder", "capsule", "sphere")

    @property
    def path(self) -> str:
        """Its line and name, for errors."""
        return f"{self.at}: collision[{self.name}]"


@dataclass(frozen=True, slots=True, kw_only=True)
class Unread:
    """A collision shape that was left out.

    Parameters
    ----------
    name : str
        The file of a mesh as the model names it, or the kind of the shape.
    reason : str
        Why it was left out.
    at : Where
        Its line.
    """

    name: str
    reason: str
    at: Where = NOWHERE


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Link:
    """A rigid body.

    Parameters
    ----------
    name : str
        As in the file.
    pose : Pose
        Pose of its frame.
    mass : float
        [kg] Its mass.
    center : ndarray, shape (3,)
        [m] Its centre of mass.
    inertia : ndarray, shape (3, 3)
        [kg m^2] Inertia tensor about the centre of mass.
    shapes : tuple of Shape
        Its collision shapes.
    unread : tuple of Unread
        Collision shapes that were left out.
    at : Where
        Its line.
    pose_at, mass_at : Where
        Lines of its pose and of its mass, if different.
    """

    name: str
    pose: Pose
    mass: float
    center: Array
    inertia: Array
    shapes: tuple[Shape, ...]
    unread: tuple[Unread, ...] = ()
    at: Where = NOWHERE
    pose_at: Where = NOWHERE
    mass_at: Where = NOWHERE

    def __post_init__(self) -> None:
        """Take the line of the link where none is given."""
        _default_lines(self, "pose_at", "mass_at")

    @property
    def path(self) -> str:
        """Its line and name, for errors."""
        return f"{self.at}: link[{self.name}]"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Joint:
    """A joint between two links.

    Parameters
    ----------
    name : str
        As in the file.
    kind : str
        "fixed", "hinge", "slide", or the file's term for anything else.
    parent, child : str
        The links.
    place : ndarray, shape (3,)
        [m] Position.
    axis : ndarray, shape (3,)
        Axis about which it turns or along which it slides.
    lower, upper : float
        [rad] or [m] Limits; infinite if there are none.
    effort : float, optional
        [N m] or [N] Largest torque or force of its motor.
    velocity : float, optional
        [rad/s] or [m/s] Largest speed.
    stiffness : float
        [N m/rad] or [N/m] Stiffness of a spring.
    damping : float
        [N m s/rad] or [N s/m] Viscous friction.
    friction : float
        [N m] or [N] Dry friction.
    armature : float
        [kg m^2] or [kg] Inertia of the motor's rotor reflected through its gear, in addition to the
        link's.
    gain : float, optional
        [N m s/rad] or [N s/m] Gain of a speed servo: torque or force per error of the speed.
    at : Where
        Its line.
    range_at, effort_at, velocity_at, dynamics_at : Where
        Lines of its limits, and of damping, friction and armature, if different.
    gain_at : Where
        Line of its servo.
    """

    name: str
    kind: str
    parent: str
    child: str
    place: Array
    axis: Array
    lower: float = -math.inf
    upper: float = math.inf
    effort: float | None = None
    velocity: float | None = None
    stiffness: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    armature: float = 0.0
    gain: float | None = None
    at: Where = NOWHERE
    range_at: Where = NOWHERE
    effort_at: Where = NOWHERE
    velocity_at: Where = NOWHERE
    dynamics_at: Where = NOWHERE
    gain_at: Where = NOWHERE

    def __post_init__(self) -> None:
        """Take the line of the joint where none is given."""
        _default_lines(self, "range_at", "effort_at", "velocity_at", "dynamics_at")

    @property
    def path(self) -> str:
        """Its line and name, for errors."""
        return f"{self.at}: joint[{self.name}]"

    @property
    def is_locked(self) -> bool:
        """Whether it cannot move: fixed, or with limits that leave no range."""
        return self.kind == "fixed" or (
            self.kind in ("hinge", "slide") and self.lower >= self.upper
        )

    @property
    def is_unlimited(self) -> bool:
        """Whether it is a hinge that can turn at least twice, as wheels do."""
        return self.kind == "hinge" and self.upper - self.lower >= TWO_TURNS


def _default_lines(part: Shape | Link | Joint, *names: str) -> None:
    for name in names:
        if getattr(part, name) is NOWHERE:
            object.__setattr__(part, name, part.at)


@dataclass(frozen=True, slots=True, kw_only=True)
class Coupling:
    """A coupling of joints, which is not read.

    Parameters
    ----------
    joints : tuple of str
        The coupled joints.
    name : str
        Its kind, such as "mimic".
    value, reason : str
        Its content and how it is treated, for a warning.
    at : Where
        Its line.
    """

    joints: tuple[str, ...]
    name: str
    value: str
    reason: str
    at: Where = NOWHERE


@dataclass(frozen=True, slots=True, kw_only=True)
class Plugin:
    """A plugin of the file and its settings: path, text and line of each."""

    name: str
    filename: str
    settings: tuple[tuple[str, str, Where], ...]
    at: Where = NOWHERE

    def is_one_of(self, *kinds: str) -> bool:
        """Whether its name or its file's contains one of these, without capitals and hyphens."""
        names = f"{self.name} {self.filename}".lower().replace("-", "")
        return any(kind in names for kind in kinds)

    def values(self, *paths: str) -> list[tuple[str, Where]]:
        """Return text and line of every setting at one of these paths."""
        return [(text, where) for path, text, where in self.settings if path in paths]

    def numbers(self, *paths: str) -> list[tuple[float, Where]]:
        """Return value and line of those of them that are numbers."""
        found = []
        for text, where in self.values(*paths):
            with contextlib.suppress(ValueError):
                found.append((float(text), where))
        return found


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Tree:
    """A robot as described by its file.

    Parameters
    ----------
    name : str
        Name of the model.
    format : str
        "SDF 1.6", "URDF", "MJCF".
    file : str
        Name of the file.
    links : tuple of Link
        The root first, parents before their children.
    joints : mapping of str to Joint
        Joints by their child link.
    plugins : tuple of Plugin
        Plugins in the order of the file.
    driven : mapping of str to Where
        Joints with a motor, and the line that declares it.
    held : mapping of str to Where
        Those of which the motor controls the position alone, and the line that says so.
    commanded : mapping of str to (float, Where)
        [rad/s] Largest speed that may be commanded of a joint, and its line.
    tracks : tuple of str
        Links whose surface is moved from outside the file.
    couplings : tuple of Coupling
        Couplings of joints.
    floors : tuple of (float, Where)
        [-] Coefficients of the ground in its file, and their lines.
    at : Where
        Line of the model element.
    """

    name: str
    format: str
    file: str
    links: tuple[Link, ...]
    joints: Mapping[str, Joint]
    plugins: tuple[Plugin, ...] = ()
    driven: Mapping[str, Where] = field(default_factory=dict)
    held: Mapping[str, Where] = field(default_factory=dict)
    commanded: Mapping[str, tuple[float, Where]] = field(default_factory=dict)
    tracks: tuple[str, ...] = ()
    couplings: tuple[Coupling, ...] = ()
    floors: tuple[tuple[float, Where], ...] = ()
    at: Where = NOWHERE

    @property
    def by_name(self) -> dict[str, Link]:
        """Links by name."""
        return {link.name: link for link in self.links}
