"""The cells of the comparison: robots, obstacles, and differences between the runs of a cell.

`find_cells` searches heights at which some runs clear and some do not.
"""

import json
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Literal

import numpy as np

import crawler2d as c2d
from benches.shared.results import write_rows
from crawler2d.parameters.terrain import RandomStepfield, Terrain
from crawler2d.parameters.track import Track
from research.models import obstacle

_AHEAD = (0.026, 0.02)  # [m] 26 mm ahead of the preset's

ROBOTS: dict[str, Callable[..., c2d.Robot]] = {
    "engineer": partial(c2d.robots.engineer, flippers=None),
    "engineer, ahead": partial(c2d.robots.engineer, flippers=None, center_of_mass=_AHEAD),
    "absolem": partial(c2d.robots.absolem, flippers=None),
    "marv": partial(c2d.robots.marv, flippers=None),
}
"""Robots without flippers; "ahead" has its centre of mass 26 mm farther ahead."""

_THREE = tuple((x, 0.0, 0.08) for x in (-0.186, 0.0, 0.186))

MODELS: dict[str, Track] = {
    "line of 3": c2d.LineOfWheels(3),
    "line of 5": c2d.LineOfWheels(5),
    "line of 9": c2d.LineOfWheels(9),
    "3 gears": c2d.LineOfWheels(3, wheel=c2d.GearWheel()),
    "5 gears": c2d.LineOfWheels(5, wheel=c2d.GearWheel()),
    "24 all round": c2d.CircumferentialWheels(24),
    "24 gears": c2d.CircumferentialWheels(24, wheel=c2d.GearWheel()),
    "public 3": c2d.HybridWheels(_THREE),
}
"""Wheels instead of a track; "public 3" are those of the Engineer's public model."""

DRIVES: dict[str, tuple[float, Literal["track", "wheel"]]] = {
    "6 N m, track": (6.0, "track"),
    "6 N m, servos": (6.0, "wheel"),
    "60 N m, track": (60.0, "track"),
    "60 N m, servos": (60.0, "wheel"),
    "100 N m a wheel": (100.0, "wheel"),
}
"""Torque and its sharing: [N m] of a sprocket, in the last one of every wheel."""

_ACCELERATION = 1.0  # [m/s^2] The same for all, so that the approach does not set the speed.


def robot_of(robot: str, model: str, drive: str) -> c2d.Robot:
    """Return a robot by its names.

    Parameters
    ----------
    robot, model, drive : str
        In `ROBOTS`, `MODELS` and `DRIVES`.

    Examples
    --------
    >>> robot_of("marv", "line of 5", "6 N m, servos").drivetrain.torque_sharing
    'wheel'
    """
    return with_motors(ROBOTS[robot](track=MODELS[model]), drive)


def with_motors(base: c2d.Robot, drive: str) -> c2d.Robot:
    """Return a robot with motors named in `DRIVES`, without rotors, which rapier does not have."""
    torque, sharing = DRIVES[drive]
    if drive == "100 N m a wheel":
        # The sprocket's torque acts at the belt, each wheel's at its own radius.
        wheels = base.wheels()
        belt = base.outline.rear_radius - base.outline.grouser_height
        torque *= 0.5 * len(wheels) * belt / float(wheels["radius"].max())
    return replace(
        base,
        drivetrain=replace(
            base.drivetrain,
            max_torque=torque,
            torque_sharing=sharing,
            max_acceleration=_ACCELERATION,
        ),
    ).without_rotors()


CELLS = Path(__file__).with_name("cells.json")
STARTS = 16
"""Runs of a cell that are predicted; an engine may have fewer."""

GROUNDS = ("step", "knife edge", "oblique edge", "one-sided edge", "step field")
"""The last three vary across the width of the robot."""

_THICK = 0.01  # [m] of edges, as in a study
_YAW = 0.35  # [rad] of oblique ones
_SPEED = 0.2  # [m/s]
_LENGTHS = 5.5  # axle distances at that speed: twice the longest way
_FIELD = 2.0  # [m] more for a step field, which is half as long
_SEEDS = 1000
_HEIGHT, _FRICTION = 0.03, 0.05  # [-] by which they vary, either way


