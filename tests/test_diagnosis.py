"""Why a run stopped: what a diagnosis holds, and how it is said."""

import copy
import dataclasses
import math
import pickle
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from conftest import ROBOT
from crawler2d.common.table import Table
from crawler2d.results.findings import Condition, Counterfactual, Intrusion


def with_torque(limit: float) -> c2d.Robot:
    """Give the robot another torque limit [N m]."""
    drivetrain = dataclasses.replace(ROBOT.drivetrain, max_torque=limit)
    return dataclasses.replace(ROBOT, drivetrain=drivetrain)


WEIGHT = ROBOT.mass * 9.81
PUBLIC_WHEELS = c2d.HybridWheels(((-0.186, 0.0, 0.08), (0.0, 0.0, 0.08), (0.186, 0.0, 0.08)))
LOW_BELLY = dataclasses.replace(
    ROBOT, belly=((-0.15, -0.075), (0.15, -0.075), (0.15, 0.05), (-0.15, 0.05))
)
# Free wheels on a slope that their drive is just too weak for.
ROLLING = dataclasses.replace(
    c2d.robots.engineer(
        flippers=None, track=c2d.ForceTrack(support="wheels"), center_of_mass=(0.0347, 0.02)
    ),
    drivetrain=dataclasses.replace(ROBOT.drivetrain, max_torque=1.0),
)
STOPS: dict[str, tuple[c2d.Robot, Any]] = {
    "straddled": (ROBOT.with_track(c2d.LineOfWheels(4)), c2d.terrains.step(0.10)),
    # The belly hangs 50 mm above the ground: at that very height rounding says what bears.
    "undercut": (ROBOT.with_track(PUBLIC_WHEELS), c2d.terrains.barrier(0.0495, 0.02)),
    "bellied": (ROBOT.with_track(c2d.LineOfWheels(2)), c2d.terrains.barrier(0.065, 0.05)),
    "interlocked": (
        with_torque(3.0).with_track(c2d.LineOfWheels(3, wheel=c2d.GearWheel())),
        c2d.terrains.step(0.068),
    ),
    "slipping": (ROBOT.with_track(c2d.LineOfWheels(5)), c2d.terrains.step(0.3, friction=0.5)),
    "stalled": (with_torque(0.8), c2d.terrains.step(0.06)),
    "hung up": (LOW_BELLY, c2d.terrains.ridge(0.06, 1.5, friction=0.6)),
    "cycling": (ROLLING, c2d.terrains.ramp(0.304, friction=0.7)),
}
SAID = {
    "straddled": "seized, straddled: edge 1 reaches",
    "undercut": "seized, undercut: edge 1 reaches 49 mm inside the envelope between wheels 1 and 2",
    "bellied": "seized, bellied: edge 1 reaches",
    "interlocked": "stalled, interlocked: edge 1 reaches 10 mm inside the envelope between two",
    "slipping": "slipping: its track slips at 0.40 m/s; twice the friction or a push of ",
    "stalled": "stalled: its motors stand at their torque limit; more torque or a push of ",
    "hung up": "hung up: 100 % of the load rests on the belly; a robot without its belly or a push",
    "cycling": "cycling",
}


@pytest.fixture(scope="module")
def stops() -> dict[str, c2d.Run]:
    """One run for each way to stop, with a belt tried at its stop."""
    scenarios = [c2d.Scenario(*parts, duration=10.0) for parts in STOPS.values()]
    runs = c2d.simulate_many(scenarios, counterfactual=True)
    return dict(zip(STOPS, runs, strict=True))


def why(run: c2d.Run) -> c2d.Diagnosis:
    assert run.diagnosis is not None
    return run.diagnosis


