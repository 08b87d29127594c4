"""Expands a xacro file; runs in a child process."""

from __future__ import annotations

import builtins
import errno
import io
import os
import re
from collections import ChainMap
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType, SimpleNamespace
from typing import IO, Any, NoReturn
from xml.sax.saxutils import escape

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.reading.expressions import NAMES, NotAllowed, evaluated, plain_copy
from crawler2d.reading.files import Files
from crawler2d.reading.limits import serve

_FIND = re.compile(r"\$\(find(?:-pkg-share)?\s+([^)\s]+)\s*\)")
# What xacro says was unknown to it, or could not be evaluated.
_CULPRITS = re.compile(r"unknown macro name: (\S+)|'([^']{2,})'")
_EVALUATED = re.compile(r"when evaluating expression '(.*)'", re.DOTALL)
_INCLUDE = re.compile(r"<xacro:include\b[^>]*?/>|<xacro:include\b[^>]*?>\s*</xacro:include>")


def prepare() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Import xacrodoc, which brings xacro along and needs no ROS."""
    module = extra("xacrodoc", "models")
    xacro, arguments = extra("xacro", "models"), extra("xacro.substitution_args", "models")
    return lambda question: _expanded(module, xacro, arguments, **question)


def _expanded(
    module: Any,
    xacro: Any,
    substitution: Any,
    *,
    text: str,
    file: str,
    files: dict[str, Any],
    trusted: bool,
    arguments: dict[str, str],
    leave_out: bool,
) -> dict[str, Any]:
    door = _Door(Files(**files), file, text, leave_out=leave_out)
    builtins.open = door  # type: ignore[assignment]
    _find_by(door, substitution)
    if not trusted:
        _check(xacro, substitution)
    left_out: list[str] = []
    if leave_out:
        text = _without_missing(door.files, text, left_out)
    try:
        document = module.XacroDoc.from_string(text, subargs=arguments, resolve_packages=False)
        return {"text": document.to_urdf_string(), "left_out": left_out}
    except Exception as error:  # xacro raises what its expressions raise, and wraps some of it
        refusal, at = _refusal(error)
        if isinstance(refusal, NotAllowed):
            place = door.place([f"${{{at}}}", at, refusal.expression], first=_file_of(xacro))
            rule = f"{refusal.rule}, or be trusted: trusted=True lets it through"
            raise ScenarioError(f"{place}: {at}", refusal.found, rule) from None
        if refusal:
            raise refusal from None
        said = " ".join(str(error).split()) or type(error).__name__
        rule = "must be xacro that expands"
        if left_out:
            rule += ", which may need an include that was left out: packages= says where it is"
        culprits = [part for pair in _CULPRITS.findall(said) for part in pair if part]
        raise ScenarioError(door.place(culprits), said, rule) from None


class _Door:
    """Takes the place of `open`: whatever xacro and its libraries read is read as the model is."""

    def __init__(self, files: Files, file: str, text: str, *, leave_out: bool) -> None:
        self.files = files
        self.texts = {file: text}  # of the model, and of what it includes by their paths
        self.leave_out = leave_out

    def __call__(
        self, path: str | os.PathLike[str], mode: str = "r", *_: object, **__: object
    ) -> IO[Any]:
        if mode not in ("r", "rt", "rb"):
            raise PermissionError(errno.EACCES, "must only be read", str(path))
        name = str(Path(path).absolute())
        try:
            data = self.files.read(name, at=self.place([Path(path).name]))
        except ScenarioError as error:
            if isinstance(error.__cause__, FileNotFoundError):  # an include may be optional
                raise error.__cause__ from None
            raise
        self.texts[name] = data.decode(errors="replace")
        return io.BytesIO(data) if mode == "rb" else io.StringIO(data.decode(), newline=None)

    def place(self, words: list[str], first: str = "") -> str:
        """Return file and line where one of some words stands first: of a file, or of them all."""
        for path in (first, *self.texts):
            text = self.texts.get(path, "")
            spelled = [each for word in words if word for each in (word, escape(word))]
            found = [text.find(word) for word in spelled if word in text]
            if found:
                return f"{Path(path).name}:{text.count(chr(10), 0, min(found)) + 1}"
        return next(iter(self.texts))

    def find(self, name: str) -> str:
        """Return the folder of a package."""
        folder = self.files.package(name)
        if folder is not None:
            return str(folder)
        rule = (
            f"must have its packages, which are looked for in {self.files.looked}:"
            " packages={name: folder} says where each is"
        )
        if not self.leave_out:
            rule += ', missing="leave_out" leaves out includes of others'
        others = _FIND.findall(next(iter(self.texts.values())))
        lost = [each for each in others if self.files.package(each) is None]
        place = self.place([f"{how} {each}" for each in (name, *lost) for how in _FINDS])
        raise ScenarioError(place, ", ".join(dict.fromkeys([*lost, name])), rule)


_FINDS = ("find", "find-pkg-share")


def _find_by(door: _Door, substitution: Any) -> None:
    """Let xacro find packages as all the rest does, also by the word of ROS 2's launch files."""
    resolved = substitution.resolve_args

    def resolve(text: str, context: Any = None, filename: Any = None) -> Any:
        return resolved(re.sub(r"^\$\(find-pkg-share\s", "$(find ", text), context, filename)

    substitution.resolve_args = resolve
    substitution._eval_find = door.find


def _check(xacro: Any, substitution: Any) -> None:
    """Put a checked evaluation in the place of both that xacro has; keep it from looking round."""
    load, context = xacro.load_yaml, xacro.substitution_args_context
    own: dict[str, Callable[..., Any]] = {
        "load_yaml": lambda name: plain_copy(load(name)),
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
        return str(evaluated(text, ChainMap({"true": True, "false": False, **values}, names)))

    def default(name: str, default: str = "") -> str:
        return default if name not in os.environ else _refuse_environment(name)

    xacro._global_symbols = names
    xacro.safe_eval = lambda text, symbols, _=None: evaluated(text, symbols)
    xacro.glob = SimpleNamespace(glob=_refuse_pattern)
    substitution._eval = in_eval
    substitution._eval_env = _refuse_environment
    substitution._eval_optenv = default


def _refuse_environment(name: str) -> NoReturn:
    raise NotAllowed(name, "must ask for no environment variable")


def _refuse_pattern(pattern: str) -> NoReturn:
    raise NotAllowed(pattern, "must include files by their names")


def _fatal(*words: Any) -> NoReturn:
    raise ValueError(" ".join(map(str, words)))


def _tokens(text: str, separators: str = ",; ", skip_empty: bool = True) -> list[str]:
    pieces = re.split(f"[{re.escape(separators)}]", text)
    return [piece for piece in pieces if piece or not skip_empty]


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


def _without_missing(files: Files, text: str, left_out: list[str]) -> str:
    """Take out the includes of packages that are not there; lines stay what they are."""

    def kept(include: re.Match[str]) -> str:
        for name in _FIND.findall(include[0]):
            if files.package(name) is None:
                left_out.append(" ".join(include[0].split()))
                return "\n" * include[0].count("\n")
        return include[0]

    return _INCLUDE.sub(kept, text)


if __name__ == "__main__":
    serve(prepare)
