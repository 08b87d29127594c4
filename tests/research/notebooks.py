"""Runs the notebooks of `studies/` and writes their outputs into them; `make notebooks` runs it.

A notebook is committed with its outputs, so that it can be read where nothing can be run. No output
is written by hand: the hash of the sources that the outputs belong to is kept in the metadata.
"""

from __future__ import annotations

import argparse
import base64
import hashlib
import io
import json
import os
import time
from collections.abc import Sequence
from pathlib import Path

import nbclient
import nbformat
from PIL import Image

__all__ = ["NOTEBOOKS", "executed", "hash_of_sources", "keep_hash", "kept_hash", "read", "shown"]

STUDIES = Path(__file__).parents[2] / "studies"
NOTEBOOKS = sorted(STUDIES.glob("*.ipynb"))

_OF_A_CELL = 1800
"""[s] After this time a cell counts as hanging."""


def read(path: Path) -> nbformat.NotebookNode:
    """Read a notebook."""
    notebook: nbformat.NotebookNode = nbformat.read(path, as_version=4)  # type: ignore[no-untyped-call]
    return notebook


def executed(path: Path, *, quick: bool) -> nbformat.NotebookNode:
    """Run a notebook from top to bottom and return it with its outputs.

    Parameters
    ----------
    path : Path
        The notebook, which stays as it is.
    quick : bool
        Whether to make few runs only.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell fails.
    """
    notebook = read(path)
    client = nbclient.NotebookClient(
        notebook,
        timeout=_OF_A_CELL,
        coalesce_streams=True,  # printed text comes in pieces that differ between runs
        resources={"metadata": {"path": str(path.parent)}},
    )
    client.execute(env={**os.environ, "CRAWLER2D_QUICK": "1" if quick else "0"})
    return _stripped(notebook)


def hash_of_sources(notebook: nbformat.NotebookNode) -> str:
    """Return the SHA-256 of the sources of all cells, including texts."""
    sources = [[cell.cell_type, cell.source] for cell in notebook.cells]
    return hashlib.sha256(json.dumps(sources).encode()).hexdigest()


def kept_hash(notebook: nbformat.NotebookNode) -> str:
    """Return the hash of the sources that the outputs belong to; "" if there is none."""
    return str(notebook.metadata.get("crawler2d", {}).get("sources_sha256", ""))


def keep_hash(notebook: nbformat.NotebookNode) -> None:
    """Record in the metadata the sources to which the outputs belong."""
    notebook.metadata["crawler2d"] = {"sources_sha256": hash_of_sources(notebook)}


def shown(notebook: nbformat.NotebookNode) -> list[list[tuple[str, str]]]:
    """List the outputs of each code cell.

    Returns
    -------
    list of list of pair
        By cell and output: its kind, a MIME type or the name of a stream, and its text; "" for
        figures, which differ from machine to machine by their fonts.
    """
    return [
        [each for output in cell.outputs for each in _shown(output)]
        for cell in notebook.cells
        if cell.cell_type == "code"
    ]


def _shown(output: nbformat.NotebookNode) -> list[tuple[str, str]]:
    if output.output_type == "stream":
        return [(output.name, output.text)]
    return [
        (kind, "" if kind.startswith("image/") else str(content))
        for kind, content in sorted(output.get("data", {}).items())
    ]


def _stripped(notebook: nbformat.NotebookNode) -> nbformat.NotebookNode:
    """Remove parts that differ between machines or times, and the pages of replays.

    A page says how long its run took. It is as large as several figures, and most viewers do not
    show the scripts of others: the text that takes its place says what the run was.
    """
    notebook.metadata.pop("widgets", None)
    notebook.metadata["language_info"] = {"name": "python"}  # without its version
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)  # when it was run
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if "<iframe" in data.get("text/html", ""):
                del data["text/html"]
            if "image/png" in data:
                data["image/png"] = _smaller(data["image/png"])
    return notebook


def _smaller(encoded: str) -> str:
    """Reduce a figure to 256 colours, which are enough: a third of the size."""
    colors = Image.open(io.BytesIO(base64.b64decode(encoded))).convert("RGB")
    file = io.BytesIO()
    colors.quantize(256, dither=Image.Dither.NONE).save(file, "png", optimize=True)
    return base64.b64encode(file.getvalue()).decode()


def main(names: Sequence[str]) -> None:
    """Run all notebooks or the given ones, and write their outputs into them."""
    for path in NOTEBOOKS:
        if names and path.stem not in names:
            continue
        began = time.monotonic()
        notebook = executed(path, quick=False)
        keep_hash(notebook)
        nbformat.write(notebook, path)  # type: ignore[no-untyped-call]
        size = path.stat().st_size / 1000
        print(f"{path.name}: {time.monotonic() - began:.0f} s, {size:.0f} kB")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=main.__doc__)
    known = [path.stem for path in NOTEBOOKS]
    parser.add_argument("names", nargs="*", metavar="name", help=", ".join(known))
    given = parser.parse_args().names
    for name in given:
        if name not in known:
            parser.error(f"{name} must be one of {', '.join(known)}")
    main(given)
