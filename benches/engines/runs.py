"""Predictions of crawler2d, and runs in engines: of cells, with finer steps, faster, and timed."""

import hashlib
import json
import math
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import crawler2d
from benches.adapters.ode_process import GAZEBO
from benches.adapters.own import simulated
from benches.adapters.space import Engine, drive, load, scene_of
from benches.engines.cells import Cell
from benches.shared.results import Results, progress, read, read_text, write_text
from crawler2d import Outcome, Scenario, Solver

Run = Mapping[str, Any]
Runs = Mapping[str, Sequence[Run]]
"""Runs by the label of their cell, in the order of their draws."""

_FOLDER = Path(__file__).parent
RESULTS, PREDICTIONS = _FOLDER / "results", _FOLDER / "predictions.json.xz"

_NEAR = 1e-3  # [m] between equal stops
_BULLET: Mapping[str, Any] = {"time_step": 1.0 / 240.0, "iterations": 50, "is_default": True}
_GZ: Mapping[str, Any] = {"time_step": 1e-3, "sweeps": 0}


@dataclass(frozen=True, slots=True)
class Entry:
    """A column of the comparison.

    Parameters
    ----------
    what : str
        The engine and its setting, in words.
    is_fine : bool
        Whether the setting is as fine as it was found to converge.
    in_space : bool
        Whether it has three dimensions.
    starts : int
        Runs of a cell unless another number is asked for, by their cost.
    engine : str
        Name for `load`; crawler2d itself if empty.
    setting : mapping
        Keywords for `load`.
    """

    what: str
    is_fine: bool
    in_space: bool
    starts: int
    engine: str = ""
    setting: Mapping[str, Any] = field(default_factory=dict)


ENGINES: dict[str, Entry] = {
    "pymunk": Entry("Chipmunk, finely", True, False, 8, "Chipmunk"),
    "rapier": Entry("crawler2d's second backend", True, False, 3),
    "ode": Entry("ODE as Gazebo classic sets it", False, True, 8, "ODE", GAZEBO),
    "ode-fine": Entry("ODE, finely", True, True, 3, "ODE"),
    "bullet": Entry("Bullet as PyBullet sets it", False, True, 6, "Bullet", _BULLET),
    "bullet-fine": Entry("Bullet, finely", True, True, 3, "Bullet"),
    "dart": Entry("DART as gz-sim sets it", False, True, 3, "DART", _GZ),
    "dart-fine": Entry("DART with Coulomb's law", True, True, 1, "DART"),
}
"""The columns, in the order in which they run."""

FINE = tuple(name for name, entry in ENGINES.items() if entry.is_fine)


def _ladder(what: str, *settings: tuple[float, int]) -> dict[str, Mapping[str, Any]]:
    """Return settings of an engine by name, given steps [ms] and iterations."""
    return {
        f"{step:g} ms, {many} {what}": {"time_step": 1e-3 * step, what: many}
        for step, many in settings
    }


Ladders = dict[str, tuple[str, dict[str, Mapping[str, Any]]]]
LADDERS: Ladders = {
    "pymunk": ("Chipmunk", _ladder("iterations", (1, 30), (0.5, 60), (0.25, 60), (0.125, 120))),
    "ode": (
        "ODE",
        {"Gazebo classic": GAZEBO}
        | _ladder("iterations", (1, 100), (0.5, 150), (0.25, 300), (0.125, 300)),
    ),
    "bullet": (
        "Bullet",
        {"PyBullet": _BULLET} | _ladder("iterations", (2, 100), (1, 200), (0.5, 200), (0.25, 400)),
    ),
    "dart": (
        "DART",
        {"gz-sim": _GZ, "0.25 ms, Dantzig": {"time_step": 2.5e-4, "sweeps": 0}}
        | _ladder("sweeps", (1, 100), (1, 300), (0.5, 300)),
    ),
}
"""Engine and settings by name, the finest last."""

_SHORT_STEPS = (0.5, 60), (0.1, 100), (0.05, 100), (0.02, 100), (0.01, 100), (0.01, 300)
FINER: Ladders = {"pymunk": ("Chipmunk", _ladder("iterations", *_SHORT_STEPS))}
"""Settings for stops that a robot passes by momentum."""


