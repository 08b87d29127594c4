"""Equal accuracy: each engine's cheapest setting within the same error limits.

The rule, for one engine on one scene:

1. Its *limit* is its finest setting. Its path over the first draws is compared, at equal times,
   with that of the next finest setting, which is coarser in every respect by a factor of two; in
   crawler2d, whose steps are then twice as long, by a factor of four in accuracy. If they differ by
   more than 1 cm in any draw, the scene is *chaotic* for the engine.
2. Settings are tried in the order of their measured cost. One is rejected as soon as a draw exceeds
   1 mm of overlap with the ground or a pin gap of 0.2 mm, or the robot flies off.
3. If the scene is not chaotic, the path must stay within 1 cm of the limit's in each of the first
   draws. If it is, the 95 % Wilson interval of the setting's rate of clearing, over all draws, must
   contain the limit's rate over the same draws.

The first accepted setting is the cheapest. If there is none, the engine has no setting of that
accuracy in the grid. crawler2d has to do with its one default accuracy in every scene.
"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

from benches.peers.engine import Engine, Setting
from benches.peers.errors import PATH, judge
from benches.peers.motion import Motion
from benches.peers.scenes import Draw, Scene
from benches.peers.timing import progress
from crawler2d.sweeps.statistics import wilson

COST_SPAN = 2.5
"""[s] Simulated time of the first measurement of cost: up to the obstacle and onto it."""


@dataclass(frozen=True)
class Effort:
    """How thorough the search is.

    Attributes
    ----------
    paths : int
        Number of draws whose paths are compared.
    ensemble : int
        Number of draws for a rate.
    finest_step : float
        [s] Time steps below this are not tried.
    """

    paths: int
    ensemble: int
    finest_step: float = 0.0


@dataclass(frozen=True)
class Limit:
    """What an engine converges to.

    Attributes
    ----------
    spread : float
        [m] Largest distance between the paths of the two finest settings.
    paths : list of Motion
        Paths of the first draws.
    cleared, count : int
        Over the ensemble, or over the first draws if the scene is not chaotic.
    penetration, gap : float
        [m] Errors of the finest setting.
    """

    spread: float
    paths: list[Motion]
    cleared: int
    count: int
    penetration: float
    gap: float

    @property
    def is_chaotic(self) -> bool:
        """Whether single runs cannot be compared."""
        return self.spread > PATH


def search(engine: Engine, scene: Scene, draws: list[Draw], effort: Effort) -> dict[str, Any]:
    """Find the cheapest accurate setting of an engine on a scene.

    Returns
    -------
    dict
        `limit`, `tried` in the order of cost, and `found`: a setting's fields or None.
    """
    variants = [scene.vary(draw) for draw in draws[: effort.ensemble]]
    limit = find_limit(engine, variants, effort)
    kind = "chaotic" if limit.is_chaotic else "converged"
    progress(f"  {engine.name}: {kind}, finest settings {limit.spread * 1e3:.2f} mm apart")
    tried: list[dict[str, Any]] = []
    found = None
    for cost, setting in by_cost(engine, scene, effort):
        verdict = _verdict(engine, variants, setting, limit, effort)
        tried.append({"setting": str(setting), "cost": cost, **verdict})
        if verdict["accepted"]:
            found = asdict(setting)
            break
    outcome = tried[-1]["setting"] if found else "nothing"
    progress(f"  {engine.name}: {outcome} after {len(tried)} settings")
    return {"limit": _plain(limit), "tried": tried, "found": found}


def find_limit(engine: Engine, variants: list[Scene], effort: Effort) -> Limit:
    """Run the two finest settings, and the ensemble only if they differ."""
    first = [judge(engine, scene, engine.finest) for scene in variants[: effort.paths]]
    spread = max(
        judge(engine, scene, engine.next_finest).motion.distance(run.motion)
        for scene, run in zip(variants, first, strict=False)
    )
    runs = list(first)
    if spread > PATH:
        runs += [judge(engine, scene, engine.finest) for scene in variants[effort.paths :]]
    return Limit(
        spread,
        [run.motion for run in first],
        sum(run.cleared for run in runs),
        len(runs),
        max(run.penetration for run in runs),
        max(run.gap for run in runs),
    )


def by_cost(engine: Engine, scene: Scene, effort: Effort) -> list[tuple[float, Setting]]:
    """Sort the grid by wall time per simulated second, measured on the scene."""
    finest = effort.finest_step
    grid = [each for each in engine.grid if each.accuracy or each.time_step >= finest]
    costs = [engine.wall_time(scene, setting, COST_SPAN) / COST_SPAN for setting in grid]
    return sorted(zip(costs, grid, strict=True), key=lambda row: row[0])


def _verdict(
    engine: Engine, variants: list[Scene], setting: Setting, limit: Limit, effort: Effort
) -> dict[str, Any]:
    """Judge a setting; stop at the first broken rule."""
    penetration = gap = distance = 0.0
    cleared = 0
    count = effort.ensemble if limit.is_chaotic else effort.paths
    for index, scene in enumerate(variants[:count]):
        run = judge(engine, scene, setting)
        penetration, gap = max(penetration, run.penetration), max(gap, run.gap)
        cleared += run.cleared
        if index < effort.paths:
            distance = max(distance, run.motion.distance(limit.paths[index]))
        if not run.is_sound or (distance > PATH and not limit.is_chaotic):
            return _row(penetration, gap, distance, accepted=False)
    if not limit.is_chaotic:
        return _row(penetration, gap, distance, accepted=True)
    _, low, high = wilson(cleared, count)
    accepted = low <= limit.cleared / limit.count <= high
    return _row(penetration, gap, distance, accepted=accepted) | {
        "cleared": cleared,
        "count": count,
    }


def _row(penetration: float, gap: float, distance: float, *, accepted: bool) -> dict[str, Any]:
    return {
        "penetration": penetration,
        "gap": gap,
        "distance": distance,
        "accepted": accepted,
    }


def _plain(limit: Limit) -> dict[str, Any]:
    return {
        "spread": limit.spread,
        "is_chaotic": limit.is_chaotic,
        "cleared": limit.cleared,
        "count": limit.count,
        "penetration": limit.penetration,
        "gap": limit.gap,
        "final_x": float(limit.paths[0].poses[-1, 0, 0]),
    }
