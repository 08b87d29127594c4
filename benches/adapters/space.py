"""Engines in three dimensions, and Chipmunk in side view: worlds, and runs with common rules."""

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any, Protocol

import numpy as np

from benches.adapters.ground import Box, blocks_of, goal_of
from benches.adapters.robots import RobotModel, model_of_robot
from crawler2d import Scenario
from crawler2d.model_tree import Array, Pose, from_rpy
from crawler2d.parameters.terrain import Lanes

_LOOK = 0.01  # [s] between two checks of a run
_CLEAR_ANGLE, _CLEAR_TIME = math.radians(5.0), 0.5  # as in crawler2d, criteria
_NO_ADVANCE, _STOP_TIME = 0.005, 3.0  # [m], [s]
_TIPPED, _TURNED = math.radians(90.0), math.radians(45.0)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Scene:
    """The input for building a world.

    Parameters
    ----------
    robot : RobotModel
        The robot.
    ground : sequence of Box
        The ground.
    friction : float
        [-] Between robot and ground.
    x, z, angle : float
        [m], [rad] Of the chassis frame at time 0, nose up > 0.
    phase : float
        [m] By which the surface of every wheel has advanced at time 0.
    """

    robot: RobotModel
    ground: Sequence[Box]
    friction: float
    x: float
    z: float
    angle: float
    phase: float

    def root(self) -> Array:
        """[m] Return the position of the model's frame."""
        turn = from_rpy((0.0, -self.angle, 0.0)).turn
        place: Array = np.array([self.x, 0.0, self.z]) - turn @ self.robot.origin
        return place


@dataclass(frozen=True, slots=True, kw_only=True)
class Touch:
    """A contact with the ground.

    Parameters
    ----------
    link : str
        Of the robot.
    point, normal : tuple of float, shape (3,)
        [m] Where, and the direction in which the ground pushes.
    force : float
        [N] Along the normal; NaN if the engine does not report it.
    """

    link: str
    point: tuple[float, float, float]
    normal: tuple[float, float, float]
    force: float

    def rounded(self) -> dict[str, Any]:
        """Return it as plain data, with few digits."""
        return {
            "link": self.link,
            "point": [round(each, 4) for each in self.point],
            "normal": [round(each, 3) for each in self.normal],
            "force": round(self.force, 1),
        }


class World(ABC):
    """A robot on its ground; without touches and flippers unless an engine has them."""

    @abstractmethod
    def advance(self, speeds: Sequence[float]) -> None:
        """Take a step for each set-point of the speed of all surfaces [m/s]."""

    @abstractmethod
    def pose(self) -> Pose:
        """Return the pose of the chassis frame."""

    def touches(self) -> list[Touch]:
        """Return the contacts with the ground."""
        return []

    def bend(self) -> float:
        """[rad] Return the largest deviation of a flipper from its angle."""
        return 0.0

    def close(self) -> None:  # noqa: B027 - most engines have nothing to free
        """Free the resources of the world."""


class Engine(Protocol):
    """An engine at one setting.

    Parameters
    ----------
    version : str
        Of the engine, with its name.
    time_step : float
        [s] Of a step.
    in_space : bool
        Whether it has three dimensions; else the ground must be the same across.
    """

    version: str
    time_step: float
    in_space: bool

    def world(self, scene: Scene) -> World:
        """Build a world."""


_CLASSES = {
    "Chipmunk": "chipmunk:Chipmunk",
    "ODE": "ode_process:Ode",
    "Bullet": "bullet:Bullet",
    "DART": "dart:Dart",
}


def load(name: str, **setting: Any) -> Engine:
    """Import an engine and return it at a setting, keywords of its class.

    Raises
    ------
    ImportError
        If it is not installed.
    """
    module, kind = _CLASSES[name].split(":")
    engine: Engine = getattr(import_module(f"benches.adapters.{module}"), kind)(**setting)
    return engine


_ORIGIN = Pose()


def check(
    robot: RobotModel, mass: float, axles: Mapping[str, Sequence[float]], frame: Pose = _ORIGIN
) -> None:
    """Compare the robot that an engine has loaded with the model.

    Parameters
    ----------
    robot : RobotModel
        The model.
    mass : float
        [kg] Of the robot in the engine.
    axles : mapping of str to sequence of float
        [m] Axles in the engine, flippers held.
    frame : Pose
        The chassis frame there.

    Raises
    ------
    ValueError
        If they differ by more than single precision does: the engine reads the file differently.
    """
    if abs(mass - robot.mass) > 1e-5 * robot.mass:
        raise ValueError(f"{robot.file}: {mass:g} kg were loaded, the robot has {robot.mass:g}")
    for wheel in robot.wheels:
        # The position of a wheel's frame along its axle is arbitrary.
        x, _, z = (np.asarray(axles[wheel.link]) - frame.place).dot(frame.turn)
        off = max(abs(wheel.axle[0] - x), abs(wheel.axle[2] - z))
        if off > 1e-5:
            raise ValueError(f"{robot.file}: {wheel.link} is {1e3 * off:.2f} mm off")


