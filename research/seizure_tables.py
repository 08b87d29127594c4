"""The rows of the seizure study, computed from its sweeps, as text and as figures."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray

import crawler2d as c2d
from crawler2d.drawings.palette import BLACK, look_of
from crawler2d.sweeps.rates import rates_of
from research.figures import add_legend, draw_rates, join_legends, make_panels
from research.models import StudyModel, study_robot
from research.paper import RPM, TABLE_2, TABLE_3
from research.tables import aligned_table, cells_of, counts, gaps, group_by, in_mm, mm, percent

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_POST_THICKNESS = 0.020
_POST_HEIGHTS = (0.03, 0.05, 0.08)

# Wide lines below narrow ones, so that coinciding lines stay visible.
_WIDTHS = (3.2, 2.0, 0.9)
_COLUMNS = 4
_EQUATION_1 = 1.0 / 3.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Cell:
    """One model on one obstacle of one height, all repeats together."""

    robot: str
    obstacle: str
    model: str
    height: float
    """[m]"""
    cleared: int
    count: int
    rate: float
    low: float
    """[-] Lower bound of Wilson's 95 % interval."""
    high: float
    poses: int
    """Distinct final poses, to 1 mm and 0.1 degree; if few, the runs were not independent."""
    others: str
    """Outcomes of the runs that did not clear, with their number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Climb:
    """The greatest height of an obstacle that a model clears."""

    obstacle: str
    model: str
    highest: float
    """[m] Greatest height cleared in at least half of the runs; nan if there is none."""
    gaps: tuple[float, ...]
    """[m] Smaller heights cleared in less than half of the runs."""
    tested: float
    """[m] Greatest height tried."""
    simulated_time: float
    """[s] Simulated time of all runs."""
    computing_time: float
    """[s] Computing time of all runs on one thread."""
    max_penetration: float
    """[m] Largest penetration in all runs."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Ride:
    """One model on flat ground, the mean of its runs."""

    model: str
    over_reading: float
    """[-] Odometry error: track distance over path length, minus 1."""
    vertical_acceleration: float
    """[m/s^2] Root mean square."""
    angular_velocity: float
    """[rad/s] Root mean square."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Phase:
    """One line of gear wheels on flat ground, the mean of its runs."""

    count: int
    phase_fraction: float
    vertical_acceleration: float
    """[m/s^2] Root mean square."""
    angular_velocity: float
    """[rad/s] Root mean square."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Post:
    """A period in which the post was between two wheels."""

    height: float
    """[m]"""
    belly: bool
    """Whether the robot has a belly."""
    outcome: str
    mechanism: str
    """Mechanism that holds the post; "" if the run did not end in a stop."""
    bodies: str
    """The two wheels, in order of belt travel; wheel 2 is the foremost."""
    start: float
    """[s]"""
    end: float
    """[s]"""
    depth: float
    """[m] Largest depth inside the taut belt round the wheels."""
    force: float
    """[N] Mean normal force on the post."""


def cells(table: xarray.Dataset, obstacle: str, robot: str = "preset") -> list[Cell]:
    """Count the outcomes of a sweep over track and height.

    Parameters
    ----------
    table : xarray.Dataset
        With the dimensions track, height and repeat.
    obstacle, robot : str
        Names of the obstacle and of the robot.
    """
    rates = rates_of(table)
    return [
        Cell(
            robot=robot,
            obstacle=obstacle,
            model=place["track"],
            height=place["height"],
            cleared=outcomes.count("cleared"),
            **{name: own[name].item() for name in ("count", "rate", "low", "high")},
            poses=own["distinct"].item(),
            others=counts(each for each in outcomes if each != "cleared"),
        )
        for place in cells_of(table, "track", "height")
        for own, outcomes in [(rates.sel(place), table["outcome"].sel(place).to_numpy().tolist())]
    ]


def climbs(table: xarray.Dataset, obstacle: str) -> list[Climb]:
    """Summarise a sweep over track and height, one row per model."""
    often = rates_of(table)["rate"] >= 0.5
    heights = table["height"].to_numpy()
    rows = []
    for model in table["track"].to_numpy().tolist():
        own = table.sel(track=model)
        cleared = often.sel(track=model).to_numpy()
        highest = heights[cleared].max() if cleared.any() else math.nan
        rows.append(
            Climb(
                obstacle=obstacle,
                model=model,
                highest=float(highest),
                gaps=tuple(heights[~cleared & (heights < highest)].tolist()),
                tested=float(heights.max()),
                simulated_time=own["time"].sum().item(),
                computing_time=own["wall_time"].sum().item(),
                max_penetration=own["max_penetration"].max().item(),
            )
        )
    return rows


