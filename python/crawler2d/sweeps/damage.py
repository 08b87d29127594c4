"""What is damaged in a store."""

from __future__ import annotations

import contextlib
import sqlite3
from dataclasses import dataclass

from crawler2d.sweeps.database import Place, damage_of, place_of, to_read
from crawler2d.sweeps.sealed import COLUMNS, OtherBuild, unsealed

__all__ = ["Damage", "check_store"]


@dataclass(frozen=True, slots=True)
class Damage:
    """Something in a store that is not as it was written.

    Attributes
    ----------
    row : int, optional
        Number of the row, in the order in which they were kept; None of the file as a whole.
    what : str
        What is wrong.
    """

    row: int | None
    what: str


def check_store(path: Place) -> tuple[Damage, ...]:
    """Check a store: its structure, the checksum of every row, and whether it holds a run.

    Sweeps, `table` and `join_stores` refuse a damaged store, or a damaged row of it; this tells
    all that is wrong. It changes nothing, and may be called while a sweep writes.

    Parameters
    ----------
    path : str or path-like
        The file.

    Returns
    -------
    tuple of Damage
        Empty if it is sound; each has a `row`, which is None for the file as a whole, and says
        `what` is wrong.

    Raises
    ------
    ScenarioError
        If that cannot be the path of a file.
    StoreError
        If there is no such file, or it cannot be opened as a store.

    Examples
    --------
    >>> import os, tempfile
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     store = os.path.join(folder, "a.sqlite")
    ...     _ = c2d.sweep(base, {}, repeats=2, store=store, progress=False)
    ...     c2d.check_store(store)
    ()
    """
    with contextlib.closing(to_read(place_of(path), checked=False)) as connection:
        found = [Damage(None, what) for what in damage_of(connection)]
        number = 0
        try:
            for number, *values in connection.execute(f"SELECT rowid, {COLUMNS} FROM run"):
                try:
                    unsealed(values)
                except OtherBuild:
                    continue
                except ValueError as fault:
                    found.append(Damage(number, str(fault)))
        except sqlite3.DatabaseError as error:
            found.append(Damage(None, f"nothing can be read behind row {number}: {error}"))
    return tuple(found)
