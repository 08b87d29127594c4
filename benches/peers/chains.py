"""A chain of shoes in pymunk and in crawler2d: what it costs, and how well the chain holds.

Times are of blocks of half a second: the lower quartile of a run's blocks, and of that the minimum
of several rounds in which all jobs take turns. Also judged:

- the largest gap of a pin, from half a second on, because the robot first falls by 2 mm;
- whether the chain stayed on: no pin gap larger than the thickness of a plate, the chassis above
  the ground;
- on flat ground, the error of the mean speed from 3 s on;
- how far the path is from the one with steps half as long; for crawler2d, with a quarter of the
  accuracy.

*At equal gaps* finds the cheapest setting with which no pin gap in pymunk exceeds an aim: what the
other scenes of this benchmark allow, and crawler2d's own gap at its defaults.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

import crawler2d as c2d
from benches.peers import chain_crawler2d, chain_pymunk, chain_robot, scenes
from benches.peers.chain_robot import ChainRobot
from benches.peers.engine import Setting
from benches.peers.errors import JOINT_GAP
from benches.peers.motion import Array
from benches.peers.timing import interleaved, progress
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive, Solver
from crawler2d.parameters.terrain import Points, Terrain
from crawler2d.parameters.track import GrouserBeltTrack, SegmentalTrack, Track

TERRAINS = ("flat", "step", "field")
SETTINGS = {
    "pymunk, defaults": Setting(1e-3, iterations=10, tuned=False),
    "pymunk, tuned": Setting(1e-3, iterations=10),
    "crawler2d": Setting(accuracy=Solver().accuracy or 0.0),
}
"""Settings that are compared."""
GRID = [
    Setting(dt * 1e-3, iterations=iterations, tuned=tuned)
    for dt in (2.0, 1.0, 0.5, 0.25, 0.125)
    for iterations in (10, 20, 40, 80, 160)
    for tuned in (True, False)
]
"""Settings of pymunk that are tried at equal gaps."""

OWN: dict[str, Track] = {
    "belt with grousers": GrouserBeltTrack(),
    "22 shoes": SegmentalTrack(shoe_count=22),
    "44 shoes": SegmentalTrack(shoe_count=44),
    "22 shoes, sprocket": SegmentalTrack(shoe_count=22, mechanism="sprocket"),
}
"""Tracks of the Engineer."""

# [s]
_DURATION, _BLOCK = 8.0, 0.5
# [s] When gaps and speed begin to count, and the sampling interval of gaps.
_SETTLED, _STEADY, _INTERVAL = 0.5, 3.0, 2e-3
# [m] Shifts of the start of a cell.
_SHIFTS = (0.0, 0.011, 0.023)


@dataclass(frozen=True)
class Place:
    """A robot on a ground.

    Attributes
    ----------
    robot : ChainRobot
        The robot.
    terrain : str
        One of `TERRAINS`.
    shift : float
        [m] How much further back it starts.
    """

    robot: ChainRobot
    terrain: str
    shift: float = 0.0

    def starts(self) -> list[Place]:
        """List the places with all starts of a cell."""
        return [replace(self, shift=shift) for shift in _SHIFTS]

    def boxes(self) -> list[Array]:
        """[m] The ground as boxes."""
        if self.terrain == "flat":
            return [np.array([(-5.0, -0.5), (15.0, -0.5), (15.0, 0.0), (-5.0, 0.0)])]
        return list(scenes.load(f"lwa5-round-{self.terrain}").boxes)

    def profile(self) -> Array:
        """[m] The ground from left to right; the second point is in front of the robot."""
        if self.terrain == "flat":
            return np.array([(-5.0, 0.0), (0.8, 0.0), (15.0, 0.0)])
        return scenes.load(f"lwa5-round-{self.terrain}").profile()

    def world(self, setting: Setting) -> chain_pymunk.World:
        """Build the world in pymunk."""
        return chain_pymunk.build(self.robot, self.boxes(), setting, self.shift)

    def scenario(self, setting: Setting) -> Scenario:
        """Make the scenario for crawler2d."""
        return chain_crawler2d.scenario(self.robot, self.profile(), setting, _DURATION, self.shift)


@dataclass(frozen=True)
class Ride:
    """A run and its errors.

    Attributes
    ----------
    path : ndarray, shape (n, 2)
        [m] Chassis x, y every `_INTERVAL`.
    gap : float
        [m] Largest gap of a pin.
    """

    path: Array
    gap: float

    @property
    def survived(self) -> bool:
        """Whether the chain stayed on."""
        return self.gap < ChainRobot.plate_thickness and bool(np.isfinite(self.path).all())

    @property
    def speed_error(self) -> float:
        """[-] Error of the mean speed."""
        steady = self.path[round(_STEADY / _INTERVAL) :, 0]
        mean = (steady[-1] - steady[0]) / ((len(steady) - 1) * _INTERVAL)
        return float(mean / chain_robot.SPEED - 1.0)

    def distance(self, other: Ride) -> float:
        """[m] Largest distance between the two paths at equal times."""
        return float(np.hypot(*(self.path - other.path).T).max())


def side_by_side(
    counts: Sequence[int], terrains: Sequence[str], repeats: int
) -> list[dict[str, Any]]:
    """Time and judge both engines."""
    rows = []
    for count in counts:
        for terrain in terrains:
            progress(f"chains: {count} shoes, {terrain}")
            place = Place(ChainRobot(count), terrain)
            jobs: dict[str, Callable[[], float]] = {
                name: partial(_blocks, name, place, setting) for name, setting in SETTINGS.items()
            }
            times = interleaved(jobs, repeats)
            for name, setting in SETTINGS.items():
                rows.append(
                    {
                        "shoes": count,
                        "terrain": terrain,
                        "engine": name,
                        "per_second": times[name].least / _BLOCK,
                        **_judged(name, place, setting),
                    }
                )
    return rows


def equal_gaps(
    counts: Sequence[int], terrains: Sequence[str], grid: Sequence[Setting] = GRID
) -> list[dict[str, Any]]:
    """Find pymunk's cheapest settings that keep the pin gaps below an aim, and their cost."""
    rows = []
    for count in counts:
        for terrain in terrains:
            progress(f"equal gaps: {count} shoes, {terrain}")
            place, own = Place(ChainRobot(count), terrain), SETTINGS["crawler2d"]
            gap = max(ride("crawler2d", start, own).gap for start in place.starts())
            costs = [_seconds(place, setting) for setting in grid]
            by_cost = [setting for _, setting in sorted(zip(costs, grid, strict=True), key=_first)]
            found: dict[str, Setting | None] = {}
            for name, aim in (("allowed", JOINT_GAP), ("own", gap)):
                is_tight = (s for s in by_cost if _widest(place, s, aim) <= aim)
                found[name] = next(is_tight, None)
                progress(f"  {1e3 * aim:.3g} mm: {found[name] or 'nothing'}")
            row = {"shoes": count, "terrain": terrain, "gap": gap, "allowed": JOINT_GAP}
            rows.append(row | _costs(place, found, grid[-2:]))
    return rows


