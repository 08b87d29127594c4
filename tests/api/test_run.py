"""A run: its arrays, tables and exports."""

import copy
import json
import math
import pickle
import sys
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.arrays import Table
from crawler2d.parameters.scenario import Scenario
from crawler2d.runs.dataset import UNITS
from tests.shared import ROBOT


def test_the_arrays_share_their_samples(run: c2d.Run) -> None:
    n = run.time.size
    assert n > 100
    for name in UNITS:
        assert getattr(run, name).shape[0] == n
        assert getattr(run, name).dtype == np.float64
        assert np.isfinite(getattr(run, name)).all()
    assert run.position.shape == run.velocity.shape == (n, 2)
    assert run.drive_speeds.shape == run.drive_positions.shape == run.drive_forces.shape == (n, 1)
    assert run.drive_positions[:, 0].tolist() == run.track_position.tolist()


def test_samples_lie_the_interval_apart_and_end_with_the_run(scenario: Scenario) -> None:
    run = c2d.simulate(scenario, sample_interval=0.025)
    steps = np.diff(run.time)
    assert run.time[0] == 0.0
    assert steps[:-1] == pytest.approx(0.025)
    assert 0.0 < steps[-1] <= 0.025 + 1e-9
    assert run.time[-1] == pytest.approx(run.metrics["time"])


def test_the_metrics_agree_with_the_arrays(run: c2d.Run) -> None:
    assert run.outcome is c2d.Outcome.CLEARED
    assert run.metrics["time"] == run.time[-1]
    assert run.metrics["final_x"] == run.position[-1, 0]
    assert run.metrics["final_y"] == run.position[-1, 1]
    assert run.metrics["final_angle"] == run.chassis_angle[-1]
    assert run.metrics["time_to_clear"] < run.metrics["time"]
    assert run.wall_time > 0.0


def test_wheels_of_their_own_servos_have_a_column_each() -> None:
    robot = ROBOT.with_track(c2d.LineOfWheels(4))
    scenario = Scenario(robot, c2d.terrains.flat(), duration=0.5)
    run = c2d.simulate(scenario.replace({"robot.drivetrain.torque_sharing": "wheel"}))
    assert run.drive_forces.shape[1] == run.drive_speeds.shape[1] == 4
    assert run.drive_forces.sum(axis=1) == pytest.approx(run.drive_force)


def test_free_wheels_have_a_column_each_after_the_motor() -> None:
    robot = ROBOT.with_track(c2d.ForceTrack(support="wheels", wheel_count=3))
    run = c2d.simulate(robot, c2d.terrains.flat(), duration=2.0)
    assert run.drive_positions.shape == (run.time.size, 4)
    rolled = run.drive_positions[-1] - run.drive_positions[0]
    assert rolled == pytest.approx(run.metrics["distance"], rel=1e-3)
    assert np.all(run.drive_forces[:, 1:] == 0.0)
    assert run.drive_forces[:, 0].tolist() == run.drive_force.tolist()


def test_a_drive_starts_at_the_phase_of_the_track() -> None:
    scenario = Scenario(ROBOT, c2d.terrains.flat(), duration=0.5)
    run = c2d.simulate(scenario.replace({"start.track_phase": 0.03}))
    assert run.drive_positions[0].tolist() == [0.03]
    travelled = run.drive_positions[-1, 0] - 0.03
    assert run.metrics["track_distance"] == pytest.approx(travelled)


@pytest.mark.parametrize("interval", [0.0007, 0.007, 0.02])
def test_samples_fall_on_multiples_of_their_interval_whatever_the_steps(interval: float) -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=2.2345, sample_interval=interval)
    *times, end = run.time.tolist()
    assert times == [index * interval for index in range(len(times))]
    assert end == run.metrics["time"] == 2.2345
    # Forces are means weighted by time: those of the ground equal the change of momentum.
    gained = ROBOT.mass * np.diff(run.velocity[:, 0])
    assert run.tractive_effort[1:] * np.diff(run.time) == pytest.approx(gained, abs=1e-6)


