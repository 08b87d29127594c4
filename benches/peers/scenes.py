"""The scenes, what varies in them, and when a robot has cleared them."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from benches.peers.motion import Array, Motion

FOLDER = Path(__file__).parent / "scenes"
NAMES = tuple(
    f"{robot}-{wheel}-{terrain}"
    for terrain in ("step", "field")
    for robot in ("lwa5", "cwa24")
    for wheel in ("round", "gear")
)
"""Names of the scenes in the folder."""

# [s] Simulated time: 1.1 m or 5.0 m at 0.4 m/s, and some more.
_DURATIONS = {"step": 10.0, "field": 15.0}

# [m] Above all ground, more than the robot standing on its end.
_HIGHEST = 0.6


class Draw(NamedTuple):
    """The values that vary from run to run; the same draws for every engine."""

    approach: float = 0.0  # [m] further away from the obstacle
    speed: float = 1.0  # [-] of the wheels
    friction: float = 1.0  # [-] of the ground


NOMINAL = Draw()


@dataclass(frozen=True)
class Joint:
    """A pin with a motor.

    Attributes
    ----------
    a, b : int
        Bodies: the chassis and a wheel.
    pa, pb : tuple of float
        [m] The pin in the frame of each body.
    speed : float
        [rad/s] Of b relative to a.
    torque : float
        [N m] Torque limit.
    """

    a: int
    b: int
    pa: tuple[float, float]
    pb: tuple[float, float]
    speed: float
    torque: float


@dataclass(frozen=True)
class Body:
    """A rigid body; its origin is the centre of mass.

    Attributes
    ----------
    x, y : float
        [m] Position at the start.
    angle : float
        [rad] Angle at the start.
    mass : float
        [kg]
    inertia : float
        [kg m^2] About the centre of mass.
    radius : float
        [m] Radius of its circle, 0 if there is none.
    polygons : tuple of ndarray, shape (n, 2)
        [m] Convex, counter-clockwise.
    """

    x: float
    y: float
    angle: float
    mass: float
    inertia: float
    radius: float
    polygons: tuple[Array, ...]


@dataclass(frozen=True)
class Scene:
    """A robot in front of an obstacle.

    Attributes
    ----------
    name : str
        Robot, wheel and terrain.
    bodies : tuple of Body
        The chassis first.
    joints : tuple of Joint
        One per wheel.
    boxes : tuple of ndarray, shape (4, 2)
        [m] The ground.
    friction : float
        [-] Friction of every pair of bodies.
    draw : Draw
        The values that were varied.
    """

    name: str
    bodies: tuple[Body, ...]
    joints: tuple[Joint, ...]
    boxes: tuple[Array, ...]
    friction: float
    draw: Draw = NOMINAL

    @property
    def duration(self) -> float:
        """[s] Simulated time."""
        return _DURATIONS[self.name.rsplit("-", 1)[1]]

    def vary(self, draw: Draw) -> Scene:
        """Make a variant of the scene in the file."""
        return replace(
            self,
            bodies=tuple(replace(body, x=body.x - draw.approach) for body in self.bodies),
            joints=tuple(replace(joint, speed=joint.speed * draw.speed) for joint in self.joints),
            friction=self.friction * draw.friction,
            draw=draw,
        )

    def profile(self) -> Array:
        """[m] Upper outline of all boxes, from left to right, shape (n, 2)."""
        tops = sorted((box[:, 0].min(), box[:, 0].max(), box[:, 1].max()) for box in self.boxes)
        points: list[tuple[float, float]] = []
        for left, right, top in tops:
            if points and points[-1][1] == top:
                points.pop()
            else:
                points.append((left, top))
            points.append((right, top))
        return np.array(points)

    def finish(self) -> float:
        """[m] The chassis x at which the rear axle has passed the last edge."""
        rear = min(joint.pa[0] for joint in self.joints)
        return float(self.profile()[-2, 0]) - rear

    def keeps_course(self, motion: Motion) -> bool:
        """Whether the chassis stayed where a driving robot can be; False if not finite."""
        profile = self.profile()
        x, y = motion.poses[:, 0, 0], motion.poses[:, 0, 1]
        is_over_ground = (x > profile[0, 0]) & (x < profile[-1, 0])
        return bool((is_over_ground & (y < profile[:, 1].max() + _HIGHEST)).all())

    def cleared(self, motion: Motion) -> bool:
        """Whether the rear axle passed the last edge; the same rule for every engine."""
        is_beyond = motion.poses[:, 0, 0].max() > self.finish()
        return self.keeps_course(motion) and bool(is_beyond)


def load(name: str) -> Scene:
    """Read a scene; ``lwa3`` is ``lwa5`` without its second and fourth wheel."""
    scene = read(FOLDER / f"{name.replace('lwa3', 'lwa5')}.json")
    if not name.startswith("lwa3"):
        return scene
    joints = tuple(replace(joint, b=wheel + 1) for wheel, joint in enumerate(scene.joints[::2]))
    bodies = (scene.bodies[0], *scene.bodies[1::2])
    return replace(scene, name=name, bodies=bodies, joints=joints)


def read(path: Path) -> Scene:
    """Read a scene's file."""
    data = json.loads(path.read_text(encoding="utf-8"))
    (friction,) = {box["mu"] for box in data["ground"]}
    return Scene(
        name=f"{data['name']}-{data['terrain']}",
        bodies=tuple(_body(body) for body in data["bodies"]),
        joints=tuple(_joint(joint) for joint in data["joints"]),
        boxes=tuple(np.array(box["pts"], float) for box in data["ground"]),
        friction=friction,
    )


def draws(count: int, seed: int = 0) -> list[Draw]:
    """Draw approaches over 50 mm, speeds and frictions within 2 %; the first draw is nominal."""
    random = np.random.default_rng(seed)
    low, high = (-0.025, 0.98, 0.98), (0.025, 1.02, 1.02)
    rest = random.uniform(low, high, (count - 1, 3))
    return [NOMINAL, *(Draw(*map(float, row)) for row in rest)]


def _body(data: dict[str, Any]) -> Body:
    shapes = data["shapes"]
    return Body(
        x=data["x"],
        y=data["y"],
        angle=data["a"],
        mass=data["mass"],
        inertia=data["inertia"],
        radius=max((shape["r"] for shape in shapes if shape["kind"] == "circle"), default=0.0),
        polygons=tuple(np.array(s["pts"], float) for s in shapes if s["kind"] == "poly"),
    )


def _joint(data: dict[str, Any]) -> Joint:
    (pax, pay), (pbx, pby) = data["pa"], data["pb"]
    motor = data["motor"]
    return Joint(data["a"], data["b"], (pax, pay), (pbx, pby), motor["speed"], motor["torque"])
