"""How an audit was asked for: the call, the command that makes it again, and its options."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["OPTIONS", "Call", "as_options", "command_of"]

_FLAGS = {"trusted": "--trusted", "quick": "--quick"}
_VALUES = {
    "samples": "--samples",
    "repeats": "--repeats",
    "seed": "--seed",
    "store": "--store",
    "threads": "--threads",
    "engine": "--engine",
    "forward": "--forward",
    "model": "--model",
    "mesh": "--mesh",
    "missing": "--missing",
    "ground_friction": "--ground-friction",
    "tolerance": "--tolerance",
    "scale": "--scale",
}
_LISTS = {"tracks": "--track"}
_PAIRS = {"packages": "--package", "arguments": "--argument"}
_FOLLOWS = {"packages": "NAME=FOLDER", "arguments": "NAME=VALUE"}
_FILES = {"path": "FILE", "html": "--html", "patch": "--patch"}

OPTIONS = {**_FLAGS, **_VALUES, **_LISTS, **_PAIRS, **_FILES}
"""How the command spells the keywords of `audit`, and of what it writes."""


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
    """Write the command that makes an audit of a file again; None if no command does.

    Examples
    --------
    >>> call = Call(samples=80, repeats=2, seed=1, repair=True, reading={"engine": "gz"})
    >>> command_of(call, "my robot.sdf")
    "crawler2d audit 'my robot.sdf' --samples 80 --repeats 2 --seed 1 --engine=gz"
    """
    if call.own:
        return None
    # A name that looks like an option is none with its folder.
    words = ["crawler2d", "audit", f"./{file}" if file.startswith("-") else file]
    words += ["--samples", str(call.samples), "--repeats", str(call.repeats)]
    words += ["--seed", str(call.seed)]
    if not call.repair:
        words.append("--no-repairs")
    if call.quick:
        words.append("--quick")
    for name, value in call.reading.items():
        if name in _FLAGS:
            words.append(_FLAGS[name])
        elif name in _VALUES:
            words.append(f"{_VALUES[name]}={value}")
        elif name in _LISTS:
            words += [f"{_LISTS[name]}={each}" for each in value]
        else:
            words += [f"{_PAIRS[name]}={key}={each}" for key, each in value.items()]
    return shlex.join(words)


def as_options(error: str) -> str:
    """Write the keywords that an error names as options of the command.

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
    return error.removesuffix(", got None")