_STOPS = {"stopped", *(str(outcome) for outcome in Outcome if outcome.is_stop)}


def both_stop(one: Run, other: Run) -> bool:
    """Whether both runs end with a stop, in crawler2d or in an engine.

    Examples
    --------
    >>> both_stop({"end": "seized"}, {"end": "stopped"})
    True
    >>> both_stop({"end": "seized"}, {"end": "tipped over"})
    False
    """
    return {one["end"], other["end"]} <= _STOPS


def cleared(runs: Iterable[Run]) -> int:
    """Count the runs that clear.

    Examples
    --------
    >>> cleared([{"end": "cleared"}, {"end": "stopped"}, {"end": "seized"}])
    1
    """
    return sum(run["end"] == "cleared" for run in runs)


def holds(name: str, cell: Cell) -> bool:
    """Whether an engine can represent a cell.

    A ground that is not the same across needs three dimensions. The limit of one motor a track
    needs gears between wheels, which only Chipmunk has here.
    """
    return not cell.is_coupled if ENGINES[name].in_space else cell.is_even


def engine_of(name: str) -> Engine:
    """Return an engine of `ENGINES` other than rapier, which is crawler2d's.

    Raises
    ------
    ImportError
        If it is not installed.
    """
    return load(ENGINES[name].engine, **ENGINES[name].setting)


def run_in(engine: Engine, scenario: Scenario, *scene: Any) -> dict[str, Any]:
    """Run a scenario in an engine, without its contacts: robots here have no flippers."""
    result = drive(engine, scenario, *scene)
    del result["touches"], result["bend"]
    return result


def predict(cells: Sequence[Cell], path: Path = PREDICTIONS) -> None:
    """Write the predictions of crawler2d before the engines run: the runs of each cell, by draw."""
    lines = []
    for number, cell in enumerate(cells, 1):
        runs = [simulated(scenario) for scenario in cell.scenarios()]
        for run in runs:
            del run["cost"]  # differs each time
        lines.append(f"{json.dumps(cell.label)}: {json.dumps(runs)}")
        progress(f"{number} of {len(cells)}: {cell.label}")
    version, body = json.dumps(crawler2d.__version__), ",\n".join(lines)
    write_text(path, f'{{"version": {version}, "cells": {{\n{body}\n}}}}\n')


def predictions(path: Path = PREDICTIONS) -> dict[str, list[dict[str, Any]]]:
    """Read the predicted runs by cell."""
    runs: dict[str, list[dict[str, Any]]] = read(path)["cells"]
    return runs


def hash_of(path: Path = PREDICTIONS) -> str:
    """Return the SHA-256 of the predictions, as they are before compression.

    Raises
    ------
    FileNotFoundError
        If nothing was predicted.
    """
    return hashlib.sha256(read_text(path).encode("utf-8")).hexdigest()


def compare_predictions(path: Path, kept: Path = PREDICTIONS) -> str:
    """Count the runs of another file that end differently from those of the stored one."""
    before, now = predictions(kept), predictions(path)
    lines = []
    for wheels, has_gears in (("round wheels", False), ("gear wheels", True)):
        both = [
            pair
            for label, runs in now.items()
            if ("gears" in label) is has_gears
            for pair in zip(before[label], runs, strict=True)
        ]
        clears = sum((one["end"] == "cleared") != (two["end"] == "cleared") for one, two in both)
        ends = sum(one["end"] != two["end"] for one, two in both)
        stops = [pair for pair in both if both_stop(*pair)]
        far = sum(distance(one, two) > _NEAR for one, two in stops)
        lines.append(
            f"{wheels}, {len(both)} runs: {clears} clear in one of both, {ends} have another "
            f"outcome; {far} of {len(stops)} that stop in both do so more than 1 mm apart"
        )
    return "\n".join(lines)


def distance(one: Run, other: Run) -> float:
    """[m] Return the distance between the last positions of two runs."""
    return math.hypot(one["x"] - other["x"], one["y"] - other["y"])


