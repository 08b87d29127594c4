"""Trials from other starts: the robot is lifted at its stop, and set down nearby."""

import collections
import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

import crawler2d as c2d
from tests.trials.robots import stops

# Drawn scenarios may be odd.
pytestmark = [
    pytest.mark.soak,
    pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning"),
]

SEED, COUNT = 2026, 600
ROOT = Path(__file__).parents[2]
COMMAND = "cargo test --release -p crawler2d-core --lib -- --ignored trials_from_other_starts"


def test_trials_have_the_same_result_from_nearby_poses(
    tmp_path: Path, say: Callable[[str], None]
) -> None:
    found = list(stops(SEED, COUNT, "all"))
    lines, freed = [], []
    for _, run in found:
        assert run.diagnosis is not None
        trials = {
            trial.name: trial.freed
            for trial in run.diagnosis.trials
            if trial.name not in ("unchanged", "rebuilt")
        }
        freed.append(trials)
        stop = {
            "scenario": run.scenario.to_json(),
            "at": run.diagnosis.time,
            "trials": list(trials),
        }
        lines.append(json.dumps(stop))
    path = tmp_path / "stops.jsonl"
    path.write_text("\n".join(lines), encoding="utf-8")
    environment = os.environ | {"CRAWLER2D_STOPS": str(path)}
    subprocess.run(COMMAND.split(), cwd=ROOT, env=environment, check=True)
    text = path.with_suffix(".jsonl.answers").read_text(encoding="utf-8")
    answers = [json.loads(line) for line in text.splitlines()]
    alike: dict[tuple[str, bool], collections.Counter[bool]] = collections.defaultdict(
        collections.Counter
    )
    for (group, run), was, again in zip(found, freed, answers, strict=True):
        for name, before in was.items():
            if again[name] is None:
                continue
            same = again[name] == before
            for pool in ("all", name, group, str(run.outcome)):
                alike[pool, before][same] += 1
    for (pool, before), counts in sorted(alike.items()):
        share, low, high = c2d.wilson(counts[True], counts.total())
        word = "freed" if before else "not freed"
        text = f"{100 * share:.1f} % ({100 * low:.1f} to {100 * high:.1f})"
        say(f"{pool}, {word}: {counts[True]} of {counts.total()} alike, {text}")
    holds = {before: alike["all", before] for before in (True, False)}
    assert holds[True][True] >= 0.95 * holds[True].total()
    assert holds[False][True] >= 0.90 * holds[False].total()
