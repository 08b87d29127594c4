"""Distributions and ranges: their texts and combinations."""

from typing import Any

import numpy as np
import pytest
from scipy import stats  # type: ignore[import-untyped]

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from crawler2d.variation.distributions import Levels, LogUniform, Ranges, read_distribution
from crawler2d.variation.draws import Variation, fields_at
from tests.kept import refusing
from tests.shared import ROBOT, VARIANTS
from tests.sweeps.small import SAID

NUMBERS = np.array([0.0, 0.25, 0.5, 0.999, 1.0])
BASE = Scenario(ROBOT, c2d.terrains.step(0.05))

# For each: its text, whether it varies about a field's own value, whether it has integers, and its
# values for `NUMBERS` and the own value 2.
EVERY: list[tuple[Any, str, bool, bool, list[float]]] = [
    (c2d.uniform(1.0, 3.0), "Uniform(low=1.0, high=3.0)", False, False, [1, 1.5, 2, 2.998, 3]),
    (
        LogUniform(1.0, 16.0),
        "LogUniform(low=1.0, high=16.0)",
        False,
        False,
        [1, 2, 4, 16**0.999, 16],
    ),
    (c2d.uniform_int(1, 4), "UniformInt(low=1, high=4)", False, True, [1, 2, 3, 4, 4]),
    (c2d.scaled(0.5, 1.5), "Scaled(low=0.5, high=1.5)", True, False, [1, 1.5, 2, 2.998, 3]),
    (c2d.shifted(-1.0, 3.0), "Shifted(low=-1.0, high=3.0)", True, False, [1, 2, 3, 4.996, 5]),
    (
        c2d.shifted(-3.0, 1.0, minimum=0.0),
        "Shifted(low=-3.0, high=1.0, minimum=0.0)",
        True,
        False,
        [0, 1, 2, 3.996, 4],
    ),
    (
        Levels((0.5, 1.0), spread=0.1),
        "Levels(factors=(0.5, 1.0), spread=0.1, along=None)",
        True,
        False,
        [0.9, 1.0, 1.8, 2.1992, 2.2],
    ),
    (
        read_distribution(stats.randint(3, 7), "x"),
        "randint(3, 7)",
        False,
        True,
        [3, 3, 4, 6, 6],
    ),
    (
        read_distribution(stats.uniform(1.0, scale=2.0), "x"),
        "uniform(1.0, scale=2.0)",
        False,
        False,
        [1, 1.5, 2, 2.998, 3],
    ),
]


@pytest.mark.parametrize(("given", "text", "relative", "whole", "values"), EVERY)
def test_a_distribution_says_what_it_is_and_does_it(
    given: Any, text: str, relative: bool, whole: bool, values: list[float]
) -> None:
    assert repr(given) == text
    assert given.is_relative is relative
    assert given.is_whole is whole
    assert given.values(NUMBERS, 2.0).tolist() == pytest.approx(values, rel=1e-12)
    assert given.resolve(BASE) == given


def test_a_shift_in_units_of_a_length_becomes_one_in_metres() -> None:
    given = c2d.shifted(-0.5, 0.25, unit="robot.outline.axle_distance", minimum=0.01)
    assert repr(given) == (
        "Shifted(low=-0.5, high=0.25, unit='robot.outline.axle_distance', minimum=0.01)"
    )
    length = ROBOT.outline.axle_distance
    assert given.resolve(BASE) == c2d.shifted(-0.5 * length, 0.25 * length, minimum=0.01)


def test_levels_are_taken_in_turn_from_any_number_on() -> None:
    levels = Levels((1.0, 2.0, 3.0))
    numbers = np.full(5, 0.5)
    for first, factors in ((0, [1, 2, 3, 1, 2]), (1, [2, 3, 1, 2, 3]), (5, [3, 1, 2, 3, 1])):
        assert levels.values(levels.cycle(numbers, first), 10.0).tolist() == [
            10.0 * factor for factor in factors
        ]
    assert levels.cycle(numbers, 0).tolist() == pytest.approx([1 / 6, 1 / 2, 5 / 6, 1 / 6, 1 / 2])


LEFT = Ranges(
    {"gravity": c2d.uniform(9.0, 10.0), "robot.mass": c2d.scaled(0.9, 1.1)},
    {"gravity": "a guess", "robot.mass": "scales"},
    ["gravity", "robot.mass"],
)


