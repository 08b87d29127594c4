"""Parse untrusted input: XML as elements with lines, and child processes with limits.

Entities, document types and external parts of XML are refused before anything is expanded, as are
files that are too long, too deep or have too many elements. Third-party parsers run in a child
process, so that only this may hang, grow or crash.
"""

from __future__ import annotations

import bisect
import contextlib
import json
import math
import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any, NoReturn
from xml.parsers import expat

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Where
from crawler2d.reading.files import LARGEST_MODEL, Files
from crawler2d.reading.log import ReadingWarning

__all__ = ["Element", "ask_child", "no_more_files", "parse_xml", "real", "serve"]

# [m, kg, ...] Largest figure of a robot; larger efforts or angle limits mean no limit.
_LARGEST = 1e6

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_LONGEST_NUMBER = 60
_MOST_ELEMENTS = 50_000
_DEEPEST = 60

SECONDS = 2
"""[s] Processor time after the imports."""

CLOCK = 4 * SECONDS
"""[s] Elapsed time after the imports, against endless waiting."""

MEGABYTES = 400
"""[MB] Memory in addition to that of the imports."""

# [s] Of the clock, in which the child starts, imports and works; what it may compute is less.
_PATIENCE = 30.0


class Element:
    """An element with its attributes, its children in order, its text and its line.

    Parameters
    ----------
    tag : str
        Its name, with the prefix that the file gives it.
    attributes : dict of str to str
        As in the file.
    parent : Element or None
        The element that contains it.
    where : Where
        File and line of its opening tag.
    """

    __slots__ = ("attributes", "children", "parent", "pieces", "tag", "where")

    def __init__(
        self, tag: str, attributes: dict[str, str], parent: Element | None, where: Where
    ) -> None:
        self.tag = tag
        self.attributes = attributes
        self.parent = parent
        self.where = where
        self.children: list[Element] = []
        self.pieces: list[str] = []

    @property
    def text(self) -> str:
        """Its own text, without the space round it."""
        return "".join(self.pieces).strip()

    @property
    def path(self) -> str:
        """Its path from the root: ``model[absolem]/link[base_link]/pose``."""
        node: Element | None = self
        steps = []
        while node is not None:
            name = node.attributes.get("name", "")[:40]
            steps.append(f"{node.tag[:40]}[{name}]" if name else node.tag[:40])
            node = node.parent
        return "/".join(reversed(steps))

    @property
    def at(self) -> str:
        """Its line and path, for errors."""
        return f"{self.where}: {self.path}"

    def refuse(self, value: object, rule: str, part: str = "") -> NoReturn:
        """Raise an error: this element, or one of its attributes, breaks a rule."""
        raise ScenarioError(f"{self.at}{part}", value, rule)

    def all(self, tag: str) -> Iterator[Element]:
        """Yield the children with a name."""
        return (child for child in self.children if child.tag == tag)

    def within(self) -> Iterator[Element]:
        """Yield itself and everything in it, in the order of the file."""
        waiting = [self]
        while waiting:
            element = waiting.pop()
            yield element
            waiting.extend(reversed(element.children))

    def only(self, path: str) -> Element | None:
        """Return the one child at a path; None if there is none. Two are refused."""
        node = self
        for tag in path.split("/"):
            children = list(node.all(tag))
            if not children:
                return None
            if len(children) > 1:
                children[1].refuse(f"{len(children)} of them", "must be given once")
            node = children[0]
        return node

    def first(self, tag: str, warnings: list[ReadingWarning]) -> Element | None:
        """Return the first child of a name, as simulators do; warn of others."""
        children = list(self.all(tag))
        warnings += [(other.at, tag, "is left out: the first one counts") for other in children[1:]]
        return children[0] if children else None

    def needed(self, path: str) -> Element:
        """Return the one child at a path, which must exist."""
        element = self.only(path)
        if element is None:
            self.refuse("none", f"must have an element <{path}>")
        return element

    def attribute(self, name: str) -> str:
        """Return an attribute, which must exist and not be empty."""
        text = self.attributes.get(name, "").strip()
        if not text:
            self.refuse("none", f"must have an attribute {name}")
        return text

    def reals(self, count: int, attribute: str | None = None) -> list[float]:
        """Return a given number of numbers, from its text or an attribute."""
        text = self.text if attribute is None else self.attributes.get(attribute, "")
        words = text.split() if len(text) <= _LONGEST_NUMBER * (count + 1) else []
        part = "" if attribute is None else f"@{attribute}"
        if len(words) != count:
            rule = "must be a number" if count == 1 else f"must be {count} numbers"
            self.refuse(text, rule, part)
        return [real(self, word, part) for word in words]

    def real(self, path: str, usual: float | None = None) -> float:
        """Return the number in a child; `usual` if it is missing and optional."""
        element = self.only(path)
        if element is None and usual is not None:
            return usual
        return self.needed(path).reals(1)[0]


