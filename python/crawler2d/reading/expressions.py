"""Expressions of xacro, evaluated here and not by Python: by a list of what is harmless.

The text is parsed, but never compiled. Each node of its tree is evaluated below on plain data, or
refused: nothing else of Python can be reached, because no attribute of any object is ever taken. A
dotted name is a key of a dict, a member of a space such as ``math``, or a method of the list below
that is called at once. Sizes are bounded before anything is made of them, and work is counted.
"""

from __future__ import annotations

import ast
import math
import operator
from collections import ChainMap
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from types import MappingProxyType
from typing import Any, NoReturn

__all__ = ["NAMES", "NotAllowed", "copy_data", "evaluate"]

_LONGEST = 2000  # [characters] of an expression; those of public files have at most 200
_DEEPEST = 100
_MOST = 100_000  # characters of a text, and parts of a value
_STEPS = 200_000  # nodes evaluated and parts made by one expression
_BITS = 400  # of an integer
_SCALARS = (bool, int, float, str, type(None))
_PLAIN = (*_SCALARS, list, tuple, dict)


class NotAllowed(Exception):
    """What only a trusted file may evaluate.

    Parameters
    ----------
    found : str
        What is not allowed.
    rule : str
        What it breaks.

    Attributes
    ----------
    expression : str
        In which it stands.
    """

    def __init__(
        self, found: str, rule: str = "must have only plain data, operators and known functions"
    ) -> None:
        super().__init__(found, rule)
        self.found = found
        self.rule = rule
        self.expression = ""


def evaluate(text: str, names: Mapping[str, Any]) -> Any:
    """Evaluate an expression.

    Parameters
    ----------
    text : str
        As Python writes it.
    names : mapping
        What names stand for: plain data, functions, and spaces, which are mappings but no dicts.

    Returns
    -------
    number, str, None, list, tuple or dict
        Plain data, with all that is in it.

    Raises
    ------
    NotAllowed
        If it holds what is not on the list, or makes what is too large.
    Exception
        What Python raises for the same, such as `NameError`.

    Examples
    --------
    >>> evaluate("2 * radius if wide else [pi, 'a'][0]", {**NAMES, "radius": 0.1, "wide": True})
    0.2
    >>> evaluate("().__class__", NAMES)
    Traceback (most recent call last):
    ...
    crawler2d.reading.expressions.NotAllowed: ('.__class__', 'must have only plain data, ...')
    """
    try:
        if len(text) > _LONGEST:
            raise NotAllowed(f"{len(text)} characters", f"must have at most {_LONGEST} characters")
        try:
            tree = ast.parse(text.strip(), mode="eval")
        except (RecursionError, MemoryError):  # of the parser
            raise NotAllowed("a deeper one", f"must be nested at most {_DEEPEST} deep") from None
        evaluation = _Evaluation(text.strip(), names)
        return evaluation.weighed(evaluation.value(tree.body))
    except NotAllowed as error:
        error.expression = text
        raise


def copy_data(value: Any) -> Any:
    """Copy lists and dicts of any class as plain ones; anything but data is refused."""
    return _Evaluation("", {}).copy(value, 0)


