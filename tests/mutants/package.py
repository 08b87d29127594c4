"""Whether tests notice small faults in the package: each of a random sample must fail a test.

    python -m tests.mutants.package [ROOM ...] [--sample 400] [--seed 1] [--seconds 30] [--together]
        [--again]

A room is a folder or file of the package, `ROOMS` by default, with a sample of its own; of
`--together` there is one sample of all their mutants. Each mutant is tried with the tests
that execute its line, those first that are quick and have noticed others; `make coverage-python`
leaves in `out/coverage` which these are and how long they take. Those beyond `--seconds` in all are
left out: a survivor has survived the others. `out/mutants` keeps the survivors, and `--again` tries
those alone. The exit status is 1 if there are others than `EQUIVALENT` argues away. Needs fork, and
some three seconds a mutant.
"""

import argparse
import compileall
import contextlib
import functools
import importlib
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from xml.etree import ElementTree

from tests.mutants.faults import PACKAGE, Mutant, mutants

ROOT = Path(__file__).resolve().parents[2]
KNOWN = ROOT / "out/coverage"

LIBRARIES = (
    *("numpy", "pytest", "hypothesis", "scipy.stats", "scipy.optimize", "xarray", "pandas"),
    *("matplotlib.pyplot", "mujoco", "trimesh", "netCDF4", "pyarrow.parquet"),
)
"""Imported once for all mutants."""

ROOMS = ("sweeps", "variation", "audits", "reading", "patching")

# [s] Of those that are tried first: most mutants end there, and few test modules are imported.
FIRST = 2.0

BROKEN = "no test ran"
LATE = "out of time"


class Tests:
    """Which tests execute a line, and how long each takes, from a run of all with coverage.

    How many mutants each test has `noticed` is counted.
    """

    def __init__(self, longest: float) -> None:
        from coverage import CoverageData  # noqa: PLC0415 - of the group `coverage`

        self.data = CoverageData(str(KNOWN / "data"))
        self.data.read()
        self.contexts = functools.cache(self.data.contexts_by_lineno)
        self.longest = longest
        self.noticed = Counter[str]()
        self.seconds = {
            name_of(case): float(case.attrib["time"])
            for case in ElementTree.parse(KNOWN / "tests.xml").iter("testcase")
            if len(case) == 0  # neither failed nor skipped
        }

    def of(self, mutant: Mutant) -> list[str]:
        """Return the tests that can notice a mutant, the most promising first.

        There are none if it never runs.
        """
        contexts = self.contexts(str(mutant.file))
        found = [context for line in mutant.lines for context in contexts.get(line, ())]
        tests = {context.rpartition("|")[0] for context in found}
        if tests == {""}:  # in another process, which a test starts by way of the same file
            found = [context for line in contexts.values() for context in line]
            tests = {context.rpartition("|")[0] for context in found}
        # What a fixture does is told of the first test alone that asks for it.
        files = {context.partition("::")[0] for context in found if context.endswith("|setup")}
        tests |= {test for test in self.seconds if test.partition("::")[0] in files}
        if tests == {""}:  # or of another file of the room
            room = mutant.file.relative_to(PACKAGE).parts[0].removesuffix(".py")
            tests = {test for test in self.seconds if test.startswith(f"tests/{room}/")}
        chosen, total = list[str](), 0.0
        for test in sorted(tests & self.seconds.keys(), key=self.cost):
            total += self.seconds[test]
            if chosen and total > self.longest:
                break
            chosen.append(test)
        return chosen

    def cost(self, test: str) -> tuple[float, str]:
        """What a test costs for a mutant that it notices, about; tests of equal times by name."""
        return self.seconds[test] / (1 + self.noticed[test]), test

    def batches(self, chosen: list[str]) -> Iterator[list[str]]:
        """Yield the first tests, and then the others, if there are more."""
        total, count = 0.0, 0
        while count < len(chosen) and (not count or total < FIRST):
            total += self.seconds[chosen[count]]
            count += 1
        yield chosen[:count]
        if chosen[count:]:
            yield chosen[count:]

    def drop(self, tests: Iterable[str]) -> None:
        """Do not try these again."""
        for test in tests:
            del self.seconds[test]


