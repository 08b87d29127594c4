"""Thousands of stops of every kind and every model, each judged independently."""

import collections
import functools
from collections.abc import Callable

import numpy as np
import pytest

from crawler2d.results.findings import Mechanism
from crawler2d.results.outcome import Outcome
from tests.census import models, strata
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

# Drawn scenarios may be odd.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")

# Runs of each stratum in the whole census: of wheels and belts, then of grousers, chains, flippers
# and lanes.
SIZES = {
    "tracks": {
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
    },
    "models": {
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
    },
}
STRATA = {"tracks": strata.STRATA, "models": models.STRATA}
TRACKS = [
    pytest.param("tracks", 200, id="a few tracks"),
    pytest.param("tracks", 1, id="all tracks", marks=pytest.mark.soak),
]
MODELS = [
    pytest.param("models", 300, id="a few models"),
    pytest.param("models", 1, id="all models", marks=pytest.mark.soak),
]

of_tracks = pytest.mark.parametrize(("name", "share"), TRACKS)
of_models = pytest.mark.parametrize(("name", "share"), MODELS)
of_both = pytest.mark.parametrize(("name", "share"), [*TRACKS, *MODELS])


@functools.cache
def drawn(name: str, share: int) -> list[Case]:
    return list(cases(STRATA[name], SIZES[name], share))


@pytest.fixture
def census(name: str, share: int) -> list[Case]:
    return drawn(name, share)


@of_both
def test_a_run_has_a_diagnosis_exactly_if_it_ended_in_a_stop(census: list[Case]) -> None:
    assert faults_of_kind(census) == []


@of_both
def test_the_fields_of_a_diagnosis_fit_together(census: list[Case]) -> None:
    assert faults_of_fields(census) == []


@of_both
def test_contact_forces_balance_where_the_pose_does_not_change(
    census: list[Case], say: Callable[[str], None]
) -> None:
    lines, shares = certificates(census)
    judged = [case.opinion.imbalance for case in stopped(census) if case.opinion is not None]
    say("\n  ".join([*lines, f"the judge's own: largest {np.max(judged):.1e}"]))
    assert len(shares) > 3
    assert {family for family, share in shares.items() if share < 0.99} <= {"gears"}


@of_both
def test_a_second_judge_agrees(census: list[Case], say: Callable[[str], None]) -> None:
    say("\n  ".join(disagreements(census)))
    assert len(apart(census)) <= 0.02 * len(stopped(census))


@of_tracks
def test_belts_and_skids_never_seize(census: list[Case]) -> None:
    smooth = [case for case in stopped(census) if case.track in {"belt", "force skids"}]
    assert smooth
    assert not [case.name for case in smooth if case.outcome is Outcome.SEIZED]


@of_tracks
def test_nothing_seizes_at_a_plain_wall(census: list[Case]) -> None:
    walls = [case for case in stopped(census) if case.stratum == "walls"]
    assert walls
    assert not [case.name for case in walls if case.outcome is Outcome.SEIZED]


@of_tracks
def test_the_census_of_tracks_holds_every_kind(
    census: list[Case], say: Callable[[str], None]
) -> None:
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
    whole = len(census) >= sum(SIZES["tracks"].values())
    least = 100 if whole else 1
    reachable = set(Outcome) - {Outcome.DETRACKED}
    if whole:
        assert sum(outcomes[each] for each in Outcome if each.is_stop) >= 5_000
    assert {outcome for outcome in reachable if outcomes[outcome] < least} == set()
    if whole:
        of_chains = {Mechanism.PINCHED, Mechanism.FOULED}
        told = set(Mechanism) - of_chains
        assert {each for each in told if mechanisms[each] < least} == set()
    assert set(SIZES["tracks"]) == set(strata.STRATA)


@of_models
def test_belts_with_grousers_never_seize(census: list[Case]) -> None:
    closed = {
        "grouser_belt",
        *(f"grouser_belt, arms{of}" for of in ("", " belt", " grouser_belt")),
        *(f"belt, arms {of}" for of in ("belt", "grouser_belt")),
    }
    belts = [case for case in stopped(census) if case.track in closed]
    assert belts
    assert not [case.name for case in belts if case.outcome is Outcome.SEIZED]


@of_models
def test_a_chain_on_its_guide_never_seizes(census: list[Case]) -> None:
    chains = [case for case in stopped(census) if case.track == "segmental guide"]
    assert chains
    assert not [case.name for case in chains if case.outcome is Outcome.SEIZED]


@of_models
def test_the_census_of_models_holds_every_kind(
    census: list[Case], say: Callable[[str], None]
) -> None:
    table = collections.Counter(
        (case.stratum, str(case.outcome), str(case.diagnosis.mechanism) if case.diagnosis else "")
        for case in census
    )
    lines = [
        f"{stratum:20} {outcome:12} {how:12} {n}"
        for (stratum, outcome, how), n in sorted(table.items())
    ]
    say("\n  ".join(["seed 0", *lines]))
    assert set(SIZES["models"]) == set(models.STRATA)
    if len(census) < sum(SIZES["models"].values()):
        return
    stops = stopped(census)
    assert len(stops) >= 1_000
    outcomes = {case.outcome for case in stops}
    mechanisms = {case.diagnosis.mechanism for case in stops if case.diagnosis is not None}
    kinds = {Outcome.SEIZED, Outcome.HUNG_UP, Outcome.STALLED, Outcome.SLIPPING, Outcome.CYCLING}
    assert outcomes - {Outcome.TIMED_OUT} == kinds  # the value for stops that would not have lasted
    assert mechanisms == {None, *Mechanism}
