"""benches/models: the ground is boxes, files are loaded as read, and one rule judges all."""

from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from numpy.typing import NDArray

from benches.adapters.ground import DEPTH, WIDTH, boxes_of, profile_of
from benches.adapters.ode_process import interpreter
from benches.adapters.robots import RobotModel, cleaned
from benches.adapters.space import Verdict, drive, scene_of
from benches.models import files, runs
from benches.models.cases import CASES, Case
from benches.models.files import balanced, exported, loaded, on_axles, patch, variant
from benches.models.runs import PREDICTIONS, robot_of
from benches.shared.results import read
from crawler2d.errors import ScenarioError
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.terrain import Barrier, Flat, Ridge, Stairs, Step
from crawler2d.parameters.track import LineOfWheels
from crawler2d.runs.batch import simulate_many

GROUNDS = {
    "flat": Flat(),
    "step": Step(0.1),
    "barrier": Barrier(0.07, 0.01),
    "stairs": Stairs(count=3, rise=0.07, run=0.18),
}


@pytest.mark.parametrize("ground", GROUNDS.values(), ids=GROUNDS)
def test_the_boxes_fill_all_below_the_profile_and_nothing_above(ground: Step) -> None:
    profile = profile_of(ground)
    boxes = boxes_of(profile)
    area = np.trapezoid(profile[:, 1] + DEPTH, profile[:, 0])
    assert sum(box.size[0] * box.size[2] for box in boxes) == pytest.approx(area, rel=1e-12)
    for box in boxes:
        assert box.size[1] == WIDTH
        middle = box.center[0]
        top = box.center[2] + 0.5 * box.size[2]
        assert top == pytest.approx(np.interp(middle, *profile.T), abs=1e-12)


def test_the_profile_is_that_of_crawler2d() -> None:
    case = CASES["absolem"]
    for label in ("step 71 mm", "barrier 71 mm", "stairs of 71 mm"):
        scenario = case.scenarios(label, case.robot())[0].replace({"duration": 0.01})
        (run,) = simulate_many([scenario], threads=1)
        corners = np.column_stack([run.edges["x"], run.edges["y"]])
        assert np.allclose(profile_of(scenario.terrain)[1:-1], corners, atol=1e-12), label


def test_slopes_and_rounded_edges_are_no_boxes() -> None:
    with pytest.raises(ScenarioError, match="must be level"):
        profile_of(Ridge(0.1, 1.0))
    with pytest.raises(ScenarioError, match="rounded edge"):
        profile_of(Step(0.1, edge_radius=0.01))


def ended(rear: list[float], step: float = 0.1, pitch: float = 0.0, yaw: float = 0.0) -> str:
    verdict = Verdict(goal=1.0, duration=10.0)
    for number, x in enumerate(rear):
        end = verdict.end(step * number, x, (0.0, pitch, yaw))
        if end:
            return f"{end} at {step * number:.1f}"
    return ""


def test_a_run_clears_when_its_rear_has_been_past_the_goal_for_half_a_second() -> None:
    assert ended([0.9, *[1.1] * 9]) == "cleared at 0.6"
    assert ended([0.9, 1.1, 1.1, 0.9, *[1.1] * 9]) == "cleared at 0.9"
    assert ended([0.9, *[1.1] * 9], pitch=0.1) == ""  # not level


def test_a_run_stops_when_it_has_got_no_farther_for_three_seconds() -> None:
    assert ended([0.5] * 40) == "stopped at 3.0"
    assert ended([0.5, 0.45] * 20) == "stopped at 3.0"  # it rattles
    assert ended([0.5 + 0.002 * n for n in range(60)]) == ""  # it creeps, 20 mm/s
    assert ended([0.5 + 0.0001 * n for n in range(60)]) == "stopped at 3.0"


def test_other_outcomes_are_distinguished() -> None:
    assert ended([0.5] * 5, pitch=1.6) == "tipped over at 0.0"
    assert ended([0.5] * 5, yaw=0.9) == "turned at 0.0"
    assert ended([0.006 * n for n in range(200)], step=0.6) == "timed out at 10.2"


def wheels_of(robot: Robot) -> NDArray[np.float64]:
    """[m] x, y and radius of each wheel."""
    wheels = robot.wheels()
    return np.column_stack([wheels["x"], wheels["y"], wheels["radius"]])


def found_in(model: RobotModel) -> NDArray[np.float64]:
    """[m] x, y and radius of each wheel of a file."""
    return np.array([(wheel.axle[0], wheel.axle[2], wheel.radius) for wheel in model.wheels])


def files_of(case: Case) -> list[RobotModel]:
    if case.file.endswith(".xacro"):
        pytest.importorskip("xacrodoc")
    made = [exported(case, case.robot(), case.form, "export")]
    forms = dict.fromkeys((case.form, "urdf"))
    return [loaded(case.reading(), form, case.angle) for form in forms] + made


