"""Each operator, method and function of a xacro expression by itself, and the size of values."""

import math
from typing import Any

import pytest

from crawler2d.reading.expressions import NAMES, NotAllowed, copy_data, evaluate


def known() -> dict[str, Any]:
    return {"x": -2.5, "n": 6, "t": " a,b ", "l": [3, 1, 2], "d": {"k": 7, "m": [1]}}


LIKE_PYTHON = [
    *("+n", "-x", "not n", "not 0", "~n", "n + 1", "n - 1", "n * 2", "n / 4", "n // 4", "n % 4"),
    *("n ** 3", "n ** -1", "2 ** 0.5", "n << 2", "n >> 1", "n & 3", "n | 9", "n ^ 3", "x % 2"),
    *("t + 'c'", "'ab' * 3", "3 * 'ab'", "l * 2", "l + [4]", "(1, 2) + (3,)", "[1] * 0"),
    *("n == 6", "n != 6", "n < 6", "n <= 6", "n > 6", "n >= 6", "n is None", "n is not None"),
    *("3 in l", "4 in l", "3 not in l", "4 not in l", "'k' in d", "1 < 2 < 3", "1 < 3 < 2"),
    *("3 > 2 > 1 > 5", "0 and n", "n and 0", "0 or n", "n or 0", "0 or '' or []", "1 and 2 and 3"),
    *("1 if n else 2", "1 if 0 else 2", "l[0]", "l[-1]", "l[1:]", "l[:1]", "l[::2]", "t[1]"),
    *("d['k']", "(1, 2)", "()", "[]", "{}", "{'a': 1, 2: 'b'}", "[i * 2 for i in l if i > 1]"),
    *("[i for i in l if i > 1 if i < 3]", "[i for i in d]", "t.strip()", "t.lstrip()"),
    *("t.rstrip()", "t.split(',')", "t.split()", "'aB'.lower()", "'aB'.upper()"),
    *("t.startswith(' ')", "t.endswith('b')", "t.replace('a', 'cc')", "l.index(2)", "l.count(3)"),
    *("d.get('k')", "d.get('z', 5)", "list(d.keys())", "list(d.values())", "list(d.items())"),
    *("list(enumerate(l))", "list(reversed(l))", "list(zip(l, l))", "list(range(3))"),
    *("list(range(1, 8, 3))", "list(range(8, 1, -3))", "list(range(0))", "round(x)"),
    *(
        "round(2.567, 1)",
        "sum(l)",
        "abs(x)",
        "bool(n)",
        "float(n)",
        "int(2.9)",
        "len(l)",
        "ord('a')",
    ),
    *("repr(t)", "str(n)", "tuple(l)", "all(l)", "any([0])", "dict(a=1, b=2)", "divmod(7, 4)"),
    *(
        "max(l)",
        "min(l)",
        "max(1, 2)",
        "sorted(l)",
        "pi",
        "e",
        "sin(x)",
        "math.cos(x)",
        "atan2(1, x)",
    ),
]


@pytest.mark.parametrize("text", LIKE_PYTHON)
def test_an_expression_is_what_python_makes_of_it(text: str) -> None:
    expected = eval(text, {"math": math, **vars(math), **known()})
    found = evaluate(text, {**NAMES, **known()})
    assert (found, type(found)) == (expected, type(expected))


def test_a_dotted_name_is_a_key_before_it_is_a_method() -> None:
    assert evaluate("d.k", {"d": {"k": 7}}) == 7
    assert evaluate("d.get", {"d": {"get": 7}}) == 7
    assert evaluate("python.len(d.m) + math.floor(2.5)", {**NAMES, **known()}) == 3


def test_a_name_of_a_comprehension_is_known_inside_it_alone() -> None:
    assert evaluate("[[i for i in [1]], [n for n in l], n]", known()) == [[1], [3, 1, 2], 6]
    with pytest.raises(NameError, match=r"^name 'i' is not defined$"):
        evaluate("[[i for i in [1]], i]", known())


