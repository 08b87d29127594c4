"""Whether the tests of the core notice a small fault in it, for a sample of all faults.

    python -m tests.mutants.core [GROUP ...] [--sample 400] [--seed 1] [--seconds 30]

cargo-mutants lists the faults, and `.cargo/mutants.toml` says which of them no test can tell from
the core. A sample of a group is built at once, each fault behind a switch; `core` is all groups in
one, and by default every other is tried. Each unit test and each fact runs once by itself, which
gives the faults that it reaches and its time; then a fault meets the tests that reach it until one
fails, or their times add up to `--seconds`: first those that are quick and have noticed others.
Printed are the survivors, and how many were noticed of each group and of each room in it, with
Wilson's interval at 95 %; those at which tests ran out of time before any failed count as noticed,
and are also counted separately. The exit status is 1 if there are survivors. Tests of the Python
package are not met.
"""

import argparse
import os
import random
import subprocess
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from crawler2d import wilson
from tests.mutants.build import FOLDER, ROOT, TREE, built
from tests.mutants.weaving import Fault, listed

PROGRAM = Path(sys.executable).parent / "cargo-mutants"
BATCH = 1.0
"""[s] Quick tests run together in one process, up to this."""
PATIENCE = 10.0
"""[s] A batch of tests that takes ten times as long as without the fault, and this, has failed."""

GROUPS = {
    "solver": ("solver",),
    "dynamics": ("dynamics",),
    "contact": ("contact", "geometry", "terrain"),
    "judges": ("observe", "diagnosis"),
    "jams": ("jams",),
    "runs": ("run", "robot", "scenario"),
}
"""Rooms whose faults are drawn together."""
CORE = {"core": tuple(room for rooms in GROUPS.values() for room in rooms)}


@dataclass(frozen=True)
class Test:
    """A test that passes without faults."""

    program: Path
    name: str
    seconds: float


@dataclass(frozen=True)
class Verdict:
    """Whether tests notice a fault."""

    fault: Fault
    tests: int
    """Number of tests that have met it."""
    is_noticed: bool
    is_late: bool = False
    """Noticed because tests ran out of time, before any failed."""


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("groups", nargs="*", choices=[*GROUPS, *CORE, []], metavar="GROUP")
    parser.add_argument("--sample", type=int, default=400, help="faults of each group")
    parser.add_argument("--seed", type=int, default=1, help="which of them")
    parser.add_argument("--seconds", type=float, default=30.0, help="of tests for each fault")
    asked = parser.parse_args()
    left = 0
    for name in asked.groups or GROUPS:
        left += tried(name, asked.sample, asked.seed, asked.seconds)
    return 1 if left else 0


def tried(name: str, size: int, seed: int, seconds: float) -> int:
    """Try a sample of a group, and return the number of survivors."""
    rooms = (GROUPS | CORE)[name]
    every = faults_of(rooms)
    drawn = random.Random(seed).sample(every, len(every))
    faults, programs = built(drawn, size)
    print(f"{name}: {len(faults)} faults of {len(every)} built", flush=True)
    reached = defaultdict(list)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for test, numbers in pool.map(traced, tests_of(programs)):
            for number in numbers:
                reached[number].append(test)
        kills: Counter[Test] = Counter()
        verdicts = []
        for verdict in pool.map(
            lambda fault: met(fault, reached[fault.number], seconds, kills), faults
        ):
            verdicts.append(verdict)
            if not verdict.is_noticed:
                fault, tests = verdict.fault, verdict.tests
                print(f"{fault.name} (met {tests} of {len(reached[fault.number])})", flush=True)
    sizes = Counter(map(room_of, every))
    for room in rooms if len(rooms) > 1 else ():
        print_score(
            f"  {room}", [each for each in verdicts if room_of(each.fault) == room], sizes[room]
        )
    print_score(name, verdicts, len(every))
    return sum(not verdict.is_noticed for verdict in verdicts)


