"""A chain of shoes in pictures and words: where its shoes lie, and what they are called."""

import dataclasses
import re
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.collections import PolyCollection

import crawler2d as c2d
from crawler2d import _core
from crawler2d.common.table import Table
from crawler2d.parameters.track import Track
from crawler2d.pictures.shapes import carriers, outlines, pins, shoes
from tests.pictures.reading import distance, page_of, unpacked

GROUSER, SHOE = 4, 5
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


def stalled(shape: Any = "rectangle") -> c2d.Run:
    """Stand before an edge with weak motors, for fifteen seconds."""
    robot = c2d.robots.engineer(flippers=None, track=c2d.SegmentalTrack(shoe_shape=shape))
    weak = dataclasses.replace(robot.drivetrain, max_torque=2.0)
    return c2d.simulate(dataclasses.replace(robot, drivetrain=weak), c2d.terrains.step(0.08))


@pytest.fixture(scope="module", params=RUNS)
def chain(request: pytest.FixtureRequest) -> c2d.Run:
    return simulated(*RUNS[request.param])


def drawn_shoes(ax: Any) -> list[Any]:
    """[m] Outlines of the pieces of the shoes of the only pose that is drawn."""
    (found,) = [c for c in ax.collections if type(c) is PolyCollection]
    return [np.array(path.vertices) for path in found.get_paths()]


def test_contacts_lie_on_the_shoes_that_are_drawn(chain: c2d.Run) -> None:
    table = chain.contacts
    near = table["lane"].max()
    # Of two tracks the right one is in front; after the shoes of each comes what they run on.
    geometry = _core.geometry(chain.scenario.to_json())
    pieces = len(geometry["shoes"])
    first = int(geometry["bodies"][0]) - pieces
    distances = []
    for sample in range(20, chain.time.size, 8):
        _, ax = plt.subplots()
        chain.plot(chain.time[sample], axes=ax)
        outlines = drawn_shoes(ax)
        plt.close("all")
        assert len(outlines) == pieces
        now = (table["time"] == chain.time[sample]) & (table["lane"] == near)
        for row in np.flatnonzero(now & np.isin(table["body_kind"], (GROUSER, SHOE))):
            point = np.array([table["x"][row], table["y"][row]])
            distances.append(distance(point, outlines[table["body"][row] - first]))
    assert len(distances) > 100
    # Contacts are means over an interval, in which a shoe that is not at rest moves on, at twice
    # the speed of the robot at most.
    assert np.quantile(distances, 0.85) < 1e-4
    interval = float(np.diff(chain.time).max())
    assert max(distances) < 2.0 * chain.scenario.drive.speed * interval


def test_each_pose_has_its_shoes(chain: c2d.Run) -> None:
    _, ax = plt.subplots()
    chain.plot([0.0, 1.0, 2.0], axes=ax)
    assert len([c for c in ax.collections if type(c) is PolyCollection]) == 3


def test_the_page_has_the_shoes_to_a_tenth_of_a_millimetre(chain: c2d.Run) -> None:
    page = page_of(chain)
    frames, robot = page["frames"], page["robot"]
    pins = unpacked(frames["pins"]).reshape(frames["count"], frames["shoes"], 2)
    ways = np.roll(pins, -1, axis=1) - pins
    middles, angles = pins + 0.5 * ways, np.arctan2(ways[..., 1], ways[..., 0])
    geometry = _core.geometry(chain.scenario.to_json())
    for sample in range(0, frames["count"], 10):
        turn = chain.chassis_angle[sample]
        placed = [
            (rotated(unpacked(piece).reshape(-1, 2), angle) + middle)
            for pieces, middle, angle in zip(
                robot["shoes"], middles[sample], angles[sample], strict=True
            )
            for piece in pieces
        ]
        for here, there in zip(placed, shoes(chain, geometry, sample), strict=True):
            world = rotated(here, turn) + chain.position[sample]
            assert np.abs(world - there[:-1]).max() < 1e-4


def rotated(points: Any, angle: float) -> Any:
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])


def test_other_tracks_have_no_shoes() -> None:
    page = page_of(simulated(c2d.GrouserBeltTrack(), duration=0.5))
    assert page["frames"]["shoes"] == 0
    assert page["robot"]["shoes"] == []


