"""A xacro file as the DOM that xacro works on, without missing includes and unknown macros."""

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
from crawler2d.reading.log import ReadingWarning
from crawler2d.reading.parsing import parse_xml

__all__ = ["XacroFiles", "XacroMacros"]

# Elements that xacro accepted without its prefix until 2016, if they have these attributes.
_OLD = {
    "arg": {"name", "default"},
    "if": {"value"},
    "include": {"filename"},
    "insert_block": {"name"},
    "macro": {"name"},
    "property": {"name"},
    "unless": {"value"},
}

OWN_OF_URDF = frozenset(
    (
        *("robot", "link", "joint", "transmission", "gazebo", "material", "sensor", "plugin"),
        *("inertial", "visual", "collision", "origin", "mass", "inertia", "geometry"),
        *("box", "cylinder", "sphere", "capsule", "mesh", "color", "texture", "contact", "group"),
        *("parent", "child", "axis", "limit", "dynamics", "calibration", "mimic", "type"),
        *("safety_controller", "actuator", "hardwareInterface", "mechanicalReduction"),
    )
)
"""Elements of URDF, which without a prefix never call a macro."""

_PLACE = "place"
_FIND = re.compile(r"\$\(find(?:-pkg-share)?\s+([^)\s]+)\s*\)")
_FINDS = ("find", "find-pkg-share")
_ARGUMENT = re.compile(r"\$\(arg\s+([^)\s]+)\s*\)")


