"""What has a name in both languages has the same one, and the same code."""

from enum import StrEnum
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.results.findings import Condition


@pytest.mark.parametrize(
    ("column", "codes"), [("body_kind", c2d.BodyKind), ("lane", c2d.Lane)], ids=["body", "lane"]
)
def test_codes_of_tables_have_the_names_of_the_core(column: str, codes: Any) -> None:
    named = {code.value: code.name.lower() for code in codes}
    assert named == dict(enumerate(_core.kinds()[column]))


def test_outcomes_are_those_of_the_core_in_its_order() -> None:
    assert [str(outcome) for outcome in c2d.Outcome] == _core.kinds()["outcome"]


@pytest.mark.parametrize(
    ("name", "words"), [("mechanism", c2d.Mechanism), ("condition", Condition)]
)
def test_words_of_a_diagnosis_are_those_of_the_core(name: str, words: type[StrEnum]) -> None:
    assert {str(word) for word in words} == set(_core.kinds()[name])
