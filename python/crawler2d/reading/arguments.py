"""Arguments of a xacro file: those that are given, and settings of its package for those without.

A repository often passes its settings to xacro as arguments. If the model has an argument without a
value, the files of YAML in its package are looked through for it, and those that have it are taken
as a whole, as the repository would. Only ``name: value`` at the beginning of a line counts.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property

from crawler2d.errors import ScenarioError
from crawler2d.reading.files import Files
from crawler2d.reading.telling import Doubt

__all__ = ["Arguments", "Setting", "Settings", "doubts_of"]

_MOST_FILES = 100
_LARGEST = 64_000  # [bytes]
_MOST_BYTES = 1_000_000
_LINE = re.compile(r"([A-Za-z_]\w*) ?: +(\S.*)")
_QUOTED = re.compile(r"""(["'])([^"'\\]*)\1\s*(?:\s#.*)?""")
_NO_SCALAR = "[]{}&*!|>%@`\"'#,?:"  # lists, blocks, anchors, comments and the like begin so
_NOTHING = ("null", "Null", "NULL", "~")


@dataclass(frozen=True, slots=True)
class Setting:
    """A value in a file of settings.

    Parameters
    ----------
    path : str
        Of the file, from the folder of the model.
    line : int
        Of the value.
    value : str
        As it is written.
    """

    path: str
    line: int
    value: str

    @property
    def file(self) -> str:
        """Its name."""
        return os.path.basename(self.path)


class Arguments(dict[str, str]):
    """Values of arguments by name; what has none is noted, and is 0 for the time being.

    Parameters
    ----------
    values : mapping of str to str
        Those that are known.

    Attributes
    ----------
    lacking : dict of str to None
        Those that were asked for in vain, in this order.

    Examples
    --------
    >>> arguments = Arguments({"radius": "0.1"})
    >>> arguments["radius"], arguments["width"], list(arguments.lacking)
    ('0.1', '0', ['width'])
    """

    def __init__(self, values: Mapping[str, str]) -> None:
        super().__init__(values)
        self.lacking: dict[str, None] = {}

    def __missing__(self, name: str) -> str:
        """Note the name."""
        self.lacking[name] = None
        return "0"


class Settings:
    """Settings in the package of a model.

    Parameters
    ----------
    files : Files
        Those of the model.
    """

    def __init__(self, files: Files) -> None:
        self._files = files

    def of(self, lacking: Iterable[str]) -> tuple[dict[str, Setting], list[str]]:
        """Look for values of arguments that have none.

        Parameters
        ----------
        lacking : iterable of str
            The arguments.

        Returns
        -------
        settings : dict of str to Setting
            All of the files that have one of the arguments, as far as they agree.
        differing : list of str
            Places of values for an argument that do not agree, in words.
        """
        chosen: dict[int, dict[str, Setting]] = {}
        differing: dict[str, str] = {}
        for name in lacking:
            having = {n: table for n, table in enumerate(self._tables) if name in table}
            values = [table[name] for table in having.values()]
            if len({each.value for each in values}) > 1:
                places = [f"{each.value} in {each.path}:{each.line}" for each in values[:4]]
                differing[name] = f"{name} is {', '.join(places)}"
            else:
                chosen |= having
        found: dict[str, list[Setting]] = {}
        for table in chosen.values():
            for name, each in table.items():
                found.setdefault(name, []).append(each)
        agreed = {
            name: values[0]
            for name, values in found.items()
            if len({each.value for each in values}) == 1 and name not in differing
        }
        return agreed, list(differing.values())

    @cached_property
    def _tables(self) -> list[dict[str, Setting]]:
        """What the files have at the beginning of lines; odd ones are passed over."""
        tables, left = [], _MOST_BYTES
        for path in self._files.settings()[:_MOST_FILES]:
            try:
                data = self._files.read(str(path), at=path.name, most=min(_LARGEST, left))
            except ScenarioError:
                continue
            left -= len(data)
            name = os.path.relpath(path, self._files.folder)
            tables.append(_table(name, data.decode(errors="replace")))
        return tables


def doubts_of(
    settings: Mapping[str, Setting], defaults: Mapping[str, str], lacking: Iterable[str]
) -> list[Doubt]:
    """Say what was taken from settings: for arguments without a default, and in place of one.

    Parameters
    ----------
    settings : mapping of str to Setting
        Those that were taken.
    defaults : mapping of str to str
        Of the arguments that have one.
    lacking : iterable of str
        Arguments that had no value.
    """
    doubts: list[Doubt] = []
    for name in lacking:
        if name in settings:
            each = settings[name]
            reason = f"is taken for the argument {name}, which has no default: arguments= sets it"
            doubts.append((f"{each.file}:{each.line}", each.value, reason))
    others: dict[str, list[str]] = {}
    for name, default in defaults.items():
        if name in settings and not _same(settings[name].value, default):
            each = settings[name]
            others.setdefault(each.file, []).append(f"{name}: {each.value} for {default}")
    reason = "is taken as a whole, also in place of defaults"
    doubts += [(file, ", ".join(values), reason) for file, values in others.items()]
    return doubts


def _table(path: str, text: str) -> dict[str, Setting]:
    found: dict[str, Setting] = {}
    for number, line in enumerate(text.split("\n"), 1):
        match = _LINE.fullmatch(line.rstrip())
        value = _scalar(match[2]) if match else None
        if match and value is not None:
            found[match[1]] = Setting(path, number, value)
    return found


def _scalar(text: str) -> str | None:
    """Return a plain text or one in quotes, without a comment; None for anything else."""
    quoted = _QUOTED.fullmatch(text)
    if quoted:
        return quoted[2]
    plain = re.split(r"\s#", text, maxsplit=1)[0].strip()
    return None if plain in _NOTHING or plain[0] in _NO_SCALAR else plain


def _same(one: str, other: str) -> bool:
    """Whether two values mean the same to xacro, as 1, 1.0 and True do."""
    return _meant(one) == _meant(other)


def _meant(value: str) -> float | str:
    try:
        return float({"true": "1", "false": "0"}.get(value.lower(), value))
    except ValueError:
        return value
