"""The cases: robots of public files with their flippers held, and their obstacles."""

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from crawler2d import Drive, Hold, Reading, Robot, Scenario, ScenarioWarning, Start, read_robot
from crawler2d.audits.runs import scenario_of
from crawler2d.audits.subject import standard_obstacles
from crawler2d.parameters.terrain import Terrain

ROBOTS = Path(__file__).parents[2] / "tests" / "robots"
STARTS = 20

_AMPLE = 20.0
"""[-] Factor of the torque that was read: no file limits its wheels below slipping."""

_FIRM = 1e4  # [N m] holds a flipper
_FIRMEST = 1e6  # [N m] brings the rotor below up to speed
_ROTOR = 100.0  # [kg m^2] hundreds of times the inertia that strikes an edge
_SEED = 23
_SPEED, _SLOW = 0.4, 0.1  # [m/s] what an audit has for 0.41 m between the axles; no momentum
_DURATION = 12.0 * _SPEED  # [m] twice the longest way, at the commanded speed


@dataclass(frozen=True, slots=True)
class Cell:
    """An obstacle, and the approach to it.

    Parameters
    ----------
    obstacle : str
        Which of the standard obstacles of an audit.
    friction : float
        [-] Between robot and ground.
    speed : float, optional
        [m/s] Commanded; None takes that of an audit.
    """

    obstacle: str
    friction: float
    speed: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A public file, and the obstacles of its robot.

    Parameters
    ----------
    file : str
        In `ROBOTS`.
    angle : float
        [rad] At which the flippers are held, relative to the chassis, upwards > 0.
    cells : mapping of str to Cell
        What it drives over, by label.
    files : tuple of str
        Which of the files of `files.FILES` there are of it.
    how : mapping
        Keywords for `read_robot`.
    """

    file: str
    angle: float
    cells: Mapping[str, Cell]
    files: tuple[str, ...] = ("public", "export", "repair", "patch")
    how: Mapping[str, Any] = field(default_factory=dict)

    @property
    def form(self) -> str:
        """Format of the file, "sdf" or "urdf"."""
        return "sdf" if self.file.endswith(".sdf") else "urdf"

    def reading(self) -> Reading:
        """Read the public file without its warnings, which are in its audit."""
        with warnings.catch_warnings(action="ignore", category=ScenarioWarning):
            return read_robot(ROBOTS / self.file, **self.how)

    def robot(self) -> Robot:
        """Return the robot with motors that hold their speeds, and its flippers held."""
        return self.with_firm_flippers(self.reading().robot)

    def with_firm_flippers(self, robot: Robot) -> Robot:
        """Return a robot whose flippers keep their angle and whose motors keep their speed."""
        torque = _AMPLE * robot.drivetrain.max_torque
        drivetrain = replace(robot.drivetrain, max_torque=torque, torque_sharing="track")
        flippers = robot.flippers
        if flippers is not None:
            flippers = replace(flippers, angle=self.angle, torque_limit=_FIRM)
        return replace(robot, drivetrain=drivetrain, flippers=flippers)

    def firm(self, robot: Robot) -> Robot:
        """Return a robot whose motors also keep their speed through impacts, as in engines.

        An impact takes no time in crawler2d, so only a rotor carries a speed through it; in an
        engine a motor that holds a speed has a whole step for it, or gives it as a constraint.
        """
        motors = replace(robot.drivetrain, max_torque=_FIRMEST, rotor_inertia=_ROTOR)
        arms = robot.flippers
        if arms is not None:
            arms = replace(arms, rotor_inertia=_ROTOR)
        return replace(robot, drivetrain=motors, flippers=arms)

    def ground(self, cell: Cell, robot: Robot) -> Terrain:
        """Return the obstacle of a cell, scaled to the robot as it is."""
        return standard_obstacles(robot, cell.friction)[cell.obstacle]

    def drive(self, cell: Cell, robot: Robot) -> Drive:
        """Return the command of a cell: flippers are held."""
        usual = scenario_of(robot, self.ground(cell, robot), None, None).drive.speed
        return Drive(speed=usual if cell.speed is None else cell.speed, gait=Hold(self.angle))

    def scenarios(self, label: str, robot: Robot) -> list[Scenario]:
        """Return one scenario for each start of a cell.

        All robots of a case have the same outline, and so the same obstacles and starts.
        """
        cell = self.cells[label]
        length = robot.outline.axle_distance
        drive = self.drive(cell, robot)
        generator = np.random.default_rng(_SEED)
        approach = length * (0.2 + generator.uniform(-0.125, 0.125, STARTS))
        turn = 2.0 * np.pi * robot.outline.front_radius
        phase = generator.uniform(0.0, turn, STARTS)
        return [
            Scenario(
                robot,
                self.ground(cell, robot),
                drive=drive,
                start=Start(approach=float(far), track_phase=float(along)),
                duration=_DURATION / drive.speed,
            )
            for far, along in zip(approach, phase, strict=True)
        ]


CASES: dict[str, Case] = {
    "absolem": Case(
        file="absolem.sdf",
        angle=0.7,
        cells={
            "step 44 mm": Cell("step 44 mm", 0.43),
            "step 71 mm": Cell("step 71 mm", 0.43),
            "knife edge 71 mm": Cell("knife edge 71 mm", 0.43),
            "barrier 71 mm": Cell("barrier 71 mm", 0.43),
            "stairs of 71 mm": Cell("stairs of 71 mm", 0.5),
            "slow, step 44 mm": Cell("step 44 mm", 0.5, _SLOW),
            "slow, step 71 mm": Cell("step 71 mm", 0.5, _SLOW),
            "slow, stairs of 71 mm": Cell("stairs of 71 mm", 0.65, _SLOW),
            "slow, knife edge 71 mm": Cell("knife edge 71 mm", 0.72, _SLOW),
        },
        files=(
            *("public", "export", "repair", "patch"),
            *("balanced", "on-axles", "balanced-on-axles"),
        ),
    ),
    "engineer": Case(
        file="eng.xacro",
        angle=0.0,
        cells={
            "step 40 mm": Cell("step 40 mm", 0.45),
            "step 64 mm": Cell("step 64 mm", 0.47),
            "knife edge 64 mm": Cell("knife edge 64 mm", 0.5),
            "barrier 64 mm": Cell("barrier 64 mm", 0.43),
            "stairs of 64 mm": Cell("stairs of 64 mm", 0.65),
            "slow, knife edge 32 mm": Cell("knife edge 32 mm", 0.6, _SLOW),
            "slow, step 40 mm": Cell("step 40 mm", 0.6, _SLOW),
            "slow, step 64 mm": Cell("step 64 mm", 0.65, _SLOW),
            "slow, knife edge 64 mm": Cell("knife edge 64 mm", 0.6, _SLOW),
            "slow, barrier 64 mm": Cell("barrier 64 mm", 0.65, _SLOW),
            "slow, stairs of 64 mm": Cell("stairs of 64 mm", 0.68, _SLOW),
        },
        how={"trusted": True, "mesh": "leave_out", "missing": "leave_out"},
    ),
    "marv": Case(
        file="marv.sdf",
        angle=0.0,
        cells={
            "step 58 mm": Cell("step 58 mm", 0.5),
            "step 93 mm": Cell("step 93 mm", 0.8),
            "knife edge 47 mm": Cell("knife edge 47 mm", 0.5),
            "barrier 93 mm": Cell("barrier 93 mm", 0.8),
            "stairs of 93 mm": Cell("stairs of 93 mm", 0.8),
        },
        files=("public", "export"),
    ),
}
"""The cases by name. In slow cells, momentum does not carry a robot over what stops it at rest.
MARV is a control: it was not found to seize, so there is nothing to repair."""
