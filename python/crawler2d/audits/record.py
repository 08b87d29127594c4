"""Arguments and results of an audit, as data."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from crawler2d.audits.candidates import Pocket
from crawler2d.audits.lint import Finding
from crawler2d.audits.repairs import Repair, RepairSearch
from crawler2d.audits.runs import Belt
from crawler2d.audits.sampling import Assumption
from crawler2d.audits.verdicts import Verdict
from crawler2d.common.bodies import BodyKind, bodies_of
from crawler2d.errors import ignore_warnings
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.terrain import Flat, Terrain
from crawler2d.reading.reading import Reading

if TYPE_CHECKING:
    import xarray

__all__ = [
    "OPTIONS",
    "READING",
    "AuditRecord",
    "AuditSetup",
    "Call",
    "as_options",
    "bodies_per_side",
    "command_of",
    "names_of",
]

READING = ("engine", "forward", "model", "mesh", "missing", "ground_friction", "tolerance", "scale")
"""Keywords of `read_robot`, and options of the command, that take one value."""

_ALIKE = ("samples", "repeats", "seed", "store", "threads", "quick", "trusted", "html", "patch")

OPTIONS = {
    **{name: f"--{name.replace('_', '-')}" for name in (*_ALIKE, *READING)},
    **{f"{name}s": f"--{name}" for name in ("track", "package", "argument")},
    "baseline": "--baseline",
    "path": "FILE",
}
"""Spelling of the keywords of `audit` in the command, and of its outputs."""

_FOLLOWS = {"packages": "NAME=FOLDER", "arguments": "NAME=VALUE"}


def bodies_per_side(robot: Robot) -> int:
    """Count the bodies of one side, including flippers: the number of the first on the right."""
    with ignore_warnings():
        # At rest, as the usual speed may exceed the robot's.
        bodies = bodies_of(Scenario(robot, Flat(), drive=Drive(speed=0.0)).to_json())
    return int(((bodies["body"] >= 0) & (bodies["kind"] != BodyKind.BELLY)).sum())


def names_of(robot: Robot, reading: Reading | None) -> dict[int, str]:
    """Return the name of each wheel in the file, by body number.

    Wheels on the right are numbered after all on the left, as for ground that differs between the
    tracks. On common ground, a number means a pair, with the name of its left wheel. If a carrier
    and the file differ in the number of wheels, as for a robot standing on the roots of its
    flippers, its bodies have no names; without a file there are none.
    """
    if reading is None:
        return {}
    bodies, links = robot.wheels(), reading.wheels
    names: dict[int, str] = {}
    for side, first in (("left", 0), ("right", bodies_per_side(robot))):
        for carrier in ("chassis", "front flipper", "rear flipper"):
            here, there = (
                (table["side"] == side) & (table["carrier"] == carrier) for table in (bodies, links)
            )
            if here.sum() == there.sum():
                own = sorted(zip(bodies["x"][here], bodies["body"][here], strict=True))
                named = sorted(zip(links["x"][there], links["name"][there], strict=True))
                names |= {
                    first + int(body): str(name)
                    for (_, body), (_, name) in zip(own, named, strict=True)
                }
    return names


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """The arguments of an audit, see `audit`.

    Parameters
    ----------
    samples, repeats, seed, repair, quick
        See `audit`.
    own : tuple of str
        Names of the other given arguments.
    reading : mapping
        Keywords of `read_robot` that differ from their defaults.
    """

    samples: int
    repeats: int
    seed: int
    repair: bool
    quick: bool = False
    own: tuple[str, ...] = ()
    reading: Mapping[str, Any] = field(default_factory=dict)


def command_of(call: Call, file: str) -> str | None:
    """Write the command that repeats the audit of a file; None if there is none.

    Examples
    --------
    >>> call = Call(samples=80, repeats=2, seed=1, repair=True, reading={"engine": "gz"})
    >>> command_of(call, "my robot.sdf")
    "crawler2d audit 'my robot.sdf' --samples 80 --repeats 2 --seed 1 --engine=gz"
    """
    if call.own:
        return None
    # With its folder, a name cannot be mistaken for an option.
    words = ["crawler2d", "audit", f"./{file}" if file.startswith("-") else file]
    words += ["--samples", str(call.samples), "--repeats", str(call.repeats)]
    words += ["--seed", str(call.seed)]
    if not call.repair:
        words.append("--no-repairs")
    if call.quick:
        words.append("--quick")
    for name, value in call.reading.items():
        option = OPTIONS[name]
        if value is True:
            words.append(option)
        elif isinstance(value, Mapping):
            words += [f"{option}={key}={each}" for key, each in value.items()]
        elif name in READING:
            words.append(f"{option}={value}")
        else:
            words += [f"{option}={each}" for each in value]
    return shlex.join(words)


def as_options(error: str) -> str:
    """Replace keywords in an error by options of the command.

    Examples
    --------
    >>> as_options('must be no mesh: mesh="hull" takes its hull')
    'must be no mesh: --mesh hull takes its hull'
    >>> as_options("forward must be given, got None")
    '--forward must be given'
    >>> as_options("packages={name: folder} says where each is, and tolerance= may say more")
    '--package NAME=FOLDER says where each is, and --tolerance may say more'
    >>> as_options("  warning, other: arguments[size] has no effect")
    '  warning, other: --argument has no effect'
    """
    for name, option in OPTIONS.items():
        value = _FOLLOWS.get(name, "")

        def advised(found: re.Match[str], option: str = option, value: str = value) -> str:
            given = (found[1] or "").strip("\"'")
            if given.startswith("{"):
                given = value
            return option if given in ("", "True") else f"{option} {given}"

        error = re.sub(rf'(?<![\w.-]){name}=(\{{[^}}]*\}}|"[^"]*"|[\w.+-]*\w)?', advised, error)
        error = re.sub(rf"(^|, other: ){name}(\[[^]]*\])?(?= )", rf"\1{option}", error)
    return re.sub(r", got None(?=$|[:;] )", "", error)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AuditSetup:
    """What is known before the first run of an audit.

    Parameters
    ----------
    robot : Robot
        The audited robot.
    reading : Reading, optional
        The reading, if it came from a file.
    lint : tuple of Finding
        Probable mistakes in the model, errors first.
    pockets : tuple of Pocket
        Spaces between its wheels: a check of the geometry, not a verdict.
    belt : Belt
        The robot on belts, for comparison, and the reason for the kind of belt.
    obstacles : mapping of str to terrain
        Obstacles in driving order: first those on which seizures are likely.
    vary, unknown : mapping of str to distribution
        What varies from run to run, and what is unknown.
    drive : Drive
        The command.
    call : Call
        The arguments.
    """

    robot: Robot
    reading: Reading | None
    lint: tuple[Finding, ...]
    pockets: tuple[Pocket, ...]
    belt: Belt
    obstacles: Mapping[str, Terrain]
    vary: Mapping[str, Any]
    unknown: Mapping[str, Any]
    drive: Drive
    call: Call


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AuditRecord(AuditSetup):
    """The results of an audit, as data.

    Parameters
    ----------
    verdicts : tuple of Verdict
        One for each obstacle, in order.
    assumed : tuple of Assumption
        Rate of each seizure under other assumptions; empty if `unknown` was given.
    repaired : RepairSearch, optional
        Result of the search for repairs; None without a search.
    table : xarray.Dataset
        The runs behind the verdicts, as from `sweep`: dimensions `model` ("model", "belt"),
        `terrain`, `sample` and `repeat`. Without unknowns the repeats are in `sample`. The
        coordinate `speed` [m/s] is that of each run, without its scatter. Runs that no verdict
        needed are missing, with the outcome "". The attributes `vary` and `unknown` describe the
        population of the rates.
    """

    verdicts: tuple[Verdict, ...]
    assumed: tuple[Assumption, ...]
    repaired: RepairSearch | None
    table: xarray.Dataset

    @property
    def seizes(self) -> bool:
        """Whether the robot seizes, by `Verdict.result`, on an obstacle that the belt clears."""
        return any(each.result == "seizes" for each in self.verdicts)

    @property
    def repairs(self) -> tuple[Repair, ...]:
        """The best of each kind tried: confirmed ones first, then the smallest change first.

        `Repair.confirmed` says whether fresh runs confirm it; empty without a search.
        """
        return () if self.repaired is None else self.repaired.repairs
