"""Pairs of runs of random robots in both engines, and in Chipmunk if their ends differ."""

import math
import warnings
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import crawler2d as c2d
from benches.adapters.space import drive, load
from benches.shared.measuring import quantiles
from benches.shared.results import Results, progress, read
from crawler2d import Run, Scenario, ScenarioError, Solver, wilson
from crawler2d.parameters.terrain import Terrain
from crawler2d.parameters.track import Track
from crawler2d.results.findings import Balance
from research.tables import group_by, table

MODELS = ("line", "row", "gears", "small wheels", "placed wheels", "free wheels")
"""Lines with gaps; rows that touch or overlap; gear wheels; small round wheels all round; wheels of
unlike radii; a force along the chassis on free wheels."""


def random_scenario(number: int) -> tuple[str, Scenario]:
    """Draw a robot and an obstacle that rapier can represent; the same number gives the same ones.

    The models take turns. Masses are 5 to 80 kg, axle distances 0.25 to 0.8 m, radii 0.12 to 0.24
    of these; obstacles are steps, barriers and ridges of 0.2 to 1.2 radii, friction 0.4 to 1.0.
    """
    model = MODELS[number % len(MODELS)]
    rng = np.random.default_rng([24, number])
    while True:
        scenario = _scenario(model, rng)
        try:
            scenario.replace({"solver": Solver(engine="rapier")}).validate()
        except ScenarioError:
            continue  # the next draws
        return model, scenario


def _scenario(model: str, rng: np.random.Generator) -> Scenario:
    length = float(rng.uniform(0.25, 0.8))
    radius = float(rng.uniform(0.12, 0.24)) * length
    mass = float(rng.uniform(5.0, 80.0))
    robot = c2d.Robot.simple(mass, axle_distance=length, radius=radius)
    x, y = robot.center_of_mass
    x += float(rng.uniform(-0.1, 0.1)) * length
    y += float(rng.uniform(0.0, 0.1)) * length
    sharing = str(rng.choice(["track", "wheel"]))
    torque = float(rng.uniform(0.2, 2.0)) * mass * 9.81 * radius
    robot = replace(robot, center_of_mass=(x, y), track=_track(model, rng, robot))
    if rng.random() < 0.5:
        robot = replace(robot, belly=None)
    height = float(rng.uniform(0.2, 1.2)) * radius
    friction = float(rng.uniform(0.4, 1.0))
    grounds: dict[str, Terrain] = {
        "step": c2d.terrains.step(height, friction=friction),
        "barrier": c2d.terrains.barrier(height, 0.5 * length, friction=friction),
        "ridge": c2d.terrains.ridge(height, float(rng.uniform(1.0, 2.0)), friction=friction),
    }
    ground = grounds[str(rng.choice(list(grounds)))]
    return Scenario(
        robot,
        ground,
        drive=c2d.Drive(speed=float(rng.uniform(0.05, 0.4))),
        start=c2d.Start(approach=float(rng.uniform(0.05, 0.05 + 0.25 * length))),
    ).replace({"robot.drivetrain.torque_sharing": sharing, "robot.drivetrain.max_torque": torque})


def _track(model: str, rng: np.random.Generator, robot: c2d.Robot) -> Track:
    outline = robot.outline
    length, radius = outline.axle_distance, outline.front_radius
    touching = 1 + math.ceil(length / (2.0 * radius))
    if model == "line":
        return c2d.LineOfWheels(int(rng.integers(2, touching + 1)))
    if model == "row":
        return c2d.LineOfWheels(touching + int(rng.integers(0, 4)))
    if model == "gears":
        return c2d.LineOfWheels(
            int(rng.integers(2, touching + 3)),
            wheel=c2d.GearWheel(
                grouser_count=int(rng.integers(7, 13)), grouser_height=0.18 * radius
            ),
        )
    if model == "small wheels":
        around = 2.0 * (math.pi * radius + length)
        return c2d.CircumferentialWheels(max(int(around / radius * rng.uniform(1.0, 1.6)), 14))
    if model == "placed wheels":
        count = int(rng.integers(1, 4))
        small = float(rng.uniform(0.4, 0.7)) * radius
        between = np.linspace(-0.5, 0.5, count + 2)[1:-1] * length
        ends = [(-0.5 * length, 0.0, radius), (0.5 * length, 0.0, radius)]
        return c2d.HybridWheels(
            (ends[0], *((float(x), small - radius, small) for x in between), ends[1])
        )
    return c2d.ForceTrack(support="wheels")


RESULTS = Path(__file__).with_name("results")
"""Folder of the results of all verbs."""

_FINER = {
    "own": Solver(accuracy=1e-8),
    "fixed": Solver(time_step=5e-5),
    "rapier": Solver(engine="rapier", time_step=3.125e-5),
}
"""A thirtieth of the default accuracy, short fixed steps, and a quarter of the default step."""


def run(robots: int, path: Path) -> None:
    """Run the pairs that a file does not have yet."""
    results = Results(path)
    missing = range(len(results.at("pairs")), robots)
    results.add(((("pairs",), number) for number in missing), _pair)


