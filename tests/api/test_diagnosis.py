"""Why a run stopped: what a diagnosis holds."""

import copy
import dataclasses
import math
import pickle
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.results.findings import Condition
from tests.shared import ROBOT


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
    "undercut": "seized, undercut: edge 1 reaches 49 mm into the track between wheels 1 and 2",
    "bellied": "seized, bellied: edge 1 reaches",
    "interlocked": "stalled, interlocked: edge 1 reaches 10 mm into the track between two",
    "slipping": "slipping: the track slips at 0.40 m/s; twice the friction or a push of ",
    "stalled": "stalled: the motors are at their torque limit; more torque or a push of ",
    "hung up": "hung up: the belly carries 100 % of the load; removing the belly or a push",
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


def test_a_simulation_under_way_says_why_it_has_stopped(stops: dict[str, c2d.Run]) -> None:
    scenario = stops["straddled"].scenario.replace({"duration": 5.0})
    run = c2d.simulate(scenario)
    sim = c2d.Simulation(scenario)
    assert sim.diagnosis() is None
    sim.advance(5.0)
    found = sim.diagnosis()
    assert found is not None
    np.testing.assert_equal(found.to_plain(), why(run).to_plain())
    assert (found.mechanism, found.cause) == (run.mechanism, why(run).cause)


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
