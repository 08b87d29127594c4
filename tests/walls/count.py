"""Counts code: `python -m tests.walls.count [FOLDER ...]`, by default everything except tests.

A line of code is one that is not blank, comment or docstring. Tests are left out.
"""

import ast
import io
import re
import statistics
import sys
import tokenize
from pathlib import Path

from tests.walls.rooms import ROOT

FOLDERS = ("python/crawler2d", "rust_core/src", "python/src", "research", "benches")


def python_code(text: str) -> int:
    """Count the lines of code of a Python file."""
    docstrings = set[int]()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            for each in node.body:
                if isinstance(each, ast.Expr) and isinstance(each.value, ast.Constant):
                    docstrings.update(range(each.lineno, (each.end_lineno or 0) + 1))
    code = set[int]()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type in (tokenize.NAME, tokenize.OP, tokenize.NUMBER, tokenize.STRING):
            code.update(range(token.start[0], token.end[0] + 1))
    return len(code - docstrings)


def rust_code(text: str) -> int:
    """Count the lines of code of a Rust file, without the unit tests at its end."""
    text = re.sub(r"#\[cfg\(test\)\]\s*mod \w+ \{.*\Z", "", text, flags=re.DOTALL)
    lines = (line.strip() for line in text.splitlines())
    return sum(bool(line) and not line.startswith("//") for line in lines)


def row(folder: str, files: list[Path]) -> str:
    """Return the row with the numbers of files and lines of a folder."""
    texts = [path.read_text(encoding="utf-8") for path in files]
    code = [
        (python_code if path.suffix == ".py" else rust_code)(text)
        for path, text in zip(files, texts, strict=True)
    ]
    lines = [text.count("\n") for text in texts]
    return (
        f"{folder:<32} {len(files):4} files {sum(lines):6} lines {sum(code):6} code,"
        f" median {statistics.median(lines):4.0f}, largest {max(lines):4}"
    )


def main(folders: list[str]) -> None:
    """Print a row for each folder, and for each folder in it."""
    for name in folders or FOLDERS:
        files = [
            path
            for path in sorted((ROOT / name).rglob("*"))
            if path.suffix in (".py", ".rs")
            and not (path.suffix == ".rs" and re.search(r"/tests(/|\.rs)", path.as_posix()))
        ]
        print(row(name, files))
        rooms = sorted({path.relative_to(ROOT / name).parts[0] for path in files})
        for room in rooms:
            inside = [path for path in files if path.relative_to(ROOT / name).parts[0] == room]
            if len(inside) > 1:
                print(row(f"  {room}", inside))


if __name__ == "__main__":
    main(sys.argv[1:])
