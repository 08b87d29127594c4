"""Files that a model names are read if allowed, or not opened at all, with the reason."""

import os
import re
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from tests.kept import refusing
from tests.reading.carts import FILES, SAID, WHEELS, XACRO, collision, left_out, read, refused, urdf
from tests.reading.odd_files import ODD

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="has pipes and devices of Unix")

CORNERS = [(x, y, z) for x in (-0.1, 0.1) for y in (-0.1, 0.1) for z in (0.0, 0.05)]
OBJ = "\n".join(f"v {x} {y} {z}" for x, y, z in CORNERS)


@pytest.fixture(autouse=True)
def _nothing_waits() -> Iterator[None]:
    """Abort a test that waits for a pipe."""

    def end(*_: Any) -> None:
        raise TimeoutError("a file was waited for")

    before = signal.signal(signal.SIGALRM, end)
    signal.alarm(20)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


odd = pytest.mark.parametrize("what", ODD)


def with_mesh(name: str) -> str:
    return urdf(WHEELS, shapes=collision(f'<mesh filename="{name}"/>'))


@odd
@pytest.mark.parametrize("suffix", ["stl", "dae"])
def test_a_mesh_that_is_no_file_of_the_model_is_left_out(
    tmp_path: Path, what: str, suffix: str
) -> None:
    ODD[what](tmp_path / f"mesh.{suffix}")
    regular = r"must be a regular file that can be read \(.*\)|there is no file"
    reason = rf"({regular}|must be in the folder or package of its model)"
    left_out(tmp_path, with_mesh(f"mesh.{suffix}"), reason)


@pytest.mark.parametrize("name", ["file:///dev/zero.stl", "/dev/zero.stl", "../dev/zero.stl"])
def test_dev_zero_is_not_read_as_a_mesh(tmp_path: Path, name: str) -> None:
    (tmp_path / "cart").mkdir()
    rule = r"in a folder that is named: packages=\{name: folder\}"
    left_out(tmp_path / "cart", with_mesh(name), rule)


@odd
@pytest.mark.parametrize("suffix", ["urdf", "sdf", "xml", "xacro"])
def test_a_model_that_is_no_file_is_refused(tmp_path: Path, what: str, suffix: str) -> None:
    path = tmp_path / f"cart.{suffix}"
    ODD[what](path)
    with refusing(SAID) as caught:
        c2d.read_robot(path, trusted=True)
    if what != "elsewhere":  # a file, which its user named, but no model
        assert caught.value.path == "path"
        assert "must be a regular file that can be read (" in caught.value.rule


@odd
@pytest.mark.parametrize("named", ["include", "yaml"])
def test_a_file_that_xacro_names_and_is_none_is_refused(
    tmp_path: Path, what: str, named: str
) -> None:
    pytest.importorskip("xacrodoc")
    ODD[what](tmp_path / "part")
    part = '<xacro:include filename="part"/>'
    if named == "yaml":
        part = '<xacro:property name="p" value="${xacro.load_yaml(\'part\')}"/><a>${p}</a>'
    rule = r"must be (a regular file that can be read \(.*\)|in the folder or package)"
    how: dict[str, Any] = {"trusted": True, "missing": "refuse"}
    refused(tmp_path, f"{XACRO}\n{part}</robot>", rule, "cart.xacro", **how)


@odd
def test_a_missing_include_is_left_out_and_an_invalid_one_refused(
    tmp_path: Path, what: str
) -> None:
    """A path that leads out of the folder of the model is not one of its files, whatever it is."""
    pytest.importorskip("xacrodoc")
    ODD[what](tmp_path / "part")
    text = urdf('\n<xacro:include filename="part"/>', WHEELS).replace('<robot name="cart">', XACRO)
    if what in ("zero", "random", "tty", "elsewhere", "nowhere"):
        (warning,) = read(tmp_path, text, "cart.xacro").warnings
        assert re.match(r"cart\.xacro:2 is left out: .* got /.*/part$", warning)
    elif what == "device" and (tmp_path / "part").is_symlink():
        pytest.skip("only root may make a device")
    else:
        refused(tmp_path, text, r"must be a regular file that can be read \(", "cart.xacro")


