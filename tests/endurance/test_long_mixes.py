"""An hour of driving over mixed scenes: nothing comes apart, penetrates, diverges or grows."""

import os
import random
import sys
import time
from collections import defaultdict
from collections.abc import Callable, Iterable

import pytest

from tests.endurance.mixed_scenes import ROBOTS, scenes
from tests.endurance.resources import check_flat, held
from tests.endurance.watch import Seen, driven

Say = Callable[[str], None]

SEED = int(os.environ.get("CRAWLER2D_FUZZ_SEED", "1"))

pytestmark = [
    pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning"),
    pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc"),
]


def check(seconds: float, say: Say, grounds: Iterable[str] = ()) -> None:
    """Drive for a time in every scene, or in those on certain grounds."""
    chosen = {
        place: scenario
        for place, scenario in scenes(SEED).items()
        if not grounds or place[1] in grounds
    }
    for place, scenario in chosen.items():  # one-time allocations
        driven(str(place), scenario, min(seconds, 20.0), random.Random(0))
    before, begin = held(), time.monotonic()
    by_model: dict[str, Seen] = defaultdict(Seen)
    for (name, ground), scenario in chosen.items():
        draw = random.Random(f"{SEED}:{name}:{ground}:drive")
        by_model[name].add(driven(f"{name}, {ground}", scenario, seconds, draw))
    after, took = held(), time.monotonic() - begin
    total = Seen()
    for name, seen in by_model.items():
        say(f"{name}: {seen}")
        total.add(seen)
    # An hour may cost a megabyte; what a few seconds cost is the allocator's.
    flat = check_flat(before, after, 1.0 * max(1.0, total.seconds / 3600.0))
    say(f"seed {SEED}, {len(chosen)} scenes, {total.seconds:.0f} s in {took:.0f} s: {flat}")
    assert set(by_model) == set(ROBOTS)
    assert total.faults == []


def test_every_model_holds_together_on_steps_for_two_seconds(say: Say) -> None:
    check(2.0, say, ("step",))


@pytest.mark.soak
def test_an_hour_of_mixed_scenes_holds_together_and_leaves_nothing_behind(say: Say) -> None:
    check(60.0, say)
