"""The keys to public trees of models agree with the files: lines, numbers, arithmetic."""

import tomllib
from typing import Any

import pytest

from tests.robots.robot_files import evaluated
from tests.robots.tree_keys import TREES, Citation, Key, decimals, expressions, flat, keys

KEYS = list(keys().values())
FIGURES = {
    "wheels_a_side",
    "driven_a_side",
    "axles",
    "radii",
    "pitch",
    "outline",
    "flipper_count",
    "flippers",
    "gauge",
    "forward",
    "mass",
    "center_of_mass",
}
each_key = pytest.mark.parametrize("key", KEYS, ids=[key.name for key in KEYS])


def cited(key: Key) -> list[tuple[str, Citation]]:
    return [(name, place) for name, entry in key.entries() for place in key.citations(entry)]


@each_key
def test_each_cited_line_has_the_cited_text(key: Key) -> None:
    absent = [
        f"{name}: {place.path.name}:{place.line} has not {place.text!r} but {place.there!r}"
        for name, place in cited(key)
        if place.text not in place.there
    ]
    assert not absent, "\n".join(absent)


@each_key
def test_each_number_of_the_arithmetic_stands_in_a_cited_line(key: Key) -> None:
    homeless = []
    for name, entry in key.entries():
        there = {number for place in key.citations(entry) for number in place.numbers}
        wanted = {number for text in expressions(entry) for number in decimals(text)}
        homeless += [f"{name}: {number}" for number in sorted(wanted - there)]
    assert not homeless


@each_key
def test_each_value_is_that_of_its_arithmetic(key: Key) -> None:
    known = key.given
    for name, entry in key.data["figures"].items():
        if "how" in entry:
            found = [evaluated("${" + text + "}", known) for text in flat(entry["how"])]
            assert flat(entry["value"]) == pytest.approx(found, rel=1e-12, abs=1e-15), name
        else:
            assert entry.get("at") or name in {"mass", "center_of_mass"}, name


@each_key
def test_mass_and_centre_are_those_of_the_links(key: Key) -> None:
    if "mass" in key.unknown:
        return
    mass = sum(link[0] for link in key.links)
    centre = [sum(link[0] * link[axis] for link in key.links) / mass for axis in (1, 2)]
    assert key.figures["mass"] == pytest.approx(mass, rel=1e-9)
    assert key.figures["center_of_mass"] == pytest.approx(centre, abs=1e-6)


@each_key
def test_each_figure_is_known_or_has_a_reason_why_not(key: Key) -> None:
    missing = FIGURES - set(key.figures) - set(key.unknown)
    assert missing <= {"flippers"}, missing
    assert not missing or key.figures["flipper_count"] == 0
    assert not set(key.figures) & set(key.unknown)
    assert all(key.unknown.values())


@each_key
def test_a_key_agrees_with_itself(key: Key) -> None:
    values: dict[str, Any] = key.figures
    axles, radii, outline = (values.get(name) for name in ("axles", "radii", "outline"))
    if axles and radii and outline:
        assert outline == [[*axle, radius] for axle, radius in zip(axles, radii, strict=True)]
    if axles and "pitch" in values:
        assert values["pitch"] == pytest.approx(axles[-1][0] - axles[0][0], rel=1e-12)
    if "flippers" in values:
        assert values["flipper_count"] == 2 * len(values["flippers"])
    assert key.data["on_shapes"] != ("cure" in key.data)


@each_key
def test_each_main_file_is_there(key: Key) -> None:
    assert key.file.is_file()


def test_every_mass_of_the_sdf_model_is_that_of_a_link_of_its_key() -> None:
    key = keys()["marv_model"]
    lines = key.file.read_text(encoding="utf-8").split("\n")
    masses = [number for number, line in enumerate(lines, 1) if "<mass>" in line]
    links = [key.citations(link)[-1].line for link in key.data["links"]]
    assert links == masses


def test_the_arguments_of_marv_are_those_that_it_has_no_default_for() -> None:
    arguments = keys()["marv"].arguments
    assert float(arguments["rover_topBoxX"]) == 0.065
    assert arguments["has_boson_thermocam"] == arguments["has_kinova"] == "False"
    assert keys()["tractor"].arguments == {}


def test_the_keys_are_those_that_the_readme_lists() -> None:
    text = (TREES / "README.md").read_text(encoding="utf-8")
    for path in (TREES / "keys").glob("*.toml"):
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        assert f"| `{path.stem}` | `{data['repository']}/{data['file']}` |" in text