@pytest.mark.parametrize("name", STOPS)
def test_every_way_to_stop_is_named_and_said(stops: dict[str, c2d.Run], name: str) -> None:
    run, text = stops[name], str(stops[name].diagnosis)
    assert run.outcome is why(run).outcome
    assert run.outcome.is_stop
    assert run.mechanism is why(run).mechanism
    assert text.startswith(SAID[name])
    assert text.startswith(str(run.outcome).replace("_", " "))


@pytest.mark.parametrize("name", STOPS)
def test_the_figures_of_a_diagnosis_agree_with_its_run(
    stops: dict[str, c2d.Run], name: str
) -> None:
    run, d = stops[name], why(stops[name])
    last = run.events["end"][run.events["kind"] == "stop"][-1]
    assert d.time == last == run.time[-1]
    assert d.since == run.events["start"][run.events["kind"] == "stop"][-1]
    assert d.progress == run.metrics["progress"]
    seen = run.time > d.time - 2.0 * run.scenario.criteria.stop_window
    for value, history in zip(
        (*d.position, d.chassis_angle), (*run.position.T, run.chassis_angle), strict=True
    ):
        assert history[seen].min() - 1e-6 <= value <= history[seen].max() + 1e-6
    assert 0.0 <= d.belly_share <= 1.0 + 1e-9
    assert 0.0 <= d.sliding_share <= 1.0 + 1e-9
    assert 0.0 <= d.stalled_share <= 1.0
    assert d.certified
    assert d.imbalance is not None
    for push in (d.escape_force, d.free_escape_force):
        assert push is None or push >= 0.0
    forces = d.contacts["normal_force"]
    assert (forces > 0.0).all()
    lift = forces * d.contacts["normal_y"] - d.contacts["friction_force"] * d.contacts["normal_x"]
    assert lift.sum() == pytest.approx(WEIGHT, rel=0.02)


def test_the_contacts_of_a_diagnosis_have_the_documented_columns(
    stops: dict[str, c2d.Run],
) -> None:
    contacts, of_run = why(stops["straddled"]).contacts, stops["straddled"].contacts
    same = [name for name in of_run if name not in ("time", "penetration")]
    assert list(contacts) == [*same, "slides", "in_pocket"]
    assert contacts["slides"].dtype == contacts["in_pocket"].dtype == bool
    with pytest.raises(ValueError, match="read-only"):
        contacts["slides"][0] = False


def test_the_intrusion_of_a_diagnosis_is_that_of_its_stop(stops: dict[str, c2d.Run]) -> None:
    run = stops["straddled"]
    inside = why(run).intrusion
    assert inside is not None
    (row,) = np.flatnonzero(run.events["kind"] == "stop")
    assert inside.edge == run.events["edge"][row]
    assert inside.bodies == run.events["bodies"][row]
    assert inside.depth == pytest.approx(run.metrics["intrusion_depth"], abs=1e-4)
    assert (inside.x, inside.y) == pytest.approx((0.0, 0.10), abs=1e-9)
    on_it = why(run).contacts["in_pocket"]
    assert why(run).contacts["normal_force"][on_it].sum() == pytest.approx(inside.force)


def test_names_come_back_as_members_of_their_enumerations(stops: dict[str, c2d.Run]) -> None:
    d = why(stops["straddled"])
    assert d.outcome is c2d.Outcome.SEIZED
    assert d.mechanism is c2d.Mechanism.STRADDLED
    assert d.cause == ((Condition.POCKET,),)
    assert d.seized_at_tips
    assert d.counterfactual is not None
    assert isinstance(d.counterfactual.outcome, c2d.Outcome)
    assert why(stops["hung up"]).cause == ((Condition.BELLY,),)
    assert why(stops["stalled"]).cause == ((Condition.TORQUE,),)
    assert why(stops["slipping"]).cause == ((Condition.FRICTION,),)


