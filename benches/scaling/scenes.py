"""The scenes: the same robot throughout, and one number that grows along each curve."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import crawler2d as c2d
from crawler2d import Scenario
from crawler2d.parameters.terrain import Lane
from crawler2d.parameters.track import Track, Wheel
from research.models import study_robot
from research.tables import group_by

WHEELS = (3, 6, 12, 24, 48, 96)
GROUSERS = (6, 12, 24, 48)
PIECES = (10, 100, 1_000, 10_000, 100_000)
ACCURACIES = (1e-7, 3e-7, 1e-6, 3e-6, 1e-5)
"""[m] Accuracies of the solver."""

FLAT, STEP = "flat ground", "step of 50 mm"
CUT, BLOCKS = "flat ground in pieces", "blocks in pieces"
LEVEL = "level"
"""Suffix of the curve whose pieces are level, and so are merged into one."""

_SHAPES: tuple[Wheel, ...] = (c2d.RoundWheel(), c2d.GearWheel())
# Three of such wheels just carry the Engineer, and 96 overlap.
_SMALL = c2d.CircumferentialWheels(24, wheel_radius=0.016)
# [m] Thin enough for 48 grousers on such a wheel.
_TIP_THICKNESS = 1e-3

# [s] 4 m at 0.4 m/s, including the acceleration; over the step and beyond.
# Long enough on ground in pieces to make the filling of caches by a new simulation negligible.
_DURATIONS = {FLAT: 11.0, STEP: 6.0, CUT: 11.0, BLOCKS: 6.0}

# [m] Extent of the ground in pieces.
_GROUND = (-1.0, 5.0)
# [m] Heights of the points; below 1e-9 m they would be read as one straight piece.
JITTER = 1e-7
# [m] Size of the blocks, the first right in front of the robot.
_BLOCK, _HEIGHT = 0.2, 0.03


class Point(NamedTuple):
    """One place on a curve of a figure."""

    figure: str
    panel: str
    curve: str
    x: float
    scenario: Scenario


def points() -> Iterator[Point]:
    """Yield every point of the study."""
    yield from _wheels()
    yield from _grousers()
    yield from _pieces()
    yield from _accuracies()


def panels(points: Iterable[Point]) -> dict[tuple[str, str], list[Point]]:
    """Group points by figure and panel, in their order."""
    return group_by(points, "figure", "panel")


def line_of_gears() -> Scenario:
    """Return the scene for the threads: a line of 3 gear wheels over the step."""
    return _over(c2d.LineOfWheels(3, wheel=c2d.GearWheel()), STEP)


def _wheels() -> Iterator[Point]:
    for panel, wheel in product((FLAT, STEP), _SHAPES):
        lines = {count: c2d.LineOfWheels(count, wheel=wheel) for count in WHEELS}
        yield from _curve("wheels", panel, f"line, {wheel.kind}", lines)
        small = replace(_SMALL, wheel=wheel)
        around = {count: replace(small, count=count) for count in WHEELS}
        yield from _curve("wheels", panel, f"circumferential, {wheel.kind}", around)


def _grousers() -> Iterator[Point]:
    gears = {count: c2d.GearWheel(grouser_count=count) for count in GROUSERS}
    thin = {count: replace(gear, tip_thickness=_TIP_THICKNESS) for count, gear in gears.items()}
    lines = {count: c2d.LineOfWheels(3, wheel=gear) for count, gear in gears.items()}
    around = {count: replace(_SMALL, wheel=gear) for count, gear in thin.items()}
    for panel in (FLAT, STEP):
        yield from _curve("grousers", panel, "line of 3", lines)
        yield from _curve("grousers", panel, "24 circumferential", around)


def _curve(figure: str, panel: str, name: str, tracks: Mapping[int, Track]) -> Iterator[Point]:
    for count, track in tracks.items():
        yield Point(figure, panel, name, count, _over(track, panel))


def _pieces() -> Iterator[Point]:
    tracks: dict[str, Track] = {
        "line of 3 round": c2d.LineOfWheels(3),
        "line of 3 gear": c2d.LineOfWheels(3, wheel=c2d.GearWheel()),
        "belt": c2d.BeltTrack(),
    }
    for name, track in tracks.items():
        whole = _on(track, c2d.terrains.from_points([(x, 0.0) for x in _GROUND], goal=0.0), CUT)
        yield Point("points", CUT, name, 1, whole)
        for count in PIECES:
            yield Point("points", CUT, name, count, _on(track, flat(count, JITTER), CUT))
        level = _on(track, flat(PIECES[-1], 0.0), CUT)
        yield Point("points", CUT, f"{name}, {LEVEL}", PIECES[-1], level)
    for name, track in tracks.items():
        # Ten pieces are too few for the blocks.
        for count in PIECES[1:]:
            yield Point("points", BLOCKS, name, count, _on(track, blocks(count), BLOCKS))


def _accuracies() -> Iterator[Point]:
    track = c2d.LineOfWheels(3, wheel=c2d.GearWheel())
    for panel in (FLAT, STEP):
        for accuracy in ACCURACIES:
            scenario = _over(track, panel).replace({"solver.accuracy": accuracy})
            yield Point("accuracy", panel, "line of 3 gear", accuracy, scenario)


@cache
def flat(count: int, jitter: float, seed: int = 0) -> Lane:
    """Cut flat ground into pieces of one length, with random heights of their ends.

    Parameters
    ----------
    count : int
        Number of pieces.
    jitter : float
        [m] Largest height, up or down.
    seed : int
        Seed of the heights.
    """
    x = np.linspace(*_GROUND, count + 1)
    return _ground(x, np.zeros(count + 1), jitter, seed)


@cache
def blocks(count: int, seed: int = 0) -> Lane:
    """Cut the tops of blocks of random heights into pieces of one length.

    Parameters
    ----------
    count : int
        Number of pieces, not counting the few vertical faces, which stay whole.
    seed : int
        Seed of the heights.
    """
    begins = np.arange(0.0, _GROUND[1], _BLOCK)
    heights = np.random.default_rng(seed).uniform(0.0, _HEIGHT, begins.size)
    tops = np.concatenate([[0.0], heights])
    x = np.unique(np.concatenate([np.linspace(*_GROUND, count + 1), begins]))
    # At the start of a block there are two points, one above the other.
    before, behind = (np.searchsorted(begins, x, side=side) for side in ("left", "right"))
    twice = np.column_stack([np.full(x.size, True), before != behind]).ravel()
    y = tops[np.column_stack([before, behind])].ravel()
    return _ground(np.repeat(x, 2)[twice], y[twice], JITTER, seed)


def _ground(x: NDArray[np.float64], y: NDArray[np.float64], jitter: float, seed: int) -> Lane:
    rough = y + np.random.default_rng(seed).uniform(-jitter, jitter, x.size)
    return c2d.terrains.from_points(np.column_stack([x, rough]), goal=0.0)


def _over(track: Track, panel: str) -> Scenario:
    terrain = c2d.terrains.flat() if panel == FLAT else c2d.terrains.step(0.05)
    return _on(track, terrain, panel)


def _on(track: Track, terrain: Lane, panel: str) -> Scenario:
    robot = study_robot(track=track)
    return Scenario(robot, terrain, duration=_DURATIONS[panel])