def real(element: Element, word: str, part: str = "", *, unlimited: bool = False) -> float:
    """Read a number. One beyond a million is refused, or infinite where that is allowed."""
    text = word.strip()
    if unlimited and text.lower().lstrip("+-") in ("inf", "infinity"):
        return -math.inf if text.startswith("-") else math.inf
    if len(text) > _LONGEST_NUMBER or not _NUMBER.fullmatch(text):
        element.refuse(word, "must be a finite number", part)
    number = float(text)
    if abs(number) > _LARGEST:
        if not unlimited:
            element.refuse(word, f"must be at most {_LARGEST:g} in magnitude", part)
        return math.copysign(math.inf, number)
    return number


def parse_xml(data: bytes, file: str) -> Element:
    r"""Parse the bytes of a file.

    Parameters
    ----------
    data : bytes
        Content, in an encoding known to XML.
    file : str
        Its name, for the lines.

    Returns
    -------
    Element
        The root.

    Raises
    ------
    ScenarioError
        If it is not XML, has a document type or entities, or is larger than a robot needs.

    Examples
    --------
    >>> root = parse_xml(b"<robot name='cart'>\n  <link name='hull'/>\n</robot>", "cart.urdf")
    >>> print(root.children[0].where)
    cart.urdf:2
    >>> parse_xml(b"<!DOCTYPE a [<!ENTITY b 'c'>]><a>&b;</a>", "bomb.sdf")
    Traceback (most recent call last):
    ...
    crawler2d.errors.ScenarioError: bomb.sdf:1 must have no document type, got 'a'
    """
    if len(data) > LARGEST_MODEL:
        raise ScenarioError(file, len(data), f"must have at most {LARGEST_MODEL} bytes")
    parser = expat.ParserCreate()
    parser.buffer_text = True
    # A stray carriage return ends a line for expat, but not for most editors.
    ends = [match.start() for match in re.finditer(rb"\n", data)]
    count = 0
    roots: list[Element] = []
    stack: list[Element] = []

    def line_of(offset: int) -> Where:
        return Where(file, bisect.bisect_left(ends, offset) + 1)

    def refuse(value: object, rule: str) -> NoReturn:
        raise ScenarioError(str(line_of(parser.CurrentByteIndex)), value, rule)

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        if count > _MOST_ELEMENTS:
            refuse(count, f"must have at most {_MOST_ELEMENTS} elements")
        if len(stack) >= _DEEPEST:
            refuse(len(stack) + 1, f"must be nested at most {_DEEPEST} deep")
        parent = stack[-1] if stack else None
        element = Element(tag, attributes, parent, line_of(parser.CurrentByteIndex))
        (parent.children if parent else roots).append(element)
        stack.append(element)

    def characters(text: str) -> None:
        stack[-1].pieces.append(text)

    def doctype(name: str, *_: object) -> None:
        refuse(repr(name), "must have no document type")

    parser.StartElementHandler = start
    parser.EndElementHandler = lambda _: stack.pop()
    parser.CharacterDataHandler = characters
    parser.StartDoctypeDeclHandler = doctype
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.ErrorString(error.code)
        where = line_of(parser.ErrorByteIndex)
        raise ScenarioError(str(where), reason, "must be well-formed XML") from None
    except ScenarioError:  # also a ValueError
        raise
    except (ValueError, LookupError) as error:  # an encoding that Python lacks or cannot map
        raise ScenarioError(file, str(error), "must be in a known encoding") from None
    return roots[0]  # expat raises if there is none