def test_the_right_one_of_two_ranges_counts_where_both_have_a_path() -> None:
    own = c2d.uniform(9.8, 9.82)
    both = LEFT | Ranges({"gravity": own, "duration": c2d.uniform(1.0, 2.0)}, {"gravity": "known"})
    assert list(both) == ["gravity", "robot.mass", "duration"]
    assert both["gravity"] == own
    assert both.sources == {"robot.mass": "scales", "gravity": "known"}
    assert both.optional == {"robot.mass"}
    plain = {"robot.mass": c2d.uniform(5.0, 6.0)} | LEFT
    assert plain["robot.mass"] == LEFT["robot.mass"]
    assert (plain.sources, plain.optional) == (LEFT.sources, LEFT.optional)
    assert len(plain) == 2
    number: Any = 3
    with pytest.raises(TypeError, match="unsupported operand"):
        LEFT | number
    with pytest.raises(TypeError, match="unsupported operand"):
        number | LEFT


def test_ranges_without_a_path_have_nothing_of_it() -> None:
    left = LEFT.without(["gravity", "no such path"])
    assert dict(left) == {"robot.mass": c2d.scaled(0.9, 1.1)}
    assert left.sources == {"robot.mass": "scales"}
    assert left.optional == {"robot.mass"}


def test_ranges_say_line_by_line_what_they_are() -> None:
    both = LEFT | {"duration": c2d.uniform(1.0, 2.0)}
    assert repr(both).splitlines() == [
        "Ranges",
        "  gravity: Uniform(low=9.0, high=10.0)",
        "      a guess",
        "  robot.mass: Scaled(low=0.9, high=1.1)",
        "      scales",
        "  duration: Uniform(low=1.0, high=2.0)",
    ]


def test_a_range_of_no_distribution_is_refused_by_its_path() -> None:
    with refusing(SAID, r"^\['gravity'\] must be uniform"):
        Ranges({"gravity": 9.81})


@pytest.mark.parametrize("of", ["of_start", "of_contact", "of_field"])
def test_the_usual_variability_is_left_out_where_a_scenario_has_none_of_it(of: str) -> None:
    ranges = getattr(c2d.variability, of)()
    assert ranges.optional == set(ranges) == set(ranges.sources)
    assert of in dir(c2d.variability)


def test_the_seeds_of_a_field_are_those_of_31_bits() -> None:
    seeds = c2d.variability.of_field()
    assert dict(seeds) == {"terrain.seed": c2d.uniform_int(0, 2**31 - 1)}
    assert seeds.sources == {"terrain.seed": "any field of the same measures"}


def test_the_friction_stands_for_that_of_every_lane_and_segment() -> None:
    path = "terrain.friction"
    assert fields_at(BASE, path) == [path]
    points = VARIANTS["belt-points"].terrain
    own = Scenario(ROBOT, points)
    count = len(points.points) - 1  # type: ignore[union-attr]
    segments = own.replace({"terrain.segment_friction": [0.5] * count})
    assert fields_at(segments, path) == [
        f"terrain.segment_friction[{number}]" for number in range(count)
    ]
    lanes = VARIANTS["belt-lanes"].replace({"terrain.middle": None})
    assert fields_at(lanes, path) == ["terrain.left.friction", "terrain.right.friction"]


def test_the_variability_of_a_start_gives_way_to_a_swept_start() -> None:
    usual = c2d.variability.of_start()
    for swept, left in (
        (["start.approach"], ["start.track_phase"]),
        (["start"], []),
        (["start.angle"], list(usual)),
        (["drive.speed"], list(usual)),
    ):
        assert list(Variation.read(BASE, usual, swept).distributions) == left
    assert Variation.read(BASE, usual, []).text == "; ".join(
        f"{path}: {each}" for path, each in usual.items()
    )


@pytest.mark.parametrize("is_first", [False, True])
def test_a_path_of_one_element_counts_before_that_of_all(is_first: bool) -> None:
    one = {"robot.belly[0][1]": c2d.uniform(-0.02, -0.02)}
    every = {"robot.belly[*][1]": c2d.uniform(-0.01, -0.01)}
    vary = {**one, **every} if is_first else {**every, **one}
    variation = Variation.read(BASE, vary, [])
    found = variation.draw(BASE, {path: np.array([0.5]) for path in vary}).values
    assert ROBOT.belly is not None
    assert {path: float(values[0]) for path, values in found.items()} == {
        f"robot.belly[{k}][1]": -0.02 if k == 0 else -0.01 for k in range(len(ROBOT.belly))
    }
