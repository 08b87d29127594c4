"""Small faults in a module: one operator, number, text, condition, value or statement each."""

import ast
import copy
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

PACKAGE = "python/crawler2d"

EQUIVALENT = [
    ("if excess > 0.0", "excess > 0.0 -> excess >= 0.0", "of 0 the correction leaves 0"),
    ("if excess > 0.0", "0.0 -> -1.0", "a whole number above -1 is not below 0"),
    ("float(sample[0])", "0 -> -1", "the only value"),
    ("strict=True", "True -> False", "as many of the one as of the other"),
    ('"" if outcome is None', "'' -> 'x'", "no outcome is called so either"),
    ("get_close_matches", "1 -> 2", "the first of them is taken"),
    ("nearest[0]", "0 -> -1", "the only one"),
    ("holder.children[0]", "0 -> -1", "the only one"),
    ('("diaginertia", 3)', "3 -> 4", "there are but three"),
    ('("fullinertia", 6)', "6 -> 7", "there are but six"),
    ("return out if out > tolerance", "0.0 -> -1.0", "neither is above 0, which alone is asked"),
    ("for line in diff[2:]", "2 -> 3", "the third says where, and is neither new nor gone"),
    ('f"{plugin.name} {plugin.filename}"', "' ' -> ' x'", "no word that is asked for begins so"),
    ("round_size: float", "1.0 -> 1.01", "left out of wheels that are removed, alone"),
    ("if more > 0", "0 -> -1", "wheels come in pairs, and without a difference nothing is told"),
    ("if more > 0", "0 -> 1", "wheels come in pairs, and without a difference nothing is told"),
    ("_MASS = ", "0.0001 -> 0.000101", "far above what rounding leaves, either"),
    ('if sign == "+"', "1.0 -> 1.01", "of a direction the sign alone counts"),
    ("self.models[1:]", "1 -> 0", "the model itself is the first, and nothing names it by a scope"),
    ('is_changed = [line[0] in "-+"', "'-+' -> '-+x'", "no line of a diff begins so"),
    ("range(len(lines) - 1", "1 -> 2", "the last line alone joins with none"),
    ("seconds = int(used", "1 -> 2", "the timer ends it before"),
    ("one = replace(runs, samples=1", "1 -> 2", "two runs have the paths of one"),
    ("duration = round(max(_LENGTHS", "1.0 -> 1.01", "it is rounded to a tenth of a second"),
    ("'xyz'[axis]", "'xyz' -> 'xyzx'", "there are but three"),
    ("inertia: float = 0.0", "0.0 -> 1.0", "a drum has no mass, which limits what moves with it"),
    ("lacking = (places[0]", "0 -> -1", "equal scenarios get their rows together"),
    ("for name in rows[0]}", "0 -> 1", "there are two at least, with the same names"),
    ('np.array(item["points"]', "1 -> 2", "NumPy finds the size that is any negative number"),
    ("_MARK = ", "'\\x00' -> '\\x00x'", "no text of a file has the one or the other"),
    (
        "np.argsort(distances, kind",
        "'stable' -> 'stablex'",
        "NumPy looks at the first letter alone",
    ),
    ('message = {"type": failing', "0 -> -1", "all are of one rule"),
    ("runs[repeat],) = whole", "(None, :) -> (None,)", "the other dimension is whole in both"),
    ("counts.most_common(1)[0]", "1 -> 2", "the first of them is taken"),
    ("is_line = bool(off", "off <= _EVEN -> off < _EVEN", "no distance is exactly the limit"),
    (
        "np.linalg.norm(np.cross(lateral, axis)) <= _SNAP",
        "np.linalg.norm(np.cross(lateral, axis)) <= _SNAP"
        " -> np.linalg.norm(np.cross(lateral, axis)) < _SNAP",
        "no angle is exactly the limit",
    ),
    (
        "for other in distinct",
        "math.hypot(*point - other) > near -> math.hypot(*point - other) >= near",
        "no distance is exactly the limit",
    ),
    (
        'if shape.kind != "hull" or len(shape.points)',
        "shape.kind != 'hull' or len(shape.points) > _MOST_CORNERS"
        " -> shape.kind != 'hull' and len(shape.points) > _MOST_CORNERS",
        "other shapes have no corners, and so many are never four",
    ),
    (
        '"left" if runner.z > work.view.middle',
        "runner.z > work.view.middle -> runner.z >= work.view.middle",
        "wheels in the middle are refused before",
    ),
    (
        "_SCALARS = (bool",
        "(bool, int, float, str, type(None)) -> (int, float, str, type(None))",
        "a bool is an int",
    ),
]
"""Mutants that no test can tell from the module: of the line, the change, and why."""

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
    ast.FloorDiv: [ast.Div],
    ast.Mod: [ast.Mult],
    ast.MatMult: [ast.Mult],
    ast.BitOr: [ast.BitAnd],
    ast.BitAnd: [ast.BitOr],
    ast.BitXor: [ast.BitOr],
    ast.LShift: [ast.RShift],
    ast.RShift: [ast.LShift],
}
TYPES = ("Literal", "Callable", "list", "dict", "set", "tuple")
NAMES = {"min": "max", "max": "min", "any": "all", "all": "any"}