def test_a_belt_gets_away_where_wheels_seize_and_not_where_it_is_stuck_itself(
    stops: dict[str, c2d.Run],
) -> None:
    for name in ("straddled", "undercut", "bellied", "stalled", "slipping"):
        belt = why(stops[name]).counterfactual
        assert belt is not None
        if stops[name].outcome is c2d.Outcome.SEIZED:
            assert belt.freed
            assert 0.0 < belt.time < 5.0
            assert belt.distance > 0.05
        else:
            assert not belt.freed
            assert math.isinf(belt.time)


def test_what_did_not_stop_has_no_diagnosis(run: c2d.Run) -> None:
    for moving in (run, c2d.simulate(ROBOT, c2d.terrains.flat(), duration=0.5)):
        assert moving.diagnosis is None
        assert moving.mechanism is None
        assert not moving.is_creeping
    error = c2d.SimulationDiverged("chassis is not finite")
    failed = c2d.Run(run.scenario, {}, error)
    assert failed.diagnosis is None
    assert failed.mechanism is None
    assert not failed.is_creeping


@pytest.mark.parametrize(
    ("progress", "creeps"), [(0.0, False), (0.02, True), (0.19, True), (0.20, False), (1.0, False)]
)
def test_a_run_creeps_between_its_criteria(run: c2d.Run, progress: float, creeps: bool) -> None:
    result = {"outcome": "timed_out", "metrics": {**run.metrics, "progress": progress}}
    assert c2d.Run(run.scenario, result).is_creeping is creeps


def test_gears_on_a_slope_that_is_just_too_steep_creep() -> None:
    track = c2d.LineOfWheels(6, wheel=c2d.GearWheel(grouser_count=6))
    slopes = [c2d.terrains.ramp(angle, length=3.0) for angle in (0.50, 0.65, 0.80)]
    scenarios = [c2d.Scenario(ROBOT.with_track(track), slope, duration=10.0) for slope in slopes]
    runs = c2d.simulate_many(scenarios, record="summary")
    assert [run.is_creeping for run in runs] == [False, True, False]
    assert [run.outcome.is_stop for run in runs if run.outcome] == [False, False, True]


@pytest.mark.parametrize("name", ["straddled", "interlocked", "stalled"])
def test_a_diagnosis_survives_pickling_with_everything(
    stops: dict[str, c2d.Run], name: str
) -> None:
    run = stops[name]
    for twin in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
        assert str(twin.diagnosis) == str(run.diagnosis)
        for field in dataclasses.fields(c2d.Diagnosis):
            own, other = getattr(run.diagnosis, field.name), getattr(twin.diagnosis, field.name)
            assert type(own) is type(other)
            if field.name == "contacts":
                assert {k: v.tolist() for k, v in own.items()} == {
                    k: v.tolist() for k, v in other.items()
                }
            else:
                assert own == other, field.name
    assert pickle.loads(pickle.dumps(run)).trunk is None


def test_a_mechanism_is_not_a_cause(stops: dict[str, c2d.Run]) -> None:
    d = why(stops["interlocked"])
    assert (d.outcome, d.mechanism) == ("stalled", "interlocked")
    assert d.cause == ((Condition.TORQUE,),)
    # The edge is between two grousers of one wheel: a pocket of a track that reaches to the tips.
    assert d.seized_at_tips


CONTACTS = {
    "body": [2, 1, 0],
    "body_kind": [0, 0, 0],
    "edge": [1, 1, -1],
    "normal_force": [150.0, 40.0, 60.0],
    "surface_speed": [-0.4, -0.4, 0.4],
    "slides": [True, True, True],
    "in_pocket": [True, True, False],
}
PIECE = Intrusion(
    edge=3,
    edges=(3,),
    bodies=(4, 3),
    body_kinds=(0, 0),
    depth=0.041,
    root_depth=0.041,
    x=0.6,
    y=0.1,
    force=190.0,
)
BELT = Counterfactual(freed=True, distance=0.3, time=0.4, outcome=c2d.Outcome.CLEARED)


