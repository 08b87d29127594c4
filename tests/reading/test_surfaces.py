"""Fixed drums, free wheels and castors are read as the track that they represent."""

import math
import re
from pathlib import Path

import pytest

import crawler2d as c2d
from tests.reading.carts import (
    ACROSS,
    FILES,
    LIMIT,
    SIDES,
    WHEELS,
    collision,
    link,
    pair,
    read,
    refused,
    urdf,
    wheel,
)

DRUM = '<cylinder radius="{radius}" length="0.05"/>'


def drums(name: str, x: float, radius: float = 0.08, parent: str = "hull", y: float = 0.15) -> str:
    """Two fixed cylinders across, left and right."""
    shape = collision(DRUM.format(radius=radius), ACROSS)
    return "".join(
        link(f"{side}_{name}", 'type="fixed">', f"{x} {sign * y} 0", parent=parent).replace(
            "</link>", f"{shape}</link>"
        )
        for side, sign in SIDES
    )


def motors(*ends: str) -> str:
    names = [f"{side}_{end}_joint" for side, _ in SIDES for end in ends]
    return "".join(
        f'<transmission name="t"><joint name="{name}"/></transmission>' for name in names
    )


def arms(x: float, tip: float, *, root: float | None = 0.0) -> str:
    """Flippers with two fixed drums each, or with one at the tip."""
    kind = 'type="revolute"><axis xyz="0 1 0"/>' + LIMIT
    parts = []
    for side, sign in SIDES:
        name = f"{side}_arm{x}"
        parts.append(link(name, kind, f"{x} {sign * 0.25} 0"))
        for at in (tip, root) if root is not None else (tip,):
            shape = collision(DRUM.format(radius=0.06), ACROSS)
            fixed = link(f"{name}_{at}", 'type="fixed">', f"{at} 0 0", parent=name)
            parts.append(fixed.replace("</link>", f"{shape}</link>"))
    return "".join(parts)


def test_fixed_drums_that_nothing_moves_are_a_belt(tmp_path: Path) -> None:
    found = read(tmp_path, urdf(drums("front", 0.2), drums("rear", -0.2, 0.06)))
    assert found.robot.track == c2d.BeltTrack()
    outline = found.robot.outline
    assert (outline.axle_distance, outline.front_radius, outline.rear_radius) == (0.4, 0.08, 0.06)
    assert "are not moved by anything in the file" in found.warnings[0]
    assert "4 fixed drums: left_front, left_rear, right_front, right_rear" in found.warnings[0]


def test_a_sprocket_and_a_fixed_idler_are_a_belt_and_the_sprocket_has_the_torque(
    tmp_path: Path,
) -> None:
    found = read(tmp_path, urdf(pair("front", 0.2), drums("rear", -0.2)))
    assert found.robot.track == c2d.BeltTrack()
    assert found.robot.drivetrain.max_torque == 5.0
    assert found.robot.outline.axle_distance == 0.4
    assert "stand still, unlike the wheel on their side" in found.warnings[0]


def test_a_box_between_the_drums_is_no_belly(tmp_path: Path) -> None:
    between = collision('<box size="0.4 0.4 0.16"/>')
    parts = (pair("front", 0.2), drums("rear", -0.2))
    assert read(tmp_path, urdf(*parts, shapes=between)).robot.belly is None
    above = collision('<box size="0.4 0.4 0.3"/>')
    assert read(tmp_path, urdf(*parts, shapes=above)).robot.belly is not None


def test_fixed_cylinders_with_more_wheels_are_part_of_the_belly(tmp_path: Path) -> None:
    found = read(tmp_path, urdf(WHEELS, drums("skid", 0.4)))
    assert found.robot.track == c2d.LineOfWheels(2)
    assert found.robot.belly is not None
    assert not any("drums" in warning for warning in found.warnings)


def test_fixed_cylinders_above_a_lower_hull_are_no_track(tmp_path: Path) -> None:
    low = collision('<box size="0.4 0.2 0.4"/>')
    text = urdf(drums("front", 0.2), drums("rear", -0.2), shapes=low)
    refused(tmp_path, text, "must have wheels")


def test_a_cylinder_across_both_sides_is_no_drum(tmp_path: Path) -> None:
    bumper = collision('<cylinder radius="0.08" length="0.4"/>', ACROSS)
    text = urdf(shapes=bumper + bumper.replace("rpy", 'xyz="0.3 0 0" rpy'))
    refused(tmp_path, text, "must have wheels")


def test_fixed_drums_on_flippers_are_belts_and_their_root_is_on_the_pivot(tmp_path: Path) -> None:
    found = read(tmp_path, urdf(WHEELS, arms(0.2, 0.2), arms(-0.2, -0.2)))
    flippers = found.robot.flippers
    assert flippers is not None
    assert flippers.track == c2d.BeltTrack()
    assert (flippers.length, flippers.root_radius, flippers.tip_radius) == (0.2, 0.06, 0.06)
    assert flippers.ends == "both"


