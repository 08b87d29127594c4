"""The paper's Table 2: every layout over random step fields, with and without a barrier."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import TYPE_CHECKING

from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Climb, Drive
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.studies.obstacles import success
from crawler2d.sweeps.statistics import wilson
from research.paper.agreement import agreement
from research.paper.layouts import GEAR_MODEL, GEAR_MODEL_OTHERWISE, READINGS, layouts
from research.paper.published import CWA_ROUND, LWA_ROUND, TABLE_1, TABLE_2
from research.paper.settings import SETTINGS, Setting

if TYPE_CHECKING:
    from crawler2d.parameters.terrain import RandomStepfield
    from crawler2d.sweeps.found import Found
    from research.paper.design import Work

__all__ = [
    "BESIDE_TABLE_2",
    "FIELDS",
    "Beside",
    "FieldCell",
    "beside",
    "cells",
    "cross",
    "cross_fields",
]

FIELDS: Mapping[str, RandomStepfield] = {
    "random RSE": terrains.random_stepfield(),
    "horizontal barrier": terrains.stepfield_with_barrier(),
    "diagonal barrier": terrains.stepfield_with_barrier(yaw=math.radians(45.0)),
}
"""By the paper's names. It gives no dimensions: these are the defaults, and half a right angle."""

BESIDE_TABLE_2 = {
    reading.layout: reading.row
    for reading in READINGS
    if reading.row in (CWA_ROUND, LWA_ROUND, GEAR_MODEL, GEAR_MODEL_OTHERWISE)
}
"""By layout, the column of Table 2 that it stands for."""


@dataclass(frozen=True, slots=True, kw_only=True)
class FieldCell:
    """One layout in one field, all runs together."""

    setting: str
    obstacle: str
    """As in `FIELDS`."""
    model: str
    column: str
    """The column of Table 2 that it stands for; "" if it is ours."""
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
    """[s] Of all runs on one thread."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Beside:
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


def cross_fields(work: Work, names: Sequence[str]) -> Iterator[tuple[Setting, Found]]:
    """Drive some layouts over the fields, in one setting after the other.

    Yields
    ------
    tuple of Setting and Found
        Dimensions `model`, `terrain` and `repeat`; every run has a field of its own, the same for
        every layout and setting.
    """
    for setting in SETTINGS if names else ():
        print(f"Table 2, {setting.name}: {', '.join(names)}", flush=True)
        yield setting, cross(setting, names, work, work.design.field_repeats)


def cross(setting: Setting, names: Collection[str], work: Work, repeats: int) -> Found:
    """Drive some layouts over the fields in one setting; see `cross_fields`."""
    known = layouts()
    grounds = {name: replace(field, friction=setting.friction) for name, field in FIELDS.items()}
    drive = Drive(speed=TABLE_1.max_speed, gait=Climb())
    base = Scenario(engineer().without_rotors(), next(iter(grounds.values())), drive=drive)
    models = {name: {"robot": setting.on(known[name].on(base.robot))} for name in names}
    found = success(base, terrains=grounds, models=models, **work.how(repeats))
    return work.counted(found)


def cells(setting: Setting, found: Found) -> list[FieldCell]:
    """Count how the runs of `cross_fields` ended, one row per layout and field."""
    rows = []
    for model in found["model"].to_numpy().tolist():
        for obstacle in found["terrain"].to_numpy().tolist():
            own = found.sel(model=model, terrain=obstacle)
            endings = Counter(own["outcome"].to_numpy().tolist())
            cleared, count = endings.pop("cleared", 0), own["count"].item()
            rate, low, high = wilson(cleared, count)
            rows.append(
                FieldCell(
                    setting=setting.name,
                    obstacle=obstacle,
                    model=model,
                    column=BESIDE_TABLE_2.get(model, ""),
                    cleared=cleared,
                    count=count,
                    rate=rate,
                    low=low,
                    high=high,
                    others=", ".join(f"{n} {name}" for name, n in endings.most_common()),
                    computing_time=own["wall_time"].sum().item(),
                )
            )
    return rows


def beside(rows: Sequence[FieldCell]) -> list[Beside]:
    """Set the rates of the paper's Table 2 and ours side by side, with the verdict on each."""
    found = []
    for setting in SETTINGS:
        for theirs in TABLE_2:
            shares = {
                CWA_ROUND: theirs.cwa,
                LWA_ROUND: theirs.lwa,
                GEAR_MODEL: theirs.gear,
                GEAR_MODEL_OTHERWISE: theirs.gear,
            }
            for model, column in BESIDE_TABLE_2.items():
                place = (setting.name, theirs.obstacle, model)
                own = [row for row in rows if (row.setting, row.obstacle, row.model) == place]
                found += [
                    Beside(
                        setting=setting.name,
                        obstacle=theirs.obstacle,
                        column=column,
                        model=model,
                        paper=shares[column],
                        cleared=row.cleared,
                        count=row.count,
                        **asdict(agreement(row.cleared, row.count, shares[column])),
                    )
                    for row in own
                    if row.count
                ]
    return found
