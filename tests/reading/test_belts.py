"""A moving belt runs round its drums: those that bend it are the outline, others are ignored."""

import math
import re
import time
from pathlib import Path

import numpy as np
import pytest

import crawler2d as c2d
from tests.reading.carts import SIDES, TRACKED, WHEELS, quietly, read, refused, tracked, urdf

TRAPEZOID = ((-0.5, 0.1, 0.1), (-0.3, 0.0, 0.1), (0.3, 0.0, 0.1), (0.5, 0.1, 0.08))
"""A raised sprocket, two road wheels and a raised idler: x, z and radius [m]."""


def outline(folder: Path, *drums: tuple[float, float, float], boxes: str = "") -> c2d.TrackOutline:
    robot = read(folder, tracked(drums, boxes), "tank.sdf").robot
    assert robot.track == c2d.BeltTrack()
    return robot.outline


def box(x: float, z: float, length: float, height: float) -> str:
    size = f"<box><size>{length} 0.1 {height}</size></box>"
    pose = f"<pose>{x} 0 {z} 0 0 0</pose>"
    return f"<collision name='b'>{pose}<geometry>{size}</geometry></collision>"


def test_drums_between_the_end_drums_bend_nothing(tmp_path: Path) -> None:
    found = outline(tmp_path, (-0.4, 0.0, 0.1), (0.0, 0.0, 0.1), (0.4, 0.0, 0.1))
    assert len(found.discs) == 2
    assert found.axle_distance == 0.8


def test_a_trapezoid_of_drums_is_the_outline_midway_between_its_ends(tmp_path: Path) -> None:
    discs = np.array(sorted(outline(tmp_path, *TRAPEZOID).discs))
    assert discs == pytest.approx(np.array(TRAPEZOID) - (0.0, 0.1, 0.0), abs=1e-12)


def test_every_figure_of_a_trapezoid_has_its_lines(tmp_path: Path) -> None:
    reading = read(tmp_path, tracked(TRAPEZOID), "tank.sdf")
    assert reading.sources["robot.outline.discs"].startswith("tank.sdf:")
    assert "robot.outline.axle_distance" not in reading.sources


def test_the_chassis_stays_level_whatever_the_heights_of_its_ends(tmp_path: Path) -> None:
    """A triangle with a high idler: x is forward in the model, not through both end axles."""
    triangle = ((-0.4, 0.0, 0.1), (0.3, 0.0, 0.1), (0.5, 0.3, 0.1))
    discs = np.array(sorted(outline(tmp_path, *triangle).discs))
    assert discs == pytest.approx(np.array(triangle) - (0.05, 0.15, 0.0), abs=1e-12)


@pytest.mark.parametrize(
    "inner",
    [
        (0.0, 0.15, 0.03),  # a return roller that does not touch the upper run
        (0.0, 0.0, 0.1),  # a road wheel on the lower run
        (0.0, -0.000005, 0.1),  # the same, off by the rounding of a file
        (-0.1, -0.05, 0.05),  # a small one on the lower run
        (0.3, 0.0, 0.05),  # one inside another
    ],
)
def test_a_drum_that_does_not_bend_the_belt_is_none_of_its_discs(
    inner: tuple[float, float, float], tmp_path: Path
) -> None:
    bare = outline(tmp_path, *TRAPEZOID)
    for drums in ((*TRAPEZOID, inner), (inner, *TRAPEZOID)):
        assert outline(tmp_path, *drums) == bare


def test_a_drum_that_lies_lowest_by_rounding_alone_does_not_bend_the_belt(tmp_path: Path) -> None:
    """It is found first, and then lies on the run between its neighbours."""
    ends, neighbours = ((-0.5, 0.15, 0.1), (0.5, 0.15, 0.1)), ((-0.2, 0.0, 0.1), (0.2, 0.0, 0.1))
    bare = outline(tmp_path, *ends, *neighbours)
    assert outline(tmp_path, *ends, *neighbours, (0.0, -0.000004, 0.1)) == bare


