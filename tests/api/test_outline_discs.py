"""Outlines of discs: both forms of two discs, any number of them, and refusals."""

import copy
import dataclasses
import json
import pickle
from typing import Any, cast

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.parameters.fields import read_path
from crawler2d.parameters.scenario import Scenario
from tests.shared import ROBOT, TRAPEZOID, VARIANTS, refusal, refused

GROUSERS = {"grouser_height": 0.012, "grouser_pitch": 0.048, "grouser_thickness": 0.006}
TWO = ((-0.1825, 0.0, 0.05), (0.1825, 0.0, 0.064))
DISCS = TRAPEZOID.outline.discs
STEP = c2d.terrains.step(0.05)


def on(discs: Any, **fields: Any) -> c2d.Robot:
    """The Engineer on other discs."""
    outline = c2d.TrackOutline(discs=discs, **{**GROUSERS, **fields})
    return dataclasses.replace(ROBOT, outline=outline)


# The two forms of two discs.


def test_two_discs_in_either_form_are_the_same_object_text_and_identity() -> None:
    short = c2d.TrackOutline(axle_distance=0.365, front_radius=0.064, rear_radius=0.05, **GROUSERS)
    long = c2d.TrackOutline(discs=np.array(TWO), **GROUSERS)
    assert short == long
    assert hash(short) == hash(long)
    assert repr(short) == repr(long)
    assert repr(short).startswith("TrackOutline(axle_distance=0.365, front_radius=0.064, rear_")
    scenarios = [Scenario(dataclasses.replace(ROBOT, outline=o), STEP) for o in (short, long)]
    assert scenarios[0].to_json() == scenarios[1].to_json()
    assert scenarios[0].identity == scenarios[1].identity
    outline = json.loads(scenarios[0].to_json())["robot"]["outline"]
    ends = {"axle_distance": 0.365, "front_radius": 0.064, "rear_radius": 0.05}
    assert outline == {**ends, **GROUSERS}


def test_a_text_with_two_discs_is_read_as_the_short_form() -> None:
    plain = json.loads(Scenario(ROBOT, STEP).to_json())
    text = _core.canonical(json.dumps(plain))
    for name in ("axle_distance", "front_radius", "rear_radius"):
        del plain["robot"]["outline"][name]
    plain["robot"]["outline"]["discs"] = [[-0.1825, 0, 0.064], [0.1825, -0.0, 0.064]]
    assert _core.canonical(json.dumps(plain)) == text
    assert Scenario.from_json(json.dumps(plain)) == Scenario(ROBOT, STEP)


@pytest.mark.parametrize(
    "discs",
    [
        DISCS,
        ((-0.1825, 0.0, 0.064), (0.1825, 0.02, 0.064)),  # not at one height
        ((-0.18, 0.0, 0.064), (0.1825, 0.0, 0.064)),  # the frame is not midway
        ((0.1825, 0.0, 0.064), (-0.1825, 0.0, 0.064)),  # the front one first
    ],
)
def test_all_other_discs_are_kept_as_they_are_given(discs: Any) -> None:
    scenario = Scenario(on(discs), STEP)
    scenario.validate()
    assert scenario.robot.outline.discs == discs
    plain = json.loads(scenario.to_json())["robot"]["outline"]
    assert plain == {"discs": [list(disc) for disc in discs], **GROUSERS}
    assert json.loads(_core.canonical(scenario.to_json())) == json.loads(scenario.to_json())
    read = Scenario.from_json(scenario.to_json())
    assert (read, read.identity) == (scenario, scenario.identity)
    outline = scenario.robot.outline
    assert eval(repr(outline), {"TrackOutline": c2d.TrackOutline}) == outline
    assert pickle.loads(pickle.dumps(outline)) == copy.deepcopy(outline) == outline


# The ends.