class XacroFiles:
    """Replaces `open`, and xacro's functions that find packages and parse files.

    Parameters
    ----------
    files : Files
        The files of the model.
    file : str
        Name of the model's file.
    text : str
        Its content.
    leave_out : bool
        Whether to leave out missing includes instead of refusing the file.

    Attributes
    ----------
    texts : dict of str to str
        Texts of the files that were read, by path.
    warnings : list of ReadingWarning
        What was left out or replaced.
    left_out : list of (str, str)
        The includes that were left out: position (file and line), and name.
    defaults : dict of str to str
        The defaults of arguments.
    """

    def __init__(self, files: Files, file: str, text: str, *, leave_out: bool) -> None:
        self.files = files
        self.leave_out = leave_out
        self.texts = {file: text}
        self.warnings: list[ReadingWarning] = []
        self.left_out: list[tuple[str, str]] = []
        self.defaults: dict[str, str] = {}
        self._include: minidom.Element | None = None  # the current one
        self._includes: dict[str, bytes] = {}  # their contents, before they are parsed

    def attach(self, xacro: Any, substitution: Any, own: Any) -> None:
        """Replace functions of xacro; `own` holds the original ones."""

        def resolve(text: str, context: Any = None, filename: Any = None) -> Any:
            text = re.sub(r"^\$\(find-pkg-share\s", "$(find ", text)
            return own.resolve_args(text, context, filename)

        def included(element: minidom.Element, *others: Any) -> None:
            self._include = element
            own.process_include(element, *others)

        xacro.process_include = included
        xacro.get_include_files = lambda spec, symbols: self._existing(
            own.get_include_files(spec, symbols)
        )
        xacro.abs_filename_spec = lambda spec: self._absolute(own.abs_filename_spec, spec)
        xacro.parse = self._parse
        substitution.resolve_args = resolve
        substitution._eval_find = self.find

    def __call__(
        self, path: str | os.PathLike[str], mode: str = "r", *_: object, **__: object
    ) -> IO[Any]:
        """Open a file for reading."""
        if mode not in ("r", "rt", "rb"):
            raise PermissionError(errno.EACCES, "must only be read", str(path))
        data = self._read(str(Path(path).absolute()), self.place([Path(path).name]))
        return io.BytesIO(data) if mode == "rb" else io.StringIO(data.decode(), newline=None)

    def find(self, name: str) -> str:
        """Return the folder of a package, or the unexpanded call, whose value may not be needed."""
        folder = self.files.packages.find(name)
        if folder is not None:
            return str(folder)
        if self.leave_out:
            return f"$(find {name})"
        rule = (
            f"must have its packages, which are looked for in {self.files.packages.looked}:"
            ' packages={name: folder} gives their folders, missing="leave_out" leaves out includes'
            " of others"
        )
        others = _FIND.findall(next(iter(self.texts.values())))
        lost = [each for each in others if self.files.packages.find(each) is None]
        place = self.place([f"{how} {each}" for each in (name, *lost) for how in _FINDS])
        raise ScenarioError(place, ", ".join(dict.fromkeys([*lost, name])), rule)

    def place(self, words: list[str], first: str = "") -> str:
        """Return file and line where any of some words first occurs, in one file or in all."""
        for path in (first, *self.texts):
            text = self.texts.get(path, "")
            spelled = [each for word in words if word for each in (word, escape(word))]
            starts = [text.find(word) for word in spelled if word in text]
            if starts:
                return f"{Path(path).name}:{text.count(chr(10), 0, min(starts)) + 1}"
        return next(iter(self.texts))

    def lacking(self) -> list[str]:
        """List arguments that are used, but declared in no file."""
        asked = [name for text in self.texts.values() for name in _ARGUMENT.findall(text)]
        return [name for name in dict.fromkeys(asked) if name not in self.defaults]

    def _read(self, name: str, at: str) -> bytes:
        data = self.files.read(name, at=at)
        self.texts[os.path.abspath(name)] = data.decode(errors="replace")
        return data

    def _absolute(self, absolute: Callable[[str], str], spec: str) -> str:
        """Return the path of a file that xacro names, even if its package was not found."""
        if not spec.removeprefix("file://").startswith(("$(find ", "package://")):
            return absolute(spec)
        return str(self.files.path(spec, at=self.place([Path(spec).name])))

    def _existing(self, paths: Iterator[str]) -> Iterator[str]:
        """Yield the paths of an include, except those that are left out."""
        assert self._include is not None
        at = _place_of(self._include)
        is_optional = self._include.getAttribute("optional") in ("true", "True", "1")
        name = ""
        try:
            for path in paths:
                name = str(Path(path).absolute())
                self._includes[path] = self._read(name, at)
                yield path
        except ScenarioError as error:
            if not is_absent(error) or not (self.leave_out or is_optional):
                raise
            if not is_optional:
                # In a missing package it has no path. The value in an error may be shortened.
                name = name or str(getattr(error.__cause__, "filename", error.value))
                self.left_out.append((at, name))
                self.warnings.append((at, name, f"is left out: the file {error.rule}"))

    def _parse(self, text: str | None, path: str | None = None) -> minidom.Document:
        """Return the document of the model's text, or of an include."""
        if text is not None:
            document, warnings = _dom_of(text, next(iter(self.texts)))
        else:
            assert path is not None
            document, warnings = _dom_of(self._includes.pop(path), Path(path).name)
        self.warnings += warnings
        for each in document.getElementsByTagName("xacro:arg"):
            self.defaults.setdefault(each.getAttribute("name"), each.getAttribute("default"))
        return document