@pytest.mark.parametrize("name", CASES)
@pytest.mark.filterwarnings("ignore::crawler2d.errors.ScenarioWarning")
def test_public_file_and_export_have_the_robots_wheels_where_it_holds_them(
    name: str,
) -> None:
    robot = CASES[name].robot()
    expected = wheels_of(robot)
    if (
        name == "marv"
    ):  # it stands on the roots of its flippers, which count as its chassis's wheels
        expected = np.unique(expected.round(9), axis=0).repeat(2, axis=0)
    for model in files_of(CASES[name]):
        assert model.mass == pytest.approx(robot.mass, rel=1e-9)
        found = found_in(model)
        if name != "marv":  # the roots of its flippers count as wheels of its chassis, too
            assert len(found) == len(expected)
        for wheel in found:
            # Absolem's file has its flippers 0.95 mm above the end axles, where a side view has
            # them; `read_robot` takes up to 1 mm.
            assert np.abs(expected - wheel).max(axis=1).min() < 1e-3
        front = expected[:, 0] + expected[:, 2]
        assert model.foremost == pytest.approx(front.max(), abs=1e-5)


def predicted_robot(name: str, file: str) -> Robot:
    return robot_of(read(PREDICTIONS)[name][files.FILES[file]])


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if "patch" in case.files])
@pytest.mark.filterwarnings("ignore::crawler2d.errors.ScenarioWarning")
def test_a_patched_file_has_the_wheels_of_the_repair(name: str) -> None:
    case, robot = CASES[name], predicted_robot(name, "repair")
    if case.file.endswith(".xacro"):
        pytest.importorskip("xacrodoc")
    expected = wheels_of(robot)
    assert len(expected) > len(case.robot().wheels())
    for form in dict.fromkeys((case.form, "urdf")):
        model = patch(case, robot, form)
        assert model.mass == pytest.approx(robot.mass, rel=1e-6)  # files round
        found = found_in(model)
        assert len(found) == len(expected)
        for wheel in expected:
            # The flippers of Absolem's file stay 0.95 mm above the end axles.
            assert np.abs(found - wheel).max(axis=1).min() < 1e-3


@pytest.mark.filterwarnings("ignore::crawler2d.errors.ScenarioWarning")
def test_balanced_wheels_have_their_mass_on_their_axles_and_the_robot_keeps_its_centre() -> None:
    reading = CASES["absolem"].reading()
    was, now = reading.tree, balanced(reading)
    wheels = set(reading.wheels["name"].tolist())
    off = {
        tree: max(
            np.linalg.norm(link.center - tree.joints[link.name].place)
            for link in tree.links
            if link.name in wheels
        )
        for tree in (was, now)
    }
    assert off[was] == pytest.approx(0.080, abs=0.001)
    assert off[now] < 1e-12
    before, after = (
        np.sum([link.mass * link.center for link in tree.links], axis=0) for tree in (was, now)
    )
    assert np.allclose(before, after, atol=1e-12)
    assert now.joints is was.joints


@pytest.mark.filterwarnings("ignore::crawler2d.errors.ScenarioWarning")
def test_flippers_put_on_the_end_axles_move_with_all_their_wheels() -> None:
    case = CASES["absolem"]
    reading = case.reading()
    was, now = reading.tree, on_axles(reading)
    for old, new in zip(was.links, now.links, strict=True):
        # The file has them 0.95 mm above the end axles.
        fall = 0.00095 if "flipper" in new.name else 0.0
        moved = [old.center - new.center, old.pose.place - new.pose.place]
        moved += [a.pose.place - b.pose.place for a, b in zip(old.shapes, new.shapes, strict=True)]
        if new.name in now.joints:
            moved.append(was.joints[new.name].place - now.joints[new.name].place)
        assert np.allclose(moved, [0.0, 0.0, fall], atol=1e-12), new.name
    assert any("pivot" in note for note in reading.notes)
    model = variant(case, "balanced-on-axles")
    low = [wheel.axle[2] for wheel in model.wheels if wheel.axle[2] < 0.01]
    assert len(low) == 2 * 8 + 4  # of the chassis, and the roots of the flippers
    assert np.allclose(low, 0.0, atol=1e-9)


def require(engine: str) -> None:
    if engine.startswith("ode"):
        if interpreter() is None:
            pytest.skip("no interpreter has ODE")
    else:
        pytest.importorskip("dartpy" if engine.startswith("dart") else "pybullet")