def test_a_drum_at_the_tip_alone_is_no_flipper(tmp_path: Path) -> None:
    found = read(tmp_path, urdf(WHEELS, arms(0.2, 0.2, root=None)))
    assert found.robot.flippers is None


@pytest.mark.parametrize("end", ["front", "rear"])
def test_a_sprocket_may_be_at_either_end_of_a_flipper(tmp_path: Path, end: str) -> None:
    """If all sprockets are in front, that of a rear flipper is on its pivot."""
    kind = 'type="revolute"><axis xyz="0 1 0"/>' + LIMIT
    sprocket, idler = ("0 0 0", 0.2) if end == "rear" else ("0.2 0 0", 0.0)
    parts = []
    for side, sign in SIDES:
        parts.append(link(f"{side}_arm", kind, f"0.2 {sign * 0.25} 0"))
        parts.append(wheel(f"{side}_sprocket", sprocket, parent=f"{side}_arm", radius="0.06"))
        shape = collision(DRUM.format(radius=0.06), ACROSS)
        fixed = link(f"{side}_idler", 'type="fixed">', f"{idler} 0 0", parent=f"{side}_arm")
        parts.append(fixed.replace("</link>", f"{shape}</link>"))
    flippers = read(tmp_path, urdf(WHEELS, *parts)).robot.flippers
    assert flippers is not None
    assert (flippers.track, flippers.length) == (c2d.BeltTrack(), 0.2)


def test_wheels_without_a_motor_beside_driven_ones_get_a_warning(tmp_path: Path) -> None:
    text = urdf(WHEELS, pair("mid", 0.0, radius="0.05"), motors("front", "rear"))
    found = read(tmp_path, text)
    assert len(found.wheels) == 6
    assert "left_mid, right_mid" in found.warnings[0]
    assert "read as driven" in found.warnings[0]


@pytest.mark.parametrize("limit", ["", '<limit effort="5" velocity="10"/>'])
def test_freely_rolling_wheels_add_no_torque(tmp_path: Path, limit: str) -> None:
    """Whether its joint states a limit or none, that of the driven wheel is that of its side."""
    text = urdf(pair("front", 0.2, limit=limit), pair("rear", -0.2), motors("rear"))
    found = read(tmp_path, text)
    assert found.robot.drivetrain.max_torque == 5.0
    assert found.robot.drivetrain.torque_sharing == "track"
    assert len(found.sources["robot.drivetrain.max_torque"].split(", ")) == 2


def test_freely_rolling_wheels_leave_the_servos_of_the_others(tmp_path: Path) -> None:
    """Of five wheels a side four have a gain of 10 N m s/rad, and 5 N m; one is half as large."""
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    text = re.sub(r'<velocity joint="\w+_middle_joint".*?/>', "", text)
    drivetrain = read(tmp_path, text, "cart.xml").robot.drivetrain
    assert drivetrain.max_torque == pytest.approx(3.0 * 5.0 + 2.0 * 5.0)
    assert drivetrain.controller == c2d.PI(gain=3.0 * 10.0 + 4.0 * 10.0)


def test_wheels_on_flippers_that_roll_freely_get_a_warning(tmp_path: Path) -> None:
    """They are simulated with motors, like those of the chassis."""
    pytest.importorskip("mujoco")
    text = (FILES / "cart.xml").read_text(encoding="utf-8")
    text = re.sub(r'<velocity joint="\w+_flipper_(root|tip)_joint".*?/>', "", text)
    reading = read(tmp_path, text, "cart.xml")
    (warning,) = [each for each in reading.warnings if "roll freely" in each]
    assert "left_flipper_root" in warning
    assert "read as driven" in warning
    assert reading.robot.drivetrain.max_torque == pytest.approx(3.0 * 5.0)
    assert reading.robot.drivetrain.torque_sharing == "track"


def test_a_differential_drive_in_a_urdf_names_its_motors(tmp_path: Path) -> None:
    """As in SDF: a castor is not a wheel without partner, and the other wheels roll freely."""
    joints = "".join(f"<{side}_joint>{side}_rear_joint</{side}_joint>" for side, _ in SIDES)
    plugin = f'<gazebo><plugin name="diff_drive" filename="x">{joints}</plugin></gazebo>'
    found = read(tmp_path, urdf(WHEELS, wheel("castor", "0.3 0 -0.05", radius="0.03"), plugin))
    assert found.tree.driven.keys() == {f"{side}_rear_joint" for side, _ in SIDES}
    assert "castor" in found.warnings[0]
    assert "left_front, right_front" in found.warnings[1]
    assert len(found.wheels) == 4


