"""Predictions of crawler2d, runs of all starts of all cells in the engines, and their tables."""

import json
from collections import Counter
from collections.abc import Iterable, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

from benches.adapters.ode_process import GAZEBO
from benches.adapters.robots import RobotModel
from benches.adapters.space import Engine, drive, load, scene_of
from benches.models.cases import CASES, Case
from benches.models.files import FILES, model_of
from benches.shared.results import Results, processes, read
from crawler2d import Robot, Scenario, audit, jams, simulate_many
from crawler2d.parameters.terrain import Flat
from crawler2d.variation.variability import of_start
from research.tables import markdown_table

_FOLDER = Path(__file__).parent
RESULTS, PREDICTIONS = _FOLDER / "results", _FOLDER / "predictions.json.xz"


def predict(case: Case, threads: int | None) -> dict[str, Any]:
    """Search for a repair under the conditions of a case, and simulate both robots from its starts.

    The search is over the cells at the speed of an audit.

    Returns
    -------
    dict
        By model, "original" and, where one was found, "repair": what it is, the robot in a scenario
        on level ground, and by cell one entry for each start: outcome, mechanism, and the last pose
        of the chassis frame [m, rad]; "runs" are those of the robot, "firm" those with motors that
        hold their speeds through impacts.
    """
    own = case.robot()
    usual = {label: cell for label, cell in case.cells.items() if cell.speed is None}
    grounds = {label: case.ground(cell, own) for label, cell in usual.items()}
    drive = case.drive(next(iter(usual.values())), own)
    found = audit(
        own, grounds, drive=drive, unknown={}, vary=of_start(), repeats=20, threads=threads
    )
    models = {"original": ("as it is", own, True)}
    repair = next((each for each in found.repairs if each.kind == "wheels"), None)
    if repair is not None:
        models["repair"] = (repair.description, repair.robot, repair.confirmed)
    return {
        name: {
            "what": what,
            "scenario": json.loads(Scenario(robot, Flat()).to_json()),
            "confirmed": confirmed,
            "runs": _by_cell(case, robot, threads),
            "firm": _by_cell(case, case.firm(robot), threads),
        }
        for name, (what, robot, confirmed) in models.items()
    }


def robot_of(entry: dict[str, Any]) -> Robot:
    """Return the robot of an entry of the predictions."""
    return Scenario.from_json(json.dumps(entry["scenario"])).robot


def _by_cell(case: Case, robot: Robot, threads: int | None) -> dict[str, Any]:
    return {label: _runs(case.scenarios(label, robot), threads) for label in case.cells}


def _runs(scenarios: list[Scenario], threads: int | None) -> list[dict[str, Any]]:
    runs = simulate_many(scenarios, record="summary", threads=threads)
    return [
        {
            "end": str(run.outcome),
            "mechanism": str(run.mechanism or ""),
            "x": round(run.metrics["final_x"], 4),
            "y": round(run.metrics["final_y"], 4),
            "angle": round(run.metrics["final_angle"], 4),
        }
        for run in runs
    ]


ENGINES: dict[str, tuple[str, dict[str, Any]]] = {
    "bullet": ("Bullet", {}),
    "bullet-pyramid": ("Bullet", {"is_cone": False}),
    "bullet-prisms": ("Bullet", {"is_round": False}),
    "dart": ("DART", {"time_step": 5e-4}),
    "dart-dantzig": ("DART", {"time_step": 5e-4, "sweeps": 0}),
    "ode-fine": ("ODE", {}),
    "ode": ("ODE", GAZEBO),
}
"""Bullet with true cylinders, with these and friction limited along and across, and with what its
readers make of cylinders by default; DART with Coulomb's law, and with its usual solver; ODE
finely, and as Gazebo classic sets it."""


def engine_of(name: str, time_step: float | None = None) -> Engine:
    """Return an engine, with its own time step or another one [s].

    Raises
    ------
    ImportError
        If it is not installed.
    """
    engine, setting = ENGINES[name]
    return load(engine, **setting | ({} if time_step is None else {"time_step": time_step}))


def run(
    engine: str,
    case: str,
    file: str,
    labels: Iterable[str],
    path: Path,
    *,
    starts: int,
    time_step: float | None,
    jobs: int,
) -> None:
    """Run a file of a case over cells, and add the results to a file.

    Starts that the file already has are not repeated, and labels of other cases are left out.
    """
    results = Results(path)
    robot = robot_of(read(PREDICTIONS)[case][FILES[file]])
    model = model_of(engine, case, file, robot)
    missing = []
    for label in (label for label in labels if label in CASES[case].cells):
        key = f"{case} | {file} | {label}"
        scenarios = CASES[case].scenarios(label, robot)[len(results.at(key)) : starts]
        missing += [((key,), scenario) for scenario in scenarios]
    with processes(jobs) as pool:
        results.add(missing, partial(_run, engine, time_step, model), pool)


