"""Everything that can be simulated or reported is documented, and has a scenario in the tests."""

import inspect
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.common.units import METRICS
from crawler2d.parameters import settings, terrain, track
from crawler2d.parameters.fields import Parameters
from tests.shared import VARIANTS

ROOT = Path(__file__).parents[2]
CHOOSING = (ROOT / "docs/guide/choosing-wheels.md").read_text(encoding="utf-8")
CONVENTIONS = (ROOT / "docs/conventions.md").read_text(encoding="utf-8")


def kinds_of(module: Any) -> list[type[Parameters]]:
    """Return the classes of a module that are variants of a kind."""
    classes = [cls for cls in vars(module).values() if inspect.isclass(cls)]
    return [cls for cls in classes if issubclass(cls, Parameters) and cls.kind]


KINDS = [cls for module in (track, terrain, settings) for cls in kinds_of(module)]
MODELS = [cls for cls in kinds_of(track) if cls.default_path == "robot.track"]


def kinds_in(node: Any) -> Iterator[str]:
    """Yield the kind of every object in plain data."""
    if isinstance(node, dict):
        if "kind" in node:
            yield node["kind"]
        for value in node.values():
            yield from kinds_in(value)
    elif isinstance(node, list):
        for value in node:
            yield from kinds_in(value)


def kinds_below(cls: type[Parameters]) -> Iterator[type[Parameters]]:
    """Yield the subclasses of a class."""
    for each in cls.__subclasses__():
        yield each
        yield from kinds_below(each)


def section(name: str) -> str:
    """Return a section of the conventions, up to the next heading of its level."""
    return CONVENTIONS.partition(f"\n## {name}\n")[2].partition("\n## ")[0]


def test_every_kind_of_track_terrain_and_gait_has_a_scenario_in_the_tests() -> None:
    tried = {kind for each in VARIANTS.values() for kind in kinds_in(json.loads(each.to_json()))}
    assert len(KINDS) > 20
    assert {cls.kind for cls in KINDS} - tried == set()


@pytest.mark.parametrize("cls", [*MODELS, *kinds_of(terrain)])
def test_every_track_model_and_terrain_has_a_row_in_the_conventions(cls: type[Parameters]) -> None:
    about = section("Terrains" if cls.default_path == "terrain" else "Track models")
    assert f"| `{cls.__name__}` | `{cls.kind}` |" in about


def test_every_track_model_is_public_and_in_the_guide() -> None:
    assert [cls.__name__ for cls in MODELS if cls.__name__ not in c2d.__all__] == []
    assert [cls.__name__ for cls in MODELS if f"| `{cls.__name__}(" not in CHOOSING] == []


def test_every_generator_of_terrains_is_in_the_conventions_and_every_terrain_has_one() -> None:
    named = section("Terrains")
    generators = c2d.terrains.__all__
    assert [name for name in generators if not re.search(f"`{name}[`(]", named)] == []
    made = [getattr(c2d.terrains, name) for name in generators]
    assert [cls for cls in kinds_of(terrain) if cls not in (*made, terrain.Points)] == []


def test_every_outcome_and_mechanism_is_in_the_tables_of_the_conventions() -> None:
    told = section("Goal and outcomes")
    assert [each for each in c2d.Outcome if not re.search(rf"^\|.*`{each}`", told, re.M)] == []
    told = section("Why a run stopped")
    assert [each for each in c2d.Mechanism if f"| `{each}` |" not in told] == []


def test_every_key_that_a_scenario_file_may_lack_is_in_the_conventions() -> None:
    told = section("Scenario files").partition("; only ")[2].partition("may be omitted")[0]
    optional = {name for cls in kinds_below(Parameters) for name in cls.omitted_defaults}
    assert set(re.findall(r"`(\w+)`", told)) == optional


def test_every_metric_is_in_the_conventions_with_its_unit() -> None:
    told: dict[str, str] = {}
    for names, units in re.findall(r"^\| (`.*?) \| (.*?) ?\| ", section("Metrics"), re.M):
        each = re.findall(r"`(\w+)`", names)
        of_each = [unit or "1" for unit in units.split(", ")]
        told |= zip(each, of_each * (len(each) // len(of_each)), strict=True)
    assert told == METRICS


def test_every_metric_is_in_the_documentation_of_a_run() -> None:
    told = inspect.getdoc(c2d.Run) or ""
    assert [name for name in METRICS if not re.search(f"^(`.*)?`{name}`", told, re.M)] == []