def pairs(cells: Iterable[Cell], predicted: Runs, runs: Runs) -> Iterator[tuple[Cell, Run, Run]]:
    """Yield the cell, the predicted and the engine's run of each draw that an engine has run."""
    for cell in cells:
        for one, other in zip(predicted[cell.label], runs.get(cell.label, ()), strict=False):
            if not other["end"].startswith("refused"):
                yield cell, one, other


def check(cells: Sequence[Cell], results: Mapping[str, Any], path: Path = PREDICTIONS) -> str:
    """Return the hash of the predictions, if runs may be added to results.

    Raises
    ------
    ValueError
        If there are none, a cell has none, or the results were made for others.
    """
    if not path.exists():
        raise ValueError(f"{path.name} is missing: predict before an engine runs")
    now = hash_of(path)
    if results and results["predictions"] != now:
        raise ValueError(f"the results are for predictions {results['predictions'][:12]}")
    missing = {cell.label for cell in cells} - predictions(path).keys()
    if missing:
        raise ValueError(f"not predicted: {min(missing)}")
    return now


def run(
    name: str, cells: Sequence[Cell], starts: int, executor: Executor, folder: Path = RESULTS
) -> None:
    """Add runs of cells to the results of an engine, the first start of all cells first.

    Raises
    ------
    ValueError
        If the cells are not predicted, or the results are for other predictions.
    """
    results = Results(folder / f"{name}.json.xz")
    now = check(cells, results.data)
    try:
        _, version = _runner(name)
    except ImportError as error:
        progress(f"{name} is left out: {error}")
        return
    results.data = results.data or {"predictions": now, "engine": version, "runs": {}}
    runs = {cell.label: results.at("runs", cell.label) for cell in cells if holds(name, cell)}
    missing = [
        (("runs", cell.label), cell.scenarios(start + 1)[start])
        for start in range(starts)
        for cell in cells
        if cell.label in runs and len(runs[cell.label]) <= start
    ]
    results.add(missing, partial(_run_by_name, name), executor)


def _run_by_name(name: str, scenario: Scenario) -> dict[str, Any]:
    """Run in any process."""
    return _runner(name)[0](scenario)


def _runner(name: str) -> tuple[Callable[[Scenario], dict[str, Any]], str]:
    """Return a function that runs a scenario, and its version."""
    if name in ("crawler2d", "rapier"):
        engine = None if name == "crawler2d" else name
        return partial(simulated, engine=engine), f"{name}, through crawler2d"
    loaded = engine_of(name)
    return partial(run_in, loaded), loaded.version


def _complete(
    results: Results,
    keys: Sequence[str],
    scenarios: Sequence[Scenario],
    one_run: Callable[[Scenario], dict[str, Any]],
) -> None:
    """Add the runs of some scenarios that are missing under some keys."""
    runs = results.at(*keys)
    results.add([(keys, scenario) for scenario in scenarios[len(runs) :]], one_run)
    progress(f"{', '.join(keys)}: {cleared(runs)} of {len(runs)} clear")


def converge(
    name: str, cells: Sequence[Cell], starts: int, path: Path, *, is_jam: bool = False
) -> None:
    """Run cells at all settings of an engine's ladder."""
    engine, settings = (FINER if is_jam else LADDERS)[name]
    results = Results(path)
    for setting, keywords in settings.items():
        for cell in cells:
            one_run = partial(run_in, load(engine, **keywords))
            _complete(results, (name, setting, cell.label), cell.scenarios(starts), one_run)


SPEEDS = (0.02, 0.05, 0.1, 0.2, 0.3, 0.4)
"""[m/s]"""

_DISTANCE = 2.0  # [m] driven in the longest time
_WAIT = 5.0  # [s] longer, so that a stop is seen


def accelerate(cell: Cell, engines: Sequence[str], starts: int, path: Path) -> None:
    """Run a cell at each speed, in crawler2d and in engines."""
    results = Results(path)
    for name in ("crawler2d", *engines):
        for speed in SPEEDS:
            change = {"drive.speed": speed, "duration": round(_DISTANCE / speed + _WAIT, 1)}
            scenarios = [scenario.replace(change) for scenario in cell.scenarios(starts)]
            keys = cell.label, name, f"{speed:g}"
            _complete(results, keys, scenarios, partial(_run_by_name, name))


