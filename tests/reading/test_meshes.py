"""Meshes are read as hulls in a separate process, which opens no files and has limits."""

import os
import sys
import time
from pathlib import Path

import pytest

from crawler2d.reading.meshes import _unit
from tests.reading.carts import FILES, WHEELS, collision, left_out, quietly, read, urdf
from tests.reading.mesh_files import BOX, BOXES, HIGH, HOSTILE, LOW, dae, obj

BELLY = ((LOW[0], LOW[2]), (HIGH[0], LOW[2]), HIGH[::2], (LOW[0], HIGH[2]))


def with_meshes(*names: str) -> str:
    return urdf(WHEELS, shapes="".join(collision(f'<mesh filename="{n}"/>') for n in names))


def belly(folder: Path, name: str, data: bytes) -> tuple[tuple[float, float], ...] | None:
    (folder / name).write_bytes(data)
    reading = read(folder, with_meshes(name))
    assert not reading.warnings
    return reading.robot.belly


@pytest.mark.parametrize("name", BOXES)
def test_a_mesh_of_each_format_is_the_hull_of_its_corners(tmp_path: Path, name: str) -> None:
    """COLLADA in the unit that it states, whatever axis it says is up: as in Gazebo and RViz."""
    found = belly(tmp_path, name, BOXES[name])
    assert found is not None
    for corner, wanted in zip(found, BELLY, strict=True):
        assert corner == pytest.approx(wanted, abs=1e-6)  # float32 corners


def test_nodes_of_collada_place_what_is_in_them(tmp_path: Path) -> None:
    scene = f"""<node><translate>0 0 0.5</translate><scale>2 2 2</scale>
      <node><rotate>0 1 0 90</rotate>{BOX}</node></node>"""
    found = belly(tmp_path, "m.dae", dae(scene=scene))
    assert found is not None
    low, high = (min(found), max(found))
    assert low == pytest.approx((0.0, 0.3), abs=1e-6)
    assert high == pytest.approx((0.06, 0.7), abs=1e-6)


def test_a_suffix_may_have_capitals(tmp_path: Path) -> None:
    assert belly(tmp_path, "M.STL", BOXES["binary.stl"]) is not None


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_mesh_is_left_out_soon(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_bytes(HOSTILE[name])
    start = time.perf_counter()
    left_out(tmp_path, with_meshes(name), "is left out: (all meshes together )?must be")
    assert time.perf_counter() - start < 20.0


@pytest.mark.skipif(sys.platform == "win32", reason="has pipes of Unix")
def test_files_named_in_a_mesh_are_not_opened(tmp_path: Path) -> None:
    for name in ("paint.mtl", "paint.png"):
        os.mkfifo(tmp_path / name)
    material = "mtllib paint.mtl\nusemtl paint"
    assert belly(tmp_path, "m.obj", obj(material)) is not None
    image = """<library_images><image id="i"><init_from>paint.png</init_from></image>
      </library_images><library_effects><effect id="e"><profile_COMMON><newparam sid="s"><surface
      type="2D"><init_from>i</init_from></surface></newparam><newparam sid="t"><sampler2D>
      <source>s</source></sampler2D></newparam><technique sid="c"><phong><diffuse><texture
      texture="t" texcoord="u"/></diffuse></phong></technique></profile_COMMON></effect>
      </library_effects><library_materials><material id="m"><instance_effect url="#e"/></material>
      </library_materials>"""
    assert belly(tmp_path, "m.dae", dae(nodes=image)) is not None


def test_a_visual_mesh_is_not_searched_for(tmp_path: Path) -> None:
    visual = '<visual><geometry><mesh filename="package://no/where.dae"/></geometry></visual>'
    assert not read(tmp_path, urdf(WHEELS, shapes=visual)).warnings


def test_one_bad_mesh_leaves_the_others(tmp_path: Path) -> None:
    (tmp_path / "good.dae").write_bytes(BOXES["metres.dae"])
    (tmp_path / "bad.dae").write_bytes(b"<COLLADA/>")
    reading = read(tmp_path, with_meshes("bad.dae", "good.dae", "good.dae"))
    (warning,) = reading.warnings
    assert "must be a mesh that trimesh reads (" in warning
    assert reading.robot.belly is not None
    (link,) = (each for each in reading.tree.links if each.unread)
    assert [(each.name, len(link.shapes)) for each in link.unread] == [("bad.dae", 2)]


def test_part_of_a_mesh_is_left_out(tmp_path: Path) -> None:
    (tmp_path / "m.stl").write_bytes(BOXES["binary.stl"])
    text = (Path(__file__).parent / "files" / "cart.sdf").read_text()
    box = "<box><size>0.5 0.25 0.125</size></box>"
    assert box in text
    part = "<mesh><uri>m.stl</uri><submesh><name>lid</name></submesh></mesh>"
    left_out(tmp_path, text.replace(box, part), "only a part of it, lid", "cart.sdf")


@pytest.mark.usefixtures("children_of_its_own")
def test_an_existing_mesh_needs_the_extra(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A robot must not depend on installed packages, so the mesh is not left out."""
    (tmp_path / "site").mkdir()
    raising = "raise ModuleNotFoundError('no', name='trimesh')"
    (tmp_path / "site" / "trimesh.py").write_text(raising)
    path = os.pathsep.join([str(tmp_path / "site"), *sys.path])
    monkeypatch.setenv("PYTHONPATH", path)
    assert read(tmp_path, with_meshes("m.stl")).robot.belly is None
    (tmp_path / "m.stl").write_bytes(BOXES["binary.stl"])
    with pytest.raises(ImportError, match=r"pip install 'crawler2d\[models\]'"):
        read(tmp_path, with_meshes("m.stl"))
    assert read(tmp_path, with_meshes("m.stl"), mesh="leave_out").robot.belly is None


@pytest.mark.parametrize("meter", ["0", "-0.5", "nan"])
def test_a_unit_of_collada_that_is_no_length_is_told(meter: str) -> None:
    data = dae().replace(b'meter="1.0"', f'meter="{meter}"'.encode())
    with pytest.raises(ValueError, match=rf"^its unit is {meter} m$"):
        _unit(data)


@pytest.mark.parametrize(
    ("weight", "is_told"),
    [
        *(("", True), ('mass="1"', True), ('mass="1" density="0"', True)),
        *(('density="0"', False), ('mass="0"', False), ('mass="0" density="500"', False)),
    ],
)
def test_a_missing_mesh_of_mjcf_lacks_mass_only_where_it_would_have_some(
    tmp_path: Path, weight: str, is_told: bool
) -> None:
    """A mass that is stated counts in place of the density."""
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    inertial = '<inertial pos="0 0 0" mass="16" diaginertia="0.125 0.5 0.5"/>'
    geom = f'<geom type="mesh" mesh="lump" contype="0" conaffinity="0" {weight}/>'
    asset = '<asset><mesh name="lump" file="lump.stl"/></asset><worldbody>'
    path = tmp_path / "cart.xml"
    path.write_text(text.replace(inertial, geom).replace("<worldbody>", asset), encoding="utf-8")
    lost = [each for each in quietly(path).warnings if "lump.stl" in each]
    assert ["its volume counts in MuJoCo" in each for each in lost] == [True] * is_told
