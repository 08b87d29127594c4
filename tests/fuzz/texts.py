"""Invalid, odd and valid JSON texts: scenarios with changed values, keys and characters."""

import json
import math
import random
import struct
from collections.abc import Callable, Iterator
from typing import Any

# A tree of a text: an object is a list of its keys and values, so that a key can come twice; a leaf
# is its own text.


class Pairs(list[Any]):
    """An object of JSON: lists of a key and a value."""


Node = Any  # Pairs, list of nodes, or the text of a leaf

NUMBERS = (
    *("NaN", "Infinity", "-Infinity", '"NaN"', '"Infinity"', '"-Infinity"', "nan", "inf", "1e999"),
    *("1e-400", "-1e-400", "1e400", "-0", "-0.0", "0", "0.0", "-1", "1e308", "-1e308", "5e-324"),
    *("2.2250738585072014e-308", "2.225073858507201e-308", "1.7976931348623159e308", "1e-20"),
    *(str(2**n + d) for n in (31, 32, 53, 63, 64, 1024) for d in (-1, 0, 1)),
    *(str(-(2**63)), "9" * 5000, "0." + "0" * 400 + "1", "1" + "0" * 400 + "e-400", "2.5", "2.0"),
    *("1e2", "1E+2", "1e00000000000001", "1e99999999999999999999", "-1e-99999999999999999999"),
    *("01", "+1", ".5", "1.", "0x10", "1_000", "1e", "--1", "1 2", "1,2", "\uff11", "1e5.5", "-"),
)
OTHERS = (
    *("true", "false", "null", "True", "None", "undefined", "", " ", "[]", "{}", "[[]]", "[{}]"),
    *("[1,2]", "[1,2,3]", "[[1,2],[3]]", "[[0,0],[1,null]]", "[[[[0]]]]", '{"kind":"belt"}'),
    *('{"kind":"flat","length":1,"friction":1}', '{"kind":null}', '{"kind":["belt"]}', "'x'"),
    *('"12"', '""', '"\\u0000"', '"\\ud800"', '"\\udc00\\ud800"', '"\\ud83d\\ude00"', '"\\x00"'),
    *('"\u00e9\u2028\ufffe"', '"\x00"', '"\n"', '"\\', '"\\u12"', "/*x*/1", "1//x", "\ufeff1"),
    *(
        '"belt"',
        '"own"',
        '"BELT"',
        '"wheel"',
        '"../../etc"',
        '"%s%n"',
        '"robot.mass"',
        "[1,]",
        "{,}",
    ),
)
CHARACTERS = (*"{}[]\",:\\-+.eE0123456789 \t\n\r\x00\x1f\x7f'/", "\u00a0", "\u2028", "\ufeff")
ODD_CHARACTERS = ("\ud800", "\udfff", "\U0001f600", "\U0010ffff", "\u202e", "\u0301", "\x85", "nul")
WORDS = ("kind", "mass", "Mass", "", "unknown", "\\u006dass", "__class__", "robot.mass", "\\u0000")


def number(draw: random.Random) -> str:
    """A number of any magnitude, or any 64 bits as one."""
    if draw.random() < 0.3:
        bits = struct.unpack("<d", draw.randbytes(8))[0]
        return repr(bits).replace("nan", "NaN").replace("inf", "Infinity")
    sign = draw.choice(("", "-"))
    return sign + repr(math.exp(draw.uniform(-20.0, 20.0)))


