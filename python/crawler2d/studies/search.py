"""Find the cheapest candidate that clears a set of terrains, and confirm it with fresh runs."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np

from crawler2d.common.arrays import real_number, whole_number
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError, raise_first
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.studies.campaign import Campaign, Sampling, Tally, campaign
from crawler2d.studies.candidates import (
    Candidate,
    Confirmation,
    FreshDraws,
    halve,
    ranked,
    search_table,
)
from crawler2d.studies.tables import (
    Models,
    check_study,
    paths_of,
    read_terrains,
    refuse_own,
    vary_fields,
)
from crawler2d.sweeps.axes import Label
from crawler2d.sweeps.sweep import variants
from crawler2d.variation.draws import Variation

if TYPE_CHECKING:
    from crawler2d.sweeps.figure_dataset import FigureDataset

__all__ = ["search"]

_FRESH_SEED = 2**64
"""Users' seeds are smaller, so larger seeds draw other numbers."""

Objective = Callable[[Scenario], float]


@takes_keywords
def search(
    scenario: Scenario,
    space: Models,
    objective: Objective | None = None,
    *,
    terrains: Mapping[Any, Terrain] | Sequence[Terrain] | None = None,
    at_least: float = 0.95,
    first: int = 20,
    confirm: int = 1000,
    **sampling: Unpack[Sampling],
) -> FigureDataset:
    """Find the cheapest candidate that clears every terrain, such as the one with fewest wheels.

    In the search every run has its own draw of what varies *and* of the uncertain parameters: a
    different robot on a different floor. All candidates are simulated a few times, then the better
    half twice as often, and so on down to two (successive halving). The winner is partly lucky, so
    winner and runner-up are simulated again with fresh draws, and only those runs give their
    success rates.

    Parameters
    ----------
    scenario : Scenario
        The scenario that all runs share.
    space : mapping of str to track or fields, or sequence of tracks
        The candidates, like the models of `compare`. Those that break a rule, such as wheels that
        do not fit, are left out.
    objective : callable, optional
        Cost to minimize among the candidates that reach the goal: takes a `Scenario`, returns a
        number. None counts the wheels of one side; every candidate must then have wheels.
    terrains : mapping of str to terrain, or sequence of terrains, optional
        Terrains to clear: a candidate counts by its lowest rate over them. None takes the
        scenario's own.
    at_least : float
        [-] The goal: required rate of clearing on every terrain, above 0, at most 1.
    first : int
        Runs of every candidate on each terrain in the first round, 1 to 1,000,000. More runs reduce
        the chance of eliminating a good but unlucky candidate.
    confirm : int
        Fresh runs of winner and runner-up on each terrain, 1 to 1,000,000. With unknowns, the same
        number again is spread over `samples` of them, for the band.
    **sampling
        See `crawler2d.studies`; there is no `until`. Unless `vary` is given, every run on a random
        step field also has its own field.

    Returns
    -------
    FigureDataset
        Dimensions `candidate` and `terrain`. From the search:

        - `rate`, `low`, `high`, `count`: with intervals valid for repeated checks; rates of the
          last candidates are biased high by the selection;
        - `cost` and `round` of each candidate: its cost and number of rounds;
        - `ending`: the commonest outcome of failed runs.

        From the confirmation, NaN for all but winner and runner-up:

        - `confirmed_rate`, `confirmed_low`, `confirmed_high`, `confirmed_count`: from `confirm`
          fresh runs, with Wilson's interval;
        - `confirmed`: whether the rate reaches the goal on every terrain;
        - with unknowns `band_low`, `band_median`, `band_high`: the rates of single samples of the
          unknowns.

        The attributes `winner` and `runner_up` are the choice of the search: the cheapest candidate
        that reached the goal, else the one with the highest rate. `verdict` describes it with the
        confirmed rates. If these fall short, the choice stays and the verdict says so, as trying
        others until one is confirmed would again select by luck. `settings` is the number of
        candidates times terrains, `refused` the number left out, `refusals` the reasons.

    Raises
    ------
    ScenarioError
        If an argument breaks a rule, or all candidates do.

    References
    ----------
    Karnin, Z., Koren, T., Somekh, O. (2013). Almost optimal exploration in multi-armed bandits.
    Proceedings of the 30th International Conference on Machine Learning. Their halving, except that
    here candidates that certainly fail drop at once, and eliminated ones may return.

    Examples
    --------
    Every combination of two lists is one candidate:

    >>> from itertools import product
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> space = {
    ...     f"{n} of {1e3 * r:.0f} mm": c2d.LineOfWheels(n, wheel_radius=r)
    ...     for n, r in product((2, 3), (0.06, 0.064))
    ... }
    >>> found = c2d.studies.search(base, space, first=5, confirm=20, progress=False)
    >>> found.attrs["winner"], found["confirmed"].sel(candidate="3 of 60 mm").item()
    ('3 of 60 mm', True)
    """
    check_study(scenario)
    goal = real_number(at_least, "at_least")
    if not 0.0 < goal <= 1.0:
        raise ScenarioError("at_least", goal, "must be > 0 and at most 1")
    if objective is not None and not callable(objective):
        raise ScenarioError("objective", objective, "must be a callable that takes a Scenario")
    fresh = whole_number(confirm, "confirm", 1, 10**6)
    grounds = read_terrains(scenario, terrains)
    fields = variants(space, "space")
    refuse_own(fields, ["terrain"] if terrains is not None else [], "space")
    swept = ["terrain", *paths_of(fields)]
    if sampling.get("vary") is None and any(hasattr(ground, "seed") for ground in grounds.values()):
        sampling = {**sampling, "vary": vary_fields(grounds)}
    with campaign(
        scenario, sampling, swept, repeats=whole_number(first, "first", 1, 10**6)
    ) as study:
        candidates, refusals = _candidates(study, fields, grounds, objective)
        study.settings += len(candidates) * len(grounds)
        rounds = halve(study, candidates, goal, study.until.min_runs)
        confirmed = _confirmed(study, ranked(candidates, goal)[:2], fresh)
        cost = "wheels a side" if objective is None else getattr(objective, "__name__", "cost")
        return search_table(study, candidates, list(grounds), confirmed, goal).assign_attrs(
            objective=cost,
            first=study.until.min_runs,
            rounds=rounds,
            confirm=fresh,
            refused=len(refusals),
            refusals="; ".join(refusals),
        )


