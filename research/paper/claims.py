"""All claims of the paper, each with the experiment that tests it here, or why none can."""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, NamedTuple

import numpy as np

import crawler2d as c2d
from crawler2d.common.bodies import belly_corners
from crawler2d.parameters.terrain import Terrain
from crawler2d.sweeps.figure_dataset import FigureDataset
from research.models import study_robot
from research.paper import TABLE_1
from research.paper.design import PRESET, STRONG, Setting, Work, climb, layouts, models_of
from research.paper.figures import Shaking
from research.paper.performance import measure_factors
from research.tables import markdown_table, mm

_OFTEN, _SELDOM = 0.9, 0.1
"""[-] A model clears an obstacle at rates from the first on, and does not up to the second."""
_ALIKE = 0.9
"""[-] Smallest ratio at which a real-time factor counts as no lower than another one."""
_STEP = 1e-3
"""[s] The default time step of the paper's simulator."""
_FIELD = "random step field"
_HEIGHT = 0.04
"""[m] Height of the sharp edges; all these models clear a wide step of this height."""
_PAIRS = {"line of 3": "line of 3 gears", "16 all round, spaced": "16 gears all round, spaced"}
"""The paper's two layouts, with round wheels and with gears."""
_SLOWER = "slower than"
_COSTS = (
    (
        "3",
        "gears solve the problem without sacrificing computational performance",
        "as fast as",
        [(gears, wheels) for wheels, gears in _PAIRS.items()],
    ),
    ("2.2", "more wheels in a line cost performance", _SLOWER, [("line of 9", "line of 3")]),
    (
        "2.2, 3",
        "small wheels all round are slower than a line of large ones",
        _SLOWER,
        [("16 all round, spaced", "line of 3"), ("16 gears all round, spaced", "line of 3 gears")],
    ),
    (
        "2.3",
        "segmental tracks have a low computational efficiency",
        _SLOWER,
        [("chain of 22 shoes", "16 all round, spaced")],
    ),
)
"""Claims about computing time: section, text, and relation of the first model to the second."""


class _Count(NamedTuple):
    """Number of runs of a model that cleared."""

    label: str
    cleared: int
    runs: int

    @property
    def rate(self) -> float:
        return self.cleared / self.runs if self.runs else math.nan

    def __str__(self) -> str:
        return f"{self.label} {self.cleared} of {self.runs}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One condition that must be true if the claim holds."""

    what: str
    result: str
    """The figures, with counts."""
    holds: bool | None
    """Whether it is true; None if there are too few runs to say."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A claim with its checks."""

    section: str
    """Section of the paper."""
    text: str
    experiment: str
    checks: tuple[Check, ...] = ()
    """The conditions; None if the claim cannot be tested here."""

    @property
    def verdict(self) -> str:
        """Whether it holds; in part, if only some of the checks do.

        Examples
        --------
        >>> yes, no, open = (Check(what="", result="", holds=each) for each in (True, False, None))
        >>> for checks in ((yes, yes), (no,), (yes, no), (open, no), ()):
        ...     print(Claim(section="", text="", experiment="", checks=checks).verdict)
        holds
        does not hold
        holds in part
        not shown
        cannot be tested here
        """
        held = [check.holds for check in self.checks]
        if not held:
            return "cannot be tested here"
        if all(held):
            return "holds"
        if any(held):
            return "holds in part"
        return "not shown" if None in held else "does not hold"


_NOT_HERE = (
    Claim(
        section="4, Table 3",
        text="the models turn at 2 to 4 revolutions a minute, the robot at 8.5",
        experiment="a side view has no turning",
    ),
    Claim(
        section="4.1.1",
        text="models with gears correspond to the real robot's dynamics and geometry better",
        experiment="no run of the real robot is given to compare with, but four figures; Table 3"
        " has them",
    ),
    Claim(
        section="2.3",
        text="segmental tracks are of low stability",
        experiment="stability of a simulator is one of its engine and its steps: chains of this"
        " project's own engine say nothing of others",
    ),
)


