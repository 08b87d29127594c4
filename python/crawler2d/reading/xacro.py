"""Xacro files as URDF, expanded by xacro itself in a child process.

A repository often passes its settings to xacro as arguments. If an argument of the model has no
value, the YAML files of its package are searched for it. All settings of a file that has it are
used, as the repository would use them. Only ``name: value`` at the beginning of a line counts.
"""

from __future__ import annotations

import builtins
import difflib
import os
import re
from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from types import MappingProxyType, SimpleNamespace
from typing import Any, NamedTuple, NoReturn

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.reading.expressions import NAMES, NotAllowed, copy_data, evaluate
from crawler2d.reading.files import Files
from crawler2d.reading.log import ReadingWarning
from crawler2d.reading.parsing import ask_child, parse_xml, serve
from crawler2d.reading.xacro_tree import XacroFiles, XacroMacros

__all__ = ["expand_xacro"]

_MOST_FILES = 100
_LARGEST = 64_000  # [bytes]
_MOST_BYTES = 1_000_000
_LINE = re.compile(r"([A-Za-z_]\w*) ?: +(\S.*)")
_QUOTED = re.compile(r"""(["'])([^"'\\]*)\1\s*(?:\s#.*)?""")
_NO_SCALAR = "[]{}&*!|>%@`\"'#,?:"  # first characters of lists, blocks, anchors, comments and so on
_NOTHING = ("null", "Null", "NULL", "~")

# In a message of xacro: names that are unknown, and expressions that cannot be evaluated.
_CULPRITS = re.compile(r"unknown macro name: (\S+)|'([^']{2,})'")

_EVALUATED = re.compile(r"when evaluating expression '(.*)'", re.DOTALL)
# Where a text uses arguments: $(arg name), arg('name'), $(eval name).
_USES = re.compile(r"\$\(arg\s[^)]*|\barg\([^)]*|\$\(eval\s[^<]*")
_MOST_PASSES = 5
_MOST_WARNINGS = 100


class Setting(NamedTuple):
    """A value in a file of settings: path relative to the folder of the model, line, and text."""

    path: str
    line: int
    value: str

    @property
    def file(self) -> str:
        """Its name."""
        return os.path.basename(self.path)


class Arguments(dict[str, str]):
    """Values of arguments by name. Arguments without a value are recorded, and read as 0 for now.

    Parameters
    ----------
    values : mapping of str to str
        The known values.

    Attributes
    ----------
    lacking : dict of str to None
        Arguments without a value, in the order in which they were asked for.

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
        """Record the name."""
        self.lacking[name] = None
        return "0"


class Settings:
    """Settings in the package of a model.

    Parameters
    ----------
    files : Files
        The files of the model.
    """

    def __init__(self, files: Files) -> None:
        self._files = files

    def of(self, lacking: Iterable[str]) -> tuple[dict[str, Setting], list[str]]:
        """Look up arguments that have no value.

        Parameters
        ----------
        lacking : iterable of str
            Their names.

        Returns
        -------
        settings : dict of str to Setting
            All settings of the files that set one of the arguments, except those that differ.
        differing : list of str
            For each argument whose values differ, a text with the values and their positions.
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
        values_of: dict[str, dict[str, Setting]] = {}
        for name, each in (item for table in chosen.values() for item in table.items()):
            values_of.setdefault(name, {}).setdefault(each.value, each)
        agreed = {
            name: next(iter(values.values()))
            for name, values in values_of.items()
            if len(values) == 1 and name not in differing
        }
        return agreed, list(differing.values())

    def have(self, name: str, value: str) -> bool:
        """Whether there is a setting with this name and value."""
        stated = (table[name].value for table in self._tables if name in table)
        return any(_value(each) == _value(value) for each in stated)

    @cached_property
    def _tables(self) -> list[dict[str, Setting]]:
        """Settings at the beginning of lines, by file; unreadable files are skipped."""
        tables, left = [], _MOST_BYTES
        for path in self._files.packages.files((".yaml", ".yml"))[:_MOST_FILES]:
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
    file: str,
    *,
    trusted: bool,
    arguments: Mapping[str, str],
    leave_out: bool,
) -> tuple[bytes, list[ReadingWarning]]:
    """Expand a file.

    Parameters
    ----------
    files : Files
        The files of the model.
    data : bytes
        The content of the file.
    file : str
        Its name.
    trusted : bool
        Whether the user trusts the file. If so, Python evaluates any expression in it.
    arguments : mapping of str to str
        Values of its ``xacro:arg``.
    leave_out : bool
        Whether to leave out missing includes with calls of their macros, and to look up
        arguments without a value in settings.

    Returns
    -------
    text : bytes
        The URDF.
    warnings : list of ReadingWarning
        What was left out or replaced.

    Raises
    ------
    ScenarioError
        If the file does not expand or needs missing files, or if it is not trusted and has
        expressions beyond plain data and known functions.
    ImportError
        If xacrodoc is missing; the message names the extra to install.
    """
    root = parse_xml(data, file)  # refuses entities before anything else reads the file
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        root.refuse("another encoding", "must be UTF-8, which xacro reads")
    question = {
        "text": text,
        "file": file,
        "files": files.parameters,
        "trusted": trusted,
        "arguments": {name: str(value) for name, value in arguments.items()},
        "leave_out": leave_out,
    }
    answer = ask_child(__name__, question, file=file, files=files)
    return answer["text"].encode(), [tuple(warning) for warning in answer["warnings"]]


