"""The paper's Table 2: every layout over random step fields, and where and why runs fail."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import crawler2d as c2d
from crawler2d.drawings.palette import BLACK, look_of
from crawler2d.parameters.terrain import RandomStepfield
from crawler2d.results.record import Row
from crawler2d.sweeps.figure_dataset import FigureDataset
from crawler2d.sweeps.store import Store
from research.figures import add_legend, make_panels
from research.paper import PAPER_RUNS, TABLE_2, WITHIN, agreement
from research.paper.design import READINGS, SETTINGS, Setting, Work, layouts, models_of
from research.tables import cells_of, counts, group_by, markdown_table, percent

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FIELDS: Mapping[str, RandomStepfield] = {
    "random RSE": c2d.terrains.random_stepfield(),
    "horizontal barrier": c2d.terrains.stepfield_with_barrier(),
    "diagonal barrier": c2d.terrains.stepfield_with_barrier(yaw=math.radians(45.0)),
}
"""By the paper's names. It has no dimensions: these are the defaults, and half a right angle."""

COLUMNS = {reading.layout: reading.row for reading in READINGS if reading.row in TABLE_2[0].columns}
"""The column of Table 2 for each layout."""

PLACES = ("before", "at", "beyond")
"""Where a robot ended, relative to the barrier."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldCell:
    """One layout in one field, all runs together."""

    setting: str
    obstacle: str
    """As in `FIELDS`."""
    model: str
    column: str
    """Its column of Table 2; "" if the layout is ours."""
    cleared: int
    count: int
    """Runs with a result."""
    rate: float
    low: float
    """[-] Lower bound of Wilson's 95 % interval: the number of runs was fixed beforehand."""
    high: float
    others: str
    """Outcomes of the runs that did not clear, with their number."""
    computing_time: float
    """[s] Computing time of all runs on one thread."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """A rate of the paper's Table 2 and ours."""

    setting: str
    obstacle: str
    column: str
    model: str
    paper: float
    """[-] Of 20 runs."""
    cleared: int
    count: int
    difference: float
    """[-] As in `Agreement`, like what follows."""
    low: float
    high: float
    verdict: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """A run that did not clear."""

    setting: str
    obstacle: str
    model: str
    repeat: int
    outcome: str
    mechanism: str
    """Mechanism that holds the ground inside the track; "" without a stop or such ground."""
    carrier: str
    """Carrier of the track that holds that ground: "chassis" or "front flipper"; "" if none."""
    x: float
    """[m] Position of the chassis where it stopped, or at the end."""
    ground_x: float
    """[m] Position of that ground; nan if there is none."""
    place: str
    """One of `PLACES`; "" in a field without a barrier."""
    sentence: str
    """The sentence of the diagnosis; "" if it did not stop."""
    identity: str
    """Identity of its scenario, by which the store finds it."""


def cross_fields(work: Work, names: Sequence[str]) -> Iterator[tuple[Setting, FigureDataset]]:
    """Drive some layouts over the fields, one setting after the other.

    Yields
    ------
    tuple of Setting and FigureDataset
        Dimensions `model`, `terrain` and `repeat`; every run has its own field, the same for every
        layout and setting.
    """
    for setting in SETTINGS if names else ():
        print(f"Table 2, {setting.name}: {', '.join(names)}", flush=True)
        yield setting, cross(setting, names, work, work.design.field_repeats)


def cross(setting: Setting, names: Collection[str], work: Work, repeats: int) -> FigureDataset:
    """Drive some layouts over the fields in one setting; see `cross_fields`."""
    grounds = {name: replace(field, friction=setting.friction) for name, field in FIELDS.items()}
    return work.success_rate(grounds, models_of(names, setting), repeats)


def cells(setting: Setting, runs: FigureDataset) -> list[FieldCell]:
    """Count the outcomes of the runs of `cross_fields`, with one row per layout and field."""
    rows = []
    for place in cells_of(runs, "model", "terrain"):
        own = runs.sel(place)
        outcomes = own["outcome"].to_numpy().tolist()
        cleared, count = outcomes.count("cleared"), own["count"].item()
        rows.append(
            FieldCell(
                setting=setting.name,
                obstacle=place["terrain"],
                model=place["model"],
                column=COLUMNS.get(place["model"], ""),
                cleared=cleared,
                count=count,
                **c2d.wilson(cleared, count)._asdict(),
                others=counts(each for each in outcomes if each != "cleared"),
                computing_time=own["wall_time"].sum().item(),
            )
        )
    return rows


def compare(rows: Sequence[FieldCell]) -> list[Comparison]:
    """Compare our rates with those of the paper's Table 2, with the verdict on each."""
    shares = {(each.obstacle, name): s for each in TABLE_2 for name, s in each.columns.items()}
    own = {(row.setting, row.obstacle, row.model): row for row in rows if row.count}
    return [
        Comparison(
            setting=row.setting,
            obstacle=row.obstacle,
            column=column,
            model=model,
            paper=shares[row.obstacle, column],
            cleared=row.cleared,
            count=row.count,
            **asdict(agreement(row.cleared, row.count, shares[row.obstacle, column])),
        )
        for setting in SETTINGS
        for obstacle in FIELDS
        for model, column in COLUMNS.items()
        if (row := own.get((setting.name, obstacle, model)))
    ]


