"""Presets agree with their files: every line they name, every sum over links, every wheel.

The files are public models, unchanged, in `tests/robots`; its README says where each is from.
"""

import dataclasses
import math
import re
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from tests.robots import robot_files
from tests.robots.robot_files import FOLDER, Array, Link, Masses, together

ABSOLEM, SPECIFICATION, MARV = "absolem.sdf", "absolem_specifications.md", "marv.sdf"
GAZEBO, ENGINEER = "tracked_vehicle_simple.sdf", "eng.xacro"
FILES = {ABSOLEM: c2d.robots.absolem, MARV: c2d.robots.marv}
PRESETS = {name: getattr(c2d.robots, name)() for name in c2d.robots.__all__}

# [m] Height of the axles in the frame of the model, of Absolem and of Gazebo's vehicle.
AXLES = 0.01855


def arms(preset: str) -> c2d.Flippers:
    robot: c2d.Robot = PRESETS[preset]
    assert robot.flippers is not None
    return robot.flippers


# File, line, its text, and which of its numbers are values of the preset: by index, the value in
# the preset, which is exactly that number or follows from it by a rule below.
LINES: list[tuple[str, int, str, dict[int, float]]] = [
    (ABSOLEM, 1273, "<pose>", {0: 0.5 * PRESETS["absolem"].outline.axle_distance}),
    (ABSOLEM, 1273, "<pose>", {1: 0.5 * PRESETS["absolem"].gauge, 2: AXLES}),
    (ABSOLEM, 1672, "<pose>", {0: -0.5 * PRESETS["absolem"].outline.axle_distance}),
    (ABSOLEM, 1291, "<radius>", {0: PRESETS["absolem"].outline.front_radius}),
    (ABSOLEM, 1690, "<radius>", {0: PRESETS["absolem"].outline.rear_radius}),
    (ABSOLEM, 988, "<pose>", {0: 0.25, 2: 0.0195}),
    (ABSOLEM, 1216, "<pose>", {}),
    (ABSOLEM, 1006, "<radius>", {0: arms("absolem").root_radius}),
    (ABSOLEM, 1234, "<radius>", {0: arms("absolem").tip_radius}),
    (ABSOLEM, 991, "<mass>", {0: arms("absolem").mass / 5}),
    (ABSOLEM, 968, "<velocity>", {0: arms("absolem").rate_limit}),
    (ABSOLEM, 967, "<effort>", {0: arms("absolem").torque_limit}),
    (ABSOLEM, 18, "<pose>", {}),
    (ABSOLEM, 21, "<size>", {}),
    (ABSOLEM, 34, "<pose>", {}),
    (ABSOLEM, 37, "<size>", {}),
    (ABSOLEM, 1287, "<pose>", {1: -0.015}),
    (ABSOLEM, 922, "<pose>", {2: AXLES + 0.00095}),
    (ABSOLEM, 990, "<pose>", {0: 0.08}),
    (ABSOLEM, 996, "<iyy>", {0: 0.012277}),
    (ABSOLEM, 1018, "<mu>", {0: 0.5}),
    (ABSOLEM, 1019, "<mu2>", {0: 1.0}),
    (ABSOLEM, 1022, "<fdir1>", {0: 0.0, 1: 0.0, 2: 1.0}),
    (SPECIFICATION, 51, "Maximum forward speed", {0: PRESETS["absolem"].drivetrain.max_speed}),
    (SPECIFICATION, 51, "odometry", {3: PRESETS["absolem"].drivetrain.max_acceleration}),
    (MARV, 469, "<pose>", {0: 0.5 * PRESETS["marv"].outline.axle_distance}),
    (MARV, 469, "<pose>", {1: 0.5 * PRESETS["marv"].gauge}),
    (MARV, 618, "<pose>", {0: 0.5 * PRESETS["marv"].outline.axle_distance}),
    (MARV, 1045, "<pose>", {}),
    (MARV, 636, "<radius>", {0: arms("marv").root_radius}),
    (MARV, 1063, "<radius>", {0: arms("marv").tip_radius}),
    (MARV, 621, "<mass>", {}),
    (MARV, 522, "<velocity>", {0: arms("marv").rate_limit}),
    (MARV, 521, "<effort>", {0: arms("marv").torque_limit}),
    (MARV, 18, "<pose>", {}),
    (MARV, 21, "<size>", {}),
    (MARV, 26, "<pose>", {}),
    (MARV, 29, "<size>", {}),
    (MARV, 34, "<pose>", {}),
    (MARV, 38, "<radius>", {}),
    (MARV, 669, "<velocity>", {}),
    (GAZEBO, 129, "<pose>", {0: 0.25, 2: AXLES}),
    (GAZEBO, 147, "<pose>", {0: -0.5 * PRESETS["gz_tracked_vehicle"].outline.axle_distance}),
    (GAZEBO, 133, "<radius>", {0: PRESETS["gz_tracked_vehicle"].outline.front_radius}),
    (GAZEBO, 98, "<pose>", {1: 0.5 * PRESETS["gz_tracked_vehicle"].gauge}),
    (GAZEBO, 67, "<mass>", {0: 13.14}),
    (GAZEBO, 101, "<mass>", {0: 6.06}),
    (GAZEBO, 201, "<mass>", {0: 6.06}),
    (GAZEBO, 334, "<pose>", {0: arms("gz_tracked_vehicle").length}),
    (GAZEBO, 316, "<radius>", {0: arms("gz_tracked_vehicle").root_radius}),
    (GAZEBO, 338, "<radius>", {0: arms("gz_tracked_vehicle").tip_radius}),
    (GAZEBO, 301, "<mass>", {0: arms("gz_tracked_vehicle").mass}),
    (GAZEBO, 298, "<pose>", {4: -arms("gz_tracked_vehicle").angle}),
    (GAZEBO, 471, "<lower>", {0: 0.0}),
    (GAZEBO, 78, "<pose>", {}),
    (GAZEBO, 81, "<size>", {}),
    (GAZEBO, 1085, "<max_velocity>", {0: PRESETS["gz_tracked_vehicle"].drivetrain.max_speed}),
    (GAZEBO, 300, "<pose>", {0: 0.08}),
    (GAZEBO, 121, "<mu>", {0: 0.7}),
    (ENGINEER, 15, "big_wheel_radius", {0: 0.8}),
    (ENGINEER, 16, "small_wheel_radius", {0: 0.7}),
    (ENGINEER, 115, 'effort="100"', {}),
    (ENGINEER, 133, 'mass="0.775"', {}),
    (ENGINEER, 144, 'right_front_base_link_wheel" x="${1.86*scale}" y="${-2.75*scale}"', {}),
    (ENGINEER, 149, 'right_rear_base_link_wheel" x="${-1.86*scale}"', {}),
    (ENGINEER, 154, 'right_middle_base_link_wheel" x="0"', {}),
    (ENGINEER, 160, 'right_flipper_wheel" x="${0.5*scale}" y="0" z="${3.4*scale}"', {}),
]