PLAIN = "must have only plain data, operators and known functions"
DATA = "must give plain data: numbers, texts, lists and dicts"
PARTS = "must have texts and values of at most 100000 parts"
BITS = "must have integers of at most 400 bits"


@pytest.mark.parametrize(
    ("text", "found", "rule"),
    [
        ("__import__", "__import__", PLAIN),
        ("t.__class__", ".__class__", PLAIN),
        ("t.title()", ".title", PLAIN),
        ("d.pop('k')", ".pop", PLAIN),
        ("l.sort()", ".sort", PLAIN),
        ("lambda: 1", "lambda: 1", PLAIN),
        ("{i for i in l}", "{i for i in l}", PLAIN),
        ("max(l, key=n)", "key=", PLAIN),
        ("dict(**d)", "**=", PLAIN),
        ("n @ n", "n @ n", PLAIN),
        ("len", "a function", DATA),
        ("[len]", "a function", DATA),
        ("math", "a mappingproxy", DATA),
        ("math()", "a mappingproxy", DATA),
        ("'%s' % n", "% of a text", PLAIN),
        ("'a' * 100001", "more", PARTS),
        ("100001 * [1]", "more", PARTS),
        ("range(100001)", "more", PARTS),
        ("t.replace('', 'a' * 30000)", "more", PARTS),
        ("2 ** 400", "a larger one", BITS),
        ("1 << 401", "a larger one", BITS),
        ("round(1.5, 401)", "a larger one", BITS),
        ("-" * 101 + "1", "a deeper one", "must be nested at most 100 deep"),
        ("1 " * 1001, "2002 characters", "must have at most 2000 characters"),
        (
            "[[1 for j in range(900)] for i in range(900)]",
            "more",
            "must be evaluated in 200000 steps",
        ),
    ],
)
def test_a_forbidden_expression_is_named_with_its_rule(text: str, found: str, rule: str) -> None:
    with pytest.raises(NotAllowed) as caught:
        evaluate(text, {**NAMES, **known()})
    assert (caught.value.found, caught.value.rule) == (found, rule)
    assert caught.value.expression == text


@pytest.mark.parametrize(
    "text",
    [
        *("'a' * 100000", "[1] * 90000", "range(90000)", "2 ** 199", "1 << 399", "round(1.5, 300)"),
        *("-" * 98 + "1", "1" + " " * 1999),
    ],
)
def test_expressions_just_below_a_limit_are_evaluated(text: str) -> None:
    evaluate(text, {**NAMES, **known()})


def test_a_value_has_a_hundred_thousand_parts_at_most_and_counts_as_one() -> None:
    assert len(evaluate("l", {"l": [1] * 99_999})) == 99_999
    with pytest.raises(NotAllowed, match="at most 100000 parts"):
        evaluate("l", {"l": [1] * 100_000})


@pytest.mark.parametrize("name", ["factorial", "comb", "perm", "prod"])
def test_a_function_whose_values_grow_without_bound_has_no_name(name: str) -> None:
    with pytest.raises(NameError, match=f"name '{name}' is not defined"):
        evaluate(f"{name}([2, 3])", NAMES)


def test_numbers_that_are_not_real_and_calls_of_no_function_are_errors() -> None:
    with pytest.raises(ValueError, match=r"^-2.5 \*\* 0.5 is not a real number$"):
        evaluate("x ** 0.5", known())
    with pytest.raises(TypeError, match=r"^n is not a function$"):
        evaluate("n(1)", known())
    with pytest.raises(TypeError, match=r"^l\[0\] is not a function$"):
        evaluate("l[0]()", known())


def test_data_of_any_class_is_copied_as_plain_data() -> None:
    class Dotted(dict[str, Any]):
        pass

    given = Dotted(a=[Dotted(b=(1, 2))], c=None)
    found = copy_data(given)
    assert found == {"a": [{"b": (1, 2)}], "c": None}
    assert type(found) is type(found["a"][0]) is dict
    deep: list[Any] = []
    for _ in range(101):
        deep = [deep]
    with pytest.raises(NotAllowed, match="nested at most 100 deep"):
        copy_data(deep)
    assert copy_data(deep[0]) == deep[0]
