"""Counts of instructions: which scenes have one, and which of them are above the limit."""

import json
from pathlib import Path

from benches.instructions import KEPT, LIMIT, above_limit, scenes, table

SCENARIOS = Path(__file__).parents[1] / "scenarios"


def test_every_scene_has_a_file_and_a_count() -> None:
    kept = json.loads(KEPT.read_text(encoding="utf-8"))["instructions"]
    assert list(kept) == scenes()
    assert len(kept) == 16
    assert all((SCENARIOS / f"{scene}.json").is_file() for scene in kept)
    assert all(count > 1_000_000 for count in kept.values())


def test_what_takes_more_than_the_limit_is_named() -> None:
    kept = {"belt": 1_000_000, "chain": 1_000_000}
    now = {"belt": round(1e6 * LIMIT) + 1, "chain": round(1e6 * LIMIT), "new": 5}
    assert above_limit(now, kept) == ["belt"]
    assert [line.split()[-1] for line in table(now, kept).splitlines()] == [
        "ratio",
        "1.050",
        "1.050",
        "1.000",
    ]
