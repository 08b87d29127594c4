"""A file in another unit of length is read, and written, as if it were in metres."""

import re
from pathlib import Path

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.patching.patch import patch_file
from crawler2d.reading.loading import _scale_lengths
from tests.kept import refusing
from tests.reading.carts import FILES, ROBOTS, SAID, pair, quietly, read, urdf


@pytest.mark.parametrize(
    "name",
    ["cart.sdf", "cart.urdf", "absolem.sdf", pytest.param("marv.sdf", marks=pytest.mark.soak)],
)
def test_a_file_in_tenths_is_the_robot_of_the_file_in_metres(tmp_path: Path, name: str) -> None:
    path = next(folder / name for folder in (FILES, ROBOTS) if (folder / name).is_file())
    usual = quietly(path)
    tenfold = quietly(path, scale=10.0, tolerance=0.01)
    (tmp_path / name).write_text(tenfold.text, encoding="utf-8")
    again = quietly(tmp_path / name, scale=0.1)
    own, other = usual.robot, again.robot
    assert other.mass == own.mass
    assert other.outline.axle_distance == pytest.approx(own.outline.axle_distance, rel=1e-9)
    assert other.moment_of_inertia == pytest.approx(own.moment_of_inertia, rel=1e-9)
    assert other.center_of_mass == pytest.approx(own.center_of_mass, abs=1e-9)
    for column in ("x", "y", "radius"):
        assert np.allclose(other.wheels()[column], own.wheels()[column], atol=1e-9)
    assert tenfold.robot.outline.axle_distance == pytest.approx(10 * own.outline.axle_distance)


def test_lines_are_those_of_the_file() -> None:
    usual, scaled = quietly(ROBOTS / "absolem.sdf"), quietly(ROBOTS / "absolem.sdf", scale=0.5)
    assert scaled.sources["robot.mass"] == usual.sources["robot.mass"]
    assert scaled.text.count("\n") == usual.text.count("\n")


def test_the_engineer_that_is_ten_times_too_large_says_so_and_is_read_a_tenth_as_large() -> None:
    large = quietly(ROBOTS / "eng.urdf", mesh="leave_out")
    assert any("scale=0.1 would correct that" in warning for warning in large.warnings)
    found = quietly(ROBOTS / "eng.urdf", mesh="leave_out", scale=0.1)
    assert found.robot.outline.axle_distance == pytest.approx(0.372)
    assert found.robot.mass == large.robot.mass
    assert not any("scale=" in warning for warning in found.warnings)


def test_a_changed_file_is_written_in_metres(tmp_path: Path) -> None:
    found = quietly(ROBOTS / "eng.urdf", mesh="leave_out", scale=0.1)
    patch = patch_file(found, found.robot.with_track(c2d.LineOfWheels(3)))
    assert "all lengths times 0.1" in patch.summary
    (tmp_path / "eng.urdf").write_text(patch.text, encoding="utf-8")
    again = quietly(tmp_path / "eng.urdf", mesh="leave_out")
    assert again.robot.track == c2d.LineOfWheels(3)
    assert again.robot.outline.axle_distance == pytest.approx(0.372)
    before, after = (
        re.findall(r'<mesh [^>]*scale="(\S+)', each)
        for each in ((ROBOTS / "eng.urdf").read_text(encoding="utf-8"), patch.text)
    )
    assert [float(scale) for scale in after] == pytest.approx([0.1 * float(b) for b in before])


def test_a_mesh_has_its_own_scale_times_that_of_the_file() -> None:
    """A mesh without a scale gets that of the file."""
    text = (ROBOTS / "absolem.sdf").read_text(encoding="utf-8")
    with_scale = text.count("<scale>0.001 0.001 0.001</scale>")
    assert 0 < with_scale < text.count("<mesh>")
    found = quietly(ROBOTS / "absolem.sdf", scale=0.5)
    assert found.text.count("<scale>0.0005 0.0005 0.0005</scale>") == with_scale
    assert found.text.count("<scale>0.5 0.5 0.5</scale>") == text.count("<mesh>") - with_scale


LENGTHS = {
    "origin": ("xyz",),
    "box": ("size",),
    "capsule": ("radius", "length"),
    "cone": ("radius", "length"),
    "cylinder": ("radius", "length"),
    "ellipsoid": ("radii",),
    "heightmap": ("size", "pos"),
    "mesh": ("scale",),
    "plane": ("size",),
    "polyline": ("point", "height"),
    "sphere": ("radius",),
}


@pytest.mark.parametrize("tag", LENGTHS)
def test_every_length_of_a_shape_is_scaled_in_attributes_and_elements(tag: str) -> None:
    names = LENGTHS[tag]
    given = "".join(f' {name}="1 2"' for name in names)
    inside = "".join(f"<{name}>3</{name}>" for name in names)
    text = f'<a><{tag}{given} rpy="1"/><{tag}>{inside}<more>1</more></{tag}></a>'
    scaled = text.replace('="1 2"', '="2 4"').replace(">3<", ">6<")
    assert _scale_lengths(text.encode(), 2.0, "cart").decode() == scaled


def test_limits_of_slides_and_tensors_are_scaled_and_no_angles() -> None:
    text = """<a><joint type="{}"><limit lower="-1" upper="2" velocity="3" effort="4"/></joint>
<inertia ixx="1" ixy="1" ixz="1" iyy="1" iyz="1" izz="1"/><pose>1 2 3 0.1 0.2 0.3</pose></a>"""
    scaled = text.replace('="1"', '="4.0"').replace("1 2 3 0.1", "2 4 6 0.1")
    turns, slides = text.format("revolute"), text.format("prismatic")
    assert _scale_lengths(turns.encode(), 2.0, "cart").decode() == scaled.format("revolute")
    moved = scaled.replace('"-1" upper="2" velocity="3"', '"-2" upper="4" velocity="6"')
    assert _scale_lengths(slides.encode(), 2.0, "cart").decode() == moved.format("prismatic")


@pytest.mark.parametrize("scale", [0.0, -1.0, float("nan"), 1e9, "0.1", True])
def test_an_invalid_scale_is_refused(scale: object) -> None:
    with refusing(SAID, "scale"):
        quietly(ROBOTS / "absolem.sdf", scale=scale)


def test_mjcf_cannot_be_scaled() -> None:
    with refusing(SAID, "must be 1 for MJCF"):
        quietly(FILES / "cart.xml", scale=0.1)


def test_a_file_in_millimetres_is_refused_with_the_scale_that_corrects_it(tmp_path: Path) -> None:
    with refusing(SAID, r"scale=0\.001 would correct that"):
        read(tmp_path, urdf(pair("front", 200.0), pair("rear", -200.0)))


def test_a_mesh_without_a_scale_gets_that_of_the_file() -> None:
    urdf = '<robot><mesh filename="m.stl"{}/></robot>'
    scaled = _scale_lengths(urdf.format("").encode(), 0.5, "cart").decode()
    assert scaled == urdf.format(' scale="0.5 0.5 0.5"')
    sdf = "<sdf><mesh><uri>m.stl</uri>{}</mesh></sdf>"
    scaled = _scale_lengths(sdf.format("").encode(), 0.5, "cart").decode()
    assert scaled == sdf.format("<scale>0.5 0.5 0.5</scale>")