def barrier_of(field: RandomStepfield, gauge: float) -> tuple[float, float] | None:
    """Return the beginning and end of the barrier of a field, or None if there is none.

    Parameters
    ----------
    field : RandomStepfield
        The field, with its barrier across the middle.
    gauge : float
        [m] Distance between the tracks, which meet a turned barrier one after the other.

    Returns
    -------
    tuple of 2 floats or None
        [m] From the first track's front face to the last track's rear face.

    Examples
    --------
    >>> low, high = barrier_of(RandomStepfield(barrier_height=0.15), 0.2)
    >>> round(low, 3), round(high, 3)
    (0.45, 0.55)
    """
    if field.barrier_height == 0.0:
        return None
    yaw = field.barrier_yaw
    half = 0.5 * (gauge * abs(math.tan(yaw)) + field.barrier_thickness / math.cos(yaw))
    middle = 0.5 * field.posts * field.post
    return middle - half, middle + half


def place_of(x: float, half_length: float, barrier: tuple[float, float] | None) -> str:
    """Return where a track with a half length [m] about x [m] is, relative to a barrier.

    Flippers are left out: stretched out, they reach farther ahead.

    Examples
    --------
    >>> [place_of(x, 0.25, (0.45, 0.55)) for x in (0.1, 0.5, 0.9)]
    ['before', 'at', 'beyond']
    """
    if barrier is None:
        return ""
    if x + half_length < barrier[0]:
        return "before"
    return "beyond" if x - half_length > barrier[1] else "at"


def failures(tables: Iterable[tuple[Setting, FigureDataset]], store: Path) -> list[Failure]:
    """List the runs of `cross_fields` that did not clear, with details from the store.

    Parameters
    ----------
    tables : iterable of Setting and FigureDataset
        The runs of each setting, with the dimensions `model`, `terrain` and `repeat`.
    store : Path
        The store of the runs.
    """
    failed: dict[str, tuple[Setting, str, str, int]] = {}
    for setting, table in tables:
        runs = table[["outcome", "identity"]].transpose("model", "terrain", "repeat")
        models, obstacles = (runs[name].to_numpy().tolist() for name in ("model", "terrain"))
        places = np.argwhere(~np.isin(runs["outcome"].to_numpy(), ["cleared", ""]))
        for model, obstacle, repeat in places.tolist():
            identity = str(runs["identity"].to_numpy()[model, obstacle, repeat])
            failed[identity] = (setting, models[model], obstacles[obstacle], repeat)
    with Store(store) as kept:
        rows = kept.read(list(failed))
    return [_failure(rows[identity], *place) for identity, place in failed.items()]


def chosen_text() -> str:
    """List the choices before any run: layouts for rows, and settings."""
    settings = [
        (
            each.name,
            f"{each.max_torque:g} N m a {'wheel' if each.a_wheel else 'sprocket'}",
            f"{each.friction:g}",
            each.reason,
        )
        for each in SETTINGS
    ]
    return "\n\n".join(
        (
            markdown_table(("row of the paper", "layout", "why"), READINGS),
            markdown_table(("setting", "motors", "friction", "why"), settings),
            "Without wheels that is the torque of the sprocket.",
        )
    )


def table_2_text(rows: Sequence[Comparison]) -> str:
    """Compare the paper's Table 2 with ours: counts, difference with its interval, verdict."""
    settings, table = list(group_by(rows, "setting")), []
    for (obstacle, model), pairs in group_by(rows, "obstacle", "model").items():
        own = {row.setting: _comparison(row) for row in pairs}
        texts = (own.get(setting, "") for setting in settings)
        table.append((obstacle, model, percent(pairs[0].paper), *texts))
    head = ("field", "layout", "paper [%]", *settings)
    note = (
        "Cells: our runs that cleared; the difference from the paper's rate in percentage points,"
        " with Newcombe's 95 % interval (20 runs of the paper); the verdict. *Agrees*: within"
        f" {100 * WITHIN:.0f} points. Otherwise *differs* if the interval excludes 0, *open* if it"
        " contains 0."
    )
    return f"{note}\n\n{markdown_table(head, table)}"


def layouts_text(rows: Sequence[FieldCell]) -> str:
    """List the rates of all layouts, fields side by side."""
    settings, models, table = group_by(rows, "setting"), group_by(rows, "model"), []
    for model, layout in layouts().items():
        if model in models:
            own = group_by(models[model], "setting")
            rates = (
                " / ".join(percent(row.rate) for row in own.get(setting, ()))
                for setting in settings
            )
            table.append((model, layout.source, *rates))
    runs = " or ".join(map(str, sorted({row.count for row in rows})))
    widest = max((max(row.rate - row.low, row.high - row.rate) for row in rows), default=0.0)
    note = (
        f"Runs that cleared [%], of {runs} a cell: {', '.join(group_by(rows, 'obstacle'))}."
        f" Wilson's 95 % intervals, in `paper_table_2.csv`, reach at most {percent(widest)} points"
        " either way."
    )
    return f"{note}\n\n{markdown_table(('layout', 'from', *settings), table)}"