def check_clears(
    what: str, counts: Iterable[tuple[str, int, int]], *, never: bool = False
) -> Check:
    """Check that every model clears in at least 90 % of the runs, or in at most 10 %.

    Parameters
    ----------
    what : str
        The condition.
    counts : iterable of str, int and int
        Label, number of cleared runs and number of all runs of each model.
    never : bool
        Whether the models must not clear.

    Examples
    --------
    >>> check_clears("gears clear", [("3 gears", 18, 20), ("5 gears", 0, 20)]).result
    '3 gears 18 of 20, 5 gears 0 of 20'
    """
    models = [_Count(*each) for each in counts]
    holds = all(each.rate <= _SELDOM if never else each.rate >= _OFTEN for each in models)
    return Check(what=what, result=", ".join(map(str, models)), holds=holds)


def check_fewer(what: str, less: tuple[str, int, int], more: tuple[str, int, int]) -> Check:
    """Check that one model clears less often than another, by Newcombe's 95 % interval.

    It does not if its rate is no lower; there are too few runs to say if the interval contains 0.

    Parameters
    ----------
    what : str
        The condition.
    less, more : tuple of str, int and int
        Label, number of cleared runs and number of all runs.

    Examples
    --------
    >>> check = check_fewer("heavier sticks more", ("heavy", 2, 20), ("light", 15, 20))
    >>> check.holds, check.result
    (True, 'heavy 2 of 20, light 15 of 20: difference -0.65 (-0.81 to -0.35)')
    """
    difference, low, high = c2d.newcombe(*less[1:], *more[1:])
    counts = f"{_Count(*less)}, {_Count(*more)}"
    return Check(
        what=what,
        result=f"{counts}: difference {difference:+.2f} ({low:+.2f} to {high:+.2f})",
        holds=True if high < 0.0 else None if difference < 0.0 else False,
    )


def claims(work: Work, shaken: Sequence[Shaking]) -> list[Claim]:
    """Test every claim by runs.

    Parameters
    ----------
    work : Work
        How runs are made.
    shaken : sequence of Shaking
        The results for eq. (1).
    """
    print("Claims", flush=True)
    return [
        gears_end_seizure(work),
        _chains_stick(work),
        _mass_sticks(work),
        *_lines_are_flat(work),
        force_is_flat(work),
        geometry(),
        *_costs(work),
        *shaking_of_gears(work, shaken),
        _odometry_of_gears(work),
        *_NOT_HERE,
    ]


def gears_end_seizure(work: Work) -> Claim:
    """Drive round wheels and gears over edges of two thicknesses, with strong motors."""
    pairs = {
        "line of 3": "line of 3 gears",
        "line of 5": "line of 5 gears",
        "24 all round": "24 gears all round",
        "16 all round, spaced": "16 gears all round, spaced",
    }
    edges = {
        f"{mm(thickness)} mm": c2d.terrains.knife_edge(_HEIGHT, thickness=thickness)
        for thickness in (0.002, 0.010)
    }
    belt = "belt with grousers"
    runs = _cross(work, STRONG, edges, [*pairs, *pairs.values(), belt])
    checks = []
    for edge in edges:
        for wheels, gears in pairs.items():
            check = check_clears(f"{gears} clear an edge {edge} thick", [_count(runs, gears, edge)])
            both = f"{check.result}; round wheels: {_count(runs, wheels, edge)}"
            checks.append(replace(check, result=both))
    belts = ", ".join(str(_count(runs, belt, edge, edge)) for edge in edges)
    return Claim(
        section="3, 4.1.1",
        text="gears end seizure on sharp edges",
        experiment=f"edges {mm(_HEIGHT)} mm high, no flippers, {STRONG.max_torque:g} N m a"
        f" sprocket; a belt with grousers clears {belts}",
        checks=tuple(checks),
    )


def force_is_flat(work: Work) -> Claim:
    """Push a robot with a force on flat and other ground, and compare it with a belt."""
    grounds: Mapping[str, Terrain] = {
        "flat": c2d.terrains.flat(),
        "slope of 35 deg": c2d.terrains.ramp(TABLE_1.declared_max_slope),
        "step of 60 mm": c2d.terrains.step(0.06),
        "edge of 40 mm": c2d.terrains.knife_edge(_HEIGHT),
    }
    names = ("belt", "force on skids", "force on wheels")
    runs = _cross(work, PRESET, grounds, names)
    checks = []
    for ground in grounds:
        belt, *forces = (_count(runs, name, ground) for name in names)
        off = max(abs(each.rate - belt.rate) for each in forces)
        alike = ground == "flat"
        checks.append(
            Check(
                what=f"{ground}: {'as' if alike else 'unlike'} the belt",
                result=", ".join(map(str, (belt, *forces))),
                holds=off <= 0.1 if alike else off > 0.5,
            )
        )
    return Claim(
        section="2.1",
        text="a robot driven by a mere force is realistic on flat ground alone",
        experiment="no flippers, the preset; unlike: a rate that differs by more than a half",
        checks=tuple(checks),
    )


