"""Contents of the diagnosis of a stop."""

import copy
import dataclasses
import math
import pickle
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d import _core
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
# Free wheels on a slope that is just too steep for their drive.
ROLLING = dataclasses.replace(
    c2d.robots.engineer(
        flippers=None, track=c2d.ForceTrack(support="wheels"), center_of_mass=(0.0347, 0.02)
    ),
    drivetrain=dataclasses.replace(ROBOT.drivetrain, max_torque=1.0),
)
STOPS: dict[str, tuple[c2d.Robot, Any]] = {
    "straddled": (ROBOT.with_track(c2d.LineOfWheels(4)), c2d.terrains.step(0.10)),
    # The belly is 50 mm above the ground: at exactly that height, rounding decides what bears.
    "undercut": (ROBOT.with_track(PUBLIC_WHEELS), c2d.terrains.barrier(0.0495, 0.02)),
    "on its belly": (ROBOT.with_track(c2d.LineOfWheels(2)), c2d.terrains.barrier(0.065, 0.05)),
    "interlocked": (
        with_torque(3.0).with_track(c2d.LineOfWheels(3, wheel=c2d.GearWheel())),
        c2d.terrains.step(0.068),
    ),
    "slipping": (ROBOT.with_track(c2d.LineOfWheels(5)), c2d.terrains.step(0.06, friction=0.5)),
    "stalled": (with_torque(0.8), c2d.terrains.step(0.06)),
    "hung up": (LOW_BELLY, c2d.terrains.ridge(0.06, 1.5, friction=0.6)),
    "cycling": (ROLLING, c2d.terrains.ramp(0.304, friction=0.7)),
}
SAID = {
    "straddled": "seized between wheels 1 and 2: the ground at x = 0.000 m, y = 0.100 m stands",
    "undercut": "seized between wheels 1 and 2: the ground at x =",
    "on its belly": "hung up: the belly carries 59 % of the supporting force at x = ",
    "interlocked": "stalled: the ground at x = 0.000 m, y = 0.067 m stands",
    "slipping": "slipping: the track slips at 0.40 m/s. Tried:",
    "stalled": "stalled: the motors are at their torque limit. Tried:",
    "hung up": "hung up: the belly carries 100 % of the supporting force at x = ",
    "cycling": "cycling",
}


@pytest.fixture(scope="module")
def stops() -> dict[str, c2d.Run]:
    """One run for each way to stop, with all trials."""
    scenarios = [c2d.Scenario(*parts, duration=10.0) for parts in STOPS.values()]
    runs = c2d.simulate_many(scenarios, trials="all")
    return dict(zip(STOPS, runs, strict=True))


def why(run: c2d.Run) -> c2d.Diagnosis:
    assert run.diagnosis is not None
    return run.diagnosis


@pytest.mark.parametrize("name", STOPS)
def test_every_outcome_of_a_stop_has_a_sentence(stops: dict[str, c2d.Run], name: str) -> None:
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
    assert (d.outcome, d.symptom) == (c2d.Outcome.SEIZED, c2d.Outcome.SLIPPING)
    assert isinstance(d.symptom, c2d.Outcome)
    assert d.mechanism is c2d.Mechanism.STRADDLED
    assert all(isinstance(tried.outcome, c2d.Outcome) for tried in d.trials)
    assert d.intrusion is not None
    assert (d.intrusion.carrier, d.intrusion.side) == ("chassis", "both")


@pytest.mark.parametrize(
    ("name", "freed"),
    [
        ("straddled", {"closed track"}),
        ("undercut", {"closed track"}),
        ("on its belly", {"no belly"}),
        ("slipping", {"friction x 2"}),
        ("stalled", {"torque x 10"}),
        ("hung up", {"no belly"}),
    ],
)
def test_a_stop_is_freed_by_what_holds_it(
    stops: dict[str, c2d.Run], name: str, freed: set[str]
) -> None:
    d = why(stops[name])
    assert freed <= set(d.freed_by)
    assert not {"unchanged", "rebuilt"} & set(d.freed_by)
    assert not d.transient
    for tried in d.trials:
        is_lost = tried.outcome in ("tipped_over", "left_terrain", "detracked")
        assert tried.freed == math.isfinite(tried.time)
        assert tried.freed == (tried.distance > 0.05 and not is_lost)
        if not tried.is_from_the_start:
            assert tried.duration == pytest.approx(5.0 + 0.05 / 0.4)
        assert 1 <= tried.starts <= 5
        assert tried.freeing <= tried.starts


def test_a_run_without_a_stop_has_no_diagnosis(run: c2d.Run) -> None:
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
    assert pickle.loads(pickle.dumps(run)).parent is None


def test_a_diagnosis_of_an_older_file_has_a_field_of_its_former_name(
    stops: dict[str, c2d.Run],
) -> None:
    values = why(stops["straddled"]).to_dict()
    values["passing"] = values.pop("transient")
    assert c2d.Diagnosis.from_core(values).transient is False


def test_a_mechanism_is_not_a_reason(stops: dict[str, c2d.Run]) -> None:
    """An edge between two grousers of one wheel jams no track."""
    d = why(stops["interlocked"])
    assert (d.outcome, d.mechanism, d.jammed) == ("stalled", "interlocked", False)
    assert "torque x 10" in d.freed_by


def test_a_simulation_under_way_says_why_it_has_stopped(stops: dict[str, c2d.Run]) -> None:
    scenario = stops["straddled"].scenario.replace({"duration": 5.0})
    run = c2d.simulate(scenario)
    sim = c2d.Simulation(scenario)
    assert sim.diagnosis() is None
    sim.advance(5.0)
    found = sim.diagnosis()
    assert found is not None
    needed = {name: value for name, value in found.to_dict().items() if name != "trials"}
    np.testing.assert_equal(needed, {name: why(run).to_dict()[name] for name in needed})
    # During a run only the trials that its outcome needs are made.
    assert set(found.freed_by) <= set(why(run).freed_by)


NEEDED = [
    *("unchanged", "rebuilt", "closed track", "closed track, clear of the ground"),
    # The belt tips over at this step, so another trial is made.
    *("belt, from the start", "closed track, from the start"),
]


@pytest.mark.parametrize(
    ("trials", "more"),
    [
        (None, []),
        ("auto", ["torque x 2", "friction x 2"]),
        ("all", ["belt", "torque x 2", "torque x 10", "friction x 2", "no belly"]),
        (["no belly"], ["no belly"]),
        ((), []),
    ],
)
def test_trials_that_the_outcome_does_not_need_are_made_on_request(
    trials: Any, more: list[str]
) -> None:
    scenario = c2d.Scenario(*STOPS["straddled"], duration=5.0)
    run = c2d.simulate(scenario, record="summary", trials=trials)
    names = [tried.name for tried in why(run).trials]
    assert names == sorted(NEEDED + more, key=_core.kinds()["trial"].index)


@pytest.mark.parametrize("wrong", ["yes", 1, True, ["torque x 3"], [1], "torque x 2"])
def test_an_unknown_trial_is_refused_by_name(wrong: Any) -> None:
    scenario = c2d.Scenario(*STOPS["straddled"], duration=0.1)
    for call in (
        lambda: c2d.simulate(scenario, trials=wrong),
        lambda: c2d.simulate_many([scenario], trials=wrong),
        lambda: c2d.sweep(scenario, {"duration": [0.1]}, trials=wrong, progress=False),
    ):
        with pytest.raises(c2d.ScenarioError) as caught:
            call()
        assert caught.value.path == "trials"
        assert "must be" in caught.value.rule
