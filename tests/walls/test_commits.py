"""Subjects of commits are imperatives of at most 72 characters, and bodies say why."""

import re
import shutil
import subprocess

import pytest

from tests.walls.rooms import ROOT

SINCE = "6a259e8938"
"""The last commit before this rule."""

LONGEST = 72

NO_IMPERATIVE = re.compile(r"\w+(?:ed|ing|(?<![s])s)", re.IGNORECASE)
IMPERATIVES = ("Bring", "Feed", "Need", "Proceed", "Speed", "Focus", "Bias", "Embed", "Shed")


def faults(message: str) -> list[str]:
    """List the faults of the message of a commit."""
    subject, _, body = message.partition("\n")
    first = subject.partition(" ")[0]
    found = []
    if len(subject) > LONGEST:
        found.append(f"{len(subject)} characters, not {LONGEST}")
    if not first[:1].isupper():
        found.append("must begin with a capital letter")
    if subject.endswith("."):
        found.append("must not end with a full stop")
    if NO_IMPERATIVE.fullmatch(first) and first not in IMPERATIVES:
        found.append(f"must begin with an imperative, not {first}")
    if not body.strip():
        found.append("needs a body that says why")
    return found


def test_a_message_is_an_imperative_with_a_reason() -> None:
    assert faults("Pass the friction by name\n\nPositions were mixed up.") == []
    assert len(faults("adds x.")) == 4
    assert len(faults(f"Added {'x' * LONGEST}\n\nWhy.")) == 2


def test_commit_messages_follow_the_rules() -> None:
    if shutil.which("git") is None:
        pytest.skip("there is no git")
    asked = ["git", "-C", str(ROOT), "log", "--no-merges", "--format=%h %B%x00", f"{SINCE}..HEAD"]
    answer = subprocess.run(asked, capture_output=True, text=True, check=False)
    if answer.returncode:
        pytest.skip("the history since this rule is not here")
    messages = [each.strip().partition(" ") for each in answer.stdout.split("\0") if each.strip()]
    wrong = {f"{name} {text[:40]}": faults(text) for name, _, text in messages if faults(text)}
    assert wrong == {}
