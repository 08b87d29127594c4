"""Studies over steps: chains of shoes, their accuracy, and the Engineer with flippers."""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray

import crawler2d as c2d
from crawler2d.drawings.palette import look_of
from crawler2d.sweeps.rates import rates_of
from research import seizure
from research.figures import draw_rates, make_panels
from research.models import FRICTION, StudyModel, study_models, study_robot
from research.paper import TABLE_3
from research.seizure_tables import Cell, cells, rates_text, rates_title, write_runs
from research.study import Job, Study
from research.tables import aligned_table, group_by, mm

if TYPE_CHECKING:
    from matplotlib.figure import Figure

CHAINS_FULL = replace(
    seizure.FULL, heights={"step": tuple(0.01 * tens for tens in range(3, 17))}, repeats=40
)
"""Steps of 30 to 160 mm."""
CHAINS_QUICK = replace(seizure.QUICK, heights={"step": (0.06, 0.10)}, repeats=4)
_TRACKS = 4
"""Number of models in the left panel of the figure."""

_ACCURACIES = (1e-7, 3e-7, 1e-6, 3e-6, 1e-5)
"""[m] Accuracies of the solver."""
_CHAIN_HEIGHTS = (0.11,)
"""[m] Heights of the steps; the chain of 22 shoes clears about a third of the runs."""
# [s] Duration of the run on flat ground, and time from which its speed is steady.
_FLAT, _STEADY = 10.0, 3.0

_FLIPPER_HEIGHTS = tuple(0.02 * step for step in range(2, 21))
"""[m] Of the steps."""
# Models whose wheels have a size or position that fits only the robot's outline.
_WITHOUT = ("hybrid", "hybrid gears", "line of 4, touching", "16 all round, spaced")


@dataclass(frozen=True, slots=True, kw_only=True)
class ChainStep:
    """Results of the chain with one accuracy of the solver."""

    accuracy: float
    """[m]"""
    step: float
    """[s] Mean time step of all runs over the steps."""
    flat_gap: float
    """[m] Largest gap of a pin on flat ground."""
    gap: float
    """[m] Largest gap of a pin in all runs over the steps."""
    lowest: float
    """[m] Lowest and highest position of the chassis frame on flat ground."""
    highest: float
    cleared: tuple[tuple[float, float, float], ...]
    """[-] Rate of clearing with Wilson's 95 % interval, for each height."""
    cost: float
    """[s] Wall time per simulated second, all runs over the steps together."""


@dataclass(frozen=True, slots=True, kw_only=True)
class HighestStep:
    """The highest step that a robot clears with one track model."""

    robot: str
    model: str
    height: float
    """[m] The highest step cleared by at least half of the runs; 0 if there is none."""
    gaps: int
    """Number of lower steps cleared by fewer runs."""
    limit: str
    """Commonest outcome of the other runs at the next step."""
    paper: float | None
    """[m] Value of the paper for models of this kind; None if it has none."""


def chain_models() -> Mapping[str, StudyModel]:
    """List the models to compare with chains, all with the Engineer's grousers.

    Returns
    -------
    mapping of str to StudyModel
        Tracks first, then wheels.
    """
    finer = StudyModel(c2d.SegmentalTrack(shoe_count=44), "ours")
    known = study_models() | {"chain of 44 shoes": finer}
    tracks = ("belt with grousers", "chain of 22 shoes", "chain of 44 shoes")
    return {name: known[name] for name in (*tracks, "line of 3 gears", "24 gears all round")}


def plot_chains(cells: Sequence[Cell]) -> Figure:
    """Draw the rates with their intervals: all tracks, then the wheels with the first track.

    Parameters
    ----------
    cells : sequence of Cell
        Heights ascending within a model; four tracks, then up to two models of wheels.
    """
    figure, ((left, right),) = make_panels(1, 2, (9.0, 3.8), sharex=True, sharey=True)
    by_model = group_by(cells, "model")
    models = list(by_model)
    for ax, shown in ((left, models[:_TRACKS]), (right, [models[0], *models[_TRACKS:]])):
        for model in shown:
            line = {"markersize": 4.5, "linewidth": 1.6, "label": model}
            draw_rates(ax, by_model[model], alpha=0.13, **look_of(models.index(model)), **line)
        ax.set(xlabel="height of the step [mm]", ylim=(-4.0, 104.0))
        ax.legend(fontsize="small", loc="upper right")
    left.set_ylabel("cleared [%]")
    figure.suptitle(rates_title(cells))
    return figure