def test_a_road_wheel_1_mm_below_the_others_bends_the_belt(tmp_path: Path) -> None:
    found = outline(tmp_path, (-0.4, 0.0, 0.1), (0.0, -0.001, 0.1), (0.4, 0.0, 0.1))
    assert len(found.discs) == 3


def test_of_road_wheels_in_a_row_the_outer_two_bend_the_belt(tmp_path: Path) -> None:
    row = [(x, 0.0, 0.1) for x in np.linspace(-0.3, 0.3, 7).tolist()]
    assert outline(tmp_path, TRAPEZOID[0], *row, TRAPEZOID[-1]) == outline(tmp_path, *TRAPEZOID)


def test_drums_all_round_a_circle_bend_the_belt_each(tmp_path: Path) -> None:
    turns = np.linspace(0.0, 2.0 * math.pi, 13)[:-1] + 0.1
    drums = [(0.4 * math.cos(turn), 0.4 * math.sin(turn), 0.05) for turn in turns]
    assert len(outline(tmp_path, *drums).discs) == 12


def test_a_track_that_bends_round_more_drums_than_an_outline_has_is_refused(
    tmp_path: Path,
) -> None:
    turns = np.linspace(0.0, 2.0 * math.pi, 71)[:-1]
    drums = [(0.4 * math.cos(turn), 0.4 * math.sin(turn), 0.01) for turn in turns]
    refused(tmp_path, tracked(drums), "must be a track that bends round at most 64", "tank.sdf")


def test_a_track_of_200_drums_and_a_thousand_boxes_is_read_quickly(tmp_path: Path) -> None:
    turns = np.linspace(0.0, 2.0 * math.pi, 65)[:-1]
    drums = [(0.4 * math.cos(turn), 0.4 * math.sin(turn), 0.01) for turn in turns]
    drums += [(x, 0.0, 0.01) for x in np.linspace(-0.3, 0.3, 130).tolist()]
    start = time.process_time()
    found = outline(tmp_path, *drums, boxes=box(0.0, 0.0, 0.1, 0.1) * 1300)
    assert time.process_time() - start < 6.0
    assert len(found.discs) == 64


def test_a_track_of_one_drum_is_refused(tmp_path: Path) -> None:
    refused(tmp_path, tracked(((0.0, 0.0, 0.1),)), "must have a drum at either end", "tank.sdf")


def test_a_large_drum_that_is_both_ends_is_refused(tmp_path: Path) -> None:
    drums = ((-0.2, -0.3, 0.1), (0.0, 0.0, 0.4), (0.2, -0.3, 0.1))
    refused(tmp_path, tracked(drums), "must have a drum at either end", "tank.sdf")


def test_a_moved_box_behind_a_run_is_within_the_belt(tmp_path: Path) -> None:
    behind = box(0.0, 0.0, 0.6, 0.2)
    assert outline(tmp_path, *TRAPEZOID, boxes=behind) == outline(tmp_path, *TRAPEZOID)


@pytest.mark.parametrize("drums", [TRAPEZOID, ((-0.4, 0.0, 0.1), (0.4, 0.0, 0.1))])
def test_a_moved_box_beyond_the_belt_is_refused(
    drums: tuple[tuple[float, float, float], ...], tmp_path: Path
) -> None:
    text = tracked(drums, box(0.0, -0.01, 0.3, 0.2))
    refused(tmp_path, text, "must lie within the belt round the drums", "tank.sdf")


def test_moved_boxes_without_drums_are_refused(tmp_path: Path) -> None:
    bare = box(0.2, 0.0, 0.3, 0.2)
    text = on_flippers((0.0, 0.0, 0.1), (0.3, 0.0, 0.05))
    without = re.sub(
        r'(<link name="\w+_arm">.*?</pose>).*?</link>', rf"\1{bare}</link>", text, flags=re.DOTALL
    )
    refused(tmp_path, without, "must have drums, to carry a belt", "tank.sdf")
    without = re.sub(
        r'(<link name="\w+_track">.*?</pose>).*?</link>', rf"\1{bare}</link>", text, flags=re.DOTALL
    )
    refused(tmp_path, without, "must have a drum at either end of a track", "tank.sdf")


