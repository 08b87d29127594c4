"""What is driven over what: robots of public files, flippers held, friction known."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from crawler2d.audits.obstacles import standard_obstacles
from crawler2d.audits.runs import scenario_of
from crawler2d.errors import ScenarioWarning
from crawler2d.parameters.gaits import Hold
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive, Start
from crawler2d.parameters.terrain import Terrain
from crawler2d.reading.reading import Reading, read_robot

__all__ = ["CASES", "ROBOTS", "STARTS", "Case"]

ROBOTS = Path(__file__).parents[2] / "tests" / "robots"
STARTS = 20

_AMPLE = 20.0
"""[-] Times the torque that was read: no file limits its wheels below what makes them slip."""

_FIRM = 1e4  # [N m] holds a flipper
_SEED = 23
_DURATION = 12.0  # [s] twice the time that the longest way takes


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A public file and what its robot drives over.

    Parameters
    ----------
    file : str
        In `ROBOTS`.
    angle : float
        [rad] At which the flippers are held, relative to the chassis, upwards > 0.
    frictions : mapping of str to float
        [-] Between robot and ground, by the name of a standard obstacle of an audit.
    how : mapping
        Keywords for `read_robot`.
    """

    file: str
    angle: float
    frictions: Mapping[str, float]
    how: Mapping[str, Any] = field(default_factory=dict)

    def reading(self) -> Reading:
        """Read the public file; what is doubted in it is in its audit."""
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ScenarioWarning)
            return read_robot(ROBOTS / self.file, **self.how)

    def robot(self) -> Robot:
        """Return the robot with motors that hold their speeds, and its flippers held."""
        return self.held(self.reading().robot)

    def held(self, robot: Robot) -> Robot:
        """Hold the flippers of a robot, and let its motors hold their speeds."""
        torque = _AMPLE * robot.drivetrain.max_torque
        drivetrain = replace(robot.drivetrain, max_torque=torque, torque_sharing="track")
        flippers = robot.flippers
        if flippers is not None:
            flippers = replace(flippers, angle=self.angle, torque_limit=_FIRM)
        return replace(robot, drivetrain=drivetrain, flippers=flippers)

    def obstacles(self, robot: Robot) -> dict[str, Terrain]:
        """Return the obstacles by name."""
        return {
            name: standard_obstacles(robot, friction)[name]
            for name, friction in self.frictions.items()
        }

    def drive(self, robot: Robot, ground: Terrain) -> Drive:
        """Return the command: the speed of an audit, flippers held."""
        speed = scenario_of(robot, ground, None, None).drive.speed
        return Drive(speed=speed, gait=Hold(self.angle))

    def scenarios(self, robot: Robot, ground: Terrain) -> list[Scenario]:
        """Return one scenario for each start; all robots of a case have the same starts."""
        length = robot.outline.axle_distance
        drive = self.drive(robot, ground)
        generator = np.random.default_rng(_SEED)
        approach = length * (0.2 + generator.uniform(-0.125, 0.125, STARTS))
        turn = 2.0 * np.pi * robot.outline.front_radius
        phase = generator.uniform(0.0, turn, STARTS)
        return [
            Scenario(
                robot,
                ground,
                drive=drive,
                start=Start(approach=float(far), track_phase=float(along)),
                duration=_DURATION,
            )
            for far, along in zip(approach, phase, strict=True)
        ]


CASES: dict[str, Case] = {
    "absolem": Case(
        file="absolem.sdf",
        angle=0.7,
        frictions={
            "step 44 mm": 0.43,
            "step 71 mm": 0.43,
            "knife edge 71 mm": 0.43,
            "barrier 71 mm": 0.43,
            "stairs of 71 mm": 0.5,
        },
    ),
    "engineer": Case(
        file="eng.xacro",
        angle=0.0,
        frictions={
            "step 40 mm": 0.45,
            "step 64 mm": 0.47,
            "knife edge 64 mm": 0.5,
            "barrier 64 mm": 0.43,
            "stairs of 64 mm": 0.65,
        },
        how={"trusted": True, "mesh": "leave_out", "missing": "leave_out"},
    ),
}
"""The cases by name."""
