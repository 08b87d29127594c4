"""The neutral tree: links, joints and collision shapes of a robot, whatever format has them.

Readers make one of a file, writers make a file of one. Everything is in the frame of the model,
whose z axis points up, with all joints at zero; metres, kilograms, radians. What is None was not
given.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from crawler2d.models.poses import Array, Pose
from crawler2d.models.where import MADE, Where

__all__ = ["Friction", "Joint", "Link", "Plugin", "Shape", "Tree", "Unread"]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Friction:
    """What a file says about the friction of a shape.

    Parameters
    ----------
    first, second : float
        [-] Coefficients along the first and across it.
    direction : ndarray, shape (3,), optional
        Of the first; None where it is left to the engine.
    priority : int
        Of this shape's coefficients over those of others, in MuJoCo.
    first_at, second_at : Where
        Their lines.
    """

    first: float
    second: float
    direction: Array | None = None
    priority: int = 0
    first_at: Where = MADE
    second_at: Where = MADE


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Shape:
    """A collision shape.

    Parameters
    ----------
    name : str
        As in the file.
    kind : {"box", "cylinder", "capsule", "sphere", "hull"}
        A "hull" is that of `points`.
    pose : Pose
        Of its frame; the axis of cylinders and capsules is z.
    radius : float
        [m] Of cylinder, capsule and sphere.
    length : float
        [m] Of a cylinder, or of a capsule without its caps.
    size : ndarray, shape (3,)
        [m] Of a box.
    points : ndarray, shape (n, 3)
        [m] Of a hull, in the frame of the model.
    friction : Friction, optional
        Of its surface.
    surface_speed : float
        [m/s] At which the file itself moves its surface; 0: it does not.
    at : Where
        Its own line.
    pose_at, size_at : Where
        The lines of its pose and of its radius or size.
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
    at: Where = MADE
    pose_at: Where = MADE
    size_at: Where = MADE

    @property
    def axis(self) -> Array:
        """Direction of a cylinder or capsule."""
        turned: Array = self.pose.turn[:, 2]
        return turned


@dataclass(frozen=True, slots=True, kw_only=True)
class Unread:
    """A collision shape that was left out: that it is there is all that is known of it.

    Parameters
    ----------
    name : str
        The file of a mesh as it is named, or the kind of the shape.
    reason : str
        Why it was left out.
    at : Where
        Its line.
    """

    name: str
    reason: str
    at: Where = MADE


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Link:
    """A rigid body.

    Parameters
    ----------
    name : str
        As in the file.
    pose : Pose
        Of its frame.
    mass : float
        [kg] Its mass.
    center : ndarray, shape (3,)
        [m] Its centre of mass.
    inertia : ndarray, shape (3, 3)
        [kg m^2] About that.
    shapes : tuple of Shape
        What collides.
    unread : tuple of Unread
        What collides besides, but was left out.
    at, pose_at, mass_at : Where
        The lines of the link, of its place and of its mass.
    """

    name: str
    pose: Pose
    mass: float
    center: Array
    inertia: Array
    shapes: tuple[Shape, ...]
    unread: tuple[Unread, ...] = ()
    at: Where = MADE
    pose_at: Where = MADE
    mass_at: Where = MADE


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Joint:
    """What joins a link to another.

    Parameters
    ----------
    name : str
        As in the file.
    kind : str
        "fixed", "hinge", "slide", or the file's own word for anything else.
    parent, child : str
        The links.
    place : ndarray, shape (3,)
        [m] Where it is.
    axis : ndarray, shape (3,)
        Direction about which it turns or along which it slides.
    lower, upper : float
        [rad] or [m] Limits; infinite where there are none.
    effort : float, optional
        [N m] or [N] Largest torque or force of its motor.
    velocity : float, optional
        [rad/s] or [m/s] Largest speed.
    stiffness : float
        [N m/rad] or [N/m] Of a spring.
    damping : float
        [N m s/rad] or [N s/m] Of viscous friction.
    friction : float
        [N m] or [N] Of dry friction.
    armature : float
        [kg m^2] or [kg] Of the motor's rotor behind its gear, on top of the link's inertia.
    gain : float, optional
        [N m s/rad] or [N s/m] Of a servo of its speed: torque or force for an error of that.
    at, effort_at, velocity_at, dynamics_at, gain_at : Where
        Its line, and those of its limits, of damping, friction and armature, and of its servo.
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
    at: Where = MADE
    effort_at: Where = MADE
    velocity_at: Where = MADE
    dynamics_at: Where = MADE
    gain_at: Where = MADE

    @property
    def is_locked(self) -> bool:
        """Whether it cannot move: fixed, or with limits that leave no range."""
        return self.kind == "fixed" or (
            self.kind in ("hinge", "slide") and self.lower >= self.upper
        )

    @property
    def is_unlimited(self) -> bool:
        """Whether it can turn at least twice: what is driven on is not limited to less."""
        return self.kind == "hinge" and self.upper - self.lower >= 4.0 * math.pi * (1.0 - 1e-3)


@dataclass(frozen=True, slots=True, kw_only=True)
class Plugin:
    """A plugin that the file asks for, with its settings: path, text and line of each leaf."""

    name: str
    filename: str
    settings: tuple[tuple[str, str, Where], ...]
    at: Where = MADE

    def values(self, *paths: str) -> list[tuple[str, Where]]:
        """Return text and line of every setting at one of these paths."""
        return [(text, where) for path, text, where in self.settings if path in paths]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Tree:
    """A robot as its file has it.

    Parameters
    ----------
    name : str
        Of the model.
    format : str
        "SDF 1.6", "URDF", "MJCF".
    file : str
        Name of the file.
    links : tuple of Link
        The root first, parents before their children.
    joints : mapping of str to Joint
        By the link that is the child.
    plugins : tuple of Plugin
        In their order.
    driven : mapping of str to Where
        The joints that the file gives a motor, and where.
    tracks : tuple of str
        Links whose surface something outside the file moves.
    at : Where
        Line of the model.
    """

    name: str
    format: str
    file: str
    links: tuple[Link, ...]
    joints: Mapping[str, Joint]
    plugins: tuple[Plugin, ...] = ()
    driven: Mapping[str, Where] = field(default_factory=dict)
    tracks: tuple[str, ...] = ()
    at: Where = MADE

    @property
    def by_name(self) -> dict[str, Link]:
        """Its links by name."""
        return {link.name: link for link in self.links}
