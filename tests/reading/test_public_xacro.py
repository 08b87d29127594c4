"""Untrusted xacro expands by default; missing files are left out, with a warning."""

import os
import re
import shutil
import sys
import tempfile
import time
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.reading.files import VARIABLES, Files
from crawler2d.reading.log import ReadingWarning
from crawler2d.reading.parsing import parse_xml
from crawler2d.reading.xacro import expand_xacro
from tests.kept import refusing
from tests.reading.carts import SAID, WHEELS, XACRO, collision, quietly, read, refused, urdf
from tests.robots.tree_keys import Key, keys

pytest.importorskip("xacrodoc")
OLD = '<robot name="cart" xmlns:xacro="http://ros.org/wiki/xacro">'
NO_PACKAGE = r"is left out: the file must be in a package that is found in .*: packages="
NO_MACRO = (
    "is left out with its content: no file defines this macro; what is included at"
    " sekirei2020_gazebo.urdf.xacro:6 and sekirei2020_gazebo.urdf.xacro:7 was left out, too"
)
TAKEN = r"is taken to be .*/robots/marv/urdf/{}: no package has that name$"
NO_DEFAULT = "is taken for the argument {}, which has no default: arguments= sets it$"

WARNED: dict[str, list[tuple[str, str, str]]] = {
    "marv": [
        ("marv.xacro:157", "$(find marv_description)/urdf/utils.xacro", TAKEN),
        ("marv.xacro:779", "$(find marv_description)/urdf/lights.xacro", TAKEN),
        ("common.yaml:11", "0.065", NO_DEFAULT.format("rover_topBoxX")),
        ("common.yaml:43", "False", NO_DEFAULT.format("has_boson_thermocam")),
        (
            "common.yaml",
            "rover_bodyLength: 0.6050 for 0.6000, ",
            "is used with all its settings, also",
        ),
    ],
    "maxii": [],
    "myzharbot": [
        (
            "myzharbot.urdf.xacro:13",
            "<property>",
            "is read as an element of xacro without its prefix, and so are 16 more elements of the"
            " file",
        )
    ],
    "sekirei2020": [],
    "sekirei2020_gazebo": [
        (
            "sekirei2020_gazebo.urdf.xacro:6",
            "$(find gazebo_continuous_track)/",
            NO_PACKAGE,
        ),
        (
            "sekirei2020_gazebo.urdf.xacro:7",
            "$(find gazebo_continuous_track)/",
            NO_PACKAGE,
        ),
        *(
            (f"sekirei2020_gazebo.urdf.xacro:{line}", f"<xacro:{macro}>", NO_MACRO)
            for line, macro in (
                *((line, "make_track") for line in (119, 124)),
                *((line, "make_track_simple") for line in (129, 134, 139, 144)),
            )
        ),
    ],
    "tank": [("tank.urdf.xacro:6", "", r"is left out: the file .*\(No such file or directory\)$")],
    "tractor": [],
}
"""By main file the path, the beginning of the value and the reason of each warning."""

LINKS = {
    "marv": 42,
    "maxii": 0,
    "myzharbot": 18,
    "sekirei2020": 19,
    "sekirei2020_gazebo": 21,
    "tank": 10,
    "tractor": 23,
}


@pytest.fixture(autouse=True)
def _no_packages_of_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in VARIABLES:
        monkeypatch.delenv(variable, raising=False)


def expand(path: Path, **how: Any) -> tuple[str, list[ReadingWarning]]:
    """Expand a file as `read_robot` does by default."""
    data = path.read_bytes()
    usual: dict[str, Any] = {"trusted": False, "arguments": {}, "leave_out": True}
    files = Files(path, how.pop("packages", {}))
    text, warned = expand_xacro(files, data, path.name, **{**usual, **how})
    return text.decode(), warned


@cache
def expanded(name: str) -> tuple[str, list[ReadingWarning]]:
    """Expand the public file of a key; some take a second."""
    return expand(keys()[name].file)


def copied(key: Key, to: Path) -> Path:
    """Copy a tree outside of any repository; return the main file."""
    shutil.copytree(key.folder, to / "clone")
    return to / "clone" / key.file.relative_to(key.folder)