def test_steps_are_counted_and_longer_where_less_happens() -> None:
    flat, step = c2d.terrains.flat(), c2d.terrains.step(0.05)
    scenarios = [
        Scenario(ROBOT, flat, duration=2.5, solver=c2d.Solver(time_step=1e-3)),
        Scenario(ROBOT, flat, duration=2.5),
        Scenario(ROBOT, step, duration=2.5),
        Scenario(ROBOT, step, duration=2.5, solver=c2d.Solver(accuracy=1e-7)),
    ]
    given, easy, hard, fine = (run.metrics for run in c2d.simulate_many(scenarios))
    assert (given["steps"], given["repeated_steps"]) == (2500, 0)
    assert 2.5 / 0.016 < easy["steps"] < hard["steps"] < fine["steps"]
    assert 0 < hard["repeated_steps"] < 0.15 * hard["steps"]
    assert given["solves"] >= 2500


def test_on_level_ground_a_belt_goes_as_far_as_its_path_and_does_not_shake() -> None:
    metrics = c2d.simulate(ROBOT, c2d.terrains.flat(), duration=2.0).metrics
    assert metrics["path_length"] == pytest.approx(metrics["distance"], rel=1e-6)
    assert metrics["track_distance"] == pytest.approx(metrics["path_length"], rel=1e-3)
    assert metrics["vertical_acceleration"] < 0.01
    assert metrics["angular_velocity"] < 0.01


@pytest.mark.filterwarnings("ignore:goal cannot be reached:crawler2d.ScenarioWarning")
def test_up_a_ramp_the_path_is_longer_than_the_way_along_x() -> None:
    angle = 0.3
    scenario = Scenario(ROBOT, c2d.terrains.ramp(angle, length=5.0), duration=6.0, goal=4.0)
    run = c2d.simulate(scenario)
    on_slope = run.position[:, 0] > 0.3
    x, y = np.ptp(run.position[on_slope], axis=0)
    assert y / x == pytest.approx(math.tan(angle), rel=1e-3)
    assert run.metrics["path_length"] > run.metrics["distance"] + 0.03
    assert run.metrics["track_distance"] > run.metrics["path_length"]


def test_the_angular_velocity_is_a_root_mean_square(run: c2d.Run) -> None:
    mean = math.sqrt(np.mean(run.angular_velocity**2))
    assert run.metrics["angular_velocity"] == pytest.approx(mean, rel=0.02)
    acceleration = np.diff(run.velocity[:, 1]) / np.diff(run.time)
    mean = math.sqrt(np.mean(acceleration**2))
    assert run.metrics["vertical_acceleration"] == pytest.approx(mean, rel=0.1)


@pytest.mark.parametrize("name", UNITS)
def test_an_array_cannot_be_written_to(run: c2d.Run, name: str) -> None:
    with pytest.raises(ValueError, match="read-only"):
        getattr(run, name)[0] = 0.0


def arrays_given_out() -> dict[str, np.ndarray[Any, Any]]:
    """All arrays of a run that ends in a stop, and of a simulation's state."""
    robot = c2d.robots.engineer(track=c2d.LineOfWheels(4)).without_rotors()
    run = c2d.simulate(robot, c2d.terrains.step(0.10), start=c2d.Start(approach=0.02))
    sim = c2d.Simulation(run.scenario)
    state, inside = sim.state(), sim.intrusions()
    assert run.diagnosis is not None
    of_run = {name: getattr(run, name) for name in UNITS}
    of_state = {name: getattr(state, name) for name in ("position", "velocity", "flipper_angles")}
    tables = {
        "contacts": run.contacts,
        "edges": run.edges,
        "events": run.events,
        "diagnosis": run.diagnosis.contacts,
        "state": state.contacts,
        "intrusions": inside,
        "wheels": robot.wheels(),
        "pickled": pickle.loads(pickle.dumps(run)).contacts,
    }
    columns = {
        f"{t}.{name}": column for t, table in tables.items() for name, column in table.items()
    }
    return of_run | of_state | columns


def test_a_returned_array_cannot_be_made_writable() -> None:
    for name, array in arrays_given_out().items():
        assert not array.flags.writeable, name
        with pytest.raises(ValueError, match="WRITEABLE"):
            array.flags.writeable = True


