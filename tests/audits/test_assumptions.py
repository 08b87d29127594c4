"""An audit reports whether a seizure depends on rotors and on restitution."""

from dataclasses import replace
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.audits.sampling import Assumption, assumptions_of
from crawler2d.audits.words import conclusion
from crawler2d.variation.distributions import Ranges
from tests.audits.seizing import QUIET, SEIZING, STEP


def test_a_rotor_that_is_stated_is_assumed_no_other() -> None:
    stated = c2d.Robot.simple(20.0, axle_distance=0.4, radius=0.06)
    assert list(assumptions_of(stated, {})) == ["rotor", "restitution"]
    drivetrain = replace(stated.drivetrain, rotor_inertia=0.05)
    assert list(assumptions_of(replace(stated, drivetrain=drivetrain), {})) == ["restitution"]


def test_chains_have_no_restitution_to_draw() -> None:
    robot = c2d.robots.engineer(flippers=None, track=c2d.SegmentalTrack())
    assert dict(c2d.unknowns.of_restitution(robot)) == {}


@pytest.mark.parametrize(("seized", "seizes"), [(0, False), (2, False), (3, True), (18, True)])
def test_a_seizure_holds_if_the_lower_bound_of_its_rate_is_above_5_percent(
    seized: int, *, seizes: bool
) -> None:
    found = Assumption(
        obstacle="step", assumption="rotor", drawn=Ranges({}), seized=seized, runs=18
    )
    assert found.seizes == seizes


def test_each_seizure_is_driven_again_under_each_assumption_and_reported() -> None:
    # At full speed alone, where runs are short; of the samples the first 18 are taken.
    how: Any = {"vary": c2d.variability.of_start(), "samples": 20, "repeats": 1}
    found = c2d.audit(SEIZING, STEP, **how, repair=False, **QUIET)
    assert found.seizes
    (impacts,) = found.assumed
    assert (impacts.obstacle, impacts.assumption, impacts.runs) == (
        "step of 75 mm",
        "restitution",
        18,
    )
    assert impacts.seized <= 18
    assert any("With bouncing contacts (restitution 0 to 1)" in each for each in conclusion(found))
    again = c2d.audit(SEIZING, STEP, **how, repair=False, **QUIET)
    assert again.assumed == found.assumed


def test_nothing_is_assumed_where_everything_is_known() -> None:
    found = c2d.audit(SEIZING, STEP, unknown={}, repeats=4, repair=False, **QUIET)
    assert found.seizes
    assert found.assumed == ()
