"""The cells: robot, obstacle and start, at a height at which some runs clear and some do not.

Robots are the Engineer with different track models, motors and flippers.
"""

import json
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import product
from pathlib import Path
from typing import Any, Literal

import numpy as np

import crawler2d as c2d
from benches.shared.results import write_rows
from crawler2d import Robot, Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.parameters.track import Track
from research.models import study_models

# Drawn fields with their bounds and number of digits; or a range of integers.
_DRAWN: dict[str, dict[str, tuple[float, float, int] | tuple[int, int]]] = {
    "step": {},
    "barrier": {"thickness": (0.05, 0.3, 3)},
    "knife edge": {"thickness": (0.002, 0.01, 3)},
    "stairs": {"count": (2, 5), "run": (0.15, 0.35, 3)},
    "two steps": {"lower": (0.3, 0.9, 2)},
    "diagonal barrier": {"yaw": (0.2, 1.0, 2), "thickness": (0.05, 0.3, 3)},
    "step field": {"seed": (0, 2**32)},
}
ONE_LANE = ("step", "barrier", "knife edge", "stairs")
TWO_LANES = ("two steps", "diagonal barrier", "step field")
_MAY_BE_ROUNDED = ("step", "barrier", "stairs")

# Share of the drawn obstacles with rounded edges.
_ROUNDED = 0.3


def draw_obstacle(kind: str, random: np.random.Generator) -> dict[str, Any]:
    """Draw everything about an obstacle except its height and friction.

    Parameters
    ----------
    kind : str
        One of `ONE_LANE` or `TWO_LANES`.
    random : numpy.random.Generator
        Source of the numbers.

    Returns
    -------
    dict
        Plain numbers, for a file; lengths [m], angles [rad].
    """
    if kind not in _DRAWN:
        raise ValueError(f"kind must be one of {ONE_LANE + TWO_LANES}, got {kind!r}")
    drawn: dict[str, Any] = {"kind": kind}
    for name, (low, high, *digits) in _DRAWN[kind].items():
        if digits:
            drawn[name] = round(float(random.uniform(low, high)), *digits)
        else:
            drawn[name] = int(random.integers(int(low), int(high)))
    if kind == "step field":
        drawn |= {"posts": 8, "levels": 4}
    if kind in _MAY_BE_ROUNDED and random.random() < _ROUNDED:
        drawn["edge_radius"] = round(float(random.uniform(0.001, 0.005)), 3)
    return drawn


def terrain_of(obstacle: Mapping[str, Any], height: float, friction: float) -> Terrain:
    """Return the terrain of an obstacle.

    Parameters
    ----------
    obstacle : mapping
        As `draw_obstacle` returns it.
    height : float
        [m] Of the step, the barrier, each stair, the higher of two steps, or the highest post of a
        step field.
    friction : float
        [-] Coulomb friction.
    """
    kind = obstacle["kind"]
    fields = {name: value for name, value in obstacle.items() if name != "kind"}
    if kind == "two steps":
        heights = (height, fields["lower"] * height)
        return c2d.terrains.lanes(*(c2d.terrains.step(h, friction=friction) for h in heights))
    if kind == "step field":
        rise = height / fields["levels"]
        return c2d.terrains.random_stepfield(rise=rise, friction=friction, **fields)
    make: Callable[..., Terrain] = getattr(c2d.terrains, kind.replace(" ", "_"))
    return make(**{"rise" if kind == "stairs" else "height": height}, friction=friction, **fields)


def length_of(obstacle: Mapping[str, Any]) -> float:
    """[m] Return the approximate length of the obstacle."""
    match obstacle["kind"]:
        case "stairs":
            return float((obstacle["count"] - 1) * obstacle["run"])
        case "diagonal barrier":
            # The Engineer's tracks are 0.2 m apart.
            return float(0.2 * np.tan(obstacle["yaw"]) + obstacle["thickness"])
        case "step field":
            return float(obstacle["posts"] * 0.1)
        case _:
            return float(obstacle.get("thickness", 0.0))


# [m] Axle distance of the Engineer; in a line of four, wheels with a sixth of it as radius touch.
_AXLES = 0.365
_STUDIED = {name: model.track for name, model in study_models().items()}
_CLOSED = {
    "24 round all round": _STUDIED["24 all round"],
    "24 gears all round": _STUDIED["24 gears all round"],
    "belt": _STUDIED["belt"],
    "belt with grousers": _STUDIED["belt with grousers"],
}
_OPEN = {
    "belt": _STUDIED["belt"],
    "line of 5 round": _STUDIED["line of 5"],
    "line of 3 gears": _STUDIED["line of 3 gears"],
}

_MECHANISMS: tuple[Literal["guide", "sprocket"], ...] = ("guide", "sprocket")
_GAITS: tuple[Literal["climb", "hold"], ...] = ("climb", "hold")

Ends = Literal["front", "rear", "both"]
_ENDS: dict[Ends, str] = {"front": "in front", "rear": "behind", "both": "at both ends"}


