"""What an audit was asked for and what it found, as data."""

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
"""Keywords of `read_robot` that take one value, and so do the options of the command."""

_ALIKE = ("samples", "repeats", "seed", "store", "threads", "quick", "trusted", "html", "patch")

OPTIONS = {
    **{name: f"--{name.replace('_', '-')}" for name in (*_ALIKE, *READING)},
    **{f"{name}s": f"--{name}" for name in ("track", "package", "argument")},
    "path": "FILE",
}
"""How the command spells the keywords of `audit`, and of what it writes."""

_FOLLOWS = {"packages": "NAME=FOLDER", "arguments": "NAME=VALUE"}


def bodies_per_side(robot: Robot) -> int:
    """Count the bodies of one side, flippers included: the number of the first on the right."""
    with ignore_warnings():
        # At rest: what is usual may be faster than it is.
        bodies = bodies_of(Scenario(robot, Flat(), drive=Drive(speed=0.0)).to_json())
    return int(((bodies["body"] >= 0) & (bodies["kind"] != BodyKind.BELLY)).sum())


def names_of(robot: Robot, reading: Reading | None) -> dict[int, str]:
    """Return the name in the file of each wheel, by the number of its body.

    Those on the right are numbered after all on the left, as where each track has its own ground.
    Where both have the same, a number is that of a pair, which has the name of its left wheel.
    Where a carrier has another number of wheels than the file, as one that stands on the roots of
    its flippers, its bodies have no names; without a file none has.
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
    """What an audit was asked for; the fields are arguments of `audit`.

    Parameters
    ----------
    samples, repeats, seed, repair, quick
        See `audit`.
    own : tuple of str
        Names of the other arguments that were given.
    reading : mapping
        How the file was read: the keywords of `read_robot` that differ from their defaults.
    """

    samples: int
    repeats: int
    seed: int
    repair: bool
    quick: bool = False
    own: tuple[str, ...] = ()
    reading: Mapping[str, Any] = field(default_factory=dict)


def command_of(call: Call, file: str) -> str | None:
    """Write the command that repeats the audit of a file; None if no command does.

    Examples
    --------
    >>> call = Call(samples=80, repeats=2, seed=1, repair=True, reading={"engine": "gz"})
    >>> command_of(call, "my robot.sdf")
    "crawler2d audit 'my robot.sdf' --samples 80 --repeats 2 --seed 1 --engine=gz"
    """
    if call.own:
        return None
    # With its folder, a name cannot be taken for an option.
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
    """Write the keywords in an error as options of the command.

    Examples
    --------
    >>> as_options('must be no mesh: mesh="hull" takes its hull')
    'must be no mesh: --mesh hull takes its hull'
    >>> as_options("forward must be given, got None")
    '--forward must be given'
    >>> as_options("packages={name: folder} says where each is, and tolerance= may say more")
    '--package NAME=FOLDER says where each is, and --tolerance may say more'
    """
    for name, option in OPTIONS.items():
        value = _FOLLOWS.get(name, "")

        def advised(found: re.Match[str], option: str = option, value: str = value) -> str:
            given = (found[1] or "").strip("\"'")
            if given.startswith("{"):
                given = value
            return option if given in ("", "True") else f"{option} {given}"

        error = re.sub(rf'(?<![\w.-]){name}=(\{{[^}}]*\}}|"[^"]*"|[\w.+-]*\w)?', advised, error)
        error = re.sub(rf"^{name}(\[[^]]*\])?(?= )", option, error)
    return re.sub(r", got None(?=$|[:;] )", "", error)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class AuditSetup:
    """What an audit knows before the first run.

    Parameters
    ----------
    robot : Robot
        What was audited.
    reading : Reading, optional
        What was read, if it was a file.
    lint : tuple of Finding
        Probable mistakes in the model, errors first.
    pockets : tuple of Pocket
        The spaces between its wheels: a check of the geometry, not a verdict.
    belt : Belt
        The robot on belts for comparison, and the reason for the kind of belt.
    obstacles : mapping of str to terrain
        What it drives over, in this order: those first where it is likely to seize.
    vary, unknown : mapping of str to distribution
        What differs from run to run, and what is unknown.
    drive : Drive
        How it is driven.
    call : Call
        What was asked for.
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
    """What an audit found, as data.

    Parameters
    ----------
    verdicts : tuple of Verdict
        One for each obstacle, in their order.
    assumed : tuple of Assumption
        How often each seizure occurs under other assumptions; none if `unknown` was given.
    repaired : RepairSearch, optional
        What the search for repairs found; None if there was none.
    table : xarray.Dataset
        The runs behind the verdicts, as from `sweep`: dimensions `model` ("model", "belt"),
        `terrain`, `sample` and `repeat`. Without unknowns the repeats stand in `sample`. The
        coordinate `speed` [m/s] is that of each run, without its scatter. Runs that no verdict
        needed were not made, and have the outcome "". Its attributes `vary` and `unknown` name
        what the rates are rates over.
    """

    verdicts: tuple[Verdict, ...]
    assumed: tuple[Assumption, ...]
    repaired: RepairSearch | None
    table: xarray.Dataset

    @property
    def seizes(self) -> bool:
        """Whether it seizes, by `Verdict.result`, on an obstacle that the belt clears."""
        return any(each.result == "seizes" for each in self.verdicts)

    @property
    def repairs(self) -> tuple[Repair, ...]:
        """The best of each kind that was tried: the confirmed ones first, then the least changed.

        `Repair.confirmed` says whether fresh runs confirm it; empty without a search.
        """
        return () if self.repaired is None else self.repaired.repairs