def chain_steps(
    heights: Sequence[float] = _CHAIN_HEIGHTS,
    accuracies: Sequence[float] = _ACCURACIES,
    **sampling: Any,
) -> list[ChainStep]:
    """Run the Engineer's chain of 22 shoes on flat ground and steps, with the same draws.

    Parameters
    ----------
    heights : sequence of float
        [m] Heights of the steps.
    accuracies : sequence of float
        [m] Of the solver.
    **sampling
        Repeats, seed and threads; see `sweep`.

    Returns
    -------
    list of ChainStep
        One for each of `accuracies`.
    """
    robot = study_robot(track=c2d.SegmentalTrack(shoe_count=22))
    drive = c2d.Drive(speed=0.4)
    base = c2d.Scenario(robot, c2d.terrains.step(heights[0], friction=FRICTION), drive=drive)
    over: dict[Any, Any] = {"solver.accuracy": list(accuracies), "terrain.height": list(heights)}
    table = c2d.sweep(base, over, wall_time=True, **sampling)
    level = c2d.Scenario(robot, c2d.terrains.flat(friction=FRICTION), drive=drive, duration=_FLAT)
    rides = c2d.simulate_many(
        [level.replace({"solver.accuracy": accuracy}) for accuracy in accuracies],
        threads=sampling.get("threads"),
    )
    rates = rates_of(table)
    rows = []
    for accuracy, ride in zip(accuracies, rides, strict=True):
        own, climbed = table.sel(accuracy=accuracy), rates.sel(accuracy=accuracy)
        simulated = own["time"].sum().item()
        height = ride.position[ride.time > _STEADY, 1]
        figures = (climbed[name].to_numpy().tolist() for name in ("rate", "low", "high"))
        rows.append(
            ChainStep(
                accuracy=accuracy,
                step=simulated / own["steps"].sum().item(),
                flat_gap=ride.metrics["max_pin_gap"],
                gap=own["max_pin_gap"].max().item(),
                lowest=float(np.min(height)),
                highest=float(np.max(height)),
                cleared=tuple(zip(*figures, strict=True)),
                cost=own["wall_time"].sum().item() / simulated,
            )
        )
    return rows


def chain_steps_text(rows: Sequence[ChainStep], heights: Sequence[float] = _CHAIN_HEIGHTS) -> str:
    """Write one row per accuracy."""
    return aligned_table(
        {
            "accuracy [um]": f"{1e6 * row.accuracy:g}",
            "step [ms]": f"{1e3 * row.step:.2f}",
            "gap, flat [um]": f"{1e6 * row.flat_gap:.1f}",
            "gap, steps [um]": f"{1e6 * row.gap:.0f}",
            "height, flat [mm]": f"{mm(row.lowest, 2)} to {mm(row.highest, 2)}",
            **{
                f"cleared {mm(height)} mm": f"{rate:.2f} ({low:.2f} to {high:.2f})"
                for height, (rate, low, high) in zip(heights, row.cleared, strict=True)
            },
            "cost [ms/s]": f"{1e3 * row.cost:.0f}",
        }
        for row in rows
    )


def flipper_robots() -> dict[str, c2d.Robot]:
    """List the robots: without flippers, with front flippers, driven backwards, with both."""
    built = study_robot("built")
    arms = built.flippers
    if arms is None:
        raise AssertionError("the preset has flippers")
    return {
        "no flippers": study_robot(),
        "in front": built,
        "behind": study_robot(replace(arms, ends="rear")),
        "both ends": study_robot(replace(arms, ends="both")),
    }


