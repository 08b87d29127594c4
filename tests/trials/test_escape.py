"""Escape forces: below the lower level a robot stays, above the upper one it gets free.

The push is applied differently from the measurement: it rises linearly, in five seconds.
"""

import collections
import math
from collections.abc import Callable

import pytest

import crawler2d as c2d
from crawler2d.parameters.terrain import Lanes, RandomStepfield
from tests.trials.robots import stops

# Drawn scenarios may be odd.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")

SEED = 77
RISE, HOLD = 5.0, 4.0  # [s]


def gets_on(run: c2d.Run, force: float) -> bool:
    """Whether a robot gets farther than before under a push that rises linearly and stays."""
    direction = math.copysign(1.0, run.scenario.drive.speed)
    pushed = run.branch(push=(direction * force, RISE), duration=RISE + HOLD)
    ahead = (direction * pushed.position[:, 0]).max() - (direction * run.position[:, 0]).max()
    is_over = pushed.outcome in ("cleared", "tipped_over", "left_terrain")
    return is_over or bool(ahead > run.scenario.criteria.escape_distance)


@pytest.mark.parametrize(
    "count", [12, pytest.param(200, marks=pytest.mark.soak)], ids=["a few", "all"]
)
def test_an_escape_force_holds_at_its_lower_end_and_frees_at_its_upper_end(
    count: int, say: Callable[[str], None]
) -> None:
    held: dict[str, collections.Counter[bool]] = collections.defaultdict(collections.Counter)
    moved: dict[str, collections.Counter[bool]] = collections.defaultdict(collections.Counter)
    wedged = 0
    for _, run in stops(SEED, count, None):
        why = run.diagnosis
        assert why is not None
        low, high = run.escape_force()
        wedged += math.isinf(high)
        on_lanes = isinstance(run.scenario.terrain, (Lanes, RandomStepfield))
        pools = ["all", str(run.outcome), "two lanes" if on_lanes else "one lane"]
        pools.append("at rest" if why.stationary else "rattling")
        holds = not gets_on(run, 0.9 * low)
        gives = math.isinf(high) or gets_on(run, 1.1 * high)
        for pool in pools:
            held[pool][holds] += 1
            moved[pool][gives] += 1
        if not (holds and gives):
            say(
                f"{run.outcome} {run.scenario.robot.track.kind} {low:.1f} {high:.1f} N, {pools[2:]}"
            )
    for pool, holding in held.items():
        stays, leaves = holding[True], moved[pool][True]
        found = f"{stays} stay at 0.9 of the lower, {leaves} get on at 1.1 of the upper"
        say(f"{pool}: of {holding.total()} {found}")
    say(f"{wedged} are moved by no push")
    assert held["at rest"][True] >= 0.9 * held["at rest"].total()
    assert moved["at rest"][True] >= 0.9 * moved["at rest"].total()