@dataclass(frozen=True)
class Mutant:
    """One change of one file, and the lines whose tests must notice it."""

    file: Path
    text: str
    line: int
    change: str
    lines: frozenset[int]
    place: "Place"
    which: int

    def source(self) -> str:
        """Return the text of the changed module."""
        tree = ast.parse(self.text)
        node: ast.AST = tree
        for step in self.place:
            node = at(node, step)
        _, other = list(variants(node))[self.which]
        put(tree, self.place, other)
        return ast.unparse(ast.fix_missing_locations(tree))

    @property
    def code(self) -> str:
        return self.text.splitlines()[self.line - 1].strip()

    @property
    def argued(self) -> list[str]:
        """The reason why no test can notice it, if any."""
        return [why for part, what, why in EQUIVALENT if part in self.code and what == self.change]

    def __str__(self) -> str:
        return f"{self.file.relative_to(PACKAGE)}:{self.line}: {self.change}, in {self.code}"


def mutants(file: Path) -> Iterator[Mutant]:
    """Yield every mutant of a file."""
    text = file.read_text(encoding="utf-8")
    tree = ast.parse(text)
    for place, node, statements in places(tree):
        changes = [change for change, _ in variants(node)]
        if not changes:
            continue
        line = getattr(node, "lineno", statements[-1].lineno)
        lines = {statements[-1].lineno, *range(line, (getattr(node, "end_lineno", 0) or line) + 1)}
        if not any(isinstance(each, ast.FunctionDef) for each in statements[:-1]):
            lines = set(users(tree, statements))
        for which, change in enumerate(changes):
            yield Mutant(file, text, line, change, frozenset(lines), place, which)


def users(tree: ast.Module, statements: tuple[ast.stmt, ...]) -> Iterator[int]:
    """Yield the lines of the functions that use what a statement defines when it is imported.

    They are those that have its name; else those of its class, or all of the module.
    """
    targets = getattr(statements[-1], "targets", [getattr(statements[-1], "target", None)])
    names = {each.id for each in targets if isinstance(each, ast.Name)}
    if isinstance(statements[-1], ast.FunctionDef):
        names = {statements[-1].name}
    holder = next((each for each in statements if isinstance(each, ast.ClassDef)), tree)
    for scope in (tree, holder, tree):
        found = [
            each
            for each in ast.walk(scope)
            if isinstance(each, ast.FunctionDef)
            and (not names or any(named(part) in names for part in ast.walk(each)))
        ]
        names = set()
        if found:
            break
    for each in found:
        yield from range(each.body[0].lineno, (each.end_lineno or each.lineno) + 1)


def named(node: ast.AST) -> str:
    return str(getattr(node, "id", "") or getattr(node, "attr", "") or getattr(node, "name", ""))


Place = tuple[tuple[str, int | None], ...]
"""Names of fields, with indices in lists, that lead from a module to a node."""


def places(
    node: ast.AST, place: Place = (), statements: tuple[ast.stmt, ...] = ()
) -> Iterator[tuple[Place, ast.AST, tuple[ast.stmt, ...]]]:
    """Yield every node whose change can matter, and the statements in which it is.

    Annotations, docstrings and lists of names do not matter.
    """
    if isinstance(node, ast.stmt):
        statements = (*statements, node)
    if place:
        yield place, node, statements
    for name, value in ast.iter_fields(node):
        if name in ("annotation", "returns", "decorator_list", "bases", "type_params"):
            continue
        for index, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if isinstance(child, ast.AST) and not is_silent(child):
                yield from places(child, (*place, (name, index)), statements)


def is_silent(node: ast.AST) -> bool:
    """Whether a node does nothing when the program runs."""
    if isinstance(node, (ast.Import, ast.ImportFrom, ast.expr_context)):
        return True
    if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant):
        return True  # a docstring
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        return True
    if isinstance(node, ast.Subscript) and ast.unparse(node.value) in TYPES:
        return True
    return isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__"


def variants(node: ast.AST) -> Iterator[tuple[str, ast.AST]]:
    """Yield possible changes of a node, with a word for each."""
    for changed in [*operators(node), *values(node)]:
        yield f"{ast.unparse(node)} -> {ast.unparse(changed)}", changed
    if isinstance(node, (ast.If, ast.IfExp)):
        branch = copy.deepcopy(node)
        branch.test = ast.UnaryOp(ast.Not(), node.test)
        yield f"not ({ast.unparse(node.test)})", branch
    elif isinstance(node, ast.Return) and ast.unparse(node) not in ("return", "return None"):
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
    """Replace a node by another."""
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
