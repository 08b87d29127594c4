"""Expressions of untrusted xacro: ordinary ones are evaluated as in Python, others refused."""

import ast
import itertools
import math
import re
import time
from collections.abc import Iterator
from pathlib import Path
from types import MappingProxyType
from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import crawler2d as c2d
from crawler2d.reading.expressions import NAMES, NotAllowed, copy_data, evaluate
from tests.fuzz.standing_child import StandingChild
from tests.kept import refusing
from tests.reading.carts import FILES, ROBOTS, SAID, WHEELS, XACRO, quietly, read, urdf

pytestmark = pytest.mark.usefixtures("children_of_its_own")  # one that stands ready

HERE = Path(__file__).parent

# Published escapes from evaluated Python, and similar ones, one per line.
LISTED = (HERE / "hostile_expressions.txt").read_text(encoding="utf-8").splitlines()
OWNERS = ("()", "[]", "''", "(1)", "x", "l", "d", "d.a", "math", "math.pi", "max", "python.len")
ATTRIBUTES = (
    *("__class__", "__dict__", "__init__", "__self__", "__getattribute__", "__reduce_ex__(2)"),
    *(
        "__globals__",
        "__subclasses__()",
        "__loader__",
        "__\u217dlass__",
        "gi_frame",
        "f_back",
        "func",
    ),
    *("format('{0.__class__}')", "format_map", "mro()", "args", "keywords", "sort", "encode()"),
)
DEEP = [
    *("(" * n + "1" + ")" * n for n in (201, 900)),
    *("[" * n + "]" * n for n in (101, 199, 900)),
    *(sign * n + "1" for sign in ("-", "~", "not ") for n in (101, 400)),
    *("+".join("1" * n) for n in (150, 900)),
    *("x" + "[0]" * n for n in (101, 600)),
    *("l" + ".append" * n for n in (2, 101, 250)),
    *("max" + "()" * n for n in (2, 101, 900)),
    *("1 if 0 else " * n + "1" for n in (101, 150)),
    *("f'{" * n + "x" + "}'" * n for n in (1, 2, 300)),
    *("lambda:" * n + "1" for n in (1, 101, 250)),
    *("9**" * n + "9" for n in (2, 101, 600)),
    *("'a'" + "*99" * n for n in (3, 90, 400)),
    *("[a for a in " * n + "l" + "]" * n for n in (101, 150)),
    "x" * 2001,
    "1" * 5000,
    "0x" + "f" * 1900,
]
HOSTILE = [
    *(each for each in LISTED if each),
    *(f"{owner}.{name}" for owner, name in itertools.product(OWNERS, ATTRIBUTES)),
    *DEEP,
]


def names() -> dict[str, Any]:
    """Names of xacro, and a few properties."""
    space = MappingProxyType({"load_yaml": copy_data, "dotify": dict})
    return {**NAMES, "xacro": space, "x": "text", "l": [1], "d": {"a": 1}}


def test_there_are_hundreds_of_hostile_expressions() -> None:
    assert len(set(HOSTILE)) >= 500


@pytest.mark.parametrize(
    "text",
    [text for text in HOSTILE if not text.startswith("xacro.")],  # those need xacro
    ids=lambda text: text[:40].encode("unicode_escape"),
)
def test_a_hostile_expression_is_refused_at_once(text: str) -> None:
    start = time.process_time()
    with pytest.raises(Exception) as caught:  # noqa: PT011 - what Python raises for the same
        evaluate(text, names())
    assert time.process_time() - start < 1.0
    allowed = (NotAllowed, SyntaxError, ArithmeticError, LookupError, NameError, TypeError)
    assert isinstance(caught.value, (*allowed, ValueError)), caught.value


def test_an_expression_too_deep_for_the_parser_of_python_is_refused_for_its_depth() -> None:
    """CPython's parser raises MemoryError from a few thousand rules deep."""
    with pytest.raises(NotAllowed) as caught:
        evaluate("(" * 199 + "-" * 1500 + "1" + ")" * 199, names())
    assert caught.value.rule == "must be nested at most 100 deep"


@pytest.fixture(scope="module")
def standing() -> Iterator[StandingChild]:
    pytest.importorskip("xacrodoc")
    with StandingChild("crawler2d.reading.xacro") as child:
        yield child