@dataclass(slots=True)
class Verdict:
    """Monitor a run, and decide when and how it ends.

    *cleared*: the rear end axle is its radius past the goal, as in crawler2d, and the chassis level
    within 5 degrees, both for 0.5 s. *stopped*: for 3 s it has advanced by less than 5 mm beyond
    its farthest place. *tipped over*: pitch or roll beyond 90 degrees; *turned*: yaw beyond 45
    degrees, so that the run is no longer one in side view. *timed out*: none of these.

    Parameters
    ----------
    goal : float
        [m] Where the rear end axle must get.
    duration : float
        [s] Longest time.

    Examples
    --------
    >>> verdict = Verdict(goal=1.0, duration=10.0)
    >>> [verdict.end(0.5 * step, rear=0.3 * step, angles=(0.0, 0.0, 0.0)) for step in range(6)]
    ['', '', '', '', '', 'cleared']
    """

    goal: float
    duration: float
    farthest: float = field(default=-math.inf, init=False)
    reached_at: float = field(default=0.0, init=False)
    clear_since: float = field(default=math.inf, init=False)

    def end(self, time: float, rear: float, angles: tuple[float, float, float]) -> str:
        """Return how the run ends now, or "" if it continues.

        Parameters
        ----------
        time : float
            [s] Now.
        rear : float
            [m] Where the rear end axle is.
        angles : tuple of float
            [rad] Roll, pitch and yaw.
        """
        if not math.isfinite(rear):
            return "not a number"
        roll, pitch, yaw = angles
        if rear > self.farthest + _NO_ADVANCE:
            self.farthest, self.reached_at = rear, time
        is_clear = rear > self.goal and abs(pitch) <= _CLEAR_ANGLE
        self.clear_since = min(self.clear_since, time) if is_clear else math.inf
        if time - self.clear_since >= _CLEAR_TIME:
            return "cleared"
        if abs(pitch) > _TIPPED or abs(roll) > _TIPPED:
            return "tipped over"
        if abs(yaw) > _TURNED:
            return "turned"
        if time - self.reached_at >= _STOP_TIME:
            return "stopped"
        return "timed out" if time >= self.duration else ""


def scene_of(scenario: Scenario, robot: RobotModel | None = None) -> Scene:
    """Return the input for an engine: the robot level, with its lowest wheel on the ground.

    Parameters
    ----------
    scenario : Scenario
        Ground and start.
    robot : RobotModel, optional
        The robot of a file in place of the scenario's own.
    """
    robot, ground = robot or model_of_robot(scenario.robot), scenario.terrain
    phase = scenario.start.track_phase
    return Scene(
        robot=robot,
        ground=blocks_of(scenario),
        friction=(ground.left if isinstance(ground, Lanes) else ground).friction,
        x=-scenario.start.approach - robot.foremost,
        z=-robot.lowest(phase),
        angle=0.0,
        phase=phase,
    )


def drive(
    engine: Engine, scenario: Scenario, scene: Scene | None = None, digits: int = 5
) -> dict[str, Any]:
    """Run a scenario in an engine; the speed rises as in crawler2d, at `max_acceleration`.

    Parameters
    ----------
    engine : Engine
        The engine.
    scenario : Scenario
        Robot, ground, command and longest time.
    scene : Scene, optional
        What is built, at rest, in place of what the scenario says.
    digits : int
        Of lengths and angles in the result.

    Returns
    -------
    dict
        How the run ends, when [s], the last pose of the chassis frame [m, rad], its heading in
        space among it, the largest yaw, roll and bend of a flipper [rad], the contacts of a stop,
        and the wall time of a simulated second [s].
    """
    outline, rise = scenario.robot.outline, scenario.robot.drivetrain.max_acceleration
    verdict = Verdict(goal=goal_of(scenario) + outline.rear_radius, duration=scenario.duration)
    rear = (outline.ends[0][0], 0.0, outline.ends[0][1])
    step, top = engine.time_step, scenario.drive.speed
    looks = max(1, round(_LOOK / step))
    begin = time.perf_counter()
    world = engine.world(scene or scene_of(scenario))
    count, end, yaw, roll, bend = 0, "", 0.0, 0.0, 0.0
    while not end:
        steps = range(count + 1, count + looks + 1)
        world.advance([min(top, rise * step * number) for number in steps])
        count += looks
        pose = world.pose()
        angles = pose.rpy
        roll, yaw = max(roll, abs(angles[0])), max(yaw, abs(angles[2]))
        bend = max(bend, world.bend())
        end = verdict.end(step * count, float(pose.at(rear)[0]), angles)
    touches = [touch.rounded() for touch in world.touches()] if end == "stopped" else []
    world.close()
    return {
        "end": end,
        "time": round(step * count, 3),
        "x": round(float(pose.place[0]), digits),
        "y": round(float(pose.place[2]), digits),
        "angle": round(-angles[1], digits),
        "heading": round(angles[2], digits),
        "yaw": round(yaw, 4),
        "roll": round(roll, 4),
        "bend": round(bend, 5),
        "touches": touches,
        "cost": round((time.perf_counter() - begin) / (step * count), 4),
    }