@pytest.mark.parametrize("name", CASES)
@pytest.mark.filterwarnings("ignore::crawler2d.errors.ScenarioWarning")
@pytest.mark.parametrize("engine", runs.ENGINES)
def test_an_engine_has_the_files_as_they_were_read_and_drives_them_forward(
    name: str, engine: str
) -> None:
    require(engine)
    if CASES[name].file.endswith(".xacro"):
        pytest.importorskip("xacrodoc")
    case = CASES[name]
    label = next(iter(case.cells))
    scenario = case.scenarios(label, case.robot())[0].replace({"duration": 0.3})
    for file in case.files:
        model = files.model_of(engine, name, file, predicted_robot(name, file))
        # Building a world compares masses and axles with those that were read.
        found = drive(runs.engine_of(engine), scenario, scene_of(scenario, model))
        assert found["end"] == "timed out"
        start = -scenario.start.approach - model.foremost
        # Half the acceleration times the square of the time, minus slip until the robot settles: at
        # most 4.4 mm, but 11.9 mm of MARV's export in DART.
        slip = 0.0125 if name == "marv" and engine.startswith("dart") else 0.006
        assert found["x"] - start == pytest.approx(0.045, abs=slip)
        assert max(found["yaw"], found["roll"], found["bend"]) < 0.01


@pytest.mark.parametrize("name", CASES)
@pytest.mark.filterwarnings("ignore::crawler2d.errors.ScenarioWarning")
def test_the_bodies_of_a_file_weigh_what_it_does_where_it_does(name: str) -> None:
    if CASES[name].file.endswith(".xacro"):
        pytest.importorskip("xacrodoc")
    case = replace(CASES[name], angle=0.0)  # a robot's centre of mass is that with level arms
    bodies = loaded(case.reading(), case.form, case.angle).bodies
    mass = sum(body["mass"] for body in bodies)
    centre = np.sum([body["mass"] * np.array(body["center"]) for body in bodies], axis=0) / mass
    robot = case.robot()
    assert mass == pytest.approx(robot.mass, rel=1e-9)
    # The side view has the pivots of Absolem's flippers on the end axles, 0.95 mm lower.
    assert centre[[0, 2]] == pytest.approx(robot.center_of_mass, abs=5e-4)
    for body in bodies:
        moments = np.linalg.eigvalsh(np.reshape(body["inertia"], (3, 3)))
        assert 0.0 < moments[0] <= moments[2] <= (moments[0] + moments[1]) * (1.0 + 1e-6)
    for body in bodies[1:]:
        (shape,) = body["shapes"]
        assert np.subtract(shape["place"], body["axle"])[[0, 2]] == pytest.approx(0.0, abs=1e-5)


def test_cleaning_takes_pictures_and_meshes_and_leaves_what_moves() -> None:
    text = """<robot name="r">
      <link name="a"><visual/><collision><geometry><mesh filename="m"/></geometry></collision>
        <collision><geometry><sphere radius="1"/></geometry></collision></link>
      <link name="b"/>
      <joint name="j" type="continuous"><parent link="a"/><child link="b"/></joint>
      <joint name="k" type="fixed"><parent link="a"/><child link="gone"/></joint>
      <gazebo/></robot>"""
    left = [each.tag for each in ElementTree.fromstring(cleaned(text)).iter()]
    assert left.count("collision") == 1
    assert not {"visual", "mesh", "gazebo"} & set(left)
    assert left.count("joint") == 1


def test_the_starts_of_a_cell_are_the_same_for_every_robot() -> None:
    case = CASES["absolem"]
    robot = case.robot()
    repaired = robot.with_track(LineOfWheels(15))
    label = next(iter(case.cells))
    pairs = zip(case.scenarios(label, robot), case.scenarios(label, repaired), strict=True)
    assert all(a.start == b.start and a.terrain == b.terrain for a, b in pairs)


def test_agreement_is_about_clearing_alone() -> None:
    predicted = [{"end": end} for end in ("seized", "cleared", "slipping", "cleared")]
    found = [{"end": end} for end in ("stopped", "cleared", "cleared")]
    assert runs.agreement(predicted, found) == 2


def test_absolems_motors_carry_it_over_the_step_if_they_are_firm_in_an_impact() -> None:
    case = CASES["absolem"]
    robot = case.robot()
    ended = simulate_many(
        [case.scenarios("step 71 mm", each)[0] for each in (robot, case.firm(robot))],
        record="summary",
        threads=1,
    )
    assert [str(run.outcome) for run in ended] == ["seized", "cleared"]


def test_rows_are_of_the_files_that_a_case_has() -> None:
    end = [{"end": "cleared", "x": 0.6}]
    label = next(iter(CASES["marv"].cells))
    of_marv = {f"marv | {file} | {label}": end for file in ("public", "repair")}
    assert [row[2] for row in runs.rows({"bullet": of_marv})] == ["public"]
