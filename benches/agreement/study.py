"""The cells of the seizure study that rapier can represent, in both engines with the same draws.

Where their ends differ, round wheels are repeated one by one, gears and small wheels over many
starts; and 24 wheels meet a knife edge.
"""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import crawler2d as c2d
from benches.adapters.space import drive, load
from benches.agreement.pairs import finer, held, in_chipmunk, told
from benches.shared.measuring import quantiles
from benches.shared.results import Results, progress, read, write
from crawler2d import Scenario, Solver, Start, newcombe_paired
from crawler2d.parameters.track import Track
from research import models
from research.models import study_robot
from research.seizure import FULL
from research.stops import STOPS
from research.tables import cells_of, group_by, markdown_table, table

_ENGINES = ["own", "rapier"]


def study(repeats: int, path: Path) -> None:
    """Run the cells of every obstacle in both engines."""
    robot = study_robot()
    results = Results(path, [])
    for obstacle, heights in list(FULL.heights.items())[len(results.data) :]:
        base = _on(robot, obstacle, heights[0])
        over = {
            "robot.track": _tracks(),
            "terrain.height": list(heights),
            "solver.engine": _ENGINES,
        }
        results.data.append(_cells(obstacle, c2d.sweep(base, over, repeats=repeats)))
        results.save()


def read_cells(path: Path) -> list[dict[str, Any]]:
    """Read the results of each cell."""
    return [cell for part in read(path) for cell in part]


def at_height(model: str, obstacle: str, height: float) -> Scenario:
    """Return the scenario of a cell, before its draws."""
    return _on(study_robot().with_track(_tracks()[model]), obstacle, height)


def _on(robot: c2d.Robot, obstacle: str, height: float) -> Scenario:
    return Scenario(robot, models.obstacle(obstacle, height), drive=c2d.Drive(speed=0.4))


def _tracks() -> dict[str, Track]:
    """List the models that rapier holds on one motor for all wheels, as the study has them."""
    in_rapier = _on(study_robot(), "step", 0.05).replace({"solver": Solver(engine="rapier")})
    held = {}
    for name, model in models.study_models().items():
        try:
            in_rapier.replace({"robot.track": model.track}).validate()
        except c2d.ScenarioError:
            continue
        held[name] = model.track
    return held


def _cells(obstacle: str, table: Any) -> list[dict[str, Any]]:
    """Keep outcomes and last poses, by model and height."""
    cells = []
    for place in cells_of(table, "track", "height"):
        pair = [table.sel(place | {"engine": engine}) for engine in _ENGINES]
        poses = [np.stack([each[name].values for name in ("final_x", "final_y")]) for each in pair]
        cells.append(
            {
                "obstacle": obstacle,
                "model": place["track"],
                "height": place["height"],
                "ends": [each["outcome"].values.tolist() for each in pair],
                "apart": np.hypot(*(poses[1] - poses[0])).tolist(),
            }
        )
    return cells


def study_table(found: list[Any]) -> str:
    """Write by model how many runs ended alike, and the distances of stops."""
    cells = [cell for part in found for cell in part]
    groups = group_by(cells, "model") | {"all": cells}
    return table(_study_row(*group) for group in groups.items())


