"""Eq. (1) and the claims of the paper."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from research.paper.claims import (
    claims,
    claims_text,
    force_is_flat,
    gears_end_seizure,
    geometry,
    shaking_of_gears,
    unevenness,
)
from research.paper.design import QUICK, Work, layouts, models_of
from research.paper.figures import (
    Shaking,
    equation_text,
    gear_angles,
    off_formula,
    phases,
    shaking,
)


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Work:
    """Few runs, in a store, so that tests share simulations."""
    design = replace(QUICK, claim_repeats=1, driving_repeats=1)
    store = tmp_path_factory.mktemp("claims") / "paper.sqlite"
    return Work(store=store, design=design, threads=1, progress=False)


@pytest.fixture(scope="module")
def shaken(work: Work) -> list[Shaking]:
    return shaking(work)


def test_gears_start_at_the_angles_of_equation_1(work: Work) -> None:
    found = phases(work)
    assert {row.model: row.count for row in found}["line of 3"] == 6  # and three on the flipper
    assert max(row.off for row in found) < 1e-12  # rounding


def test_another_phase_is_off_equation_1() -> None:
    track = c2d.LineOfWheels(3, wheel=c2d.GearWheel(phase_fraction=0.5))
    robot = c2d.robots.engineer(flippers=None, track=track)
    run = c2d.simulate(c2d.Scenario(robot, c2d.terrains.flat(), duration=3.0))
    number, angle, theta = gear_angles(run)[0]
    assert number == 1
    assert theta == pytest.approx(2.0 * np.pi / 7.0)
    assert off_formula(number, angle, theta) == pytest.approx(theta / 6.0)


def test_a_third_of_theta_takes_most_of_the_swing_but_not_for_three_gears(
    work: Work, shaken: list[Shaking]
) -> None:
    swings = {(row.count, round(row.fraction, 2)): row.swing for row in shaken}
    # In step all wheels stand on two grousers at once, then on one: a chord between the corners of
    # two tips, 6 mm thick, of seven. Sampled every 10 ms.
    half = np.pi / 7.0 - np.arcsin(0.003 / 0.064)
    for count in (3, 5):
        assert swings[count, 0.0] == pytest.approx(0.064 * (1.0 - np.cos(half)), rel=0.01)
    assert swings[5, 0.33] < 0.1 * swings[5, 0.0]
    assert swings[3, 0.5] < swings[3, 0.33] < 0.5 * swings[3, 0.0]
    rough, third = shaking_of_gears(work, shaken)
    assert (rough.verdict, third.verdict) == ("holds", "holds in part")
    assert "eq. (1) within" in equation_text(phases(work), shaken)


@pytest.mark.parametrize("count", [5, 9])
def test_pockets_of_a_line_are_as_deep_as_the_circles_leave_them(count: int) -> None:
    robot = c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(count))
    deep, mean = unevenness(robot)
    pitch = 0.365 / (count - 1)
    assert deep == pytest.approx(0.064 - (0.064**2 - pitch**2 / 4.0) ** 0.5, rel=1e-6)
    # A circular segment holds two thirds of its chord's rectangle, less for deep ones.
    assert mean == pytest.approx(deep / 3.0, rel=0.1)


def test_slots_are_as_deep_as_the_belly_is_high() -> None:
    robot = layouts()["line of 3"].on(c2d.robots.engineer(flippers=None))
    assert unevenness(robot)[0] == pytest.approx(0.034)
    assert geometry().verdict == "holds in part"


def test_five_gears_stay_on_an_edge_of_2_mm_that_three_gears_clear(
    work: Work, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = {"line of 3 gears", "line of 5 gears"}

    def lines(names: Sequence[str], *others: Any, **fields: Any) -> dict[str, Any]:
        """Replace what is not asked for: wheels all round and grousers take most of the time."""
        models = models_of(names, *others, **fields)
        return {name: models[name if name in asked else "line of 3"] for name in names}

    monkeypatch.setattr("research.paper.claims.models_of", lines)
    claim = gears_end_seizure(work)
    held = {check.what: check.holds for check in claim.checks}
    assert not held["line of 5 gears clear an edge 2 mm thick"]
    assert held["line of 5 gears clear an edge 10 mm thick"]
    assert held["line of 3 gears clear an edge 2 mm thick"]
    assert claim.verdict == "holds in part"
    assert "| 1 | gears end seizure on sharp edges |" in claims_text([claim])


@pytest.mark.soak  # the others contain its parts
def test_every_claim_has_its_verdict(work: Work, shaken: list[Shaking]) -> None:
    tiny = replace(QUICK, claim_repeats=1, field_repeats=1, driving_repeats=1, computing_repeats=1)
    little = replace(work, design=tiny)
    found = claims(little, shaken)
    verdicts = {claim.text: claim.verdict for claim in found}
    assert len(verdicts) == len(found) >= 15
    unasked = [text for text, verdict in verdicts.items() if verdict == "cannot be tested here"]
    assert len(unasked) == 3
    assert any("turn" in text for text in unasked)
    assert verdicts["segmental tracks have a low computational efficiency"] == "holds"
    assert verdicts["the protrusions of gears complicate odometry"] == "holds"


def test_a_force_is_unlike_a_belt_at_a_step(work: Work) -> None:
    held = {check.what: check.holds for check in force_is_flat(work).checks}
    assert held["flat: as the belt"]
    assert held["step of 60 mm: unlike the belt"]
