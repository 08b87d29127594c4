"""What xacro reads, it reads as the model is read; an include that is not there is left out."""

from __future__ import annotations

import errno
import io
import os
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import IO, Any
from xml.dom import minidom
from xml.sax.saxutils import escape

from crawler2d.errors import ScenarioError
from crawler2d.reading.files import Files, is_absent
from crawler2d.reading.telling import Doubt
from crawler2d.reading.xacro_tree import place_of, tree_of_text

__all__ = ["XacroFiles"]

_FIND = re.compile(r"\$\(find(?:-pkg-share)?\s+([^)\s]+)\s*\)")
_FINDS = ("find", "find-pkg-share")
_ARGUMENT = re.compile(r"\$\(arg\s+([^)\s]+)\s*\)")


class XacroFiles:
    """Takes the place of `open`, and of what in xacro finds packages and parses files.

    Parameters
    ----------
    files : Files
        Those of the model.
    file : str
        Name of the model's file.
    text : str
        What it holds.
    leave_out : bool
        Whether includes that are not there are left out, or refused.

    Attributes
    ----------
    texts : dict of str to str
        What was read, by path.
    doubts : list of Doubt
        What was left out and taken, in its order.
    left_out : list of (str, str)
        The includes that were left out: file and line, and what was named.
    defaults : dict of str to str
        Those of arguments.
    """

    def __init__(self, files: Files, file: str, text: str, *, leave_out: bool) -> None:
        self.files = files
        self.leave_out = leave_out
        self.texts = {file: text}
        self.doubts: list[Doubt] = []
        self.left_out: list[tuple[str, str]] = []
        self.defaults: dict[str, str] = {}
        self._include: minidom.Element | None = None  # that is at work
        self._checked: dict[str, bytes] = {}  # of an include, which is there

    def attach(self, xacro: Any, substitution: Any, own: Any) -> None:
        """Take the places in xacro; `own` are those that xacro has of its own."""

        def resolve(text: str, context: Any = None, filename: Any = None) -> Any:
            return own.resolve_args(
                re.sub(r"^\$\(find-pkg-share\s", "$(find ", text), context, filename
            )

        def included(element: minidom.Element, *others: Any) -> None:
            self._include = element
            own.process_include(element, *others)

        xacro.process_include = included
        xacro.get_include_files = lambda spec, symbols: self._there(
            own.get_include_files(spec, symbols)
        )
        xacro.abs_filename_spec = lambda spec: self._absolute(own.abs_filename_spec, spec)
        xacro.parse = self._parse
        substitution.resolve_args = resolve
        substitution._eval_find = self.find

    def __call__(
        self, path: str | os.PathLike[str], mode: str = "r", *_: object, **__: object
    ) -> IO[Any]:
        """Open a file to be read."""
        if mode not in ("r", "rt", "rb"):
            raise PermissionError(errno.EACCES, "must only be read", str(path))
        data = self._read(str(Path(path).absolute()), self.place([Path(path).name]))
        return io.BytesIO(data) if mode == "rb" else io.StringIO(data.decode(), newline=None)

    def find(self, name: str) -> str:
        """Return the folder of a package, or its name as it is: it may not be needed."""
        folder = self.files.package(name)
        if folder is not None:
            return str(folder)
        if self.leave_out:
            return f"$(find {name})"
        rule = (
            f"must have its packages, which are looked for in {self.files.looked}:"
            ' packages={name: folder} says where each is, missing="leave_out" leaves out includes'
            " of others"
        )
        others = _FIND.findall(next(iter(self.texts.values())))
        lost = [each for each in others if self.files.package(each) is None]
        place = self.place([f"{how} {each}" for each in (name, *lost) for how in _FINDS])
        raise ScenarioError(place, ", ".join(dict.fromkeys([*lost, name])), rule)

    def place(self, words: list[str], first: str = "") -> str:
        """Return file and line where one of some words stands first: of a file, or of them all."""
        for path in (first, *self.texts):
            text = self.texts.get(path, "")
            spelled = [each for word in words if word for each in (word, escape(word))]
            found = [text.find(word) for word in spelled if word in text]
            if found:
                return f"{Path(path).name}:{text.count(chr(10), 0, min(found)) + 1}"
        return next(iter(self.texts))

    def lacking(self) -> list[str]:
        """List arguments that some file asks for and none declares."""
        asked = [name for text in self.texts.values() for name in _ARGUMENT.findall(text)]
        return [name for name in dict.fromkeys(asked) if name not in self.defaults]

    def _read(self, name: str, at: str) -> bytes:
        data = self.files.read(name, at=at)
        self.texts[os.path.abspath(name)] = data.decode(errors="replace")
        return data

    def _absolute(self, absolute: Callable[[str], str], spec: str) -> str:
        """Say where a file is that xacro names, also one of a package that was not found."""
        if not spec.removeprefix("file://").startswith(("$(find ", "package://")):
            return absolute(spec)
        return str(self.files.path(spec, at=self.place([Path(spec).name])))

    def _there(self, paths: Iterator[str]) -> Iterator[str]:
        """Give the paths of an include, without those that are left out."""
        assert self._include is not None
        at, optional = place_of(self._include), self._include.getAttribute("optional")
        name = ""
        try:
            for path in paths:
                name = str(Path(path).absolute())
                self._checked[path] = self._read(name, at)
                yield path
        except ScenarioError as error:
            optional_too = optional in ("true", "True", "1")
            if not is_absent(error) or not (self.leave_out or optional_too):
                raise
            if not optional_too:
                # One of a package that is not there has no path. An error may cut names short.
                name = name or str(getattr(error.__cause__, "filename", error.value))
                self.left_out.append((at, name))
                self.doubts.append((at, name, f"is left out: the file {error.rule}"))

    def _parse(self, text: str | None, path: str | None = None) -> minidom.Document:
        """Make the tree of the model's text, or of an include."""
        if text is not None:
            document, doubts = tree_of_text(text, next(iter(self.texts)))
        else:
            assert path is not None
            document, doubts = tree_of_text(self._checked.pop(path), Path(path).name)
        self.doubts += doubts
        for each in document.getElementsByTagName("xacro:arg"):
            self.defaults.setdefault(each.getAttribute("name"), each.getAttribute("default"))
        return document
