"""Fuzzing that looks for paths: `python -m tests.fuzz.guided MINUTES [TARGET ...]`, or make fuzz.

All targets have a share of the minutes, as many at a time as there are processors. libFuzzer
changes cases and keeps those that reach edges of the code that no other has. It begins with the
cases that are kept in the repository, those of former times in out/fuzz, and files of the tests.
`... guided keep` keeps in the repository, of its cases and what has come up since, a few that
together reach most of these edges.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from tests.fuzz import model_files
from tests.fuzz.account import SEED

ROOT = Path(__file__).parents[2]
OUT = ROOT / "out" / "fuzz"
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "release"
SCENARIOS = {path.name: path.read_bytes() for path in (ROOT / "tests/scenarios").glob("*.json")}
NOISE = {f"{n}": bytes((n * k * k + k) % 251 for k in range(120)) for n in range(8)}

LIMITS = ("-timeout=60", "-report_slow_units=60", "-rss_limit_mb=2000", "-len_control=0")
"""What a case may take, [s] of the clock and [MB]; and cases of any length from the beginning."""

LARGEST_KEPT, MOST_KEPT = 2500, 40
"""[bytes] A case that is kept in the repository, as large as scenarios are, and how many of a
target."""


@dataclass(frozen=True)
class Target:
    """A fuzzed target."""

    name: str
    seeds: Mapping[str, bytes]
    longest: int
    """[bytes] A case."""
    is_rust: bool = False

    @property
    def command(self) -> list[str]:
        """The command that tries cases, to which options of libFuzzer are appended."""
        if self.is_rust:
            return [str(BUILT / f"fuzz-{self.name}")]
        return [sys.executable, "-m", "tests.fuzz.guided_target", self.name]

    @property
    def kept(self) -> Path:
        """The cases in the repository."""
        folder = "rust_core/fuzz/corpus" if self.is_rust else "tests/fuzz/corpus"
        return ROOT / folder / self.name

    @property
    def found(self) -> Path:
        """The cases of earlier runs."""
        return OUT / self.name / "cases"

    def run(self, *options: str) -> str:
        """Call it; return its output."""
        command = [*self.command, f"-max_len={self.longest}", *LIMITS, *options]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, check=False)
        text = (done.stdout + done.stderr).decode(errors="replace")
        (OUT / self.name / "log.txt").write_text(text, encoding="utf-8")
        return text

    def fuzz(self, seconds: float) -> tuple[str, bool]:
        """Try cases for a time; return the result, and whether it was a fault."""
        faults, seeds = OUT / self.name / "faults", OUT / self.name / "seeds"
        for folder in (self.found, faults, seeds, self.kept):
            folder.mkdir(parents=True, exist_ok=True)
        for name, data in self.seeds.items():
            (seeds / name).write_bytes(data)
        before = set(faults.iterdir())
        text = self.run(
            f"-seed={SEED}",
            f"-max_total_time={round(seconds)}",
            f"-artifact_prefix={faults}/",
            *(str(folder) for folder in (self.found, self.kept, seeds)),
        )
        told = re.findall(r"#(\d+)\t(\w+) +cov: (\d+)", text)
        begin = next((edges for _, what, edges in told if what == "INITED"), "?")
        count, last, end = told[-1] if told else ("0", "", "?")
        new = sorted(set(faults.iterdir()) - before)
        line = f"{self.name}: {count} cases, edges {begin} to {end}, seed {SEED}, {len(new)} faults"
        for path in new:
            replay = " ".join([*self.command, str(path)]).replace(f"{ROOT}/", "")
            line += f"\n  FAULT {path.relative_to(ROOT)}; again: {replay}"
        is_fault = bool(new) or last != "DONE"
        if is_fault:
            line += f"\n  {OUT.relative_to(ROOT)}/{self.name}/log.txt says more"
        return line, is_fault

    def keep(self) -> str:
        """Store in the repository the cases with the most coverage, of those stored and found."""
        short, merged = OUT / self.name / "short", OUT / self.name / "merged"
        for folder in (short, merged):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(parents=True)
        both = [path for folder in (self.kept, self.found) for path in folder.glob("*")]
        for path in both:
            if path.stat().st_size <= LARGEST_KEPT:
                shutil.copy(path, short)
        control = OUT / self.name / "reached.txt"
        control.unlink(missing_ok=True)
        how = ("-set_cover_merge=1", "-use_counters=0", f"-merge_control_file={control}")
        self.run(*how, str(merged), str(short))
        cases = [Path(name) for name in widest(control.read_text(), MOST_KEPT)]
        shutil.rmtree(self.kept, ignore_errors=True)
        self.kept.mkdir(parents=True)
        sizes = [Path(shutil.copy(path, self.kept)).stat().st_size for path in cases]
        return f"{self.name}: {len(sizes)} cases of {sum(sizes)} bytes"


def widest(control: str, most: int) -> list[str]:
    """Choose so many cases at most that together reach as much as possible.

    Parameters
    ----------
    control : str
        What libFuzzer notes of a merge: two numbers, the first that of the cases, their names with
        the smallest first, and in lines that begin with FT and a case's number what it reaches.
    most : int
        How many are wanted.
    """
    count, _, *lines = control.splitlines()
    names, notes = lines[: int(count)], lines[int(count) :]
    told = [note.split() for note in notes if note.startswith("FT ")]
    reached = {names[int(number)]: set(edges) for _, number, *edges in told}
    chosen: list[str] = []
    while reached and len(chosen) < most:
        best = max(reached, key=lambda name: len(reached[name]))
        new = reached.pop(best)
        if not new:
            break
        chosen.append(best)
        reached = {name: edges - new for name, edges in reached.items()}
    return chosen


TARGETS = [
    Target("scenario", SCENARIOS, 6000, is_rust=True),
    Target("run", SCENARIOS, 6000, is_rust=True),
    Target("terrain", NOISE, 240, is_rust=True),
    Target("snapshot", NOISE, 60, is_rust=True),
    Target("solver", NOISE, 240, is_rust=True),
    Target("model", {**model_files.SDF, **model_files.URDF}, 40_000),
    Target("xacro", model_files.XACRO, 20_000),
    Target("mjcf", model_files.MJCF, 40_000),
    Target("store", NOISE, 120),
]


def main(what: str, *names: str) -> int:
    """Fuzz for a number of minutes in total, or store what was found."""
    chosen = [target for target in TARGETS if not names or target.name in names]
    if what == "keep":
        for target in chosen:
            print(target.keep(), flush=True)
        return 0
    together = min(os.cpu_count() or 1, len(chosen))
    seconds = 60.0 * float(what) * together / len(chosen)
    with ThreadPoolExecutor(together) as pool:
        failed = False
        for line, is_fault in pool.map(lambda target: target.fuzz(seconds), chosen):
            print(line, flush=True)
            failed |= is_fault
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