def numbers(line: str) -> list[float]:
    """Numbers of a line, except digits within names."""
    number = r"(?<![\w.])-?\d+\.?\d*(?:e-?\d+)?(?![\w.]\d)"
    return [float(word) for word in re.findall(number, line)]


@pytest.mark.parametrize(
    ("file", "number", "holds", "figures"), LINES, ids=[f"{r[0]}:{r[1]}" for r in LINES]
)
def test_a_preset_has_the_figure_of_the_line_it_names(
    file: str, number: int, holds: str, figures: dict[int, float]
) -> None:
    line = robot_files.lines(file)[number]
    assert holds in line, line
    for index, figure in figures.items():
        # Halves, fifths and sums of decimals: equal except for rounding.
        assert figure == pytest.approx(numbers(line)[index], rel=1e-14, abs=1e-17)


def test_the_lines_that_the_presets_name_are_those_that_are_read() -> None:
    named = set()
    for name in c2d.robots.__all__:
        text = " ".join((getattr(c2d.robots, name).__doc__ or "").split())
        for file, listed in re.findall(r"([\w.]+\.\w+):(\d+(?:(?:, | and | to )\d+)*)", text):
            named |= {(file, int(number)) for number in re.findall(r"\d+", listed)}
    assert named == {(file, number) for file, number, *_ in LINES}


