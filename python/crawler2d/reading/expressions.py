"""Evaluate xacro expressions without Python's eval, with a list of harmless names.

The text is parsed but never compiled. Each node of its tree is evaluated here on plain data, or
refused. Nothing else of Python can be reached, because attributes of objects are never read: a
dotted name is a key of a dict, a member of a namespace such as ``math``, or a method listed below.
Sizes are checked before anything is built, and steps are counted.
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
    """An expression that only a trusted file may evaluate.

    Parameters
    ----------
    found : str
        The part that is not allowed.
    rule : str
        The rule that it breaks.

    Attributes
    ----------
    expression : str
        The whole expression.
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
        Expression in Python syntax.
    names : mapping
        Values by name: plain data, functions, and namespaces, which are mappings other than dicts.

    Returns
    -------
    number, str, None, list, tuple or dict
        Plain data at every level.

    Raises
    ------
    NotAllowed
        If a part is not on the list, or a value is too large.
    Exception
        As raised by Python, such as `NameError`.

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
        except (RecursionError, MemoryError):  # raised by the parser
            raise _too_deep() from None
        evaluation = _Evaluation(text.strip(), names)
        return evaluation.checked(evaluation.value(tree.body))
    except NotAllowed as error:
        error.expression = text
        raise


def copy_data(value: Any) -> Any:
    """Copy lists and dicts of any class as plain ones; refuse anything but data."""
    return _Evaluation("", {}).copy(value, 0)


class _Evaluation:
    """The evaluation of one expression, with its remaining steps."""

    def __init__(self, text: str, names: Mapping[str, Any]) -> None:
        self.text = text
        self.names = names
        self.steps = _STEPS
        self.depth = 0

    def count(self, steps: int) -> None:
        self.steps -= steps
        if self.steps < 0:
            raise NotAllowed("more", f"must be evaluated in {_STEPS} steps")

    def checked(self, value: Any) -> Any:
        """Check that all parts of a value are plain, and not too many with repetitions."""
        waiting, weight = [value], 0
        while waiting:
            part = waiting.pop()
            if type(part) not in _PLAIN:
                _refuse_object(part)
            weight += 1
            if isinstance(part, str):
                weight += len(part) // 16
                _check_size(len(part))
            elif isinstance(part, dict):
                waiting += [*part.keys(), *part.values()]
            elif isinstance(part, (list, tuple)):
                waiting += part
            elif isinstance(part, int):
                _check_bits(part.bit_length())
            _check_size(weight + len(waiting))
        self.count(weight)
        return value

    def copy(self, value: Any, depth: int) -> Any:
        self.count(1)
        if depth > _DEEPEST:
            raise _too_deep()
        if isinstance(value, dict):
            return {
                self.copy(key, depth + 1): self.copy(dict.__getitem__(value, key), depth + 1)
                for key in value
            }
        if isinstance(value, list):
            return [self.copy(each, depth + 1) for each in list.__iter__(value)]
        return self.checked(value)

    @contextmanager
    def deeper(self) -> Iterator[None]:
        self.count(1)
        self.depth += 1
        if self.depth > _DEEPEST:
            raise _too_deep()
        yield
        self.depth -= 1

    def value(self, node: ast.expr) -> Any:
        """Evaluate a node that must be plain data."""
        with self.deeper():
            value = self.resolve(node)
        if type(value) not in _PLAIN:
            _refuse_object(value)
        return value

    def resolve(self, node: ast.expr) -> Any:  # noqa: PLR0911, PLR0912 - one for each kind of node
        """Evaluate a node; names and dotted names may also be functions and namespaces."""
        match node:
            case ast.Name(id=name):
                return self.lookup(name)
            case ast.Attribute(value=owner, attr=name):
                with self.deeper():
                    return self.member(self.resolve(owner), name)
            case ast.Constant(value=value) if type(value) in _SCALARS:
                return self.checked(value)
            case ast.UnaryOp(op=op, operand=operand):
                return _UNARY[type(op)](self.value(operand))
            case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
                return self.checked(_BINARY[type(op)](self.value(left), self.value(right)))
            case ast.BoolOp(op=op, values=parts):
                return self.either(parts, until=isinstance(op, ast.Or))
            case ast.Compare(left=left, ops=ops, comparators=parts):
                return self.compare(left, ops, parts)
            case ast.IfExp(test=test, body=body, orelse=other):
                return self.value(body if self.value(test) else other)
            case ast.List(elts=parts):
                return self.checked([self.value(part) for part in parts])
            case ast.Tuple(elts=parts):
                return self.checked(tuple(self.value(part) for part in parts))
            case ast.Dict(keys=keys, values=parts) if None not in keys:
                pairs = zip(keys, parts, strict=True)
                return self.checked({self.value(k): self.value(v) for k, v in pairs if k})
            case ast.Subscript(value=owner, slice=ast.Slice(lower=lower, upper=upper, step=step)):
                ends = [None if end is None else self.value(end) for end in (lower, upper, step)]
                return self.checked(self.value(owner)[slice(*ends)])
            case ast.Subscript(value=owner, slice=index):
                return self.value(owner)[self.value(index)]
            case ast.Call(func=function, args=arguments, keywords=keywords):
                return self.call(function, arguments, keywords)
            case ast.ListComp(
                elt=element,
                generators=[
                    ast.comprehension(target=ast.Name(id=name), iter=source, ifs=tests, is_async=0)
                ],
            ):
                return self.comprehend(element, name, source, tests)
        raise NotAllowed(self.written(node))

    def written(self, node: ast.expr) -> str:
        """Return the beginning of a node's text."""
        return (ast.get_source_segment(self.text, node) or type(node).__name__)[:60]

    def lookup(self, name: str) -> Any:
        """Return the value of a name."""
        if name.startswith("__"):
            raise NotAllowed(name)
        try:
            return self.names[name]
        except KeyError:
            raise NameError(f"name '{name}' is not defined") from None

    def member(self, owner: Any, name: str) -> Any:
        """Return the value of a dotted name: a key, a member of a namespace, or a known method."""
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

    def call(self, node: ast.expr, arguments: list[ast.expr], keywords: list[ast.keyword]) -> Any:
        """Call a function of the list."""
        with self.deeper():
            function = self.resolve(node)
        if type(function) in _PLAIN:
            raise TypeError(f"{self.written(node)} is not a function")
        if not callable(function):
            _refuse_object(function)
        values = self.checked([self.value(argument) for argument in arguments])
        named = {each.arg: self.value(each.value) for each in keywords if each.arg}
        if len(named) < len(keywords) or (named and function is not dict):
            raise NotAllowed(f"{keywords[0].arg or '**'}=")
        result = self.checked(function(*values, **named))
        if isinstance(function, partial):  # a method may have extended its object
            self.checked(list(function.args))
        return result

    def either(self, parts: list[ast.expr], *, until: bool) -> Any:
        """Return the first value that decides `or` or `and`, else the last."""
        value = None
        for part in parts:
            value = self.value(part)
            if bool(value) is until:
                break
        return value

    def compare(self, left: ast.expr, ops: list[ast.cmpop], parts: list[ast.expr]) -> Any:
        """Evaluate a chained comparison."""
        one = self.checked(self.value(left))
        holds: Any = True
        for op, part in zip(ops, parts, strict=True):
            other = self.checked(self.value(part))
            holds = _COMPARISONS[type(op)](one, other)
            if not holds:
                break
            one = other
        return holds

    def comprehend(
        self, element: ast.expr, name: str, source: ast.expr, tests: list[ast.expr]
    ) -> list[Any]:
        """Evaluate a list comprehension; its variable is local."""
        outer, values = self.names, []
        for each in iter(self.value(source)):
            self.names = ChainMap({name: each}, outer)  # type: ignore[arg-type]
            if all(self.value(test) for test in tests):
                values.append(self.value(element))
        self.names = outer
        return self.checked(values)  # type: ignore[no-any-return]