KNOWN = """<xacro:arg name="e" default=""/><xacro:property name="x" value="text"/>
<xacro:property name="l" value="${[1]}"/><xacro:property name="d" value="${dict(a=1)}"/>"""


@pytest.mark.parametrize("every", [30, pytest.param(1, marks=pytest.mark.soak)])
def test_xacro_evaluates_no_hostile_expression(
    tmp_path: Path, standing: StandingChild, every: int
) -> None:
    """Each is built from an argument, so that its result appears only if it is really evaluated.

    Those that do not need xacro are tried without it above.
    """
    ours = [text for text in HOSTILE if text.startswith("xacro.")]
    others = [text for text in HOSTILE if text not in ours]
    already = standing.asked
    path = tmp_path / "cart.xacro"
    path.write_text(f'{XACRO}{KNOWN}<link name="${{$(arg e)}}"/></robot>')
    for text in (*ours, *others[::every]):
        start = time.perf_counter()
        with pytest.raises(c2d.ScenarioError) as caught:
            c2d.read_robot(path, arguments={"e": text})
        assert time.perf_counter() - start < 5.0, text
        error = caught.value
        assert re.match(r"cart\.xacro(:\d|$| )", error.path), (text, error)
        rules = "trusted=True allows it|xacro that expands|folder or|value for each argument"
        assert re.search(rules, error.rule)
        assert [each.name for each in tmp_path.iterdir()] == ["cart.xacro"], text
    assert standing.asked - already >= 500 / every


EVIL = "().__class__"
WHERE = {
    "an attribute": f'\n<link name="${{{EVIL}}}"/>',
    "a text": f"\n<link>${{{EVIL}}}</link>",
    "a condition": f'\n<xacro:if value="${{{EVIL}}}"/>',
    "a negated condition": f'\n<xacro:unless value="${{{EVIL}}}"/>',
    "a property": f'\n<xacro:property name="p" value="${{{EVIL}}}"/><link name="${{p}}"/>',
    "an eager property": f'\n<xacro:property name="p" value="${{{EVIL}}}" lazy_eval="false"/>',
    "a default": f'\n<xacro:property name="p" default="${{{EVIL}}}" scope="global"/>${{p}}',
    "a name of a property": f'\n<xacro:property name="${{{EVIL}}}" value="1"/>',
    "an argument": f'\n<xacro:arg name="a" default="${{{EVIL}}}"/>',
    "an include": f'\n<xacro:include filename="${{{EVIL}}}"/>',
    "a namespace": f'\n<xacro:include filename="a" ns="${{{EVIL}}}"/>',
    "a call": f'\n<xacro:call macro="${{{EVIL}}}"/>',
    "an element": f'\n<xacro:element xacro:name="${{{EVIL}}}"/>',
    "a made attribute": f'\n<a><xacro:attribute name="b" value="${{{EVIL}}}"/></a>',
    "a comment": f"\n<!-- xacro:eval-comments --><!-- ${{{EVIL}}} -->",
    "an escaped one": f'\n<link name="$${{{EVIL}}}"/>',
    "a body": '<xacro:macro name="m" params="p"><link name="${p}"/></xacro:macro>\n'
    f'<xacro:m p="${{{EVIL}}}"/>',
    "a default of a macro": f'<xacro:macro name="m" params="p:=${{{EVIL}}}">'
    '<link name="${p}"/></xacro:macro><xacro:m/>',
    "a block": '<xacro:macro name="m" params="*b"><xacro:insert_block name="b"/></xacro:macro>\n'
    f'<xacro:m><link name="${{{EVIL}}}"/></xacro:m>',
    "eval": '\n<link name="$(eval [].append)"/>',
    "eval of a text": "<xacro:property name=\"t\" value=\"${'().__cl' + 'ass__'}\"/>\n"
    '<link name="$(eval ${t})"/>',
    "a text that is made": '<xacro:arg name="t" default="__class__"/>\n'
    '<link name="${().$(arg t)}"/>',
}


@pytest.mark.parametrize("where", WHERE)
def test_an_expression_is_checked_wherever_xacro_evaluates_it(
    tmp_path: Path, standing: StandingChild, where: str
) -> None:
    with refusing(SAID, "trusted=True allows it"):
        read(tmp_path, f"{XACRO}{WHERE[where]}</robot>", "cart.xacro")
    assert standing.asked