def without_arms(links: list[Link]) -> list[Link]:
    return [link for link in links if "flipper" not in link.name]


def of_preset(robot: c2d.Robot, height: float) -> Masses:
    x, y = robot.center_of_mass
    return Masses(robot.mass, x, y + height, robot.moment_of_inertia)


@pytest.mark.parametrize(
    ("name", "file", "model", "height", "digit"),
    [
        ("absolem", ABSOLEM, None, AXLES, {"mass": 1e-4, "x": 1e-5, "z": 1e-5, "inertia": 1e-4}),
        ("marv", MARV, None, 0.0, {"mass": 1e-3, "x": 1e-5, "z": 1e-5, "inertia": 1e-4}),
        # The angle of 1.5708 rad by which the file turns the body is not exactly a right angle.
        ("gz_tracked_vehicle", GAZEBO, "simple_tracked", AXLES, {"inertia": 1e-9}),
    ],
)
def test_without_arms_a_robot_has_the_masses_of_its_files_links(
    name: str, file: str, model: str | None, height: float, digit: dict[str, float]
) -> None:
    """Rounded figures are within half of their last digit; the others are exact."""
    file_has = together(without_arms(robot_files.read_sdf(file, model)))
    robot = of_preset(getattr(c2d.robots, name)(flippers=None), height)
    for figure in ("mass", "x", "z", "inertia"):
        slack = 0.5 * digit.get(figure, 1e-12)
        assert getattr(robot, figure) == pytest.approx(getattr(file_has, figure), abs=slack), figure


@pytest.mark.parametrize(
    ("name", "file", "model"),
    [
        ("absolem", ABSOLEM, None),
        ("marv", MARV, None),
        ("gz_tracked_vehicle", GAZEBO, "simple_tracked"),
    ],
)
def test_with_arms_a_robot_has_the_mass_and_the_middle_of_its_file(
    name: str, file: str, model: str | None
) -> None:
    """Arms at both ends balance in x, wherever along them their mass is."""
    links = robot_files.read_sdf(file, model)
    whole, robot = together(links), PRESETS[name]
    # 3.659 kg an arm are rounded, and the frames of arms of 10 mg are left out.
    assert robot.mass == pytest.approx(whole.mass, abs=5e-4)
    assert robot.center_of_mass[0] == pytest.approx(whole.x, abs=1e-5)
    for side in ("left", "right"):
        for end in ("front", "rear"):
            arm = [link for link in links if link.name.startswith(f"{end}_{side}_flipper")]
            assert arms(name).mass == pytest.approx(together(arm).mass, abs=1e-4)


def wheels_of(links: list[Link], start: str) -> list[tuple[Array, float]]:
    """Axles and radii of the links with such names, in order of their numbers."""
    found = [link for link in links if link.name.startswith(start)]
    found.sort(key=lambda link: int(link.name.rpartition("wheel")[2]))
    return [(link.rounds[0].place, link.rounds[0].radius) for link in found]


def wheels_of_chassis(robot: c2d.Robot) -> dict[str, Array]:
    """Columns of the wheels that the chassis carries on one side; the other has the same."""
    table = robot.wheels()
    chosen = {
        side: (table["carrier"] == "chassis") & (table["side"] == side)
        for side in ("left", "right")
    }
    columns = {name: table[name][chosen["left"]] for name in ("x", "y", "radius")}
    for name, column in columns.items():
        assert column.tolist() == table[name][chosen["right"]].tolist()
    return columns


