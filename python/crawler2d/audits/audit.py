"""Audit a model of a robot: mistakes in it, where it seizes, and the smallest repair."""

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
from crawler2d.sweeps.store import Store
from crawler2d.variation.distributions import Ranges

if TYPE_CHECKING:
    import xarray

__all__ = ["Audit", "audit"]

QUICK, SAMPLES, REPEATS = 36, 80, 1
"""Samples of the unknowns in a quick and a full audit, and runs per sample. If none of 80 robots
seizes, the rate is at most 4.6 %; if 8 do, at least 5.2 %. Running another robot tells more than
repeating the same one."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Audit(AuditRecord):
    """Result of an audit; printing it shows the short form.

    Attributes
    ----------
    robot, reading : Robot, and Reading or None
        The audited robot, and the reading if it came from a file.
    lint, pockets : tuple of Finding, tuple of Pocket
        Probable mistakes in the model, and the spaces between its wheels.
    belt : Belt
        The robot on belts, for comparison; `reason` explains the choice of belts.
    obstacles, verdicts : mapping of str to terrain, tuple of Verdict
        The obstacles, and the verdict on each.
    seizes : bool
        Whether it seizes on an obstacle that the belt clears.
    assumed : tuple of Assumption
        Whether seizures depend on rotors of the motors, or on restitution.
    repairs, repaired : tuple of Repair, and RepairSearch or None
        Changes that prevent the seizures, and the search for them.
    table : xarray.Dataset
        The runs behind the verdicts.
    vary, unknown, drive, call
        Distributions behind the rates, the command, and the arguments.
    """

    @property
    def summary(self) -> str:
        """The short form, as printed by ``crawler2d audit``."""
        return text_of(self)

    @takes_keywords
    def patch(
        self, path: str | os.PathLike[str] | None = None, repair: Repair | None = None
    ) -> str:
        """Write the audited file with a repair, by default the best.

        Only wheels are changed in the file. The wheels of a carrier keep their total mass, motor
        torque and rotor inertia; a new wheel is a copy of its neighbour, including its drive. The
        result is read again, and refused if it is not the repaired robot. Plugin settings that may
        no longer fit the number or size of wheels are kept, with a `ScenarioWarning` each; visual
        meshes keep their size. A robot on belts is written as a new file, as by `Robot.to_sdf` and
        `to_mjcf`. The first comment of the file describes the change and its result.

        Parameters
        ----------
        path : path-like, optional
            File to write. Meshes keep their relative paths, so it belongs in the folder of the
            original file. URDF has no belts: for these an .sdf is written instead, with a
            `ScenarioWarning`.
        repair : Repair, optional
            One of `repairs`. None takes the first confirmed repair with wheels, else the one that
            seizes least often, if less often than the file, else belts. If the file does not seize,
            nothing is written.

        Returns
        -------
        str
            Unified diff from the original file; for a xacro file, from its expansion. "" if nothing
            was written, or a new file.

        Raises
        ------
        ScenarioError
            If no file was audited; if `repair` is not one of the audit's; or if the wheels cannot
            be changed in the file, such as meshes of another size, and no format supports the
            belts.
        OSError
            If the file cannot be written.
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

        For each obstacle on which the robot seized, one run is simulated again, and with the same
        draws the repaired robot, or without a repair the belt. If it seized nowhere, it is the run
        that came closest. The page replays both side by side.

        Parameters
        ----------
        path : str or path-like, optional
            File to write; None returns the text.
        threads : int, optional
            Threads for the replayed runs; see `simulate_many`.

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
        >>> page.startswith("<!doctype html>"), found.verdicts[0].jam_wheels in page
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
    """Find where a model of a robot seizes although a belt would not, and what prevents that.

    The robot and the same robot on belts drive over standard obstacles many times, with resampled
    uncertain parameters. The rules for lint, verdicts and repairs are in ``docs/conventions.md``,
    "Audit".

    Parameters
    ----------
    robot : Robot, Reading or path
        A robot, a reading, or a model file: SDF, URDF, xacro or MJCF.
    obstacles : mapping of str to terrain, optional
        Obstacles by label, instead of the standard ones. They keep their friction.
    vary : mapping of str to distribution, optional
        What varies from run to run; see `sweep`. None takes start and contact; the seed of random
        step fields; a tenth, a third and all of the speed in turn; and heights, rises, radii and
        widths of obstacles within 5 %.
    unknown : mapping of str to distribution, optional
        Uncertain parameters, in the same form. None takes the friction of the floor and, for a
        file, narrow ranges for stated figures and wide ones for estimates; for other robots those
        of `unknowns`. ``{}`` takes everything as known.
    samples : int, optional
        Largest number of samples of the uncertain parameters, 1 to 100,000; runs over an obstacle
        end as soon as its verdict is certain. Fewer than 35 cannot show that the robot does not
        seize. None takes 80, or 36 if `quick`.
    repeats : int
        Runs per sample and obstacle, 1 to 1,000,000.
    seed : int
        Seed of the draws, 0 to 2^64 - 1.
    repair : bool
        Whether to search for repairs if the robot seizes.
    quick : bool
        Whether to take fewer samples, to skip the trials of torque and friction, and to search only
        among round wheels if the robot has any.
    drive : Drive, optional
        The command. None drives at 0.2 sqrt(g L), with L the axle distance, or at the robot's
        largest speed if that is lower; flippers `Climb`, and are raised before the obstacle. `vary`
        scales this speed.
    duration : float, optional
        [s] Longest simulated time at that speed; 5/3 of it at a third of the speed, and 4 times at
        a tenth. None takes the time to drive fifteen times the robot's length.
    store : str or path-like, optional
        File that keeps every run: after an interruption the same call continues; see `sweep`.
    executor, threads
        See `sweep`.
    progress : bool or callable
        True prints results to the standard error as they become certain: those before the first
        run, each verdict, and the rest. A callable gets the numbers of finished runs and of all
        that may be needed.
    **reading
        For a file: keywords of `read_robot`, such as `engine` and `trusted`.

    Returns
    -------
    Audit
        Lint, pockets, verdicts and repairs; printing it shows the short form.

    Raises
    ------
    ScenarioError
        If the file cannot be read, or an argument or the robot breaks a rule; or if the file has a
        size that no tracked robot has, and `scale` is not given.
    StoreError
        If `store` cannot be used, before the first run, or fails.
    BatchInterrupted
        On Ctrl-C; a store keeps the finished runs.
    ImportError
        If xarray is missing, or a package for the format of the file.

    Examples
    --------
    Four wheels that touch, on one step, with the motors of a simulator:

    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4, wheel_radius=0.0608))
    >>> robot = robot.without_rotors()
    >>> step = {"step of 75 mm": c2d.terrains.step(0.075)}
    >>> found = audit(
    ...     robot, step, unknown={}, repeats=20, quick=True, duration=6.0, progress=False
    ... )
    >>> found.seizes, found.verdicts[0].jam_wheels, found.verdicts[0].jam_counts
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
    if drive is not None and not any((drive.speed, *(speed for _, speed in drive.schedule or ()))):
        raise ScenarioError("drive.speed", drive.speed, "must move the robot: it meets no obstacle")
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
        for name, ground in grounds.items():  # a missing path is an error before any run
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
        if store is not None:
            Store(store).close()  # an error before any result
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
    """Drive over the obstacles in order; write each verdict as soon as it is certain."""
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
