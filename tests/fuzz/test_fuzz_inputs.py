"""Any text or object as a scenario is either valid, or refused with the name of the field."""

import pickle
import random
import time
from collections.abc import Callable
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.errors import ArgumentError
from crawler2d.parameters.fields import Parameters
from crawler2d.parameters.scenario import Scenario
from tests.fuzz import texts as fuzz_texts
from tests.fuzz.account import SEED, Account, cases
from tests.fuzz.objects import drawn_object, fields
from tests.shared import VARIANTS

Say = Callable[[str], None]
Drawn = Callable[[random.Random], tuple[str, Callable[[], Scenario]]]

BASES = list(VARIANTS.values())
TREES = [fuzz_texts.tree(scenario.to_json()) for scenario in BASES]
LONGEST = 10.0  # [s] of processor time for one


def from_text(draw: random.Random) -> tuple[str, Callable[[], Scenario]]:
    text = fuzz_texts.drawn_text(draw, TREES)
    return ascii(text[:2000]), lambda: Scenario.from_json(text)


def from_objects(draw: random.Random) -> tuple[str, Callable[[], Scenario]]:
    def made() -> Scenario:
        scenario = drawn_object(draw, BASES)
        scenario.validate()
        return scenario

    return "objects", made


def is_told(error: c2d.ScenarioError) -> bool:
    """Whether an error can be printed, and passed to another process."""
    copy = pickle.loads(pickle.dumps(error))
    shown = str(error)
    whole = (copy.path, copy.rule, str(copy)) == (error.path, error.rule, shown)
    return whole and len(repr(error)) < 10_000


def survives(scenario: Scenario) -> bool:
    """Whether a scenario is unchanged by writing and reading."""
    copy = Scenario.from_json(scenario.to_json())
    equal = copy == scenario and hash(copy) == hash(scenario)
    return equal and copy.identity == scenario.identity and copy.to_json() == scenario.to_json()


def fuzzed(name: str, drawn: Drawn, count: int) -> Account:
    """Try a number of cases; a case is determined by its number and the seed."""
    account = Account(name)
    for case in range(count):
        what, made = drawn(random.Random(f"{SEED}:{name}:{case}"))
        begin = time.process_time()
        try:
            scenario = made()
            account.counts["accepted"] += 1
            if not survives(scenario):
                account.fault("accepted and not the same when read again", f"case {case}: {what}")
        except c2d.ScenarioError as error:
            account.counts["refused"] += 1
            if not is_told(error):
                account.fault("an error that does not tell", f"case {case}: {error!r:.500}")
        except Exception as error:  # that there is none is what is tested
            kind = f"{type(error).__name__}: {error!s:.60}"
            account.fault(kind, f"case {case}: {what}")
        took = time.process_time() - begin
        account.took(took, f"case {case}")
        if took > LONGEST:
            account.fault("too long", f"case {case}: {took:.1f} s, {what}")
    return account


def check(name: str, drawn: Drawn, count: int, say: Say = print) -> None:
    account = fuzzed(name, drawn, count)
    say(str(account))
    assert not account.faults
    assert account.counts["accepted"] > 0.05 * count
    assert account.counts["refused"] > 0.5 * count


# Doubtful values may give warnings, which are not tested here.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")


def test_a_changed_text_is_a_scenario_or_is_refused(capfd: pytest.CaptureFixture[str]) -> None:
    check("texts", from_text, 1_500)
    assert "panicked" not in capfd.readouterr().err


def test_odd_objects_are_a_scenario_or_are_refused(capfd: pytest.CaptureFixture[str]) -> None:
    check("objects", from_objects, 1_500)
    assert "panicked" not in capfd.readouterr().err


@pytest.mark.soak
def test_a_hundred_thousand_texts_are_scenarios_or_are_refused(say: Say) -> None:
    check("texts", from_text, cases("TEXTS", 100_000), say)


@pytest.mark.soak
def test_a_hundred_thousand_odd_objects_are_scenarios_or_are_refused(say: Say) -> None:
    check("objects", from_objects, cases("OBJECTS", 100_000), say)


@pytest.mark.parametrize("name", VARIANTS)
def test_a_misspelt_keyword_is_refused_by_name(name: str) -> None:
    scenario = VARIANTS[name]
    for owner in (scenario, *(value for _, value in fields(scenario))):
        if isinstance(owner, Parameters):
            cls: Any = type(owner)
            with pytest.raises(ArgumentError, match=f"^unknown must be .* {cls.__name__} takes"):
                cls(unknown=1)