def name_of(case: ElementTree.Element) -> str:
    """Return pytest's name of a test, of class and name in JUnit's file."""
    parts, classes = case.attrib["classname"].split("."), list[str]()
    while len(parts) > 1 and not (ROOT / "/".join(parts)).with_suffix(".py").is_file():
        classes.insert(0, parts.pop())
    return "::".join(["/".join(parts) + ".py", *classes, case.attrib["name"]])


def run_pytest(arguments: list[str], seconds: float, told: int) -> int:
    """Run tests within so many seconds of computing, and write the names of those that fail."""
    for name in [name for name in sys.modules if name.partition(".")[0] == "tests"]:
        del sys.modules[name]  # which come from the copy, too
    os.setsid()
    # At the harder limit the system sends SIGKILL, which does not tell why.
    resource.setrlimit(resource.RLIMIT_CPU, (int(seconds), int(seconds) + 5))
    signal.alarm(4 * int(seconds))
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(nowhere, stream)
    import pytest  # noqa: PLC0415 - after `main` has

    class Told:
        def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
            if report.failed:
                os.write(told, f"{report.nodeid}\n".encode())

    plain = ["-q", "--assert=plain", "-p", "no:cacheprovider", "-p", "no:cov", "-p", "no:xdist"]
    return int(pytest.main([*plain, *arguments], plugins=[Told()]))


