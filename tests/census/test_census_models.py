"""Over a thousand stops of grousers, chains, flippers and lanes, each judged independently."""

import collections
from collections.abc import Callable

import numpy as np
import pytest

from crawler2d.results.findings import Mechanism
from crawler2d.results.outcome import Outcome
from tests.census.cases import (
    Case,
    apart,
    cases,
    certificates,
    disagreements,
    faults_of_fields,
    faults_of_kind,
    stopped,
)
from tests.census.models import STRATA

# Drawn scenarios may be odd.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")

# Runs of each stratum in the whole census.
SIZES = {
    "grouser belts": 200,
    "weak grouser belts": 160,
    "guides": 80,
    "weak guides": 100,
    "slippery guides": 80,
    "sprockets": 80,
    "weak sprockets": 80,
    "few road wheels": 100,
    "arms held": 200,
    "arms climbing": 200,
    "pockets of arms": 200,
    "gear arms": 200,
    "lanes": 200,
    "new models on lanes": 60,
    "arms on lanes": 80,
}


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(200, id="a few"),
        pytest.param(1, id="all", marks=pytest.mark.soak),
    ],
)
def census(request: pytest.FixtureRequest) -> list[Case]:
    return list(cases(STRATA, SIZES, request.param))


def test_a_run_has_a_diagnosis_exactly_if_it_ended_in_a_stop(census: list[Case]) -> None:
    assert faults_of_kind(census) == []


def test_the_fields_of_a_diagnosis_fit_together(census: list[Case]) -> None:
    assert faults_of_fields(census) == []


def test_contact_forces_balance_where_the_pose_does_not_change(
    census: list[Case], say: Callable[[str], None]
) -> None:
    lines, shares = certificates(census)
    judged = [case.opinion.imbalance for case in stopped(census) if case.opinion is not None]
    say("\n  ".join([*lines, f"the judge's own: largest {np.max(judged):.1e}"]))
    assert len(shares) > 3
    assert {family for family, share in shares.items() if share < 0.99} <= {"gears"}


def test_a_second_judge_agrees(census: list[Case], say: Callable[[str], None]) -> None:
    say("\n  ".join(disagreements(census)))
    assert len(apart(census)) <= 0.02 * len(stopped(census))


def test_belts_with_grousers_never_seize(census: list[Case]) -> None:
    closed = {
        "grouser_belt",
        *(f"grouser_belt, arms{of}" for of in ("", " belt", " grouser_belt")),
        *(f"belt, arms {of}" for of in ("belt", "grouser_belt")),
    }
    belts = [case for case in stopped(census) if case.track in closed]
    assert belts
    assert not [case.name for case in belts if case.outcome is Outcome.SEIZED]


def test_a_chain_on_its_guide_never_seizes(census: list[Case]) -> None:
    chains = [case for case in stopped(census) if case.track == "segmental guide"]
    assert chains
    assert not [case.name for case in chains if case.outcome is Outcome.SEIZED]


def test_the_census_holds_every_kind(census: list[Case], say: Callable[[str], None]) -> None:
    table = collections.Counter(
        (case.stratum, str(case.outcome), str(case.diagnosis.mechanism) if case.diagnosis else "")
        for case in census
    )
    lines = [
        f"{stratum:20} {outcome:12} {how:12} {n}"
        for (stratum, outcome, how), n in sorted(table.items())
    ]
    say("\n  ".join(["seed 0", *lines]))
    assert set(SIZES) == set(STRATA)
    if len(census) < sum(SIZES.values()):
        return
    stops = stopped(census)
    assert len(stops) >= 1_000
    outcomes = {case.outcome for case in stops}
    mechanisms = {case.diagnosis.mechanism for case in stops if case.diagnosis is not None}
    kinds = {Outcome.SEIZED, Outcome.HUNG_UP, Outcome.STALLED, Outcome.SLIPPING, Outcome.CYCLING}
    assert outcomes - {Outcome.TIMED_OUT} == kinds  # the value for stops that would not have lasted
    assert mechanisms == {None, *Mechanism}