def geometry() -> Claim:
    """Compare how far the lower runs of layouts are inside the track as built, without runs."""
    known, bare, checks = layouts(), study_robot(), []
    for all_round, line in (
        ("16 all round, spaced", "line of 3"),
        ("24 all round", "line of 5"),
        ("24 all round", "line of 9"),
    ):
        deep, mean = unevenness(known[all_round].on(bare))
        other_deep, other_mean = unevenness(known[line].on(bare))
        checks.append(
            Check(
                what=f"the wheels {all_round} are nearer to the track than the {line}",
                result=f"{mm(mean, 1)} mm off on average, {mm(deep)} mm at most; {line}"
                f" {mm(other_mean, 1)} mm, {mm(other_deep)} mm",
                holds=mean < other_mean,
            )
        )
    return Claim(
        section="2.2",
        text="small wheels all round have the greater similarity in geometry",
        experiment="mean gap between the wheels and the lower run of the track as built; no run",
        checks=tuple(checks),
    )


def unevenness(robot: c2d.Robot) -> tuple[float, float]:
    """[m] Measure the depth of the lower run of wheels inside that of the track as built.

    Parameters
    ----------
    robot : Robot
        A robot with wheels and equal ends.

    Returns
    -------
    tuple of 2 floats
        Largest and mean gap between the ground under the end axles and the wheels, or up to the
        belly in a slot.

    Examples
    --------
    Wheels of radius r at a distance p leave r - sqrt(r^2 - p^2 / 4):

    >>> import crawler2d as c2d
    >>> deep, _ = unevenness(c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(5)))
    >>> round(1e3 * deep, 2), round(64 - (64**2 - (365 / 8) ** 2) ** 0.5, 2)
    (19.12, 19.12)
    """
    outline, wheels = robot.outline, robot.wheels()
    half = 0.5 * outline.axle_distance
    x = np.linspace(-half, half, 20001)
    belly = belly_corners(robot.belly)[:, 1]
    lowest = np.full_like(x, belly.min(initial=math.inf))
    for at, height, radius in zip(wheels["x"], wheels["y"], wheels["radius"], strict=True):
        inside = radius**2 - (x - at) ** 2
        bottom = height - np.sqrt(np.maximum(inside, 0.0))
        lowest = np.where(inside >= 0.0, np.minimum(lowest, bottom), lowest)
    gaps = lowest + outline.rear_radius
    return float(gaps.max()), float(gaps.mean())


