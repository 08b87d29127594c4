"""An untrusted file takes neither much time nor memory, and its error names the line."""

import pickle
import re
import time
from pathlib import Path

import pytest

import crawler2d as c2d
from crawler2d.reading import parsing
from tests.kept import refusing
from tests.reading.carts import FILES, SAID, WHEELS, XACRO, quietly, read, urdf

own_child = pytest.mark.usefixtures("children_of_its_own")
"""For tests of the process itself; a fork of a standing one has the same limits."""

BOMB = """<!DOCTYPE robot [<!ENTITY a "aaaaaaaaaa">
<!ENTITY b "&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;">]>
<robot name="&b;"/>"""


def refused(folder: Path, text: str, rule: str, name: str = "cart.urdf") -> c2d.ScenarioError:
    start = time.perf_counter()
    with refusing(SAID, rule) as caught:
        read(folder, text, name)
    assert time.perf_counter() - start < 6.0
    return caught.value


@pytest.mark.parametrize("name", ["bomb.urdf", "bomb.sdf", "bomb.xml", "bomb.xacro"])
def test_an_entity_bomb_is_refused_at_its_first_line(tmp_path: Path, name: str) -> None:
    assert refused(tmp_path, BOMB, "must have no document type", name).path == f"{name}:1"


def test_an_external_entity_is_refused(tmp_path: Path) -> None:
    kind = '<!DOCTYPE r [<!ENTITY f SYSTEM "file:///etc/passwd">]>'
    text = f'<?xml version="1.0"?>\n{kind}\n{urdf("&f;")}'
    assert refused(tmp_path, text, "must have no document type").path == "cart.urdf:2"


def test_100_megabytes_are_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "big.urdf"
    with path.open("wb") as file:
        file.truncate(100_000_000)
    start = time.perf_counter()
    with refusing(SAID, "must have at most 4000000 bytes"):
        c2d.read_robot(path)
    assert time.perf_counter() - start < 0.5


def test_deep_nesting_is_refused(tmp_path: Path) -> None:
    refused(tmp_path, "<robot>" + "<a>" * 100_000, "must be nested at most 60 deep")


def test_900_thousand_elements_are_refused(tmp_path: Path) -> None:
    refused(tmp_path, f"<robot>{'<a/>' * 900_000}</robot>", "must have at most 50000 elements")


def test_ten_thousand_links_are_refused(tmp_path: Path) -> None:
    many = "".join(f'<link name="l{n}"/>' for n in range(10_000))
    refused(tmp_path, f"<robot>{many}</robot>", "must have at most 1000 links")


@pytest.mark.parametrize("name", ["many.urdf", "many.sdf"])
def test_ten_thousand_shapes_are_refused(tmp_path: Path, name: str) -> None:
    many = "<collision/>" * 10_000
    text = f'<robot><link name="a">{many}</link></robot>'
    if name == "many.sdf":
        text = f'<sdf version="1.7"><model name="m"><link name="a">{many}</link></model></sdf>'
    refused(tmp_path, text, "must have at most 3000 collision shapes", name)


def chain(count: int, last: str) -> str:
    links = "".join(f'<link name="l{n}"/>' for n in range(count))
    joints = "".join(
        f'<joint name="j{n}" type="fixed"><parent link="l{n}"/><child link="l{n + 1}"/></joint>'
        for n in range(count - 1)
    )
    return f"<robot>{links}{joints}{last}</robot>"


def test_a_chain_of_a_thousand_links_is_no_hang(tmp_path: Path) -> None:
    refused(tmp_path, chain(1000, ""), "must have wheels")


def test_links_in_a_circle_are_refused(tmp_path: Path) -> None:
    back = '<joint name="back" type="fixed"><parent link="l9"/><child link="l0"/></joint>'
    refused(
        tmp_path,
        chain(10, back),
        "must have one link that hangs on no other, got links in a circle",
    )


def test_links_in_a_circle_beside_the_robot_are_refused(tmp_path: Path) -> None:
    circle = '<link name="a"/><link name="b"/>' + "".join(
        f'<joint name="{p}{c}" type="fixed"><parent link="{p}"/><child link="{c}"/></joint>'
        for p, c in ("ab", "ba")
    )
    refused(tmp_path, chain(3, circle), "must hang on the root, not on itself in a circle, got a")


def test_frames_in_a_circle_are_refused(tmp_path: Path) -> None:
    frames = '<link name="a"><pose relative_to="f"/></link>'
    frames += '<frame name="f"><pose relative_to="a"/></frame>'
    text = f'<sdf version="1.7"><model name="m">{frames}</model></sdf>'
    refused(tmp_path, text, "must not be defined relative to itself", "m.sdf")