def rides(table: xarray.Dataset) -> list[Ride]:
    """Average a sweep over track on flat ground."""
    over_reading = (table["track_distance"] / table["path_length"] - 1.0).mean("repeat")
    return [
        Ride(
            model=model,
            over_reading=over_reading.sel(track=model).item(),
            **_vibration(table.sel(track=model)),
        )
        for model in table["track"].to_numpy().tolist()
    ]


def phases(table: xarray.Dataset) -> list[Phase]:
    """Average a sweep over robot_track_count and phase_fraction on flat ground."""
    return [
        Phase(
            count=place["robot_track_count"],
            phase_fraction=place["phase_fraction"],
            **_vibration(table.sel(place)),
        )
        for place in cells_of(table, "robot_track_count", "phase_fraction")
    ]


def write_runs(table: xarray.Dataset, path: Path) -> None:
    """Write a sweep as CSV without scenarios, which follow from the seed and take most space."""
    table.drop_vars("scenario").to_dataframe().to_csv(path)


def public_wheel_model(threads: int | None = None) -> dict[tuple[float, bool], c2d.Run]:
    """Drive the public wheel model of the Engineer against posts, with and without a belly.

    The wheels are those of the public simulation model; robot, friction and speed are those of the
    study, so that only the track differs.

    Parameters
    ----------
    threads : int, optional
        See `simulate_many`.

    Returns
    -------
    dict of (float, bool) to Run
        Runs with history, by the height of the post [m] and whether the robot has a belly.
    """
    robot = study_robot(track="public")
    robots = {True: robot, False: replace(robot, belly=None)}
    places = [(height, belly) for belly in robots for height in _POST_HEIGHTS]
    scenarios = [
        c2d.Scenario(robots[belly], c2d.terrains.barrier(height, _POST_THICKNESS))
        for height, belly in places
    ]
    return dict(zip(places, c2d.simulate_many(scenarios, threads=threads), strict=True))


def posts(runs: Mapping[tuple[float, bool], c2d.Run]) -> list[Post]:
    """List the periods in which the post was between two different wheels.

    Parameters
    ----------
    runs : mapping of (float, bool) to Run
        The result of `public_wheel_model`.

    Returns
    -------
    list of Post
        In the order of runs and events.

    Examples
    --------
    >>> first = posts(public_wheel_model())[0]
    >>> first.bodies, round(first.depth, 3)
    ('2 1', 0.03)
    """
    return [
        Post(
            height=height,
            belly=belly,
            outcome=str(run.outcome),
            mechanism=str(run.mechanism or ""),
            bodies=" ".join(map(str, run.events["bodies"][row])),
            **{name: float(run.events[name][row]) for name in ("start", "end", "depth", "force")},
        )
        for (height, belly), run in runs.items()
        for row in np.flatnonzero(run.events["kind"] == "intrusion")
        if len(set(run.events["bodies"][row])) == 2
    ]


def rates_text(cells: Iterable[Cell]) -> str:
    """Write how often each model cleared."""
    rows = (
        {
            "model": cell.model,
            "obstacle": cell.obstacle,
            "[mm]": mm(cell.height),
            "cleared": f"{cell.cleared}/{cell.count}",
            "95 % interval": f"{percent(cell.low)} to {percent(cell.high)} %",
            "poses": str(cell.poses),
            "other outcomes": cell.others,
        }
        for cell in cells
    )
    return aligned_table(rows, left=("obstacle", "other outcomes"))


def climbs_text(models: Mapping[str, StudyModel], climbs: Sequence[Climb]) -> str:
    """Write the greatest height that each model clears, one row per model."""
    by_model = group_by(climbs, "model")
    rows = (
        {
            "model": name,
            "paper": model.source,
            **{climb.obstacle: _highest(climb) for climb in by_model[name]},
            "RTF": _real_time_factor(by_model[name]),
            "penetration": mm(max(climb.max_penetration for climb in by_model[name]), 2),
        }
        for name, model in models.items()
    )
    return (
        "Greatest height [mm] cleared in at least half of the runs (in brackets: smaller heights\n"
        "that were not; +: the greatest height tried), real-time factor on one thread, largest\n"
        "penetration of all runs [mm]\n\n"
    ) + aligned_table(rows, left=("paper", *group_by(climbs, "obstacle")))


def robots_text(cells: Sequence[Cell]) -> str:
    """Write how other estimates for the robot change the table."""
    heights = in_mm(group_by(cells, "height"))
    rows = (
        {"model": model}
        | {
            robot: " ".join(str(cell.cleared) for cell in own)
            for robot, own in group_by(of_model, "robot").items()
        }
        for model, of_model in group_by(cells, "model").items()
    )
    note = f"Other robots: how many of {cells[0].count} runs cleared a step of {heights} mm"
    return f"{note}\n\n{aligned_table(rows)}"


def rides_text(rides: Iterable[Ride]) -> str:
    """Write odometry error and vibration on flat ground."""
    rows = (
        {
            "model": ride.model,
            "odometry [%]": f"{100 * ride.over_reading:z.2f}",
            "acceleration [m/s^2]": f"{ride.vertical_acceleration:.2f}",
            "angle rate [rad/s]": f"{ride.angular_velocity:.3f}",
        }
        for ride in rides
    )
    return (
        "Flat ground: how much too far odometry reads, and vibration (root mean square of the\n"
        "vertical acceleration and of the rate of the chassis angle)\n\n"
    ) + aligned_table(rows)


def phases_text(phases: Sequence[Phase]) -> str:
    """Write the vibration of lines of gear wheels over their phases."""
    rows = (
        {
            "phase": f"{fraction:.3f}",
            **{f"{phase.count} [m/s^2]": f"{phase.vertical_acceleration:.2f}" for phase in own},
            **{f"{phase.count} [rad/s]": f"{phase.angular_velocity:.3f}" for phase in own},
        }
        for fraction, own in group_by(phases, "phase_fraction").items()
    )
    return (
        "Lines of gear wheels on flat ground: vibration over the phase fraction of eq. (1), which\n"
        "is 0.333 in the paper\n\n"
    ) + aligned_table(rows)


def posts_text(posts: Iterable[Post]) -> str:
    """Write when the post was between two wheels of the public model."""
    rows = (
        {
            "post [mm]": mm(post.height),
            "belly": "yes" if post.belly else "no",
            "outcome": ", ".join(filter(None, (post.outcome, post.mechanism))),
            "between": post.bodies,
            "time [s]": f"{post.start:.2f} to {post.end:.2f}",
            "depth [mm]": mm(post.depth, 1),
            "force [N]": f"{post.force:.0f}",
        }
        for post in posts
    )
    return (
        "The public wheel model, three wheels per side with gaps of 26 mm, against a post 20 mm\n"
        "thick: the time spans in which it was between two wheels\n\n"
    ) + aligned_table(rows, left=("belly", "outcome", "between"))


def paper_text(models: Mapping[str, StudyModel], climbs: Sequence[Climb]) -> str:
    """Write the paper's Tables 2 and 3, with our models below the rows of their kind."""
    places = ("barrier", "step", "knife edge")
    columns = {"CWA": "cwa", "LWA": "lwa", "gear wheels": "gear"}
    success = (
        {"obstacle": row.obstacle}
        | {name: percent(getattr(row, column)) for name, column in columns.items()}
        for row in TABLE_2
    )
    rows = []
    by_model = group_by(climbs, "model")
    for theirs in TABLE_3:
        paper = {
            "model": theirs.model,
            **dict.fromkeys(places, ""),
            "RTF": f"{theirs.real_time_factor:g}",
            "speed": f"{theirs.max_speed:g}",
            "braking": f"{theirs.braking_distance:g}",
            "acceleration": f"{theirs.acceleration:g}",
            "turning": f"{theirs.max_turn_rate / RPM:.1f}",
        }
        rows.append(paper | {places[0]: mm(theirs.max_height)})
        for name in (name for name, model in models.items() if model.row == theirs.model):
            own = {climb.obstacle: _highest(climb) for climb in by_model[name]}
            own |= {"model": f"    ours: {name}", "RTF": _real_time_factor(by_model[name])}
            rows.append(dict.fromkeys(paper, "") | own)
    return "\n\n".join(
        (
            "The paper's Table 2, successful runs of 20 [%]",
            aligned_table(success),
            "The paper's Table 3, with ours below. Only the order of the heights can be compared:\n"
            "the paper's 150 and 200 mm are those of a robot with flippers. A side view has no\n"
            "turning. Heights in mm, speed in m/s, braking in m, acceleration in m/s^2, turning\n"
            "in revolutions per minute.",
            aligned_table(rows, left=places),
        )
    )