@dataclass(frozen=True, kw_only=True)
class Kind:
    """A kind of robot for which cells are drawn."""

    name: str
    model: str
    """Model; all kinds of a model have a common verdict."""
    track: Track
    sharing: Literal["track", "wheel"] = "track"
    """Whether a track has one motor or each wheel a servo."""
    ends: Ends | None = None
    """Ends with flippers."""
    gait: Literal["climb", "hold"] | None = None
    obstacles: tuple[str, ...] = ONE_LANE
    heights: tuple[float, float] = (0.01, 0.3)
    """[m] Range of the search."""

    def robot(
        self, center_of_mass: tuple[float, float], max_torque: float, *, rotors: bool
    ) -> Robot:
        """Build the robot.

        Parameters
        ----------
        center_of_mass : (float, float)
            [m] Without flippers.
        max_torque : float
            [N m] Of one sprocket.
        rotors : bool
            Whether its motors have those of the preset.
        """
        arms = c2d.robots.engineer().flippers if self.ends else None
        if arms is not None and self.ends is not None:
            arms = replace(arms, ends=self.ends)
        robot = c2d.robots.engineer(center_of_mass=center_of_mass, flippers=arms, track=self.track)
        drivetrain = replace(robot.drivetrain, max_torque=max_torque, torque_sharing=self.sharing)
        robot = replace(robot, drivetrain=drivetrain)
        return robot if rotors else robot.without_rotors()


def _lines() -> Iterator[Kind]:
    for wheel, word in ((c2d.RoundWheel(), "round"), (c2d.GearWheel(), "gears")):
        for count in (3, 4, 5, 9):
            radius = _AXLES / 6.0 if count == 4 else None
            track = c2d.LineOfWheels(count, wheel_radius=radius, wheel=wheel)
            name, model = f"line of {count} {word}", f"lines of {wheel.kind} wheels"
            yield Kind(name=name, model=model, track=track)
            yield Kind(name=f"{name}, servos", model=model, track=track, sharing="wheel")


def _closed() -> Iterator[Kind]:
    for letter in "ab":
        for name, track in _CLOSED.items():
            yield Kind(name=f"{name} ({letter})", model=name, track=track)
    for name in ("hybrid", "hybrid gears"):
        word = "" if "gears" in name else " round"
        yield Kind(name=name + word, model="hybrid", track=_STUDIED[name])
    for name in ("force on skids", "force on wheels"):
        yield Kind(name=name, model="force", track=_STUDIED[name], heights=(0.003, 0.2))


def _lanes() -> Iterator[Kind]:
    more = ("belt with grousers", "24 gears all round")
    tracks = _OPEN | {name: _CLOSED[name] for name in more}
    for name, track in tracks.items():
        yield Kind(name=f"{name}, two lanes", model="two lanes", track=track, obstacles=TWO_LANES)


def _chains() -> Iterator[Kind]:
    for count, mechanism in product((22, 44), _MECHANISMS):
        track = c2d.SegmentalTrack(shoe_count=count, mechanism=mechanism)
        yield Kind(name=f"chain of {count}, {mechanism}", model="chains", track=track)


def _arms() -> Iterator[Kind]:
    for (name, track), (ends, place), gait in product(_OPEN.items(), _ENDS.items(), _GAITS):
        yield Kind(
            name=f"{name}, flippers {place}, {gait}",
            model=f"{name}, flippers",
            track=track,
            ends=ends,
            gait=gait,
            heights=(0.03, 0.45),
        )


KINDS = {kind.name: kind for part in (_lines, _closed, _lanes, _chains, _arms) for kind in part()}
"""All kinds by name, the fastest first."""


FOLDER = Path(__file__).parent / "sets"

Setting = Mapping[str, Any]
"""Arguments of `Solver`."""


@dataclass(frozen=True, kw_only=True)
class Cell:
    """Common data of all runs of a cell."""

    name: str
    kind: str
    """Name in `KINDS`."""
    center_of_mass: tuple[float, float]
    """[m] Length of the robot without flippers."""
    max_torque: float
    """[N m] Of one sprocket."""
    friction: float
    speed: float
    """[m/s]"""
    obstacle: Mapping[str, Any]
    """The result of `draw_obstacle`."""
    height: float
    """[m] Of the obstacle."""
    duration: float
    """[s] Longest simulated time."""
    hold_angle: float = 0.0
    """[rad] Angle of the flippers, for the gait that holds them."""
    rotors: bool = False
    """Whether its motors have those of the preset."""
    found: Mapping[str, Any] = field(default_factory=dict)
    """How the height was found: rate, runs, setting, draws that had no such height."""

    @property
    def what(self) -> Kind:
        """The kind of robot."""
        return KINDS[self.kind]

    @property
    def seed(self) -> int:
        """Seed of its runs; the cells must not repeat each other's draws."""
        return 2 * zlib.crc32(f"{self.name} {self.friction}".encode())

    def scenario(self, setting: Setting) -> Scenario:
        """Return the scenario that the runs vary.

        Parameters
        ----------
        setting : mapping
            Arguments of `Solver`.
        """
        gaits = {None: None, "climb": c2d.Climb(), "hold": c2d.Hold(self.hold_angle)}
        return Scenario(
            self.what.robot(self.center_of_mass, self.max_torque, rotors=self.rotors),
            terrain_of(self.obstacle, self.height, self.friction),
            drive=c2d.Drive(speed=self.speed, gait=gaits[self.what.gait]),
            duration=self.duration,
            solver=c2d.Solver(**setting),
        )


def path_of(number: int) -> Path:
    """Return the file of a set, whose number is the seed of its draws."""
    return FOLDER / f"{number}.json"


def read(path: Path) -> list[Cell]:
    """Read a set of cells, which is empty without a file."""
    if not path.exists():
        return []
    rows = json.loads(path.read_text(encoding="utf-8"))
    return [Cell(**row | {"center_of_mass": tuple(row["center_of_mass"])}) for row in rows]


def write(path: Path, cells: Sequence[Cell]) -> None:
    """Write a set of cells, one per line; the file is complete at any time."""
    write_rows(path, map(asdict, cells))