def _costs(
    place: Place, found: dict[str, Setting | None], finest: Sequence[Setting]
) -> dict[str, Any]:
    """Time the settings found beside crawler2d's defaults; without one, measure the finest."""
    settings = {name: setting for name, setting in found.items() if setting is not None}
    jobs = {name: partial(_blocks, "pymunk", place, s) for name, s in settings.items()}
    jobs["crawler2d"] = partial(_blocks, "crawler2d", place, SETTINGS["crawler2d"])
    times = interleaved(jobs, 3)
    row: dict[str, Any] = {
        "per_second": {name: time.least / _BLOCK for name, time in times.items()},
        "found": {name: str(setting) for name, setting in settings.items()},
    }
    if len(settings) < len(found):
        gaps = {str(s): ride("pymunk", place, s).gap for s in finest}
        row["finest"] = min(gaps.items(), key=lambda item: item[1])
    return row


def _first(pair: tuple[float, Setting]) -> float:
    return pair[0]


def engineer(repeats: int) -> list[dict[str, Any]]:
    """Time the Engineer's own chains and its belt with grousers."""
    grounds: dict[str, Terrain] = {
        "flat": c2d.terrains.flat(friction=0.9),
        "step of 80 mm": c2d.terrains.step(0.08, friction=0.9),
        "blocks up to 60 mm": _low_blocks(),
    }
    cases = [(name, terrain) for name in OWN for terrain in grounds]
    progress("chains: the Engineer's")
    times = interleaved(
        {
            (name, terrain): partial(_own_blocks, OWN[name], grounds[terrain])
            for name, terrain in cases
        },
        repeats,
    )
    return [
        {"track": name, "terrain": terrain, "per_second": times[name, terrain].least / _BLOCK}
        for name, terrain in cases
    ]


