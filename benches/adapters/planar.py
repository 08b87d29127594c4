"""Scenes in the plane that depend on no engine, the interface of engines, and their motion."""

from __future__ import annotations

import json
import sys
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from benches.shared.measuring import seconds

Array = NDArray[np.float64]

_FOLDER = Path(__file__).parents[1] / "peers" / "scenes"
SCENES = tuple(
    f"{robot}-{wheel}-{terrain}"
    for terrain in ("step", "field")
    for robot in ("lwa5", "cwa24")
    for wheel in ("round", "gear")
)
"""Names of the scenes in the folder."""

_DURATIONS = {"step": 10.0, "field": 15.0}  # [s] 1.1 m or 5.0 m at 0.4 m/s, and some more
_HIGHEST = 0.6  # [m] above all ground, more than a robot standing on its end
_RASTER = 0.02  # [s] interval at which paths are compared


class Motion(NamedTuple):
    """The recorded motion of all bodies.

    Attributes
    ----------
    time : ndarray, shape (n,)
        [s] Time of each sample.
    poses : ndarray, shape (n, bodies, 3)
        [m], [m], [rad] Position and angle of each body.
    penetration : float
        [m] Deepest overlap with the ground that the engine itself reports, also between samples; 0
        if it reports none.
    """

    time: Array
    poses: Array
    penetration: float = 0.0

    @classmethod
    def of(cls, time: Any, poses: Any, penetration: float = 0.0) -> Motion:
        """Gather samples."""
        return cls(np.asarray(time, float), np.asarray(poses, float), penetration)

    def path(self) -> Array:
        """[m] Chassis x, y at equal time intervals, shape (m, 2)."""
        raster = np.arange(0.0, self.time[-1], _RASTER)
        chassis = self.poses[:, 0]
        return np.stack([np.interp(raster, self.time, chassis[:, i]) for i in (0, 1)], axis=1)

    def distance(self, other: Motion) -> float:
        """[m] Largest distance between the two paths at equal times."""
        a, b = self.path(), other.path()
        shared = min(len(a), len(b))
        return float(np.linalg.norm(a[:shared] - b[:shared], axis=1).max())


def to_world(poses: Array, point: Iterable[float]) -> Array:
    """[m] A point of a body in the world, given the poses of the body; shape (n, 2)."""
    cosine, sine = np.cos(poses[:, 2]), np.sin(poses[:, 2])
    x, y = point
    offset = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)
    return np.asarray(poses[:, :2] + offset)


class Draw(NamedTuple):
    """The values that vary from run to run; the same draws for every engine."""

    approach: float = 0.0  # [m] further away from the obstacle
    speed: float = 1.0  # [-] of the wheels
    friction: float = 1.0  # [-] of the ground


NOMINAL = Draw()


def draws(count: int, seed: int = 0) -> list[Draw]:
    """Draw approaches over 50 mm, speeds and frictions within 2 %; the first draw is nominal."""
    random = np.random.default_rng(seed)
    low, high = (-0.025, 0.98, 0.98), (0.025, 1.02, 1.02)
    return [NOMINAL, *(Draw(*map(float, row)) for row in random.uniform(low, high, (count - 1, 3)))]


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
    x, y, angle : float
        [m], [m], [rad] Pose at the start.
    mass, inertia : float
        [kg], [kg m^2] About the centre of mass.
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
        """Whether the chassis stayed at plausible positions; False if not finite."""
        profile = self.profile()
        x, y = motion.poses[:, 0, 0], motion.poses[:, 0, 1]
        is_over_ground = (x > profile[0, 0]) & (x < profile[-1, 0])
        return bool((is_over_ground & (y < profile[:, 1].max() + _HIGHEST)).all())

    def cleared(self, motion: Motion) -> bool:
        """Whether the rear axle passed the last edge; the same rule for every engine."""
        is_beyond = motion.poses[:, 0, 0].max() > self.finish()
        return self.keeps_course(motion) and bool(is_beyond)


def load_scene(name: str) -> Scene:
    """Read a scene; ``lwa3`` is ``lwa5`` without its second and fourth wheel."""
    file = _FOLDER / f"{name.replace('lwa3', 'lwa5')}.json"
    data = json.loads(file.read_text(encoding="utf-8"))
    (friction,) = {box["mu"] for box in data["ground"]}
    scene = Scene(
        name=f"{data['name']}-{data['terrain']}",
        bodies=tuple(_body(body) for body in data["bodies"]),
        joints=tuple(_joint(joint) for joint in data["joints"]),
        boxes=tuple(np.array(box["pts"], float) for box in data["ground"]),
        friction=friction,
    )
    if not name.startswith("lwa3"):
        return scene
    joints = tuple(replace(joint, b=wheel + 1) for wheel, joint in enumerate(scene.joints[::2]))
    bodies = (scene.bodies[0], *scene.bodies[1::2])
    return replace(scene, name=name, bodies=bodies, joints=joints)


def _body(data: dict[str, Any]) -> Body:
    shapes = data["shapes"]
    return Body(
        **{name: data[name] for name in ("x", "y", "mass", "inertia")},
        angle=data["a"],
        radius=max((shape["r"] for shape in shapes if shape["kind"] == "circle"), default=0.0),
        polygons=tuple(np.array(s["pts"], float) for s in shapes if s["kind"] == "poly"),
    )


