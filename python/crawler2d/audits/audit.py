"""Audit a model of a robot: what it lacks, where it seizes, and what smallest change ends that."""

from __future__ import annotations

import os
import warnings
from collections.abc import Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Unpack, overload

from crawler2d._doubts import warn
from crawler2d.audits.audited import Audited
from crawler2d.audits.beside import belt_of
from crawler2d.audits.call import Call
from crawler2d.audits.lint import lint
from crawler2d.audits.obstacles import read_obstacles, standard_obstacles
from crawler2d.audits.patches import diffs_of, patch_of
from crawler2d.audits.pockets import pockets
from crawler2d.audits.population import (
    unknown_of,
    unknown_of_file,
    vary_of,
    without_friction,
)
from crawler2d.audits.repairs import Repair, repaired
from crawler2d.audits.runs import Runs, scenario_of
from crawler2d.audits.subject import HowToRead, subject_of
from crawler2d.audits.text import text_of
from crawler2d.audits.verdicts import BELT, OWN, verdicts_of
from crawler2d.common.arrays import whole_number
from crawler2d.common.extras import extra
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError, ScenarioWarning
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.terrain import Terrain
from crawler2d.reading.reading import Reading
from crawler2d.runs.progress import Progress

__all__ = ["Audit", "audit"]