def test_castors_in_the_middle_are_skids_of_the_belly(tmp_path: Path) -> None:
    castors = wheel("trailing", "-0.3 0 -0.05", radius="0.03") + wheel(
        "leading", "0.3 0 -0.05", radius="0.03"
    )
    found = read(tmp_path, urdf(WHEELS, castors, motors("front", "rear")))
    assert found.robot.track == c2d.LineOfWheels(2)
    assert found.robot.belly is not None
    assert min(y for _, y in found.robot.belly) == pytest.approx(-0.08)
    assert "trailing, leading" in found.warnings[0]


def test_one_wheel_a_side_with_castors_stands_on_all_three(tmp_path: Path) -> None:
    castors = wheel("trailing", "-0.3 0 -0.049", radius="0.03") + wheel(
        "leading", "0.2 0 -0.049", radius="0.03"
    )
    found = read(tmp_path, urdf(pair("front", 0.0), castors, motors("front")))
    assert found.robot.outline.discs is not None
    assert len(found.robot.outline.discs) == 3
    assert len(found.robot.wheels()) == 2
    assert c2d.simulate(found.robot, c2d.terrains.flat()).outcome == "cleared"


@pytest.mark.parametrize(("kind", "wheels"), [("fixed", 3), ("continuous", 2)])
def test_a_wheel_on_which_another_link_turns_is_no_wheel(
    tmp_path: Path, kind: str, wheels: int
) -> None:
    turning = f'type="{kind}">'
    caps = "".join(link(f"{side}_cap", turning, parent=f"{side}_mid") for side, _ in SIDES)
    found = read(tmp_path, urdf(WHEELS, pair("mid", 0.0), caps))
    assert len(found.wheels) == 2 * wheels
    told = "left_mid, right_mid: move by themselves, and touch nothing here" in found.notes
    assert told == (kind == "continuous")


@pytest.mark.parametrize("ahead", [1.0, -1.0])
@pytest.mark.parametrize(("radius", "lower"), [("0.08", 0.0), ("0.03", -0.05)])
def test_one_wheel_a_side_may_trail_a_castor_or_push_it(
    tmp_path: Path, ahead: float, radius: str, lower: float
) -> None:
    castor = wheel("castor", f"{0.2 * ahead} 0 {lower}", radius=radius)
    text = urdf(pair("own", -0.2 * ahead), castor, motors("own"))
    robot = read(tmp_path, text).robot
    assert len(robot.wheels()) == 2
    assert robot.outline.axle_distance == pytest.approx(math.hypot(0.4, lower))
    at_rear, at_front = (0.08, float(radius))[:: int(ahead)]
    assert robot.outline.rear_radius == pytest.approx(at_rear)
    assert robot.outline.front_radius == pytest.approx(at_front)


def test_flippers_lighter_than_the_core_can_move_get_the_least_mass(tmp_path: Path) -> None:
    text = urdf(WHEELS, arms(0.2, 0.2)).replace('<mass value="0.5"/>', '<mass value="1e-5"/>')
    found = read(tmp_path, text)
    assert found.robot.flippers is not None
    assert found.robot.flippers.mass == pytest.approx(1e-5 * found.robot.mass, rel=0.01)
    assert any("is too light to simulate" in warning for warning in found.warnings)
    found.robot.wheels()


def test_a_shape_that_stands_a_little_out_of_a_flipper_is_left_out_with_a_warning(
    tmp_path: Path,
) -> None:
    def with_box(height: float) -> str:
        box = collision(f'<box size="0.2 0.05 {height}"/>', '<origin xyz="0.1 0 0"/>')
        text = urdf(WHEELS, arms(0.2, 0.2))
        for side, _ in SIDES:
            start = text.index(f'<link name="{side}_arm0.2">')
            end = text.index("</link>", start)
            text = text[:end] + box + text[end:]
        return text

    found = read(tmp_path, with_box(0.13))
    assert any("5 mm beyond it" in warning for warning in found.warnings)
    refused(tmp_path, with_box(0.2), "must lie within the envelope of its flipper's wheels")


def test_a_moved_box_above_the_upper_run_is_belly(tmp_path: Path) -> None:
    """Such as boxes for a tensioned run, which meet no obstacle before the belt."""
    shape = collision(DRUM.format(radius=0.08), ACROSS)
    roof = collision('<box size="0.2 0.05 0.02"/>', '<origin xyz="0.2 0 0.09"/>')
    tracks = "".join(
        link(f"{side}_track", 'type="fixed">', f"-0.2 {sign * 0.15} 0").replace(
            "</link>", shape + shape.replace("rpy", 'xyz="0.4 0 0" rpy') + roof + "</link>"
        )
        for side, sign in SIDES
    )
    found = read(tmp_path, urdf(tracks), tracks=["left_track", "right_track"])
    assert found.robot.track == c2d.BeltTrack()
    assert found.robot.belly is not None
    assert any("20 mm" in warning and "read as belly" in warning for warning in found.warnings)
