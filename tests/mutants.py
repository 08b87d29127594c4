"""Whether the tests of a module notice a change in it: one change at a time, each must fail a test.

    python tests/mutants.py [NAME ...]

Names are those of `TESTS`, all by default. Each mutant is a copy of the package with one operator,
number, text, condition, returned value or statement changed. Survivors are printed with their
line; the exit status is 1 if there are others than `EQUIVALENT` argues away. Needs fork, and some
three seconds a mutant.
"""

import ast
import copy
import importlib
import os
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent

TESTS = {
    "statistics": ["tests/sweeps/test_statistics.py", "tests/sweeps/test_statistics_scipy.py"],
    "../variation/draws": ["tests/sweeps/test_draws.py"],
    "../variation/distributions": ["tests/sweeps/test_draws.py"],
    "rates": ["tests/sweeps/test_rates.py", "tests/sweeps/test_unknowns.py"],
    "sequential": ["tests/sweeps/test_sequential.py"],
}
"""Of each module of the sweeps that is tried."""

EQUIVALENT = [
    ("if excess > 0.0", "excess > 0.0 -> excess >= 0.0", "of 0 the correction leaves 0"),
    ("if excess > 0.0", "0.0 -> -1.0", "a whole number above -1 is not below 0"),
    ("float(sample[0])", "0 -> -1", "the only value"),
    ("strict=True", "True -> False", "as many of the one as of the other"),
    ('"" if outcome is None', "'' -> 'x'", "no outcome is called so either"),
    ("get_close_matches", "1 -> 2", "the first of them is taken"),
    ("nearest[0]", "0 -> -1", "the only one"),
]
"""Mutants that no test can tell from the module: of the line, the change, and why."""

# [s] A mutant that takes longer loops for ever.
LONGEST = 120

OTHERS: dict[type[ast.AST], list[type[ast.AST]]] = {
    ast.Lt: [ast.LtE, ast.GtE],
    ast.LtE: [ast.Lt, ast.Gt],
    ast.Gt: [ast.GtE, ast.LtE],
    ast.GtE: [ast.Gt, ast.Lt],
    ast.Eq: [ast.NotEq],
    ast.NotEq: [ast.Eq],
    ast.In: [ast.NotIn],
    ast.NotIn: [ast.In],
    ast.Is: [ast.IsNot],
    ast.IsNot: [ast.Is],
    ast.Add: [ast.Sub],
    ast.Sub: [ast.Add],
    ast.Mult: [ast.Div],
    ast.Div: [ast.Mult],
    ast.Pow: [ast.Mult],
    ast.BitOr: [ast.BitAnd],
}
NAMES = {"min": "max", "max": "min", "any": "all", "all": "any"}


def mutants(tree: ast.Module) -> Iterator[tuple[str, int, str]]:
    """Yield the text of each mutant, and on which line what was changed."""
    for path, node in places(tree):
        for change, other in variants(node):
            mutant = copy.deepcopy(tree)
            put(mutant, path, other)
            line = getattr(node, "lineno", 0)
            yield ast.unparse(ast.fix_missing_locations(mutant)), line, change


Place = tuple[tuple[str, int | None], ...]
"""Names of fields, with indices in lists, that lead from a module to a node."""


def places(node: ast.AST, path: Place = ()) -> Iterator[tuple[Place, ast.AST]]:
    """Yield every node whose change can matter: no annotation, docstring or list of names."""
    if path:
        yield path, node
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "bases", "type_params"):
            continue
        for index, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(child, ast.AST) and not is_silent(child):
                yield from places(child, (*path, (name, index)))


def is_silent(node: ast.AST) -> bool:
    """Whether a node does nothing when the program runs."""
    if isinstance(node, (ast.Import, ast.ImportFrom, ast.expr_context)):
        return True
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return True  # a docstring
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return True
    return isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"