def check(name: str, text: str, warned: list[ReadingWarning]) -> None:
    root = parse_xml(text.encode(), name)
    assert root.tag == "robot"
    assert len(list(root.all("link"))) == LINKS[name]
    assert not any(element.tag.startswith("xacro:") for element in root.within())
    assert len(warned) == len(WARNED[name]), warned
    for (path, value, reason), expected in zip(warned, WARNED[name], strict=True):
        assert (path, str(value)[: len(expected[1])]) == expected[:2]
        rule = expected[2].format(re.escape(Path(str(value)).name))
        assert re.match(rule, reason), reason


@pytest.mark.parametrize("name", WARNED)
def test_a_public_tree_expands_with_warnings_of_what_is_missing(name: str) -> None:
    check(name, *expanded(name))


@pytest.mark.parametrize(
    "name",
    [
        "marv",
        "sekirei2020_gazebo",
        *(pytest.param(each, marks=pytest.mark.soak) for each in ("tank", "tractor")),
    ],
)
def test_a_public_tree_expands_as_well_outside_of_a_repository(name: str, tmp_path: Path) -> None:
    path = copied(keys()[name], tmp_path)
    assert not any((folder / ".git").exists() for folder in path.parents)
    check(name, *expand(path))


def test_every_public_main_file_of_xacro_is_tried() -> None:
    files = {name for name, key in keys().items() if key.file.suffix == ".xacro"}
    assert files == WARNED.keys() == LINKS.keys()


@pytest.mark.parametrize(
    ("name", "key"),
    [
        *((name, name) for name in ("marv", "tank", "tractor", "sekirei2020")),
        ("sekirei2020_gazebo", "sekirei2020"),  # without its belts, whose macros are not there
    ],
)
def test_an_expanded_model_has_the_mass_of_its_key(name: str, key: str) -> None:
    text, _ = expanded(name)
    masses = [each for each in parse_xml(text.encode(), name).within() if each.tag == "mass"]
    total = sum(float(mass.attribute("value")) for mass in masses)
    assert total == pytest.approx(keys()[key].figures["mass"], abs=1e-6)


def test_marv_is_expanded_with_the_settings_of_its_repository() -> None:
    key = keys()["marv"]
    found, _ = expanded("marv")
    given, warned = expand(key.file, arguments=key.arguments, packages=key.packages)
    assert found == given
    assert not warned


def test_an_argument_that_is_given_comes_before_settings() -> None:
    key = keys()["marv"]
    text, warned = expand(key.file, arguments={"rover_topBoxX": "0.123", "num_wheels": "1"})
    assert "0.123 0" in text
    assert text.count("_wheel1") > 0
    assert not any("rover_topBoxX" in reason for _, _, reason in warned)


# Includes.


