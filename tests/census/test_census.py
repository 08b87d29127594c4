"""Thousands of stops of every kind, each judged independently."""

import collections
from collections.abc import Callable

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
from tests.census.strata import STRATA

# Drawn scenarios may be odd.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")

# Runs of each stratum in the whole census.
SIZES = {
    "anything": 1200,
    "wheels": 1200,
    "slots": 1400,
    "weak motors": 800,
    "weak gears": 600,
    "low bellies": 600,
    "little grip": 600,
    "smooth tracks": 500,
    "walls": 300,
    "gears at walls": 300,
    "long grousers": 600,
    "small obstacles": 120,
    "high steps": 120,
    "ends": 140,
    "short times": 120,
}


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(120, id="a few"),
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
    say("\n  ".join(lines))
    assert len(shares) > 3
    assert {family for family, share in shares.items() if share < 0.99} <= {"gears"}


def test_a_second_judge_agrees(census: list[Case], say: Callable[[str], None]) -> None:
    say("\n  ".join(disagreements(census)))
    assert len(apart(census)) <= 0.02 * len(stopped(census))


def test_belts_and_skids_never_seize(census: list[Case]) -> None:
    smooth = [case for case in stopped(census) if case.track in {"belt", "force skids"}]
    assert smooth
    assert not [case.name for case in smooth if case.outcome is Outcome.SEIZED]


def test_nothing_seizes_at_a_plain_wall(census: list[Case]) -> None:
    walls = [case for case in stopped(census) if case.stratum == "walls"]
    assert walls
    assert not [case.name for case in walls if case.outcome is Outcome.SEIZED]


def test_the_census_holds_every_kind(census: list[Case], say: Callable[[str], None]) -> None:
    counts = collections.Counter(
        (str(case.outcome), str(case.diagnosis.mechanism) if case.diagnosis else "")
        for case in census
    )
    outcomes = collections.Counter(case.outcome for case in census)
    mechanisms = collections.Counter(
        case.diagnosis.mechanism for case in census if case.diagnosis is not None
    )
    lines = [f"{' '.join(key):22} {count}" for key, count in sorted(counts.items())]
    say("\n  ".join(["seed 0", *lines]))
    whole = len(census) >= sum(SIZES.values())
    least = 100 if whole else 1
    reachable = set(Outcome) - {Outcome.DETRACKED}
    if whole:
        assert sum(outcomes[each] for each in Outcome if each.is_stop) >= 5_000
    assert {outcome for outcome in reachable if outcomes[outcome] < least} == set()
    if whole:
        of_chains = {Mechanism.PINCHED, Mechanism.FOULED}
        told = set(Mechanism) - of_chains
        assert {each for each in told if mechanisms[each] < least} == set()
    assert set(SIZES) == set(STRATA)
