"""How an audit was asked for: the call, and the command that makes it again."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Call", "command_of"]

_FLAGS = {"trusted": "--trusted"}
_VALUES = {
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


@dataclass(frozen=True, slots=True, kw_only=True)
class Call:
    """What an audit was asked for; the fields are arguments of `audit`.

    Parameters
    ----------
    samples, repeats, seed, repair
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
    own: tuple[str, ...] = ()
    reading: Mapping[str, Any] = field(default_factory=dict)


def command_of(call: Call, file: str) -> str | None:
    """Write the command that makes an audit of a file again; None if no command does.

    Examples
    --------
    >>> call = Call(samples=80, repeats=2, seed=1, repair=True, reading={"engine": "gz"})
    >>> command_of(call, "my robot.sdf")
    "python -m crawler2d audit 'my robot.sdf' --samples 80 --repeats 2 --seed 1 --engine=gz"
    """
    if call.own:
        return None
    # A name that looks like an option is none with its folder.
    words = ["python", "-m", "crawler2d", "audit", f"./{file}" if file.startswith("-") else file]
    words += ["--samples", str(call.samples), "--repeats", str(call.repeats)]
    words += ["--seed", str(call.seed)]
    if not call.repair:
        words.append("--no-repairs")
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
