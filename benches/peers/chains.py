"""A chain of shoes in pymunk and in crawler2d: its cost, and the gaps of its pins.

The robot depends on no engine: two toothed ends, a hull, shoes on pins. The pins of the straight
runs lie one radius below and above the axles, a whole number of pitches apart. Round an end they
are the corners of a polygon with as many corners as the sprocket has teeth. So the pitch follows
from the counts and the axle distance, and the chain closes without slack. Hull and discs leave it a
clearance of one millimetre. In crawler2d it is a `SegmentalTrack` on its guide: the outer faces of
the shoes run along the same outline, the drive pulls along the shoes of the rear end, with the
force of the same torque, and hull, sprockets and shoes have the same weights.

Times are of blocks of half a second: the lower quartile of a run's blocks, and of that the minimum
of several rounds in which all jobs take turns. Also measured:

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

import math
import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

import crawler2d as c2d
from benches.adapters.planar import Array, Setting, load_engine, load_scene
from benches.peers.accuracy import JOINT_GAP
from benches.shared.measuring import interleaved, machine, seconds
from benches.shared.results import progress
from crawler2d import Scenario, Solver
from crawler2d.parameters.terrain import Points, Terrain
from crawler2d.parameters.track import Track
from research.models import study_robot

if TYPE_CHECKING:
    from benches.adapters.chipmunk import Chain

TEETH = {22: 8, 36: 12, 44: 16}
"""Teeth of one sprocket, by the number of shoes."""
SPEED, TORQUE, FRICTION, DROP = 0.4, 30.0, 0.9, 0.002
"""[m/s] Speed of the chain, [N m] limit of the only motor, at the rear sprocket, [-] friction of
shoes and ground, [m] height from which the robot falls at the start."""

_SLACK = 0.001  # [m]
# [m] Depth below the pins at which the teeth begin and end, and the lugs end.
_TOOTH_ROOT, _TOOTH_TIP, _LUG_TIP = 0.0396, 0.0146, 0.0253
# [-] Widths, in pitches.
_TOOTH_BASE, _TOOTH_END, _LUG_BASE, _LUG_END = 0.333, 0.229, 0.292, 0.167


@dataclass(frozen=True)
class ChainRobot:
    """The robot with a number of shoes.

    Attributes
    ----------
    shoe_count : int
        Shoes of the chain.
    """

    shoe_count: int

    axle_distance, plate_thickness = 0.576, 0.0146
    """[m]"""
    hull_mass, sprocket_mass, chain_mass = 13.0, 1.5, 3.96
    """[kg] Masses; the sprocket is one of two."""
    hull_inertia, sprocket_inertia = 0.4008, 0.0048
    """[kg m^2] Moments of inertia of a box 0.6 m long, and of a disc."""
    torque, friction, drop = TORQUE, FRICTION, DROP
    hull_friction, disc_friction, tooth_friction = 0.1, 0.3, 0.1
    """[-] Friction between shoes and the robot."""

    @property
    def tooth_count(self) -> int:
        """Number of teeth of one sprocket."""
        return TEETH[self.shoe_count]

    @property
    def pitch(self) -> float:
        """[m] Distance from pin to pin."""
        return 2.0 * self.axle_distance / (self.shoe_count - self.tooth_count)

    @property
    def pin_radius(self) -> float:
        """[m] Distance from an axle to the pins round it."""
        return self.pitch / (2.0 * math.sin(math.pi / self.tooth_count))

    @property
    def radius(self) -> float:
        """[m] Distance from an axle to the ground."""
        return self.pin_radius + self.plate_thickness / 2.0

    @property
    def mass(self) -> float:
        """[kg] Mass of the whole robot."""
        return self.hull_mass + 2.0 * self.sprocket_mass + self.chain_mass

    @property
    def shoe_mass(self) -> float:
        """[kg] Mass of one shoe."""
        return self.chain_mass / self.shoe_count

    @property
    def shoe_inertia(self) -> float:
        """[kg m^2] Moment of inertia of a shoe, taken as a plate."""
        return self.shoe_mass * (self.pitch**2 + self.plate_thickness**2) / 12.0

    @property
    def moment_of_inertia(self) -> float:
        """[kg m^2] Moment of inertia of the whole robot about its middle."""
        x, y, _ = self.shoes().T
        ends = 2.0 * (self.sprocket_inertia + self.sprocket_mass * (self.axle_distance / 2.0) ** 2)
        shoes = self.shoe_count * self.shoe_inertia + self.shoe_mass * float((x**2 + y**2).sum())
        return self.hull_inertia + ends + shoes

    @property
    def sprocket_speed(self) -> float:
        """[rad/s] Speed at which the teeth move the chain at the commanded speed."""
        return -SPEED * 2.0 * math.pi / (self.tooth_count * self.pitch)

    def pins(self) -> Array:
        """[m] Pins relative to the robot's middle, each at the rear end of a shoe; (shoes, 2)."""
        half, count = self.axle_distance / 2.0, self.tooth_count // 2
        straight = (self.shoe_count - self.tooth_count) // 2
        lower = [(-half + i * self.pitch, -self.pin_radius) for i in range(straight)]
        turn = [-math.pi / 2.0 + math.pi * i / count for i in range(count)]
        front = [
            (half + self.pin_radius * math.cos(a), self.pin_radius * math.sin(a)) for a in turn
        ]
        ahead = np.array([*lower, *front])
        return np.concatenate([ahead, -ahead])

    def shoes(self) -> Array:
        """[m], [m], [rad] Poses relative to the middle of the robot, shape (shoes, 3)."""
        rear = self.pins()
        front = np.roll(rear, -1, axis=0)
        angle = np.arctan2(*(front - rear).T[::-1])
        return np.column_stack([(rear + front) / 2.0, angle])

    def plate(self) -> Array:
        """[m] Corners of a plate in the shoe's frame; 6 % short, so neighbours do not touch."""
        x, y = 0.47 * self.pitch, self.plate_thickness / 2.0
        return np.array([(-x, -y), (x, -y), (x, y), (-x, y)])

    def lug(self) -> Array:
        """[m] Corners of the lug that goes between the teeth, in the shoe's frame."""
        base, tip = 0.5 * _LUG_BASE * self.pitch, 0.5 * _LUG_END * self.pitch
        low = self.plate_thickness / 4.0
        return np.array([(base, low), (tip, _LUG_TIP), (-tip, _LUG_TIP), (-base, low)])

    def disc_radius(self) -> float:
        """[m] Radius of the disc that carries the plates round an end."""
        return self._apothem() - self.plate_thickness / 2.0 - _SLACK

    def teeth(self) -> list[Array]:
        """[m] Corners of the teeth in the sprocket's frame, one tooth at each pin."""
        root, tip = self._apothem() - _TOOTH_ROOT, self._apothem() - _TOOTH_TIP
        base, end = 0.5 * _TOOTH_BASE * self.pitch, 0.5 * _TOOTH_END * self.pitch
        tooth = np.array([(root, -base), (tip, -end), (tip, end), (root, base)])
        turns = -math.pi / 2.0 + 2.0 * math.pi * np.arange(self.tooth_count) / self.tooth_count
        return [
            tooth @ np.array([(math.cos(a), math.sin(a)), (-math.sin(a), math.cos(a))])
            for a in turns
        ]

    def hull(self) -> Array:
        """[m] Corners of the hull that carries the straight runs, in the chassis frame."""
        y = self.pin_radius - self.plate_thickness / 2.0 - _SLACK
        below = [(-0.258, -y + 0.015), (-0.208, -y), (0.208, -y), (0.258, -y + 0.015)]
        return np.array([*below, *((-a, -b) for a, b in below)])

    def _apothem(self) -> float:
        return self.pin_radius * math.cos(math.pi / self.tooth_count)