def ride(engine: str, place: Place, setting: Setting, most: float = np.inf) -> Ride:
    """Run an engine; pymunk's run ends early if a pin gap exceeds `most` [m]."""
    if engine == "crawler2d":
        run = c2d.simulate(place.scenario(setting), sample_interval=_INTERVAL)
        return Ride(run.position, run.metrics["max_pin_gap"])
    world, stride = place.world(setting), setting.stride(_INTERVAL)
    path, widest = [world.chassis_pose()[:2]], 0.0
    for sample in range(1, round(_DURATION / _INTERVAL) + 1):
        world.advance(stride, setting.time_step)
        path.append(world.chassis_pose()[:2])
        if sample * _INTERVAL > _SETTLED:
            widest = max(widest, pin_gap(world.shoe_poses(), place.robot.pitch))
        if not widest <= most:
            break
    return Ride(np.array(path), widest)


def pin_gap(shoes: Array, pitch: float) -> float:
    """[m] Largest pin gap of a closed chain, from the poses of its shoes."""
    reach = pitch / 2.0 * np.column_stack([np.cos(shoes[:, 2]), np.sin(shoes[:, 2])])
    front, rear = shoes[:, :2] + reach, shoes[:, :2] - reach
    return float(np.hypot(*(front - np.roll(rear, -1, axis=0)).T).max())


def _judged(engine: str, place: Place, setting: Setting) -> dict[str, Any]:
    """Measure the errors over a few starts, and against steps half as long."""
    half = replace(setting, time_step=setting.time_step / 2.0, accuracy=setting.accuracy / 4.0)
    runs = [ride(engine, start, setting) for start in place.starts()]
    finer = [ride(engine, start, half) for start in place.starts()]
    return {
        "gap": max(run.gap for run in runs),
        "survived": sum(run.survived for run in runs),
        "count": len(runs),
        "distance_gone": float(runs[0].path[-1, 0] - runs[0].path[0, 0]),
        "speed_error": max((run.speed_error for run in runs), key=abs),
        "distance": max(run.distance(fine) for run, fine in zip(runs, finer, strict=True)),
    }


def _widest(place: Place, setting: Setting, most: float) -> float:
    """[m] Largest pin gap in pymunk over the starts; ends early if it exceeds `most`."""
    widest = 0.0
    for start in place.starts():
        run = ride("pymunk", start, setting, most)
        widest = max(widest, run.gap if np.isfinite(run.gap) else np.inf)
        if widest > most:
            break
    return widest


def _seconds(place: Place, setting: Setting) -> float:
    """[s] Wall time of 0.1 s of simulated time in pymunk."""
    world = place.world(setting)
    return world.advance(setting.steps(0.1), setting.time_step)


def _blocks(engine: str, place: Place, setting: Setting) -> float:
    """[s] Wall time of a block, lower quartile over a run."""
    if engine == "crawler2d":
        return _of_simulation(place.scenario(setting))
    world = place.world(setting)
    steps = setting.steps(_BLOCK)
    return _lower_quartile(lambda: world.advance(steps, setting.time_step))


def _own_blocks(track: Track, terrain: Terrain) -> float:
    """[s] The same for the Engineer."""
    robot = c2d.robots.engineer(flippers=None, track=track).without_rotors()
    drivetrain = replace(robot.drivetrain, max_acceleration=2.0, max_torque=20.0)
    built = replace(robot, drivetrain=drivetrain)
    return _of_simulation(Scenario(built, terrain, drive=Drive(speed=chain_robot.SPEED)))


def _of_simulation(scenario: Scenario) -> float:
    simulation = c2d.Simulation(scenario)

    def block() -> float:
        start = time.perf_counter()
        simulation.advance(_BLOCK)
        return time.perf_counter() - start

    return _lower_quartile(block)


def _lower_quartile(block: Callable[[], float]) -> float:
    return statistics.quantiles([block() for _ in range(round(_DURATION / _BLOCK))], n=4)[0]


def _low_blocks() -> Points:
    """Make twenty blocks, each 0.2 m long."""
    heights = np.random.default_rng(7).uniform(0.0, 0.06, 20)
    points = [(-5.0, 0.0), (0.0, 0.0)]
    for index, height in enumerate(heights.tolist()):
        points += [(0.2 * index, height), (0.2 * (index + 1), height)]
    points += [(4.0, 0.0), (20.0, 0.0)]
    return Points(tuple(points), goal=4.0, friction=0.9)