class _Evaluation:
    """One expression: what it may still do."""

    def __init__(self, text: str, names: Mapping[str, Any]) -> None:
        self.text = text
        self.names = names
        self.steps = _STEPS
        self.depth = 0

    def count(self, steps: int) -> None:
        self.steps -= steps
        if self.steps < 0:
            raise NotAllowed("more", f"must be evaluated in {_STEPS} steps")

    def weighed(self, value: Any) -> Any:
        """Return a value whose parts are all plain and not too many, as often as they are shown."""
        waiting, weight = [value], 0
        while waiting:
            part = waiting.pop()
            if type(part) not in _PLAIN:
                _refuse_object(part)
            weight += 1
            if isinstance(part, str):
                weight += len(part) // 16
                if len(part) > _MOST:
                    _refuse_size()
            elif isinstance(part, dict):
                waiting += [*part.keys(), *part.values()]
            elif isinstance(part, (list, tuple)):
                waiting += part
            elif isinstance(part, int) and part.bit_length() > _BITS:
                raise NotAllowed("a larger one", f"must have integers of at most {_BITS} bits")
            if weight + len(waiting) > _MOST:
                _refuse_size()
        self.count(weight)
        return value

    def copy(self, value: Any, depth: int) -> Any:
        self.count(1)
        if depth > _DEEPEST:
            raise NotAllowed("a deeper one", f"must be nested at most {_DEEPEST} deep")
        if isinstance(value, dict):
            return {
                self.copy(key, depth + 1): self.copy(dict.__getitem__(value, key), depth + 1)
                for key in value
            }
        if isinstance(value, list):
            return [self.copy(each, depth + 1) for each in list.__iter__(value)]
        return self.weighed(value)

    @contextmanager
    def deeper(self) -> Iterator[None]:
        self.count(1)
        self.depth += 1
        if self.depth > _DEEPEST:
            raise NotAllowed("a deeper one", f"must be nested at most {_DEEPEST} deep")
        yield
        self.depth -= 1

    def value(self, node: ast.expr) -> Any:
        """Evaluate a node that must be plain data."""
        with self.deeper():
            found = self.found(node)
        if type(found) not in _PLAIN:
            _refuse_object(found)
        return found

    def found(self, node: ast.expr) -> Any:  # noqa: PLR0911, PLR0912 - one for each kind of node
        """Evaluate a node; of names and dotted names also functions and spaces."""
        match node:
            case ast.Name(id=name):
                return self.named(name)
            case ast.Attribute(value=owner, attr=name):
                with self.deeper():
                    return self.member(self.found(owner), name)
            case ast.Constant(value=value) if type(value) in _SCALARS:
                return self.weighed(value)
            case ast.UnaryOp(op=op, operand=operand):
                return _UNARY[type(op)](self.value(operand))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                return self.weighed(_BINARY[type(op)](self.value(left), self.value(right)))
            case ast.BoolOp(op=op, values=parts):
                return self.either(parts, until=isinstance(op, ast.Or))
            case ast.Compare(left=left, ops=ops, comparators=parts):
                return self.compared(left, ops, parts)
            case ast.IfExp(test=test, body=body, orelse=other):
                return self.value(body if self.value(test) else other)
            case ast.List(elts=parts):
                return self.weighed([self.value(part) for part in parts])
            case ast.Tuple(elts=parts):
                return self.weighed(tuple(self.value(part) for part in parts))
            case ast.Dict(keys=keys, values=parts) if None not in keys:
                pairs = zip(keys, parts, strict=True)
                return self.weighed({self.value(k): self.value(v) for k, v in pairs if k})
            case ast.Subscript(value=owner, slice=ast.Slice(lower=lower, upper=upper, step=step)):
                ends = [None if end is None else self.value(end) for end in (lower, upper, step)]
                return self.weighed(self.value(owner)[slice(*ends)])
            case ast.Subscript(value=owner, slice=index):
                return self.value(owner)[self.value(index)]
            case ast.Call(func=function, args=arguments, keywords=keywords):
                return self.called(function, arguments, keywords)
            case ast.ListComp(
                elt=element,
                generators=[
                    ast.comprehension(target=ast.Name(id=name), iter=source, ifs=tests, is_async=0)
                ],
            ):
                return self.listed(element, name, source, tests)
        raise NotAllowed(self.written(node))

    def written(self, node: ast.expr) -> str:
        """Return the beginning of a node as it is written."""
        return (ast.get_source_segment(self.text, node) or type(node).__name__)[:60]

    def named(self, name: str) -> Any:
        """Return what a name stands for."""
        if name.startswith("__"):
            raise NotAllowed(name)
        try:
            return self.names[name]
        except KeyError:
            raise NameError(f"name '{name}' is not defined") from None

    def member(self, owner: Any, name: str) -> Any:
        """Return what a dotted name stands for: a key, a member of a space, or a known method."""
        if name.startswith("__"):
            raise NotAllowed(f".{name}")
        if type(owner) is dict or (type(owner) not in _PLAIN and isinstance(owner, Mapping)):
            try:
                return owner[name]
            except KeyError:
                pass
        method = _METHODS.get(type(owner), {}).get(name)
        if method is None:
            raise NotAllowed(f".{name}")
        return partial(method, owner)

    def called(self, node: ast.expr, arguments: list[ast.expr], keywords: list[ast.keyword]) -> Any:
        """Call a function of the list."""
        with self.deeper():
            function = self.found(node)
        if type(function) in _PLAIN:
            raise TypeError(f"{self.written(node)} is no function")
        if not callable(function):
            _refuse_object(function)
        values = self.weighed([self.value(argument) for argument in arguments])
        named = {each.arg: self.value(each.value) for each in keywords if each.arg}
        if len(named) < len(keywords) or (named and function is not dict):
            raise NotAllowed(f"{keywords[0].arg or '**'}=")
        result = self.weighed(function(*values, **named))
        if isinstance(function, partial):  # a method, which may have added to what it is of
            self.weighed(list(function.args))
        return result

    def either(self, parts: list[ast.expr], *, until: bool) -> Any:
        """Return the first of some values that is true, or false; else the last."""
        value = None
        for part in parts:
            value = self.value(part)
            if bool(value) is until:
                break
        return value

    def compared(self, left: ast.expr, ops: list[ast.cmpop], parts: list[ast.expr]) -> Any:
        """Compare values in a row."""
        one = self.weighed(self.value(left))
        holds: Any = True
        for op, part in zip(ops, parts, strict=True):
            other = self.weighed(self.value(part))
            holds = _COMPARISONS[type(op)](one, other)
            if not holds:
                break
            one = other
        return holds

    def listed(
        self, element: ast.expr, name: str, source: ast.expr, tests: list[ast.expr]
    ) -> list[Any]:
        """Make a list of each element of another; its name is known within it alone."""
        outer, made = self.names, []
        for each in iter(self.value(source)):
            self.names = ChainMap({name: each}, outer)  # type: ignore[arg-type]
            if all(self.value(test) for test in tests):
                made.append(self.value(element))
        self.names = outer
        return self.weighed(made)  # type: ignore[no-any-return]


