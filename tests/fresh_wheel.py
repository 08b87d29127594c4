"""Typical use of the wheel by itself; `make test-wheel` runs it without a compiler."""

import os
import shutil
import subprocess
import sys
from importlib.metadata import files
from pathlib import Path

import nbclient
import nbformat

import crawler2d as c2d

MODEL = Path(__file__).parent / "robots" / "absolem.sdf"
NOTEBOOK = Path(__file__).parents[1] / "studies" / "phase_rule.ipynb"


def main() -> None:
    """See the demonstration, audit a public model from the command line, and run a notebook."""
    assert not any(shutil.which(name) for name in ("cargo", "rustc", "cc", "gcc"))
    assert Path(c2d.__file__).is_relative_to(sys.prefix), "not the wheel, but a working copy"
    assert {"LICENSE", "THIRD-PARTY-NOTICES"} <= {file.name for file in files("crawler2d") or ()}
    assert all(c2d.samples.path(name).is_file() for name in c2d.samples.names())
    program = [sys.executable, "-W", "ignore", "-m", "crawler2d"]
    subprocess.run([*program, "demo"], check=True)
    assert "seized" in Path("out/demo.html").read_text(encoding="utf-8")
    command = [*program, "audit", str(MODEL), "--quick"]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    print(done.stdout)
    assert done.returncode in (0, 1)  # whether it seizes in so few runs does not matter here
    assert "38.7 kg" in done.stdout
    assert "Verdicts" in done.stdout
    page = Path("out/audit-absolem.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")
    notebook = nbformat.read(NOTEBOOK, as_version=4)  # type: ignore[no-untyped-call]
    # Its kernel starts here, where there is no working copy to import.
    client = nbclient.NotebookClient(notebook, timeout=300, resources={"metadata": {"path": "."}})
    client.execute(env={**os.environ, "CRAWLER2D_QUICK": "1"})
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in outputs)


if __name__ == "__main__":
    main()