@pytest.mark.parametrize(
    ("discs", "expected"),
    [
        (DISCS, (0.57, 0.045, 0.05)),
        (DISCS[::-1], (0.57, 0.045, 0.05)),
        # The rear end reaches farther back than the disc whose axle lies farthest back.
        (((-0.2, 0, 0.08), (-0.21, 0.2, 0.03), (0.2, 0, 0.05)), (0.4, 0.05, 0.08)),
        # If two reach equally far, the higher one is an end.
        (((-0.2, 0, 0.05), (-0.21, 0.2, 0.04), (0.2, 0, 0.05)), (0.41, 0.05, 0.04)),
        (((-0.21, 0.2, 0.04), (-0.2, 0, 0.05), (0.2, 0, 0.05)), (0.41, 0.05, 0.04)),
    ],
)
def test_the_ends_reach_farthest(discs: Any, expected: tuple[float, float, float]) -> None:
    outline = on(discs).outline
    found = (outline.axle_distance, outline.front_radius, outline.rear_radius)
    assert found == pytest.approx(expected, abs=1e-15)
    geometry = _core.geometry(Scenario(on(discs), STEP).to_json())
    assert geometry["carriers"][0]["envelope"][:, 0].min() == pytest.approx(
        outline.ends[0][0] - outline.rear_radius, abs=1e-3
    )


def test_clearing_means_that_all_of_the_track_is_past_the_goal() -> None:
    run = c2d.simulate(Scenario(TRAPEZOID, c2d.terrains.flat(length=0.5)))
    assert run.outcome == "cleared"
    x = np.interp(run.metrics["time_to_clear"], run.time, run.position[:, 0])
    assert x + TRAPEZOID.outline.ends[0][0] - 0.05 == pytest.approx(0.5, abs=2e-4)


def test_it_starts_with_its_foremost_disc_at_the_approach() -> None:
    scenario = Scenario(TRAPEZOID, STEP, start=c2d.Start(approach=0.1))
    state = c2d.Simulation(scenario).state()
    assert state.position[0] + 0.29 + 0.045 == pytest.approx(-0.1, abs=1e-12)
    assert state.position[1] == pytest.approx(0.064, abs=1e-12)


def test_flippers_add_their_mass_on_the_end_axles() -> None:
    arms = c2d.Flippers(
        length=0.3, root_radius=0.05, tip_radius=0.03, mass=1.0, torque_limit=20.0, ends="both"
    )
    robot = TRAPEZOID.with_flippers(arms)
    x, y = TRAPEZOID.center_of_mass
    mass = TRAPEZOID.mass
    places = np.array([[0.29 + 0.15, 0.1], [-0.28 - 0.15, 0.09]])
    expected = (mass * np.array([x, y]) + 2.0 * places.sum(axis=0)) / (mass + 4.0)
    assert robot.center_of_mass == pytest.approx(expected.tolist())
    back = robot.without_flippers()
    assert back.center_of_mass == pytest.approx((x, y), abs=1e-15)
    assert back.moment_of_inertia == pytest.approx(TRAPEZOID.moment_of_inertia)
    c2d.simulate(Scenario(robot, STEP, duration=0.5))


# Replacing and sweeping.


def test_three_numbers_replace_those_of_two_discs() -> None:
    outline = on(TWO).outline
    assert dataclasses.replace(outline, front_radius=0.06).discs == (TWO[0], (0.1825, 0.0, 0.06))
    scenario = Scenario(on(TWO), STEP)
    wider = scenario.replace(
        {"robot.outline.axle_distance": 0.5, "robot.outline.rear_radius": 0.06}
    )
    assert wider.robot.outline.discs == ((-0.25, 0.0, 0.06), (0.25, 0.0, 0.064))
    assert read_path(wider, "robot.outline.axle_distance") == 0.5


def test_one_number_of_a_disc_can_be_replaced_and_swept() -> None:
    scenario = Scenario(TRAPEZOID, STEP)
    raised = scenario.replace({"robot.outline.discs[3][1]": 0.12})
    assert raised.robot.outline.discs == (*DISCS[:3], (0.29, 0.12, 0.045))
    lifted = Scenario(ROBOT, STEP).replace({"robot.outline.discs[1][1]": 0.02})
    assert lifted.robot.outline.ends == ((-0.1825, 0.0, 0.064), (0.1825, 0.02, 0.064))
    table = c2d.sweep(
        scenario.replace({"duration": 0.5}),
        {"robot.outline.discs[3][1]": [0.1, 0.12]},
        vary={"robot.outline.discs[0][2]": c2d.scaled(0.95, 1.05)},
        repeats=2,
        progress=False,
    )
    assert table["outcome"].shape == (2, 2)
    assert table["discs_3_1"].attrs["units"] == "m"