def test_a_forbidden_expression_is_named_with_its_file_and_line(
    tmp_path: Path, standing: StandingChild
) -> None:
    macro = '<xacro:macro name="m" params="p">\n\n<link name="${p.__class__}"/></xacro:macro>'
    (tmp_path / "part.xacro").write_text(f"{XACRO}{macro}</robot>")
    text = f'{XACRO}\n<xacro:include filename="part.xacro"/><xacro:m p="a"/></robot>'
    with pytest.raises(c2d.ScenarioError) as caught:
        read(tmp_path, text, "cart.xacro")
    assert str(caught.value) == (
        "part.xacro:3: p.__class__ must have only plain data, operators and known functions, or be"
        " trusted, got .__class__: trusted=True allows it"
    )
    assert standing.asked


def test_a_trusted_file_may_evaluate_anything(tmp_path: Path, standing: StandingChild) -> None:
    text = urdf(WHEELS, mass="${[a + b for a in [4] for b in [4]][0]}")
    text = text.replace('<robot name="cart">', XACRO)
    with refusing(SAID, "trusted=True allows it"):
        read(tmp_path, text, "cart.xacro")
    assert read(tmp_path, text, "cart.xacro", trusted=True).robot.mass == 12.0
    assert standing.asked


def test_even_a_trusted_file_opens_no_file_to_write(
    tmp_path: Path, standing: StandingChild
) -> None:
    # Within a lambda: xacro itself looks for names that begin with __ outside of it alone.
    call = "(lambda: xacro.load_yaml.__globals__['__builtins__']['open']('new.txt', 'w'))()"
    text = f'{XACRO}\n<xacro:property name="p" value="${{{call}}}"/><link name="${{p}}"/></robot>'
    with refusing(SAID, r"must only be read: 'new\.txt'") as caught:
        read(tmp_path, text, "cart.xacro", trusted=True)
    assert (caught.value.path, caught.value.rule) == ("cart.xacro:2", "must be xacro that expands")
    assert not (tmp_path / "new.txt").exists()
    assert standing.asked


def test_most_of_xacro_needs_no_trust(tmp_path: Path, standing: StandingChild) -> None:
    """YAML with units, dotted, and its lists; arguments in $(eval); messages."""
    (tmp_path / "m.yaml").write_text("hull: {masses: [5, 3], angle: !degrees 180}\nm: 2\n")
    load = '<xacro:property name="c" value="${xacro.load_yaml(\'m.yaml\')}"/>'
    load += '<xacro:arg name="n" default="2"/><xacro:property name="n" value="$(eval n * 2)"/>'
    mass = "${sum(c.hull.masses) + c['m'] - n/2 + sin(c.hull.angle)*0 + len(xacro.message('a'))}"
    text = urdf(WHEELS, mass=mass).replace('<robot name="cart">', XACRO + load)
    assert read(tmp_path, text, "cart.xacro").robot.mass == 12.0
    assert standing.asked


@pytest.mark.parametrize("yaml", ["&a [*a]", "2020-01-01", "!!binary aGk=", "!!set {a}"])
def test_yaml_that_is_no_plain_data_is_refused(
    tmp_path: Path, standing: StandingChild, yaml: str
) -> None:
    (tmp_path / "m.yaml").write_text(f"m: {yaml}")
    text = f"{XACRO}\n<link name=\"${{xacro.load_yaml('m.yaml')['m']}}\"/></robot>"
    with refusing(SAID, "trusted=True allows it"):
        read(tmp_path, text, "cart.xacro")
    assert standing.asked


def test_the_environment_is_not_shown(tmp_path: Path, standing: StandingChild) -> None:
    """The default is used, as if the variable did not exist."""
    for text in ("$(env HOME)", "$(optenv HOME 8)", "$(optenv PATH)"):
        with refusing(SAID, "must not use environment variables, or"):
            read(tmp_path, f'{XACRO}<link name="{text}"/></robot>', "cart.xacro")
    text = urdf(WHEELS, mass="$(optenv NOBODY_HAS_THIS_VARIABLE 8)")
    text = text.replace('<robot name="cart">', XACRO)
    assert read(tmp_path, text, "cart.xacro").robot.mass == 12.0
    assert standing.asked


