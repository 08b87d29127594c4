"""Whether a change of the code leaves the motion of every run unchanged, to the last bit.

`python -m tests.same_runs FILE` writes hashes of some 420 runs into a new file, or compares the
runs with those of a file that is there. Write the file with the code before, compare with the code
after, on one machine: another processor or libm may round differently.
"""

import hashlib
import json
import sys
import warnings
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.dataset import UNITS
from tests.fuzz.drawn_robots import Draw
from tests.fuzz.drawn_scenes import drawn_scenario
from tests.shared import VARIANTS

DRAWN = 400


def scenarios() -> Iterator[tuple[str, Scenario]]:
    """Yield one scenario of every kind, and drawn ones."""
    yield from VARIANTS.items()
    for seed in range(DRAWN):
        yield f"drawn {seed}", drawn_scenario(Draw(seed))


def digest(scenario: Scenario) -> dict[str, str]:
    """Hash a scenario as JSON, and the bits of all its results."""
    said = hashlib.sha256(scenario.to_json().encode())
    moved = hashlib.sha256()
    try:
        run = c2d.simulate(scenario, record="full", trials=None)
    except c2d.errors.Crawler2dError as error:
        moved.update(type(error).__name__.encode())
    else:
        moved.update(str(run.outcome).encode())
        tables = (run.events, run.edges, run.contacts)
        columns = [table[name] for table in tables for name in table]
        for values in (*run.metrics.values(), *(getattr(run, name) for name in UNITS), *columns):
            array = np.asarray(values)
            text = str(array.tolist()) if array.dtype.kind in "OUT" else None
            moved.update(array.tobytes() if text is None else text.encode())
    return {"scenario": said.hexdigest()[:16], "motion": moved.hexdigest()[:16]}


def main(path: Path) -> int:
    """Write the file, or compare with it and print which runs differ."""
    warnings.simplefilter("ignore", c2d.ScenarioWarning)
    found = {name: digest(scenario) for name, scenario in scenarios()}
    if not path.exists():
        path.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        print(f"hashes of {len(found)} runs written to {path}")
        return 0
    before = json.loads(path.read_text(encoding="utf-8"))
    changed = {
        what: [name for name in found if before.get(name, {}).get(what) != found[name][what]]
        for what in ("scenario", "motion")
    }
    for what, names in changed.items():
        print(f"{what}: {len(names)} of {len(found)} differ", *names[:20])
    return int(any(changed.values()) or before.keys() != found.keys())


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