# [s] Longer than any run.
_NEVER = 1000.0
# [m/s^2] The motor in pymunk has no ramp.
_AT_ONCE = 100.0


def chain_scenario(
    robot: ChainRobot, profile: Array, setting: Setting, duration: float, shift: float
) -> Scenario:
    """Return the scenario of the robot on a ground, starting `shift` [m] further back.

    Parameters
    ----------
    robot : ChainRobot
        The robot.
    profile : ndarray, shape (n, 2)
        [m] The ground from left to right; the robot stands in front of its second point.
    setting : Setting
        Its accuracy counts.
    duration, shift : float
        [s], [m]
    """
    return Scenario(
        _robot(robot),
        Points(
            tuple(map(tuple, profile.tolist())), goal=float(profile[-1, 0]) - 1.0, friction=FRICTION
        ),
        drive=c2d.Drive(speed=SPEED),
        start=c2d.Start(
            approach=float(profile[1, 0]) - robot.axle_distance / 2.0 - robot.radius + shift
        ),
        duration=duration,
        solver=Solver(accuracy=setting.accuracy),
        criteria=c2d.SeizureCriteria(stop_window=_NEVER),
    )


def _robot(robot: ChainRobot) -> c2d.Robot:
    return c2d.Robot(
        f"chain of {robot.shoe_count}",
        mass=robot.mass,
        center_of_mass=(0.0, 0.0),
        moment_of_inertia=robot.moment_of_inertia,
        track_mass=robot.chain_mass,
        outline=c2d.TrackOutline(
            axle_distance=robot.axle_distance,
            front_radius=robot.radius,
            rear_radius=robot.radius,
            grouser_height=0.0,
            grouser_pitch=robot.pitch,
            grouser_thickness=0.1 * robot.pitch,
        ),
        belly=tuple(map(tuple, robot.hull().tolist())),
        gauge=0.3,
        drivetrain=c2d.Drivetrain(
            max_speed=1.0,
            max_acceleration=_AT_ONCE,
            max_deceleration=_AT_ONCE,
            # Torque of one of two sprockets.
            max_torque=TORQUE / 2.0,
        ),
        track=c2d.SegmentalTrack(
            shoe_count=robot.shoe_count, plate_thickness=robot.plate_thickness
        ),
    )


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
    "belt with grousers": c2d.GrouserBeltTrack(),
    "22 shoes": c2d.SegmentalTrack(shoe_count=22),
    "44 shoes": c2d.SegmentalTrack(shoe_count=44),
    "22 shoes, sprocket": c2d.SegmentalTrack(shoe_count=22, mechanism="sprocket"),
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
        return list(load_scene(f"lwa5-round-{self.terrain}").boxes)

    def profile(self) -> Array:
        """[m] The ground from left to right; the second point is in front of the robot."""
        if self.terrain == "flat":
            return np.array([(-5.0, 0.0), (0.8, 0.0), (15.0, 0.0)])
        return load_scene(f"lwa5-round-{self.terrain}").profile()

    def world(self, setting: Setting) -> Chain:
        """Build the world in pymunk."""
        from benches.adapters.chipmunk import build_chain  # noqa: PLC0415 - needs pymunk

        return build_chain(self.robot, self.boxes(), setting, self.shift)

    def scenario(self, setting: Setting) -> Scenario:
        """Return the scenario for crawler2d."""
        return chain_scenario(self.robot, self.profile(), setting, _DURATION, self.shift)


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
        return float(mean / SPEED - 1.0)

    def distance(self, other: Ride) -> float:
        """[m] Largest distance between the two paths at equal times."""
        return float(np.hypot(*(self.path - other.path).T).max())