def _pair(number: int) -> dict[str, Any]:
    """Run a pair; if the ends differ, run it again, finer."""
    model, scenario = random_scenario(number)
    with warnings.catch_warnings(action="ignore", category=c2d.ScenarioWarning):
        check = c2d.simulate(scenario, record="summary", trials=None).cross_check()
        pair: dict[str, Any] = {
            "number": number,
            "model": model,
            "ends": [_end(check.run), _end(check.other)],
            "apart": check.distance,
            "turn": check.turn,
            "parted_at": check.parted_at,
            "balances": held(check.balances),
        }
        if len({end["gets_over"] for end in pair["ends"]}) == 2:
            pair["finer"] = finer(scenario)
    return pair


def _end(run: Run) -> dict[str, Any]:
    return {
        "outcome": str(run.outcome),
        "gets_over": run.outcome is c2d.Outcome.CLEARED,
        "stops": run.diagnosis is not None,
        "penetration": run.metrics["max_penetration"],
    }


def finer(scenario: Scenario) -> dict[str, str]:
    """Return the end of a scenario in each engine with finer settings."""
    solved = {name: scenario.replace({"solver": solver}) for name, solver in _FINER.items()}
    return {
        name: str(c2d.simulate(each, record="summary", trials=None).outcome)
        for name, each in solved.items()
    }


def held(balances: Iterable[Balance | None]) -> list[bool | None]:
    """Return which of the stops, if any, are equilibria."""
    return [None if balance is None else balance.holds for balance in balances]


def told(held: Iterable[bool | None]) -> str:
    """Write the result of `held`."""
    return ", ".join("yes" if holds else "no" for holds in held if holds is not None)


_CHIPMUNK = {"time_step": 5e-5, "iterations": 100}
"""A tenth of the fine step of benches/engines: steps at which impacts have converged there."""


def run_third(pairs: Path, path: Path) -> None:
    """Run pairs with different ends in Chipmunk, except those that exist."""
    results = Results(path)
    for number in (pair["number"] for pair in read_pairs(pairs) if "finer" in pair):
        if str(number) not in results.data:
            results.data[str(number)] = in_chipmunk(random_scenario(number)[1])
            results.save()
            progress(f"robot {number}: {results.data[str(number)]}")


def read_pairs(path: Path) -> list[dict[str, Any]]:
    """Read the pairs."""
    pairs: list[dict[str, Any]] = read(path, {"pairs": []})["pairs"]
    return pairs


def in_chipmunk(scenario: Scenario) -> str:
    """Return the end of a scenario in Chipmunk with fine steps."""
    try:
        return str(drive(load("Chipmunk", **_CHIPMUNK), scenario)["end"])
    except ScenarioError:  # a ridge, which is not drawn there
        return "not held"


_NEAR = 1e-3  # [m]
Pair = dict[str, Any]


def parts(pairs: Sequence[Pair], third: Mapping[str, str]) -> dict[str, str]:
    """Write the tables of a page, by name; a third engine's ends are by the robot's number."""
    return {"models": _by_model(pairs), "unlike": _unlike(pairs, third)}


def _by_model(pairs: Sequence[Pair]) -> str:
    groups = group_by(pairs, "model") | {"all": list(pairs)}
    return table(_row(name, groups.get(name, [])) for name in (*MODELS, "all"))


def _row(name: str, pairs: list[Pair]) -> dict[str, str]:
    alike = sum(_same(pair, "gets_over") for pair in pairs)
    named = sum(_same(pair, "outcome") for pair in pairs)
    stops = [pair for pair in pairs if all(end["stops"] for end in pair["ends"])]
    near = sum(pair["apart"] < _NEAR for pair in stops)
    unheld = [sum(pair["balances"][k] is False for pair in pairs) for k in (0, 1)]
    return {
        "model": name,
        "robots": str(len(pairs)),
        "same result": _rate(alike, len(pairs)),
        "same outcome": _rate(named, len(pairs)),
        "both stop": str(len(stops)),
        "within 1 mm": str(near),
        "distance of stops [mm]: median, 90th": quantiles([1e3 * pair["apart"] for pair in stops]),
        "rotation of stops [mrad]: median, 90th": quantiles(
            [1e3 * abs(pair["turn"]) for pair in stops]
        ),
        "no equilibrium: crawler2d, rapier": ", ".join(map(str, unheld)),
    }


def _same(pair: Pair, what: str) -> bool:
    one, other = (end[what] for end in pair["ends"])
    return bool(one == other)


def _rate(count: int, of: int) -> str:
    if not of:
        return ""
    found = wilson(count, of)
    return f"{count} ({100 * found.low:.0f} to {100 * found.high:.0f} %)"


def _unlike(pairs: Sequence[Pair], third: Mapping[str, str]) -> str:
    return table(
        {
            "robot": str(pair["number"]),
            "model": pair["model"],
            "own": pair["ends"][0]["outcome"],
            "own, finer": pair["finer"]["own"],
            "own, fixed steps": pair["finer"]["fixed"],
            "rapier": pair["ends"][1]["outcome"],
            "rapier, finer": pair["finer"]["rapier"],
            "Chipmunk": third.get(str(pair["number"]), ""),
            "the stop is an equilibrium": told(pair["balances"]),
            "rapier sinks in by [mm]": f"{1e3 * pair['ends'][1]['penetration']:.2g}",
        }
        for pair in pairs
        if "finer" in pair
    )
