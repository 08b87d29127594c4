"""Thousands of stops of every kind, each judged a second time by other means."""

import collections
import itertools
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
import pytest

import crawler2d as c2d
from census import STRATA, drawn
from crawler2d.diagnosis import Condition, Diagnosis, Mechanism
from crawler2d.outcome import Outcome
from judge import STOPS, Opinion, judge

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
AT_A_TIME = 100  # histories that are held in memory


@dataclass(frozen=True, kw_only=True)
class Case:
    """One run of the census, without its history."""

    stratum: str
    index: int
    track: str
    outcome: Outcome | None
    """None where there is no result."""
    diagnosis: Diagnosis | None
    lasts: bool
    """The last stop goes on to the end."""
    opinion: Opinion | None

    @property
    def name(self) -> str:
        return f"{self.stratum}:{self.index} {self.track}"

    @property
    def family(self) -> str:
        """Models whose contacts are alike."""
        if self.track.startswith(("belt", "force")):
            return self.track
        return "gears" if self.track.endswith("gear") else "round wheels"

    @property
    def opinions(self) -> tuple[str, str]:
        """What core and judge say, where there is a stop."""
        assert self.diagnosis is not None
        assert self.opinion is not None
        return (
            f"{self.outcome}, {self.diagnosis.mechanism}",
            f"{self.opinion.outcome}, {self.opinion.mechanism}",
        )

    @property
    def is_hard(self) -> bool:
        """Somebody sees loaded ground inside the track."""
        assert self.diagnosis is not None
        assert self.opinion is not None
        return self.diagnosis.mechanism is not None or self.opinion.mechanism is not None


