"""Which lines of the core its own tests run, by room: unit tests and facts, without any Python.

    python -m tests.coverage.core [FILTER ...]

Writes out/coverage-rust.txt: a line for each room, then the lines of each file that no test ran.
Filters are those of `cargo test`. rustc counts; llvm_profparser reads the counts, since it takes no
LLVM of rustc's version. The tests of a room in its own files are not counted as lines of the core.
"""

import json
import os
import re
import subprocess
import sys
from collections import defaultdict
from itertools import groupby
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "rust_core/src"
OUT = ROOT / "out/coverage-rust.txt"
BUILT = Path(os.environ.get("CARGO_TARGET_DIR", "target")).resolve() / "coverage"

# In a debug build, the facts take hours. One codegen unit takes twice the time to build.
BUILD = {
    "CARGO_TARGET_DIR": str(BUILT),
    "CARGO_PROFILE_RELEASE_CODEGEN_UNITS": "16",
    "RUSTC_WORKSPACE_WRAPPER": str(Path(__file__).with_name("rustc.sh")),
    "LLVM_PROFILE_FILE": os.devnull,
}

Hits = dict[Path, dict[int, int]]
"""How often a line ran, for each line with code of each file."""


def main(filters: list[str]) -> int:
    hits: Hits = defaultdict(dict)
    for test in tests():
        raw = BUILT / f"{test.name}.profraw"
        # Threads would wait for each other's counters.
        counting = os.environ | {"LLVM_PROFILE_FILE": str(raw), "RUST_TEST_THREADS": "1"}
        subprocess.run([test, *filters], check=True, cwd=CORE.parent, env=counting)
        for file, lines in counted(test, raw).items():
            for line, count in lines.items():
                hits[file][line] = hits[file].get(line, 0) + count
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text("\n".join(report(hits)) + "\n", encoding="utf-8")
    print(OUT.read_text(encoding="utf-8").split("\n\n")[0])
    return 0


def tests() -> list[Path]:
    """Build the programs of the tests, and return them."""
    command = "cargo test --release --package crawler2d-core --lib --test facts --no-run"
    built = subprocess.run(
        [*command.split(), "--message-format=json-render-diagnostics"],
        check=True,
        cwd=ROOT,
        env=os.environ | BUILD,
        stdout=subprocess.PIPE,
        text=True,
    )
    messages = map(json.loads, built.stdout.splitlines())
    return [Path(found) for message in messages if (found := message.get("executable"))]


def counted(test: Path, raw: Path) -> Hits:
    """Return how often each line of the core ran in one program."""
    cov = Path(sys.executable).parent / "cov"
    command: list[str | Path] = [cov, "show", "--instr-profile", raw, "--object", test]
    shown = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True)
    hits: Hits = {}
    lines: dict[int, int] = {}
    for line in shown.stdout.splitlines():
        if line.startswith("/"):
            file = Path(line)
            lines = {}
            if file.is_relative_to(CORE) and not is_of_tests(file):
                hits[file] = lines
                own_tests = first_line_of_tests(file)
        elif found := re.match(r" *(\d+)\| *(\d+)\|", line):
            number, count = map(int, found.groups())
            if lines is hits.get(file) and number < own_tests:
                lines[number] = count
    return hits


def is_of_tests(file: Path) -> bool:
    return file.stem in ("tests", "draw") or "tests" in file.parts


def first_line_of_tests(file: Path) -> int:
    """Return the line where the tests in a file begin, which are at its end."""
    text = file.read_text(encoding="utf-8")
    found = re.search(r"^#\[cfg\(test\)\]\nmod \w+ \{", text, re.MULTILINE)
    return text.count("\n", 0, found.start() if found else len(text)) + 1


def report(hits: Hits) -> list[str]:
    """Return the lines of the report."""
    rooms: dict[str, list[bool]] = defaultdict(list)
    missed = []
    for file, lines in sorted(hits.items()):
        name = file.relative_to(CORE)
        rooms[name.parts[0]] += [count > 0 for count in lines.values()]
        if without := [line for line, count in sorted(lines.items()) if count == 0]:
            missed.append(f"{name}: {ranges(without)}")
    rooms["the core"] = [ran for lines in rooms.values() for ran in lines]
    table = [
        f"{room:12} {sum(ran):6} of {len(ran):6} lines  {sum(ran) / len(ran):6.1%}"
        for room, ran in rooms.items()
    ]
    return [*table, "", "Lines that no test ran:", *missed]


def ranges(numbers: list[int]) -> str:
    """Return numbers in rising order as text, such as `3-5, 8`."""
    runs = groupby(enumerate(numbers), lambda pair: pair[1] - pair[0])
    ends = [[number for _, number in run] for _, run in runs]
    return ", ".join(f"{run[0]}-{run[-1]}" if len(run) > 1 else str(run[0]) for run in ends)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