def study_percentages(cells: list[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """Return by model the fraction of runs [%] that clear in each engine, and that end alike."""
    found = {}
    for model, mine in group_by(cells, "model").items():
        own, other = (
            np.array([end == "cleared" for cell in mine for end in cell["ends"][k]]) for k in (0, 1)
        )
        percent = {
            "get over in crawler2d": own,
            "get over in rapier": other,
            "end alike": own == other,
        }
        found[model] = {name: 100.0 * float(of.sum()) / len(of) for name, of in percent.items()}
    return found


def _study_row(name: str, cells: list[dict[str, Any]]) -> dict[str, str]:
    runs = [
        (own, other, apart)
        for cell in cells
        for own, other, apart in zip(*cell["ends"], cell["apart"], strict=True)
    ]
    stops = [1e3 * apart for own, other, apart in runs if own in STOPS and other in STOPS]
    gets = [(own == "cleared", other == "cleared") for own, other, _ in runs]
    return {
        "model": name,
        "runs": str(len(runs)),
        "same result": str(sum(own == other for own, other in gets)),
        "same outcome": str(sum(own == other for own, other, _ in runs)),
        "clears: crawler2d, rapier": f"{sum(o for o, _ in gets)}, {sum(o for _, o in gets)}",
        "difference of rates [%]": _gap([(other, own) for own, other in gets]),
        "both stop": str(len(stops)),
        "distance of stops [mm]: median, 90th": quantiles(stops),
    }


def one_by_one(study: Path, path: Path) -> None:
    """Repeat runs of lines of round wheels whose ends differ, one by one, also with finer steps."""
    results = Results(path, [])
    results.data = []
    results.save()
    for cell in read_cells(study):
        ends = list(zip(*cell["ends"], strict=True))
        unlike = [k for k, end in enumerate(ends) if end.count("cleared") == 1]
        if not unlike or not _is_round_line(cell["model"]):
            continue
        base = at_height(cell["model"], cell["obstacle"], cell["height"])
        draws = _draws(base, cell["height"], len(ends))
        for k in unlike:
            drawn = base.replace({field: v[k] for field, v in draws.items()})
            results.data.append(_again(cell, k, drawn))
            results.save()
            progress(
                f"{cell['model']}, {cell['obstacle']} of {1e3 * cell['height']:.0f} mm, run {k}"
            )


def _is_round_line(model: str) -> bool:
    return model.startswith("line") and "gear" not in model


def _draws(base: Scenario, height: float, repeats: int) -> dict[str, list[float]]:
    """Return the draws of a sweep by path; they depend only on the repeat."""
    table = c2d.sweep(base, {"terrain.height": [height]}, repeats=repeats)
    drawn = [column for name, column in table.data_vars.items() if str(name).startswith("drawn_")]
    return {column.attrs["path"]: column.values.ravel().tolist() for column in drawn}


def _again(cell: dict[str, Any], number: int, scenario: Scenario) -> dict[str, Any]:
    with warnings.catch_warnings(action="ignore", category=c2d.ScenarioWarning):
        check = c2d.simulate(scenario, record="summary", trials=None).cross_check()
        return {
            **{name: cell[name] for name in ("model", "obstacle", "height")},
            "run": number,
            "own": str(check.run.outcome),
            "rapier": str(check.other.outcome),
            "finer": finer(scenario),
            "Chipmunk": in_chipmunk(scenario),
            "holds": held(check.balances),
        }


def one_by_one_table(found: list[Any]) -> str:
    """Write these runs, one per row."""
    head = (
        *("model", "obstacle", "mm", "own", "own, finer", "own, steps of 0.05 ms", "rapier"),
        *("rapier, finer", "Chipmunk", "the stop is an equilibrium"),
    )
    rows = [
        (
            *(each["model"], each["obstacle"], f"{1e3 * each['height']:.0f}"),
            *(each["own"], each["finer"]["own"], each["finer"]["fixed"]),
            *(each["rapier"], each["finer"]["rapier"], each["Chipmunk"]),
            told(each["holds"]),
        )
        for each in found
    ]
    return markdown_table(head, rows)


_CHIPMUNK_USUAL = {"time_step": 5e-4, "iterations": 100}


def who_gets_over(
    scenarios: Sequence[Scenario], solvers: Mapping[str, Solver]
) -> dict[str, list[bool]]:
    """Return in which scenarios the robot clears with each solver, and in Chipmunk."""
    gets = {
        name: [_gets_over(scenario.replace({"solver": solver})) for scenario in scenarios]
        for name, solver in solvers.items()
    }
    chipmunk = load("Chipmunk", **_CHIPMUNK_USUAL)
    ends = [drive(chipmunk, scenario)["end"] for scenario in scenarios]
    return gets | {"Chipmunk": [end == "cleared" for end in ends]}


def counts(gets_over: Mapping[str, list[bool]]) -> dict[str, str]:
    """Write how many clear, by solver."""
    return {name: f"{sum(each)} of {len(each)}" for name, each in gets_over.items()}


def _gets_over(scenario: Scenario) -> bool:
    with warnings.catch_warnings(action="ignore", category=c2d.ScenarioWarning):
        run = c2d.simulate(scenario, record="summary", trials=None)
    return run.outcome is c2d.Outcome.CLEARED


_ENSEMBLE_SOLVERS = {
    "own": Solver(),
    "own, finer": Solver(accuracy=3e-8),
    "rapier": Solver(engine="rapier"),
}
"""The default accuracy and a tenth of it, and rapier's usual step."""
_APPROACH = 0.1  # [m]
_PITCH = 0.048  # [m] of the Engineer's grousers


def ensembles(starts: int, study: Path, path: Path) -> None:
    """Run cells with different ends from starts spread evenly over a grouser pitch.

    Nothing else is drawn, so the pairs differ only in how the robot meets the edge.
    """
    results = Results(path, [])
    there = [_key(each) for each in results.data]
    for cell in read_cells(study):
        if _key(cell) in there or not _has_unequal_ends(cell):
            continue
        base = at_height(cell["model"], cell["obstacle"], cell["height"])
        spread = _PITCH * (np.arange(starts) + 0.5) / starts
        over = [base.replace({"start": Start(approach=float(a))}) for a in _APPROACH + spread]
        gets = who_gets_over(over, _ENSEMBLE_SOLVERS)
        results.data.append({**{name: cell[name] for name in _KEY}, "gets_over": gets})
        results.save()
        progress(f"{_key(cell)}: {[sum(each) for each in gets.values()]} of {starts}")


_KEY = ("model", "obstacle", "height")


def _key(cell: dict[str, Any]) -> tuple[Any, ...]:
    return tuple(cell[name] for name in _KEY)


def _has_unequal_ends(cell: dict[str, Any]) -> bool:
    own, other = ([end == "cleared" for end in ends] for ends in cell["ends"])
    return own != other


def ensembles_table(found: list[Any]) -> str:
    """Write how many runs of each cell clear, and the differences of the rates."""
    return table(
        {
            "model": cell["model"],
            "obstacle": cell["obstacle"],
            "mm": f"{1e3 * cell['height']:.0f}",
            **counts(cell["gets_over"]),
            **{
                f"{name} less own [%]": _gap(
                    list(zip(cell["gets_over"][name], cell["gets_over"]["own"], strict=True))
                )
                for name in ("rapier", "Chipmunk")
            },
        }
        for cell in found
    )


def _gap(pairs: Sequence[tuple[bool, bool]]) -> str:
    """[%] Write the interval of the first rate of clearing minus the second."""
    kinds = (True, True), (True, False), (False, True), (False, False)
    gap = newcombe_paired(*(pairs.count(kind) for kind in kinds))
    return f"{100 * gap.low:+.0f} to {100 * gap.high:+.0f}"


_PINCHED_SOLVERS = {
    "own": Solver(),
    "own, fixed steps": Solver(time_step=5e-5),
    "own, restitution 0.5": Solver(restitution=0.5),
    "own, restitution 1": Solver(restitution=1.0),
    "rapier": Solver(engine="rapier"),
}
_HEIGHTS = (0.02, 0.04, 0.06)  # [m]
_SPEEDS = (0.4, 0.05)  # [m/s]
_SPREAD = 0.03  # [m] over which the starts are drawn
_SEED = 3


def pinched(starts: int, path: Path) -> None:
    """Run 24 wheels on a knife edge that gets between two of them, solved in six ways."""
    rng = np.random.default_rng(_SEED)
    found = []
    for height in _HEIGHTS:
        for speed in _SPEEDS:
            starting = _APPROACH + _SPREAD * rng.random(starts)
            over = [_on_knife_edge(height, speed, float(approach)) for approach in starting]
            gets = who_gets_over(over, _PINCHED_SOLVERS)
            found.append({"height": height, "speed": speed, "gets_over": gets})
            progress(f"knife edge of {1e3 * height:.0f} mm at {speed} m/s")
    write(path, found)


def _on_knife_edge(height: float, speed: float, approach: float) -> Scenario:
    small_wheels = study_robot(track=c2d.CircumferentialWheels(24))
    base = _on(small_wheels, "knife edge", height)
    return base.replace({"drive.speed": speed, "start.approach": approach})


def pinched_table(found: list[Any]) -> str:
    """Write how many runs of each cell clear."""
    return table(
        {
            "knife edge [mm]": f"{1e3 * cell['height']:.0f}",
            "speed [m/s]": str(cell["speed"]),
            **counts(cell["gets_over"]),
        }
        for cell in found
    )