def cases(share: int) -> Iterable[Case]:
    for stratum, size in SIZES.items():
        scenarios = drawn(stratum, -(-size // share))
        index = itertools.count()
        while batch := list(itertools.islice(scenarios, AT_A_TIME)):
            # One that fails is shown by its test, after all others have been looked at.
            for run in c2d.simulate_many(batch, threads=2, on_error="record"):
                yield case(stratum, next(index), run)


def case(stratum: str, index: int, run: c2d.Run) -> Case:
    track = run.scenario.robot.track
    stops = run.events["end"][run.events["kind"] == "stop"] if len(run.events) else np.zeros(0)
    shape = getattr(getattr(track, "wheel", None), "kind", getattr(track, "support", ""))
    return Case(
        stratum=stratum,
        index=index,
        track=f"{track.kind} {shape}".strip(),
        outcome=run.outcome,
        diagnosis=run.diagnosis,
        lasts=bool(len(stops) and stops.max() >= run.time[-1] - 1e-6),
        opinion=second_opinion(run) if run.outcome in STOPS else None,
    )


def second_opinion(run: c2d.Run) -> Opinion:
    try:
        return judge(run)
    except AssertionError as error:  # a linear program without an answer
        return Opinion(outcome=str(error), mechanism=None, imbalance=np.inf)


@pytest.fixture(
    scope="module",
    params=[
        pytest.param(50, id="a fiftieth"),
        pytest.param(1, id="all", marks=pytest.mark.soak),
    ],
)
def census(request: pytest.FixtureRequest) -> list[Case]:
    return list(cases(request.param))


def stopped(census: list[Case]) -> list[Case]:
    return [case for case in census if case.outcome in STOPS]


def test_a_run_has_a_diagnosis_exactly_if_it_ended_in_a_stop(census: list[Case]) -> None:
    wrong = []
    for case in census:
        d = case.diagnosis
        rules = {
            "result": case.outcome is not None,
            "diagnosis": (d is not None) == (case.outcome in STOPS),
            "lasts": d is None or case.lasts,
            "outcome": d is None or d.outcome is case.outcome,
        }
        wrong += [f"{case.name}: {rule}" for rule, holds in rules.items() if not holds]
    assert wrong == []


def test_the_fields_of_a_diagnosis_fit_together(census: list[Case]) -> None:
    wrong = []
    for case in stopped(census):
        assert case.diagnosis is not None
        rules = rules_of(case.diagnosis)
        wrong += [f"{case.name}: {rule}" for rule, holds in rules.items() if not holds]
    assert wrong == []


def rules_of(d: Diagnosis) -> dict[str, bool]:
    """What has to hold in a diagnosis, and whether it does."""
    criteria = c2d.SeizureCriteria()
    allowed = criteria.imbalance if d.stationary else criteria.mean_imbalance
    # A push means nothing to a state that rattles on.
    has_escape = d.certified and d.stationary
    shares = (d.belly_share, d.sliding_share, d.stalled_share)
    is_seized, is_stalled = d.outcome is Outcome.SEIZED, d.stalled_share >= 0.5
    jams = {Mechanism.INTERLOCKED, Mechanism.BLOCKED}
    return {
        "certified": d.certified == (d.imbalance is not None and d.imbalance <= allowed),
        "escape force": (d.escape_force is not None) == has_escape,
        "free escape force": (d.free_escape_force is not None) == has_escape,
        "since": d.since < d.time,
        "shares": all(0.0 <= share <= 1.0 + 1e-9 for share in shares),
        "intrusion": d.mechanism is None or d.intrusion is not None,
        "a seizure is certified": d.certified or not is_seized,
        "a seizure is due to a pocket": is_seized == ((Condition.POCKET,) in d.cause)
        or d.outcome is Outcome.CYCLING,
        "a seizure has contacts in a pocket": any(d.contacts["in_pocket"]) or not is_seized,
        "a belly hangs": d.outcome is not Outcome.HUNG_UP or d.belly_share >= criteria.belly_load,
        "motors stall": d.outcome is not Outcome.STALLED or is_stalled,
        "motors jam": d.mechanism not in jams or is_stalled,
    }


def test_contact_forces_balance_where_the_pose_does_not_change(
    census: list[Case], say: Callable[[str], None]
) -> None:
    families: dict[tuple[str, bool], list[float]] = collections.defaultdict(list)
    for case in stopped(census):
        d = case.diagnosis
        assert d is not None
        found = np.inf if d.imbalance is None else d.imbalance
        families[case.family, d.stationary].append(found)
    lines = ["imbalance: median, 95 %, 99 %, largest; no certificate"]
    criteria = c2d.SeizureCriteria()
    wrong = []
    for (family, stationary), values in sorted(families.items()):
        allowed = criteria.imbalance if stationary else criteria.mean_imbalance
        within = [value <= allowed for value in values]
        figures = " ".join(f"{q:.1e}" for q in np.quantile(values, [0.5, 0.95, 0.99, 1.0]))
        state = "stationary" if stationary else "in the mean"
        lines.append(f"{family:12} {state:11} {len(values):5}: {figures}; {within.count(False)}")
        if family != "gears" and stationary and np.mean(within) < 0.99:
            wrong.append(family)
    say("\n  ".join(lines))
    assert wrong == []


def test_a_second_judge_agrees(census: list[Case], say: Callable[[str], None]) -> None:
    stops = stopped(census)
    apart = [case for case in stops if case.opinions[0] != case.opinions[1]]
    hard = [case for case in stops if case.is_hard]
    hard_apart = [case for case in apart if case.is_hard]
    lines = []
    for case in apart:
        assert case.opinion is not None
        figures = " ".join(f"{name} {value:.3g}" for name, value in case.opinion.figures.items())
        relaxed = " ".join(f"{value:.1e}" for value in case.opinion.relaxed)
        core, other = case.opinions
        lines.append(f"{case.name}: core {core}; judge {other}; closed {relaxed}; {figures}")
    lines.append(
        f"{len(stops)} stops, {len(apart)} judged differently; "
        f"of {len(hard)} with loaded ground inside {len(hard_apart)}"
    )
    say("\n  ".join(lines))
    assert len(apart) <= 0.02 * len(stops)


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
        assert sum(outcomes[Outcome(stop)] for stop in STOPS) >= 5_000
    assert {outcome for outcome in reachable if outcomes[outcome] < least} == set()
    if whole:
        of_chains = {Mechanism.PINCHED, Mechanism.FOULED}
        told = set(Mechanism) - of_chains
        assert {each for each in told if mechanisms[each] < least} == set()
    assert set(SIZES) == set(STRATA)