class XacroMacros:
    """Replaces xacro's functions that define and call macros.

    Old xacro allowed macros to be called before their definition. A file with such a call is
    expanded a second time, with the macros of the first pass as `known`.

    Parameters
    ----------
    files : XacroFiles
        The files, with their warnings.
    leave_out : bool
        Whether to leave out calls of unknown macros instead of refusing the file.
    known : mapping of str to Any
        Macros that are known before the file is read.

    Attributes
    ----------
    defined : dict of str to Any
        Macros of the file and its includes, except those in namespaces.
    unknown : set of str
        Macros that were called, but not known.
    """

    def __init__(self, files: XacroFiles, *, leave_out: bool, known: dict[str, Any]) -> None:
        self.files = files
        self.leave_out = leave_out
        self.known = known
        self.defined: dict[str, Any] = {}
        self.unknown: set[str] = set()

    def attach(self, xacro: Any, own: Any) -> None:
        """Replace functions of xacro; `own` holds the original ones."""
        define, call = own.grab_macro, own.handle_macro_call

        def defined(element: minidom.Element, macros: Any) -> None:
            name = element.getAttribute("name").removeprefix("xacro:")
            define(element, macros)
            self.defined[name] = macros[name]

        def resolve(name: str, macros: Any, symbols: Any) -> Any:
            try:
                macro = own.resolve_macro(name, macros, symbols)[2]
            except (KeyError, TypeError):  # not a macro, or not a namespace
                return None
            return macro if isinstance(macro, own.Macro) else None

        def called(node: minidom.Element, macros: Any, symbols: Any) -> Any:
            name = node.tagName.removeprefix("xacro:")
            prefixed = name != node.tagName
            if node.tagName == "xacro:call" or (not prefixed and name in OWN_OF_URDF):
                return call(node, macros, symbols)
            macro = resolve(name, macros, symbols)
            if macro is None and name in self.known:
                macro = macros[name] = self.known[name]
                self.note(node, "is a macro that is defined later, which old xacro allowed")
            if not prefixed and macro not in xacro.macrostack and self.fits(node, macro):
                self.note(node, "is taken as a call of the macro, which old xacro allowed")
                node.tagName = node.nodeName = f"xacro:{name}"
            elif prefixed and macro is None and self.leave_out:
                self.unknown.add(name)
                lost = " and ".join(at for at, _ in self.files.left_out[:3])
                why = f"; what is included at {lost} was left out, too" if lost else ""
                self.note(node, f"is left out with its content: no file defines this macro{why}")
                own.replace_node(node, by=None)
                return True
            return call(node, macros, symbols)

        xacro.grab_macro, xacro.handle_macro_call = defined, called

    def note(self, node: minidom.Element, reason: str) -> None:
        """Add a warning about a call."""
        self.files.warnings.append((_place_of(node), f"<{node.tagName}>", reason))

    def fits(self, node: minidom.Element, macro: Any) -> bool:
        """Whether attributes and children of an element without prefix fit the macro."""
        if macro is None:
            return False
        given = set(node.attributes.keys())
        wanted = {name for name in macro.params if not name.startswith("*")}
        inside = [each for each in node.childNodes if each.nodeType == each.ELEMENT_NODE]
        return (
            given <= wanted
            and wanted - given <= macro.defaultmap.keys()
            and len(inside) == len(macro.params) - len(wanted)
        )


def _place_of(node: minidom.Element) -> str:
    """Return file and line of an element; a copy has those of its original."""
    place: str = node.getUserData(_PLACE) or ""
    return place


def _dom_of(data: str | bytes, file: str) -> tuple[minidom.Document, list[ReadingWarning]]:
    """Return the document of a file, and a warning if it has elements of old xacro.

    Each element knows its line, see `_place_of`.

    Raises
    ------
    ScenarioError
        If the file is not XML, has a document type or entities, or is too large.
    """
    root = parse_xml(data.encode() if isinstance(data, str) else data, file)
    document = minidom.parseString(data)
    old: list[str] = []
    nodes = document.getElementsByTagName("*")
    for node, element in zip(nodes, root.within(), strict=True):
        node.setUserData(_PLACE, str(element.where), _COPIED)
        if _is_old(node):
            old.append(f"{element.where} <{node.tagName}>")
            node.tagName = node.nodeName = f"xacro:{node.tagName}"
    if not old:
        return document, []
    place, _, name = old[0].rpartition(" ")
    others = f", and so are {len(old) - 1} more elements of the file" if len(old) > 1 else ""
    return document, [(place, name, f"is read as an element of xacro without its prefix{others}")]


def _is_old(node: minidom.Element) -> bool:
    """Whether an element is one of xacro without the prefix, and not inside a plugin."""
    wanted = _OLD.get(node.tagName)
    if wanted is None or not wanted <= set(node.attributes.keys()):
        return False
    filled = any(each.nodeType == each.ELEMENT_NODE for each in node.childNodes)
    can_be_empty = node.tagName != "macro" and (
        node.tagName != "property" or node.hasAttribute("value")
    )
    if not filled and not can_be_empty:
        return False
    outer: Any = node.parentNode
    while outer is not None and outer.nodeName != "plugin":
        outer = outer.parentNode
    return outer is None


class _Copied:
    """Gives a copy of an element the line of the original."""

    def handle(self, _operation: int, key: str, data: Any, _source: Any, copy: Any) -> None:
        copy.setUserData(key, data, self)


_COPIED = _Copied()