def line_between(robot: c2d.Robot, outline: dict[str, Any], track: c2d.LineOfWheels) -> Array:
    """Positions along the line and radii of the model's wheels for such an outline."""
    outline_of_arm = dataclasses.replace(robot.outline, **outline)
    bare = dataclasses.replace(robot, outline=outline_of_arm, flippers=None, track=track)
    wheels = wheels_of_chassis(bare)
    return np.array([wheels["x"] + 0.5 * outline_of_arm.axle_distance, wheels["radius"]]).T


@pytest.mark.parametrize("side", ["left", "right"])
def test_public_absolem_has_its_files_wheels_in_side_view(side: str) -> None:
    """Its foremost is 15 mm inboard, across the track: they still lie on one line, evenly."""
    links = robot_files.read_sdf(ABSOLEM)
    found = wheels_of(links, f"{side}_track_wheel")
    wheels = wheels_of_chassis(c2d.robots.absolem(track="public"))
    assert len(found) == len(wheels["x"]) == 8
    for (place, radius), x, y, own in zip(
        reversed(found), wheels["x"], wheels["y"], wheels["radius"], strict=True
    ):
        assert [x, y + AXLES] == pytest.approx([place[0], place[2]], abs=5e-7)  # 6 decimals
        assert own == radius
    inboard = [0.1985 - abs(float(place[1])) for place, _ in found]
    assert inboard == pytest.approx([0.015, *[0.0] * 7])


@pytest.mark.parametrize(("file", "count"), [(ABSOLEM, 5), (MARV, 8)])
@pytest.mark.parametrize("end", ["front", "rear"])
@pytest.mark.parametrize("side", ["left", "right"])
def test_public_flippers_have_their_files_wheels(
    file: str, count: int, end: str, side: str
) -> None:
    found = wheels_of(robot_files.read_sdf(file), f"{end}_{side}_flipper_wheel")
    robot = FILES[file](track="public")
    arm = robot.flippers
    assert arm is not None
    assert arm.track == c2d.LineOfWheels(count)
    assert len(found) == count
    pivot = found[0][0]
    along = [float(np.linalg.norm(place - pivot)) for place, _ in found]
    ends = {"rear_radius": arm.root_radius, "front_radius": arm.tip_radius}
    outline = {"axle_distance": arm.length, **ends}
    made = line_between(robot, outline, c2d.LineOfWheels(count))
    assert made[:, 0] == pytest.approx(along, abs=1e-6)  # the file has six decimals
    assert made[:, 1] == pytest.approx([radius for _, radius in found], abs=1e-12)


def test_the_bellies_are_the_boxes_of_their_files() -> None:
    def box(file: str, pose: int, size: int) -> tuple[float, float, float, float]:
        """Rear, front, bottom and top; boxes turned about z reach as far as their corners."""
        x, _, z, _, _, yaw = numbers(robot_files.lines(file)[pose])
        length, width, height = numbers(robot_files.lines(file)[size])
        half = 0.5 * (length * abs(math.cos(yaw)) + width * abs(math.sin(yaw)))
        return x - half, x + half, z - 0.5 * height, z + 0.5 * height

    hull, bow = box(ABSOLEM, 18, 21), box(ABSOLEM, 34, 37)
    belly = np.array(PRESETS["absolem"].belly)
    assert belly[:, 0].min() == pytest.approx(hull[0], abs=1e-9)
    assert belly[:, 0].max() == pytest.approx(bow[1], abs=1e-6)
    assert [belly[:, 1].min() + AXLES, belly[:, 1].max() + AXLES] == pytest.approx(hull[2:])
    body = box(GAZEBO, 78, 81)
    belly = np.array(PRESETS["gz_tracked_vehicle"].belly)
    assert [*belly[:, 0][[0, 1]], *(belly[:, 1][[0, 2]] + AXLES)] == pytest.approx(body)
    body, keel = box(MARV, 18, 21), box(MARV, 26, 29)
    axle = numbers(robot_files.lines(MARV)[34])
    (radius,) = numbers(robot_files.lines(MARV)[38])
    belly = np.array(PRESETS["marv"].belly)
    # The file's quarter circle begins 0.1 mm higher and is 0.05 mm larger than the hull it rounds.
    slack = 2e-4
    assert [belly[:, 0].min(), belly[:, 0].max()] == pytest.approx([body[0], body[1]])
    assert [belly[:, 1].min(), belly[:, 1].max()] == pytest.approx([keel[2], body[3]])
    on_bow = belly[(belly[:, 0] > axle[0] - 1e-9) & (belly[:, 1] < axle[2])]
    assert len(on_bow) == 5
    reach = np.hypot(on_bow[:, 0] - axle[0], on_bow[:, 1] - axle[2])
    assert reach == pytest.approx(radius, abs=slack)