def test_a_table_leaves_the_array_it_was_made_from_alone() -> None:
    mine = np.zeros(3)
    rows = np.zeros((3, 2))
    table = Table({"own": mine, "view": rows[:, 0]})
    mine[0] = rows[0, 0] = 1.0
    assert table["own"].tolist() == table["view"].tolist() == [0.0, 0.0, 0.0]


CHANGES: list[Any] = [
    lambda metrics: metrics.__setitem__("time", 0.0),
    lambda metrics: metrics.__delitem__("time"),
    lambda metrics: metrics.update(time=0.0),
    lambda metrics: metrics.setdefault("mine", 0.0),
    lambda metrics: metrics.pop("time"),
    lambda metrics: metrics.popitem(),
    lambda metrics: metrics.clear(),
    lambda metrics: metrics.__ior__({"time": 0.0}),
]


@pytest.mark.parametrize("change", CHANGES)
def test_the_figures_of_a_run_cannot_be_changed(run: c2d.Run, change: Any) -> None:
    before = dict(run.metrics)
    with pytest.raises(TypeError, match="read-only"):
        change(run.metrics)
    assert run.metrics == before


def test_the_figures_of_a_run_behave_like_a_dict(run: c2d.Run) -> None:
    plain = dict(run.metrics)
    for twin in (pickle.loads(pickle.dumps(run.metrics)), copy.deepcopy(run.metrics)):
        assert twin == plain
        assert type(twin) is type(run.metrics)
    assert json.loads(json.dumps(run.metrics)) == plain
    plain["time"] = -1.0
    assert run.metrics != plain
    assert run.metrics | {"time": -1.0} == plain


def test_a_summary_has_the_same_figures_and_refuses_arrays_clearly(run: c2d.Run) -> None:
    summary = c2d.simulate(run.scenario, record="summary")
    assert (summary.outcome, summary.metrics) == (run.outcome, run.metrics)
    assert len(summary.edges) == len(run.edges)
    for name in [*UNITS, "contacts"]:
        with pytest.raises(AttributeError, match="record='summary'"):
            getattr(summary, name)
    for way_out in (summary.plot, summary.to_xarray):
        with pytest.raises(AttributeError, match="record='summary'"):
            way_out()


def test_a_run_survives_pickling(run: c2d.Run) -> None:
    for twin in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
        assert repr(twin) == repr(run)
        assert twin.scenario == run.scenario
        assert twin.metrics == run.metrics
        for name in UNITS:
            assert np.array_equal(getattr(twin, name), getattr(run, name))
        for name, column in run.contacts.items():
            assert np.array_equal(twin.contacts[name], column)
        with pytest.raises(ValueError, match="read-only"):
            twin.time[0] = 1.0


def test_results_that_are_values_equal_their_copies_and_no_others() -> None:
    robot = ROBOT.with_track(c2d.LineOfWheels(4))
    scenario = Scenario(robot, c2d.terrains.step(0.1))
    run = c2d.simulate(scenario)
    sim, batch = c2d.Simulation(scenario), c2d.Simulations([scenario])
    over = {"terrain.height": (0.05, 0.06)}
    certificate = c2d.studies.certify(scenario, over, most_cells=10, keep_cells=True)
    before = (run.diagnosis, run.events, run.bodies, sim.state(), batch.state(), certificate)
    for value in before:
        for twin in (copy.copy(value), copy.deepcopy(value), pickle.loads(pickle.dumps(value))):
            assert (twin, hash(twin)) == (value, hash(value))
    run.what_if("torque x 10")
    sim.advance(0.1)
    batch.advance(0.1)
    other = c2d.studies.certify(scenario, over, most_cells=10, depth=2e-3)
    after = (run.diagnosis, run.contacts, run.edges, sim.state(), batch.state(), other)
    for one, another in zip(before, after, strict=True):
        assert one != another