def _run(
    engine: str, time_step: float | None, model: RobotModel, scenario: Scenario
) -> dict[str, Any]:
    result = drive(engine_of(engine, time_step), scenario, scene_of(scenario, model), digits=4)
    del result["heading"], result["cost"]
    return result


_KINDS = ("runs", "firm")


def summary(runs: Sequence[dict[str, Any]]) -> str:
    """Return the ends of runs, and the positions of the chassis frame of those that stopped [mm].

    Examples
    --------
    >>> summary([{"end": "seized", "x": -0.3372}] * 2 + [{"end": "cleared", "x": 0.56}])
    '2 seized at -337, 1 cleared'
    """
    words = []
    for end, count in Counter(run["end"] for run in runs).most_common():
        places = sorted(1e3 * run["x"] for run in runs if run["end"] == end)
        low, high = (f"{places[i]:.0f}" for i in (0, -1))
        at = f" at {low}" if low == high else f" at {low} to {high}"
        words.append(f"{count} {end}" + ("" if end == "cleared" else at))
    return ", ".join(words)


def agreement(predicted: Sequence[dict[str, Any]], found: Sequence[dict[str, Any]]) -> int:
    """Return the number of starts from which both or none clear."""
    pairs = zip(predicted, found, strict=False)
    return sum((a["end"] == "cleared") == (b["end"] == "cleared") for a, b in pairs)


def rows(results: dict[str, dict[str, Any]]) -> list[list[str]]:
    """Return a row for each cell that was run: description, predictions, and each engine."""
    predictions = read(PREDICTIONS)
    found = []
    for name, case in CASES.items():
        for label, cell in case.cells.items():
            for file in case.files:
                predicted = predictions[name][FILES[file]]["runs"][label]
                if not any(runs.get(f"{name} | {file} | {label}") for runs in results.values()):
                    continue
                firm = predictions[name][FILES[file]]["firm"][label]
                is_same = agreement(predicted, firm) == len(predicted)
                row = [name, f"{label}, {cell.friction:g}", file, summary(predicted)]
                row.append("the same" if is_same else summary(firm))
                for runs in results.values():
                    own = runs.get(f"{name} | {file} | {label}", [])
                    same = f" ({agreement(predicted, own)} of {len(own)})" if own else ""
                    row.append(summary(own) + same)
                found.append(row)
    return found


def counts(results: dict[str, dict[str, Any]]) -> list[list[str]]:
    """Return a row for each engine: in how many starts it agrees, by predicted outcome.

    First with the predictions written before, then with those for firm motors.
    """
    predictions = read(PREDICTIONS)
    found = []
    for engine, runs in results.items():
        same, of = Counter[tuple[str, bool]](), Counter[tuple[str, bool]]()
        for key, own in runs.items():
            name, file, label = key.split(" | ")
            for kind in _KINDS:
                predicted = predictions[name][FILES[file]][kind][label]
                for a, b in zip(predicted, own, strict=False):
                    cell = kind, a["end"] == "cleared"
                    of[cell] += 1
                    same[cell] += agreement([a], [b])
        cells = product(_KINDS, (False, True))
        found.append([engine, *(f"{same[cell]} of {of[cell]}" for cell in cells)])
    return found


_NEAR = 1e-3
"""[m] A stop this close to a jam along the ground is at it: Bullet separates bodies by 0.3 mm."""


def stops(results: dict[str, dict[str, Any]]) -> list[list[str]]:
    """Return a row for each engine: how many stops of the public files are at jams from `c2d.jams`.

    Flippers and wheels are as at the start, so jams follow from geometry and friction alone.
    """
    predictions = read(PREDICTIONS)
    places: dict[str, list[float]] = {}
    for name, case in CASES.items():
        robot = robot_of(predictions[name][FILES["public"]])
        for label in case.cells:
            found = jams(case.scenarios(label, robot)[0])
            places[f"{name} | public | {label}"] = [jam.position[0] for jam in found]
    rows = []
    for engine, runs in results.items():
        row = [engine]
        for name in CASES:
            there = of = 0
            for key, own in runs.items():
                if key.startswith(f"{name} | public | "):
                    stopped = [each["x"] for each in own if each["end"] == "stopped"]
                    of += len(stopped)
                    is_near = [any(abs(x - jam) < _NEAR for jam in places[key]) for x in stopped]
                    there += sum(is_near)
            row.append(f"{there} of {of}")
        rows.append(row)
    return rows


def parts(paths: Sequence[Path]) -> dict[str, str]:
    """Return the tables in Markdown, by name; results are named after their files."""
    results = {path.name.partition(".")[0]: read(path) for path in paths}
    header = ["robot", "cell, friction", "file", "crawler2d", "firm motors", *results]
    ends = ("predicted to stop", "predicted to clear")
    firm = (f"{end}, firm motors" for end in ends)
    return {
        "outcomes": markdown_table(header, rows(results)),
        "files": markdown_table(["engine", *ends, *firm], counts(results)),
        "stops": markdown_table(["stops at jams", *CASES], stops(results)),
    }
