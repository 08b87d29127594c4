"""The notebooks: committed without outputs, and run from top to bottom."""

import re
from pathlib import Path

import nbclient
import nbformat
import pytest

STUDIES = Path(__file__).parents[2] / "studies"
NOTEBOOKS = sorted(STUDIES.glob("*.ipynb"))


def read(path: Path) -> nbformat.NotebookNode:
    notebook: nbformat.NotebookNode = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    return notebook


def test_there_is_a_notebook() -> None:
    assert NOTEBOOKS


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_no_output_is_committed(path: Path) -> None:
    for cell in read(path).cells:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


# What a text may name: what is put in, and the figures of the paper.
GIVEN = re.compile(r"a step of 75 mm|Fig\. \d+")


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_text_leaves_figures_to_the_runs(path: Path) -> None:
    texts = [cell.source for cell in read(path).cells if cell.cell_type == "markdown"]
    stated = [line for text in texts for line in GIVEN.sub("", text).splitlines()]
    assert [line for line in stated if re.search(r"\d", line)] == []


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_notebook_runs(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CRAWLER2D_QUICK", "1")
    notebook = read(path)
    # A cell that fails ends the run with its traceback.
    nbclient.NotebookClient(
        notebook, timeout=60, resources={"metadata": {"path": str(STUDIES)}}
    ).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    # Warnings would meet every reader.
    assert not [output for output in outputs if output.get("name") == "stderr"]