SAMPLES, REPEATS = 80, 1
"""Of the unknowns, and runs of each: of 80 robots that never seize at most 4.6 % do, of 80 of which
8 do so at least 5.2 %. A run of another robot tells more than one more of the same."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Audit(Audited):
    """What an audit found; printing it shows the short form.

    Attributes
    ----------
    robot, reading : Robot, and Reading or None
        What was audited, and what was read if it was a file.
    lint, pockets : tuple of Finding, tuple of Pocket
        What is hardly meant in the model, and a screen of its geometry.
    belt : Belt
        The robot on belts that it was compared with; its `reason` says which belts, and why.
    obstacles, verdicts : mapping of str to terrain, tuple of Verdict
        What it drove over, and what came of it.
    seizes : bool
        Whether it seizes on an obstacle that the belt clears.
    repairs, repaired : tuple of Repair, and Repaired or None
        Changes that end the seizures, and all of the search for them.
    table : xarray.Dataset
        The runs behind the verdicts.
    vary, unknown, drive, call
        Over what the rates are rates, how it was driven, and what was asked for.
    """

    @property
    def in_words(self) -> str:
        """The short form, as ``python -m crawler2d audit`` prints it."""
        return text_of(self)

    @takes_keywords
    def patch(
        self, path: str | os.PathLike[str] | None = None, repair: Repair | None = None
    ) -> str:
        """Change the wheels in the file that was audited, and nothing else.

        All wheels of a carrier together keep their mass and the torque of their motors; a new one
        is a copy of its neighbour, with all that drives it. What was made is read again, and
        refused if that is not the repaired robot. Settings of plugins that may no longer be right
        for so many wheels are left as they are, with a `ScenarioWarning` each.

        Parameters
        ----------
        path : path-like, optional
            Where to write the changed file; meshes keep their relative names, so the folder of
            the file that was read is the place for it.
        repair : Repair, optional
            One of `repairs`; None takes the first that is confirmed and not of belts.

        Returns
        -------
        str
            What differs from the file that was read, as a unified diff. Of a xacro file it is what
            that expands to which is changed.

        Raises
        ------
        ScenarioError
            If no file was audited, no repair by wheels is confirmed, or the file has its wheels in
            a form that cannot be changed in place, such as meshes of another size.
        OSError
            If it cannot be written.
        """
        patch = patch_of(self, repair)
        for setting in patch.left:
            warn("patch", setting, "leaves this to be set by hand")
        if path is not None:
            Path(path).write_text(patch.text, encoding="utf-8")
        return patch.diff

    def __repr__(self) -> str:
        """Write the short form."""
        return self.in_words

    @overload
    def to_html(self, path: None = None, *, threads: int | None = None) -> str: ...

    @overload
    def to_html(self, path: str | os.PathLike[str], *, threads: int | None = None) -> Path: ...

    @takes_keywords
    def to_html(
        self, path: str | os.PathLike[str] | None = None, *, threads: int | None = None
    ) -> str | Path:
        """Write one self-contained HTML page with all that was found.

        For each obstacle on which it seized one run is simulated again, beside that of the belt
        with the same draws, and can be replayed in the page.

        Parameters
        ----------
        path : str or path-like, optional
            Where to write the page; None returns its text.
        threads : int, optional
            For the runs that are replayed; see `simulate_many`.

        Returns
        -------
        str or Path
            The text, or the path of the written file.

        Raises
        ------
        OSError
            If the file cannot be written.

        Examples
        --------
        >>> import crawler2d as c2d
        >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
        >>> step = {"step": c2d.terrains.step(0.1)}
        >>> found = c2d.audit(robot, step, unknown={}, repeats=4, repair=False, progress=False)
        >>> page = found.to_html()
        >>> page.startswith("<!doctype html>"), found.verdicts[0].where in page
        (True, True)
        """
        # Imported only when used.
        from crawler2d.audits.page import audit_page  # noqa: PLC0415

        text = audit_page(self, diffs_of(self), threads=threads)
        if path is None:
            return text
        Path(path).write_text(text, encoding="utf-8", newline="\n")
        return Path(path)


@takes_keywords
def audit(
    robot: Robot | Reading | str | os.PathLike[str],
    obstacles: Mapping[str, Terrain] | None = None,
    *,
    vary: Mapping[str, Any] | None = None,
    unknown: Mapping[str, Any] | None = None,
    samples: int = SAMPLES,
    repeats: int = REPEATS,
    seed: int = 0,
    repair: bool = True,
    drive: Drive | None = None,
    duration: float | None = None,
    store: str | os.PathLike[str] | None = None,
    executor: Executor | None = None,
    threads: int | None = None,
    progress: bool | Progress | None = True,
    **reading: Unpack[HowToRead],
) -> Audit:
    """Find out whether a model of a robot seizes where a belt would not, and what ends that.

    The robot drives over the standard obstacles, beside the same robot on belts, again and again
    with what is not known of it drawn anew. The rules of lint, verdicts and repairs are in
    ``docs/conventions.md``, "Audit".

    Parameters
    ----------
    robot : Robot, Reading or path
        The robot, what was read of a model, or its file: SDF, URDF, xacro or MJCF.
    obstacles : mapping of str to terrain, optional
        What to drive over, by label, in place of the standard obstacles. They keep their friction.
    vary : mapping of str to distribution, optional
        What differs from run to run; see `sweep`. None takes start, contact and, of random step
        fields, the field; a tenth, a third and all of the speed in turn; and heights, rises, radii
        and widths of obstacles within 5 %.
    unknown : mapping of str to distribution, optional
        What is not known, in the same form. None takes, of a file, narrow ranges for what it states
        and wide ones for estimates; of a preset and of another robot those of `unknowns`; and the
        friction of the floor. ``{}`` takes everything as known.
    samples : int
        Of the unknowns: so many robots on floors, 1 to 100,000; fewer than 35 cannot show that it
        does not seize.
    repeats : int
        Runs of each of them over every obstacle, 1 to 1,000,000.
    seed : int
        Seed of the draws, 0 to 2^64 - 1.
    repair : bool
        Whether to search for repairs if it seizes.
    drive : Drive, optional
        None drives at 0.2 sqrt(g L), with L the axle distance, or at the robot's largest speed if
        that is less; flippers `Climb`, and are raised before the obstacle. `vary` takes shares of
        its speed.
    duration : float, optional
        [s] Longest simulated time at that speed; at a third of it runs have 5/3 of that, at a tenth
        4 times. None takes that in which the robot would drive fifteen times its own length.
    store : str or path-like, optional
        A file that keeps every run: the same call goes on where it was; see `sweep`.
    executor, threads, progress
        See `sweep`.
    **reading
        For a path: the keywords of `read_robot`, such as `engine` and `trusted`.

    Returns
    -------
    Audit
        Lint, pockets, verdicts and repairs; printing it shows the short form.

    Raises
    ------
    ScenarioError
        If the file cannot be read, or an argument or the robot breaks a rule.
    BatchInterrupted
        On Ctrl-C; a store keeps what was finished.
    ImportError
        If xarray is missing, or what the format of the file needs.

    Examples
    --------
    Four wheels that touch, on one step:

    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4, wheel_radius=0.0608))
    >>> step = {"step of 75 mm": c2d.terrains.step(0.075)}
    >>> found = audit(robot, step, unknown={}, repeats=20, progress=False)
    >>> found.seizes, found.verdicts[0].where, found.verdicts[0].there
    (True, '1-2', (20, 20))
    >>> found.repairs[0].what, found.repairs[0].confirmed
    ('chassis: 5 wheels in place of 4', True)
    """
    extra("xarray", "analysis")  # fail before the runs if it is missing
    whole_number(seed, "seed", 0, 2**64 - 1)
    if drive is not None and not isinstance(drive, Drive):
        raise ScenarioError("drive", drive, "must be a Drive")
    own_arguments = {
        "obstacles": obstacles,
        "vary": vary,
        "unknown": unknown,
        "drive": drive,
        "duration": duration,
    }
    own, read, floors = subject_of(robot, reading)
    friction = 0.9 if read is None else read.friction
    grounds = standard_obstacles(own, friction)
    if obstacles is not None:
        grounds = read_obstacles(obstacles)
    if unknown is None:
        if read is None:
            unknown = unknown_of(own, with_friction=obstacles is None)
        else:
            unknown = unknown_of_file(read, floors)
            unknown = unknown if obstacles is None else without_friction(unknown)
    runs = Runs(
        scenario=scenario_of(own, next(iter(grounds.values())), drive, duration),
        vary=vary_of(drive) if vary is None else vary,
        unknown=unknown,
        samples=samples,
        repeats=repeats,
        seed=seed,
        store=store,
        executor=executor,
        threads=threads,
        progress=progress,
    )
    belt = belt_of(own)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ScenarioWarning)
        table = runs.table({OWN: own, BELT: belt.robot}, grounds)
        verdicts = verdicts_of(table, list(grounds))
        is_seizing = any(each.word == "seizes" for each in verdicts)
        found = None
        if repair and is_seizing:
            found = repaired(own, belt, grounds=grounds, verdicts=verdicts, table=table, runs=runs)
    return Audit(
        robot=own,
        reading=read,
        lint=lint(own, read, _doubts(caught)),
        pockets=pockets(own),
        belt=belt,
        obstacles=grounds,
        verdicts=verdicts,
        repaired=found,
        table=table,
        vary=runs.vary,
        unknown=unknown,
        drive=runs.scenario.drive,
        call=Call(
            samples=samples,
            repeats=repeats,
            seed=seed,
            repair=repair,
            own=tuple(name for name, value in own_arguments.items() if value is not None),
            reading={} if read is None else read.how.given,
        ),
    )


def _doubts(caught: list[warnings.WarningMessage]) -> list[str]:
    """Return what the core doubts, each once; other warnings go on."""
    doubts = []
    for each in caught:
        if issubclass(each.category, ScenarioWarning):
            doubts.append(str(each.message))
        else:
            warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)
    return list(dict.fromkeys(doubts))
