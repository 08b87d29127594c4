"""The axes of a sweep: order, labels, names of dimensions."""

import json
from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.units import METRICS
from crawler2d.parameters.scenario import Scenario
from crawler2d.sweeps.axes import COLUMNS, _dimensions, short_names, stop_columns
from crawler2d.sweeps.rates import rate
from crawler2d.sweeps.sweep import sweep
from tests.kept import refusing
from tests.shared import ROBOT, VARIANTS
from tests.sweeps.small import SAID, quiet, refusal

BASE = Scenario(ROBOT, c2d.terrains.step(0.03), duration=0.05)


def test_axes_are_replaced_in_the_order_given() -> None:
    over = {"robot.track": {"line": c2d.LineOfWheels(9)}, "robot.track.count": [3, 5]}
    found = quiet(BASE, over)
    texts = found["scenario"].sel(track="line").isel(repeat=0).values
    assert [json.loads(text)["robot"]["track"]["count"] for text in texts] == [3, 5]


def test_objects_without_labels_are_labelled_in_short() -> None:
    tracks = [c2d.BeltTrack(), c2d.LineOfWheels(3), c2d.LineOfWheels(4, wheel_radius=0.06)]
    centers = [(0.0, 0.02), np.array([0.01, 0.02])]
    found = quiet(BASE, {"robot.track": tracks, "robot.center_of_mass": centers})
    assert found["track"].values.tolist() == [
        "BeltTrack()",
        "LineOfWheels(3)",
        "LineOfWheels(4, wheel_radius=0.06)",
    ]
    assert found["center_of_mass"].values.tolist() == ["(0.0, 0.02)", "(0.01, 0.02)"]
    # Consequences of a default are left out, too.
    solvers = [c2d.Solver(), c2d.Solver(time_step=1e-3), c2d.Solver(accuracy=1e-5)]
    labels = quiet(BASE, {"solver": solvers})["solver"].values.tolist()
    assert labels == ["Solver()", "Solver(time_step=0.001)", "Solver(accuracy=1e-05)"]


def test_the_accuracy_or_the_time_step_is_swept_on_any_scenario() -> None:
    of_steps = BASE.replace({"solver.time_step": 1e-3})
    for base in (BASE, of_steps):
        steps = quiet(base, {"solver.time_step": [1e-3, 5e-4]}, vary={}, repeats=1)
        assert steps["steps"].values.tolist() == [[50.0], [100.0]]
        assert steps["time_step"].attrs["units"] == "s"
        fine = quiet(base, {"solver.accuracy": [c2d.Solver().accuracy]}, vary={}, repeats=1)
        assert Scenario.from_json(fine["scenario"].values.item()).solver == c2d.Solver()
        assert fine["accuracy"].attrs["units"] == "m"
    error = refusal(BASE, {"solver.accuracy": [1e-6], "solver.time_step": [1e-3]})
    assert error.path.endswith(".solver.time_step")


def test_labels_that_are_no_numbers_are_texts() -> None:
    line = BASE.replace({"robot.track": c2d.LineOfWheels(3)})
    found = quiet(line, {"robot.track.wheel_radius": [None, 0.06]})
    assert found["wheel_radius"].values.tolist() == ["None", "0.06"]
    assert "units" not in found["wheel_radius"].attrs
    counts = {3: c2d.LineOfWheels(3), np.int64(5): c2d.LineOfWheels(5)}
    assert quiet(BASE, {"robot.track": counts})["track"].values.tolist() == [3, 5]
    named = quiet(BASE, {"terrain.height": {1: 0.02, 2: 0.03}})["height"]
    assert named.values.tolist() == [1, 2]
    assert "units" not in named.attrs


@pytest.mark.parametrize(
    "heights",
    [np.array([0.02, 0.03]), (0.02, 0.03), np.linspace(0.02, 0.03, 2), iter([0.02, 0.03])],
    ids=lambda values: type(values).__name__,
)
def test_any_sequence_of_numbers_is_an_axis(heights: Iterable[float]) -> None:
    found = quiet(BASE, {"terrain.height": heights})
    assert found["height"].values.tolist() == [0.02, 0.03]
    assert json.loads(found["scenario"].values[0, 0])["terrain"]["height"] == 0.02