@pytest.mark.parametrize("count", [3, 300])
def test_a_joint_of_frames_in_a_row_joins_their_link_unless_they_are_in_a_circle(
    tmp_path: Path, count: int
) -> None:
    def framed(last: str) -> str:
        ends = [*(f"f{n}" for n in range(1, count)), last]
        frames = "".join(f'<frame name="f{n}" attached_to="{end}"/>' for n, end in enumerate(ends))
        text = (FILES / "cart.sdf").read_text(encoding="utf-8")
        assert "<child>left_rear</child>" in text
        text = text.replace("<child>left_rear</child>", "<child>f0</child>")
        return text.replace("</model>", f"{frames}</model>")

    assert (
        read(tmp_path, framed("left_rear"), "cart.sdf").robot == quietly(FILES / "cart.sdf").robot
    )
    rule = "must join links, not frames that are attached in a circle"
    refused(tmp_path, framed("f0"), rule, "cart.sdf")


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        (('name="left_front"', 'name="left_rear"'), "must be a name that no other link has"),
        (
            ('<parent link="hull"/>', '<parent link="bow"/>'),
            "must have a partner on the left",
        ),
        (('<child link="left_front"/>', '<child link="left_rear"/>'), "must be the only joint"),
        (("<robot", "<machine"), "must be well-formed XML"),
        (
            ('<mass value="8"/>', '<mass value="nan"/>'),
            "mass@value must be a finite number",
        ),
        (('<mass value="8"/>', '<mass value="1e999"/>'), "must be at most 1e"),
        (('<mass value="8"/>', '<mass value="-8"/>'), "must have a mass >= 0 kg"),
        (('<mass value="8"/>', '<mass value="heavy"/>'), "must be a finite number, got heavy"),
        (('<mass value="8"/>', '<mass value="1_0"/>'), "must be a finite number, got 1_0"),
        (('<mass value="8"/>', '<mass value="\u0661"/>'), "must be a finite number"),
        (('<mass value="8"/>', ""), r"must have an element <mass>"),
        (('<mass value="8"/>', '<mass value="8"/><mass value="9"/>'), "must be given once"),
        (('radius="0.08"', 'radius="0"'), "it may be a wheel or a track"),
        (('radius="0.08"', 'radius="-0.08"'), "must have sizes >= 0 m"),
        (('radius="0.08"', 'radius="-inf"'), "must be a finite number"),
        (('xyz="0.2 0.15 0.0"', 'xyz="0.2 0.15"'), "must be 3 numbers"),
        (('axis xyz="0 1 0"', 'axis xyz="0 0 0"'), "must have an axis with a direction"),
    ],
)
def test_what_breaks_a_rule_of_the_format_is_refused(
    tmp_path: Path, change: tuple[str, str], rule: str
) -> None:
    text = urdf(WHEELS)
    assert change[0] in text
    error = refused(tmp_path, text.replace(*change, 1), rule)
    assert error.path.startswith("cart.urdf:")
    assert str(pickle.loads(pickle.dumps(error))) == str(error)


@pytest.mark.parametrize(
    ("data", "rule"),
    [
        (b"", "must be well-formed XML"),
        (b"\x00\xff\xfe", "must be well-formed XML"),
        (b'<?xml version="1.0" encoding="klingon"?><robot/>', "must be"),
        (b"<robot/><robot/>", "must be well-formed XML"),
        (b"<html/>", "must be <sdf>, <robot> or <mujoco>"),
    ],
)
def test_what_is_no_model_at_all_is_refused(tmp_path: Path, data: bytes, rule: str) -> None:
    path = tmp_path / "m.urdf"
    path.write_bytes(data)
    with refusing(SAID, rule):
        c2d.read_robot(path)


LONG_NAME = "x" * 5000


@pytest.mark.parametrize(
    "path",
    ["", "nowhere.sdf", "a\0b.sdf", LONG_NAME, f"{LONG_NAME}/a.sdf", None, 7, b"a.sdf"],
)
def test_a_path_that_is_no_file_is_refused(path: object) -> None:
    with refusing(SAID) as caught:
        c2d.read_robot(path)  # type: ignore[arg-type]
    assert caught.value.path == "path"


def test_the_text_of_a_model_is_refused_as_a_path() -> None:
    """As ROS has it in the parameter robot_description."""
    with refusing(SAID, r"must be a path, got .*; write the text of a model to a file$"):
        c2d.read_robot(urdf(WHEELS))