def failures(tests: list[str], seconds: float, *options: str) -> list[str]:
    """Return the tests that fail here, in a process of its own, or why they could not end."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os._exit(run_pytest([*options, *tests], seconds, write))
        finally:
            os._exit(1)
    os.close(write)
    with open(read, encoding="utf-8") as pipe:
        failed = pipe.read().splitlines()
    _, status = os.waitpid(child, 0)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)  # what a test started
    if os.WIFSIGNALED(status) and os.WTERMSIG(status) in (signal.SIGALRM, signal.SIGXCPU):
        return [LATE]
    return failed or ([BROKEN] if status else [])


def copied(folder: Path) -> Path:
    """Copy what the tests need, for faults to be put into, and make it what is imported."""
    tree = folder / "tree"
    ignored = shutil.ignore_patterns("__pycache__", ".*", "target", "out", "dist")
    shutil.copytree(ROOT, tree, ignore=ignored)
    for code in ("python", "tests"):
        compileall.compile_dir(tree / code, quiet=2)
    os.chdir(tree)
    paths = [str(tree / "python"), str(tree)]
    sys.path[:0] = paths
    os.environ["PYTHONPATH"] = os.pathsep.join(paths)
    return tree


def notices(mutant: Mutant, tests: Tests, number: int) -> str:
    """Return the test that fails for a mutant, or what else ends it; nothing if none does."""
    chosen = tests.of(mutant)
    if not chosen:
        return ""
    before = mutant.file.stat()
    failed = ""
    try:
        mutant.file.write_text(mutant.source(), encoding="utf-8")
        os.utime(mutant.file, (number, number))  # not from existing byte code
        for batch in tests.batches(chosen):
            seconds = 10 + 5 * sum(tests.seconds[test] for test in batch)
            failed = next(iter(failures(batch, seconds, "-x")), "")
            if failed:
                break
    finally:
        mutant.file.write_text(mutant.text, encoding="utf-8")
        os.utime(mutant.file, ns=(before.st_atime_ns, before.st_mtime_ns))
    if failed == BROKEN and failures(chosen, 60, "--collect-only"):
        raise SystemExit(f"these tests do not run without a mutant: {chosen}")
    tests.noticed[failed] += 1
    return failed


def outcomes(sample: list[Mutant], tests: Tests) -> dict[Mutant, str]:
    """Return what notices each mutant, nothing of a survivor; print survivors as they come.

    A test that fails without a mutant, too, has noticed none.
    """
    found: dict[Mutant, str] = {}
    waiting = sample
    while waiting:
        for number, mutant in enumerate(waiting):
            found[mutant] = notices(mutant, tests, number)
            if not found[mutant]:
                unreached = [] if tests.of(mutant) else ["never executed"]
                print(mutant, *unreached, *mutant.argued, sep="  # ", flush=True)
        failing = {test for test in found.values() if test in tests.seconds}
        failing &= set(failures(sorted(failing), 3600)) if failing else set()
        tests.drop(failing)
        waiting = [mutant for mutant, test in found.items() if test in failing]
    return found


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("rooms", nargs="*", metavar="ROOM", default=ROOMS)
    parser.add_argument("--sample", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=30.0, help="of tests for each mutant")
    parser.add_argument("--together", action="store_true", help="one sample of all rooms")
    parser.add_argument("--again", action="store_true", help="the survivors alone")
    asked = parser.parse_args()
    for library in LIBRARIES:
        importlib.import_module(library)
    sys.dont_write_bytecode = True
    tests = Tests(asked.seconds)
    unexplained = 0
    with tempfile.TemporaryDirectory() as folder:
        copied(Path(folder))
        for rooms in [asked.rooms] if asked.together else [[room] for room in asked.rooms]:
            begin = time.monotonic()
            room_of = {mutant: room for room in rooms for mutant in mutants_of(room)}
            report = ROOT / "out/mutants" / f"{'+'.join(rooms).replace('/', '.')}.txt"
            if asked.again:
                before = set(report.read_text(encoding="utf-8").splitlines())
                sample = [mutant for mutant in room_of if str(mutant) in before]
            else:
                count = min(asked.sample, len(room_of))
                sample = random.Random(asked.seed).sample(list(room_of), count)
            found = outcomes(sample, tests)
            survived = [mutant for mutant in found if not found[mutant]]
            report.parent.mkdir(parents=True, exist_ok=True)
            report.write_text("".join(f"{mutant}\n" for mutant in survived), encoding="utf-8")
            unexplained += sum(not mutant.argued for mutant in survived)
            for room in rooms:
                own = {mutant: found[mutant] for mutant in found if room_of[mutant] == room}
                print(scored(room, own), flush=True)
            if asked.together:
                print(scored("together", found))
            print(f"{time.monotonic() - begin:.0f} s", flush=True)
    return 1 if unexplained else 0


def mutants_of(room: str) -> Iterator[Mutant]:
    for file in sorted(Path(PACKAGE).glob(f"{room}/**/*.py")) or [Path(PACKAGE, room)]:
        yield from mutants(file)


def scored(name: str, found: dict[Mutant, str]) -> str:
    """Return how many mutants were noticed, with Wilson's interval, also without those argued.

    Those at which tests ran out of time count as noticed, and are also counted separately.
    """
    # Not the package's own: no process may have imported that before a mutant is written.
    binomtest = importlib.import_module("scipy.stats").binomtest
    argued = sum(bool(mutant.argued) for mutant in found if not found[mutant])
    noticed = sum(map(bool, found.values()))
    words = []
    for of, what in ((len(found), "mutants"), (len(found) - argued, "that can be noticed")):
        low, high = binomtest(noticed, max(of, 1)).proportion_ci(method="wilson")
        words.append(
            f"{noticed} of {of} {what} ({noticed / max(of, 1):.1%}, {low:.1%} to {high:.1%})"
        )
    late = sum(test == LATE for test in found.values())
    return f"{name}: {', '.join(words)}; {late} of the noticed ran {LATE}"


if __name__ == "__main__":
    raise SystemExit(main())