def test_paths_swept_together_share_a_dimension_and_have_coordinates_of_their_own() -> None:
    over = {("terrain.height", "robot.track"): [(0.02, c2d.BeltTrack()), (0.03, c2d.ForceTrack())]}
    found = quiet(BASE, over)
    assert found["outcome"].dims == ("height_track", "repeat")
    assert found["height_track"].values.tolist() == ["(0.02, BeltTrack())", "(0.03, ForceTrack())"]
    assert found["height_track"].attrs["path"] == "terrain.height, robot.track"
    assert found["height"].dims == ("height_track",)
    assert found["height"].attrs["units"] == "m"
    kinds = [json.loads(text)["robot"]["track"]["kind"] for text in found["scenario"].values[:, 0]]
    assert kinds == ["belt", "force"]


def test_the_lanes_of_a_terrain_are_swept_together() -> None:
    lanes = VARIANTS["belt-lanes"].replace({"duration": 0.05})
    sides = ("terrain.left.height", "terrain.right.height", "terrain.middle.height")
    found = quiet(lanes, {sides: np.repeat([[0.02], [0.03]], 3, axis=1)})
    assert found["outcome"].sizes == {"height": 2, "repeat": 2}
    assert found["terrain_left_height"].values.tolist() == [0.02, 0.03]
    drawn = [json.loads(text)["terrain"] for text in found["scenario"].values[:, 0]]
    assert found["drawn_friction"].values[:, 0].tolist() == [t["left"]["friction"] for t in drawn]


def test_paths_that_end_alike_are_named_in_full() -> None:
    found = quiet(BASE, {"start.angle": [0.0], "terrain": {"r": c2d.terrains.ramp(0.1)}})
    assert found["outcome"].dims == ("angle", "terrain", "repeat")
    ramp = BASE.replace({"terrain": c2d.terrains.ramp(0.1)})
    found = quiet(ramp, {"start.angle": [0.0], "terrain.angle": [0.1, 0.2]})
    assert found["outcome"].dims == ("start_angle", "terrain_angle", "repeat")
    depth = quiet(BASE, {"criteria.intrusion_depth": [1e-4, 2e-4]})  # also a metric
    assert depth["outcome"].dims == ("criteria_intrusion_depth", "repeat")
    pairs = {("start.angle", "terrain.angle"): [(0.0, 0.1)], ("goal",): [(1.0,), (2.0,)]}
    assert quiet(ramp, pairs)["outcome"].dims == ("angle", "goal", "repeat")


def test_elements_are_axes_with_names_that_python_can_spell() -> None:
    driven = BASE.replace({"drive.schedule": [(1.0, 0.2), (2.0, 0.3)]})
    over = {
        "robot.center_of_mass[0]": [-0.05, 0.05],
        ("drive.schedule[0][1]", "drive.schedule[1][1]"): [(0.1, 0.2), (0.2, 0.3)],
    }
    found = quiet(driven, over)
    assert found["outcome"].dims == ("center_of_mass_0", "schedule_0_1_schedule_1_1", "repeat")
    assert all(str(name).isidentifier() for name in found.variables)
    assert found["center_of_mass_0"].attrs == {
        "path": "robot.center_of_mass[0]",
        "units": "m",
        "long_name": "center of mass[0]",
    }
    assert found["schedule_1_1"].values.tolist() == [0.2, 0.3]
    assert found["schedule_1_1"].attrs["units"] == "m/s"
    text = found["scenario"].values[1, 0, 0]
    assert json.loads(text)["robot"]["center_of_mass"] == [0.05, 0.02]
    assert json.loads(text)["drive"]["schedule"] == [[1.0, 0.1], [2.0, 0.2]]


def test_an_element_and_a_field_that_are_called_alike_are_named_in_full() -> None:
    belly = {"robot.belly[0][0]": [-0.1], "robot.belly[1][0]": [0.1]}
    assert quiet(BASE, belly)["outcome"].dims == ("belly_0_0", "belly_1_0", "repeat")
    lanes = VARIANTS["belt-lanes"].replace(
        {f"terrain.{side}": VARIANTS["belt-points"].terrain for side in ("left", "right", "middle")}
    )
    ends = {"terrain.left.points[3][1]": [0.05], "terrain.right.points[3][1]": [0.05]}
    assert quiet(lanes.replace({"duration": 0.0}), ends)["outcome"].dims == (
        "terrain_left_points_3_1",
        "terrain_right_points_3_1",
        "repeat",
    )