def test_a_line_is_that_of_an_editor_whatever_ends_lines_within_it(tmp_path: Path) -> None:
    text = "<!-- a\rb\rc -->\n" + urdf(WHEELS).replace('<mass value="8"/>', '\n<mass value="x"/>')
    assert refused(tmp_path, text, "must be a finite number").path.startswith("cart.urdf:3:")


@own_child
def test_a_child_that_does_not_answer_in_time_is_given_up(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(parsing, "_PATIENCE", 0.01)  # [s] Python does not start within.
    error = refused(tmp_path, f"{XACRO}</robot>", r"must be parsed within 0\.01 s", "cart.xacro")
    assert (error.path, error.value) == ("cart.xacro", "no answer")


@own_child
def test_xacro_that_takes_all_time_or_memory_is_ended(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    loop = "${max([a*b for a in range(10**5) for b in range(10**5)])}"
    text = urdf(WHEELS, mass=loop).replace(
        "<robot", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"'
    )
    path = tmp_path / "loop.xacro"
    path.write_text(text)
    with refusing(SAID, r"loop\.xacro(:1)? must be"):
        c2d.read_robot(path, trusted=True)


ENDLESS = {
    "an include of itself": '<xacro:include filename="cart.xacro"/>',
    "includes of each other": '<xacro:include filename="a.xacro"/>',
    "a macro before its definition": '<xacro:a/><xacro:macro name="a"><xacro:a/></xacro:macro>',
    "macros of each other": '<xacro:a/><xacro:macro name="a"><xacro:b/></xacro:macro>'
    '<xacro:macro name="b"><xacro:a/></xacro:macro>',
    "calls without a prefix": '<xacro:macro name="a"><b/></xacro:macro><xacro:macro name="b"><a/>'
    "</xacro:macro><xacro:property name='p' value='${p}'/><a/>${p}",
    "arguments of arguments": '<xacro:arg name="a" default="$(arg b)"/><x y="$(arg a)$(arg c)"/>',
    "a property of itself": '<property name="a" value="${a}"/><x y="${a}"/>',
    "40,000 unknown macros": "<xacro:a/>" * 40_000 + "${lost}",
    "20,000 unknown arguments": "".join(f"$(arg a{n})" for n in range(20_000)),
}


LONG = {"20,000 unknown arguments"}


@pytest.mark.parametrize(
    "what", [pytest.param(n, marks=pytest.mark.soak if n in LONG else ()) for n in ENDLESS]
)
def test_xacro_that_goes_round_without_an_end_is_refused(tmp_path: Path, what: str) -> None:
    pytest.importorskip("xacrodoc")
    for name, other in ("ab", "ba"):
        include = f'<xacro:include filename="{other}.xacro"/>'
        (tmp_path / f"{name}.xacro").write_text(f"{XACRO}{include}</robot>")
    text = urdf(WHEELS, ENDLESS[what]).replace('<robot name="cart">', XACRO)
    start = time.process_time()
    with refusing(SAID, r"must be (xacro|parsed)|must have a value"):
        read(tmp_path, text, "cart.xacro")
    assert time.process_time() - start < 6.0


def test_a_thousand_files_of_settings_cost_little(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    for number in range(1000):
        (tmp_path / f"{number:04}.yaml").write_text("a: 1\n" * 10_000)
    text = urdf(WHEELS, mass="$(arg hull)").replace('<robot name="cart">', XACRO)
    with refusing(SAID, "must have a value for each argument"):
        read(tmp_path, text, "cart.xacro")


@own_child
def test_a_folder_of_the_model_is_not_on_the_path_of_the_child(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    (tmp_path / "mujoco.py").write_text("raise SystemExit('imported what lies beside a model')")
    with refusing(SAID, "must have one body with a free joint"):
        read(tmp_path, "<mujoco><worldbody/></mujoco>", "m.xml")


@pytest.mark.parametrize(
    ("change", "rule"),
    [
        (('pos="0.25 0.25 0"', 'pos="1e300 0.25 0"'), "must be finite and at most 1e"),
        (('pos="0.25 0.25 0"', 'pos="0.25 0.25 0" quat="1 1e300 0 0"'), "must be a rotation"),
    ],
)
def test_numbers_that_no_robot_has_are_refused_in_mjcf(
    tmp_path: Path, change: tuple[str, str], rule: str
) -> None:
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text()
    assert change[0] in text
    error = refused(tmp_path, text.replace(*change, 1), rule, "cart.xml")
    assert re.match(r"cart\.xml:\d+: bodies", error.path)
