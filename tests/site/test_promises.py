"""The page of promises names existing tests, and every promise has one."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/promises.md").read_text(encoding="utf-8")
NAMED = re.findall(r"`([\w/.]+\.(?:py|rs))::(\w+)`", PAGE)
PROMISES = PAGE.split("\n## ")[1:]
NONE = ("What is not promised",)
"""Sections that promise nothing."""


def names_in(path: Path) -> set[str]:
    """Names of the functions of a file that are tests."""
    text = path.read_text(encoding="utf-8")
    if path.suffix == ".rs":
        return set(re.findall(r"#\[test\]\s+(?:#\[ignore[^\n]*\n\s*)?fn (\w+)", text))
    functions = (node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef))
    return {node.name for node in functions if node.name.startswith("test_")}


def is_long(path: Path, name: str) -> bool:
    """Whether a whole Python test runs only in `make soak`."""
    nodes = ast.walk(ast.parse(path.read_text(encoding="utf-8"))) if path.suffix == ".py" else ()
    own = (node for node in nodes if isinstance(node, ast.FunctionDef) and node.name == name)
    return any(
        ast.unparse(each) == "pytest.mark.soak" for node in own for each in node.decorator_list
    )


@pytest.mark.parametrize(("file", "name"), NAMED)
def test_a_test_that_is_named_is_there(file: str, name: str) -> None:
    assert name in names_in(ROOT / file)


@pytest.mark.parametrize("promise", PROMISES, ids=lambda text: text.splitlines()[0])
def test_every_promise_has_a_test_in_every_line(promise: str) -> None:
    rows = [line for line in promise.splitlines() if line.startswith("| ")][1:]
    assert bool(rows) == (promise.splitlines()[0] not in NONE)
    assert [row for row in rows if not re.search(r"\.(?:py|rs)::\w+`", row)] == []


def test_the_usual_tests_are_not_marked_as_long() -> None:
    rows = [line.split(" | ") for line in PAGE.splitlines() if "::" in line]
    usual = [
        re.findall(r"`([\w/.]+)::(\w+)`", test) for _, test, often, *_ in rows if often.strip()
    ]
    assert len(usual) > 30
    assert [name for ((file, name),) in usual if is_long(ROOT / file, name)] == []