def test_no_axis_takes_the_name_of_a_column_of_the_table_or_of_its_rates() -> None:
    table = sweep(BASE, {}, repeats=2, trials="all", wall_time=True, vary={}, progress=False)
    assert {*METRICS, *COLUMNS} >= {*map(str, table.variables), *map(str, rate(table).variables)}
    wheels = BASE.replace({"robot.track": c2d.LineOfWheels(3)})
    found = quiet(wheels, {"robot.track.count": [3, 5]})
    assert found["outcome"].dims == ("robot_track_count", "repeat")
    assert rate(found)["count"].dims == ("robot_track_count",)
    assert rate(found)["count"].sel(robot_track_count=5).item() == 2
    field = BASE.replace({"terrain": c2d.terrains.random_stepfield(0)})
    assert quiet(field, {"terrain.seed": [3, 4]})["outcome"].dims == ("terrain_seed", "repeat")
    together = {("robot.track.count", "duration"): [(3, 0.0), (5, 0.1)]}
    paired = quiet(wheels, together)
    assert paired["outcome"].dims == ("count_duration", "repeat")
    assert paired["robot_track_count"].values.tolist() == [3, 5]
    assert rate(paired)["robot_track_count"].values.tolist() == [3, 5]


@pytest.mark.parametrize(
    ("over", "path", "hint"),
    [
        (None, "over", "mapping"),
        ([("terrain.height", [0.1])], "over", "mapping"),
        ({3: [0.1]}, "over", "dotted paths"),
        ({(): [0.1]}, "over", "dotted paths"),
        ({("terrain.height", 3): [(0.1, 0.1)]}, "over", "dotted paths"),
        ({"terrain.height": []}, "over['terrain.height']", "at least one value"),
        ({"terrain.height": {}}, "over['terrain.height']", "at least one value"),
        ({"terrain.height": 0.1}, "over['terrain.height']", "a sequence"),
        ({"terrain.height": None}, "over['terrain.height']", "a sequence"),
        ({"terrain.height": "0.1"}, "over['terrain.height']", "a sequence"),
        ({"terrain.height": {0.1, 0.2}}, "over['terrain.height']", "a sequence"),
        ({"robot.track": c2d.BeltTrack()}, "over['robot.track']", "a sequence"),
        ({"terrain.height": np.array(0.1)}, "over['terrain.height']", "one dimension"),
        ({"terrain.height": {None: 0.1}}, "over['terrain.height']", "strings or numbers"),
        ({"terrain.height": {True: 0.1}}, "over['terrain.height']", "strings or numbers"),
        ({"terrain.height": [0.1, 0.2, 0.1]}, "over['terrain.height'][2]", "labels, not 0.1 twice"),
        ({"terrain.height": {"1": 0.1, 1: 0.2}}, "over['terrain.height'][1]", "not 1 twice"),
        ({"robot.track": [c2d.BeltTrack()] * 2}, "over['robot.track'][1]", "unique"),
        ({"robot": [ROBOT]}, "over['robot'][0]", "give a mapping"),
        ({("terrain.height", "gravity"): [0.1]}, "over[('terrain.height', 'gravity')]", "2 values"),
        ({("terrain.height",): [(1, 2)]}, "over[('terrain.height',)]", "tuples of 1 values"),
        ({("gravity", "gravity"): [(9.0, 9.1)]}, "over", "each path only once"),
        ({"gravity": [9.0], ("gravity", "duration"): [(9.0, 1.0)]}, "over", "each path only once"),
        (
            {"robot.track.count": [3], "robot.track": [c2d.LineOfWheels(5)]},
            "over",
            "before robot.track.count",
        ),
        (
            {"robot.center_of_mass[0]": [0.1], "robot.center_of_mass": {"low": (0.0, 0.0)}},
            "over",
            "before robot.center_of_mass[0]",
        ),
    ],
)
def test_an_invalid_axis_is_refused_by_name(over: Any, path: str, hint: str) -> None:
    with refusing(SAID) as caught:
        quiet(BASE, over)
    assert caught.value.path == path
    assert caught.value.rule.startswith("must")
    assert hint in caught.value.rule


def test_a_table_has_these_columns_of_stops_with_these_units() -> None:
    found = stop_columns([None])
    jams = ("closed_track", "closed_track_clear_of_the_ground", "belt")
    trials = (*jams, "belt_from_the_start", "closed_track_from_the_start")
    units = {name: unit for name, (_, unit, _) in found.items() if unit}
    assert {name for name in found if name.startswith("tried_")} == {f"tried_{t}" for t in trials}
    assert {name: values for name, (_, _, values) in found.items() if name in NO_STOP} == NO_STOP
    assert units["stop_x"] == "m"
    assert units["stop_angle"] == "rad"
    table = quiet(BASE, {}, repeats=1)
    assert {name for name in found if "units" in table[name].attrs} == units.keys()


