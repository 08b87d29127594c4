"""Audit a model of a robot: what is wrong with it, where it seizes, and the smallest repair."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Unpack, overload

from crawler2d.audits.candidates import pockets
from crawler2d.audits.lint import lint
from crawler2d.audits.patches import best_change, change_of, diffs_of
from crawler2d.audits.record import AuditRecord, AuditSetup, Call
from crawler2d.audits.repairs import Repair, search_repairs
from crawler2d.audits.runs import TRIED, RunCounter, Runs, belt_of, read_progress, scenario_of
from crawler2d.audits.sampling import (
    Assumption,
    assumptions_of,
    check_assumptions,
    order_by_risk,
    verdict_on,
)
from crawler2d.audits.subject import (
    ReadKeywords,
    check_size,
    read_obstacles,
    standard_obstacles,
    subject_of,
    unknown_of,
    vary_of,
)
from crawler2d.audits.text import head_of, lint_of, rest_of, row_of, text_of
from crawler2d.audits.verdicts import BELT, OWN, Verdict
from crawler2d.common.arrays import read_bool, whole_number
from crawler2d.common.extras import extra
from crawler2d.common.files import write_text
from crawler2d.common.keywords import takes_keywords
from crawler2d.errors import ScenarioError, ScenarioWarning, warn
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.terrain import Terrain
from crawler2d.reading.reading import Reading
from crawler2d.runs.progress import Progress, thread_count
from crawler2d.variation.distributions import Ranges

if TYPE_CHECKING:
    import xarray

__all__ = ["Audit", "audit"]

QUICK, SAMPLES, REPEATS = 36, 80, 1
"""Samples of the unknowns in a quick audit and in a full one, and runs of each: of 80 robots that
never seize at most 4.6 % do, of 80 of which 8 do so at least 5.2 %. A run of another robot is worth
more than another run of the same."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Audit(AuditRecord):
    """What an audit found; printing it shows the short form.

    Attributes
    ----------
    robot, reading : Robot, and Reading or None
        What was audited, and what was read if it was a file.
    lint, pockets : tuple of Finding, tuple of Pocket
        Probable mistakes in the model, and a check of its geometry.
    belt : Belt
        The robot on belts that it was compared with; its `reason` says which belts, and why.
    obstacles, verdicts : mapping of str to terrain, tuple of Verdict
        What it drove over, and the result on each.
    seizes : bool
        Whether it seizes on an obstacle that the belt clears.
    assumed : tuple of Assumption
        Whether seizures depend on rotors of the motors, or on restitution.
    repairs, repaired : tuple of Repair, and RepairSearch or None
        Changes that prevent the seizures, and the whole search for them.
    table : xarray.Dataset
        The runs behind the verdicts.
    vary, unknown, drive, call
        What the rates are taken over, how the robot was driven, and the arguments.
    """

    @property
    def summary(self) -> str:
        """The short form, as ``crawler2d audit`` prints it."""
        return text_of(self)

    @takes_keywords
    def patch(
        self, path: str | os.PathLike[str] | None = None, repair: Repair | None = None
    ) -> str:
        """Write the file that was audited with a repair, by default the best.

        Only wheels are changed in the file. All wheels of a carrier together keep their mass, and
        torque and rotors of their motors; a new one is a copy of its neighbour, with all that
        drives it. The result is read again, and refused if it is not the repaired robot. Settings
        of plugins that may no longer be right for so many or such wheels are left as they are, with
        a `ScenarioWarning` each; meshes that are only seen keep their size. With belts
        the robot is written as a new file, as by `Robot.to_sdf` and `to_mjcf`. The first comment of
        the file says what was changed, and with what result.

        Parameters
        ----------
        path : path-like, optional
            Where to write the file; meshes keep their relative names, so it belongs into the folder
            of the file that was read. URDF holds no belts: for these an .sdf is written instead,
            with a `ScenarioWarning`.
        repair : Repair, optional
            One of `repairs`. None takes the wheels of the first that is confirmed, else of the one
            that seizes least often if that is less often than the file does, else belts. If the
            file does not seize, nothing is written.

        Returns
        -------
        str
            What differs from the file that was read, as a unified diff; of a xacro file from what
            it expands to. "" if nothing was written, or a new file.

        Raises
        ------
        ScenarioError
            If no file was audited, `repair` is none, or the wheels cannot be changed in the file,
            such as meshes of another size, and no format holds the belts.
        OSError
            If it cannot be written.
        """
        if repair is not None and not isinstance(repair, Repair):
            raise ScenarioError("repair", repair, "must be one of the repairs of an audit")
        change = best_change(self) if repair is None else change_of(self, repair)
        if change is None:
            return ""
        for setting in change.left:
            warn("patch", setting, "leaves this to be set by hand")
        if path is not None:
            written = change.write(Path(path))
            if written != Path(path):
                warn("patch", str(written), f"is {change.summary}")
        return change.diff

    def __repr__(self) -> str:
        """Write the short form."""
        return self.summary

    @overload
    def to_html(self, path: None = None, *, threads: int | None = None) -> str: ...

    @overload
    def to_html(self, path: str | os.PathLike[str], *, threads: int | None = None) -> Path: ...

    @takes_keywords
    def to_html(
        self, path: str | os.PathLike[str] | None = None, *, threads: int | None = None
    ) -> str | Path:
        """Write one self-contained HTML page with all results.

        For each obstacle on which the robot seized one run is simulated again, with the same draws
        also with the repaired robot, or without a repair with the belt; if it seized nowhere, the
        run that came closest. The page replays them side by side.

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
        return text if path is None else write_text(path, text)


@takes_keywords
def audit(
    robot: Robot | Reading | str | os.PathLike[str],
    obstacles: Mapping[str, Terrain] | None = None,
    *,
    vary: Mapping[str, Any] | None = None,
    unknown: Mapping[str, Any] | None = None,
    samples: int | None = None,
    repeats: int = REPEATS,
    seed: int = 0,
    repair: bool = True,
    quick: bool = False,
    drive: Drive | None = None,
    duration: float | None = None,
    store: str | os.PathLike[str] | None = None,
    executor: Executor | None = None,
    threads: int | None = None,
    progress: bool | Progress | None = True,
    **reading: Unpack[ReadKeywords],
) -> Audit:
    """Find out whether a model of a robot seizes where a belt would not, and what prevents that.

    The robot and the same robot on belts drive over the standard obstacles many times, with its
    uncertain parameters resampled. The rules of lint, verdicts and repairs are in
    ``docs/conventions.md``, "Audit".

    Parameters
    ----------
    robot : Robot, Reading or path
        The robot, what was read of a model, or its file: SDF, URDF, xacro or MJCF.
    obstacles : mapping of str to terrain, optional
        What to drive over, by label, in place of the standard obstacles. They keep their friction.
    vary : mapping of str to distribution, optional
        What varies from run to run; see `sweep`. None takes start, contact and, of random step
        fields, the field; a tenth, a third and all of the speed in turn; and heights, rises, radii
        and widths of obstacles within 5 %.
    unknown : mapping of str to distribution, optional
        Uncertain parameters, in the same form. None takes narrow ranges for what a file states and
        wide ones for estimates; for a preset or another robot those of `unknowns`; and the friction
        of the floor. ``{}`` takes everything as known.
    samples : int, optional
        Largest number of samples of the uncertain parameters, 1 to 100,000; an obstacle is left as
        soon as its verdict is certain. Fewer than 35 cannot show that it does not seize. None takes
        80, or 36 if it is to be `quick`.
    repeats : int
        Runs of each of them over every obstacle, 1 to 1,000,000.
    seed : int
        Seed of the draws, 0 to 2^64 - 1.
    repair : bool
        Whether to search for repairs if it seizes.
    quick : bool
        Whether to take fewer samples, to try no torque and friction where it stops, and to search
        among round wheels alone if there are any.
    drive : Drive, optional
        None drives at 0.2 sqrt(g L), with L the axle distance, or at the robot's largest speed if
        that is less; flippers `Climb`, and are raised before the obstacle. `vary` takes shares of
        its speed.
    duration : float, optional
        [s] Longest simulated time at that speed; at a third of it runs have 5/3 of that, at a tenth
        4 times. None takes that in which the robot would drive fifteen times its own length.
    store : str or path-like, optional
        A file that keeps every run: the same call continues where it was; see `sweep`.
    executor, threads
        See `sweep`.
    progress : bool or callable
        True prints to the standard error what is known before the first run, each verdict as soon
        as it is certain, and the rest; a callable is given the number of finished runs and of all
        that may be needed.
    **reading
        For a path: the keywords of `read_robot`, such as `engine` and `trusted`.

    Returns
    -------
    Audit
        Lint, pockets, verdicts and repairs; printing it shows the short form.

    Raises
    ------
    ScenarioError
        If the file cannot be read, or an argument or the robot breaks a rule; or the file has a
        size that no tracked robot has, unless a `scale` is given.
    BatchInterrupted
        On Ctrl-C; a store keeps what was finished.
    ImportError
        If xarray is missing, or what the format of the file needs.

    Examples
    --------
    Four wheels that touch, on one step, with motors as a simulator has them:

    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4, wheel_radius=0.0608))
    >>> robot = robot.without_rotors()
    >>> step = {"step of 75 mm": c2d.terrains.step(0.075)}
    >>> found = audit(robot, step, unknown={}, repeats=20, quick=True, progress=False)
    >>> found.seizes, found.verdicts[0].where, found.verdicts[0].jam_counts
    (True, '1-2', (9, 9))
    >>> found.repairs[0].description, found.repairs[0].confirmed
    ('chassis: 5 wheels in place of 4', True)
    """
    extra("xarray", "analysis")  # fail before the runs if it is missing
    repair, quick = read_bool(repair, "repair"), read_bool(quick, "quick")
    usual = QUICK if quick else SAMPLES
    samples = whole_number(usual if samples is None else samples, "samples", 1, 10**5)
    repeats = whole_number(repeats, "repeats", 1, 10**6)
    whole_number(seed, "seed", 0, 2**64 - 1)
    thread_count(threads)
    if drive is not None and not isinstance(drive, Drive):
        raise ScenarioError("drive", drive, "must be a Drive")
    own_arguments = {
        "obstacles": obstacles,
        "vary": vary,
        "unknown": unknown,
        "drive": drive,
        "duration": duration,
    }
    write, show = read_progress(progress)
    subject = subject_of(robot, reading)
    own, read = subject.robot, subject.reading
    if read is not None:
        check_size(read)
    friction = 0.9 if read is None else read.friction
    grounds = standard_obstacles(own, friction)
    if obstacles is not None:
        grounds = read_obstacles(obstacles)
    found = pockets(own)
    grounds = {name: grounds[name] for name in order_by_risk(grounds, found)}
    if unknown is None:
        unknown = unknown_of(subject, with_friction=obstacles is None)
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
        trials=() if quick else TRIED,
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", ScenarioWarning)
        one = replace(runs, samples=1, repeats=1)
        for name, ground in grounds.items():  # what one of them lacks is an error before any run
            one.course({OWN: own}, name, ground)
        setup = AuditSetup(
            robot=own,
            reading=read,
            lint=lint(own, read, _core_warnings(caught)),
            pockets=found,
            belt=belt_of(own),
            obstacles=grounds,
            vary=runs.vary,
            unknown=unknown,
            drive=runs.scenario.drive,
            call=Call(
                samples=samples,
                repeats=repeats,
                seed=seed,
                repair=repair,
                quick=quick,
                own=tuple(name for name, value in own_arguments.items() if value is not None),
                reading={} if read is None else read.how.given,
            ),
        )
        write(head_of(setup))
        assumed = {} if "unknown" in setup.call.own else assumptions_of(own, unknown)
        verdicts, others, table = _drive(setup, runs, assumed, write, show)
        repairs = None
        if repair and any(each.result == "seizes" for each in verdicts):
            repairs = search_repairs(
                own,
                setup.belt,
                grounds=grounds,
                verdicts=verdicts,
                table=table,
                runs=runs,
                is_quick=quick,
                show=show,
            )
    for each in caught:
        if not issubclass(each.category, ScenarioWarning):
            warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)
    parts = {each.name: getattr(setup, each.name) for each in fields(setup)}
    parts["lint"] = lint(own, read, _core_warnings(caught))
    audit = Audit(**parts, verdicts=verdicts, assumed=others, repaired=repairs, table=table)
    late = [each for each in audit.lint if each not in setup.lint]
    if late:
        write("\n".join(lint_of(late, "Lint, warnings during the runs")))
    write(rest_of(audit))
    return audit


def _drive(
    setup: AuditSetup,
    runs: Runs,
    assumed: Mapping[str, Ranges],
    write: Callable[[str], None],
    show: Progress | None,
) -> tuple[tuple[Verdict, ...], tuple[Assumption, ...], xarray.Dataset]:
    """Drive over the obstacles one after another; write each verdict as soon as it is certain."""
    xr = extra("xarray", "analysis")
    models = {OWN: setup.robot, BELT: setup.belt.robot}
    verdicts, tables = [], []
    others: list[Assumption] = []
    count = RunCounter(show, len(setup.obstacles) * setup.call.samples * setup.call.repeats)
    for name, ground in setup.obstacles.items():
        verdict, table = verdict_on(runs.course(models, name, ground), name, count)
        write(row_of(setup, verdict))
        verdicts.append(verdict)
        tables.append(table)
        if verdict.result == "seizes":
            others += check_assumptions(assumed, runs, setup.robot, (name, ground), count)
    return tuple(verdicts), tuple(others), xr.concat(tables, "terrain")


def _core_warnings(caught: list[warnings.WarningMessage]) -> list[str]:
    """List the warnings of the core, each once."""
    messages = [str(each.message) for each in caught if issubclass(each.category, ScenarioWarning)]
    return list(dict.fromkeys(messages))
