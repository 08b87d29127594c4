"""Names that exist in both languages are the same, with the same codes."""

from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d import _core
from crawler2d.results.outcome import MECHANISMS, OUTCOMES, TRIALS


@pytest.mark.parametrize(
    ("column", "codes"), [("body_kind", c2d.BodyKind), ("lane", c2d.Lane)], ids=["body", "lane"]
)
def test_codes_of_tables_have_the_names_of_the_core(column: str, codes: Any) -> None:
    named = {code.value: code.name.lower() for code in codes}
    assert named == dict(enumerate(_core.kinds()[column]))


def test_outcomes_are_those_of_the_core_in_its_order() -> None:
    assert [str(outcome) for outcome in c2d.Outcome] == _core.kinds()["outcome"]


def test_words_of_a_diagnosis_are_those_of_the_core_and_have_a_meaning() -> None:
    assert {str(word) for word in c2d.Mechanism} == set(_core.kinds()["mechanism"])
    assert [str(word) for word in c2d.Mechanism] == list(MECHANISMS)
    assert [str(word) for word in c2d.Outcome] == list(OUTCOMES)
    assert list(TRIALS) == _core.kinds()["trial"]


@pytest.mark.parametrize("words", [c2d.Mechanism, c2d.Outcome])
def test_help_explains_every_word(words: Any) -> None:
    assert words.__doc__ is not None
    for word in words:
        assert f"- {word}: {word.meaning}" in words.__doc__


def test_the_docs_say_the_same_of_every_word() -> None:
    text = (Path(__file__).parents[2] / "docs" / "conventions.md").read_text(encoding="utf-8")
    for words in (MECHANISMS, OUTCOMES, TRIALS):
        for word, meaning in words.items():
            assert f"| `{word}` | {meaning} |" in text, word