def made(contacts: Any = None, **fields: Any) -> c2d.Diagnosis:
    """Make a diagnosis: wheels 2 and 1 slide on edge 3, unless told otherwise."""
    columns = {name: np.array(column) for name, column in (CONTACTS | (contacts or {})).items()}
    plain: dict[str, Any] = {
        "outcome": c2d.Outcome.SEIZED,
        "mechanism": c2d.Mechanism.STRADDLED,
        "cause": ((Condition.POCKET,),),
        "seized_at_tips": True,
        "time": 9.0,
        "since": 6.0,
        "position": (0.5, 0.1),
        "chassis_angle": 0.2,
        "intrusion": PIECE,
        "belly_share": 0.0,
        "sliding_share": 1.0,
        "stalled_share": 0.0,
        "progress": 0.0,
        "stationary": True,
        "imbalance": 1e-9,
        "certified": True,
        "escape_force": 61.2,
        "free_escape_force": 400.0,
        "counterfactual": None,
    }
    return c2d.Diagnosis(**(plain | {"contacts": Table(columns)} | fields))


INSIDE = "edge 3 reaches 41 mm inside the envelope between wheels 3 and 4, at x 0.600 m, y 0.100 m"
ON_IT = "wheel 2 slides on it with 150 N, wheel 1 with 40 N"


def test_a_sentence_says_what_is_inside_what_bears_and_what_would_move_it() -> None:
    assert str(made()) == (
        f"seized, straddled: {INSIDE}; {ON_IT}; a closed track or a push of 61 N would move it on"
    )
    assert str(made(counterfactual=BELT)) == (
        f"seized, straddled: {INSIDE}; {ON_IT}; a push of 61 N would move it on; "
        "a closed belt gets away"
    )


@pytest.mark.parametrize(
    ("contacts", "mechanism", "said"),
    [
        ({}, "straddled", ON_IT),
        (
            {"slides": [False, True, True]},
            "straddled",
            "wheel 2 bears on it with 150 N and wheel 1 slides on it with 40 N",
        ),
        ({"in_pocket": [False, True, False]}, "undercut", "wheel 1 slides on it with 40 N"),
        # Two contacts of one wheel are one wheel.
        ({"body": [2, 2, 0]}, "undercut", "wheel 2 slides on it with 190 N"),
        ({"body_kind": [3, 0, 0]}, "bellied", "the belly slides on it with 150 N, wheel 1 with"),
        (
            {"slides": [False] * 3},
            "interlocked",
            "wheel 2 bears on it with 150 N, wheel 1 with 40 N, a grouser's flank against it",
        ),
        # Shoes have no numbers that a reader could count.
        ({"body_kind": [5, 5, 5]}, "undercut", "a shoe slides on it with 150 N, another with 40 N"),
        ({"body_kind": [6, 4, 4]}, "undercut", "the guide slides on it with 150 N, a grouser with"),
        # A hundredth of the force is not worth a name.
        ({"normal_force": [150.0, 1.0, 60.0]}, "straddled", "wheel 2 slides on it with 150 N;"),
    ],
)
def test_bodies_on_the_edge_are_named_by_what_they_do(
    contacts: Any, mechanism: str, said: str
) -> None:
    d = made(contacts, mechanism=c2d.Mechanism(mechanism))
    assert f"; {said}" in str(d)


