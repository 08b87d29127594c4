"""What the files of a crate import of each other, unit tests left out."""

import re
from collections.abc import Iterator
from pathlib import Path

from tests.walls.rooms import Import

Module = tuple[str, ...]

_NO_CODE = re.compile(
    r"""//[^\n]* | /\*.*?\*/ | b?r(\#*)".*?"\1 | b?"(?:\\.|[^"\\])*" | b?'(?:\\.[^']*|[^'\\])'""",
    re.DOTALL | re.VERBOSE,
)
_VISIBLE_IN = re.compile(r"\(in [^)]*\)")
_TEST = re.compile(r"#\[cfg\(test\)\]")
_TEST_MODULE = re.compile(r"#\[cfg\(test\)\]\s*mod\s+(\w+)\s*;")
_USE = re.compile(r"\buse\s+([^;]+);")
_HANDED_ON = re.compile(r"\bpub(?:\([^)]*\))?\s+use\s+([^;]+);")
_PATH = re.compile(r"\b((?:crate|super|self)(?:\s*::\s*\w+)+)")


def rust_files(folder: Path) -> dict[str, Module]:
    """Map the paths of the files of a crate to its modules, those of unit tests left out."""
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
    faces = {
        (*module, path[-1]): resolved(path, module, by_module, {})
        for file, module in files.items()
        for _, path in paths(codes[file], _HANDED_ON)
    }
    found = set()
    for file, module in files.items():
        code = codes[file]
        for position, path in paths(code):
            target = resolved(path, module, by_module, faces)
            is_face = target is not None and faces.get((*module, path[-1])) == target
            # A room that hands on what is in it does not depend on that.
            if target is None or (is_face and target[: len(module)] == module):
                continue
            if by_module[target] != file:
                line = code.count("\n", 0, position) + 1
                found.add(Import(file, line, by_module[target]))
    return sorted(found, key=lambda each: (each.file, each.line, each.imported))


def code_of(text: str) -> str:
    """Blank comments, literals, visibilities and unit tests; what is left stays where it was."""
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


def paths(code: str, uses: re.Pattern[str] = _USE) -> Iterator[tuple[int, list[str]]]:
    """Yield the paths of `use` items, and those in code that begin at a module, with positions."""
    for match in uses.finditer(code):
        for offset, path in _branches(match[1]):
            yield match.start(1) + offset, path
    if uses is not _USE:
        return
    for match in _PATH.finditer(_USE.sub(_blank, code)):
        yield match.start(), re.split(r"\s*::\s*", match[1])


def _branches(tree: str, before: tuple[str, ...] = ()) -> Iterator[tuple[int, list[str]]]:
    """Spread the braces of a `use`; each path comes with the place of its last part."""
    stem, brace, _ = tree.partition("{")
    parts = [*before, *re.findall(r"\w+|\*", stem.split(" as ")[0])]
    if not brace:
        if tree.strip():
            yield len(stem) - len(stem.lstrip()), parts
        return
    begin = start = len(stem) + 1
    depth = 0
    for position in range(begin, len(tree)):
        character = tree[position]
        if character in "," * (depth == 0) or (character == "}" and depth == 0):
            for offset, path in _branches(tree[start:position], tuple(parts)):
                yield start + offset, path
            start = position + 1
        depth += (character == "{") - (character == "}")


def resolved(
    path: list[str],
    module: Module,
    modules: dict[Module, str],
    faces: dict[Module, Module | None],
) -> Module | None:
    """Find the module that a path leads to; None if it leads out of the crate.

    `faces` are names that a module hands on, with the modules that they come from.
    """
    first = path[0]
    if first == "crate":
        full = path[1:]
    elif first in ("self", "super"):
        ups = sum(part == "super" for part in path)
        full = [*module[: len(module) - ups], *(p for p in path if p not in ("self", "super"))]
    elif (*module, first) in modules:
        full = [*module, *path]
    else:
        return None
    for end in range(len(full), -1, -1):
        if faces.get(tuple(full[:end])) is not None:
            return faces[tuple(full[:end])]
        if tuple(full[:end]) in modules:
            return tuple(full[:end])
    return None