def print_score(name: str, verdicts: list[Verdict], size: int) -> None:
    noticed = sum(verdict.is_noticed for verdict in verdicts)
    late = sum(verdict.is_late for verdict in verdicts)
    rate = wilson(noticed, len(verdicts))
    print(
        f"{name}: {noticed} of {len(verdicts)} noticed, {late} of them by running out of time, "
        f"of {size} in all: {rate.rate:.1%} ({rate.low:.1%} to {rate.high:.1%})",
        flush=True,
    )


def room_of(fault: Fault) -> str:
    return Path(fault.file).parts[2]


def faults_of(rooms: tuple[str, ...]) -> list[Fault]:
    files = [f"--file=rust_core/src/{room}/**" for room in rooms]
    return listed(printed(PROGRAM, "mutants", "--list", "--json", *files))


def printed(program: Path, *arguments: str) -> str:
    command = [str(program), *arguments]
    return subprocess.run(command, check=True, cwd=ROOT, stdout=subprocess.PIPE, text=True).stdout


def tests_of(programs: list[Path]) -> Iterator[tuple[Path, str]]:
    for program in programs:
        for line in printed(program, "--list", "--format=terse").splitlines():
            yield program, line.removesuffix(": test")


def traced(test: tuple[Path, str]) -> tuple[Test, list[int]]:
    """Run a test without faults; return it with the numbers of the faults that it reaches."""
    program, name = test
    trace = FOLDER / "traces" / f"{program.name}.{name}".replace(":", ".")
    trace.parent.mkdir(exist_ok=True)
    trace.unlink(missing_ok=True)
    begun = time.monotonic()
    if failing([Test(program, name, 0.0)], None, {"CRAWLER2D_TRACE": str(trace)}):
        raise SystemExit(f"{name} fails without a fault")
    found = trace.read_text().split() if trace.exists() else []
    return Test(program, name, time.monotonic() - begun), [int(number) for number in found]


def met(fault: Fault, tests: list[Test], seconds: float, noticed: Counter[Test]) -> Verdict:
    """Let tests meet a fault until one notices it, and count how many each test has `noticed`."""
    count = 0
    promising = sorted(tests, key=lambda test: test.seconds / (1 + noticed[test]))
    for batch in batches(promising, seconds):
        count += len(batch)
        for program in {test.program for test in batch}:
            own = [test for test in batch if test.program == program]
            limit = PATIENCE + 10.0 * sum(test.seconds for test in own)
            try:
                failed = failing(own, limit, {"CRAWLER2D_FAULT": str(fault.number)})
            except subprocess.TimeoutExpired:
                return Verdict(fault, count, is_noticed=True, is_late=True)
            if failed:
                noticed.update(failed)
                return Verdict(fault, count, is_noticed=True)
    return Verdict(fault, count, is_noticed=False)


def batches(tests: list[Test], seconds: float) -> Iterator[list[Test]]:
    """Yield tests that run together; those beyond `seconds` in all are left out."""
    batch: list[Test] = []
    for test in tests:
        if test.seconds > seconds:
            continue
        seconds -= test.seconds
        if batch and sum(each.seconds for each in batch) + test.seconds > BATCH:
            yield batch
            batch = []
        batch.append(test)
    if batch:
        yield batch


def failing(tests: list[Test], limit: float | None, variables: dict[str, str]) -> list[Test]:
    """Run tests of one program; return those that fail, or all if that does not say which."""
    ended = subprocess.run(
        [tests[0].program, "--exact", "--test-threads=1", *(test.name for test in tests)],
        check=False,
        cwd=TREE / "rust_core",
        env=os.environ | variables,
        timeout=limit,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    if ended.returncode == 0:
        return []
    lines = set(ended.stdout.splitlines())
    return [test for test in tests if f"test {test.name} ... FAILED" in lines] or tests


if __name__ == "__main__":
    raise SystemExit(main())