def leaf(draw: random.Random) -> str:
    """Replacements of a value, valid JSON or not."""
    chance = draw.random()
    if chance < 0.4:
        return draw.choice(NUMBERS)
    if chance < 0.6:
        return number(draw)
    if chance < 0.9:
        return draw.choice(OTHERS)
    if chance < 0.95:
        return json.dumps("".join(chr(draw.randrange(0x110000)) for _ in range(draw.randrange(20))))
    size = int(10.0 ** draw.uniform(0.0, 4.7))
    long = ('"' + "x" * size + '"', "[" * size + "]" * size, "[" + "0," * size + "0]", "[" * size)
    nested = "{" + '"a":{' * min(size, 5000) + "}" * min(size, 5000) + "}"
    return draw.choice((*long, nested, "[" + "[0,0]," * (size // 5) + "[0,0]]", "1" * size))


def tree(text: str) -> Node:
    """Read a text that is JSON; leaves stay as they are written."""
    pairs = json.loads(text, parse_float=_Leaf, parse_int=_Leaf, object_pairs_hook=Pairs)
    return _leaves(pairs)


class _Leaf(str):
    __slots__ = ()


def _leaves(node: Any) -> Node:
    if isinstance(node, Pairs):
        return Pairs([json.dumps(key), _leaves(value)] for key, value in node)
    if isinstance(node, list):
        return [_leaves(value) for value in node]
    return str(node) if isinstance(node, _Leaf) else json.dumps(node)


def copied(node: Node) -> Node:
    if isinstance(node, Pairs):
        return Pairs([key, copied(value)] for key, value in node)
    return [copied(value) for value in node] if isinstance(node, list) else node


def written(node: Node) -> str:
    if isinstance(node, Pairs):
        return "{" + ",".join(f"{key}:{written(value)}" for key, value in node) + "}"
    if isinstance(node, list):
        return "[" + ",".join(map(written, node)) + "]"
    return str(node)


Place = tuple[list[Any], int]
"""A row of an object or a list, by its number: the value is the last of an object's row."""


def places(node: Node) -> Iterator[Place]:
    """Every value but the whole."""
    if isinstance(node, list):
        for index, row in enumerate(node):
            yield node, index
            yield from places(row[1] if isinstance(node, Pairs) else row)


def _get(place: Place) -> Node:
    rows, index = place
    return rows[index][1] if isinstance(rows, Pairs) else rows[index]


def _put(place: Place, value: Node) -> None:
    rows, index = place
    if isinstance(rows, Pairs):
        rows[index] = [rows[index][0], value]
    else:
        rows[index] = value


def _replace(draw: random.Random, place: Place, _: Node) -> None:
    _put(place, leaf(draw))


def _rescale(draw: random.Random, place: Place, _: Node) -> None:
    try:
        value = float(_get(place))
    except (TypeError, ValueError):
        return
    factor = draw.choice((-1.0, 0.5, 2.0, 1.0 + 2**-52, 10.0 ** draw.uniform(-3.0, 3.0)))
    _put(place, repr(value * factor))


def _delete(_: random.Random, place: Place, __: Node) -> None:
    del place[0][place[1]]


def _repeat(draw: random.Random, place: Place, _: Node) -> None:
    rows, index = place
    row = rows[index]
    if isinstance(rows, Pairs):
        again = [row[0], leaf(draw) if draw.random() < 0.5 else copied(row[1])]
        rows.insert(draw.randrange(len(rows) + 1), again)
    else:
        rows[index:index] = [copied(row) for _ in range(draw.choice((1, 2, 70, 3000)))]


def _add(draw: random.Random, place: Place, other: Node) -> None:
    rows, _ = place
    value = leaf(draw) if draw.random() < 0.5 else other
    key = f'"{draw.choice(WORDS)}"' if draw.random() < 0.9 else leaf(draw)
    rows.insert(draw.randrange(len(rows) + 1), [key, value] if isinstance(rows, Pairs) else value)


def _graft(_: random.Random, place: Place, other: Node) -> None:
    _put(place, other)


def _wrap(draw: random.Random, place: Place, _: Node) -> None:
    value = _get(place)
    _put(place, draw.choice(([value], Pairs([['"kind"', value]]), [value, value], [[value]])))


def _shuffle(draw: random.Random, place: Place, _: Node) -> None:
    draw.shuffle(place[0])


def _rename(draw: random.Random, place: Place, _: Node) -> None:
    rows, index = place
    if isinstance(rows, Pairs):
        key = rows[index][0]
        at = draw.randrange(len(key))
        odd = (
            key.upper(),
            key[:at] + draw.choice(CHARACTERS) + key[at:],
            f'"{draw.choice(WORDS)}"',
        )
        rows[index][0] = draw.choice(odd)


CHANGES: tuple[Callable[[random.Random, Place, Node], None], ...] = (
    *(_replace,) * 6,
    *(_rescale,) * 3,
    *(_delete, _repeat, _add, _graft, _graft, _wrap, _shuffle, _rename),
)


def _cut(draw: random.Random, text: str) -> str:
    """Change characters."""
    at, to = sorted(draw.randrange(len(text) + 1) for _ in range(2))
    character = draw.choice(CHARACTERS if draw.random() < 0.8 else ODD_CHARACTERS)
    return draw.choice(
        (
            *(text[:at], text[at:], text[:at] + text[at + 1 :], text[:at] + character + text[at:]),
            *(text[:at] + character + text[at + 1 :], text[:to] + text[at:], text + character),
            *(character + text, text.replace('"', "'"), text.replace(",", " ,\r\n\t"), text + text),
            *("[" * (to - at) + text, f"{text}{' ' * to}"),
        )
    )


def drawn_text(draw: random.Random, trees: list[Node]) -> str:
    """One of the texts, with one value or several changed, and perhaps its characters."""
    whole = copied(draw.choice(trees))
    for _ in range(draw.choice((0, 1, 1, 1, 2, 3))):
        found = list(places(whole))
        if not found:
            break
        other = copied(_get(draw.choice(list(places(draw.choice(trees))))))
        draw.choice(CHANGES)(draw, draw.choice(found), other)
    text = written(whole)
    return _cut(draw, text) if draw.random() < 0.25 else text