def shaking_of_gears(work: Work, shaken: Sequence[Shaking]) -> tuple[Claim, Claim]:
    """Compare the vibration of gears in the runs of eq. (1), and with that of round wheels."""
    by_place = {(each.count, round(6 * each.fraction)): each for each in shaken}
    third = []
    for count in (3, 5):
        step, turned, half = (by_place[count, sixths] for sixths in (0, 2, 3))
        swings = f"{mm(step.swing, 2)} mm in step, {mm(turned.swing, 2)} mm at a third"
        third += [
            Check(
                what=f"{count} gears: a third at least halves the swing in height",
                result=swings,
                holds=turned.swing <= 0.5 * step.swing,
            ),
            Check(
                what=f"{count} gears: a third swings less than a half",
                result=f"{mm(turned.swing, 2)} mm at a third, {mm(half.swing, 2)} mm at a half",
                holds=turned.swing < half.swing,
            ),
        ]
    runs = _drive_level(work, c2d.studies.ride, [*_PAIRS, *_PAIRS.values(), "belt with grousers"])
    shakes = runs["vibration"].to_series().to_dict()
    rough = tuple(
        Check(
            what=f"{gears} shake the robot on level ground",
            result=f"{shakes[gears]:.2f} m/s^2, round wheels {shakes[wheels]:.2f}, a belt with"
            f" grousers {shakes['belt with grousers']:.2f}",
            holds=shakes[gears] > 10.0 * shakes[wheels],
        )
        for wheels, gears in _PAIRS.items()
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


def claims_text(claims: Sequence[Claim]) -> str:
    """List the claims with their verdicts."""
    rows = [
        (str(number), claim.text, f"**{claim.verdict}**") for number, claim in enumerate(claims, 1)
    ]
    return markdown_table(("no.", "claim", "verdict"), rows)


def checks_text(claims: Sequence[Claim]) -> str:
    """List the experiment and the checks behind each verdict."""
    verdicts = {True: "yes", False: "no", None: "not shown"}
    rows = []
    for number, claim in enumerate(claims, 1):
        rows.append((str(number), f"section {claim.section}: {claim.experiment}", "", ""))
        rows += [
            (str(number), check.what, verdicts[check.holds], check.result) for check in claim.checks
        ]
    head = ("claim", "experiment, then what it must show", "shown", "found")
    return f"Counts are runs that cleared of all.\n\n{markdown_table(head, rows)}"


def _chains_stick(work: Work) -> Claim:
    """Drive a chain over small sharp edges, which fit between its shoes."""
    heights = (0.005, 0.010, 0.020, 0.040)
    edges = {
        f"{1e3 * height:.0f} mm": c2d.terrains.knife_edge(height, thickness=0.002)
        for height in heights
    }
    chain, *others = ("chain of 22 shoes", "belt with grousers")
    checks = []
    for setting in (PRESET, STRONG):
        runs = _cross(work, setting, edges, [chain, *others])
        own = runs.sel(model=chain)
        ends = own["outcome"].to_numpy()
        pinched = int((own["mechanism"].to_numpy() == "pinched").sum())
        stuck = int((own["jammed"].to_numpy() & (ends != "cleared")).sum())
        counts = ", ".join(str(_count(runs, chain, edge, edge)) for edge in edges)
        checks.append(
            Check(
                what=f"some runs of the chain end in a jam ({setting.max_torque:g} N m)",
                result=f"{stuck} of {ends.size} jammed, {pinched} pinched between shoes; cleared:"
                f" {counts}",
                holds=stuck > 0,
            )
        )
    return Claim(
        section="2.3",
        text="a chain sticks when a sharp or small obstacle gets between its segments",
        experiment="edges 2 mm thick and 5 to 40 mm high, no flippers, chain of 22 shoes",
        checks=tuple(checks),
    )


def _cross(
    work: Work, setting: Setting, grounds: Mapping[str, Any], names: Sequence[str]
) -> FigureDataset:
    """Drive layouts without flippers over several grounds."""
    models = models_of(names, setting, flippers=False)
    return work.success_rate(grounds, models, work.design.claim_repeats)


def _count(runs: FigureDataset, model: str, ground: str, label: str = "") -> _Count:
    own = runs.sel(model=model, terrain=ground)
    cleared = int((own["outcome"].to_numpy() == "cleared").sum())
    return _Count(label or model, cleared, own["count"].item())


def _mass_sticks(work: Work) -> Claim:
    """Drive lines of round wheels over step fields with twice the mass and stronger motors."""
    names = ("line of 3", "line of 5")
    motors = replace(PRESET, max_torque=2.0 * PRESET.max_torque)
    models = models_of(names, motors)
    for name in names:
        light = models[name]["robot"]
        models[f"{name}, twice the mass"] = {"robot": _heavier(light, 1.0)}
        models[f"{name}, twice mass and torque"] = {"robot": _heavier(light, 2.0)}
    runs = _over_fields(work, models, motors.friction)
    return Claim(
        section="2.2",
        text="a heavy robot sticks more on a line of wheels",
        experiment=f"random step fields, flippers, {motors.max_torque:g} N m a sprocket",
        checks=tuple(
            check_fewer(
                f"{name}: {what} clears less",
                _count(runs, f"{name}, {what}", _FIELD),
                _count(runs, name, _FIELD),
            )
            for what in ("twice the mass", "twice mass and torque")
            for name in names
        ),
    )


def _over_fields(work: Work, models: Mapping[str, Any], friction: float) -> FigureDataset:
    """Drive robots over the fields of Table 2."""
    field = {_FIELD: c2d.terrains.random_stepfield(friction=friction)}
    return work.success_rate(field, models, work.design.field_repeats)


def _heavier(robot: c2d.Robot, motors: float) -> c2d.Robot:
    """Double all masses of a robot, and multiply the torque of all its motors by a factor."""
    arms = robot.flippers
    return replace(
        robot,
        mass=2.0 * robot.mass,
        moment_of_inertia=2.0 * robot.moment_of_inertia,
        track_mass=2.0 * robot.track_mass,
        drivetrain=replace(robot.drivetrain, max_torque=motors * robot.drivetrain.max_torque),
        flippers=None
        if arms is None
        else replace(arms, mass=2.0 * arms.mass, torque_limit=motors * arms.torque_limit),
    )


def _odometry_of_gears(work: Work) -> Claim:
    """Measure the error of the odometry of gears with the radius that the paper uses."""
    runs = _drive_level(
        work, c2d.studies.odometry, [name for pair in _PAIRS.items() for name in pair]
    )
    errors = runs["odometry_error"].to_series().to_dict()
    return Claim(
        section="3",
        text="the protrusions of gears complicate odometry",
        experiment="way by the circumscribed radius less the way of the robot, on level ground;"
        " complicate: by a thousandth or more",
        checks=tuple(
            Check(
                what=f"the odometry of {gears} is off",
                result=f"{1e2 * errors[gears]:+.2f} %, round wheels {1e2 * errors[wheels]:+.2f} %",
                holds=abs(errors[gears]) >= 1e-3 > abs(errors[wheels]),
            )
            for wheels, gears in _PAIRS.items()
        ),
    )


def _drive_level(work: Work, study: Any, names: Sequence[str]) -> FigureDataset:
    """Drive layouts without flippers over level ground."""
    base = c2d.Scenario(
        study_robot(), c2d.terrains.flat(), drive=c2d.Drive(speed=TABLE_1.max_speed)
    )
    repeats, models = work.design.driving_repeats, models_of(names, flippers=False)
    runs: FigureDataset = study(base, models=models, repeats=repeats, **work.sampling)
    return work.count(runs)


def _lines_are_flat(work: Work) -> tuple[Claim, Claim]:
    """Drive lines of 3, 5 and 9 round wheels over step fields, with two kinds of motors."""
    names = ("line of 3", "line of 5", "line of 9")
    more, flat = [], []
    for setting in (PRESET, STRONG):
        runs = _over_fields(work, models_of(names, setting), setting.friction)
        counts = [_count(runs, name, _FIELD) for name in names]
        motors = f"{setting.max_torque:g} N m"
        more.append(check_fewer(f"3 wheels clear less than 9 ({motors})", counts[0], counts[-1]))
        flat += [
            check_clears(f"{count.label} does not clear ({motors})", [count], never=True)
            for count in counts
        ]
    return (
        Claim(
            section="2.2",
            text="more wheels in a line solve the sticking in part",
            experiment="random step fields, flippers, round wheels; what they cost is below",
            checks=tuple(more),
        ),
        Claim(
            section="2.2",
            text="lines of wheels are suitable only for flat ground",
            experiment="the same runs",
            checks=tuple(flat),
        ),
    )


def _costs(work: Work) -> list[Claim]:
    """Compare real-time factors: gears and round wheels, all round and in a line, and a chain."""
    names = {name for *_, pairs in _COSTS for pair in pairs for name in pair}
    models = models_of(sorted(names), flippers=False)
    base = climb(c2d.terrains.flat(), flippers=False)
    solvers = {
        "default accuracy": base,
        "steps of 1 ms": base.replace({"solver.time_step": _STEP}),
    }
    factors = {}
    for name, scenario in solvers.items():
        measured = measure_factors(work, scenario, models)["factor"].sel(motion="driving")
        factors[name] = measured.to_series().to_dict()

    def compare(one: str, other: str, solver: str, relation: str) -> Check:
        ours, theirs = factors[solver][one], factors[solver][other]
        return Check(
            what=f"{one} is {relation} {other} ({solver})",
            result=f"{ours:.0f} and {theirs:.0f}",
            holds=(ours < _ALIKE * theirs) == (relation == _SLOWER),
        )

    return [
        Claim(
            section=section,
            text=text,
            experiment="real-time factors on level ground, no flippers, one thread of this machine",
            checks=tuple(
                compare(*pair, solver, relation) for pair, solver in product(pairs, solvers)
            ),
        )
        for section, text, relation, pairs in _COSTS
    ]
