"""Coverage of the package by the ordinary tests, room by room: `make coverage-python`."""

import ast
import json
import sys
from collections import defaultdict
from pathlib import Path
from typing import Any, TypeGuard

from tests.walls.rooms import ROOT

PACKAGE = Path("python/crawler2d")


def missed_errors(file: Path, missing: set[int]) -> list[str]:
    """Return file, line and text of the errors that are never raised."""
    text = (ROOT / file).read_text(encoding="utf-8")
    lines = text.splitlines()
    raising = sorted(node.lineno for node in ast.walk(ast.parse(text)) if is_error(node))
    return [f"{file}:{line}: {lines[line - 1].strip()}" for line in raising if line in missing]


def is_error(node: Any) -> TypeGuard[ast.stmt]:
    """Whether a statement raises an error, directly or by a method that refuses a value."""
    if isinstance(node, ast.Raise):
        return True
    if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Call):
        return False
    called = node.value.func
    return getattr(called, "attr", getattr(called, "id", "")) == "refuse"


def main(report: Path) -> None:
    """Print lines and branches by room, and statements that raise but are never executed."""
    files = json.loads(report.read_text(encoding="utf-8"))["files"]
    rooms: dict[str, list[int]] = defaultdict(lambda: [0, 0, 0, 0])
    errors: list[str] = []
    rest: list[str] = []
    for name, found in sorted(files.items()):
        file = Path(name)
        room = file.relative_to(PACKAGE).parts[0]
        told = found["summary"]
        counts = [
            told["covered_lines"],
            told["num_statements"],
            told["covered_branches"],
            told["num_branches"],
        ]
        for key in (room, "all"):
            rooms[key] = [a + b for a, b in zip(rooms[key], counts, strict=True)]
        errors += missed_errors(file, set(found["missing_lines"]))
        if missing := found["missing_lines"]:
            rest.append(f"{name}: {', '.join(map(str, missing))}")
    print(f"{'room':16}{'lines':>8}{'of':>7}{'':>9}{'branches':>10}{'of':>7}")
    for room, (lines, of_lines, branches, of_branches) in rooms.items():
        print(
            f"{room:16}{lines:8}{of_lines:7}{lines / max(of_lines, 1):9.1%}"
            f"{branches:10}{of_branches:7}{branches / max(of_branches, 1):9.1%}"
        )
    print(f"\n{len(errors)} errors are never raised:", *errors, sep="\n")
    print("\nLines that are never executed:", *rest, sep="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