def _too_deep() -> NotAllowed:
    return NotAllowed("a deeper one", f"must be nested at most {_DEEPEST} deep")


def _refuse_object(value: object) -> NoReturn:
    kind = "a function" if callable(value) else f"a {type(value).__name__}"
    raise NotAllowed(kind, "must give plain data: numbers, texts, lists and dicts")


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
        raise ValueError(f"{base} ** {exponent} is not a real number")
    return power


def _shift(number: Any, by: Any) -> Any:
    if isinstance(by, int):
        _check_bits(by)
    return number << by


def _remainder(one: Any, other: Any) -> Any:
    if isinstance(one, str):
        raise NotAllowed("% of a text")
    return one % other


def _check_size(size: int) -> None:
    if size > _MOST:
        raise NotAllowed("more", f"must have texts and values of at most {_MOST} parts")


def _check_bits(bits: int) -> None:
    if bits > _BITS:
        raise NotAllowed("a larger one", f"must have integers of at most {_BITS} bits")


def _range(*ends: int) -> list[int]:
    numbers = range(*ends)
    if numbers:  # the length of one that is too long has no integer that len() may return
        _check_size(abs(numbers[-1] - numbers[0]) // abs(numbers.step) + 1)
    return list(numbers)


def _round(number: Any, digits: int | None = None) -> Any:
    if digits is not None:
        _check_bits(abs(digits))
    return round(number, digits)


def _replace(text: str, old: str, new: str) -> str:
    _check_size(len(text) + text.count(old) * len(new))
    return text.replace(old, new)


def _list_of(function: Callable[..., Any]) -> Callable[..., list[Any]]:
    """Wrap a function so that it returns a list instead of an iterator."""
    return lambda *values: list(function(*values))


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
    ast.LShift: _shift,
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
        "replace": _replace,
    },
    list: {"append": list.append, "index": list.index, "count": list.count},
    dict: {
        "get": dict.get,
        **{name: _list_of(getattr(dict, name)) for name in ("keys", "values", "items")},
    },
}
"""Methods called by public files; none returns more data than its arguments hold, or it checks the
size first."""

# Operators whose values grow faster than their arguments.
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
    "round": _round,
    "sum": lambda values: sum(values),  # noqa: PLW0108 - without a start
}

NAMES: Mapping[str, Any] = MappingProxyType(
    {
        **_PYTHON,
        **_MATH,
        "math": MappingProxyType(_MATH),
        "python": MappingProxyType(_PYTHON),
    }
)
"""Harmless names of xacro."""