def test_fifteen_seconds_of_a_chain_take_less_than_500_kb() -> None:
    run = stalled()
    assert run.time.size == 1501
    assert len(run.to_html().encode()) < 500_000


@pytest.mark.parametrize("shape", ["rectangle", "trapezoid"])
def test_a_chain_that_stalls_is_told_by_its_shoes(shape: Any) -> None:
    run = stalled(shape)
    assert run.outcome == c2d.Outcome.STALLED
    told = str(run.diagnosis)
    assert "into the track between two shoes, at x" in told
    name = {"rectangle": "a grouser", "trapezoid": "a shoe"}[shape]
    assert f"; {name} bears on it with" in told
    assert "wheel" not in told


@pytest.mark.parametrize("terrain", [c2d.terrains.flat(), LANES], ids=["one lane", "two lanes"])
@pytest.mark.parametrize("flippers", [False, True], ids=["bare", "flippers"])
def test_teeth_stand_between_the_pins_that_are_drawn(terrain: Any, flippers: bool) -> None:
    bare = c2d.robots.engineer(flippers=None, track=SPROCKET)
    robot = c2d.robots.engineer(track=SPROCKET) if flippers else bare
    run = c2d.simulate(robot, terrain, duration=4.0)
    geometry = _core.geometry(run.scenario.to_json())
    chassis, *arms = carriers(run, geometry)
    assert bool(arms) == flippers
    rear = np.array(geometry["sprocket"]["center"])[None]
    for sample in range(100, run.time.size, 25):
        teeth, places = outlines(chassis, sample)[0], pins(run, geometry)[sample]
        axle = chassis.placed(sample, rear)[0]
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
    geometry = _core.geometry(run.scenario.to_json())
    (chassis,) = carriers(run, geometry)
    _, ax = plt.subplots()
    run.plot(0.3, axes=ax)
    lines = [np.array(line.get_xydata()) for line in ax.get_lines()]
    drawn = outlines(chassis, int(np.abs(run.time - 0.3).argmin()))
    assert len(drawn) == 2 + 7 + 3
    for outline in drawn:
        assert any(np.array_equal(outline, line) for line in lines)
    corners = len(geometry["root_envelope"])
    assert all(len(line) != corners + 1 for line in lines)


def test_no_edge_is_between_the_wheels_in_a_chain() -> None:
    run = simulated(SPROCKET)
    row = next(row for row, bodies in enumerate(run.events["bodies"]) if len(set(bodies)) == 2)
    _, ax = plt.subplots()
    run.plot(0.5 * (run.events["start"][row] + run.events["end"][row]), axes=ax)
    (told,) = [
        str(line.get_label()) for line in ax.get_lines() if "inside" in str(line.get_label())
    ]
    assert re.fullmatch(r"edge inside the track: \d+\.\d mm", told)


@pytest.mark.parametrize("terrain", [STEP, LANES], ids=["one lane", "two lanes"])
def test_the_page_has_sprocket_idler_and_wheels(terrain: Any) -> None:
    run = simulated(SPROCKET, terrain, duration=0.5)
    robot, geometry = page_of(run)["robot"], _core.geometry(run.scenario.to_json())
    sprocket = geometry["sprocket"]
    first, *others = robot["wheels"]
    assert len(others) == 1 + 7 + 3
    assert (robot["hull"], robot["ends"], robot["envelope"]) == (None, [], None)
    assert first["radius"] == sprocket["radius"]
    assert np.abs(unpacked(first["outline"]).reshape(-1, 2) - sprocket["outline"]).max() < 1e-5
    assert not any("outline" in wheel for wheel in others)
    # Of two tracks the right one is in front.
    assert {wheel["drive"] for wheel in robot["wheels"]} == {run.drive_positions.shape[1] - 1}


def test_the_guide_is_called_by_its_name() -> None:
    found = stalled().diagnosis
    assert found is not None
    columns = {name: np.array(found.contacts[name]) for name in found.contacts}
    first = np.flatnonzero(columns["in_pocket"])[0]
    columns["body_kind"][columns["body"] == columns["body"][first]] = 6
    told = str(dataclasses.replace(found, contacts=Table(columns)))
    assert re.search(r"the guide (bears on it )?with \d+ N", told)
