"""Scenarios with odd objects in their fields: numbers and arrays of all kinds, anything."""

import array
import dataclasses
import datetime
import decimal
import enum
import fractions
import random
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.scenario import Scenario
from tests.fuzz import texts as fuzz_texts


class Refuses:
    """Fails in every operation."""

    def _refuse(self, *_: object, **__: object) -> Any:
        raise RuntimeError("not me")

    __float__ = __int__ = __index__ = __len__ = __getitem__ = __iter__ = __bool__ = _refuse
    __str__ = __repr__ = __array__ = __eq__ = __ne__ = __lt__ = __le__ = __hash__ = _refuse
    __reduce__ = __format__ = _refuse


class Mine(float):
    """A subclass of float."""


class Whole(enum.IntEnum):
    FOUR = 4


class Name(str):
    __slots__ = ()


def _endless() -> list[Any]:
    inside: list[Any] = []
    inside.append(inside)
    return inside


def _number(draw: random.Random) -> float:
    return float(fuzz_texts.number(draw))


DTYPES = (
    *("f2", "f4", "f8", "g", ">f8", ">f4", "i1", "u1", "i2", "u4", "i8", "u8", ">i4", "?", "c8"),
    *("c16", "U3", "S3", "O", "M8[s]", "m8[ns]", "V4", "f8,f8"),
)
SHAPES = (
    (),
    (0,),
    (1,),
    (2,),
    (3,),
    (0, 2),
    (1, 2),
    (2, 2),
    (4, 2),
    (4, 3),
    (2, 1),
    (2, 0),
    (1, 1, 2),
)


def _array(draw: random.Random) -> Any:
    """An array of an odd type, shape or layout, its numbers small or any."""
    dtype, shape = np.dtype(draw.choice(DTYPES)), draw.choice(SHAPES)
    with np.errstate(all="ignore"):
        if dtype.kind in "OUSmMV":
            made = np.zeros(shape, dtype)
        elif draw.random() < 0.5 and dtype.kind in "iuf":
            # Any bits, but of the padding of a long double.
            size = int(np.prod(shape)) * 8
            made = np.frombuffer(draw.randbytes(size), "f8").reshape(shape).astype(dtype)
        else:
            made = np.arange(np.prod(shape), dtype="f8").reshape(shape).astype(dtype)
    views: tuple[Callable[[Any], Any], ...] = (
        *(lambda a: a, np.asfortranarray, lambda a: a[..., ::-1], lambda a: a.T),
        *(lambda a: np.ma.array(a, mask=True), np.ma.array, lambda a: a.tolist()),
        lambda a: np.repeat(a, 40, axis=0) if a.ndim else a,
    )
    chosen = views[draw.choice((0, 0, 0, 1, 2, 3, 4, 5, 6, 7))]
    return chosen(made) if made.ndim else made


def _scalar(draw: random.Random) -> Any:
    kinds = (np.float16, np.float32, np.float64, np.longdouble, np.complex128, Mine, np.array)
    whole = (np.int8, np.uint8, np.int64, np.uint64, np.bool_, np.str_, Whole)
    with np.errstate(all="ignore"):
        if draw.random() < 0.6:
            return draw.choice(kinds)(_number(draw))
        return draw.choice(whole)(4)


def _rows(draw: random.Random) -> Any:
    """Points, most of them in order, or nearly points."""
    columns, count = draw.choice((1, 2, 2, 2, 3, 3, 4)), draw.choice((0, 1, 2, 3, 4, 60, 70, 500))
    rows: list[Any] = [
        [float(i), *(draw.uniform(-1, 1) for _ in range(columns - 1))] for i in range(count)
    ]
    for _ in range(draw.choice((0, 0, 1, 2))):
        if rows:
            index = draw.randrange(len(rows))
            doubled = [*rows[index], *rows[index]] if isinstance(rows[index], list) else rows[index]
            number = _number(draw)
            rows[index] = draw.choice((None, [], [0.0], "ab", doubled, [None, 1], [number, 2]))
    return draw.choice(
        (rows, tuple(map(tuple, [r for r in rows if isinstance(r, list)])), iter(rows))
    )


def _anything(draw: random.Random, other: Any) -> Any:
    things: tuple[Callable[[], Any], ...] = (
        *(object, Refuses, _endless, dict, set, list, tuple, str, bytes, bytearray),
        *(lambda: None, lambda: True, lambda: False, lambda: ..., lambda: NotImplemented),
        *(lambda: Refuses, lambda: len, lambda: Scenario, lambda: Parameters, lambda: np.float64),
        *(lambda: 1j, lambda: 2**53 + 1, lambda: 2**63, lambda: -(2**64), lambda: 10**400),
        *(lambda: 10**5000, lambda: -(10**5000), lambda: np.ma.masked, lambda: {"kind": "belt"}),
        *(lambda: decimal.Decimal("0.3"), lambda: fractions.Fraction(1, 3), lambda: range(4)),
        *(
            lambda: datetime.timedelta(1),
            lambda: np.datetime64("nat"),
            lambda: array.array("d", [1, 2]),
        ),
        *(lambda: memoryview(b"12"), lambda: (i for i in range(2)), lambda: ValueError("x")),
        *(lambda: np.float64, lambda: [Refuses()], lambda: [[Refuses(), 1.0]], lambda: {1: 2}),
        *(
            lambda: "belt",
            lambda: Name("own"),
            lambda: "\ud800",
            lambda: "\x00",
            lambda: "x" * 10**5,
        ),
        *(lambda: "\udfff" * 10**4, lambda: "\U0001f600" * 999, lambda: "own\n", lambda: b"own"),
        *(c2d.BeltTrack, c2d.RoundWheel, lambda: other),
        *(lambda: [other], lambda: type(other)),
    )
    return draw.choice(things)()


def odd(draw: random.Random, other: Any) -> Any:
    """A value for a field: something drawn, or `other`, the value of another field."""
    chance = draw.random()
    if chance < 0.3:
        return _number(draw)
    if chance < 0.4:
        return draw.choice((0, 0.0, -0.0, 1, -1, 2.5, 200, 201, 1e-20, 1e308, 5e-324, float("nan")))
    if chance < 0.5:
        return _scalar(draw)
    if chance < 0.65:
        return _array(draw)
    if chance < 0.75:
        return _rows(draw)
    return other if chance < 0.85 else _anything(draw, other)


def fields(node: Any, names: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield every field of a tree of parameters with the names that lead to it."""
    if isinstance(node, Parameters):
        for field in dataclasses.fields(node):  # type: ignore[arg-type]
            value = getattr(node, field.name)
            yield (*names, field.name), value
            yield from fields(value, (*names, field.name))


def changed(node: Any, names: tuple[str, ...], value: Any) -> Any:
    """Call the constructors again, with another value at a place."""
    name, *rest = names
    given = {field.name: getattr(node, field.name) for field in dataclasses.fields(node)}
    given[name] = changed(given[name], tuple(rest), value) if rest else value
    return type(node)(**given)


def drawn_object(draw: random.Random, bases: list[Scenario]) -> Scenario:
    """A scenario, or the errors of its constructors for odd values in one or several fields."""
    whole = draw.choice(bases)
    for _ in range(draw.choice((1, 1, 1, 2, 3))):
        names, _value = draw.choice(list(fields(whole)))
        others = [value for _, value in fields(draw.choice(bases))]
        value = odd(draw, draw.choice(others))
        if draw.random() < 0.5:
            whole = changed(whole, names, value)
        else:
            whole = whole.replace({".".join(names): value})
        if not isinstance(whole.robot, c2d.Robot):
            break  # nothing is left to change
    return whole
