"""Count the instructions that each track model takes to get to the middle of its climb.

Unlike times, the counts do not depend on the machine, but for its kind of processor; so they are
compared with those that are kept.

    python -m benches.instructions          # table; exit status 1 if a model has become dearer
    python -m benches.instructions --write  # keep the counts of now
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

KEPT = Path(__file__).with_suffix(".json")
"""Instructions by scene, and the compiler that they are of."""

LIMIT = 1.05
"""How many times what is kept a model may take; code that is merely laid out anew takes 1.02."""

_ROOT = Path(__file__).parents[1]
_SCENES = re.compile(r'scene!\("(\w+)"\)')
_COUNT = re.compile(r"Collected : (\d+)")
_BUILD = ["cargo", "build", "--release", "--package", "crawler2d-benches", "--bin", "climb"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Count, and compare or keep; returns the exit status."""
    parser = argparse.ArgumentParser(prog="instructions", description=__doc__)
    parser.add_argument("--write", action="store_true", help="keep the counts of now")
    options = parser.parse_args(arguments)
    if shutil.which("valgrind") is None:
        _say("instructions are not counted without valgrind (Debian: apt-get install valgrind)")
        return 2 if options.write else 0
    counts, compiler = count_all(_built()), _compiler()
    if options.write:
        KEPT.write_text(json.dumps({"compiler": compiler, "instructions": counts}, indent=1) + "\n")
        return 0
    kept = json.loads(KEPT.read_text())
    _say(table(counts, kept["instructions"]))
    if kept["compiler"] != compiler:
        _say(f"not judged: what is kept is of {kept['compiler']}, this is {compiler}")
        return 0
    if dearer := above_limit(counts, kept["instructions"]):
        _say(f"more than {LIMIT} times the instructions kept: {', '.join(dearer)}")
        _say("If that is meant, python -m benches.instructions --write keeps the new counts.")
    return 1 if dearer else 0


def scenes() -> list[str]:
    """Names of the scenes of `benches/src/lib.rs`."""
    return _SCENES.findall((_ROOT / "benches/src/lib.rs").read_text())


def count_all(program: Path) -> dict[str, int]:
    """Count the instructions of every scene, on all cores."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        counted = {scene: pool.submit(count, program, scene) for scene in scenes()}
    return {scene: each.result() for scene, each in counted.items()}


def count(program: Path, scene: str) -> int:
    """Count the instructions of a scene."""
    command = [
        "valgrind",
        "--tool=callgrind",
        "--callgrind-out-file=/dev/null",
        str(program),
        scene,
    ]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    found = _COUNT.search(done.stderr)
    assert found is not None, done.stderr
    return int(found[1])


def above_limit(counts: Mapping[str, int], kept: Mapping[str, int]) -> list[str]:
    """Scenes that take more than the limit allows; one that is not kept is new."""
    return [scene for scene in counts if counts[scene] > LIMIT * kept.get(scene, counts[scene])]


def table(counts: Mapping[str, int], kept: Mapping[str, int]) -> str:
    """Lay out the counts beside those kept."""
    rows = ["scene                        million    kept   ratio"]
    for scene, now in counts.items():
        before = kept.get(scene, now)
        rows.append(f"{scene:26} {now / 1e6:9.1f} {before / 1e6:7.1f} {now / before:7.3f}")
    return "\n".join(rows)


def _compiler() -> str:
    said = subprocess.check_output(["rustc", "-vV"], text=True)
    host, release = re.findall(r"^(?:host|release): (.+)$", said, re.MULTILINE)
    return f"rustc {release} for {host}"


def _built() -> Path:
    subprocess.run(_BUILD, check=True, cwd=_ROOT)
    return _ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "release" / "climb"


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    sys.exit(main())
