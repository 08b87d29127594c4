"""Where and why the runs of the paper's Table 2 failed."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import RandomStepfield
from crawler2d.results.record import Row
from crawler2d.sweeps.store import Store

if TYPE_CHECKING:
    from pathlib import Path

    from crawler2d.sweeps.found import Found
    from research.paper.settings import Setting

__all__ = ["PLACES", "Failure", "Failures", "barrier_of", "failures", "gathered", "place_of"]

PLACES = ("before", "at", "beyond")
"""Where a robot ended, as seen from the barrier."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Failure:
    """A run that did not clear."""

    setting: str
    obstacle: str
    model: str
    repeat: int
    outcome: str
    mechanism: str
    """How the ground that holds it is held; "" if it did not stop, or none is."""
    carrier: str
    """What carries the track that holds that ground: "chassis" or "front flipper"; "" if none."""
    x: float
    """[m] Position of the chassis where it stopped, or at the end."""
    ground_x: float
    """[m] Where that ground is; nan if there is none."""
    place: str
    """One of `PLACES`; "" in a field without a barrier."""
    sentence: str
    """The sentence of the diagnosis; "" if it did not stop."""
    identity: str
    """Of its scenario, by which the store finds it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Failures:
    """The failures of one layout in one field."""

    setting: str
    obstacle: str
    model: str
    count: int
    has_barrier: bool
    before: int
    """How many are before the barrier."""
    outcomes: str
    """With their numbers, the commonest first."""
    mechanisms: str
    """Of the stops, with their numbers."""
    in_flippers: int
    """How many are held by the track of a flipper."""


def barrier_of(field: RandomStepfield, gauge: float) -> tuple[float, float] | None:
    """Return where the barrier of a field begins and ends, or None if there is none.

    Parameters
    ----------
    field : RandomStepfield
        With its barrier across the middle.
    gauge : float
        [m] Between the tracks, which meet a turned barrier one after the other.

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
    """Tell where a track of some half length [m] about x [m] is, as seen from a barrier.

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


def failures(tables: Iterable[tuple[Setting, Found]], store: Path) -> list[Failure]:
    """List the runs of `cross_fields` that did not clear, with what the store knows of them.

    Parameters
    ----------
    tables : iterable of Setting and Found
        What was made under each setting, with the dimensions `model`, `terrain` and `repeat`.
    store : Path
        Where the runs are.
    """
    wanted: dict[str, tuple[Setting, str, str, int]] = {}
    for setting, found in tables:
        runs = found[["outcome", "identity"]].transpose("model", "terrain", "repeat")
        models, obstacles = (runs[name].to_numpy().tolist() for name in ("model", "terrain"))
        failed = ~np.isin(runs["outcome"].to_numpy(), ["cleared", ""])
        for model, obstacle, repeat in np.argwhere(failed).tolist():
            identity = str(runs["identity"].to_numpy()[model, obstacle, repeat])
            wanted[identity] = (setting, models[model], obstacles[obstacle], repeat)
    with Store(store) as kept:
        rows = kept.found(list(wanted))
    return [_failure(rows[identity], *place) for identity, place in wanted.items()]


def gathered(found: Sequence[Failure]) -> list[Failures]:
    """Sum failures up, one row per setting, field and layout, in the order of their appearance."""
    cells: dict[tuple[str, str, str], list[Failure]] = {}
    for each in found:
        cells.setdefault((each.setting, each.obstacle, each.model), []).append(each)
    return [
        Failures(
            setting=setting,
            obstacle=obstacle,
            model=model,
            count=len(own),
            has_barrier=any(each.place for each in own),
            before=sum(each.place == "before" for each in own),
            outcomes=_counted(each.outcome for each in own),
            mechanisms=_counted(each.mechanism for each in own if each.mechanism),
            in_flippers=sum(each.carrier.endswith("flipper") for each in own),
        )
        for (setting, obstacle, model), own in cells.items()
    ]


def _failure(row: Row, setting: Setting, model: str, obstacle: str, repeat: int) -> Failure:
    scenario, why = Scenario.from_json(row.scenario), row.why()
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


def _counted(names: Iterable[str]) -> str:
    return ", ".join(f"{n} {name.replace('_', ' ')}" for name, n in Counter(names).most_common())
