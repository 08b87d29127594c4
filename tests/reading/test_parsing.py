"""How elements, attributes and numbers of a model file are read and refused, word for word."""

import math
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.reading.files import Files
from crawler2d.reading.parsing import Element, _exit_name, ask_child, parse_xml, real


def element(text: str) -> Element:
    return parse_xml(text.encode(), "m.sdf")


def said_by(call: object, *arguments: object, **keywords: object) -> str:
    assert callable(call)
    with pytest.raises(c2d.ScenarioError) as caught:
        call(*arguments, **keywords)
    return str(caught.value)


A = element("<a>\n<b name='n' c='1 2'>3</b><d/><d/><e><f/></e></a>")
B = A.children[0]


def test_a_number_is_finite_and_at_most_a_million() -> None:
    for word in ("1e6", "-1e6", " .5 ", "+3.", "-0"):
        assert real(B, word) == float(word)
    for word in ("inf", "nan", "0x1", "1_0", "1e", "1 2", "\u0663", "1" * 61):
        said = said_by(real, B, word)
        assert said == f"m.sdf:2: a/b[n] must be a finite number, got {word}"
    assert real(B, f"{'0' * 59}1") == 1.0
    assert said_by(real, B, "1000001", "@c") == (
        "m.sdf:2: a/b[n]@c must be at most 1e+06 in magnitude, got 1000001"
    )


def test_a_limit_may_be_infinite_and_is_beyond_a_million() -> None:
    for word in ("inf", "Infinity", "+INF", "1e16", "1000001"):
        assert real(B, word, unlimited=True) == math.inf
        assert real(B, f"-{word.lstrip('+')}", unlimited=True) == -math.inf
    assert real(B, "1e6", unlimited=True) == 1e6
    assert "must be a finite number" in said_by(real, B, "nan", unlimited=True)
    assert "must be a finite number" in said_by(real, B, "infinite", unlimited=True)


@pytest.mark.parametrize(("text", "longest"), [("20", 120), ("0 1 2", 240)])
def test_a_text_of_numbers_is_as_long_as_one_more_of_them_at_most(text: str, longest: int) -> None:
    """Each has sixty letters at most; a longer text is not taken apart."""
    count = len(text.split())
    assert len(element(f"<a c='{text.ljust(longest)}'/>").reals(count, "c")) == count
    too_long = element(f"<a c='{text.ljust(longest + 1)}'/>")
    assert "must be" in said_by(too_long.reals, count, "c")


def test_a_text_or_an_attribute_has_the_required_count_of_numbers() -> None:
    assert B.reals(1) == [3.0]
    assert B.reals(2, "c") == [1.0, 2.0]
    assert said_by(B.reals, 1, "c") == "m.sdf:2: a/b[n]@c must be a number, got 1 2"
    assert said_by(B.reals, 2) == "m.sdf:2: a/b[n] must be 2 numbers, got 3"
    assert said_by(B.reals, 1, "z") == "m.sdf:2: a/b[n]@z must be a number, got "


def test_a_child_is_the_only_one_of_its_path() -> None:
    assert A.only("b") is B
    found = A.only("e/f")
    assert found is not None
    assert found.path == "a/e/f"
    assert A.only("b/f") is None
    assert said_by(A.only, "d") == "m.sdf:2: a/d must be given once, got 2 of them"
    assert said_by(A.needed, "e/g") == "m.sdf:1: a must have an element <e/g>, got none"
    assert said_by(B.attribute, "z") == "m.sdf:2: a/b[n] must have an attribute z, got none"
    assert (A.real("b"), A.real("z", 7.0)) == (3.0, 7.0)
    assert said_by(A.real, "z") == "m.sdf:1: a must have an element <z>, got none"


def test_everything_in_an_element_comes_in_the_order_of_the_file() -> None:
    assert [each.tag for each in A.within()] == ["a", "b", "d", "d", "e", "f"]


def test_long_names_are_cut_in_a_path() -> None:
    long = element(f"<{'t' * 41} name='{'n' * 41}'/>")
    assert long.path == f"{'t' * 40}[{'n' * 40}]"


def test_lines_are_counted_as_in_editors() -> None:
    root = element("<a>\r\n<b/>\r<c/>\n\n<d/></a>")
    assert [each.where.line for each in root.within()] == [1, 2, 2, 4]


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("<a>" * 60 + "</a>" * 60, ""),
        ("<a>" * 61 + "</a>" * 61, "m.sdf:1 must be nested at most 60 deep, got 61"),
        (f"<a>{'<b/>' * 49_999}</a>", ""),
        (f"<a>{'<b/>' * 50_000}</a>", "m.sdf:1 must have at most 50000 elements, got 50001"),
        ("<a>\n</b>", "m.sdf:2 must be well-formed XML, got mismatched tag"),
        ("", "m.sdf:1 must be well-formed XML, got no element found"),
        ("\n<!DOCTYPE x><a/>", "m.sdf:2 must have no document type, got 'x'"),
        ("<?xml version='1.0' encoding='klingon'?><a/>", "m.sdf must be in a known encoding"),
    ],
    ids=["deep", "deeper", "many", "more", "broken", "empty", "type", "encoding"],
)
def test_a_file_is_xml_of_a_limited_size(text: str, rule: str) -> None:
    if not rule:
        assert element(text).tag == "a"
    else:
        assert said_by(element, text).startswith(rule)


def test_the_end_of_a_child_is_named_by_its_signal_or_its_status() -> None:
    ends = {0: "status 0", 3: "status 3", -9: "SIGKILL", -27: "SIGPROF", -200: "signal 200"}
    assert {status: _exit_name(status) for status in ends} == ends


def test_a_parser_that_cannot_start_is_not_blamed_on_the_limits(tmp_path: Path) -> None:
    files = Files(tmp_path / "cart.xacro", packages={})
    said = said_by(ask_child, "no_such_parser", {}, file="cart.xacro", files=files)
    assert said == (
        "cart.xacro must be parsed by no_such_parser, which failed,"
        " got No module named no_such_parser"
    )
