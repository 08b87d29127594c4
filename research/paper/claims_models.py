"""Claims of the paper about the models themselves: geometry, computing time, shaking, odometry."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Climb, Drive
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.studies.riding import odometry, real_time_factor, ride
from research.paper.claim import Check, Claim
from research.paper.layouts import layouts
from research.paper.published import TABLE_1

if TYPE_CHECKING:
    from crawler2d.parameters.robot import Robot
    from research.paper.design import Work
    from research.paper.phases import Shaking

__all__ = ["costs", "geometry", "odometry_of_gears", "shaking_of_gears", "unevenness"]

_PAIRS = {"line of 3": "line of 3 gears", "16 all round, spaced": "16 gears all round, spaced"}
"""The paper's two layouts, with round wheels and with gears."""
_ALIKE = 0.9
"""[-] A real-time factor that is at least this share of another is none the worse for it."""
_STEP = 1e-3
"""[s] The time step that the paper's simulator takes by default."""
_SPAN = 5.0


def geometry() -> Claim:
    """Compare how far the lower runs of the layouts lie within the track as built; no run."""
    known, bare = layouts(), engineer(flippers=None)
    names = ("16 all round, spaced", "24 all round", "line of 3", "line of 5", "line of 9")
    uneven = {name: unevenness(known[name].on(bare)) for name in names}

    def nearer(all_round: str, line: str) -> Check:
        (deep, mean), (other_deep, other_mean) = uneven[all_round], uneven[line]
        return Check(
            what=f"the wheels {all_round} are nearer to the track than the {line}",
            found=f"{_mm(mean, 1)} off on average, {_mm(deep)} at most; {line}"
            f" {_mm(other_mean, 1)}, {_mm(other_deep)}",
            holds=mean < other_mean,
        )

    return Claim(
        section="2.2",
        text="small wheels all round have the greater similarity in geometry",
        experiment="mean gap between the wheels and the lower run of the track as built; no run",
        checks=tuple(
            nearer(*pair)
            for pair in (
                ("16 all round, spaced", "line of 3"),
                ("24 all round", "line of 5"),
                ("24 all round", "line of 9"),
            )
        ),
    )


def unevenness(robot: Robot) -> tuple[float, float]:
    """[m] Measure how deep the lower run of wheels lies within that of the track as built.

    Parameters
    ----------
    robot : Robot
        With wheels, and equal ends.

    Returns
    -------
    tuple of 2 floats
        Greatest and mean gap between the ground under the end axles and the wheels; where there is
        a slot, up to the belly.

    Examples
    --------
    Wheels of radius r that stand p apart leave r - sqrt(r^2 - p^2 / 4):

    >>> import crawler2d as c2d
    >>> deep, _ = unevenness(c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(5)))
    >>> round(1e3 * deep, 2), round(64 - (64**2 - (365 / 8) ** 2) ** 0.5, 2)
    (19.12, 19.12)
    """
    outline, wheels = robot.outline, robot.wheels()
    half = 0.5 * outline.axle_distance
    x = np.linspace(-half, half, 20001)
    belly = min((y for _, y in robot.belly or ()), default=math.inf)
    lowest = np.full_like(x, belly)
    for at, height, radius in zip(wheels["x"], wheels["y"], wheels["radius"], strict=True):
        inside = radius**2 - (x - at) ** 2
        bottom = height - np.sqrt(np.maximum(inside, 0.0))
        lowest = np.where(inside >= 0.0, np.minimum(lowest, bottom), lowest)
    gaps = lowest + outline.rear_radius
    return float(gaps.max()), float(gaps.mean())


def costs(work: Work) -> tuple[Claim, ...]:
    """Compare real-time factors: gears and round wheels, all round and in a line, and a chain."""
    names = [*_PAIRS, *_PAIRS.values(), "line of 9", "chain of 22 shoes"]
    found = {
        solver: _factors(work, names, fields)
        for solver, fields in (
            ("default accuracy", {}),
            ("steps of 1 ms", {"solver.time_step": _STEP}),
        )
    }

    def slower(slow: str, fast: str) -> tuple[Check, ...]:
        return tuple(
            Check(
                what=f"{slow} is slower than {fast} ({solver})",
                found=f"{factors[slow]:.0f} and {factors[fast]:.0f}",
                holds=factors[slow] < _ALIKE * factors[fast],
            )
            for solver, factors in found.items()
        )

    as_fast = tuple(
        Check(
            what=f"{gears} is as fast as {plain} ({solver})",
            found=f"{factors[gears]:.0f} and {factors[plain]:.0f}",
            holds=factors[gears] >= _ALIKE * factors[plain],
        )
        for solver, factors in found.items()
        for plain, gears in _PAIRS.items()
    )
    how = "real-time factors on level ground, no flippers, one thread of this machine"
    return (
        Claim(
            section="3",
            text="gears solve the problem without sacrificing computational performance",
            experiment=how,
            checks=as_fast,
        ),
        Claim(
            section="2.2",
            text="more wheels in a line cost performance",
            experiment=how,
            checks=slower("line of 9", "line of 3"),
        ),
        Claim(
            section="2.2, 3",
            text="small wheels all round are slower than a line of large ones",
            experiment=how,
            checks=(
                *slower("16 all round, spaced", "line of 3"),
                *slower("16 gears all round, spaced", "line of 3 gears"),
            ),
        ),
        Claim(
            section="2.3",
            text="segmental tracks have a low computational efficiency",
            experiment=how,
            checks=slower("chain of 22 shoes", "16 all round, spaced"),
        ),
    )


