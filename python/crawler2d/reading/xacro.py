"""Xacro files as URDF, expanded by xacro itself in a child process.

A repository often passes its settings to xacro as arguments. If the model has an argument without a
value, the YAML files of its package are searched for it, and those that have it are taken as a
whole, as the repository would. Only ``name: value`` at the beginning of a line counts.
"""

from __future__ import annotations

import builtins
import os
import re
from collections import ChainMap
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType, SimpleNamespace
from typing import Any, NoReturn

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.reading.child import ask_child, serve
from crawler2d.reading.elements import Element
from crawler2d.reading.expressions import NAMES, NotAllowed, copy_data, evaluate
from crawler2d.reading.files import Files
from crawler2d.reading.log import Doubt
from crawler2d.reading.xacro_tree import XacroFiles, XacroMacros

__all__ = ["expand_xacro"]

_MOST_FILES = 100
_LARGEST = 64_000  # [bytes]
_MOST_BYTES = 1_000_000
_LINE = re.compile(r"([A-Za-z_]\w*) ?: +(\S.*)")
_QUOTED = re.compile(r"""(["'])([^"'\\]*)\1\s*(?:\s#.*)?""")
_NO_SCALAR = "[]{}&*!|>%@`\"'#,?:"  # lists, blocks, anchors, comments and the like begin so
_NOTHING = ("null", "Null", "NULL", "~")

# What xacro says was unknown to it, or could not be evaluated.
_CULPRITS = re.compile(r"unknown macro name: (\S+)|'([^']{2,})'")

_EVALUATED = re.compile(r"when evaluating expression '(.*)'", re.DOTALL)
_MOST_PASSES = 5
_MOST_DOUBTS = 100


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
    """Values of arguments by name; what has none is add_doubts, and is 0 for the time being.

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


def expand_xacro(
    files: Files,
    data: bytes,
    root: Element,
    *,
    trusted: bool,
    arguments: Mapping[str, str],
    leave_out: bool,
) -> tuple[bytes, list[Doubt]]:
    """Expand a file.

    Parameters
    ----------
    files : Files
        Those of the model.
    data : bytes
        What it holds.
    root : Element
        Of the file, for errors.
    trusted : bool
        Whether its user trusts it: Python evaluates its expressions, whatever they are.
    arguments : mapping of str to str
        Values of its ``xacro:arg``.
    leave_out : bool
        Whether it does without what is not there: includes and calls of their macros are left out,
        arguments without a value are looked for in settings.

    Returns
    -------
    text : bytes
        The URDF.
    doubts : list of Doubt
        What was left out, and what was taken for something that is not there.

    Raises
    ------
    ScenarioError
        If it does not expand, needs what is not there, or is not trusted and has expressions of
        more than plain data and known functions.
    ImportError
        If xacrodoc is missing; the message names the extra to install.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        root.refuse("another encoding", "must be UTF-8, which xacro reads")
    question = {
        "text": text,
        "file": root.where.file,
        "files": files.parameters,
        "trusted": trusted,
        "arguments": {name: str(value) for name, value in arguments.items()},
        "leave_out": leave_out,
    }
    answer = ask_child("crawler2d.reading.xacro", question, file=root.where.file, files=files)
    return answer["text"].encode(), [(path, value, why) for path, value, why in answer["doubts"]]


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