def measure_chains(
    counts: Sequence[int], terrains: Sequence[str], repeats: int, grid: Sequence[Setting] = GRID
) -> dict[str, Any]:
    """Run the section on chains; it describes its own machine, because it can be run alone."""
    versions = {name: load_engine(name).version for name in ("pymunk", "crawler2d")}
    result: dict[str, Any] = {"machine": machine(versions)}
    start = time.perf_counter()
    result["side_by_side"] = side_by_side(counts, terrains, repeats)
    result["engineer"] = engineer(repeats)
    result["equal_gaps"] = equal_gaps(counts, terrains, grid)
    return result | {"wall": time.perf_counter() - start}


def side_by_side(
    counts: Sequence[int], terrains: Sequence[str], repeats: int
) -> list[dict[str, Any]]:
    """Time both engines and measure their errors."""
    rows = []
    for count, terrain in product(counts, terrains):
        progress(f"chains: {count} shoes, {terrain}")
        place = Place(ChainRobot(count), terrain)
        jobs = {name: partial(_blocks, name, place, each) for name, each in SETTINGS.items()}
        times = interleaved(jobs, repeats)
        for name, setting in SETTINGS.items():
            row = {"shoes": count, "terrain": terrain, "engine": name}
            cost = {"per_second": times[name] / _BLOCK}
            rows.append(row | cost | _errors(name, place, setting))
    return rows


def equal_gaps(
    counts: Sequence[int], terrains: Sequence[str], grid: Sequence[Setting] = GRID
) -> list[dict[str, Any]]:
    """Find pymunk's cheapest settings that keep the pin gaps below an aim, and their cost."""
    rows = []
    for count, terrain in product(counts, terrains):
        progress(f"equal gaps: {count} shoes, {terrain}")
        place, own = Place(ChainRobot(count), terrain), SETTINGS["crawler2d"]
        gap = max(ride("crawler2d", start, own).gap for start in place.starts())
        costs = {setting: _seconds(place, setting) for setting in grid}
        by_cost = sorted(costs, key=lambda setting: costs[setting])
        found: dict[str, Setting | None] = {}
        for name, aim in (("allowed", JOINT_GAP), ("own", gap)):
            found[name] = next((s for s in by_cost if _widest(place, s, aim) <= aim), None)
            progress(f"  {1e3 * aim:.3g} mm: {found[name] or 'nothing'}")
        row = {"shoes": count, "terrain": terrain, "gap": gap, "allowed": JOINT_GAP}
        rows.append(row | _costs(place, found, grid[-2:]))
    return rows


