"""The last value on either side of each limit of the reader."""

import math
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.reading import mjcf
from crawler2d.reading.xacro import Settings
from tests.kept import refusing
from tests.reading.carts import FILES, SAID, SIDES, WHEELS, link, pair, read, refused, urdf
from tests.reading.test_gear_wheels import gear, wheel_of
from tests.reading.test_surfaces import arms, motors


def turns(count: int) -> list[float]:
    return [2.0 * math.pi * k / count for k in range(count)]


def test_a_gear_wheel_has_three_grousers_at_least(tmp_path: Path) -> None:
    three = [gear(name, x, turns=turns(3)) for name, x in (("front", 0.2), ("rear", -0.2))]
    assert wheel_of(tmp_path, *three).grouser_count == 3
    two = [gear(name, x, turns=turns(2)) for name, x in (("front", 0.2), ("rear", -0.2))]
    refused(tmp_path, urdf(*two), "must have wheels")


def test_a_heavy_link_keeps_a_moment_of_inertia_that_it_cannot_have(tmp_path: Path) -> None:
    usual, large = urdf(WHEELS), urdf(WHEELS).replace('iyy="0.2"', 'iyy="9"', 1)
    found = read(tmp_path, large)
    before = read(tmp_path, usual).robot.moment_of_inertia
    assert found.robot.moment_of_inertia == pytest.approx(before + 8.8, rel=1e-12)
    assert "is kept" in found.warnings[0]


def test_a_light_link_has_no_more_than_the_reach_of_the_robot_allows(tmp_path: Path) -> None:
    """8 of its 12 kg are the hull; 0.09 kg are light, and 0.13 kg are not."""
    for mass, is_light in ((0.09, True), (0.13, False)):
        mast = f"""<link name="mast"><inertial><mass value="{mass}"/><inertia ixx="9" ixy="0"
        ixz="0" iyy="9" iyz="0" izz="9"/></inertial></link><joint name="m" type="fixed">
        <parent link="hull"/><child link="mast"/></joint>"""
        found = read(tmp_path, urdf(WHEELS, mast))
        assert ("is taken as" if is_light else "is kept") in found.warnings[0]
        assert (found.robot.moment_of_inertia < 9.0) is is_light


def test_names_of_more_than_four_wheels_are_counted(tmp_path: Path) -> None:
    free = [pair(f"w{n}", 0.05 * n, radius="0.05") for n in range(-1, 2)]
    reading = read(tmp_path, urdf(WHEELS, *free, motors("front", "rear")))
    assert reading.warnings[0].endswith("left_w-1, right_w-1, left_w0, right_w0 and 2 more")


def test_doubtful_figures_get_a_warning(tmp_path: Path) -> None:
    path = tmp_path / "cart.urdf"
    path.write_text(urdf(WHEELS, '<link name="stray"/>'), encoding="utf-8")
    with pytest.warns(c2d.ScenarioWarning, match=r"^cart\.urdf:33: link\[stray\] is left out"):
        c2d.read_robot(path)


TURN = "<limit><lower>-{0}</lower><upper>{0}</upper><effort>5</effort><velocity>10</velocity>"
FREE = "<limit><effort>5</effort><velocity>10</velocity>"


@pytest.mark.parametrize(("limit", "is_wheel"), [("6.2831", True), ("6.27", False)])
def test_a_range_of_two_turns_is_no_limit_up_to_rounding(
    tmp_path: Path, limit: str, *, is_wheel: bool
) -> None:
    """Also where a world has two models, of which the one that drives is read."""
    text = (FILES / "cart.sdf").read_text(encoding="utf-8")
    turned = text.replace(FREE, TURN.format(limit))
    assert turned.count("<lower>") == 8 + text.count("<lower>")
    crate = '<model name="crate"><link name="l"/></model>'
    world = turned.replace("<model name", f"<world name='w'>{crate}<model name", 1)
    world = world.replace("</sdf>", "</world></sdf>")
    if is_wheel:
        assert len(read(tmp_path, turned, "cart.sdf").wheels) == 10
        assert len(read(tmp_path, world, "cart.sdf").wheels) == 10
    else:
        refused(tmp_path, turned, "must lie within the envelope of its flipper", "cart.sdf")


def test_a_weight_off_the_axle_counts_by_the_square_of_its_distance(tmp_path: Path) -> None:
    """0.5 kg with 0.003 kg m^2 of its own, 30 mm ahead and 40 mm up, on each of four wheels."""
    weights = (
        link(f"{side}_{end}_weight", 'type="fixed">', "0.03 0 0.04", parent=f"{side}_{end}")
        for side, _ in SIDES
        for end in ("front", "rear")
    )
    inertia = 0.003 + 0.003 + 0.5 * 0.05**2
    found = read(tmp_path, urdf(WHEELS, *weights)).robot.track_mass
    assert found == pytest.approx(4.0 * inertia / 0.08**2, rel=1e-9)