def test_the_models_of_the_tests_need_no_trust(standing: StandingChild) -> None:
    """The Engineer's needs what is missing left out, trusted or not."""
    for path in (FILES / "cart.xacro", ROBOTS / "eng.xacro"):
        how: dict[str, Any] = {"missing": "leave_out", "mesh": "leave_out"}
        by_default = quietly(path, **how)
        assert by_default.robot == quietly(path, trusted=True, **how).robot
    assert standing.asked


PUBLIC = [
    re.sub(r"\$\(arg [^)]*\)", "0.5", line)
    for line in (HERE / "public_expressions.txt").read_text(encoding="utf-8").splitlines()
    if not line.startswith("#")
]
LISTS: dict[str, list[Any]] = {"xacros": ["a", "b"], "payload_mass": [1.0]}


def python_of(text: str, known: dict[str, Any]) -> Any:
    """The result of an expression in xacro."""
    public = {name: value for name, value in {**NAMES, **known}.items() if name != "math"}
    return eval(text, {"__builtins__": {}, "math": math, **public})


@pytest.mark.parametrize("text", PUBLIC)
def test_an_expression_of_a_public_file_is_evaluated_as_by_python(text: str) -> None:
    used = {node.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Name)}

    def known() -> dict[str, Any]:
        numbers = {name: 2.5 + n for n, name in enumerate(sorted(used - set(NAMES)))}
        lists = {name: list(value) for name, value in LISTS.items()}
        texts = dict.fromkeys(("prefix", "color", "type", "name"), "rear")
        return {**numbers, **lists, **texts}

    assert evaluate(text, {**NAMES, **known()}) == python_of(text, known())


NUMBERS = st.one_of(st.integers(-50, 50), st.floats(-50, 50, allow_nan=False), st.booleans())
LEAVES = st.one_of(NUMBERS.map(lambda n: f"({n!r})"), st.sampled_from(["a", "pi", "l[1]", "d.k"]))


def grown(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    operators = ["+", "-", "*", "/", "//", "%", "<", "<=", "==", "!=", "and", "or"]
    functions = ["sin({})", "abs({})", "max({0}, {0})", "int({})", "-({})", "(not {})", "str({})"]
    return st.one_of(
        st.tuples(inner, st.sampled_from(operators), inner).map(lambda p: f"({' '.join(p)})"),
        st.tuples(st.sampled_from(functions), inner).map(lambda p: p[0].format(p[1])),
        st.tuples(inner, inner, inner).map(lambda p: "({} if {} else {})".format(*p)),
        st.lists(inner, max_size=3).map(lambda p: f"len([{', '.join(p)}])"),
    )


@settings(max_examples=300, deadline=None)
@given(st.recursive(LEAVES, grown, max_leaves=12))
def test_arithmetic_is_that_of_python(text: str) -> None:
    known = {"a": 3, "l": [1, 2.5], "d": {"k": 7}}
    expected: Any
    try:
        expected = python_of(text.replace("d.k", "d['k']"), known)
    except (ArithmeticError, TypeError, ValueError) as error:
        expected = type(error)
    try:
        found = evaluate(text, {**NAMES, **known})
    except (ArithmeticError, TypeError, ValueError) as error:
        found = type(error)
    except NotAllowed as error:
        found = error.found
        assume(found not in ("a larger one", "% of a text"))  # the result in Python
    assert found == expected
    assert type(found) is type(expected)


PIECES = st.one_of(
    st.sampled_from(["(", ")", "[", "]", ".", ",", " for a in ", " if ", " else ", "*", "**", "="]),
    st.sampled_from(["x", "l", "d", "a", "math", "max", "len", "range", "9", "99999", "'a'", "__"]),
    st.sampled_from([".append", ".replace", ".split", ".keys", "lambda ", "f'", "\\", "\n", "\0"]),
)


@settings(deadline=1000)
@given(st.lists(PIECES, max_size=40).map("".join))
def test_any_expression_gives_plain_data_or_an_error_quickly(text: str) -> None:
    try:
        found = evaluate(text, names())
    except (
        NotAllowed,
        SyntaxError,
        ArithmeticError,
        LookupError,
        NameError,
        TypeError,
        ValueError,
    ):
        return
    assert copy_data(found) == found