def test_discs_of_the_short_form_can_be_varied() -> None:
    scenario = Scenario(ROBOT, STEP, duration=0.5)
    how: Any = {"repeats": 3, "progress": False}
    tall = c2d.sweep(
        scenario, {}, vary={"robot.outline.discs[1][1]": c2d.uniform(0.0, 0.05)}, **how
    )
    assert len(set(tall["final_y"].values.ravel().tolist())) == 3
    wide = c2d.sweep(
        scenario, {}, vary={"robot.outline.front_radius": c2d.uniform(0.05, 0.06)}, **how
    )
    assert len(set(wide["final_angle"].values.ravel().tolist())) == 3


def test_a_number_that_follows_from_discs_is_not_replaced() -> None:
    for name in ("axle_distance", "front_radius", "rear_radius"):
        path, given = f"robot.outline.{name}", cast("dict[str, Any]", {name: 0.1})
        for each in (
            refused(lambda given=given: c2d.TrackOutline(discs=DISCS, **GROUSERS, **given)),
            refused(lambda given=given: dataclasses.replace(TRAPEZOID.outline, **given)),
            refused(lambda path=path: Scenario(TRAPEZOID, STEP).replace({path: 0.1})),
        ):
            assert (each.path, each.value) == (path, 0.1)
            assert "determine it" in each.rule
    plain = json.loads(Scenario(TRAPEZOID, STEP).to_json())
    plain["robot"]["outline"]["front_radius"] = 0.05
    error = refused(lambda: Scenario.from_json(json.dumps(plain)))
    assert error.path == "robot.outline.front_radius"


def test_a_missing_number_is_named() -> None:
    error = refused(lambda: c2d.TrackOutline(axle_distance=0.4, rear_radius=0.05, **GROUSERS))
    assert error.path == "robot.outline.front_radius"
    plain = json.loads(Scenario(TRAPEZOID, STEP).to_json())
    del plain["robot"]["outline"]["discs"]
    assert refused(lambda: Scenario.from_json(json.dumps(plain))).path == "robot.outline.discs"


@pytest.mark.parametrize("value", [0.0, -0.365, float("nan"), "0.365", None, True, [0.3, 0.4]])
def test_an_invalid_distance_is_refused_at_once(value: Any) -> None:
    error = refused(
        lambda: c2d.TrackOutline(
            axle_distance=value, front_radius=0.05, rear_radius=0.05, **GROUSERS
        )
    )
    assert error.path == "robot.outline.axle_distance"


# What is refused.


@pytest.mark.parametrize(
    ("discs", "path", "rule"),
    [
        ((), "discs", "must have at least 2 discs"),
        ((TWO[0],), "discs", "must have at least 2 discs"),
        ([(x, 0.0, 0.01) for x in np.linspace(-1.0, 1.0, 65)], "discs", "at most 64"),
        ((TWO[0], (0.2, 0.0, 0.0)), "discs[1][2]", "must be >= 0.0001 m"),
        ((TWO[0], (0.2, 0.0, -0.05)), "discs[1][2]", "must be >= 0.0001 m"),
        ((TWO[0], (0.2, np.nan, 0.05)), "discs[1][1]", "must be a finite number"),
        ((TWO[0], (np.inf, 0.0, 0.05)), "discs[1][0]", "must be a finite number"),
        ((TWO[0], TWO[1], TWO[0]), "discs[0]", "must not lie in another disc, discs[2]"),
        ((*TWO, (0.19, 0.0, 0.05)), "discs[2]", "must not lie in another disc, discs[1]"),
        # Touching it from inside, within rounding.
        ((*TWO, (0.1825, 0.014, 0.05)), "discs[2]", "must"),
        ((*TWO, (0.0, 0.0, 0.05)), "discs[2]", "must reach out of the hull of the others"),
        # On the lower run: the track would touch it, but not bend.
        (((-0.2, 0, 0.05), (0.0, 0, 0.05), (0.2, 0, 0.05)), "discs[1]", "must reach out"),
        (((-0.2, 0, 0.05), (0.2, 0, 0.05), (0.0, -1e-9, 0.05)), "discs[2]", "must reach out"),
        (((0.1, 0, 0.05), (0.3, 0.1, 0.05)), "discs", "must have the origin"),
        (((-0.3, 0, 0.05), (-0.1, 0.1, 0.05)), "discs", "must have the origin"),
        (((-0.05, 0, 0.1), (0.0, 0.1, 0.01), (0.0, 0.3, 0.01)), "discs", "must have its rearmost"),
        (((0.0, 0, 0.05), (0.0, 0.1, 0.05)), "discs", "must have its rearmost"),
    ],
)
def test_discs_that_no_track_runs_round_are_refused(discs: Any, path: str, rule: str) -> None:
    error = refusal(on(discs, grouser_height=0.0))
    assert error.path == f"robot.outline.{path}"
    assert rule in error.rule, error
    assert error.value not in (None, "")


