"""Arguments of a xacro file: those that are given, and settings of its package for those without.

A repository often passes its settings to xacro as arguments. If the model has an argument without a
value, the files of YAML in its package are looked through for it, and those that have it are taken
as a whole, as the repository would. Only ``name: value`` at the beginning of a line counts.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from crawler2d.errors import ScenarioError
from crawler2d.reading.files import Files
from crawler2d.reading.telling import Doubt

__all__ = ["Arguments", "Setting", "doubts_of", "settings_for"]

_MOST_FILES = 100
_LARGEST = 64_000  # [bytes]
_LINE = re.compile(r"([A-Za-z_]\w*) ?: +(\S.*)")
_QUOTED = re.compile(r"""(["'])([^"'\\]*)\1\s*(?:\s#.*)?""")
_NO_SCALAR = "[]{}&*!|>%@`\"'#,?:"  # lists, blocks, anchors, comments and the like begin so
_NOTHING = ("null", "Null", "NULL", "~")


@dataclass(frozen=True, slots=True)
class Setting:
    """A value in a file of settings.

    Parameters
    ----------
    file : str
        Name of the file.
    line : int
        Of the value.
    value : str
        As it is written.
    """

    file: str
    line: int
    value: str


class Arguments(dict[str, str]):
    """Values of arguments by name; what has none is noted, and is 0 for the time being.

    Parameters
    ----------
    values : mapping of str to str
        Those that are known.

    Attributes
    ----------
    lacking : list of str
        Those that were asked for in vain.

    Examples
    --------
    >>> arguments = Arguments({"radius": "0.1"})
    >>> arguments["radius"], arguments["width"], arguments.lacking
    ('0.1', '0', ['width'])
    """

    def __init__(self, values: Mapping[str, str]) -> None:
        super().__init__(values)
        self.lacking: list[str] = []

    def __missing__(self, name: str) -> str:
        """Note the name."""
        if name not in self.lacking:
            self.lacking.append(name)
        return "0"


def settings_for(files: Files, lacking: Iterable[str]) -> tuple[dict[str, Setting], list[str]]:
    """Look for settings with a value for arguments that have none.

    Parameters
    ----------
    files : Files
        Those of the model.
    lacking : iterable of str
        The arguments.

    Returns
    -------
    settings : dict of str to Setting
        All of the files that have one of the arguments, as far as they agree.
    differing : list of str
        Places of values for an argument that do not agree, in words.
    """
    tables = _tables(files)
    chosen: list[dict[str, Setting]] = []
    differing = []
    for name in lacking:
        having = [table for table in tables if name in table]
        if len({table[name].value for table in having}) > 1:
            values = [table[name] for table in having]
            places = ", ".join(f"{each.value} in {each.file}:{each.line}" for each in values[:4])
            differing.append(f"{name} is {places}")
        else:
            chosen += [table for table in having if table not in chosen]
    found: dict[str, Setting] = {}
    for name in dict.fromkeys(name for table in chosen for name in table):
        values = [table[name] for table in chosen if name in table]
        if len({each.value for each in values}) == 1:
            found[name] = values[0]
    return found, differing


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


def _tables(files: Files) -> list[dict[str, Setting]]:
    """Read what the files of settings have at the beginning of lines; odd files are passed over."""
    tables = []
    for path in files.settings()[:_MOST_FILES]:
        try:
            data = files.read(str(path), at=path.name, most=_LARGEST)
        except ScenarioError:
            continue
        tables.append(_table(path.name, data.decode(errors="replace")))
    return tables


def _table(file: str, text: str) -> dict[str, Setting]:
    found: dict[str, Setting] = {}
    for number, line in enumerate(text.split("\n"), 1):
        match = _LINE.fullmatch(line.rstrip())
        value = _scalar(match[2]) if match else None
        if match and value is not None:
            found[match[1]] = Setting(file, number, value)
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