@pytest.mark.parametrize(
    ("piece", "said"),
    [
        ({}, "41 mm inside the envelope between wheels 3 and 4, at x 0.600 m, y 0.100 m;"),
        ({"x": -1e-9}, "between wheels 3 and 4, at x 0.000 m"),
        ({"root_depth": 0.029}, "inside the envelope, 29 mm below the roots, between wheels 3"),
        ({"root_depth": 0.0}, "inside the envelope, not below the roots, between wheels 3 and 4"),
        ({"root_depth": 0.0, "bodies": (4, 4)}, "the envelope between two grousers of wheel 4, at"),
        ({"bodies": (4, 4)}, "the envelope at wheel 4, at x 0.600 m"),
        # What a chain runs on has no numbers that a reader could count.
        ({"body_kinds": (9, 9)}, "under the shoes between a road wheel and the next, at x 0.600"),
        ({"body_kinds": (9, 7)}, "under the shoes between a road wheel and the sprocket, at x"),
        ({"bodies": (44, 44), "body_kinds": (6, 6)}, "the envelope between two shoes, at x 0.600"),
        (
            {"bodies": (0, 0), "body_kinds": (1, 1), "root_depth": 0.029},
            "the envelope between two grousers of the belt, at x 0.600 m",
        ),
    ],
)
def test_ground_inside_is_told_by_its_place_and_depth(piece: Any, said: str) -> None:
    assert said in str(made(intrusion=dataclasses.replace(PIECE, **piece)))


POCKET, BELLY, TORQUE, FRICTION = Condition


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"cause": ((POCKET,), (FRICTION,))}, "a closed track, twice the friction or a push of 61"),
        # A tie is told without the pocket where a belt has been tried.
        (
            {"cause": ((POCKET,), (FRICTION,)), "counterfactual": BELT},
            "; twice the friction or a push of 61 N would move it on; a closed belt gets away",
        ),
        ({"cause": ((BELLY, TORQUE),)}, "a robot without its belly with more torque or a push"),
        ({"escape_force": 0.2}, "a closed track or the slightest push would move it on"),
        ({"escape_force": math.inf}, "a closed track would move it on, but not any push"),
        ({"cause": (), "escape_force": math.inf}, "; no push would move it on"),
        ({"escape_force": None}, "; a closed track would move it on"),
        ({"cause": (), "escape_force": None, "certified": False, "imbalance": 0.034}, "balance"),
    ],
)
def test_what_would_move_it_on_is_told_once(fields: Any, said: str) -> None:
    assert said in str(made(**fields))


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        (
            {"outcome": "stalled", "stalled_share": 1.0},
            "stalled: its motors stand at their torque limit; a push of 61 N would move it on, but "
            "not more torque",
        ),
        (
            {"outcome": "stalled", "stalled_share": 0.6, "escape_force": math.inf},
            "stalled: 60 % of its motors stand at their torque limit; neither more torque nor any "
            "push would move it on",
        ),
        (
            {"outcome": "stalled", "stalled_share": 1.0, "escape_force": None},
            "stalled: its motors stand at their torque limit; more torque would not move it on",
        ),
        (
            {"outcome": "slipping", "escape_force": 20.0},
            "slipping: its track slips at 0.40 m/s; a push of 20 N would move it on, but not twice "
            "the friction",
        ),
        (
            {"outcome": "hung_up", "belly_share": 0.995, "cause": ((BELLY,),)},
            "hung up: 100 % of the load rests on the belly; a robot without its belly or a push of "
            "61 N would move it on",
        ),
        (
            {"outcome": "cycling", "cause": ((FRICTION,),), "progress": 0.031},
            "cycling: its track slips at 0.40 m/s; it creeps on at 3 % of what is commanded; twice "
            "the friction or a push of 61 N would move it on",
        ),
        (
            {"outcome": "slipping", "certified": False, "escape_force": None, "imbalance": 0.034},
            "slipping: its track slips at 0.40 m/s; no contact forces balance it: 3.4 % of the "
            "weight is missing",
        ),
        (
            {"outcome": "slipping", "certified": False, "escape_force": None, "imbalance": None},
            "slipping: its track slips at 0.40 m/s; its balance could not be computed",
        ),
    ],
)
def test_a_stop_without_ground_inside_is_told_by_motors_and_surfaces(
    fields: dict[str, Any], said: str
) -> None:
    contacts = {"in_pocket": [False] * 3}
    given: dict[str, Any] = {"mechanism": None, "intrusion": None, "cause": (), **fields}
    assert str(made(contacts, **given | {"outcome": c2d.Outcome(given["outcome"])})) == said