def failures_text(failed: Sequence[Failure], models: Collection[str]) -> str:
    """Describe where and why runs failed: a sum for every setting, and rows for some layouts."""
    sums, table = [], []
    for setting, runs in group_by(failed, "setting").items():
        with_barrier = [run for run in runs if run.place]
        sums.append(
            f"- {setting}: {len(runs)} runs of all layouts failed; of the {len(with_barrier)} with"
            f" a barrier, {_before(with_barrier)} ended before it."
        )
        table += [
            (
                setting,
                obstacle,
                model,
                str(len(own)),
                str(_before(own)) if own[0].place else "-",
                _endings(run.outcome for run in own),
                _endings(run.mechanism for run in own if run.mechanism) or "-",
                str(sum(run.carrier.endswith("flipper") for run in own) or "-"),
            )
            for (obstacle, model), own in group_by(runs, "obstacle", "model").items()
            if model in models
        ]
    head = (
        *("setting", "field", "layout", "failures", "before the barrier"),
        *("outcomes", "how the ground is held", "by a flipper's track"),
    )
    note = (
        "A run ended *before the barrier* if its tracks had not reached it; flippers may have."
        " `paper_failures.csv` has every failure with its place and its sentence."
    )
    return "\n\n".join((note, "\n".join(sums), markdown_table(head, table)))


def plot_table_2(rows: Sequence[Comparison]) -> Figure:
    """Draw the rates of the paper and ours with Wilson's intervals, one panel per field.

    Parameters
    ----------
    rows : sequence of Comparison
        Up to three settings.
    """
    fields, models = list(group_by(rows, "obstacle")), list(group_by(rows, "model"))
    settings, pairs = list(group_by(rows, "setting")), group_by(rows, "obstacle", "model")
    figure, axes = make_panels(1, len(fields), (4.4 * len(fields), 4.4), sharey=True)
    for ax, field in zip(axes.flat, fields, strict=True):
        for place, model in enumerate(models):
            own = pairs[field, model]
            points = [("the paper", round(PAPER_RUNS * own[0].paper), PAPER_RUNS)]
            points += [(row.setting, row.cleared, row.count) for row in own]
            for step, (label, cleared, count) in enumerate(points):
                rate, low, high = c2d.wilson(cleared, count)
                x = place + 0.16 * (step - 1.5)
                look = {"color": BLACK, "marker": "D"}
                if step:
                    look = look_of(settings.index(label))
                ax.vlines(x, 100 * low, 100 * high, color=look["color"], linewidth=1.6)
                named = {"label": label} if place == 0 else {}
                ax.plot(x, 100 * rate, **look | {"linestyle": ""}, **named)
        ax.set_xticks(range(len(models)), [model.replace(", ", ",\n") for model in models])
        ax.tick_params(axis="x", labelsize="small", rotation=20)
        ax.set(ylim=(-4.0, 104.0), xlim=(-0.5, len(models) - 0.5))
        ax.set_title(field, loc="left", fontsize="medium")
        ax.grid(alpha=0.25, axis="y")
    axes[0, 0].set_ylabel("cleared [%]")
    add_legend(figure, axes[0, 0], "upper center")
    return figure


def _failure(row: Row, setting: Setting, model: str, obstacle: str, repeat: int) -> Failure:
    scenario, why = c2d.Scenario.from_json(row.scenario), row.read_diagnosis()
    inside = None if why is None else why.intrusion
    x = row.metrics.get("final_x", math.nan) if why is None else why.position[0]
    field, outline = scenario.terrain, scenario.robot.outline
    if not isinstance(field, RandomStepfield):
        raise TypeError(f"these runs are over step fields, got {field.kind}")
    barrier = barrier_of(field, scenario.robot.gauge)
    half_length = 0.5 * outline.axle_distance + outline.front_radius
    return Failure(
        setting=setting.name,
        obstacle=obstacle,
        model=model,
        repeat=repeat,
        outcome=row.outcome,
        mechanism="" if why is None else str(why.mechanism or ""),
        carrier="" if inside is None else inside.carrier,
        x=x,
        ground_x=math.nan if inside is None else inside.x,
        place=place_of(x, half_length, barrier),
        sentence="" if why is None else str(why),
        identity=row.identity,
    )


def _comparison(row: Comparison) -> str:
    points = [f"{100 * each:+.0f}" for each in (row.difference, row.low, row.high)]
    return (
        f"{row.cleared} of {row.count}; {points[0]} ({points[1]} to {points[2]}): **{row.verdict}**"
    )


def _endings(names: Iterable[str]) -> str:
    return counts(name.replace("_", " ") for name in names)


def _before(runs: Iterable[Failure]) -> int:
    return sum(run.place == "before" for run in runs)