def on_flippers(*drums: tuple[float, float, float]) -> str:
    """Gazebo's controllers move belts on the hull and on flippers in front."""
    links = plugins = ""
    for side, sign in SIDES:
        for name, kind, place, each in (
            ("track", "fixed", f"0 {0.3 * sign} 0", ((-0.4, 0.0, 0.1), (0.4, 0.0, 0.1))),
            ("arm", "revolute", f"0.4 {0.4 * sign} 0", drums),
        ):
            shapes = "".join(
                f"""<collision name="d{n}"><pose>{x} 0 {z} 1.5707963267948966 0 0</pose><geometry>
                <cylinder><radius>{r}</radius><length>0.05</length></cylinder></geometry>
                </collision>"""
                for n, (x, z, r) in enumerate(each)
            )
            axis = "<axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis>"
            links += f"""<link name="{side}_{name}"><pose>{place} 0 0 0</pose>{shapes}</link>
            <joint name="{side}_{name}_joint" type="{kind}"><parent>hull</parent>
            <child>{side}_{name}</child>{axis if kind == "revolute" else ""}</joint>"""
            plugins += f'<plugin name="TrackController" filename="x"><link>{side}_{name}</link>'
            plugins += "</plugin>"
    return TRACKED.format(links=links, plugins=plugins)


def test_a_flipper_has_a_belt_round_two_drums(tmp_path: Path) -> None:
    drums = (0.0, 0.0, 0.1), (0.3, 0.0, 0.05)
    flippers = read(tmp_path, on_flippers(*drums), "tank.sdf").robot.flippers
    assert flippers is not None
    assert (flippers.root_radius, flippers.tip_radius) == (0.1, 0.05)
    third = (0.15, -0.08, 0.05)
    refused(tmp_path, on_flippers(*drums, third), "flippers have two", "tank.sdf")


def test_of_drums_beyond_the_belt_of_a_flipper_the_rearmost_is_named(tmp_path: Path) -> None:
    ends = (0.0, 0.0, 0.1), (0.3, 0.0, 0.05)
    path = tmp_path / "tank.sdf"
    path.write_text(on_flippers(*ends, (0.2, -0.08, 0.05), (0.1, -0.08, 0.05)))
    with pytest.raises(c2d.ScenarioError) as caught:
        quietly(path)
    assert caught.value.path.endswith(": drum[left_arm/d3]")
    assert caught.value.value == "2 beyond the belt round the end drums"


def test_of_a_robot_with_belts_and_wheels_on_flippers_a_note_is_about_its_belts(
    tmp_path: Path,
) -> None:
    def part(name: str, place: str, parent: str, limit: str = "", shape: str = "") -> str:
        axis = f"<axis><xyz>0 1 0</xyz>{limit}</axis>"
        return f"""<link name="{name}"><pose>{place} 0 0 0</pose>{shape}</link>
          <joint name="{name}_joint" type="revolute"><parent>{parent}</parent>
          <child>{name}</child>{axis}</joint>"""

    tyre = """<collision name="c"><pose>0 0 0 1.5707963267948966 0 0</pose><geometry><cylinder>
      <radius>0.1</radius><length>0.05</length></cylinder></geometry></collision>"""
    arms = ""
    for side, sign in SIDES:
        limit, y = "<limit><lower>-1</lower><upper>1</upper></limit>", 0.45 * sign
        arms += part(f"{side}_arm", f"0.4 {y} 0", "hull", limit)
        arms += part(f"{side}_root", f"0.4 {y} 0", f"{side}_arm", shape=tyre)
        arms += part(f"{side}_tip", f"0.7 {y} 0", f"{side}_arm", shape=tyre)
    text = tracked(((-0.4, 0.0, 0.1), (0.4, 0.0, 0.1)))
    (tmp_path / "tank.sdf").write_text(text.replace("</model>", f"{arms}</model>"))
    found = quietly(tmp_path / "tank.sdf")
    assert found.robot.track == c2d.BeltTrack()
    assert found.robot.flippers is not None
    assert found.robot.flippers.track == c2d.LineOfWheels(2)
    assert any(note.startswith("belts in gz-sim: ") for note in found.notes)
    assert not any(note.startswith("motors in ") for note in found.notes)


