"""Whether models get over a set of grounds, and how the runs that fail end."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import TYPE_CHECKING, Unpack

import numpy as np

from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.results.outcome import Outcome
from crawler2d.results.row import NO_RESULT
from crawler2d.studies.campaign import Cell, How, campaign
from crawler2d.studies.models import Models, read_models
from crawler2d.studies.tables import found_of
from crawler2d.variation.variability import of_contact, of_field, of_start

if TYPE_CHECKING:
    from crawler2d.sweeps.found import Found

__all__ = ["success"]


@takes_keywords
def success(
    scenario: Scenario,
    *,
    terrains: Mapping[str, Terrain] | None = None,
    models: Models | None = None,
    **how: Unpack[How],
) -> Found:
    """Find how often each model gets over each ground, and how and where it fails.

    Parameters
    ----------
    scenario : Scenario
        What all runs share.
    terrains : mapping of str to terrain, optional
        By label; None takes the scenario's own.
    models : mapping of str to track or fields, optional
        As for `compare`; None takes the scenario's own robot.
    **how
        See `crawler2d.studies`. `vary` is ``of_start() | of_contact() | of_field()`` unless given:
        every run over a random step field has a field of its own. Each cell is simulated until its
        rate is known within 0.2, unless `until` says otherwise.

    Returns
    -------
    Found
        Dimensions `model`, `terrain`, `sample` if there are unknowns, and `repeat`; `rate` of runs
        that cleared with its interval and `count`; the columns of `sweep` for each run, of which
        `outcome`, `stop_x` and `stop_mechanism` tell how and where it failed; and for every outcome
        that occurred a column `ended_...`, how many runs ended so.

    Raises
    ------
    ScenarioError
        If a terrain is none, or an argument breaks a rule.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat())
    >>> grounds = {"step": c2d.terrains.step(0.06), "wall": c2d.terrains.step(0.3)}
    >>> found = c2d.studies.success(base, terrains=grounds, progress=False)
    >>> found["rate"].sel(terrain="step").item(), found["ended_cleared"].values.tolist()
    (1.0, [[33, 0]])
    """
    grounds = _grounds(scenario, terrains)
    fields = read_models(scenario, models)
    swept = ["terrain", *dict.fromkeys(key for each in fields.values() for key in each)]
    how = {"vary": of_start() | of_contact() | of_field(), **how}
    with campaign(scenario, how, swept) as study:
        cells = [
            Cell((f"model={label}", f"terrain={name}"), scenario.replace({"terrain": each, **own}))
            for label, own in fields.items()
            for name, each in grounds.items()
        ]
        tallies = study.repeat(cells)
        no_units: dict[str, str] = {}
        dims = {"model": (list(fields), no_units), "terrain": (list(grounds), no_units)}
        found = found_of(study, "success", tallies, dims)
    ends = [Counter(row.outcome for row in tally.rows) for each in tallies for tally in each]
    occurred = [each for each in (*map(str, Outcome), *NO_RESULT) if any(end[each] for end in ends)]
    shape, dimensions = found["rate"].shape, found["rate"].dims
    return found.assign(
        {
            f"ended_{name}": (
                dimensions,
                np.array([end[name] for end in ends]).reshape(shape),
                {"units": "1", "long_name": name.replace("_", " ")},
            )
            for name in occurred
        }
    )


def _grounds(scenario: Scenario, terrains: Mapping[str, Terrain] | None) -> Mapping[str, Terrain]:
    if terrains is None:
        return {scenario.terrain.kind: scenario.terrain}
    if not isinstance(terrains, Mapping) or not terrains:
        raise ScenarioError("terrains", terrains, "must be a mapping from labels to terrains")
    for label, ground in terrains.items():
        if not isinstance(ground, Terrain):
            raise ScenarioError(f"terrains[{label!r}]", ground, "must be a terrain")
    return terrains