MJCF = {
    "mesh": '<mesh name="m" file="part.stl"/>',
    "hfield": '<hfield name="m" file="part.png" size="1 1 1 1"/>',
    "texture": '<texture name="m" type="2d" file="part.png"/>',
    "sides": '<texture name="m" type="cube" fileright="part.png"/>',
    "skin": '</asset><deformable><skin name="m" file="part.skn"/></deformable><asset>',
    "model": '<model name="m" file="part.xml"/>',
}


def mjcf(asset: str) -> str:
    text = (FILES / "cart.xml").read_text()
    return text.replace("<worldbody>", f"<asset>{asset}</asset><worldbody>", 1)


@pytest.mark.parametrize("what", ["pipe", "device", "elsewhere"])
@pytest.mark.parametrize("named", MJCF)
def test_a_file_that_mjcf_names_and_is_none_is_not_opened(
    tmp_path: Path, what: str, named: str
) -> None:
    """Visuals are not even searched for; meshes without shapes do not matter either."""
    pytest.importorskip("mujoco")
    for suffix in ("stl", "png", "skn", "xml"):
        ODD[what](tmp_path / f"part.{suffix}")
    if named == "model":
        refused(tmp_path, mjcf(MJCF[named]), "must contain the robot itself", "cart.xml")
    else:
        assert read(tmp_path, mjcf(MJCF[named]), "cart.xml").robot.mass > 0.0


def test_mujoco_opens_nothing_by_itself(tmp_path: Path) -> None:
    """Not even files outside the list of assets, such as the mesh of a soft body."""
    pytest.importorskip("mujoco")
    os.mkfifo(tmp_path / "part.msh")
    soft = '<flexcomp name="f" type="gmsh" dim="3" file="part.msh"/>'
    text = (FILES / "cart.xml").read_text().replace("</body>", f"{soft}</body>", 1)
    start = time.perf_counter()
    refused(tmp_path, text, "must be a model that MuJoCo compiles", "cart.xml")
    assert time.perf_counter() - start < 6.0