def test_absolems_arms_are_as_long_as_their_wheels_are_apart() -> None:
    root, tip = (np.array(numbers(robot_files.lines(ABSOLEM)[n])[:3]) for n in (988, 1216))
    assert arms("absolem").length == pytest.approx(float(np.linalg.norm(tip - root)), abs=1e-6)
    lowered = math.atan2(root[2] - tip[2], tip[0] - root[0])
    assert lowered == pytest.approx(0.19, abs=5e-3)


def test_marvs_arms_masses_and_speed_follow_from_its_wheels() -> None:
    text = robot_files.lines(MARV)
    root, tip = numbers(text[618]), numbers(text[1045])
    assert arms("marv").length == pytest.approx(tip[0] - root[0], abs=1e-12)
    assert arms("marv").mass == pytest.approx(8 * numbers(text[621])[0], abs=5e-4)
    speed = numbers(text[669])[0] * arms("marv").root_radius
    assert PRESETS["marv"].drivetrain.max_speed == pytest.approx(speed, abs=1e-5)


def test_the_engineer_has_the_masses_and_the_wheels_of_its_file() -> None:
    masses, wheels = robot_files.read_xacro(ENGINEER)
    links = sum(masses.values())
    assert links == pytest.approx(12.35, abs=2e-3)  # and 1 g of an inertial sensor
    # The manipulator's links are commented out, and so are not elements.
    text = (FOLDER / ENGINEER).read_text()
    comments = " ".join(re.findall(r"<!--(.*?)-->", text, flags=re.DOTALL))
    manipulator = sum(float(mass) for mass in re.findall(r'mass="([\d.]+)"', comments))
    assert manipulator == pytest.approx(8.85, abs=5e-3)
    assert PRESETS["engineer"].mass == pytest.approx(links + manipulator, abs=0.05)
    assert arms("engineer").mass == masses["right_flipper"]
    public = c2d.robots.engineer(track="public")
    own = wheels_of_chassis(public)
    for side in ("left", "right"):
        found = sorted(
            (float(w.place[0]), w.radius)
            for w in wheels
            if w.parent == "base_link" and w.name.startswith(side)
        )
        assert own["x"] == pytest.approx([x for x, _ in found])
        assert own["radius"] == pytest.approx([radius for _, radius in found])
    assert {round(float(w.place[2]), 9) for w in wheels if w.parent == "base_link"} == {-0.025}
    (tip,) = (w for w in wheels if w.name == "right_flipper_wheel")
    # The arm's joint turns by -90 degrees about x, then about z: its z axis points ahead.
    ahead = robot_files.rotation(-math.pi / 2, 0.0, -math.pi / 2) @ tip.place
    arm = public.flippers
    assert arm is not None
    assert arm.length == pytest.approx(float(ahead[0]))
    assert isinstance(arm.track, c2d.LineOfWheels)
    assert arm.track.count == 2
    assert arm.track.wheel_radius == pytest.approx(tip.radius)
    # The wheel that the model adds at the root is inside the front wheel of the robot.
    pivot = 0.5 * public.outline.axle_distance
    assert abs(0.186 - pivot) + tip.radius < 0.08