@dataclass(frozen=True, slots=True)
class Cell:
    """The common data of the runs of a cell.

    Parameters
    ----------
    group : {"plane", "space", "paper"}
        Whether the ground is the same across the robot; "paper" has the settings of the public
        simulation model.
    robot, model, drive : str
        See `robots`.
    ground : str
        One of `GROUNDS`.
    height : float
        [m] Of the obstacle, or of one level of a step field.
    friction : float
        [-] Between robot and ground.
    """

    group: str
    robot: str
    model: str
    drive: str
    ground: str
    height: float = 0.0
    friction: float = 0.0

    @property
    def label(self) -> str:
        """Its name."""
        where = f"{self.ground} of {1e3 * self.height:.4g} mm, friction {self.friction:.4g}"
        return f"{self.robot}; {self.model}; {self.drive}; {where}"

    @property
    def is_even(self) -> bool:
        """Whether its ground is constant across the width of the robot."""
        return self.ground in GROUNDS[:2]

    @property
    def is_coupled(self) -> bool:
        """Whether the limit of one motor per track matters: it cannot make wheels slip."""
        return self.drive == "6 N m, track"

    def built(self) -> c2d.Robot:
        """Return its robot."""
        return robot_of(self.robot, self.model, self.drive)

    def scenarios(self, count: int = STARTS) -> list[c2d.Scenario]:
        """Return its first runs.

        They differ in approach (a quarter of the axle distance), phase of the wheels (a turn),
        height (3 % either way) and friction (5 %); every step field is another one.
        """
        robot = self.built()
        length = robot.outline.axle_distance
        way = _LENGTHS * length + (_FIELD if self.ground == "step field" else 0.0)
        draw = np.random.default_rng(zlib.crc32(self.label.encode())).uniform
        found = []
        for _ in range(count):
            far = length * draw(0.075, 0.325)
            along = draw(0.0, 2.0 * np.pi * robot.outline.front_radius)
            height = self.height * draw(1.0 - _HEIGHT, 1.0 + _HEIGHT)
            friction = self.friction * draw(1.0 - _FRICTION, 1.0 + _FRICTION)
            ground = terrain_of(self.ground, height, friction)
            if isinstance(ground, RandomStepfield):
                ground = replace(ground, seed=int(draw(0.0, _SEEDS)))
            found.append(
                c2d.Scenario(
                    robot,
                    ground,
                    drive=c2d.Drive(speed=_SPEED),
                    start=c2d.Start(approach=float(far), track_phase=float(along)),
                    duration=round(way / _SPEED, 2),
                )
            )
        return found


def terrain_of(ground: str, height: float, friction: float) -> Terrain:
    """Return a ground by its name; if it varies across the width, roll and yaw are held."""
    match ground:
        case "step" | "knife edge":
            return obstacle(ground, height, friction)
        case "oblique edge":
            return c2d.terrains.diagonal_barrier(
                _YAW, height=height, thickness=_THICK, friction=friction
            )
        case "one-sided edge":
            level = c2d.terrains.flat(length=_THICK, friction=friction)
            return c2d.terrains.lanes(left=obstacle("knife edge", height, friction), right=level)
        case "step field":
            return c2d.terrains.random_stepfield(rise=height, friction=friction)
    raise ValueError(f"no ground {ground!r}; grounds: {', '.join(GROUNDS)}")


def read_cells(path: Path = CELLS) -> list[Cell]:
    """Read cells."""
    return [Cell(**row) for row in json.loads(path.read_text(encoding="utf-8"))]


def write_cells(cells: Sequence[Cell], path: Path = CELLS) -> None:
    """Write cells, one line each; the file is complete at any time."""
    write_rows(path, map(asdict, cells))


_HEIGHTS = (0.4, 0.55, 0.7, 0.85, 1.0, 1.2, 1.4, 1.6, 1.8)
"""[-] Heights relative to the radius, for a first search."""

_RUNS = 8
_FEW, _MANY = 0.2, 0.8
_HALVINGS = 4
_FRICTIONS = (0.7, 0.85, 0.55, 1.0)

_GIVEN = {
    ("step", "6 N m, track"): (0.0496, 0.7),
    ("step", "6 N m, servos"): (0.0256, 0.85),
    ("step", "60 N m, track"): (0.052, 0.55),
    ("step", "60 N m, servos"): (0.0256, 1.0),
    ("knife edge", "6 N m, servos"): (0.0256, 0.7),
    ("knife edge", "60 N m, servos"): (0.03, 1.0),
    ("oblique edge", "60 N m, track"): (0.03, 0.7),
    ("one-sided edge", "60 N m, track"): (0.03, 0.7),
}
"""Height [m] and friction of 24 gears, whose runs take too long for a search: those of the steps
were found by one with the first of the robots, the others are given."""