def test_a_flipper_pivots_within_a_twentieth_of_the_axle_distance_from_its_end(
    tmp_path: Path,
) -> None:
    """Of 0.4 m: beyond the tolerance of 1 mm with a doubt, beyond a tenth of that with a note."""
    told = "joint[left_arm0.181_joint] pivots 19 mm off the end axle, here on it, got front"
    assert told in read(tmp_path, urdf(WHEELS, arms(0.181, 0.2))).warnings
    near = read(tmp_path, urdf(WHEELS, arms(0.1995, 0.2)))
    assert "the front flippers pivot 0.5 mm off the end axle, here on it" in near.notes
    assert not [doubt for doubt in near.warnings if "pivot" in doubt]
    on_it = read(tmp_path, urdf(WHEELS, arms(0.19995, 0.2)))
    assert not [each for each in (*on_it.notes, *on_it.warnings) if "pivot" in each]
    refused(tmp_path, urdf(WHEELS, arms(0.179, 0.2)), "must pivot within 5% of the axle distance")


class Folder:
    """Files of settings in memory, each read within its limit."""

    def __init__(self, texts: dict[str, str]) -> None:
        self.texts = texts
        self.folder = self
        self.packages = self

    def files(self, suffixes: tuple[str, ...]) -> list[Path]:
        return [Path(name) for name in self.texts if name.endswith(suffixes)]

    def read(self, name: str, *, at: str, most: int) -> bytes:
        if len(self.texts[name]) > most:
            raise c2d.ScenarioError(at, len(self.texts[name]), f"must have at most {most} bytes")
        return self.texts[name].encode()

    def __fspath__(self) -> str:
        return "."


def test_settings_are_looked_up_in_a_hundred_files_of_a_megabyte_together() -> None:
    many = {f"{n}.yaml": f"a{n}: {n}\n" for n in range(101)}
    found, differing = Settings(Folder(many)).of(["a0", "a99", "a100"])  # type: ignore[arg-type]
    assert (sorted(found), differing) == (["a0", "a99"], [])
    large = {f"{n}.yml": f"a{n}: {n}\n".ljust(64_000, "#") for n in range(17)}
    large |= {"larger.yml": "b: 1\n".ljust(64_001, "#"), "text.txt": "c: 1\n"}
    settings = Settings(Folder(large))  # type: ignore[arg-type]
    # Fifteen have 960,000 bytes, and 40,000 are left.
    assert [settings.have(f"a{n}", f"{n}.0") for n in (0, 14, 15)] == [True, True, False]
    assert not settings.have("b", "1")
    assert not settings.have("c", "1")


def test_settings_that_differ_are_named_with_their_files_and_lines() -> None:
    texts = {"a.yaml": "x: 1\ny: 'b' # c\n", "b.yaml": "\nx: 2\nz: ~\nw: [1]\nv: d#e\nu: 5 # six\n"}
    settings = Settings(Folder(texts))  # type: ignore[arg-type]
    assert settings.of(["x"]) == ({}, ["x is 1 in a.yaml:1, 2 in b.yaml:2"])
    found, differing = settings.of(["y", "v", "u"])
    assert differing == []
    assert {name: (each.file, each.line, each.value) for name, each in found.items()} == {
        "y": ("a.yaml", 2, "b"),
        "v": ("b.yaml", 5, "d#e"),
        "u": ("b.yaml", 6, "5"),
    }
    assert not settings.have("z", "~")
    assert not settings.have("w", "[1]")
    assert settings.have("x", "2")
    assert not settings.have("x", "3")


def answered(name: str, value: Any) -> dict[str, list[dict[str, Any]]]:
    """What MuJoCo is asked for, with one figure of a shape."""
    shape = {"line": 7, "name": "tip", "kind": "box", name: value}
    return {"bodies": [], "joints": [], "shapes": [shape], "motors": []}


MEASURES = ("place", "center", "size", "points", "mass", "inertia", "surface_velocity")


@pytest.mark.parametrize("name", MEASURES)
def test_measures_of_mjcf_are_at_most_a_million(name: str) -> None:
    mjcf._check_numbers(answered(name, [0.0, -1e6]), "a.xml")
    for value in ([0.0, -1.000001e6], 1e7, math.nan, [math.inf]):
        rule = rf"^a\.xml:7: shapes\[tip\]: {name} must be finite and at most 1e\+06 in magnitude"
        with refusing(SAID, rule):
            mjcf._check_numbers(answered(name, value), "a.xml")


def test_limits_of_mjcf_may_be_infinite_and_rotations_are_some() -> None:
    for name, value in (("effort", math.inf), ("velocity", 1e9), ("effort", None), ("turn", [1])):
        mjcf._check_numbers(answered(name, value), "a.xml")
    with refusing(SAID, "^a.xml:7: shapes.tip.: effort must be finite"):
        mjcf._check_numbers(answered("effort", math.nan), "a.xml")
    for name in ("turn", "axes"):
        with refusing(SAID, f"^a.xml:7: shapes.tip.: {name} must be a rotation, got 0.0$"):
            mjcf._check_numbers(answered(name, [0.0, 0.0, 0.0, 0.0]), "a.xml")
