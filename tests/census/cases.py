"""Runs of a census without their histories, and conditions that they must satisfy."""

import collections
import itertools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.results.diagnosis import Diagnosis
from crawler2d.results.findings import Mechanism
from crawler2d.results.outcome import Outcome
from tests.census.strata import Strata, drawn
from tests.judges.judge import Opinion, judge

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
    family: str
    """Models whose contacts are alike."""

    @property
    def name(self) -> str:
        return f"{self.stratum}:{self.index} {self.track}"

    @property
    def opinions(self) -> tuple[str, str]:
        """The opinions of core and judge on a stop."""
        assert self.diagnosis is not None
        assert self.opinion is not None
        return (
            _view(self.diagnosis.symptom, self.diagnosis),
            _view(self.opinion.symptom, self.opinion),
        )

    @property
    def is_hard(self) -> bool:
        """Whether core or judge find loaded ground inside the track."""
        assert self.diagnosis is not None
        assert self.opinion is not None
        return self.diagnosis.mechanism is not None or self.opinion.mechanism is not None


def _view(symptom: str, of: Diagnosis | Opinion) -> str:
    return f"{symptom}, {of.mechanism}{', jammed' * of.jammed}"


def cases(strata: Strata, sizes: dict[str, int], share: int) -> Iterable[Case]:
    """All cases of strata of these sizes, or a fraction of them."""
    for stratum, size in sizes.items():
        scenarios = drawn(stratum, -(-size // share), strata=strata)
        index = itertools.count()
        while batch := list(itertools.islice(scenarios, AT_A_TIME)):
            # A failing one is reported by its test, after all others.
            for run in c2d.simulate_many(batch, threads=2, on_error="record"):
                yield case(stratum, next(index), run)


def case(stratum: str, index: int, run: c2d.Run) -> Case:
    """The stored data of a run."""
    robot = run.scenario.robot
    stops = run.events["end"][run.events["kind"] == "stop"] if len(run.events) else np.zeros(0)
    names = [name_of(robot.track)]
    if robot.flippers is not None:
        arms = robot.flippers.track
        names.append(f"arms {'' if arms is None else name_of(arms)}".strip())
    return Case(
        stratum=stratum,
        index=index,
        track=", ".join(names),
        outcome=run.outcome,
        diagnosis=run.diagnosis,
        lasts=bool(len(stops) and stops.max() >= run.time[-1] - 1e-6),
        opinion=None if run.diagnosis is None else second_opinion(run),
        family=family(names),
    )


def name_of(track: Any) -> str:
    """The model of a track, with the shape of its wheels or its support."""
    shape = getattr(getattr(track, "wheel", None), "kind", getattr(track, "support", ""))
    return f"{track.kind} {getattr(track, 'mechanism', shape)}".strip()


def family(names: list[str]) -> str:
    """The part of the name that decides the kind of contacts: chains and gears rattle."""
    said = " ".join(names)
    for word, found in (
        ("segmental", "chains"),
        ("gear", "gears"),
        ("round", "round wheels"),
        ("grouser_belt", "grouser belts"),
    ):
        if word in said:
            return found
    return names[0]


def second_opinion(run: c2d.Run) -> Opinion:
    try:
        return judge(run)
    except AssertionError as error:  # a linear program without an answer
        return Opinion(symptom=str(error), jammed=False, mechanism=None, imbalance=np.inf)


def stopped(census: list[Case]) -> list[Case]:
    """The cases that stood still or moved to and fro at their end, temporarily or not."""
    return [case for case in census if case.diagnosis is not None]


def faults_of_kind(census: list[Case]) -> list[str]:
    """Cases without a result, or with a missing or superfluous diagnosis."""
    wrong = []
    for case in census:
        d = case.diagnosis
        rules = {
            "result": case.outcome is not None,
            "diagnosis": d is not None or not (case.outcome and case.outcome.is_stop),
            "stop": d is None or bool(d.outcome.is_stop) is not d.transient,
            "lasts": d is None or case.lasts,
            "outcome": d is None or d.outcome is case.outcome,
        }
        wrong += [f"{case.name}: {rule}" for rule, holds in rules.items() if not holds]
    return wrong


def faults_of_fields(census: list[Case]) -> list[str]:
    """Diagnoses that contradict themselves."""
    wrong = []
    for case in stopped(census):
        assert case.diagnosis is not None
        rules = rules_of(case.diagnosis)
        wrong += [f"{case.name}: {rule}" for rule, holds in rules.items() if not holds]
    return wrong


def rules_of(d: Diagnosis) -> dict[str, bool]:
    """Conditions that a diagnosis must satisfy, and whether it does."""
    criteria = c2d.SeizureCriteria()
    allowed = criteria.imbalance if d.stationary else criteria.mean_imbalance
    shares = (d.belly_share, d.sliding_share, d.stalled_share)
    is_stalled = d.stalled_share >= 0.5
    freed = set(d.freed_by)
    belts = {"closed track", "closed track, clear of the ground"}
    tried = {trial.name for trial in d.trials}
    is_freed_as_a_belt = d.jammed and bool(freed & belts)
    outcome = d.symptom
    if d.transient:
        outcome = Outcome.TIMED_OUT
    elif is_freed_as_a_belt:
        outcome = Outcome.STALLED if "one motor" in freed else Outcome.SEIZED
    jams = {Mechanism.INTERLOCKED, Mechanism.BLOCKED}
    return {
        "certified": d.certified == (d.imbalance is not None and d.imbalance <= allowed),
        "since": d.since < d.time,
        "shares": all(0.0 <= share <= 1.0 + 1e-9 for share in shares),
        "intrusion": d.mechanism is None or d.intrusion is not None,
        "outcome": d.outcome is outcome,
        "controls": d.transient == bool(freed & {"unchanged", "rebuilt"}),
        "a jam is tried with belts": d.transient or not d.jammed or belts & tried != set(),
        "a jam has contacts": any(d.contacts["in_pocket"]) or not d.jammed,
        "a belly hangs": d.symptom is not Outcome.HUNG_UP or d.belly_share >= criteria.belly_load,
        "motors stall": d.symptom is not Outcome.STALLED or is_stalled,
        "motors jam": d.mechanism not in jams or is_stalled,
    }


def certificates(census: list[Case]) -> tuple[list[str], dict[str, float]]:
    """A table of imbalances, and for families at rest the fraction within the criteria."""
    families: dict[tuple[str, bool], list[float]] = collections.defaultdict(list)
    for case in stopped(census):
        d = case.diagnosis
        assert d is not None
        found = np.inf if d.imbalance is None else d.imbalance
        families[case.family, d.stationary].append(found)
    lines = ["imbalance: median, 95 %, 99 %, largest; no certificate"]
    criteria = c2d.SeizureCriteria()
    shares = {}
    for (name, stationary), values in sorted(families.items()):
        allowed = criteria.imbalance if stationary else criteria.mean_imbalance
        within = [value <= allowed for value in values]
        figures = " ".join(f"{q:.1e}" for q in np.quantile(values, [0.5, 0.95, 0.99, 1.0]))
        state = "stationary" if stationary else "in the mean"
        lines.append(f"{name:13} {state:11} {len(values):5}: {figures}; {within.count(False)}")
        if stationary:
            shares[name] = float(np.mean(within))
    return lines, shares


def apart(census: list[Case]) -> list[Case]:
    """The stops for which core and judge have different names."""
    return [case for case in stopped(census) if case.opinions[0] != case.opinions[1]]


def disagreements(census: list[Case]) -> list[str]:
    """Each of them with its figures, and their number."""
    hard = [case for case in stopped(census) if case.is_hard]
    hard_apart = [case for case in apart(census) if case.is_hard]
    lines = []
    for case in apart(census):
        assert case.opinion is not None
        figures = " ".join(f"{name} {value:.3g}" for name, value in case.opinion.figures.items())
        core, other = case.opinions
        lines.append(f"{case.name}: core {core}; judge {other}; {figures}")
    lines.append(
        f"{len(stopped(census))} stops, {len(apart(census))} judged differently; "
        f"of {len(hard)} with loaded ground inside {len(hard_apart)}"
    )
    return lines