def test_equal_values_share_a_hash_and_others_hardly_ever() -> None:
    ones = [Table({"x": np.array([-0.0, np.nan, 1.0]), "kind": [(1, 2), (), (3,)]})]
    ones.append(Table({"x": np.array([0.0, np.nan, 1.0], dtype="f4"), "kind": [(1, 2), (), (3,)]}))
    assert ones[0] == ones[1]
    assert len(set(ones)) == 1
    sim, states = c2d.Simulation(Scenario(ROBOT, c2d.terrains.flat())), []
    for _ in range(20):
        states.append(sim.state())
        sim.advance(0.01)
    assert len(set(map(hash, states))) == len(set(map(hash, [s.contacts for s in states]))) == 20


def test_the_repr_is_one_short_line(run: c2d.Run) -> None:
    assert (
        repr(run)
        == f"Run(engineer, line, step: cleared after {run.metrics['time_to_clear']:.2f} s)"
    )


def test_contacts_carry_the_weight_on_flat_ground() -> None:
    run = c2d.simulate(ROBOT, c2d.terrains.flat(), drive=c2d.Drive(speed=0.0), duration=1.0)
    last = run.contacts["time"] == run.time[-1]
    weight = ROBOT.mass * run.scenario.gravity
    assert run.contacts["normal_force"][last].sum() == pytest.approx(weight, rel=1e-3)
    assert run.contacts["normal_y"][last] == pytest.approx(1.0)
    assert set(run.contacts["body_kind"]) == {1}  # belt


def test_a_wheel_is_one_contact_from_facet_to_facet() -> None:
    xs = np.linspace(-3.0, 3.0, 601)
    # Not quite flat: facets on one line would be merged.
    ground = c2d.terrains.from_points(np.column_stack([xs, 1e-3 * xs**2]), goal=1.0)
    robot = ROBOT.with_track(c2d.LineOfWheels(3))
    contacts = c2d.simulate(robot, ground, start=c2d.Start(approach=0.6), duration=1.5).contacts
    assert contacts["contact"].dtype == np.int64
    for wheel in (0, 2):  # the ground is hollow under the middle one
        rows = contacts["body"] == wheel
        assert len(set(contacts["segment"][rows])) > 20
        assert len(set(contacts["contact"][rows])) == 1
    assert len(set(contacts["contact"])) == 2


def test_a_diagnosis_names_contacts_by_the_numbers_of_the_table() -> None:
    robot = ROBOT.with_track(c2d.LineOfWheels(4, wheel=c2d.GearWheel()))
    run = c2d.simulate(robot, c2d.terrains.step(0.2), duration=6.0)
    assert run.diagnosis is not None
    bearing, table = run.diagnosis.contacts, run.contacts
    bodies = dict(zip(table["contact"].tolist(), table["body"].tolist(), strict=True))
    assert len(set(bearing["contact"])) == len(bearing["contact"]) > 1
    for contact, body in zip(bearing["contact"].tolist(), bearing["body"].tolist(), strict=True):
        assert bodies[contact] == body


def test_the_contact_table_has_the_documented_columns(run: c2d.Run) -> None:
    assert list(run.contacts) == [
        "time",
        "contact",
        "lane",
        "body",
        "body_kind",
        "segment",
        "edge",
        "x",
        "y",
        "normal_x",
        "normal_y",
        "normal_force",
        "friction_force",
        "surface_speed",
        "penetration",
    ]
    assert list(run.edges) == ["id", "lane", "x", "y", "angle", "radius"]
    assert list(run.events) == [
        "kind",
        "start",
        "end",
        "lane",
        "edge",
        "bodies",
        "depth",
        "root_depth",
        "force",
    ]


def test_the_edges_are_those_of_the_step(run: c2d.Run) -> None:
    assert run.edges["x"].tolist() == [0.0, 0.0]
    assert run.edges["y"].tolist() == [0.0, 0.05]
    assert run.edges["angle"] == pytest.approx([-np.pi / 2, np.pi / 2])
    touched = run.contacts["edge"][run.contacts["edge"] >= 0]
    assert set(touched) <= set(run.edges["id"])
    assert touched.size > 0


