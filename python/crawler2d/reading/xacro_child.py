"""Expands a xacro file that its user trusts; runs in a child process."""

from __future__ import annotations

import builtins
import errno
import io
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

from crawler2d.common.extras import extra
from crawler2d.errors import ScenarioError
from crawler2d.reading.files import Files
from crawler2d.reading.limits import serve

_FIND = re.compile(r"\$\(find\s+([^)\s]+)\s*\)")
_LOST = re.compile(r"Package not found: (\S+)")
# What xacro says was unknown to it, or could not be evaluated.
_CULPRITS = re.compile(r"unknown macro name: (\S+)|'([^']{2,})'")
_INCLUDE = re.compile(r"<xacro:include\b[^>]*?/>|<xacro:include\b[^>]*?>\s*</xacro:include>")


def prepare() -> Callable[[dict[str, Any]], dict[str, Any]]:
    """Import xacrodoc, which brings xacro along and needs no ROS."""
    module = extra("xacrodoc", "models")
    return lambda question: _expanded(module, **question)


def _expanded(
    module: Any,
    *,
    text: str,
    file: str,
    files: dict[str, Any],
    arguments: dict[str, str],
    leave_out: bool,
) -> dict[str, Any]:
    module.packages.update_package_cache(files["packages"])
    builtins.open = _Door(Files(**files), file, text)  # type: ignore[assignment]
    left_out: list[str] = []
    if leave_out:
        text = _without_missing(module, text, left_out)
    try:
        document = module.XacroDoc.from_string(text, subargs=arguments, resolve_packages=False)
        return {"text": document.to_urdf_string(), "left_out": left_out}
    except Exception as error:  # xacro raises what its expressions raise, and wraps some of it
        if refusal := _refusal(error):
            raise refusal from None
        said = " ".join(str(error).split()) or type(error).__name__
        if lost := _LOST.search(said):
            names = [name for name in _FIND.findall(text) if not _known(module, name)]
            rule = "must have its packages: packages={name: folder} says where each is"
            if not leave_out:
                rule += ', missing="leave_out" leaves out includes of others'
            value = ", ".join(dict.fromkeys([*names, lost[1]]))
            calls = [f"find {name}" for name in (lost[1], *names)]
            raise ScenarioError(_place(file, text, calls), value, rule) from None
        rule = "must be xacro that expands"
        if left_out:
            rule += ", which may need an include that was left out: packages= says where it is"
        culprits = [part for pair in _CULPRITS.findall(said) for part in pair if part]
        raise ScenarioError(_place(file, text, culprits), said, rule) from None


class _Door:
    """Takes the place of `open`: whatever xacro and its libraries read is read as the model is."""

    def __init__(self, files: Files, file: str, text: str) -> None:
        self.files = files
        self.file = file
        self.text = text

    def __call__(
        self, path: str | os.PathLike[str], mode: str = "r", *_: object, **__: object
    ) -> IO[Any]:
        if mode not in ("r", "rt", "rb"):
            raise PermissionError(errno.EACCES, "must only be read", str(path))
        name = str(Path(path).absolute())
        try:
            data = self.files.read(name, at=_place(self.file, self.text, [Path(path).name]))
        except ScenarioError as error:
            if isinstance(error.__cause__, FileNotFoundError):  # an include may be optional
                raise error.__cause__ from None
            raise
        return io.BytesIO(data) if mode == "rb" else io.StringIO(data.decode(), newline=None)


def _refusal(error: BaseException | None) -> ScenarioError | None:
    """Return the refusal of a file among an error and those that it came of."""
    while error is not None and not isinstance(error, ScenarioError):
        error = error.__context__
    return error


def _place(file: str, text: str, culprits: list[str]) -> str:
    r"""Return file and line where one of some words stands first; without it, what it includes has.

    Examples
    --------
    >>> _place("cart.xacro", "<robot>\n<xacro:wheel/>", ["xacro:wheel"])
    'cart.xacro:2'
    """
    found = [text.find(word) for word in culprits if word in text]
    return f"{file}:{text.count(chr(10), 0, min(found)) + 1}" if found else file


def _without_missing(module: Any, text: str, left_out: list[str]) -> str:
    """Take out the includes of packages that are not there; lines stay what they are."""

    def kept(include: re.Match[str]) -> str:
        for name in _FIND.findall(include[0]):
            if not _known(module, name):
                left_out.append(" ".join(include[0].split()))
                return "\n" * include[0].count("\n")
        return include[0]

    return _INCLUDE.sub(kept, text)


def _known(module: Any, name: str) -> bool:
    try:
        module.packages.get_path(name)
    except Exception:  # whatever a finder raises: it is not found
        return False
    return True


if __name__ == "__main__":
    serve(prepare)
