"""Every claim in the sentences of many stops is compared with tables, geometry and branches."""

import collections
from collections.abc import Callable

import pytest

from tests.judges.claims import false_claims
from tests.trials.robots import stops

# Drawn scenarios may be odd.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")

SEED = 2026


@pytest.mark.parametrize(
    "count", [4, pytest.param(600, marks=pytest.mark.soak)], ids=["a few", "all"]
)
def test_the_claims_of_a_sentence_hold(count: int, say: Callable[[str], None]) -> None:
    claims, wrong = 0, []
    outcomes: collections.Counter[str] = collections.Counter()
    for number, (group, run) in enumerate(stops(SEED, count, "all")):
        outcomes[str(run.outcome)] += 1
        made, false = false_claims(run)
        claims += made
        wrong += [f"{number} {group}, {run.outcome}: {claim}" for claim in false]
    counts = ", ".join(f"{outcome} {n}" for outcome, n in outcomes.most_common())
    found = f"{claims} claims about {count} stops of seed {SEED} ({counts}), {len(wrong)} false"
    say("\n  ".join([found, *wrong]))
    assert len(wrong) <= 0.01 * claims