def highest_steps(
    heights: Sequence[float] = _FLIPPER_HEIGHTS,
    models: Mapping[str, StudyModel] | None = None,
    **sampling: Any,
) -> list[HighestStep]:
    """Run every robot with every track model over steps, with the gait `Climb`.

    Parameters
    ----------
    heights : sequence of float
        [m] Heights of the steps, ascending.
    models : mapping of str to StudyModel, optional
        The models; by default those of the study that flippers can have.
    **sampling
        Repeats, seed and threads; see `sweep`.

    Returns
    -------
    list of HighestStep
        One per robot and model.
    """
    if models is None:
        models = {name: model for name, model in study_models().items() if name not in _WITHOUT}
    over: dict[Any, Any] = {
        "robot.track": {name: model.track for name, model in models.items()},
        "terrain.height": list(heights),
    }
    rows = []
    for name, robot in flipper_robots().items():
        drive = c2d.Drive(speed=0.4, gait=None if robot.flippers is None else c2d.Climb())
        base = c2d.Scenario(robot, c2d.terrains.step(heights[0], friction=FRICTION), drive=drive)
        table = c2d.sweep(base, over, on_error="record", **sampling)
        often = rates_of(table)["rate"] >= 0.5
        for label, model in models.items():
            cleared = np.flatnonzero(often.sel(track=label).to_numpy()).tolist()
            following = cleared[-1] + 1 if cleared else 0
            rows.append(
                HighestStep(
                    robot=name,
                    model=label,
                    height=heights[following - 1] if cleared else 0.0,
                    gaps=following - len(cleared),
                    limit=_limit(table.sel(track=label).isel(height=slice(following, None))),
                    paper=next((row.max_height for row in TABLE_3 if row.model == model.row), None),
                )
            )
    return rows


def highest_steps_text(rows: Sequence[HighestStep]) -> str:
    """Write one row per model and one column per robot, with what limits each."""
    lines = (
        {
            "highest step [cm], then what limits it": model,
            "paper": "-" if own[0].paper is None else f"{100 * own[0].paper:.0f}",
            **{
                row.robot: f"{100 * row.height:.0f}{'*' * bool(row.gaps)} {row.limit}"
                for row in own
            },
        }
        for model, own in group_by(rows, "model").items()
    )
    note = "* fewer than half of the runs clear some lower step; the paper's real robot: 20 cm"
    return f"{aligned_table(lines)}\n{note}"


def _limit(above: xarray.Dataset) -> str:
    """Return the commonest outcome of runs that do not clear the first of some heights."""
    if not above.sizes["height"]:
        return "none up to here"
    columns = (above[name].isel(height=0).to_numpy().tolist() for name in ("outcome", "mechanism"))
    endings = Counter(
        " ".join(filter(None, (outcome, mechanism)))
        for outcome, mechanism in zip(*columns, strict=True)
        if outcome != "cleared"
    )
    return endings.most_common(1)[0][0].replace("_", " ")


def _run_chains(job: Job) -> None:
    design = CHAINS_FULL if job.full else CHAINS_QUICK
    sweeps = seizure.Sweeps(design=design, models=chain_models(), **job.sampling)
    begin = time.perf_counter()
    runs, head = seizure.cross_obstacles(sweeps)
    table = runs["step"]
    took = time.perf_counter() - begin
    rows = cells(table, "step")
    job.report("chains", rates_text(rows), head)
    write_runs(table, job.out / "runs_chains.csv")
    job.write_rows(chains=rows)
    job.draw({"chains": partial(plot_chains, rows)})
    print(f"{table['outcome'].size} runs in {took:.0f} s; table and picture are in {job.out}")


def _run_chain_steps(job: Job) -> None:
    steps = chain_steps(repeats=40 if job.full else 2, **job.sampling)
    job.report("chain_steps", chain_steps_text(steps))


def _run_flippers(job: Job) -> None:
    heights, repeats = (_FLIPPER_HEIGHTS, 6) if job.full else (_FLIPPER_HEIGHTS[1::4], 2)
    steps = highest_steps(heights, repeats=repeats, **job.sampling)
    job.report("flippers", highest_steps_text(steps))


CHAINS = Study(text="Chains of shoes on steps, compared with simpler models.", run=_run_chains)
CHAIN_STEPS = Study(text="How finely a chain of shoes must be stepped.", run=_run_chain_steps)
FLIPPERS = Study(
    text="The highest step that the Engineer climbs with its flippers.", run=_run_flippers
)