def plot_rates(cells: Sequence[Cell]) -> Figure:
    """Draw the rates of one robot with their intervals, one panel per model.

    Parameters
    ----------
    cells : sequence of Cell
        Heights ascending within a model and an obstacle; up to three obstacles.
    """
    models, obstacles = list(group_by(cells, "model")), list(group_by(cells, "obstacle"))
    own = group_by(cells, "model", "obstacle")
    columns = min(_COLUMNS, len(models))
    rows = -(-len(models) // columns)
    size = (2.2 * columns, 1.9 * rows + 0.9)
    figure, axes = make_panels(rows, columns, size, sharex=True, sharey=True)
    for ax in axes.flat[len(models) :]:
        ax.set_visible(False)
    for index, (ax, model) in enumerate(zip(axes.flat, models, strict=False)):
        for place, (obstacle, width) in enumerate(zip(obstacles, _WIDTHS, strict=False)):
            line = {"linewidth": width, "markersize": 2.0 + width, "label": obstacle}
            draw_rates(ax, own[model, obstacle], alpha=0.15, **look_of(place), **line)
        ax.set_title(model, fontsize="medium")
        ax.set_ylim(-5.0, 105.0)
        if index % columns == 0:
            ax.set_ylabel("cleared [%]")
        if index + columns >= len(models):
            ax.set_xlabel("height [mm]")
            ax.tick_params(labelbottom=True)
    figure.suptitle(rates_title(cells))
    add_legend(figure, axes[0, 0], "lower center")
    return figure


def rates_title(cells: Iterable[Cell]) -> str:
    """Write the title of a figure of rates."""
    count = max(cell.count for cell in cells)
    return f"Engineer without flippers: {count} runs per point, 95 % Wilson intervals"


def plot_phases(phases: Sequence[Phase]) -> Figure:
    """Draw the vibration of lines of gear wheels on flat ground over their phases.

    Parameters
    ----------
    phases : sequence of Phase
        Phase fractions ascending within a count; up to three counts.
    """
    figure, axes = make_panels(1, 2, (8.0, 3.6), sharex=True)
    names = {
        "vertical_acceleration": "vertical acceleration, rms [m/s²]",
        "angular_velocity": "rate of the chassis angle, rms [rad/s]",
    }
    for ax, (name, label) in zip(axes.flat, names.items(), strict=True):
        for index, (count, own) in enumerate(group_by(phases, "count").items()):
            ax.plot(
                [phase.phase_fraction for phase in own],
                [getattr(phase, name) for phase in own],
                **look_of(index),
                markersize=4,
                label=f"{count} gear wheels",
            )
        ax.axvline(_EQUATION_1, color=BLACK, linestyle=":", label="eq. (1)")
        ax.set(xlabel="phase fraction", ylabel=label, ylim=(0.0, None))
        ax.grid(alpha=0.25)
    add_legend(figure, axes[0, 0], "upper center")
    return figure


def plot_posts(runs: Mapping[tuple[float, bool], c2d.Run]) -> Figure:
    """Draw where the public wheel model stopped at a post, one panel per run.

    Parameters
    ----------
    runs : mapping of (float, bool) to Run
        The result of `public_wheel_model`; runs that cleared are left out.
    """
    stuck = {place: run for place, run in runs.items() if run.outcome != "cleared"}
    rows = -(-len(stuck) // 2)
    figure, axes = make_panels(rows, 2, (8.0, 2.2 * rows), sharex=True, sharey=True)
    for ax, ((height, belly), run) in zip(axes.flat, stuck.items(), strict=False):
        run.plot(ax, time=run.time[-1])
        title = f"post of {mm(height)} mm, {'belly' if belly else 'no belly'}: {run.outcome}"
        ax.set_title(title, loc="left", fontsize="medium")
        ax.set(xlim=(-0.42, 0.22), ylim=(-0.03, 0.23))
        ax.label_outer()
    join_legends(figure, axes.ravel().tolist()[: len(stuck)])
    for ax in axes.ravel()[len(stuck) :]:
        ax.set_visible(False)
    return figure


def _vibration(runs: xarray.Dataset) -> dict[str, float]:
    names = ("vertical_acceleration", "angular_velocity")
    return {name: runs[name].mean().item() for name in names}


def _real_time_factor(climbs: Collection[Climb]) -> str:
    simulated = sum(climb.simulated_time for climb in climbs)
    return f"{simulated / sum(climb.computing_time for climb in climbs):.0f}"


def _highest(climb: Climb) -> str:
    if math.isnan(climb.highest):
        return "none"
    more = "+" if climb.highest == climb.tested else ""
    return f"{mm(climb.highest)}{more}{gaps(climb.gaps)}"