def test_meshes_of_one_name_in_two_folders_are_told_apart(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    for number, name in enumerate(("low", "high")):
        (tmp_path / name).mkdir()
        rows = [f"v {x} {y} {z * (number + 1)}" for x, y, z in CORNERS]
        faces = "\nf 1 2 3\nf 4 5 6\nf 6 7 8\nf 1 4 8"
        (tmp_path / name / "box.obj").write_text("\n".join(rows) + faces)
    assets = "".join(f'<mesh name="{n}" file="{n}/box.obj"/>' for n in ("low", "high"))
    box = '<geom type="box" pos="0 0 0.0625" size="0.25 0.125 0.0625"/>'
    text = mjcf(assets)
    assert box in text
    tops = []
    for name in ("low", "high"):
        shape = f'<geom type="mesh" mesh="{name}"/>'
        belly = read(tmp_path, text.replace(box, shape), "cart.xml", mesh="hull").robot.belly
        assert belly is not None
        heights = [y for _, y in belly]
        tops.append(max(heights) - min(heights))
    assert tops == pytest.approx([0.05, 0.1], abs=1e-6)


def test_an_include_that_is_optional_and_missing_is_passed_over(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    text = urdf('<xacro:include filename="no.xacro" optional="true"/>', WHEELS)
    text = text.replace('<robot name="cart">', XACRO)
    assert read(tmp_path, text, "cart.xacro", trusted=True).robot.mass > 0.0


def test_includes_and_yaml_of_the_folder_are_read(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    (tmp_path / "wheels.xacro").write_text(f"{XACRO}{WHEELS}</robot>")
    (tmp_path / "masses.yaml").write_text("hull: 8\n")
    text = urdf('<xacro:include filename="wheels.xacro"/>', mass="${m['hull']}")
    load = '<xacro:property name="m" value="${xacro.load_yaml(\'masses.yaml\')}"/>'
    text = text.replace('<robot name="cart">', XACRO + load)
    assert read(tmp_path, text, "cart.xacro", trusted=True).robot.mass == 12.0


OUTSIDE = {
    "above": "../other/m.obj",
    "absolute": "{other}/m.obj",
    "as a file": "file://{other}/m.obj",
    "by a link": "link.obj",
    "by a linked folder": "linked/m.obj",
}


@pytest.mark.parametrize("way", OUTSIDE)
def test_a_mesh_elsewhere_is_read_only_where_its_folder_is_named(tmp_path: Path, way: str) -> None:
    cart, other = tmp_path / "cart", tmp_path / "other"
    cart.mkdir()
    other.mkdir()
    (other / "m.obj").write_text(OBJ)
    (cart / "link.obj").symlink_to(other / "m.obj")
    (cart / "linked").symlink_to(other)
    text = with_mesh(OUTSIDE[way].format(other=other))
    left_out(cart, text, "must be in the folder or package of its model")
    reading = read(cart, text, mesh="hull", packages={"other": other})
    assert reading.robot.belly == ((-0.1, 0.0), (0.1, 0.0), (0.1, 0.05), (-0.1, 0.05))


@pytest.mark.parametrize("manifest", ["package.xml", "manifest.xml", "model.config"])
def test_a_mesh_of_the_package_round_a_model_is_read(tmp_path: Path, manifest: str) -> None:
    for name in ("urdf", "meshes"):
        (tmp_path / name).mkdir()
    (tmp_path / "meshes" / "m.obj").write_text(OBJ)
    (tmp_path / manifest).write_text("<package/>")
    reading = read(tmp_path / "urdf", with_mesh("../meshes/m.obj"), mesh="hull")
    assert reading.robot.belly is not None


def test_packages_of_the_ros_path_are_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Includes and meshes; a manifest that is a pipe does not block."""
    pytest.importorskip("xacrodoc")
    package, cart = tmp_path / "ros" / "parts", tmp_path / "cart"
    package.mkdir(parents=True)
    cart.mkdir()
    (package / "package.xml").write_text("<package><name>parts</name></package>")
    (package / "wheels.xacro").write_text(f"{XACRO}{WHEELS}</robot>")
    (package / "m.obj").write_text(OBJ)
    include = '<xacro:include filename="$(find parts)/wheels.xacro"/>'
    text = urdf(include, shapes=collision('<mesh filename="file://$(find parts)/m.obj"/>'))
    text = text.replace('<robot name="cart">', XACRO)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))
    how: dict[str, Any] = {"trusted": True, "mesh": "hull"}
    assert read(cart, text, "cart.xacro", **how).robot.belly is not None
    (package / "package.xml").unlink()
    os.mkfifo(package / "package.xml")
    with refusing(SAID, r"looked for in .* and in ROS_PACKAGE_PATH"):
        read(cart, text, "cart.xacro", missing="refuse", **how)


@pytest.mark.parametrize("suffix", ["stl", "obj"])
def test_a_mesh_is_not_larger_than_30_megabytes(tmp_path: Path, suffix: str) -> None:
    with (tmp_path / f"m.{suffix}").open("wb") as file:
        file.truncate(100_000_000)
    left_out(tmp_path, with_mesh(f"m.{suffix}"), "must have at most 30000000 bytes")


def test_all_meshes_of_a_model_are_not_larger_than_30_megabytes(tmp_path: Path) -> None:
    for name, blank in (("a", 16_000_000), ("b", 16_000_000), ("c", 0)):
        (tmp_path / f"{name}.obj").write_text(OBJ + "\n" * blank)
    shapes = "".join(collision(f'<mesh filename="{name}.obj"/>') for name in "abc")
    reason = "must, with the other files of its model, have at most 30000000 bytes, got b.obj"
    left_out(tmp_path, urdf(WHEELS, shapes=shapes), reason)


def test_too_many_corners_are_left_out(tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text("".join(f"v {k} 0 1\n" for k in range(300_001)))
    reason = "must, with the other meshes, have at most 300000 corners"
    left_out(tmp_path, with_mesh("m.obj"), reason)


FILLINGS = {"stl": ("\n", "vertex ", "vertex 1 "), "obj": ("\n", "v ", "v 1 1 ")}
"""Those that matter to a format: its own words, and the lines that once took for ever."""


@pytest.mark.parametrize(
    ("suffix", "filling"),
    [
        pytest.param(suffix, each, marks=() if each in FILLINGS[suffix] else pytest.mark.soak)
        for suffix in ("stl", "obj")
        for each in ("\n", " ", "vertex ", "v ", "vertex 1 ", "v 1 1 ", "\t\n")
    ],
)
def test_a_text_mesh_takes_time_by_its_size_alone(
    tmp_path: Path, suffix: str, filling: str
) -> None:
    """Millions of empty lines in a text STL took for ever: time was quadratic in their number."""
    (tmp_path / f"m.{suffix}").write_text("solid\n" + filling * (5_000_000 // len(filling)))
    start = time.perf_counter()
    left_out(tmp_path, with_mesh(f"m.{suffix}"), "must ")
    assert time.perf_counter() - start < 12.0


@pytest.mark.parametrize("word", ["x", "nan", "inf", "1e9", "-1e300", "1e999", "\u0661", "1.2.3"])
def test_a_mesh_with_a_non_finite_corner_is_left_out(tmp_path: Path, word: str) -> None:
    (tmp_path / "m.obj").write_text(f"{OBJ}\nv 0 0 {word}")
    reason = "must (be a mesh that trimesh reads|have corners that are finite and at most 1e)"
    left_out(tmp_path, with_mesh("m.obj"), reason)


def test_a_binary_mesh_with_odd_bits_is_left_out(tmp_path: Path) -> None:
    facet = struct.pack("<12f", *[float("nan")] * 12) + b"\0\0"
    signalling = facet.replace(b"\0\0\xc0\x7f", b"\1\0\xa0\x7f")
    for data in (facet, signalling):
        (tmp_path / "m.stl").write_bytes(b"\0" * 80 + struct.pack("<I", 1) + data)
        left_out(tmp_path, with_mesh("m.stl"), "must have corners")


def test_a_mesh_of_a_package_has_the_same_limits(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "m.stl")
    text = with_mesh("package://p/m.stl")
    packages = {"p": tmp_path}
    left_out(tmp_path, text, "it is a pipe", packages=packages)
    outside = text.replace("p/m", "p/../../m")
    left_out(tmp_path, outside, "in the folder or package", packages=packages)


def test_an_include_is_not_larger_than_a_model(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    with (tmp_path / "part.xacro").open("wb") as file:
        file.truncate(5_000_000)
    text = f'{XACRO}\n<xacro:include filename="part.xacro"/></robot>'
    refused(tmp_path, text, "must have at most 4000000 bytes", "cart.xacro", trusted=True)


def test_a_child_process_that_hangs_is_ended_by_its_time_limit() -> None:
    wait = "import os; from crawler2d.reading import parsing; parsing.CLOCK = 0.1; parsing._limit()"
    done = subprocess.run([sys.executable, "-c", f"{wait}; os.read(os.pipe()[0], 1)"], check=False)
    assert done.returncode == -signal.SIGALRM


@pytest.mark.skipif(not Path("/proc/self/statm").is_file(), reason="asks Linux for its size")
@pytest.mark.parametrize(("size", "end"), [(20_000_000, ""), (100_000_000, "MemoryError")])
def test_a_child_process_gets_no_more_memory_than_its_limit(size: int, end: str) -> None:
    limit = "from crawler2d.reading import parsing; parsing.MEGABYTES = 50; parsing._limit()"
    command = [sys.executable, "-c", f"{limit}; bytearray({size})"]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False)
    assert done.stderr.strip().rpartition("\n")[2] == end