def test_a_stop_is_an_event_that_lasts_to_the_end() -> None:
    run = c2d.simulate(ROBOT.with_track(c2d.ForceTrack()), c2d.terrains.step(0.1))
    assert run.outcome is c2d.Outcome.STALLED
    assert run.events["kind"].tolist() == ["stop"]
    assert run.events["end"][0] == pytest.approx(run.time[-1])
    length = run.events["end"][0] - run.events["start"][0]
    assert run.metrics["stopped_time"] == pytest.approx(length)


def test_a_table_has_columns_rows_and_a_short_repr(run: c2d.Run) -> None:
    table = run.contacts
    assert len(table) == table["time"].size
    assert bool(table)
    assert not Table({"x": []})
    assert repr(run.edges) == "Table(2 rows: id, lane, x, y, angle, radius)"
    assert "height" not in table
    with pytest.raises(ValueError, match="read-only"):
        table["x"][0] = 0.0


def test_a_misspelt_column_or_metric_is_answered_with_the_nearest(run: c2d.Run) -> None:
    with pytest.raises(KeyError, match=r"tiem \(did you mean time\?\)"):
        run.contacts["tiem"]
    with pytest.raises(KeyError, match=r"time_to_claer \(did you mean time_to_clear\?\)"):
        run.metrics["time_to_claer"]
    assert run.contacts.get("tiem") is None
    assert run.metrics.get("time_to_claer") is None
    with pytest.raises(KeyError, match=r"^0$"):
        run.contacts[0]  # type: ignore[index]


def test_a_table_shows_its_first_rows_in_a_notebook() -> None:
    shown = Table({"<x>": list(range(25)), "bodies": [(1, 2)] * 25})._repr_html_()
    assert shown.count("<tr>") == 1 + 10
    assert "&lt;x&gt;" in shown
    assert "(1, 2)" in shown
    assert "25 rows, first 10 shown" in shown
    assert "shown" not in Table({"x": [1.5]})._repr_html_()


def test_a_table_becomes_a_data_frame(run: c2d.Run) -> None:
    frame = run.contacts.to_pandas()
    assert list(frame.columns) == list(run.contacts)
    assert frame["normal_force"].to_numpy() == pytest.approx(run.contacts["normal_force"])
    frame.loc[0, "x"] = 7.0
    assert run.contacts["x"][0] != 7.0
    assert len(run.events.to_pandas()) == len(run.events)


def test_the_data_set_has_units_and_provenance(run: c2d.Run) -> None:
    dataset = run.to_xarray()
    assert dataset.sizes == {"time": run.time.size, "axis": 2, "drive": 1}
    assert dataset["position"].sel(axis="x").values == pytest.approx(run.position[:, 0])
    assert {name: dataset[name].attrs["units"] for name in dataset} == {
        name: unit
        for name, unit in UNITS.items()
        if name != "time" and not name.startswith(("shoe", "flipper"))
    }
    assert dataset.attrs["outcome"] == "cleared"
    assert Scenario.from_json(dataset.attrs["scenario"]) == run.scenario
    assert dataset.attrs["identity"] == run.scenario.identity
    assert dataset.attrs["build_version"] == c2d.__version__


def test_the_data_set_of_a_chain_has_its_shoes() -> None:
    robot = c2d.robots.engineer(flippers=None, track=c2d.SegmentalTrack())
    run = c2d.simulate(c2d.Scenario(robot, c2d.terrains.flat(), duration=0.5))
    dataset = run.to_xarray()
    assert dataset.sizes == {"time": run.time.size, "axis": 2, "drive": 1, "shoe": 22, "pose": 3}
    assert dataset["shoe_poses"].sel(pose="x").values == pytest.approx(run.shoe_poses[:, :, 0])
    assert dataset["track_tension"].values == pytest.approx(run.track_tension)


def test_a_missing_package_names_its_extra(run: c2d.Run, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("xarray", "pandas", "matplotlib.pyplot"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=r"pip install 'crawler2d\[analysis\]'"):
        run.to_xarray()
    with pytest.raises(ImportError, match=r"pip install 'crawler2d\[analysis\]'"):
        run.contacts.to_pandas()
    with pytest.raises(ImportError, match=r"pip install 'crawler2d\[plot\]'"):
        run.plot()
