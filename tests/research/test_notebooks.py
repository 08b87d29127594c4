"""Notebooks run from top to bottom, and their texts, code and outputs belong together."""

import ast
import functools
import inspect
import re
from pathlib import Path
from typing import Any

import nbformat
import pytest

import crawler2d as c2d
from tests.research.notebooks import NOTEBOOKS, executed, hash_of_sources, kept_hash, read, shown

of_each = pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)


SHORT = ("why_it_stopped",)
"""What takes seconds; `make soak` runs the others, too."""

TRAINED = ("what_a_policy_learned",)
"""Notebooks whose figures depend on the processor: eigenvalues of LAPACK differ in their last bits,
and what is trained by them in more. Their findings are asserted in them."""

of_each_run = pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=() if path.stem in SHORT else pytest.mark.soak)
        for path in NOTEBOOKS
    ],
)


@functools.cache
def quick_run(path: Path) -> nbformat.NotebookNode:
    return executed(path, quick=True)


def test_there_is_a_notebook() -> None:
    assert NOTEBOOKS


# Names in a text: inputs, places in the paper, and files of the project.
GIVEN = re.compile(r"a step of 75 mm|(Fig\.|Table|eq\.) \(?\d+\)?|crawler2d|\w+_2\.ipynb")


@of_each
def test_a_text_leaves_figures_to_the_runs(path: Path) -> None:
    texts = [cell.source for cell in read(path).cells if cell.cell_type == "markdown"]
    stated = [line for text in texts for line in GIVEN.sub("", text).splitlines()]
    assert [line for line in stated if re.search(r"\d", line)] == []


def findings(text: str) -> int:
    """Count the findings of a text: its quoted paragraphs."""
    return len(re.findall(r"^>.*(?:\n>.*)*", text, re.MULTILINE))


def asserts(code: str) -> int:
    return sum(isinstance(node, ast.Assert) for node in ast.walk(ast.parse(code)))


@of_each
def test_a_finding_is_asserted_in_the_next_cell(path: Path) -> None:
    cells = read(path).cells
    texts = [k for k, cell in enumerate(cells) if cell.cell_type == "markdown"]
    stating = [k for k in texts if findings(cells[k].source)]
    assert stating
    for k in stating:
        assert cells[k + 1].cell_type == "code"
        assert asserts(cells[k + 1].source) >= findings(cells[k].source), cells[k].source


def code_of(path: Path) -> list[str]:
    return [cell.source for cell in read(path).cells if cell.cell_type == "code"]


def named(node: ast.expr) -> Any:
    """The object of the package that an expression names; None if it names none."""
    if isinstance(node, ast.Name):
        return c2d if node.id == "c2d" else None
    if isinstance(node, ast.Attribute) and (owner := named(node.value)) is not None:
        return getattr(owner, node.attr)
    return None


@of_each
def test_names_that_a_notebook_uses_exist(path: Path) -> None:
    """Names and keywords, also those that no short run reaches."""
    asked = 0
    for node in ast.walk(ast.parse("\n".join(code_of(path)))):
        if isinstance(node, ast.Attribute):
            named(node)
        if isinstance(node, ast.Call) and (called := named(node.func)) is not None:
            positional = [None for each in node.args if not isinstance(each, ast.Starred)]
            keywords = {each.arg: None for each in node.keywords if each.arg is not None}
            inspect.signature(called).bind_partial(*positional, **keywords)
            asked += 1
    assert asked > 3


@of_each
def test_the_scenarios_of_a_notebook_are_valid(path: Path) -> None:
    """Its first cell: robots, models, grounds."""
    exec(code_of(path)[0], {})


@of_each_run
def test_the_notebook_runs_and_warns_of_nothing(path: Path) -> None:
    kinds = [kind for cell in shown(quick_run(path)) for kind, _ in cell]
    assert "image/png" in kinds
    assert "stderr" not in kinds


@of_each
def test_the_outputs_are_those_of_the_sources(path: Path) -> None:
    committed = read(path)
    assert kept_hash(committed) == hash_of_sources(committed), "run make notebooks"


def kinds_shown(notebook: nbformat.NotebookNode) -> list[list[str]]:
    """List the kinds of outputs of each code cell."""
    return [[kind for kind, _ in cell] for cell in shown(notebook)]


@of_each_run
def test_every_cell_that_shows_something_has_it_committed(path: Path) -> None:
    assert kinds_shown(read(path)) == kinds_shown(quick_run(path))


@of_each
def test_a_notebook_can_be_read_on_the_web(path: Path) -> None:
    # Larger ones are slow to show, and each new version stays in the history.
    assert path.stat().st_size < 500_000


@pytest.mark.soak
@of_each
def test_a_full_run_says_what_is_committed(path: Path) -> None:
    made, committed = executed(path, quick=False), read(path)
    if path.stem in TRAINED:
        assert kinds_shown(made) == kinds_shown(committed)
    else:
        assert shown(made) == shown(committed)