NO_STOP = {
    "symptom": [""],
    "mechanism": [""],
    "belly_side": [""],
    "stop_side": [""],
    "stop_carrier": [""],
    "stop_bodies": [""],
    "transient": [False],
    "jammed": [False],
    "stop_edge": [-1],
}


def test_an_axis_of_several_paths_whose_name_is_taken_has_that_of_its_paths() -> None:
    two = ("start.approach", "robot.mass")
    other = ("start.approach", "robot.track_mass", "robot.mass")
    assert _dimensions([two]) == ["approach_mass"]
    assert _dimensions([("terrain.height",), other[1:]]) == ["height", "track_mass_mass"]
    # With the same last parts as another axis.
    front, rear = (("robot.a.x", "robot.a.y"), ("robot.b.x", "robot.b.y"))
    assert _dimensions([front, rear]) == ["robot_a_x_robot_a_y", "robot_b_x_robot_b_y"]


@pytest.mark.parametrize("count", [60, 61])
def test_a_label_has_sixty_letters_at_most(count: int) -> None:
    name = "x" * count
    if count > 60:
        rule = r"^over\['robot.name'\]\[0\] must have a label of at most 60 letters, got "
        with refusing(SAID, rule):
            quiet(BASE, {"robot.name": [name]})
    else:
        assert quiet(BASE, {"robot.name": [name]})["name"].values.tolist() == [name]


def test_names_of_columns_are_taken_by_no_path() -> None:
    """As in the guide: columns of a sweep with all trials, of its rates, and of their band."""
    trials = (
        *("closed_track", "closed_track_clear_of_the_ground", "belt", "belt_from_the_start"),
        *("closed_track_from_the_start", "torque_x2", "friction_x2", "no_belly"),
    )
    names = [
        *("sample", "repeat", "seed", "outcome", "error", "wall_time", "identity", "scenario"),
        *("rate", "low", "high", "count", "distinct", "band_low", "band_median", "band_high"),
        *("symptom", "transient", "mechanism", "jammed", "belly_side", "stop_x", "stop_angle"),
        *("stop_edge", "stop_side", "stop_carrier", "stop_bodies"),
        *(f"{way}_{trial}" for way in ("tried", "freed_by", "then") for trial in trials),
        *METRICS,
    ]
    assert short_names([f"robot.{name}" for name in names]) == {
        f"robot.{name}": f"robot_{name}" for name in names
    }
    assert short_names(["robot.mass"]) == {"robot.mass": "mass"}
    assert {*names} <= {*COLUMNS, *METRICS}


def test_the_columns_of_a_stop_are_those_of_its_diagnosis() -> None:
    wheels = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4))
    base = c2d.Scenario(wheels, c2d.terrains.step(0.1))
    run = c2d.simulate(base, trials="all", record="summary")
    stop = run.diagnosis
    assert stop is not None
    assert stop.intrusion is not None
    found = stop_columns([stop, None], ["torque x 2"])
    values = {name: column for name, (_, _, column) in found.items()}
    assert values["symptom"] == [str(stop.symptom), ""]
    assert values["mechanism"] == [str(stop.mechanism), ""]
    assert values["transient"] == [stop.transient, False]
    assert values["jammed"] == [True, False]
    assert values["belly_side"] == [stop.belly_side, ""]
    assert values["stop_x"][0] == stop.position[0] != stop.position[1]
    assert values["stop_angle"][0] == stop.chassis_angle
    assert np.isnan([values["stop_x"][1], values["stop_angle"][1]]).all()
    assert values["stop_edge"] == [stop.intrusion.edge, -1]
    assert values["stop_side"] == [str(stop.intrusion.side), ""]
    assert values["stop_carrier"] == [str(stop.intrusion.carrier), ""]
    assert values["stop_bodies"] == ["-".join(map(str, sorted(stop.intrusion.bodies))), ""]
    ways = {each.name: each for each in stop.trials}
    for name, short in (("torque x 2", "torque_x2"), ("closed track", "closed_track")):
        assert values[f"tried_{short}"] == [True, False]
        assert values[f"freed_by_{short}"] == [ways[name].freed, False]
        assert values[f"then_{short}"] == [str(ways[name].outcome), ""]
    assert "tried_no_belly" not in values
    kinds = {name: kind for name, (kind, _, _) in found.items()}
    assert {name for name, kind in kinds.items() if kind is bool} == {
        *("transient", "jammed"),
        *(name for name in kinds if name.startswith(("tried_", "freed_by_"))),
    }
    assert {name for name, kind in kinds.items() if kind is float} == {"stop_x", "stop_angle"}
    assert kinds["stop_edge"] is int
