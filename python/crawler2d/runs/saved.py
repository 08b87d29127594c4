"""Read runs that `Run.save` wrote."""

from __future__ import annotations

import os

from crawler2d.results.run_file import read_run
from crawler2d.runs.run import Run

__all__ = ["load"]


def load(path: str | os.PathLike[str]) -> Run:
    """Read a run that `Run.save` wrote.

    Nothing in the file is executed, so files from strangers are safe.

    Parameters
    ----------
    path : str or path-like
        The file.

    Returns
    -------
    Run
        The same run, bit by bit. Branches, trials and `escape_force` repeat the run, so they are
        refused if another build (`Run.build`) simulated it.

    Raises
    ------
    StoreError
        If the file cannot be read, is not a saved run, is truncated or damaged, or has a newer
        format. The message says which, and what to do.

    Examples
    --------
    >>> import tempfile
    >>> from pathlib import Path
    >>> import crawler2d as c2d
    >>> run = c2d.simulate(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> path = run.save(Path(tempfile.mkdtemp()) / "step.npz")
    >>> again = c2d.load(path)
    >>> again.metrics == run.metrics, again.position.shape == run.position.shape
    (True, True)
    """
    return read_run(path, Run)
