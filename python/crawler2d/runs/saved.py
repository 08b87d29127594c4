"""Runs read from files that `Run.save` wrote."""

from __future__ import annotations

import os

from crawler2d.results.run_file import read_run
from crawler2d.runs.run import Run

__all__ = ["load"]


def load(path: str | os.PathLike[str]) -> Run:
    """Read a run that `Run.save` wrote.

    Nothing in the file is executed, whoever wrote it.

    Parameters
    ----------
    path : str or path-like
        The file.

    Returns
    -------
    Run
        The same run to the last bit. `Run.build` says what simulated it: branches, trials and
        `escape_force` repeat the run, and are refused if that was another build.

    Raises
    ------
    StoreError
        If the file cannot be read; if it is no saved run, is cut short or damaged, or of a newer
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