_SLOW = "24 gears"
_OTHERS = ("line of 3", "line of 5", "line of 9", "5 gears")
_PAPER_GROUNDS = (
    ("knife edge", 0.04),
    ("step", 0.05),
    ("step", 0.075),
    ("step", 0.1),
    ("step field", 0.025),
)
"""Grounds, and [m] their heights, at the settings of the public model."""


def _wanted() -> Iterator[Cell]:
    """Yield the cells to search, whose height and friction are still open.

    On two lanes 24 gears are on one motor a track: with servos their runs take minutes there.
    """
    usual = [model for model in MODELS if model != "public 3"]
    for model, robot in product(usual, ("engineer", "engineer, ahead")):
        for drive in ("6 N m, track", "6 N m, servos", "60 N m, track", "60 N m, servos"):
            yield Cell("plane", robot, model, drive, "step")
        for drive in ("6 N m, servos", "60 N m, servos"):
            yield Cell("plane", robot, model, drive, "knife edge")
    for robot, model, ground in product(("absolem", "marv"), _OTHERS, ("step", "knife edge")):
        yield Cell("plane", robot, model, "60 N m, servos", ground)
    for model, ground in product(usual, ("oblique edge", "one-sided edge")):
        drive = "60 N m, track" if model == _SLOW else "60 N m, servos"
        yield Cell("space", "engineer", model, drive, ground)


def _paper() -> Iterator[Cell]:
    """Yield the cells at the settings of the public simulation model.

    24 gears are on one motor a track of 60 N m, in other engines 74 N m a wheel: with such servos
    their runs take minutes.
    """
    for model in MODELS:
        drive = "60 N m, track" if model == _SLOW else "100 N m a wheel"
        for ground, height in _PAPER_GROUNDS:
            cell = Cell("paper", "engineer", model, drive, ground)
            yield replace(cell, height=height, friction=1.0)


def find_cells() -> Iterator[tuple[Cell, float]]:
    """Yield each cell with its rate of clearing, with another friction if the first has none."""
    for number, cell in enumerate(_wanted()):
        if cell.model == _SLOW:
            height, friction = _GIVEN[cell.ground, cell.drive]
            given = replace(cell, height=height, friction=friction)
            yield given, _rate(given)
            continue
        first = number % len(_FRICTIONS)
        found = []
        for friction in _FRICTIONS[first:] + _FRICTIONS[:first]:
            found.append(_search(replace(cell, friction=friction)))
            if _FEW <= found[-1][1] <= _MANY:
                break
        yield min(found, key=lambda each: abs(each[1] - 0.5))
    for cell in _paper():
        yield cell, _rate(cell)


def _search(cell: Cell) -> tuple[Cell, float]:
    """Return the cell at the height with the rate closest to one half, and that rate."""
    radius = cell.built().outline.front_radius
    looked: list[tuple[Cell, float]] = []
    for share in _HEIGHTS:
        looked.append(_look(cell, share * radius))
        if _FEW <= looked[-1][1] <= _MANY or looked[0][1] == 0.0:
            return looked[-1]  # a robot stopped by the lowest is not tried at higher ones
        if len(looked) > 1 and _crosses(looked[-2:]):
            low, high = looked[-2:]
            for _ in range(_HALVINGS):
                middle = _look(cell, 0.5 * (low[0].height + high[0].height))
                looked.append(middle)
                if _FEW <= middle[1] <= _MANY:
                    return middle
                low, high = (low, middle) if _crosses((low, middle)) else (middle, high)
    return min(looked, key=lambda each: abs(each[1] - 0.5))


def _crosses(pair: Sequence[tuple[Cell, float]]) -> bool:
    return (pair[0][1] > 0.5) != (pair[1][1] > 0.5)


def _look(cell: Cell, height: float) -> tuple[Cell, float]:
    cell = replace(cell, height=round(height, 4))
    return cell, _rate(cell)


def _rate(cell: Cell) -> float:
    runs = c2d.simulate_many(cell.scenarios(_RUNS), record="summary", threads=1)
    return sum(str(run.outcome) == "cleared" for run in runs) / _RUNS