_ACCURACY = 3e-8  # [m] a tenth of the default
_FINER_RAPIER = Solver(engine="rapier", time_step=2e-5)
_STAYS = 0.02  # [m] from the pose of a stop


def refine(cells: Sequence[Cell], engines: Sequence[str], folder: Path, most: int) -> None:
    """Repeat runs that differ, at the finest setting of the ladder and at a tenth of the accuracy.

    Only on grounds that are the same across: on others the third dimension makes a difference.
    Where crawler2d stops on round wheels and the engine does not, the engine also starts from rest
    in the pose of that stop: if it stays there, the stop is one in its mechanics, too, and the two
    differ in how the robot reached it. How gear wheels are turned then is not known.

    Parameters
    ----------
    cells : sequence of Cell
        Which to look at.
    engines : sequence of str
        Names of fine ones.
    folder : Path
        Of the results.
    most : int
        Runs of a cell and an engine at most.
    """
    results = Results(folder / "refined.json.xz")
    predicted = predictions()
    for name in engines:
        ladder = LADDERS.get(name.removesuffix("-fine"))
        before = read(folder / f"{name}.json.xz")
        if before is None or (ladder is None and name != "rapier"):
            continue
        engine = None if ladder is None else load(ladder[0], **[*ladder[1].values()][-1])
        for cell in (cell for cell in cells if cell.is_even):
            refined = results.data.setdefault(name, {}).setdefault(cell.label, {})
            scenarios = cell.scenarios()
            for number, (_, one, other) in enumerate(pairs([cell], predicted, before["runs"])):
                differs = (one["end"] == "cleared") != (other["end"] == "cleared")
                if not differs or str(number) in refined or len(refined) >= most:
                    continue
                scenario = scenarios[number]
                own = simulated(scenario.replace({"solver.accuracy": _ACCURACY}))
                again = (
                    simulated(scenario.replace({"solver": _FINER_RAPIER}))
                    if engine is None
                    else run_in(engine, scenario)
                )
                ends = [one["end"], other["end"], own["end"], again["end"]]
                refined[str(number)] = [*ends, _from_stop(engine, cell, scenario, one)]
                progress(f"{name}, {cell.label}: {', '.join(refined[str(number)])}")
                results.save()


def _from_stop(engine: Engine | None, cell: Cell, scenario: Scenario, stop: Run) -> str:
    """Return whether an engine "stays" in or "leaves" the pose of a stop, or "" without a stop.

    rapier, which crawler2d starts as the scenario says, is not asked.
    """
    if engine is None or "gears" in cell.model:
        return ""
    if stop["end"] not in ("seized", "stalled", "slipping", "hung_up"):
        return ""
    scene = replace(scene_of(scenario), x=stop["x"], z=stop["y"], angle=stop["angle"])
    end = run_in(engine, scenario, scene)
    return "stays" if end["end"] == "stopped" and distance(end, stop) < _STAYS else "leaves"


MODELS_TIMED = ("line of 3", "5 gears", "24 all round")
_REPEATS, _ENOUGH = 3, 20.0  # runs, or [s] after which there are no more


def time_engines(path: Path) -> None:
    """Time runs of three models over an edge in every engine that is here, the best of up to three.

    A run's time contains building its world, and in ODE starting the process.
    """
    results = Results(path)
    for model in MODELS_TIMED:
        cell = Cell("plane", "engineer", model, "60 N m, servos", "step", height=0.04, friction=1.0)
        (scenario,) = cell.scenarios(1)
        for name in ("crawler2d", *ENGINES):
            try:
                one_run, _ = _runner(name)
            except ImportError:
                continue
            times: list[float] = []
            begin = time.perf_counter()
            while len(times) < _REPEATS and time.perf_counter() - begin < _ENOUGH:
                times.append(one_run(scenario)["cost"])
            results.data.setdefault(name, {})[model] = min(times)
            progress(f"{name}, {model}: {min(times):g} s a simulated second")
            results.save()