def variants(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Yield what a node can be changed to, and a word for it."""
    for changed in [*operators(node), *values(node)]:
        yield f"{ast.unparse(node)} -> {ast.unparse(changed)}", changed
    if isinstance(node, (ast.If, ast.IfExp)):
        branch = copy.deepcopy(node)
        branch.test = ast.UnaryOp(ast.Not(), node.test)
        yield f"not ({ast.unparse(node.test)})", branch
    elif isinstance(node, ast.Return) and node.value is not None:
        yield f"{ast.unparse(node)} -> return None", ast.Return(ast.Constant(None))
    elif isinstance(node, (ast.Raise, ast.Expr, ast.AugAssign, ast.Continue)):
        yield f"{ast.unparse(node)} -> pass", ast.Pass()


def operators(node: ast.AST) -> Iterator[ast.AST]:
    if isinstance(node, ast.Compare):
        for index, compared in enumerate(node.ops):
            for other in OTHERS[type(compared)]:
                ops: list[Any] = [*node.ops[:index], other(), *node.ops[index + 1 :]]
                yield ast.Compare(node.left, ops, node.comparators)
    elif isinstance(node, ast.BinOp):
        for other in OTHERS[type(node.op)]:
            changed: Any = other()
            yield ast.BinOp(node.left, changed, node.right)
    elif isinstance(node, ast.BoolOp):
        yield ast.BoolOp(ast.Or() if isinstance(node.op, ast.And) else ast.And(), node.values)
    elif isinstance(node, ast.UnaryOp):
        yield node.operand


def values(node: ast.AST) -> Iterator[ast.AST]:
    if isinstance(node, ast.Constant):
        value: Any = node.value
        if isinstance(value, bool):
            yield ast.Constant(not value)
        elif isinstance(value, int):
            yield from (ast.Constant(value + 1), ast.Constant(value - 1))
        elif isinstance(value, float):
            yield from (ast.Constant(value + 1.0), ast.Constant(value * 1.01 or -1.0))
        elif isinstance(value, str):
            yield ast.Constant(value + "x")
    elif isinstance(node, ast.Name) and node.id in NAMES:
        yield ast.Name(NAMES[node.id], ast.Load())
    elif isinstance(node, ast.Tuple) and isinstance(node.ctx, ast.Load):
        for index in range(len(node.elts)):
            yield ast.Tuple(node.elts[:index] + node.elts[index + 1 :], ast.Load())


def put(tree: ast.AST, path: Place, node: ast.AST) -> None:
    """Put a node in the place of another."""
    for step in path[:-1]:
        tree = at(tree, step)
    name, index = path[-1]
    if index is None:
        setattr(tree, name, node)
    else:
        getattr(tree, name)[index] = node


def at(node: ast.AST, step: tuple[str, int | None]) -> ast.AST:
    name, index = step
    found: ast.AST = getattr(node, name) if index is None else getattr(node, name)[index]
    return found


def is_noticed(package: Path, tests: list[str]) -> bool:
    """Whether a test fails with the package of a folder, in a process of its own."""
    child = os.fork()
    if child == 0:
        signal.alarm(LONGEST)
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, 1)
        os.dup2(nowhere, 2)
        sys.path.insert(0, str(package))
        import pytest  # noqa: PLC0415 - after `main` has

        os._exit(int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", *tests])))
    _, status = os.waitpid(child, 0)
    return status != 0


def main(names: list[str]) -> int:
    for library in ("numpy", "pytest", "scipy.stats", "xarray"):
        importlib.import_module(library)  # once for all children; the package is each child's own
    os.chdir(ROOT)
    sys.dont_write_bytecode = True
    unexplained = 0
    with tempfile.TemporaryDirectory() as folder:
        package = Path(folder)
        ignored = shutil.ignore_patterns("__pycache__")
        shutil.copytree(ROOT / "python/crawler2d", package / "crawler2d", ignore=ignored)
        for name in names or TESTS:
            begin = time.monotonic()
            source = package / "crawler2d/sweeps" / f"{name}.py"
            text = source.read_text(encoding="utf-8")
            if is_noticed(package, TESTS[name]):
                raise SystemExit(f"the tests of {name} fail without a mutant")
            killed = total = 0
            for mutant, number, change in mutants(ast.parse(text)):
                source.write_text(mutant, encoding="utf-8")
                total += 1
                if is_noticed(package, TESTS[name]):
                    killed += 1
                    continue
                line = text.splitlines()[number - 1].strip()
                found = [why for part, what, why in EQUIVALENT if part in line and what == change]
                unexplained += not found
                print(f"{name}.py:{number}: {change}, in {line}", *found, sep="  # ", flush=True)
            source.write_text(text, encoding="utf-8")
            took = time.monotonic() - begin
            print(
                f"{name}: {killed} of {total} mutants noticed ({killed / total:.1%}), {took:.0f} s"
            )
    return 1 if unexplained else 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