def _candidates(
    study: Campaign,
    fields: Mapping[Label, Mapping[str, Any]],
    grounds: Mapping[Label, Any],
    objective: Objective | None,
) -> tuple[list[Candidate], list[str]]:
    """Make the candidates, and list the reasons for those left out."""
    own = study.planner
    nominal = replace(own, unknowns=Variation({}))
    planner = FreshDraws(own.variation, own.unknowns, own.seed)
    candidates, refusals, errors = [], [], []
    for label, each in fields.items():
        worlds = []
        for name, ground in grounds.items():
            cell = study.base.replace({"terrain": ground, **each})
            worlds += nominal.worlds(cell, (f"candidate={label}", f"terrain={name}"))
        broken = [world.checked for world in worlds if isinstance(world.checked, ScenarioError)]
        if broken:
            errors += broken
            refusals.append(str(broken[0]))
            continue
        tallies = [Tally(world, study.until, planner=planner) for world in worlds]
        candidates.append(Candidate(label, _cost(worlds[0].cell, label, objective), tallies))
    if not candidates:
        raise_first(errors)
    return candidates, refusals


def _cost(scenario: Scenario, label: Label, objective: Objective | None) -> float:
    if objective is not None:
        cost = real_number(objective(scenario), f"objective of {label}")
        if not np.isfinite(cost):
            raise ScenarioError(f"objective of {label}", cost, "must be finite")
        return cost
    wheels = int(np.count_nonzero(scenario.robot.wheels()["side"] == "left"))
    if wheels == 0:
        rule = f"must be given: {label} has no wheels to count"
        raise ScenarioError("objective", None, rule)
    return float(wheels)


def _confirmed(study: Campaign, chosen: Sequence[Candidate], fresh: int) -> list[Confirmation]:
    """Simulate the choice with fresh draws."""
    own = study.planner
    planner = FreshDraws(own.variation, own.unknowns, own.seed + _FRESH_SEED)
    by_robot = replace(own, seed=own.seed + 2 * _FRESH_SEED)
    confirmations = []
    for candidate in chosen:
        worlds = [tally.world for tally in candidate.tallies]
        pooled = [Tally(world, study.until, planner=planner) for world in worlds]
        robots = [
            [
                Tally(each, study.until, planner=by_robot)
                for each in by_robot.worlds(world.cell, world.labels)
            ]
            for world in (worlds if own.unknowns.distributions else [])
        ]
        confirmations.append(Confirmation(candidate, pooled, robots))
    single = [tally for each in confirmations for robots in each.robots for tally in robots]
    raise_first(tally.world.checked for tally in single)
    due = [(tally, fresh) for each in confirmations for tally in each.pooled]
    repeats = max(fresh // own.samples, 1)
    study.simulate([*due, *((tally, repeats) for tally in single)])
    return confirmations
