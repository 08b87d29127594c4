"""A chain of shoes in pictures and words: positions and names of its shoes."""

import dataclasses
import functools
import re
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.collections import PolyCollection

import crawler2d as c2d
from crawler2d.common.arrays import Table
from crawler2d.common.bodies import BodyKind
from crawler2d.drawings.scene import Scene
from crawler2d.parameters.track import Track
from crawler2d.pictures.scenes import scene_of
from tests.pictures.reading import distance, page_of, placed, unpacked

STEP = c2d.terrains.step(0.06)
LANES = c2d.terrains.lanes(c2d.terrains.step(0.05), c2d.terrains.step(0.03))
SPROCKET = c2d.SegmentalTrack(mechanism="sprocket")
RUNS: dict[str, tuple[c2d.SegmentalTrack, Any]] = {
    "plates": (c2d.SegmentalTrack(), STEP),
    "trapezoids": (c2d.SegmentalTrack(shoe_shape="trapezoid"), STEP),
    "short shoes": (c2d.SegmentalTrack(shoe_count=44), STEP),
    "two lanes": (c2d.SegmentalTrack(), LANES),
    "sprocket": (SPROCKET, STEP),
    "sprockets on two lanes": (SPROCKET, LANES),
}


def simulated(track: Track, terrain: Any = STEP, **fields: Any) -> c2d.Run:
    return c2d.simulate(c2d.robots.engineer(flippers=None, track=track), terrain, **fields)


@functools.cache
def stalled(shape: Any = "rectangle") -> c2d.Run:
    """Stand at an edge with weak motors for fifteen seconds."""
    robot = c2d.robots.engineer(flippers=None, track=c2d.SegmentalTrack(shoe_shape=shape))
    weak = dataclasses.replace(robot.drivetrain, max_torque=2.0)
    return c2d.simulate(dataclasses.replace(robot, drivetrain=weak), c2d.terrains.step(0.08))


LONG = {"two lanes", "short shoes", "sprocket"}
"""What takes long, and is in the others as well: guides, lanes and sprockets."""


@pytest.fixture(
    scope="module",
    params=[pytest.param(name, marks=pytest.mark.soak if name in LONG else ()) for name in RUNS],
)
def chain(request: pytest.FixtureRequest) -> c2d.Run:
    return simulated(*RUNS[request.param])


def drawn_shoes(ax: Any) -> list[Any]:
    """[m] Outlines of the pieces of the shoes of the only pose that is drawn."""
    (found,) = [c for c in ax.collections if type(c) is PolyCollection]
    return [np.array(path.vertices) for path in found.get_paths()]


def test_contacts_lie_on_the_shoes_that_are_drawn(chain: c2d.Run) -> None:
    table = chain.contacts
    near = table["lane"].max()
    bodies = chain.bodies
    pieces = np.flatnonzero((bodies["shoe"] >= 0) & (bodies["lane"] == near)).tolist()
    distances = []
    for sample in range(20, chain.time.size, 12):
        _, ax = plt.subplots()
        chain.plot(ax, time=chain.time[sample])
        outlines = drawn_shoes(ax)
        plt.close("all")
        assert len(outlines) == len(pieces)
        now = (table["time"] == chain.time[sample]) & (table["lane"] == near)
        for row in np.flatnonzero(
            now & np.isin(table["body_kind"], (BodyKind.GROUSER, BodyKind.SHOE))
        ):
            point = np.array([table["x"][row], table["y"][row]])
            distances.append(distance(point, outlines[pieces.index(table["body"][row])]))
    assert len(distances) > 100
    # Contacts are means over an interval, in which a moving shoe moves at most at twice the speed
    # of the robot.
    assert np.quantile(distances, 0.85) < 1e-4
    interval = float(np.diff(chain.time).max())
    assert max(distances) < 2.0 * chain.scenario.drive.speed * interval


def test_each_pose_has_its_shoes(chain: c2d.Run) -> None:
    _, ax = plt.subplots()
    chain.plot(ax, time=[0.0, 1.0, 2.0])
    assert len([c for c in ax.collections if type(c) is PolyCollection]) == 3


def test_other_tracks_have_no_shoes() -> None:
    page = page_of(simulated(c2d.GrouserBeltTrack(), duration=0.5))
    (chassis,) = page["robot"]["carriers"]
    assert "shoe" not in {body["look"] for body in chassis["bodies"]}


def test_fifteen_seconds_of_a_chain_take_less_than_500_kb() -> None:
    run = stalled()
    assert run.time.size == 1501
    assert len(run.to_html().encode()) < 500_000


@pytest.mark.parametrize("shape", ["rectangle", "trapezoid"])
def test_the_diagnosis_of_a_stalled_chain_names_its_shoes(shape: Any) -> None:
    run = stalled(shape)
    assert run.outcome == c2d.Outcome.STALLED
    told = str(run.diagnosis)
    assert "inside the track between two shoes;" in told
    name = {"rectangle": "a grouser", "trapezoid": "a shoe"}[shape]
    assert f"; {name} bears on it with" in told
    assert "wheel" not in told