def prepare() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Import xacrodoc, which includes xacro and needs no ROS, in the child process."""
    module = extra("xacrodoc", "models")
    xacro, substitution = extra("xacro", "models"), extra("xacro.substitution_args", "models")
    own = SimpleNamespace(**vars(xacro), resolve_args=substitution.resolve_args)
    return lambda question: _expand(module, xacro, substitution, own, question)


def _table(path: str, text: str) -> dict[str, Setting]:
    settings: dict[str, Setting] = {}
    for number, line in enumerate(text.split("\n"), 1):
        match = _LINE.fullmatch(line.rstrip())
        value = _scalar(match[2]) if match else None
        if match and value is not None:
            settings[match[1]] = Setting(path, number, value)
    return settings


def _scalar(text: str) -> str | None:
    """Return a plain or quoted scalar without its comment; None for anything else."""
    quoted = _QUOTED.fullmatch(text)
    if quoted:
        return quoted[2]
    scalar = re.split(r"\s#", text, maxsplit=1)[0].strip()
    return None if scalar in _NOTHING or scalar[0] in _NO_SCALAR else scalar


def _expand(
    module: Any, xacro: Any, substitution: Any, own: SimpleNamespace, question: dict[str, Any]
) -> dict[str, Any]:
    """Expand a file repeatedly, until a pass finds no more of the missing settings and macros."""
    text, leave_out, arguments = (question[name] for name in ("text", "leave_out", "arguments"))
    of_model = Files(**question["files"])
    package = Settings(of_model)
    more: dict[str, Setting] = {}
    lacking: dict[str, None] = {}
    macros: dict[str, Any] = {}
    for _ in range(_MOST_PASSES):
        settings = more
        values = Arguments({name: each.value for name, each in settings.items()} | arguments)
        files = XacroFiles(of_model, question["file"], text, leave_out=leave_out)
        calls = XacroMacros(files, leave_out=leave_out, known=macros)
        of_model.warnings.clear()
        builtins.open = files  # type: ignore[assignment]
        files.attach(xacro, substitution, own)
        calls.attach(xacro, own)
        if not question["trusted"]:
            _restrict(xacro, substitution)
        xacro.filestack = xacro.macrostack = None
        urdf, failure = "", None
        try:
            document = module.XacroDoc.from_string(text, subargs=values, resolve_packages=False)
            urdf = document.to_urdf_string()
        except Exception as error:  # any error of an expression, some of them wrapped
            failure = error
        lacking |= values.lacking
        more, differing = package.of(lacking) if leave_out and lacking else ({}, [])
        wanted = {*lacking, *files.defaults} - arguments.keys()
        more = {name: each for name, each in more.items() if name in wanted}
        later = {name: calls.defined[name] for name in calls.unknown & calls.defined.keys()}
        if more == settings and later.keys() <= macros.keys():
            break
        macros = macros | later
    if values.lacking:
        _refuse_arguments(files, values.lacking, differing, more=failure is not None)
    if failure is not None:
        _refuse(failure, files, xacro)
    replaced = _warnings_of(settings, files.defaults, lacking)
    useless = _useless(arguments, files, package)
    warnings = list(dict.fromkeys([*files.warnings, *of_model.warnings, *replaced, *useless]))
    if len(warnings) > _MOST_WARNINGS:
        path, value, _ = warnings[_MOST_WARNINGS - 1]
        reason = f"is one of {len(warnings) - _MOST_WARNINGS + 1} more places of this kind"
        warnings[_MOST_WARNINGS - 1 :] = [(path, value, reason)]
    return {"text": urdf, "warnings": warnings}


def _restrict(xacro: Any, substitution: Any) -> None:
    """Replace both evaluators of xacro by a checked one; block environment and glob patterns."""
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

    def refuse_environment(name: str) -> NoReturn:
        raise NotAllowed(name, "must not use environment variables")

    def refuse_pattern(pattern: str) -> NoReturn:
        raise NotAllowed(pattern, "must include files by name, not by pattern")

    def default(name: str, default: str = "") -> str:
        return default if name not in os.environ else refuse_environment(name)

    xacro._global_symbols = names
    xacro.safe_eval = lambda text, symbols, _=None: evaluate(text, symbols)
    xacro.glob = SimpleNamespace(glob=refuse_pattern)
    substitution._eval = in_eval
    substitution._eval_env = refuse_environment
    substitution._eval_optenv = default


def _fatal(*words: Any) -> NoReturn:
    raise ValueError(" ".join(map(str, words)))


def _tokens(text: str, separators: str = ",; ", skip_empty: bool = True) -> list[str]:
    pieces = re.split(f"[{re.escape(separators)}]", text)
    return [piece for piece in pieces if piece or not skip_empty]


def _refuse_arguments(
    files: XacroFiles, lacking: Iterable[str], differing: list[str], *, more: bool
) -> NoReturn:
    """Refuse a file, naming all arguments that have no value."""
    names = dict.fromkeys([*lacking, *(files.lacking() if more else [])])
    rule = "must have a value for each argument, as a default or in arguments={name: value}"
    if differing:
        rule += f"; files of settings differ: {'; '.join(differing)}"
    raise ScenarioError(files.place([f"$(arg {name})" for name in names]), ", ".join(names), rule)


def _refuse(error: Exception, files: XacroFiles, xacro: Any) -> NoReturn:
    """Refuse a file that does not expand, with the line and a remedy."""
    refusal, at = _refusal(error)
    if isinstance(refusal, NotAllowed):
        place = files.place([f"${{{at}}}", at, refusal.expression], first=_current_file(xacro))
        rule = f"{refusal.rule}, or be trusted: trusted=True allows it"
        raise ScenarioError(f"{place}: {at}", refusal.found, rule) from None
    if refusal:
        raise refusal from None
    said = " ".join(str(error).split()) or type(error).__name__
    rule = "must be xacro that expands"
    if files.left_out:
        lost = " and ".join(f"{name} ({at})" for at, name in files.left_out[:3])
        rule += (
            f", for which it may need what was left out, {lost}: put the file there, or pass the"
            " folder of its package as packages={name: folder}"
        )
    culprits = [part for pair in _CULPRITS.findall(said) for part in pair if part]
    raise ScenarioError(files.place(culprits), said, rule) from None


def _refusal(error: BaseException | None) -> tuple[ScenarioError | NotAllowed | None, str]:
    """Return the refusal in the chain of an error, and its expression as written in the file."""
    written = ""
    while error is not None and not isinstance(error, (ScenarioError, NotAllowed)):
        stated = _EVALUATED.search(str(getattr(error, "suffix", "") or ""))
        written = stated[1] if stated else written
        error = error.__context__
    if isinstance(error, NotAllowed):
        return error, written or error.expression or error.found
    return error, written


def _current_file(xacro: Any) -> str:
    """Return the path of the current file: of the current macro, or else the innermost include."""
    macros, files = xacro.macrostack or [], xacro.filestack or []
    files = macros[-1].history[-1] if macros else files
    return os.path.abspath(files[-1]) if files and files[-1] else ""


def _warnings_of(
    settings: Mapping[str, Setting], defaults: Mapping[str, str], lacking: Iterable[str]
) -> list[ReadingWarning]:
    """Report the settings that were used, with those that replaced a default."""
    warnings: list[ReadingWarning] = []
    for name in lacking:
        if name in settings:
            each = settings[name]
            reason = f"is taken for the argument {name}, which has no default: arguments= sets it"
            warnings.append((f"{each.file}:{each.line}", each.value, reason))
    others: dict[str, list[str]] = {}
    for name, default in defaults.items():
        if name in settings and _value(settings[name].value) != _value(default):
            each = settings[name]
            others.setdefault(each.file, []).append(f"{name}: {each.value} for {default}")
    reason = "is used with all its settings, also instead of defaults"
    return warnings + [(file, ", ".join(values), reason) for file, values in others.items()]


def _useless(
    arguments: Mapping[str, str], files: XacroFiles, package: Settings
) -> Iterator[ReadingWarning]:
    """Report given arguments that are neither used in the model nor those of its settings.

    A repository often passes all of its settings, used or not.
    """
    used = " ".join(use for text in files.texts.values() for use in _USES.findall(text))
    for name, value in arguments.items():
        is_known = name in files.defaults or re.search(rf"(?<!\w){re.escape(name)}(?!\w)", used)
        if not is_known and not package.have(name, value):
            close = difflib.get_close_matches(name, files.defaults, n=1)
            meant = f" (did you mean {close[0]}?)" if close else ""
            reason = f"has no effect: it must be an argument of the model{meant}"
            yield f"arguments[{name}]", f"{name}={value}", reason


def _value(text: str) -> float | str:
    """Return a text as the value that xacro takes it for: 1, 1.0 and True are equal."""
    try:
        return float({"true": "1", "false": "0"}.get(text.lower(), text))
    except ValueError:
        return text


if __name__ == "__main__":
    serve(prepare)