def test_a_belt_of_a_flipper_that_does_not_run_round_its_pivot_is_refused(tmp_path: Path) -> None:
    beside = on_flippers((0.1, 0.0, 0.1), (0.3, 0.0, 0.05))
    refused(tmp_path, beside, "must have a belt from the pivot to the tip", "tank.sdf")


def test_speed_and_acceleration_of_a_vehicle_with_tracks_are_those_of_its_plugin(
    tmp_path: Path,
) -> None:
    """Gazebo's TrackedVehicle has limits within limits, that of turning among them."""
    plugin = """<plugin name="gz::sim::systems::TrackedVehicle" filename="x">
      <left_track><link>left</link></left_track><right_track><link>right</link></right_track>
      <linear_velocity><max_velocity>0.4</max_velocity>
        <max_acceleration>0.3</max_acceleration><min_acceleration>-2</min_acceleration>
      </linear_velocity>
      <angular_velocity><max_velocity>0.2</max_velocity><max_acceleration>0.1</max_acceleration>
      </angular_velocity></plugin>"""
    text = tracked(((-0.4, 0.0, 0.1), (0.4, 0.0, 0.1)))
    reading = read(tmp_path, text.replace("</model>", f"{plugin}</model>"), "tank.sdf")
    drivetrain = reading.robot.drivetrain
    assert drivetrain.max_speed == 0.4
    assert (drivetrain.max_acceleration, drivetrain.max_deceleration) == (0.3, 2.0)
    assert reading.sources["robot.drivetrain.max_speed"].startswith("tank.sdf:")


def test_track_controllers_of_unlike_limits_get_a_warning(tmp_path: Path) -> None:
    text = tracked(((-0.4, 0.0, 0.1), (0.4, 0.0, 0.1)))
    link, speed = "<link>left</link>", "<max_velocity>0.5</max_velocity>"
    assert link in text
    one = read(tmp_path, text.replace(link, f"{link}{speed}"), "tank.sdf")
    (warning,) = [each for each in one.warnings if "max_velocity" in each]
    assert warning.startswith("tank.sdf:")
    assert warning.endswith("differs between tracks: all have the smallest, got 0.5, none")
    assert one.robot.drivetrain.max_speed == 0.5
    both = read(tmp_path, text.replace("</link></plugin>", f"</link>{speed}</plugin>"), "tank.sdf")
    assert not [each for each in both.warnings if "max_velocity" in each]


def test_slip_in_proportion_to_the_force_gets_a_warning_where_it_is_along_the_track(
    tmp_path: Path,
) -> None:
    text = tracked(((-0.4, 0.0, 0.1), (0.4, 0.0, 0.1)))
    ode = "<ode><slip1>{}</slip1><slip2>{}</slip2></ode>"
    for slips, count in (((0.01, 0), 1), ((0, 0.01), 0)):
        surface = f"<surface><friction>{ode.format(*slips)}</friction></surface></collision>"
        reading = read(tmp_path, text.replace("</collision>", surface), "tank.sdf")
        found = [each for each in reading.warnings if "slip" in each]
        assert len(found) == count
    plugin = """<gazebo><plugin name="x" filename="gz-sim-wheel-slip-system"><wheel link_name="w">
    <slip_compliance_lateral>1</slip_compliance_lateral>
    <slip_compliance_longitudinal>0.02</slip_compliance_longitudinal></wheel></plugin></gazebo>"""
    text = urdf(WHEELS).replace("</robot>", f"{plugin}</robot>")
    (warning,) = [each for each in read(tmp_path, text).warnings if "slip" in each]
    assert warning.endswith("slips at the limit of friction alone, got 0.02 m/s per N")
    surface = f"<surface><friction>{ode.format(0.01, 0)}</friction></surface>"
    blocks = f'<gazebo reference="left_front"><collision>{surface}</collision></gazebo></robot>'
    warnings = read(tmp_path, urdf(WHEELS).replace("</robot>", blocks)).warnings
    assert [each for each in warnings if each.endswith("alone, got 0.01 m/s per N")]