@pytest.mark.parametrize(
    ("belt", "said"),
    [
        ({}, "; a closed belt gets away"),
        ({"freed": False, "distance": 0.0123}, "; a closed belt gets 12 mm further"),
        ({"freed": False, "distance": 0.0}, "; a closed belt gets no further"),
    ],
)
def test_a_tried_belt_ends_the_sentence(belt: Any, said: str) -> None:
    assert str(made(counterfactual=dataclasses.replace(BELT, **belt))).endswith(said)


@pytest.mark.parametrize(("kind", "name"), [(1, "the belt"), (2, "the skid")])
def test_the_body_of_a_closed_track_is_no_wheel(kind: int, name: str) -> None:
    # Ground that a branch found inside of it.
    contacts = {"body": [0, 0, 0], "body_kind": [kind] * 3, "in_pocket": [True, False, False]}
    piece = dataclasses.replace(PIECE, bodies=(0, 0), body_kinds=(kind, kind))
    said = str(made(contacts, intrusion=piece))
    assert f"inside the envelope at {name}, at x 0.600 m" in said
    assert f"; {name} slides on it with 150 N;" in said
    assert "wheel" not in said


def test_of_a_belt_nobody_is_told_that_a_belt_does_the_same() -> None:
    inside = dataclasses.replace(PIECE, bodies=(0, 0), body_kinds=(1, 1))
    for piece in (inside, None):
        fields = {"intrusion": piece, "outcome": c2d.Outcome.SLIPPING, "counterfactual": BELT}
        assert "closed belt" not in str(made({"body_kind": [1, 4, 4]}, **fields))


def test_a_simulation_under_way_says_why_it_has_stopped(stops: dict[str, c2d.Run]) -> None:
    run = stops["straddled"]
    sim = c2d.Simulation(run.scenario)
    sim.advance(0.5)
    assert sim.diagnosis() is None
    sim.advance(run.time[-1] - 0.5)
    found = sim.diagnosis()
    assert found is not None
    assert dataclasses.replace(why(run), counterfactual=None).to_plain().keys() == (
        found.to_plain().keys()
    )
    assert (found.mechanism, found.cause) == (run.mechanism, why(run).cause)
    assert found.escape_force == why(run).escape_force


def test_a_belt_is_only_tried_where_that_is_asked_for() -> None:
    scenario = c2d.Scenario(*STOPS["straddled"], duration=5.0)
    run = c2d.simulate(scenario, record="summary")
    assert why(run).counterfactual is None
    assert why(c2d.simulate(scenario, record="summary", counterfactual=True)).counterfactual


@pytest.mark.parametrize("wrong", ["yes", 1, None, [True]])
def test_whether_to_try_a_belt_is_true_or_false(wrong: Any) -> None:
    scenario = c2d.Scenario(*STOPS["straddled"], duration=0.1)
    for call in (
        lambda: c2d.simulate(scenario, counterfactual=wrong),
        lambda: c2d.simulate_many([scenario], counterfactual=wrong),
        lambda: c2d.sweep(scenario, {"duration": [0.1]}, counterfactual=wrong, progress=False),
    ):
        with pytest.raises(c2d.ScenarioError, match="True or False") as caught:
            call()
        assert caught.value.path == "counterfactual"


def test_a_push_beyond_the_escape_force_moves_the_robot_and_a_smaller_one_does_not(
    stops: dict[str, c2d.Run],
) -> None:
    run = stops["straddled"]
    force = why(run).escape_force
    assert force is not None
    for share, leaves in ((0.5, False), (4.0, True)):
        sim = c2d.Simulation(run.scenario)
        sim.advance(run.time[-1])
        x = sim.state().position[0]
        sim.command(push=share * force)
        sim.advance(2.0)
        assert (abs(sim.state().position[0] - x) > 0.01) == leaves