@pytest.mark.parametrize("discs", [5, "discs", [[0, 0]], [[0, 0, "a"]], [[0, 0, None]], {1: 2}])
def test_anything_but_discs_is_refused_at_once(discs: Any) -> None:
    assert refused(lambda: on(discs)).path.startswith("robot.outline.discs")


def test_an_outline_without_discs_has_no_ends() -> None:
    empty = on(())
    asked: list[Any] = [lambda: empty.outline.axle_distance, empty.plot, Scenario(empty, STEP).plot]
    for call in asked:
        assert refused(call).path == "robot.outline.discs"
    assert empty._repr_html_() is None
    assert repr(empty.outline).startswith("TrackOutline(discs=(), ")


def test_grousers_are_lower_than_the_smallest_disc() -> None:
    error = refusal(on((*DISCS[:3], (0.29, 0.1, 0.012))))
    assert error.path == "robot.outline.grouser_height"


@pytest.mark.parametrize(
    ("track", "path", "value"),
    [
        (c2d.LineOfWheels(4), "kind", "line"),
        (c2d.ClosedTrack(c2d.LineOfWheels(4)), "of.kind", "line"),
        (c2d.ForceTrack(support="wheels"), "support", "wheels"),
        (c2d.SegmentalTrack(mechanism="sprocket"), "mechanism", "sprocket"),
    ],
)
def test_tracks_with_two_ends_are_refused_on_more_discs(track: Any, path: str, value: str) -> None:
    error = refusal(TRAPEZOID.with_track(track))
    assert (error.path, error.value) == (f"robot.track.{path}", value)
    assert "round 4 discs (robot.outline.discs)" in error.rule
    # Two discs at any height have two ends.
    inclined = on(((-0.2, 0.0, 0.05), (0.2, 0.05, 0.06)))
    Scenario(inclined.with_track(track), STEP).validate()


def test_flippers_of_a_trapezoid_may_be_lines_of_wheels() -> None:
    arms = dataclasses.replace(
        VARIANTS["flippers-climb"].robot.flippers,  # type: ignore[type-var]
        track=c2d.LineOfWheels(3),
    )
    Scenario(TRAPEZOID.with_flippers(arms), STEP).validate()  # type: ignore[arg-type]


def test_a_chain_that_does_not_fit_says_how_many_shoes_do() -> None:
    error = refusal(TRAPEZOID.with_track(c2d.SegmentalTrack(shoe_count=12)))
    assert error.path == "robot.track.shoe_count"
    least = int(error.rule.split("from ")[1].split()[0])
    Scenario(TRAPEZOID.with_track(c2d.SegmentalTrack(shoe_count=least)), STEP).validate()


@pytest.mark.parametrize("track", [c2d.BeltTrack(), c2d.GrouserBeltTrack(), c2d.SegmentalTrack()])
def test_a_run_on_discs_can_be_tried_continued_and_shown(track: Any, tmp_path: Any) -> None:
    scenario = Scenario(
        TRAPEZOID.with_track(track),
        c2d.terrains.step(0.3, friction=0.4),
        start=c2d.Start(approach=0.02),
        solver=c2d.Solver(accuracy=1e-4),  # the position of its stop does not matter here
    )
    run = c2d.simulate(scenario.replace({"duration": 2.5}))
    assert run.diagnosis is not None
    assert run.what_if("friction x 2").name == "friction x 2"
    page = tmp_path / "run.html"
    run.to_html(page)
    assert "engineer" in page.read_text(encoding="utf-8")
    branch = run.branch(at=0.5, duration=0.5)
    assert branch.position.shape[1] == 2