@pytest.mark.parametrize("terrain", [c2d.terrains.flat(), LANES], ids=["one lane", "two lanes"])
@pytest.mark.parametrize("flippers", [False, True], ids=["bare", "flippers"])
def test_teeth_stand_between_the_pins_that_are_drawn(terrain: Any, flippers: bool) -> None:
    bare = c2d.robots.engineer(flippers=None, track=SPROCKET)
    robot = c2d.robots.engineer(track=SPROCKET) if flippers else bare
    run = c2d.simulate(robot, terrain, duration=2.5)
    scene, poses = scene_of(run), run.poses
    assert (len(scene.carriers) > 1) == flippers
    (sprocket,) = rows_of(scene, BodyKind.SPROCKET)
    plates = rows_of(scene, BodyKind.SHOE)
    rear_pin = np.array([[scene.bodies["outline"][plates[0]][:, 0].min(), 0.0]])
    for sample in range(100, run.time.size, 25):
        teeth, axle = scene.outline(sprocket, sample), poses[sample, sprocket, :2]
        places = np.concatenate([placed(rear_pin, poses[sample, plate]) for plate in plates])
        behind = (places - axle) @ directed(run.chassis_angle[sample]) < 0.0
        seated = places[behind & (np.hypot(*(places - axle).T) < 0.0575)]
        assert len(seated) >= 1
        # A pin is as thick as the plates, some 3 mm, and keeps its play to the flanks.
        clear = [distance(place, teeth) for place in seated]
        assert min(clear) > 1e-3
        assert max(clear) < 4e-3


def directed(angle: float) -> Any:
    return np.array([np.cos(angle), np.sin(angle)])


def test_the_picture_has_sprocket_idler_and_wheels_and_no_guide() -> None:
    run = simulated(SPROCKET, duration=0.5)
    scene = scene_of(run)
    _, ax = plt.subplots()
    run.plot(ax, time=0.3)
    lines = [np.array(line.get_xydata()) for line in ax.get_lines()]
    sample = int(np.abs(run.time - 0.3).argmin())
    in_chain = [kind for kind in BodyKind if kind.is_in_chain]
    drawn = [scene.outline(row, sample) for row in rows_of(scene, *in_chain)]
    assert len(drawn) == 2 + 7 + 3
    for outline in drawn:
        assert any(np.array_equal(outline, line) for line in lines)
    corners = len(scene.carriers[0].root_envelope)
    assert all(len(line) != corners + 1 for line in lines)


def test_no_edge_is_between_the_wheels_in_a_chain() -> None:
    run = simulated(SPROCKET)
    row = next(row for row, bodies in enumerate(run.events["bodies"]) if len(set(bodies)) == 2)
    _, ax = plt.subplots()
    run.plot(ax, time=0.5 * (run.events["start"][row] + run.events["end"][row]))
    (told,) = [
        str(line.get_label()) for line in ax.get_lines() if "inside" in str(line.get_label())
    ]
    assert re.fullmatch(r"edge inside the envelope: at most \d+\.\d mm", told)


@pytest.mark.parametrize("terrain", [STEP, LANES], ids=["one lane", "two lanes"])
def test_the_page_has_sprocket_idler_and_wheels(terrain: Any) -> None:
    run = simulated(SPROCKET, terrain, duration=0.5)
    robot, scene = page_of(run)["robot"], scene_of(run)
    (chassis,) = robot["carriers"]
    assert (chassis["envelope"], chassis["circuit"]) == (None, None)
    looks = [body["look"] for body in chassis["bodies"]]
    counts = {look: looks.count(look) for look in looks}
    assert counts == {"shoe": 22, "wheel": 1, "chain wheel": 1 + 7 + 3, "belly": 1}
    wheels = {BodyKind.IDLER: 1, BodyKind.ROAD_WHEEL: 7, BodyKind.ROLLER: 3}
    shown = {body["body"] for body in chassis["bodies"] if body["look"] == "chain wheel"}
    for kind, count in wheels.items():
        assert len(shown & set(rows_of(scene, kind))) == count
    # Of two tracks the right one is in front.
    (row,) = rows_of(scene, BodyKind.SPROCKET)
    sprocket = next(body for body in chassis["bodies"] if body["look"] == "wheel")
    assert sprocket["body"] == row
    outline = unpacked(robot["outlines"][sprocket["outlines"][0]]).reshape(-1, 2)
    assert np.abs(outline - scene.bodies["outline"][row]).max() < 1e-5


def rows_of(scene: Scene, *kinds: BodyKind) -> list[int]:
    """Visible bodies of the chassis."""
    return [row for row in scene.carriers[0].bodies.tolist() if scene.kinds[row] in kinds]


def test_the_guide_is_called_by_its_name() -> None:
    found = stalled().diagnosis
    assert found is not None
    columns = {name: np.array(found.contacts[name]) for name in found.contacts}
    first = np.flatnonzero(columns["in_pocket"])[0]
    columns["body_kind"][columns["body"] == columns["body"][first]] = BodyKind.GUIDE
    told = str(dataclasses.replace(found, contacts=Table(columns)))
    assert re.search(r"the guide (bears on it )?with \d+ N", told)
