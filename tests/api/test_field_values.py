"""Every field of every scenario: an error names its exact path."""

import copy
import json
from collections.abc import Iterator
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.shared import VARIANTS

# Where -1 is a legal number.
SIGNED = (
    "robot.center_of_mass",
    "robot.belly",
    "terrain.angle",
    "terrain.yaw",
    "terrain.barrier_yaw",
    "terrain.points",
    "drive.speed",
    *(f"drive.schedule[{row}][1]" for row in range(2)),
    "drive.gait.angle",
    "drive.gait.schedule[0][1]",
    "drive.gait.reach_angle",
    "drive.gait.sweep_angle",
    "drive.gait.push_angle",
    "robot.flippers.angle",
    "start.track_phase",
    "start.angle",
    "goal",
    "terrain.goal",
    *(f"robot.track.placements[{wheel}][{axis}]" for wheel in range(3) for axis in range(2)),
    *(f"robot.outline.discs[{disc}][{axis}]" for disc in range(4) for axis in range(2)),
)


def walk(node: Any, keys: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Yield the keys that lead to every value, objects and lists included."""
    if keys:
        yield keys
    if isinstance(node, dict):
        for key, value in node.items():
            yield from walk(value, (*keys, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from walk(value, (*keys, index))


def dotted(keys: tuple[str | int, ...]) -> str:
    """Write keys as a path, such as ``terrain.points[0][1]``."""
    return "".join(f"[{k}]" if isinstance(k, int) else f".{k}" for k in keys).removeprefix(".")


def at(plain: Any, keys: tuple[str | int, ...]) -> Any:
    for key in keys:
        plain = plain[key]
    return plain


PLAIN = {name: json.loads(scenario.to_json()) for name, scenario in VARIANTS.items()}
PLACES = [(name, keys) for name, plain in PLAIN.items() for keys in walk(plain)]
NUMBERS = [(name, keys) for name, keys in PLACES if type(at(PLAIN[name], keys)) in (int, float)]
OBJECTS = [
    (name, keys)
    for name, plain in PLAIN.items()
    for keys in [(), *walk(plain)]
    if isinstance(at(plain, keys), dict)
]


def refusal(plain: Any) -> c2d.ScenarioError:
    with pytest.raises(c2d.ScenarioError) as caught:
        Scenario.from_json(json.dumps(plain))
    return caught.value


def changed(name: str, keys: tuple[str | int, ...], value: Any) -> Any:
    plain = copy.deepcopy(PLAIN[name])
    at(plain, keys[:-1])[keys[-1]] = value
    return plain


def test_scenarios_have_fields_to_test() -> None:
    assert len(PLACES) > 500
    assert len(NUMBERS) > 350


@pytest.mark.parametrize("value", ["NaN", "Infinity", "-Infinity", "12", True, [], {}])
def test_a_non_number_is_refused_in_every_number_field(value: Any) -> None:
    for name, keys in NUMBERS:
        error = refusal(changed(name, keys, value))
        assert error.path == dotted(keys), error
        assert error.rule.startswith("must"), error


def test_a_negative_number_is_refused_wherever_it_has_no_meaning() -> None:
    for name, keys in NUMBERS:
        path = dotted(keys)
        if path.startswith(SIGNED):
            continue
        assert refusal(changed(name, keys, -1)).path == path


@pytest.mark.parametrize("value", [1e308, -1e308, 1e-320, 2**80])
def test_an_absurd_number_is_refused_at_every_number(value: float) -> None:
    for name, keys in NUMBERS:
        assert refusal(changed(name, keys, value)).path == dotted(keys)


def test_a_wrong_type_is_refused_at_every_place() -> None:
    for name, keys in PLACES:
        value = at(PLAIN[name], keys)
        wrong: Any = 5 if isinstance(value, (str, dict, list)) else ["x"]
        if value is None:
            wrong = "x"
        error = refusal(changed(name, keys, wrong))
        assert error.path == dotted(keys), error


def test_an_unknown_key_is_refused_in_every_object() -> None:
    for name, keys in OBJECTS:
        error = refusal(changed(name, (*keys, "unknown_key"), 1))
        assert error.path == dotted((*keys, "unknown_key")), error


def test_an_unknown_key_is_answered_with_every_field_once() -> None:
    for name, keys in OBJECTS:
        rule = refusal(changed(name, (*keys, "unknown_key"), 1)).rule
        fields = rule.removeprefix("must be a known field: ").partition(" (")[0].split(", ")
        assert sorted(fields) == sorted(at(PLAIN[name], keys)), rule


OMITTED = c2d.Drivetrain.omitted_defaults + c2d.SegmentalTrack.omitted_defaults


def test_a_missing_key_is_refused_in_every_object() -> None:
    for name, keys in OBJECTS:
        for key in at(PLAIN[name], keys):
            if key in OMITTED:  # JSON leaves it out at its default
                continue
            plain = copy.deepcopy(PLAIN[name])
            del at(plain, keys)[key]
            assert refusal(plain).path == dotted((*keys, key))


def test_a_misspelt_choice_lists_the_names_and_the_nearest() -> None:
    for name, path, value, nearest in [
        ("belt-step", "robot.track.kind", "Belt", "belt"),
        ("belt-step", "terrain.kind", "stp", "step"),
        ("belt-step", "robot.drivetrain.torque_sharing", "wheels", "wheel"),
        ("circumferential-ridge", "robot.track.kind", "circumferental", "circumferential"),
        ("hybrid-gap", "robot.track.kind", "Hybrid", "hybrid"),
        ("line-barrier", "robot.track.wheel.kind", "gears", "gear"),
        ("line-flat", "robot.track.wheel.kind", "Round", "round"),
        ("force-stairs", "robot.track.support", "wheel", "wheels"),
        ("line-barrier", "terrain.kind", "barier", "barrier"),
        ("circumferential-half-round", "terrain.kind", "half-round", "half_round"),
        ("force-stairs", "terrain.kind", "STAIRS", "stairs"),
        ("grousers-gap", "robot.track.kind", "grouser-belt", "grouser_belt"),
        ("segmental-step", "robot.track.kind", "Segmental", "segmental"),
        ("segmental-step", "robot.track.shoe_shape", "trapezium", "trapezoid"),
        ("sprocket-step", "robot.track.mechanism", "Sprocket", "sprocket"),
        ("flippers-climb", "robot.flippers.ends", "Front", "front"),
        ("flippers-climb", "drive.gait.kind", "clim", "climb"),
        ("flippers-hold", "drive.gait.kind", "Hold", "hold"),
        ("flippers-hold", "robot.flippers.track.kind", "lin", "line"),
        ("belt-lanes", "terrain.left.kind", "Step", "step"),
    ]:
        error = refusal(changed(name, tuple(path.split(".")), value))
        assert error.path == path
        assert f"did you mean {nearest}?" in error.rule


def test_a_misspelt_key_names_the_nearest() -> None:
    for name, path, nearest in [
        ("belt-step", "robot.mas", "mass"),
        ("line-barrier", "robot.track.wheel.grouser_hight", "grouser_height"),
        ("circumferential-ridge", "robot.track.Count", "count"),
        ("circumferential-ridge", "terrain.edge_angel", "edge_angle"),
        ("hybrid-gap", "robot.track.placement", "placements"),
        ("force-stairs", "terrain.riser", "rise"),
        ("sprocket-step", "robot.track.roadwheel_count", "road_wheel_count"),
        ("grousers-gap", "robot.track.grousers_count", "grouser_count"),
        ("flippers-climb", "robot.flippers.tipradius", "tip_radius"),
        ("flippers-climb", "drive.shedule", "schedule"),
        ("flippers-climb", "drive.gait.sweep_angel", "sweep_angle"),
        ("belt-lanes", "terrain.midle", "middle"),
    ]:
        error = refusal(changed(name, tuple(path.split(".")), 1))
        assert error.path == path
        assert f"did you mean {nearest}?" in error.rule


@pytest.mark.parametrize(
    ("name", "path", "value", "rule"),
    [
        ("line-barrier", "robot.track.count", 1, "must be an integer from 2 to 200"),
        ("line-barrier", "robot.track.wheel_radius", 1e-9, "must be >= 0.0001 m and <= 100 m"),
        ("line-barrier", "robot.track.wheel.grouser_count", 2, "must be an integer from 3 to 200"),
        ("line-barrier", "robot.track.wheel.grouser_height", 0, "must be > 0 m and <= 100 m"),
        ("line-barrier", "robot.track.wheel.tip_thickness", 0, "must be > 0 m and <= 100 m"),
        ("line-barrier", "robot.track.wheel.base_thickness", 0, "must be > 0 m and <= 100 m"),
        ("line-barrier", "robot.track.wheel.phase_fraction", 1.01, "must be >= 0 and <= 1"),
        ("circumferential-ridge", "robot.track.count", 2, "must be an integer from 3 to 200"),
        ("hybrid-gap", "robot.track.placements[2][0]", 101, "must be >= -100 m and <= 100 m"),
        ("hybrid-gap", "robot.track.placements[0][2]", 0, "must be >= 0.0001 m and <= 100 m"),
        ("force-stairs", "robot.track.wheel_count", 1, "must be an integer from 2 to 200"),
        ("line-barrier", "terrain.thickness", 0, "must be >= 0.0001 m and <= 10000 m"),
        ("circumferential-ridge", "terrain.height", 0, "must be > 0 m and <= 100 m"),
        (
            "circumferential-ridge",
            "terrain.edge_angle",
            3.14,
            "must be >= 0.01 rad and <= 3.13 rad",
        ),
        ("hybrid-gap", "terrain.width", 0, "must be >= 0.0001 m and <= 10000 m"),
        ("hybrid-gap", "terrain.depth", 0, "must be > 0 m and <= 100 m"),
        ("force-stairs", "terrain.count", 0, "must be an integer from 1 to 1000"),
        ("force-stairs", "terrain.rise", 0, "must be > 0 m and <= 100 m"),
        ("force-stairs", "terrain.run", 0, "must be >= 0.0001 m and <= 10000 m"),
        ("circumferential-half-round", "terrain.radius", 0, "must be >= 0.0001 m and <= 100 m"),
        ("belt-step", "criteria.intrusion_depth", -1e-9, "must be >= 0 m and <= 0.1 m"),
        ("belt-step", "criteria.intrusion_depth", 0.11, "must be >= 0 m and <= 0.1 m"),
    ],
)
def test_a_rule_says_what_is_allowed(name: str, path: str, value: float, rule: str) -> None:
    keys = next(keys for keys in walk(PLAIN[name]) if dotted(keys) == path)
    error = refusal(changed(name, keys, value))
    assert (error.path, error.rule) == (path, rule)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("robot.track_mass", 21.2),
        ("robot.track_mass", 30.0),
        ("robot.moment_of_inertia", 1e-3),
        ("robot.outline.grouser_height", 0.064),
        ("robot.outline.grouser_thickness", 0.048),
        ("robot.outline.front_radius", 0.5),
        ("robot.drivetrain.torque_sharing", "wheel"),
        ("drive.speed", 1.5),
        ("solver.time_step", 0.0),
        ("solver.time_step", 0.1),
        ("solver.time_step", 1e-3),  # an accuracy is given, too
        ("solver.accuracy", None),
        ("solver.accuracy", 0.0),
        ("solver.accuracy", 0.1),
        ("solver.iterations", 0),
        ("solver.iterations", 1001),
        ("schema", 1),
        ("schema", 3),
    ],
)
def test_a_rule_between_fields_names_the_field_to_change(path: str, value: Any) -> None:
    error = refusal(changed("belt-step", tuple(path.split(".")), value))
    assert error.path == path


@pytest.mark.parametrize("version", [3, 30, "1" * 5000, "3.0", '"3"', -1])
def test_the_error_for_a_newer_file_says_that_it_is_newer(version: Any) -> None:
    newer = changed("belt-step", ("robot", "new"), 1) | {"schema": "?"}
    with pytest.raises(c2d.ScenarioError) as caught:
        Scenario.from_json(json.dumps(newer).replace('"?"', str(version)))
    assert caught.value.path == "schema"
    said = caught.value.rule == "must be 2; a newer version of crawler2d wrote the file"
    assert said is (version in (3, 30))


def test_the_error_for_a_version_1_file_says_what_has_changed() -> None:
    old = changed("belt-step", ("schema",), 1)
    del old["solver"]["accuracy"]
    old["solver"] |= {"time_step": 1e-3, "substeps": 2}
    error = refusal(old)
    assert error.path == "schema"
    assert "solver.accuracy takes the place of solver.substeps" in error.rule
    # Following its advice gives a current file.
    del old["solver"]["substeps"]
    old["schema"] = 2
    old["solver"]["accuracy"] = None
    assert Scenario.from_json(json.dumps(old)).solver.time_step == 1e-3
