"""Packages that a model names are found, by their manifests and by ROS's and Gazebo's variables."""

import os
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from crawler2d.reading.files import VARIABLES
from tests.reading.carts import WHEELS, XACRO, collision, left_out, quietly, read, refused, urdf

OBJ = "\n".join(f"v {x} {y} {z}" for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (0.0, 0.05))
NAMED = ("package://parts/", "model://parts/", "$(find parts)/", "file://$(find-pkg-share parts)/")
PACKAGE = "<?xml version='1.0'?><!-- <name>no</name> -->\n<package><name> parts </name></package>"


@pytest.fixture(autouse=True)
def _no_packages_of_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in VARIABLES:
        monkeypatch.delenv(variable, raising=False)


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """The root of a repository with an empty folder for models."""
    (tmp_path / "clone" / ".git").mkdir(parents=True)
    (tmp_path / "clone" / "models" / "cart").mkdir(parents=True)
    return tmp_path / "clone"


def package(folder: Path, manifest: str = "package.xml", text: str = PACKAGE) -> Path:
    """Make a package of a mesh, wheels and a manifest; return its folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "m.obj").write_text(OBJ)
    (folder / "wheels.xacro").write_text(f"{XACRO}{WHEELS}</robot>")
    if manifest:
        (folder / manifest).write_text(text)
    return folder


def with_mesh(name: str) -> str:
    return urdf(WHEELS, shapes=collision(f'<mesh filename="{name}m.obj"/>'))


def has_belly(folder: Path, name: str = NAMED[0], **how: Any) -> bool:
    return read(folder, with_mesh(name), mesh="hull", **how).robot.belly is not None


@pytest.mark.parametrize("name", NAMED)
def test_a_package_of_the_repository_is_found_by_its_name(clone: Path, name: str) -> None:
    package(clone / "here" / "called_otherwise")
    assert has_belly(clone / "models" / "cart", name)


def test_a_model_of_gazebo_is_found_by_its_folder_and_its_name(clone: Path) -> None:
    config = "<model><name>wheels and all</name></model>"
    package(clone / "worlds" / "parts", "model.config", config)
    assert has_belly(clone / "models", "model://parts/")
    assert has_belly(clone / "models", "model://wheels and all/")


@pytest.mark.parametrize("word", ["find", "find-pkg-share"])
def test_xacro_finds_packages_as_meshes_are_found(clone: Path, word: str) -> None:
    pytest.importorskip("xacrodoc")
    package(clone / "parts_description")
    include = f'<xacro:include filename="$({word} parts)/wheels.xacro"/>'
    text = urdf(include, shapes=collision('<mesh filename="file://$(find parts)/m.obj"/>'))
    text = text.replace('<robot name="cart">', XACRO)
    reading = read(clone / "models", text, "cart.xacro", mesh="hull")
    assert reading.robot.belly is not None
    again = read(clone / "models", reading.text, "cart.urdf", mesh="hull")  # with paths of files
    assert again.robot == reading.robot


LAYOUTS = [
    ("AMENT_PREFIX_PATH", "share/parts"),
    ("COLCON_PREFIX_PATH", "share/parts"),
    ("COLCON_PREFIX_PATH", "parts/share/parts"),
    ("GZ_SIM_RESOURCE_PATH", "parts"),
    ("IGN_GAZEBO_RESOURCE_PATH", "parts"),
    ("GAZEBO_MODEL_PATH", "parts"),
    ("SDF_PATH", "parts"),
    ("ROS_PACKAGE_PATH", "any/where/called_otherwise"),
    ("ROS_ROOT", "any/where/called_otherwise"),
]


def test_every_variable_has_a_layout_here() -> None:
    assert {variable for variable, _ in LAYOUTS} == VARIABLES.keys()


@pytest.mark.parametrize(("variable", "inside"), LAYOUTS)
def test_a_package_is_found_by_a_variable(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, variable: str, inside: str
) -> None:
    (tmp_path / "cart").mkdir()
    package(tmp_path / "prefix" / inside, "package.xml" if "any" in inside else "")
    left_out(tmp_path / "cart", with_mesh(NAMED[0]), "in a package that is found in")
    folders = [str(tmp_path / "nowhere"), str(tmp_path / "prefix")]
    monkeypatch.setenv(variable, os.pathsep.join(folders))
    assert has_belly(tmp_path / "cart")


def test_the_nearest_package_comes_first_and_a_given_one_before_it(
    clone: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only one of them has the mesh, so that choosing another is an error."""
    cart = clone / "models"
    package(clone / "near")
    (package(tmp_path / "ros" / "parts") / "m.obj").unlink()
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    assert has_belly(cart)
    given = tmp_path / "given"
    given.mkdir()
    left_out(cart, with_mesh(NAMED[0]), "there is no file", packages={"parts": given})


def test_packages_beside_that_of_the_model_need_no_repository(tmp_path: Path) -> None:
    own = package(tmp_path / "ws" / "cart", text="<package><name>cart</name></package>")
    package(tmp_path / "ws" / "others" / "parts")
    (own / "urdf").mkdir()
    assert has_belly(own / "urdf")


