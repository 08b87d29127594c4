"""Imports between the files of a Python package, anywhere in them, including types."""

import ast
from collections.abc import Iterator
from pathlib import Path

from tests.walls.rooms import Import


def python_files(folder: Path) -> dict[str, str]:
    """Map the paths of the files of a package to the dotted names of its modules."""
    found = {}
    for path in sorted([*folder.rglob("*.py"), *folder.rglob("*.pyi")]):
        file = path.relative_to(folder)
        parts = [folder.name, *file.parent.parts]
        found[file.as_posix()] = ".".join(parts if file.stem == "__init__" else [*parts, file.stem])
    return found


def python_imports(folder: Path) -> list[Import]:
    """List the imports between the files of a package, in the order of files and lines."""
    modules = python_files(folder)
    by_name = {module: file for file, module in modules.items()}
    found = set()
    for file, module in modules.items():
        tree = ast.parse((folder / file).read_text(encoding="utf-8"))
        package = module if file.endswith("__init__.py") else module.rpartition(".")[0]
        for node in ast.walk(tree):
            for line, name in imported_names(node, package):
                imported = by_name.get(name) or by_name.get(name.rpartition(".")[0])
                if imported is not None and imported != file:
                    found.add(Import(file, line, imported))
    return sorted(found, key=lambda each: (each.file, each.line, each.imported))


def imported_names(node: ast.AST, package: str) -> Iterator[tuple[int, str]]:
    """Yield the line and dotted names, of modules or of what is in them, of an import."""
    if isinstance(node, ast.Import):
        yield from ((node.lineno, alias.name) for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        base = node.module or ""
        if node.level:
            parents = package.split(".")[: len(package.split(".")) - node.level + 1]
            base = ".".join([*parents, *filter(None, [base])])
        yield from ((node.lineno, f"{base}.{alias.name}") for alias in node.names)