def test_an_include_at_any_depth_is_left_out_with_its_own_line(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    lost = (
        '\n\n<xacro:include filename="lost.xacro"/>\n<xacro:include filename="$(find p)/l.xacro"/>'
    )
    (tmp_path / "parts" / "wheels.xacro").write_text(f"{XACRO}{lost}{WHEELS}</robot>")
    text = urdf('<xacro:include filename="parts/wheels.xacro"/>').replace(OLD_NAME, XACRO)
    warned = read(tmp_path, text, "cart.xacro").warnings
    assert len(warned) == 2
    assert re.match(r"wheels\.xacro:3 is left out: .* got .*/parts/lost\.xacro$", warned[0])
    assert re.match(r"wheels\.xacro:4 is left out: .* got \$\(find p\)/l\.xacro$", warned[1])


OLD_NAME = '<robot name="cart">'


@pytest.mark.parametrize(
    "name", ["lost.xacro", "$(find parts)/l.xacro", "/nowhere/at/all.xacro", "../../../l.xacro"]
)
def test_missing_parts_are_refused_on_request(tmp_path: Path, name: str) -> None:
    text = urdf(f'\n<xacro:include filename="{name}"/>', WHEELS).replace(OLD_NAME, XACRO)
    assert len(read(tmp_path, text, "cart.xacro").warnings) == 1
    refused(tmp_path, text, "must ", "cart.xacro", missing="refuse")


def test_an_include_that_holds_elements_is_included_and_they_are_ignored(tmp_path: Path) -> None:
    (tmp_path / "wheels.xacro").write_text(f"{XACRO}{WHEELS}</robot>")
    filled = '<xacro:include filename="wheels.xacro"><xacro:arg name="a" value="$(arg b)"/>'
    text = urdf(f"{filled}</xacro:include>").replace(OLD_NAME, XACRO)
    assert not read(tmp_path, text, "cart.xacro").warnings


def test_an_include_with_entities_is_refused(tmp_path: Path) -> None:
    bomb = '<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa">]>\n<robot name="&a;"/>'
    (tmp_path / "part.xacro").write_text(bomb)
    text = urdf('<xacro:include filename="part.xacro"/>', WHEELS).replace(OLD_NAME, XACRO)
    with refusing(SAID, "must have no document type") as caught:
        read(tmp_path, text, "cart.xacro")
    assert caught.value.path == "part.xacro:1"


def test_an_error_caused_by_a_missing_include_says_so(tmp_path: Path) -> None:
    lost = '<xacro:include filename="$(find parts)/sizes.xacro"/>'
    text = urdf(WHEELS, mass="${hull_mass}").replace(OLD_NAME, XACRO + lost)
    with refusing(SAID) as caught:
        read(tmp_path, text, "cart.xacro")
    assert re.fullmatch(
        r"cart\.xacro:1 must be xacro that expands, for which it may need what was left out,"
        r" \$\(find parts\)/sizes\.xacro \(cart\.xacro:1\), got name 'hull_mass' is not defined .*:"
        r" put the file there, or pass the folder of its package as packages=\{name: folder\}",
        str(caught.value),
    )


def test_a_refusal_after_an_include_was_left_out_notes_that(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = urdf('<xacro:include filename="$(find parts)/w.xacro"/>').replace(OLD_NAME, XACRO)
    with refusing(SAID, "must have wheels") as caught:
        read(tmp_path, text, "cart.xacro")
    (note,) = caught.value.__notes__
    assert re.match(r"cart\.xacro:1 is left out: .* got \$\(find parts\)/w\.xacro", note)
    from crawler2d.__main__ import main  # noqa: PLC0415 - as the command does

    assert main(["audit", str(tmp_path / "cart.xacro"), "--no-html"]) == 2
    assert "\n  before that: cart.xacro:1 is left out" in capsys.readouterr().err


# Macros.


def test_a_call_of_an_unknown_macro_is_left_out_with_its_block(tmp_path: Path) -> None:
    call = '\n<xacro:sensor name="${nothing}"><link name="lidar"/></xacro:sensor>'
    text = urdf(call, '\n<xacro:call macro="a.b"/>', WHEELS).replace(OLD_NAME, XACRO)
    reading = read(tmp_path, text, "cart.xacro")
    assert "lidar" not in reading.text
    assert [re.sub(", got.*", "", warning) for warning in reading.warnings] == [
        f"cart.xacro:{line} is left out with its content: no file defines this macro"
        for line in (2, 3)
    ]


def test_a_call_in_a_macro_is_reported_at_the_line_of_the_call(tmp_path: Path) -> None:
    macro = '\n<xacro:macro name="m">\n<xacro:inner/></xacro:macro>\n<xacro:m/><xacro:m/>'
    text = urdf(macro, WHEELS).replace(OLD_NAME, XACRO)
    (warning,) = read(tmp_path, text, "cart.xacro").warnings
    assert warning.startswith("cart.xacro:3 is left out with its content")


def test_a_thousand_warnings_are_cut_to_a_hundred(tmp_path: Path) -> None:
    text = urdf("\n<xacro:none/>" * 1000, WHEELS).replace(OLD_NAME, XACRO)
    (tmp_path / "cart.xacro").write_text(text, encoding="utf-8")
    doubts = quietly(tmp_path / "cart.xacro").warnings
    assert len(doubts) == 100
    assert doubts[-1] == ("cart.xacro:101 is one of 901 more places of this kind, got <xacro:none>")


# Packages without a manifest.


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """The root of a repository with a folder for models, of which no manifest tells."""
    (tmp_path / "clone" / ".git").mkdir(parents=True)
    (tmp_path / "clone" / "models").mkdir()
    return tmp_path / "clone"


def part(folder: Path, name: str = "wheels.xacro", text: str = f"{XACRO}{WHEELS}</robot>") -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text)
    return folder / name


INCLUDE = urdf('<xacro:include filename="$(find parts)/urdf/wheels.xacro"/>').replace(
    OLD_NAME, XACRO
)


def test_a_file_of_a_package_without_a_manifest_is_found_by_its_path(clone: Path) -> None:
    path = part(clone / "anywhere" / "urdf")
    (warning,) = read(clone / "models", INCLUDE, "cart.xacro").warnings
    assert warning == (
        f"cart.xacro:1 is taken to be {path}: no package has that name,"
        " got $(find parts)/urdf/wheels.xacro"
    )


def test_a_folder_with_the_name_of_the_package_is_preferred(clone: Path) -> None:
    part(clone / "others" / "urdf", text="<robot/>")
    path = part(clone / "parts" / "urdf")
    (warning,) = read(clone / "models", INCLUDE, "cart.xacro").warnings
    assert f"is taken to be {path}" in warning


def test_an_ambiguous_file_is_not_used(clone: Path) -> None:
    part(clone / "one" / "urdf")
    part(clone / "two" / "urdf")
    with refusing(SAID, "must have wheels") as caught:
        read(clone / "models", INCLUDE, "cart.xacro")
    assert "is left out" in caught.value.__notes__[0]


def test_a_name_without_a_path_identifies_no_file(clone: Path) -> None:
    part(clone / "anywhere")
    text = INCLUDE.replace("/urdf/", "/")
    with refusing(SAID, "must have wheels"):
        read(clone / "models", text, "cart.xacro")


def test_a_file_found_by_its_path_includes_its_neighbours(clone: Path) -> None:
    part(clone / "any" / "urdf", text=f'{XACRO}<xacro:include filename="sub/w.xacro"/></robot>')
    part(clone / "any" / "urdf" / "sub", "w.xacro")
    (clone / "any" / "package.xml").write_text("<package><name>called otherwise</name></package>")
    (warning,) = read(clone / "models", INCLUDE, "cart.xacro").warnings
    assert "no package has that name" in warning


@pytest.mark.parametrize("name", ["package://parts/", "model://parts/", "file://$(find parts)/"])
def test_a_mesh_of_a_package_without_a_manifest_is_found_by_its_path(
    clone: Path, name: str
) -> None:
    corners = [f"v {x} {y} {z}" for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (0.0, 0.05)]
    path = part(clone / "any" / "meshes", "m.obj", "\n".join(corners))
    shapes = collision(f'<mesh filename="{name}meshes/m.obj"/>')
    for kind in ("cart.urdf", "cart.xacro"):
        text = urdf(WHEELS, shapes=shapes).replace(OLD_NAME, XACRO)
        reading = read(clone / "models", text, kind, mesh="hull")
        assert reading.robot.belly is not None
        assert any(f"is taken to be {path}" in warning for warning in reading.warnings)


def test_yaml_of_a_package_without_a_manifest_is_found_by_its_path(clone: Path) -> None:
    part(clone / "any" / "config", "m.yaml", "hull: 8")
    mass = "${xacro.load_yaml('$(find parts)/config/m.yaml')['hull']}"
    text = urdf(WHEELS, mass=mass).replace(OLD_NAME, XACRO)
    reading = read(clone / "models", text, "cart.xacro")
    assert reading.robot.mass == 12.0
    assert "config/m.yaml" in reading.warnings[0]


def test_a_visual_of_a_missing_package_is_ignored(tmp_path: Path) -> None:
    visual = '<visual><geometry><mesh filename="file://$(find no)/a.stl"/></geometry></visual>'
    text = urdf(WHEELS, shapes=visual).replace(OLD_NAME, XACRO)
    assert not read(tmp_path, text, "cart.xacro").warnings


@pytest.mark.skipif(sys.platform == "win32", reason="has links of Unix")
def test_a_path_does_not_lead_out_of_the_tree(clone: Path, tmp_path: Path) -> None:
    part(tmp_path / "out" / "urdf")
    (clone / "linked").symlink_to(tmp_path / "out")
    (clone / "urdf").mkdir()
    (clone / "urdf" / "wheels.xacro").symlink_to(tmp_path / "out" / "urdf" / "wheels.xacro")
    for name in ("urdf/wheels.xacro", "../out/urdf/wheels.xacro", "./urdf/../../out/urdf/w.xacro"):
        text = INCLUDE.replace("urdf/wheels.xacro", name)
        with refusing(SAID, "must have wheels") as caught:
            read(clone / "models", text, "cart.xacro")
        assert any("is left out" in note for note in caught.value.__notes__)


def test_a_tree_in_the_folder_for_temporary_files_is_searched_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    part(tmp_path / "stranger" / "urdf")
    (tmp_path / "stranger" / "package.xml").write_text("<package><name>parts</name></package>")
    own = tmp_path / "clone" / "robot"
    (own / "models").mkdir(parents=True)
    (tmp_path / "clone" / "package.xml").write_text("<package><name>own</name></package>")
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    with refusing(SAID, "must have wheels") as caught:
        read(own / "models", INCLUDE, "cart.xacro")
    assert f"found in {tmp_path / 'clone'} and below, or" in caught.value.__notes__[0]


# Arguments.


def with_arguments(folder: Path, *names: str, own: str = "", **how: Any) -> c2d.Reading:
    """Read a cart whose mass is the sum of arguments."""
    mass = " + ".join(f"$(arg {name})" for name in names)
    text = urdf(WHEELS, mass=f"${{{mass}}}").replace(OLD_NAME, XACRO + own)
    return read(folder, text, "cart.xacro", **how)


def test_an_argument_without_a_value_is_that_of_a_setting(tmp_path: Path) -> None:
    for folder in ("urdf", "config"):
        (tmp_path / folder).mkdir()
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    text = "# sizes\n---\nhull: '3' # [kg]\nload:   5\nmore:\n  rest: 7\nrest: [9]\nlist: [1]\n"
    (tmp_path / "config" / "sizes.yaml").write_text(text)
    (tmp_path / "config" / "same.yml").write_text("load: 5\n")
    reading = with_arguments(tmp_path / "urdf", "hull", "load")
    assert reading.robot.mass == 12.0
    assert reading.warnings == (
        "sizes.yaml:3 is taken for the argument hull, which has no default: arguments= sets it,"
        " got 3",
        "sizes.yaml:4 is taken for the argument load, which has no default: arguments= sets it,"
        " got 5",
    )
    with refusing(SAID, r"arguments=\{name: value\}, got rest, list$"):
        with_arguments(tmp_path / "urdf", "hull", "rest", "list")


def test_all_arguments_without_a_value_are_named_at_once(tmp_path: Path) -> None:
    own = '<xacro:arg name="known" default="1"/><xacro:if value="$(arg d)"><a/></xacro:if>'
    with refusing(SAID) as caught:
        with_arguments(tmp_path, "a", "b", "known", "c", own=own)
    rule = "must have a value for each argument, as a default or in arguments={name: value}"
    assert str(caught.value) == f"cart.xacro:1 {rule}, got d, a, b, c"
    own += "${1 / $(arg e)}"
    with refusing(SAID, "got d, e, a, b, c"):
        with_arguments(tmp_path, "a", "b", "known", "c", own=own)


def test_contradictory_settings_are_not_used(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("hull: 3")
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "a.yaml").write_text("\nhull: 4")
    rule = r"got hull; files of settings differ: hull is 3 in a\.yaml:1, 4 in b/a\.yaml:2$"
    with refusing(SAID, rule):
        with_arguments(tmp_path, "hull")
    assert with_arguments(tmp_path, "hull", arguments={"hull": 8}).robot.mass == 12.0
    (tmp_path / "a.yaml").write_text("hull: 3\nload: 5")
    with refusing(SAID, rule):
        with_arguments(tmp_path, "hull", "load")


def test_settings_are_not_used_on_request_or_where_there_is_a_default(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("hull: 3\nload: 5")
    rule = "must have a value for each argument"
    with refusing(SAID, rule):
        with_arguments(tmp_path, "hull", missing="refuse")
    own = '<xacro:arg name="hull" default="8"/>'
    assert with_arguments(tmp_path, "hull", own=own).warnings == ()
    reading = with_arguments(tmp_path, "hull", "load", own=own)
    assert reading.robot.mass == 12.0  # 3 kg: all settings of the file are used
    assert reading.warnings[1] == (
        "a.yaml is used with all its settings, also instead of defaults, got hull: 3 for 8"
    )


@pytest.mark.skipif(sys.platform == "win32", reason="has pipes of Unix")
def test_settings_that_are_odd_files_cause_no_delay(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.yaml")
    (tmp_path / "folder.yaml").mkdir()
    (tmp_path / "out.yaml").symlink_to("/etc/passwd")
    (tmp_path / "zero.yaml").symlink_to("/dev/zero")
    with (tmp_path / "large.yaml").open("wb") as file:
        file.truncate(10**10)
    odd = ("{" * 60_000, "a: x" + " " * 60_000 + "y", "hull: '" + " " * 60_000, "\0\xff: &a [*a]")
    for number, text in enumerate((*odd, "!!python/object/apply:os.system [ls]\n")):
        (tmp_path / f"{number}.yaml").write_text(text, encoding="latin-1")
    (tmp_path / "z.yaml").write_text("hull: 8")
    start = time.perf_counter()
    assert with_arguments(tmp_path, "hull").robot.mass == 12.0
    assert time.perf_counter() - start < 5.0


def test_an_argument_from_settings_is_evaluated_as_carefully_as_any(tmp_path: Path) -> None:
    (tmp_path / "a.yaml").write_text("hull: ().__class__")
    with refusing(SAID, "trusted=True allows it"):
        with_arguments(tmp_path, "hull")


# Old xacro.


def test_elements_of_old_xacro_need_no_prefix(tmp_path: Path) -> None:
    (tmp_path / "wheels.xacro").write_text(f"{OLD}{WHEELS}</robot>")
    first = '\n<property name="hull_mass" value="8"/>'
    old = """
<property name="place"><origin xyz="0 0 0"/></property>
<macro name="box_of" params="name *where"><link name="${name}">
  <collision><insert_block name="where"/><geometry><box size="0.1 0.1 0.1"/></geometry></collision>
</link></macro>
<include filename="wheels.xacro"/>
<if value="1"><box_of name="cargo"><origin xyz="0 0 0.1"/></box_of></if>
<unless value="1"><link name="none"/></unless>
<joint name="j" type="fixed"><parent link="hull"/><child link="cargo"/></joint>"""
    text = urdf(old, mass="${hull_mass}").replace(OLD_NAME, OLD + first)
    reading = read(tmp_path, text, "cart.xacro")
    assert reading.robot.mass == 12.0
    assert reading.robot.belly is not None
    assert reading.warnings == (
        "cart.xacro:2 is read as an element of xacro without its prefix, and so are 6 more elements"
        " of the file, got <property>",
        "cart.xacro:8 is taken as a call of the macro, which old xacro allowed, got <box_of>",
    )


def test_elements_of_urdf_and_of_plugins_are_no_calls(tmp_path: Path) -> None:
    """A macro may be called like an element; a plugin may have properties and conditions."""
    macro = '<xacro:macro name="mass" params="value"><wrong/></xacro:macro>'
    plugin = '<plugin name="a" filename="b"><property name="c" value="d"/><if value="e"/></plugin>'
    text = urdf(macro, f"<gazebo>{plugin}</gazebo>", WHEELS).replace(OLD_NAME, XACRO)
    reading = read(tmp_path, text, "cart.xacro")
    assert reading.warnings == ()
    assert '<property name="c" value="d"/>' in reading.text


def test_a_macro_calls_others_without_a_prefix_but_not_itself(tmp_path: Path) -> None:
    macros = '<macro name="inner" params="of"><inner of="${of}"/></macro>'
    macros += '\n<macro name="outer" params="of"><inner of="${of}"/></macro>\n<outer of="a"/>'
    reading = read(tmp_path, urdf(macros, WHEELS).replace(OLD_NAME, OLD), "cart.xacro")
    assert [warning.partition(" ")[0] for warning in reading.warnings] == [
        f"cart.xacro:{line}" for line in (1, 3, 2)
    ]
    assert reading.text.count('<inner of="a"/>') == 1


@pytest.mark.parametrize(
    "element", ['<cover colour="red"/>', '<cover size="1"><a/></cover>', "<cover/>", "<space/>"]
)
def test_an_element_that_a_macro_does_not_fit_is_no_call(tmp_path: Path, element: str) -> None:
    (tmp_path / "none.xacro").write_text(f"{XACRO}</robot>")
    macro = '<xacro:macro name="cover" params="size"><link name="cover"/></xacro:macro>'
    macro += '<xacro:include filename="none.xacro" ns="space"/>'
    text = urdf(macro, element, WHEELS).replace(OLD_NAME, XACRO)
    assert read(tmp_path, text, "cart.xacro").warnings == ()


def test_a_macro_may_be_called_before_it_is_defined_as_in_old_xacro(tmp_path: Path) -> None:
    call = "\n<xacro:all_wheels/>\n<xacro:nowhere/>"
    macro = f'<xacro:macro name="all_wheels">{WHEELS}</xacro:macro>'
    text = urdf(call, macro).replace(OLD_NAME, XACRO)
    warned = read(tmp_path, text, "cart.xacro").warnings
    assert [re.sub(" which.*| with.*", "", warning) for warning in warned] == [
        "cart.xacro:2 is a macro that is defined later,",
        "cart.xacro:3 is left out",
    ]