def _costs(
    place: Place, found: dict[str, Setting | None], finest: Sequence[Setting]
) -> dict[str, Any]:
    """Time the cheapest settings and crawler2d's defaults; without one, measure the finest."""
    settings = {name: setting for name, setting in found.items() if setting is not None}
    jobs = {name: partial(_blocks, "pymunk", place, s) for name, s in settings.items()}
    jobs["crawler2d"] = partial(_blocks, "crawler2d", place, SETTINGS["crawler2d"])
    times = interleaved(jobs, 3)
    row: dict[str, Any] = {
        "per_second": {name: time / _BLOCK for name, time in times.items()},
        "found": {name: str(setting) for name, setting in settings.items()},
    }
    if len(settings) < len(found):
        gaps = {str(s): ride("pymunk", place, s).gap for s in finest}
        row["finest"] = min(gaps.items(), key=lambda item: item[1])
    return row


def engineer(repeats: int) -> list[dict[str, Any]]:
    """Time the Engineer's own chains and its belt with grousers."""
    grounds: dict[str, Terrain] = {
        "flat": c2d.terrains.flat(friction=0.9),
        "step of 80 mm": c2d.terrains.step(0.08, friction=0.9),
        "blocks up to 60 mm": _low_blocks(),
    }
    progress("chains: the Engineer's")
    jobs = {
        (name, ground): partial(_own_blocks, track, terrain)
        for name, track in OWN.items()
        for ground, terrain in grounds.items()
    }
    return [
        {"track": name, "terrain": ground, "per_second": time / _BLOCK}
        for (name, ground), time in interleaved(jobs, repeats).items()
    ]


def ride(engine: str, place: Place, setting: Setting, most: float = np.inf) -> Ride:
    """Run an engine; pymunk's run ends early if a pin gap exceeds `most` [m]."""
    if engine == "crawler2d":
        run = c2d.simulate(place.scenario(setting), sample_interval=_INTERVAL)
        return Ride(run.position, run.metrics["max_pin_gap"])
    world, stride = place.world(setting), setting.stride(_INTERVAL)
    path, widest = [world.position()], 0.0
    for sample in range(1, round(_DURATION / _INTERVAL) + 1):
        world.advance(stride)
        path.append(world.position())
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


def _errors(engine: str, place: Place, setting: Setting) -> dict[str, Any]:
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
    steps = setting.steps(0.1)
    return seconds(lambda: world.advance(steps))


def _blocks(engine: str, place: Place, setting: Setting) -> float:
    """[s] Wall time of a block, lower quartile over a run."""
    if engine == "crawler2d":
        return _of_simulation(place.scenario(setting))
    world = place.world(setting)
    steps = setting.steps(_BLOCK)
    return _lower_quartile(lambda: seconds(lambda: world.advance(steps)))


def _own_blocks(track: Track, terrain: Terrain) -> float:
    """[s] The same for the Engineer."""
    robot = study_robot(track=track)
    drivetrain = replace(robot.drivetrain, max_acceleration=2.0, max_torque=20.0)
    built = replace(robot, drivetrain=drivetrain)
    return _of_simulation(Scenario(built, terrain, drive=c2d.Drive(speed=SPEED)))


def _of_simulation(scenario: Scenario) -> float:
    simulation = c2d.Simulation(scenario)
    return _lower_quartile(lambda: seconds(lambda: simulation.advance(_BLOCK)))


def _lower_quartile(block: Callable[[], float]) -> float:
    return statistics.quantiles([block() for _ in range(round(_DURATION / _BLOCK))], n=4)[0]


def _low_blocks() -> Points:
    """Return twenty blocks, each 0.2 m long."""
    heights = np.random.default_rng(7).uniform(0.0, 0.06, 20)
    points = [(-5.0, 0.0), (0.0, 0.0)]
    for index, height in enumerate(heights.tolist()):
        points += [(0.2 * index, height), (0.2 * (index + 1), height)]
    points += [(4.0, 0.0), (20.0, 0.0)]
    return Points(tuple(points), goal=4.0, friction=0.9)