def test_packages_beside_the_outermost_that_holds_the_model_are_found(tmp_path: Path) -> None:
    inner = tmp_path / "ws" / "robots" / "sim" / "worlds" / "cart"
    for folder in (tmp_path / "ws" / "robots", inner):
        package(folder, text="<package><name>cart</name></package>")
    package(tmp_path / "ws" / "parts")
    assert has_belly(inner)


def test_a_package_outside_the_repository_is_not_found(clone: Path, tmp_path: Path) -> None:
    package(tmp_path / "parts")
    (clone / "linked").symlink_to(tmp_path / "parts")
    rule = rf"in a package that is found in {clone} and below, or whose folder is given: packages="
    left_out(clone / "models", with_mesh(NAMED[0]), rule)


def test_a_package_that_is_not_found_says_where_it_was_looked_for(
    clone: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("xacrodoc")
    monkeypatch.setenv("SDF_PATH", str(clone))
    where = rf"looked for in {clone} and below and in SDF_PATH, got parts: packages="
    text = f'{XACRO}\n<link name="$(find-pkg-share parts)"/></robot>'
    refused(clone / "models", text, where, "cart.xacro", missing="refuse")


def test_of_files_of_one_name_that_of_the_folder_of_the_package_is_meant(clone: Path) -> None:
    """No folder has a manifest: the path alone tells them apart."""
    for folder in ("parts", "others"):
        package(clone / folder / "meshes", "")
    assert has_belly(clone / "models", "package://parts/meshes/")
    (clone / "parts" / "meshes" / "m.obj").unlink()
    assert has_belly(clone / "models", "package://parts/meshes/")  # the only one that is left
    package(clone / "third" / "meshes", "")
    left_out(clone / "models", with_mesh("package://parts/meshes/"), "in a package that is found")


@pytest.mark.parametrize("name", ["..", ".", "", "a/../..", "~", "$HOME", "-x", "parts\\..\\.."])
def test_an_invalid_package_name_is_not_found(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    (tmp_path / "cart").mkdir()
    (tmp_path / "m.obj").write_text(OBJ)
    monkeypatch.setenv("SDF_PATH", str(tmp_path / "cart"))
    left_out(tmp_path / "cart", with_mesh(f"model://{name}/"), "in a package that")


def test_a_found_package_does_not_lead_out_of_itself(clone: Path) -> None:
    package(clone / "parts")
    (clone / "m.obj").write_text(OBJ)
    rule = "must be in the folder or package of its model"
    left_out(clone / "models", with_mesh("package://parts/../"), rule)


@pytest.mark.skipif(sys.platform == "win32", reason="has pipes of Unix")
def test_an_odd_manifest_causes_no_delay(clone: Path) -> None:
    for number, text in enumerate((b"", b"\xff<name>", b"<!--" * 15_000, b"<name>" * 10_000)):
        package(clone / f"a{number}", "")
        (clone / f"a{number}" / "package.xml").write_bytes(text)
    os.mkfifo(package(clone / "pipe", "") / "package.xml")
    (package(clone / "folder", "") / "package.xml").mkdir()
    with (package(clone / "large", "") / "package.xml").open("wb") as file:
        file.truncate(10**10)
    package(clone / "parts")
    start = time.perf_counter()
    assert has_belly(clone / "models")
    assert time.perf_counter() - start < 2.0


def test_a_large_tree_is_looked_into_up_to_a_number_of_folders(clone: Path) -> None:
    for number in range(6000):
        (clone / f"a{number}").mkdir()
    deep = clone / "/".join("b" * 40)
    package(deep)
    start = time.perf_counter()
    left_out(clone / "models", with_mesh(NAMED[0]), "in a package that is found")
    assert time.perf_counter() - start < 3.0


def test_a_folder_that_cannot_be_listed_is_passed_over(clone: Path) -> None:
    package(clone / "parts")
    (clone / "closed").mkdir(mode=0o000)
    assert has_belly(clone / "models")
    (clone / "closed").chmod(0o700)


def test_settings_of_another_package_of_the_repository_are_not_taken(clone: Path) -> None:
    package(clone / "models")
    other = package(clone / "other", text=PACKAGE.replace("parts", "other"))
    (other / "sizes.yaml").write_text("hull: 8")
    text = urdf(WHEELS, mass="$(arg hull)").replace('<robot name="cart">', XACRO)
    folder = clone / "models" / "cart"
    refused(folder, text, "must have a value for each argument", "cart.xacro")
    (clone / "models" / "sizes.yaml").write_text("\n\nhull: 3")
    assert read(folder, text, "cart.xacro").robot.mass == 7.0  # with four wheels of 1 kg


def test_a_file_that_is_named_only_before_settings_are_known_gets_no_warning(clone: Path) -> None:
    """An argument is 0 until its setting is found."""
    for size in ("0", "small"):
        package(clone / "any" / "parts" / size, manifest="")
    cart = clone / "models" / "cart"
    (cart / "sizes.yaml").write_text("size: small")
    include = '<xacro:include filename="$(find parts)/$(arg size)/wheels.xacro"/>'
    (cart / "cart.xacro").write_text(urdf(include).replace('<robot name="cart">', XACRO))
    warned = quietly(cart / "cart.xacro").warnings
    assert sum("small/wheels.xacro: no package has that name" in each for each in warned) == 1
    assert not any("0/wheels.xacro" in each for each in warned)