def prepare() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Import xacrodoc, which brings xacro along and needs no ROS."""
    module = extra("xacrodoc", "models")
    xacro, substitution = extra("xacro", "models"), extra("xacro.substitution_args", "models")
    own = SimpleNamespace(**vars(xacro), resolve_args=substitution.resolve_args)
    return lambda question: _expanded(module, xacro, substitution, own, **question)


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


def _expanded(
    module: Any,
    xacro: Any,
    substitution: Any,
    own: SimpleNamespace,
    *,
    text: str,
    file: str,
    files: dict[str, Any],
    trusted: bool,
    arguments: dict[str, str],
    leave_out: bool,
) -> dict[str, Any]:
    """Go through a file until no more settings and macros are found that it lacks."""
    shared = Files(**files)
    package = Settings(shared)
    found: dict[str, Setting] = {}
    lacking: dict[str, None] = {}
    macros: dict[str, Any] = {}
    for _ in range(_MOST_PASSES):
        settings = found
        values = Arguments({name: each.value for name, each in settings.items()} | arguments)
        door = XacroFiles(shared, file, text, leave_out=leave_out)
        calls = XacroMacros(door, leave_out=leave_out, known=macros)
        shared.doubts.clear()
        builtins.open = door  # type: ignore[assignment]
        door.attach(xacro, substitution, own)
        calls.attach(xacro, own)
        if not trusted:
            _check(xacro, substitution)
        xacro.filestack = xacro.macrostack = None
        urdf, failure = "", None
        try:
            made = module.XacroDoc.from_string(text, subargs=values, resolve_packages=False)
            urdf = made.to_urdf_string()
        except Exception as error:  # xacro raises what its expressions raise, and wraps some of it
            failure = error
        lacking |= values.lacking
        found, differing = package.of(lacking) if leave_out and lacking else ({}, [])
        wanted = {*lacking, *door.defaults}
        found = {name: each for name, each in found.items() if name in wanted - arguments.keys()}
        later = {name: calls.defined[name] for name in calls.unknown & calls.defined.keys()}
        if found == settings and later.keys() <= macros.keys():
            break
        macros = macros | later
    if values.lacking:
        _refuse_arguments(door, values.lacking, differing, more=failure is not None)
    if failure is not None:
        _refuse(failure, door, xacro)
    taken = doubts_of(settings, door.defaults, lacking)
    return {"text": urdf, "doubts": _told([*door.doubts, *shared.doubts, *taken])}


def _check(xacro: Any, substitution: Any) -> None:
    """Put a checked evaluation in the place of both that xacro has; keep it from looking round."""
    load, context = xacro.load_yaml, xacro.substitution_args_context
    own: dict[str, Callable[..., Any]] = {
        "load_yaml": lambda name: copy_data(load(name)),
        "dotify": dict,
        "abs_filename": xacro.abs_filename_spec,
    }
    others: dict[str, Callable[..., Any]] = {
        "arg": lambda name: context["arg"][name],
        "fatal": _fatal,
        "tokenize": _tokens,
        **dict.fromkeys(("message", "warning", "error", "print_location"), lambda *_: ""),
    }
    names = {**NAMES, **own, "xacro": MappingProxyType({**own, **others})}

    def in_eval(text: str, context: Mapping[str, Any]) -> str:
        arguments = context.get("arg", {}).items()
        values = {name: substitution.convert_value(str(value), "auto") for name, value in arguments}
        return str(evaluate(text, ChainMap({"true": True, "false": False, **values}, names)))

    def default(name: str, default: str = "") -> str:
        return default if name not in os.environ else _refuse_environment(name)

    xacro._global_symbols = names
    xacro.safe_eval = lambda text, symbols, _=None: evaluate(text, symbols)
    xacro.glob = SimpleNamespace(glob=_refuse_pattern)
    substitution._eval = in_eval
    substitution._eval_env = _refuse_environment
    substitution._eval_optenv = default


def _fatal(*words: Any) -> NoReturn:
    raise ValueError(" ".join(map(str, words)))


def _tokens(text: str, separators: str = ",; ", skip_empty: bool = True) -> list[str]:
    pieces = re.split(f"[{re.escape(separators)}]", text)
    return [piece for piece in pieces if piece or not skip_empty]


def _refuse_environment(name: str) -> NoReturn:
    raise NotAllowed(name, "must ask for no environment variable")


def _refuse_pattern(pattern: str) -> NoReturn:
    raise NotAllowed(pattern, "must include files by their names")


def _refuse_arguments(
    door: XacroFiles, lacking: Iterable[str], differing: list[str], *, more: bool
) -> NoReturn:
    """Refuse a file for all arguments that have no value."""
    names = dict.fromkeys([*lacking, *(door.lacking() if more else [])])
    rule = "must have a value for each argument, by a default or by arguments={name: value}"
    if differing:
        rule += f"; files of settings differ: {'; '.join(differing)}"
    raise ScenarioError(door.place([f"$(arg {name})" for name in names]), ", ".join(names), rule)


def _refuse(error: Exception, door: XacroFiles, xacro: Any) -> NoReturn:
    """Refuse a file that does not expand, with the line and what would help."""
    refusal, at = _refusal(error)
    if isinstance(refusal, NotAllowed):
        place = door.place([f"${{{at}}}", at, refusal.expression], first=_file_of(xacro))
        rule = f"{refusal.rule}, or be trusted: trusted=True lets it through"
        raise ScenarioError(f"{place}: {at}", refusal.found, rule) from None
    if refusal:
        raise refusal from None
    said = " ".join(str(error).split()) or type(error).__name__
    rule = "must be xacro that expands"
    if door.left_out:
        lost = " and ".join(f"{name} ({at})" for at, name in door.left_out[:3])
        rule += (
            f", for which it may need what was left out, {lost}: put the file there, or say by"
            " packages={name: folder} where its package is"
        )
    culprits = [part for pair in _CULPRITS.findall(said) for part in pair if part]
    raise ScenarioError(door.place(culprits), said, rule) from None


def _refusal(error: BaseException | None) -> tuple[ScenarioError | NotAllowed | None, str]:
    """Return the refusal among an error and those that it came of, and in which expression.

    That is as it is written; what is evaluated may be made of arguments.
    """
    written = ""
    while error is not None and not isinstance(error, (ScenarioError, NotAllowed)):
        stated = _EVALUATED.search(str(getattr(error, "suffix", "") or ""))
        written = stated[1] if stated else written
        error = error.__context__
    if isinstance(error, NotAllowed):
        return error, written or error.expression or error.found
    return error, written


def _file_of(xacro: Any) -> str:
    """Return the path of the file at work: that of the macro, or the innermost include."""
    macros, files = xacro.macrostack or [], xacro.filestack or []
    files = macros[-1].history[-1] if macros else files
    return os.path.abspath(files[-1]) if files and files[-1] else ""


def _told(doubts: list[Doubt]) -> list[Doubt]:
    """Return each doubt once, and not too many."""
    doubts = list(dict.fromkeys(doubts))
    if len(doubts) > _MOST_DOUBTS:
        path, value, _ = doubts[_MOST_DOUBTS - 1]
        reason = f"is one of {len(doubts) - _MOST_DOUBTS + 1} more places of this kind"
        doubts[_MOST_DOUBTS - 1 :] = [(path, value, reason)]
    return doubts


if __name__ == "__main__":
    serve(prepare)
