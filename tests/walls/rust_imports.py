"""Imports between the files of a crate, without unit tests."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from tests.walls.rooms import Import

Module = tuple[str, ...]

_NO_CODE = re.compile(
    r"""//[^\n]* | /\*.*?\*/ | b?r(\#*)".*?"\1 | b?"(?:\\.|[^"\\])*" | b?'(?:\\.[^']*|[^'\\])'""",
    re.DOTALL | re.VERBOSE,
)
_VISIBLE_IN = re.compile(r"\(in [^)]*\)")
_OF_TESTS = r"#\[cfg\((?:test|any\(test, fuzzing\))\)\]"
_TEST = re.compile(_OF_TESTS)
_TEST_MODULE = re.compile(_OF_TESTS + r"\s*(?:pub(?:\(crate\))?\s+)?mod\s+(\w+)\s*;")
_USE = re.compile(r"\buse\s+([^;]+);")
_HANDED_ON = re.compile(r"\bpub(?:\([^)]*\))?\s+use\s+([^;]+);")
_PATH = re.compile(r"\b((?:crate|super|self)(?:\s*::\s*\w+)+)")


def rust_files(folder: Path) -> dict[str, Module]:
    """Map the paths of the files of a crate to its modules, without unit tests."""
    found = {}
    for path in sorted(folder.rglob("*.rs")):
        file = path.relative_to(folder)
        *parents, last = file.with_suffix("").parts
        if "tests" not in (*parents, last):
            found[file.as_posix()] = tuple(parents if last in ("lib", "mod") else [*parents, last])
    tests = {
        (*module, name)
        for file, module in found.items()
        for name in _TEST_MODULE.findall((folder / file).read_text(encoding="utf-8"))
    }
    return {
        file: module
        for file, module in found.items()
        if not any(module[: len(test)] == test for test in tests)
    }


def rust_imports(folder: Path) -> list[Import]:
    """List the imports between the files of a crate, in the order of files and lines."""
    files = rust_files(folder)
    by_module = {module: file for file, module in files.items()}
    codes = {file: code_of((folder / file).read_text(encoding="utf-8")) for file in files}
    exports = {
        (*module, name): absolute(path, module, by_module)
        for file, module in files.items()
        for _, path, name in paths(codes[file], _HANDED_ON)
    }
    found = set()
    for file, module in files.items():
        code = codes[file]
        for position, path, name in paths(code):
            full = absolute(path, module, by_module)
            # A room that re-exports its own content does not depend on it.
            if module and exports.get((*module, name)) == full and full[: len(module)] == module:
                continue
            line = code.count("\n", 0, position) + 1
            for imported in resolved(full, by_module, exports):
                if imported != file:
                    found.add(Import(file, line, imported))
    return sorted(found, key=lambda each: (each.file, each.line, each.imported))


def code_of(text: str) -> str:
    """Blank comments, literals, visibilities and unit tests; the rest keeps its position."""
    code = _VISIBLE_IN.sub(_blank, _NO_CODE.sub(_blank, text))
    while match := _TEST.search(code):
        end = _end_of_item(code, match.end())
        code = code[: match.start()] + _blanked(code[match.start() : end]) + code[end:]
    return code


def _blank(match: re.Match[str]) -> str:
    return _blanked(match[0])


def _blanked(text: str) -> str:
    return re.sub(r"[^\n]", " ", text)


def _end_of_item(code: str, start: int) -> int:
    """Find the end of an item: the first semicolon outside of braces, or the last of its braces."""
    depth = 0
    for position in range(start, len(code)):
        character = code[position]
        depth += (character in "{([") - (character in "})]")
        if depth == 0 and character in ";}":
            return position + 1
    return len(code)


def paths(code: str, uses: re.Pattern[str] = _USE) -> Iterator[tuple[int, list[str], str]]:
    """Yield the paths of `use` items, and those in code that begin at a module.

    Each comes with its position, and with the name that it has from there on.
    """
    for match in uses.finditer(code):
        for offset, path, name in _branches(match[1]):
            yield match.start(1) + offset, path, name
    if uses is not _USE:
        return
    for match in _PATH.finditer(_USE.sub(_blank, code)):
        path = re.split(r"\s*::\s*", match[1])
        yield match.start(), path, path[-1]


def _branches(tree: str, before: tuple[str, ...] = ()) -> Iterator[tuple[int, list[str], str]]:
    """Spread the braces of a `use`; each path comes with the place of its last part."""
    stem, brace, _ = tree.partition("{")
    own, _, alias = stem.partition(" as ")
    parts = [*before, *re.findall(r"\w+|\*", own)]
    if not brace:
        if tree.strip():
            if parts[-1] == "self" and len(parts) > 1:
                parts.pop()
            yield len(stem) - len(stem.lstrip()), parts, alias.strip() or parts[-1]
        return
    begin = start = len(stem) + 1
    depth = 0
    for position in range(begin, len(tree)):
        character = tree[position]
        if character in "," * (depth == 0) or (character == "}" and depth == 0):
            for offset, path, name in _branches(tree[start:position], tuple(parts)):
                yield start + offset, path, name
            start = position + 1
        depth += (character == "{") - (character == "}")


def absolute(path: list[str], module: Module, modules: Mapping[Module, str]) -> Module:
    """Write a path from the root of the crate; it is empty if the path leads out of the crate."""
    first = path[0]
    if first == "crate":
        return tuple(path[1:])
    if first in ("self", "super"):
        ups = sum(part == "super" for part in path)
        below = (part for part in path if part not in ("self", "super"))
        return (*module[: len(module) - ups], *below)
    return (*module, *path) if (*module, first) in modules else ()


def resolved(
    full: Module, modules: Mapping[Module, str], exports: Mapping[Module, Module]
) -> Iterator[str]:
    """Yield the file that defines what a path from the root names, and files that export it.

    `exports` are names that a module hands on, with their paths. A `mod.rs` or `lib.rs` on the
    way does not count: it only makes a folder a module.
    """
    passed = set[Module]()
    while full:
        known = {*modules, *(exports.keys() - passed)}
        name = next(full[:end] for end in range(len(full), -1, -1) if full[:end] in known)
        # A module may re-export a name of one of its modules, which then has the rest of the path.
        is_module = name in modules and (name != full or name not in exports or name in passed)
        if is_module:
            yield modules[name]
            return
        passed.add(name)
        file = modules[name[:-1]]
        if not file.endswith(("mod.rs", "lib.rs")):
            yield file
        full = (*exports[name], *full[len(name) :]) if exports[name] else ()
