"""Keys to public trees of models: what a reader should find in each main file, with file and line.

They were written by hand from the files, not by the reader, which they are meant to judge.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from tests.robots.robot_files import evaluated

TREES = Path(__file__).parent / "trees"

_CITATION = re.compile(r"(?:(?P<file>[\w./]+):)?(?P<line>\d+): (?P<text>.+)")
_NUMBER = re.compile(r"(?<![\w.])\d+\.?\d*(?:e[-+]?\d+)?(?![\w.]\d)")


@dataclass(frozen=True)
class Citation:
    """A text and its line in a file."""

    path: Path
    line: int
    text: str

    @property
    def there(self) -> str:
        """The line of the file, or nothing if the file is shorter."""
        lines = self.path.read_bytes().decode().split("\n")
        return lines[self.line - 1] if self.line <= len(lines) else ""

    @property
    def numbers(self) -> set[float]:
        """Numbers in the text, without their signs."""
        return {float(number) for number in _NUMBER.findall(self.text)}


@dataclass(frozen=True)
class Key:
    """The contents of a main file.

    Attributes
    ----------
    name : str
        Of the key.
    folder, file : Path
        The copy of the repository, and the main file in it.
    data : dict
        The key as it is written; the README of the trees says what its entries are.
    """

    name: str
    folder: Path
    file: Path
    data: dict[str, Any]

    @property
    def figures(self) -> dict[str, Any]:
        """Values by name; values that the files do not have are under `unknown`."""
        return {name: entry["value"] for name, entry in self.data["figures"].items()}

    @property
    def unknown(self) -> dict[str, str]:
        """Reasons why a figure cannot be known, by its name."""
        reasons: dict[str, str] = self.data["unknown"]
        return reasons

    @property
    def packages(self) -> dict[str, Path]:
        """Folders of the packages that the main file names and that are among the files."""
        named = self.data.get("needs", {}).get("packages", {})
        return {name: self.folder / inside for name, inside in named.items()}

    @property
    def arguments(self) -> dict[str, str]:
        """Arguments for expanding the main file, from settings of its repository."""
        found: dict[str, str] = {}
        for name in self.data.get("needs", {}).get("arguments_from", []):
            text = (self.folder / name).read_text(encoding="utf-8")
            found |= dict(re.findall(r"^(\w+): *([^#\s]+)", text, re.MULTILINE))
        return found

    @property
    def given(self) -> dict[str, float]:
        """Values of the names in expressions, in order."""
        known: dict[str, float] = {}
        for name, entry in self.data.get("given", {}).items():
            known[name] = evaluated("${" + entry["how"] + "}", known)
        return known

    @property
    def links(self) -> list[tuple[float, float, float]]:
        """Mass [kg], x and z [m] of the centre, of each link with a mass."""
        known = self.given

        def value(text: str) -> float:
            return evaluated("${" + text + "}", known)

        rows = self.data.get("links", [])
        return [(value(row["mass"]), value(row["x"]), value(row["z"])) for row in rows]

    def citations(self, entry: dict[str, Any]) -> list[Citation]:
        """Citations of an entry: name of the file, if it is not the main one, line and text."""
        found = []
        for at in entry.get("at", []):
            parts = _CITATION.fullmatch(at)
            assert parts is not None, at
            path = self.file if parts["file"] is None else self._only(parts["file"])
            found.append(Citation(path, int(parts["line"]), parts["text"]))
        return found

    def entries(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """Everything that cites, with a name for it."""
        for group in ("given", "figures"):
            for name, entry in self.data.get(group, {}).items():
                yield f"{group}.{name}", entry
        for link in self.data.get("links", []):
            yield f"link {link['link']}", link
        for hazard in self.data["hazards"]:
            yield hazard["what"], hazard

    def _only(self, name: str) -> Path:
        (path,) = (each for each in self.folder.rglob(Path(name).name) if each.match(name))
        return path


@cache
def keys() -> dict[str, Key]:
    """All keys by name."""
    found = {}
    for path in sorted((TREES / "keys").glob("*.toml")):
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        folder = TREES / data["repository"]
        found[path.stem] = Key(path.stem, folder, folder / data["file"], data)
    return found


def expressions(entry: dict[str, Any]) -> Iterator[str]:
    """Return every expression of an entry: of a value, of several, or of a link."""
    yield from flat(entry.get("how", []))
    for part in ("mass", "x", "z"):
        if part in entry:
            yield entry[part]


def flat(value: Any) -> list[Any]:
    """Return the items of nested lists, in order."""
    return [each for part in value for each in flat(part)] if isinstance(value, list) else [value]


def decimals(expression: str) -> set[float]:
    """Return the numbers of an expression with a point or an exponent."""
    return {float(word) for word in _NUMBER.findall(expression) if "." in word or "e" in word}