def shaking_of_gears(work: Work, shaken: Sequence[Shaking]) -> tuple[Claim, Claim]:
    """Judge the shaking of gears by the runs of eq. (1), and of round wheels beside."""
    by_place = {(each.count, round(6 * each.fraction)): each for each in shaken}
    third = []
    for count in (3, 5):
        step, turned, half = (by_place[count, sixths] for sixths in (0, 2, 3))
        told = f"{_mm(step.swing, 2)} in step, {_mm(turned.swing, 2)} at a third"
        third += [
            Check(
                what=f"{count} gears: a third at least halves the swing in height",
                found=told,
                holds=turned.swing <= 0.5 * step.swing,
            ),
            Check(
                what=f"{count} gears: a third swings less than a half",
                found=f"{_mm(turned.swing, 2)} at a third, {_mm(half.swing, 2)} at a half",
                holds=turned.swing < half.swing,
            ),
        ]
    known, bare = layouts(), engineer(flippers=None).without_rotors()
    models = {
        name: {"robot": known[name].on(bare)}
        for name in (*_PAIRS, *_PAIRS.values(), "belt with grousers")
    }
    base = Scenario(bare, terrains.flat(), drive=Drive(speed=TABLE_1.max_speed))
    how, repeats = work.sampling, work.design.driving_repeats
    found = work.counted(ride(base, models=models, repeats=repeats, **how))
    shakes = {name: found["vibration"].sel(model=name).item() for name in models}
    rough = tuple(
        Check(
            what=f"{gears} shake the robot on level ground",
            found=f"{shakes[gears]:.2f} m/s^2, round wheels {shakes[plain]:.2f}, a belt with"
            f" grousers {shakes['belt with grousers']:.2f}",
            holds=shakes[gears] > 10.0 * shakes[plain],
        )
        for plain, gears in _PAIRS.items()
    )
    return (
        Claim(
            section="3",
            text="gears shake the robot on a flat surface",
            experiment="vertical acceleration, root mean square, no flippers; shake: ten times as"
            " much as round wheels",
            checks=rough,
        ),
        Claim(
            section="3, eq. (1)",
            text="turning each gear by a third of theta avoids excessive shaking",
            experiment="swing of the chassis in height at 0.4 m/s on level ground",
            checks=tuple(third),
        ),
    )


def odometry_of_gears(work: Work) -> Claim:
    """Measure how far the odometry of gears is off, with the radius that the paper takes."""
    known, bare = layouts(), engineer(flippers=None).without_rotors()
    models = {name: {"robot": known[name].on(bare)} for pair in _PAIRS.items() for name in pair}
    base = Scenario(bare, terrains.flat(), drive=Drive(speed=TABLE_1.max_speed))
    how, repeats = work.sampling, work.design.driving_repeats
    found = work.counted(odometry(base, models=models, repeats=repeats, **how))
    errors = {name: found["odometry_error"].sel(model=name).item() for name in models}
    return Claim(
        section="3",
        text="the protrusions of gears complicate odometry",
        experiment="way by the circumscribed radius less the way of the robot, on level ground;"
        " complicate: by a thousandth or more",
        checks=tuple(
            Check(
                what=f"the odometry of {gears} is off",
                found=f"{1e2 * errors[gears]:+.2f} %, round wheels {1e2 * errors[plain]:+.2f} %",
                holds=abs(errors[gears]) >= 1e-3 > abs(errors[plain]),
            )
            for plain, gears in _PAIRS.items()
        ),
    )


def _factors(work: Work, names: Iterable[str], fields: Mapping[str, Any]) -> dict[str, float]:
    known, bare = layouts(), engineer(flippers=None).without_rotors()
    drive = Drive(speed=TABLE_1.max_speed, gait=Climb())
    base = Scenario(bare, terrains.flat(), drive=drive).replace(fields)
    models = {name: {"robot": known[name].on(bare)} for name in names}
    found = real_time_factor(
        base,
        models=models,
        duration=_SPAN,
        repeats=work.design.computing_repeats,
        progress=work.progress,
    )
    factors = found["factor"].sel(motion="driving")
    return {name: factors.sel(model=name).item() for name in models}


def _mm(length: float, digits: int = 0) -> str:
    return f"{1e3 * length:.{digits}f} mm"
