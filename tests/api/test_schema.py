"""The JSON Schema of scenario files accepts what the core reads, and refuses invalid values."""

import copy
import inspect
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest

import crawler2d as c2d
from crawler2d.__main__ import main
from crawler2d.common.units import unit_of
from crawler2d.parameters import settings, terrain, track
from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.schema import scenario_schema
from tests.shared import VARIANTS

FILES = sorted((Path(__file__).parents[1] / "scenarios").glob("*.json"))
SCHEMA = scenario_schema()
VALIDATOR = jsonschema.Draft202012Validator(SCHEMA)

Place = tuple[Any, ...]


def is_accepted(scenario: Any) -> bool:
    return bool(VALIDATOR.is_valid(scenario))


def is_read(scenario: Any) -> bool:
    try:
        c2d.Scenario.from_json(json.dumps(scenario))
    except c2d.ScenarioError:
        return False
    return True


def leaves(node: Any, place: Place = ()) -> Iterator[tuple[Place, Any]]:
    """Yield every value in plain data that contains no others, with its path."""
    if isinstance(node, (dict, list)):
        pairs = node.items() if isinstance(node, dict) else enumerate(node)
        for key, value in pairs:
            yield from leaves(value, (*place, key))
    else:
        yield place, node


def objects(node: Any, place: Place = ()) -> Iterator[Place]:
    if isinstance(node, dict):
        yield place
        for key, value in node.items():
            yield from objects(value, (*place, key))


def changed(plain: Any, place: Place, value: Any) -> Any:
    """Copy plain data with another value at a path."""
    copied = copy.deepcopy(plain)
    holder = copied
    for key in place[:-1]:
        holder = holder[key]
    holder[place[-1]] = value
    return copied


def test_the_schema_is_valid() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    assert SCHEMA["$schema"] == "https://json-schema.org/draft/2020-12/schema"


def test_every_scenario_file_is_accepted() -> None:
    assert len(FILES) > 10
    assert [path.name for path in FILES if not is_accepted(json.loads(path.read_text()))] == []


@pytest.mark.parametrize("scenario", VARIANTS.values(), ids=VARIANTS)
def test_every_kind_of_robot_and_ground_is_accepted(scenario: c2d.Scenario) -> None:
    VALIDATOR.validate(json.loads(scenario.to_json()))


# With many kinds of parts between them.
SPOILT = ("flippers-climb", "flippers-hold", "belt-lanes", "sprocket-step", "closed-barrier")


def cases() -> Iterator[tuple[Any, Place, Any]]:
    """Yield a scenario for each value of each kind of part, with the place of the value."""
    seen = set()
    for name in SPOILT:
        plain = json.loads(VARIANTS[name].to_json())
        for place, value in leaves(plain):
            holder = plain
            for key in place[:-1]:
                holder = holder[key]
            kind = holder.get("kind") if isinstance(holder, dict) else len(holder)
            field = [key for key in place if isinstance(key, str)][-1]
            if (kind, field) not in seen:
                seen.add((kind, field))
                yield plain, place, value


def wrong_values(value: Any) -> list[Any]:
    """List values of other types than one, and numbers out of range."""
    if isinstance(value, (bool, str)):
        return ["no such name", 1, None]
    return ["1", -1e300, None] if isinstance(value, (int, float)) else ["1", True]


def test_a_wrong_value_anywhere_is_refused_as_it_is_by_the_core() -> None:
    tried = 0
    for plain, place, value in cases():
        for wrong in wrong_values(value):
            spoilt = changed(plain, place, wrong)
            if not is_read(spoilt) and not joins_fields(place, wrong):
                assert not is_accepted(spoilt), (place, wrong)
                tried += 1
    assert tried > 200


def joins_fields(place: Place, wrong: Any) -> bool:
    """Whether a value is invalid only with another one, which the schema cannot express."""
    return wrong is None and place in {("solver", "accuracy"), ("solver", "time_step")}


@pytest.mark.parametrize("name", ["flippers-climb", "belt-lanes"])
def test_a_field_too_many_or_too_few_is_refused(name: str) -> None:
    plain = json.loads(VARIANTS[name].to_json())
    for place in objects(plain):
        spoilt = changed(plain, (*place, "colour"), "red")
        assert not is_accepted(spoilt)
        node: Any = plain
        for key in place:
            node = node[key]
        for field in node:
            rest = {key: value for key, value in node.items() if key != field}
            spoilt = changed(plain, place, rest) if place else rest
            assert is_accepted(spoilt) is is_read(spoilt), (place, field)


def test_negative_sizes_masses_and_counts_are_refused() -> None:
    plain = json.loads(FILES[0].read_text())
    for place in [
        ("robot", "mass"),
        ("robot", "gauge"),
        ("robot", "outline", "axle_distance"),
        ("robot", "drivetrain", "max_torque"),
        ("duration",),
        ("terrain", "friction"),
        ("criteria", "stationary_windows"),
    ]:
        assert is_accepted(plain)
        assert not is_accepted(changed(plain, place, -1)), place


def test_of_fields_that_exclude_each_other_one_is_accepted() -> None:
    plain = json.loads(FILES[0].read_text())
    assert plain["solver"]["accuracy"] is not None or plain["solver"]["time_step"] is not None
    both = changed(plain, ("solver", "accuracy"), 1e-6)
    assert not is_accepted(changed(both, ("solver", "time_step"), 1e-3))
    outline = plain["robot"]["outline"]
    discs = {"discs": [[-0.2, 0.0, 0.05], [0.2, 0.0, 0.05], [0.0, 0.05, 0.05]]}
    grousers = {name: value for name, value in outline.items() if name.startswith("grouser")}
    assert is_accepted(changed(plain, ("robot", "outline"), discs | grousers))
    assert not is_accepted(changed(plain, ("robot", "outline"), discs | outline))


def test_every_field_has_a_description_and_every_number_a_range_and_its_unit() -> None:
    parts = {**SCHEMA["$defs"], "Scenario": SCHEMA}
    for name, part in parts.items():
        for field, value in part["properties"].items():
            assert field == "kind" or "description" in value, (name, field)
            types = value.get("type", [])
            if {"number", "integer"}.intersection([types] if isinstance(types, str) else types):
                assert "maximum" in value, (name, field)
                unit = unit_of(field)
                if unit not in (None, "1") and (name, field) != ("Flippers", "torque_limit"):
                    assert value["description"].startswith(f"[{unit}]"), (name, field)


def test_every_class_of_parameters_is_described() -> None:
    classes = {
        cls.__name__
        for module in (track, terrain, settings)
        for cls in vars(module).values()
        if inspect.isclass(cls) and issubclass(cls, Parameters) and cls.kind
    }
    assert classes - set(SCHEMA["$defs"]) == set()
    assert {"Robot", "Drivetrain", "PI", "Flippers", "Solver"} <= set(SCHEMA["$defs"])


def test_the_command_prints_the_schema(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA
