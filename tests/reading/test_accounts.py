"""Readings of files with a bit of everything are, line by line, as in `accounts`."""

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.reading.wheels import farthest
from tests.kept import check_kept
from tests.reading.carts import WHEELS, pair, quietly, urdf
from tests.reading.telling import account
from tests.reading.test_gear_wheels import gear
from tests.reading.test_surfaces import arms, drums

KEPT = Path(__file__).parent / "accounts"

GENERATED = {
    "gears.urdf": urdf(*(gear(f"w{n}", 0.1 * n * n, turn=0.3 * n) for n in (1, 2, 3))),
    "drums.urdf": urdf(
        pair("front", 0.2), drums("rear", -0.2, 0.06), arms(0.2, 0.25), arms(-0.2, -0.25)
    ),
    "bare.urdf": urdf(WHEELS).replace('<limit effort="5" velocity="10"/>', ""),
}
"""Gear wheels that stand unevenly, a sprocket with fixed drums, and wheels without limits."""


def told(folder: Path, name: str, **how: Any) -> list[str]:
    """Return the lines of the account of a file that is stored or generated."""
    path = KEPT / name
    if name in GENERATED:
        path = folder / name
        path.write_text(GENERATED[name], encoding="utf-8")
    elif path.suffix == ".xml":
        pytest.importorskip("mujoco")
    return account(quietly(path, **how)).splitlines()


@pytest.mark.parametrize("name", ["odd.urdf", "odd.sdf", "odd.xml", *GENERATED])
def test_a_file_is_read_as_its_account_says(tmp_path: Path, name: str) -> None:
    check_kept(KEPT / f"{name}.txt", "\n".join(told(tmp_path, name)))


@pytest.mark.parametrize(
    ("name", "how"),
    [
        *(("odd.urdf", {"engine": each}) for each in ("classic", "bullet", "mujoco", "isaac")),
        ("odd.urdf", {"forward": "-y"}),
        ("odd.urdf", {"ground_friction": 0.5}),
        ("odd.sdf", {"mesh": "leave_out"}),
        ("odd.sdf", {"scale": 0.5}),
        ("odd.xml", {"engine": "gz"}),
        ("bare.urdf", {"engine": "mujoco"}),
    ],
    ids=lambda value: value if isinstance(value, str) else "-".join(map(str, *value.items())),
)
def test_a_keyword_changes_these_lines_of_an_account(
    tmp_path: Path, name: str, how: dict[str, Any]
) -> None:
    usual = told(tmp_path, name)
    changed = [line for line in told(tmp_path, name, **how) if line not in usual]
    kept = KEPT / f"{name}.{'-'.join(map(str, *how.items()))}.txt"
    check_kept(kept, "\n".join(changed))


@pytest.mark.parametrize("name", ["odd.urdf", "drums.urdf", "gears.urdf"])
def test_a_robot_is_the_same_wherever_it_stands_in_its_model(tmp_path: Path, name: str) -> None:
    """Moved by metres and turned, on its own link; the rounding error is 1e-12 of that."""
    text = GENERATED[name] if name in GENERATED else (KEPT / name).read_text(encoding="utf-8")
    usual, moved = tmp_path / "usual.urdf", tmp_path / "moved.urdf"
    usual.write_text(text, encoding="utf-8")
    link = "hull" if name in GENERATED else "base"
    ground = f"""<link name="ground"/><joint name="j" type="fixed"><parent link="ground"/>
        <child link="{link}"/><origin xyz="3 -7 0.5" rpy="0 0 {math.pi / 2}"/></joint></robot>"""
    moved.write_text(text.replace("</robot>", ground), encoding="utf-8")
    forward = {} if name == "odd.urdf" else {"forward": "+y"}
    found, wanted = quietly(moved, **forward), quietly(usual)
    assert [float(each) for each in numbers(found)] == pytest.approx(
        [float(each) for each in numbers(wanted)], abs=1e-8
    )
    assert len(found.warnings) == len(wanted.warnings)


def numbers(reading: c2d.Reading) -> list[str]:
    """Return the figures of a robot, and of its wheels, as text."""
    said = repr(reading.robot) + repr(reading.wheels["radius"].tolist())
    return re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", said)


def test_the_farthest_point_of_a_shape_is_a_corner_or_beyond_its_axis() -> None:
    shapes = {
        each.name: each for link in quietly(KEPT / "odd.urdf").tree.links for each in link.shapes
    }
    origin = np.zeros(3)
    found = {name: farthest(shapes[name], origin) for name in ("body", "nose", "tail", "lidar")}
    # The box is turned about z, by which no corner gets farther; its middle is 0.3 m up.
    assert found["body"] == pytest.approx(math.sqrt(0.15**2 + 0.25**2 + 0.35**2))
    assert found["nose"] == pytest.approx(math.hypot(0.3, 0.3) + 0.05)
    # Of a capsule or cylinder it is at most the sum of the distance and of half the diagonal.
    assert found["tail"] == pytest.approx(math.hypot(0.3, 0.32) + math.hypot(0.03, 0.05) + 0.03)
    assert found["lidar"] == pytest.approx(0.45 + math.hypot(0.04, 0.025))
    lid = shapes["lid"]
    assert farthest(lid, lid.pose.place) == pytest.approx(0.2, rel=2e-3)  # of chords