def _refuse_object(value: object) -> NoReturn:
    kind = "a function" if callable(value) else f"a {type(value).__name__}"
    raise NotAllowed(kind, "must give plain data: numbers, texts, lists and dicts")


def _refuse_size() -> NoReturn:
    raise NotAllowed("more", f"must have texts and values of at most {_MOST} parts")


def _times(one: Any, other: Any) -> Any:
    for many, times in ((one, other), (other, one)):
        if isinstance(many, (str, list, tuple)) and isinstance(times, int):
            _check_size(len(many) * times)
    return one * other


def _power(base: Any, exponent: Any) -> Any:
    if isinstance(base, int) and isinstance(exponent, int):
        _check_bits(base.bit_length() * abs(exponent))
    power = base**exponent
    if isinstance(power, complex):
        raise ValueError(f"{base} ** {exponent} is no real number")
    return power


def _shifted(number: Any, by: Any) -> Any:
    if isinstance(by, int):
        _check_bits(by)
    return number << by


def _remainder(one: Any, other: Any) -> Any:
    if isinstance(one, str):
        raise NotAllowed("% of a text")
    return one % other


def _check_size(size: int) -> None:
    if size > _MOST:
        _refuse_size()


def _check_bits(bits: int) -> None:
    if bits > _BITS:
        raise NotAllowed("a larger one", f"must have integers of at most {_BITS} bits")


def _range(*ends: int) -> list[int]:
    numbers = range(*ends)
    if numbers:  # the length of one that is too long has no integer that len() may return
        _check_size(abs(numbers[-1] - numbers[0]) // abs(numbers.step) + 1)
    return list(numbers)


def _rounded(number: Any, digits: int | None = None) -> Any:
    if digits is not None:
        _check_bits(abs(digits))
    return round(number, digits)


def _replaced(text: str, old: str, new: str) -> str:
    _check_size(len(text) + text.count(old) * len(new))
    return text.replace(old, new)


def _list_of(function: Callable[..., Any]) -> Callable[..., list[Any]]:
    """Return a function that gives a list, of one that gives what is not plain."""
    return lambda *values: list(function(*values))


def _sum(values: Any) -> Any:
    return sum(values)


_UNARY: dict[type[ast.unaryop], Callable[[Any], Any]] = {
    ast.UAdd: operator.pos,
    ast.USub: operator.neg,
    ast.Not: operator.not_,
    ast.Invert: operator.invert,
}
_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: _times,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: _remainder,
    ast.Pow: _power,
    ast.LShift: _shifted,
    ast.RShift: operator.rshift,
    ast.BitAnd: operator.and_,
    ast.BitOr: operator.or_,
    ast.BitXor: operator.xor,
}
_COMPARISONS: dict[type[ast.cmpop], Callable[[Any, Any], Any]] = {
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Is: operator.is_,
    ast.IsNot: operator.is_not,
    ast.In: lambda one, many: one in many,
    ast.NotIn: lambda one, many: one not in many,
}
_METHODS: dict[type, dict[str, Callable[..., Any]]] = {
    str: {
        **{name: getattr(str, name) for name in ("strip", "lstrip", "rstrip", "split")},
        **{name: getattr(str, name) for name in ("lower", "upper", "startswith", "endswith")},
        "replace": _replaced,
    },
    list: {"append": list.append, "index": list.index, "count": list.count},
    dict: {
        "get": dict.get,
        **{name: _list_of(getattr(dict, name)) for name in ("keys", "values", "items")},
    },
}
"""Those that public files call; none makes what is larger than the values that go in, or it checks
before."""

# What these make grows faster than what goes in.
_GROWING = ("factorial", "comb", "perm", "prod")
_MATH = {
    name: member
    for name, member in vars(math).items()
    if not name.startswith("_") and name not in _GROWING
}
_PYTHON: dict[str, Callable[..., Any]] = {
    **{each.__name__: each for each in (abs, bool, float, int, len, list, ord, repr, str, tuple)},
    **{each.__name__: each for each in (all, any, dict, divmod, max, min, sorted)},
    **{each.__name__: _list_of(each) for each in (enumerate, reversed, zip)},
    "range": _range,
    "round": _rounded,
    "sum": _sum,
}

NAMES: Mapping[str, Any] = MappingProxyType(
    {
        **_PYTHON,
        **_MATH,
        "math": MappingProxyType(_MATH),
        "python": MappingProxyType(_PYTHON),
    }
)
"""What xacro gives names to, and is harmless."""