def _joint(data: dict[str, Any]) -> Joint:
    (pax, pay), (pbx, pby) = data["pa"], data["pb"]
    motor = data["motor"]
    return Joint(data["a"], data["b"], (pax, pay), (pbx, pby), motor["speed"], motor["torque"])


@dataclass(frozen=True)
class Setting:
    """Time step and iterations of an engine.

    Attributes
    ----------
    time_step : float
        [s] Time of a step; 0 in crawler2d, which chooses it.
    substeps : int
        Substeps per step, in engines that have them.
    iterations : int
        Sweeps or solver iterations, in engines that have them; 0 is the engine's default.
    tuned : bool
        Whether lengths and stiffness suit parts of a few millimetres, or are defaults.
    ground : {"boxes", "profile"}
        What the ground is made of, in engines that offer both.
    accuracy : float
        [m] By which crawler2d chooses its steps; 0 in engines with steps of a given length.
    """

    time_step: float = 0.0
    substeps: int = 1
    iterations: int = 0
    tuned: bool = True
    ground: Literal["boxes", "profile"] = "boxes"
    accuracy: float = 0.0

    def __str__(self) -> str:
        """Describe it for a table."""
        step, accuracy = f"{self.time_step * 1e3:.4g} ms", f"accuracy {self.accuracy * 1e6:.4g} um"
        parts = [accuracy if self.accuracy else step]
        if self.substeps > 1:
            parts.append(f"{self.substeps} substeps")
        if self.iterations > 1:
            parts.append(f"{self.iterations} iterations")
        if self.ground == "profile":
            parts.append("profile")
        return ", ".join(parts) if self.tuned else f"{', '.join(parts)}, defaults"

    def steps(self, duration: float) -> int:
        """Count the steps of a duration [s]."""
        return round(duration / self.time_step)

    def stride(self, interval: float) -> int:
        """Count the steps between samples that are at most an interval [s] apart, at least one."""
        return max(int(interval / self.time_step * (1.0 + 1e-9)), 1)


class Engine(Protocol):
    """One engine; only its own module needs the engine installed."""

    name: str
    """Name in tables."""
    version: str
    """Installed version."""
    defaults: Setting
    """Settings from the engine's documentation or examples."""
    grid: Sequence[Setting]
    """Settings that the search for equal accuracy tries."""
    finest: Setting
    """The engine's finest setting, its own limit."""
    next_finest: Setting
    """Next finest setting, which shows whether the limit has converged."""

    def wall_time(self, scene: Scene, setting: Setting, duration: float) -> float:
        """[s] Time a run in the engine's fastest way from Python, without recording."""

    def record(self, scene: Scene, setting: Setting, duration: float, interval: float) -> Motion:
        """Run and sample all poses every `interval` [s], at most every step."""


Started = tuple[Callable[[int], object], Callable[[], Any]]
"""A world: a function that takes a number of steps, and one that reads all poses."""


class SteppedEngine(ABC):
    """An engine with a given time step."""

    @abstractmethod
    def start(self, scene: Scene, setting: Setting) -> Started:
        """Build a world; return functions that take a number of steps, and that read all poses."""

    def wall_time(self, scene: Scene, setting: Setting, duration: float) -> float:
        """[s] Time a run."""
        advance, _ = self.start(scene, setting)
        steps = setting.steps(duration)
        return seconds(lambda: advance(steps))

    def record(self, scene: Scene, setting: Setting, duration: float, interval: float) -> Motion:
        """Run and sample all poses."""
        advance, poses = self.start(scene, setting)
        stride = setting.stride(interval)
        times, samples = [], []
        for sample in range(setting.steps(duration) // stride + 1):
            if sample > 0:
                advance(stride)
            times.append(sample * stride * setting.time_step)
            samples.append(poses())
        return Motion.of(times, samples)


_CLASSES = {
    "pymunk": "chipmunk:Pymunk",
    "Box2D v3": "box2d:Box2D",
    "MuJoCo": "mujoco:MuJoCo",
    "rapier2d": "rapier:Rapier",
    "crawler2d": "own:Crawler2D",
}
ENGINES = tuple(_CLASSES)
"""Names of the engines, in the order of the tables."""


@cache
def load_engine(name: str) -> Engine:
    """Import an engine, once per process."""
    module, kind = _CLASSES[name].split(":")
    try:
        engine: Engine = getattr(import_module(f"benches.adapters.{module}"), kind)()
    except ModuleNotFoundError as error:
        sys.exit(f"{name} needs {error.name}: pip install --group peers")
    return engine


def load_engines() -> list[Engine]:
    """Import all engines."""
    return [load_engine(name) for name in ENGINES]


def at(engine: Engine, time_step: float, *, tuned: bool = False) -> Setting:
    """Return an engine's defaults with another time step [s]; crawler2d keeps its accuracy."""
    if engine.defaults.accuracy:
        return engine.defaults
    return replace(engine.defaults, time_step=time_step, tuned=tuned)