def serve(prepare: Callable[[], Callable[[dict[str, Any]], dict[str, Any]]]) -> None:
    """Answer the question on standard input, within limits.

    Parameters
    ----------
    prepare : callable
        Imports modules and returns the answering function; runs before the limits apply.
    """
    out, sys.stdout = sys.stdout, sys.stderr  # output of libraries is not the answer
    try:
        work = prepare()
        _limit()
        answer = work(json.loads(sys.stdin.read()))
    except ImportError as error:
        answer = {"missing": str(error)}
    except ScenarioError as error:
        answer = {"path": error.path, "value": error.value, "rule": error.rule}
    out.write(json.dumps(answer))
    out.flush()


@contextlib.contextmanager
def no_more_files() -> Iterator[None]:
    """Prevent opening any file, if the system has such a limit."""
    try:
        import resource  # noqa: PLC0415 - not on Windows
    except ImportError:
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (0, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def ask_child(program: str, question: dict[str, Any], *, file: str, files: Files) -> dict[str, Any]:
    """Run a program of this folder in its own process, and return its plain data.

    Parameters
    ----------
    program : str
        Dotted name of the module, which ends with `serve`.
    question : dict
        Plain data that JSON can represent.
    file : str
        The subject of errors.
    files : Files
        The files of the model; the program runs in their folder.

    Raises
    ------
    ScenarioError
        With path, value and rule from the program, or if it exceeded its limits or failed.
    ImportError
        If the library that the program needs is missing.
    """
    try:
        # Nothing in the folder of the model is imported: -P keeps it off the path.
        done = subprocess.run(
            [sys.executable, "-P", "-m", program],
            input=json.dumps(question).encode(),
            capture_output=True,
            cwd=files.folder,
            timeout=_PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        rule = f"must be parsed within {_PATIENCE:g} s"
        raise ScenarioError(file, "no answer", rule) from None
    try:
        answer: dict[str, Any] = json.loads(done.stdout)
    except ValueError:
        errors = done.stderr.decode(errors="replace").strip().splitlines()
        said = errors[-1] if errors else f"an end by {_exit_name(done.returncode)}"
        if done.returncode > 0 and "MemoryError" not in said:
            rule = f"must be parsed by {program}, which failed"
        else:
            rule = (
                f"must be parsed in {SECONDS} s of computing, {CLOCK} s of the clock and"
                f" {MEGABYTES} MB of memory"
            )
        raise ScenarioError(file, said.removeprefix(f"{sys.executable}: "), rule) from None
    if "missing" in answer:
        raise ImportError(answer["missing"])
    if "rule" in answer:
        raise ScenarioError(answer["path"], answer["value"], answer["rule"])
    return answer


def _limit() -> None:
    """Set the limits supported by the system."""
    with contextlib.suppress(ImportError):
        import resource  # noqa: PLC0415 - not on Windows, where only the patience of the parent holds

        # Their signals end the process. The limit is in whole seconds, but code running here cannot
        # undo it.
        signal.setitimer(signal.ITIMER_PROF, SECONDS)
        signal.setitimer(signal.ITIMER_REAL, CLOCK)
        used = resource.getrusage(resource.RUSAGE_SELF)
        seconds = int(used.ru_utime + used.ru_stime) + 1 + SECONDS
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        with contextlib.suppress(OSError, ValueError):
            with open("/proc/self/statm", encoding="ascii") as file:
                pages = int(file.read().split()[0])
            most = pages * os.sysconf("SC_PAGE_SIZE") + 1_000_000 * MEGABYTES
            resource.setrlimit(resource.RLIMIT_AS, (most, most))


def _exit_name(status: int) -> str:
    """Name the exit of a process; those that run out of time end by a signal."""
    if status >= 0:
        return f"status {status}"
    try:
        return signal.Signals(-status).name
    except ValueError:
        return f"signal {-status}"
