"""Draw cells, and search for the height of each, first with a coarse setting, then a fine one."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from benches.accuracy.cells import KINDS, Cell, Kind, Setting, draw_obstacle, length_of, read, write
from benches.accuracy.runs import plan, simulate
from benches.shared.results import progress

RATES = (0.15, 0.85)
"""[-] Range of the rate of clearing that the search accepts."""
DRAWS = 12
"""Number of draws of a kind before it counts as one without such a height."""

# Settings of the search: while it is coarse, and to confirm.
_COARSE: Setting = {"accuracy": 1e-6}
_CONFIRM: Setting = {"accuracy": 3e-7}
# Runs per height, and number of equal outcomes after which a height is given up.
_RUNS = 40
_COARSE_RUNS = 24
_FIRST = 8
# [m] Heights are whole multiples of this.
_GRID = 1e-4
# [-] Range of the fine search above and below the coarse height, as a fraction of it.
_NEAR = 0.15
_LOOKS = 11


def draw(name: str, seed: int, attempt: int) -> Cell:
    """Draw a cell of a kind, without its height.

    Parameters
    ----------
    name : str
        Name in `KINDS`.
    seed, attempt : int
        Number of the set, and of the draw of this kind.
    """
    kind = KINDS[name]
    random = np.random.default_rng((seed, attempt, *name.encode()))
    shift, rise = random.uniform((-0.03, 0.0), (0.03, 0.03))
    torque = float(random.choice((6.0, 60.0)))
    friction, speed, angle = random.uniform((0.5, 0.2, -0.2), (0.95, 0.6, 0.8))
    obstacle = draw_obstacle(str(random.choice(kind.obstacles)), random)
    speed = round(float(speed), 2)
    return Cell(
        name=name,
        kind=name,
        center_of_mass=(round(float(shift), 3), round(0.02 + float(rise), 3)),
        max_torque=torque,
        friction=round(float(friction), 2),
        speed=speed,
        obstacle=obstacle,
        height=kind.heights[1],
        duration=_duration(kind, speed, obstacle),
        hold_angle=round(float(angle), 2) if kind.gait == "hold" else 0.0,
    )


def _duration(kind: Kind, speed: float, obstacle: Mapping[str, Any]) -> float:
    """[s] Twice the time of an unhindered robot, plus time to start, to stop and to move arms."""
    way = 0.7 + length_of(obstacle)
    return float(round(5.0 + (5.0 if kind.ends else 0.0) + 2.0 * way / speed))


def find(name: str, seed: int, threads: int | None, *, rotors: bool) -> Cell | None:
    """Draw cells of a kind until one has a height at which some runs clear and some do not.

    Returns
    -------
    Cell or None
        None if `DRAWS` draws have none.
    """
    for attempt in range(DRAWS):
        cell = replace(draw(name, seed, attempt), rotors=rotors)
        found = find_height(cell, threads)
        if found is not None:
            return replace(found, found={**found.found, "redrawn": attempt})
    return None


def find_height(cell: Cell, threads: int | None) -> Cell | None:
    """Search the height of a drawn cell."""

    def rate(height: float, setting: Setting, count: int) -> float:
        share, made = _rate(replace(cell, height=height), setting, count, threads)
        progress(f"{cell.name}: {1e3 * height:.1f} mm, {setting}: {share:.2f} of {made}")
        return share

    coarse = bisect(lambda h: rate(h, _COARSE, _COARSE_RUNS), *cell.what.heights)
    if coarse is None:
        return None
    low, high = (1.0 - _NEAR) * coarse[0], (1.0 + _NEAR) * coarse[0]
    fine = bisect(lambda h: rate(h, _CONFIRM, _RUNS), low, high)
    if fine is None:
        return None
    result = {"rate": round(fine[1], 3), "runs": _RUNS, "setting": dict(_CONFIRM)}
    return replace(cell, height=fine[0], found=result)


def bisect(rate: Callable[[float], float], low: float, high: float) -> tuple[float, float] | None:
    """Bisect until the rate in the middle of the interval is accepted.

    Rates need not decrease with the height; if they do not, bisection finds one of several heights.
    """
    for _ in range(_LOOKS):
        height = round(round(0.5 * (low + high) / _GRID) * _GRID, 6)
        share = rate(height)
        if RATES[0] <= share <= RATES[1]:
            return height, share
        if share > RATES[1]:
            low = height
        else:
            high = height
        if high - low < 1.5 * _GRID:
            return None
    return None


def _rate(cell: Cell, setting: Setting, count: int, threads: int | None) -> tuple[float, int]:
    """Return the rate of clearing and the number of runs, which is small if the first end alike."""
    # Other draws than those of the study, in which a cell found by chance must not have the same
    # luck.
    planned = plan(cell, setting, count, cell.seed + 1)
    cleared: list[bool] = []
    for part in filter(None, (range(min(_FIRST, count)), range(_FIRST, count))):
        cleared += [row.outcome == "cleared" for row in simulate(planned, part, threads)]
        if len(set(cleared)) == 1:
            break
    return sum(cleared) / len(cleared), len(cleared)


def complete_cells(
    path: Path, seed: int, names: Iterable[str], threads: int | None, *, rotors: bool
) -> list[str]:
    """Add a drawn cell of every kind that a set lacks, and write the set after each.

    Parameters
    ----------
    path : Path
        File of the set.
    seed : int
        Number of the set.
    names : iterable of str
        Kinds, names in `KINDS`.
    threads : int or None
        See `crawler2d.simulate_many`.
    rotors : bool
        Whether motors have the rotors of the preset.

    Returns
    -------
    list of str
        The kinds of which no draw has such a height.
    """
    without = []
    for name in names:
        cells = read(path)
        if any(cell.name == name for cell in cells):
            continue
        cell = find(name, seed, threads, rotors=rotors)
        if cell is None:
            without.append(name)
        else:
            write(path, [*cells, cell])
    return without
