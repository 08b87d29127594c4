"""Lint and pockets of a robot alone: what an audit finds without a single run."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Unpack

from crawler2d.audits.finding import Finding
from crawler2d.audits.lint import lint
from crawler2d.audits.pockets import Pocket, pockets
from crawler2d.audits.subject import HowToRead, subject_of
from crawler2d.audits.text import text_of_lint
from crawler2d.audits.verdicts import Verdict
from crawler2d.parameters.robot import Robot
from crawler2d.reading.reading import Reading

__all__ = ["Linted", "linted"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Linted:
    """What lint found; the fields are those of `Audit`.

    Parameters
    ----------
    robot : Robot
        What was looked at.
    reading : Reading, optional
        What was read, if it was a file.
    lint : tuple of Finding
        What is hardly meant in the model, errors first.
    pockets : tuple of Pocket
        What is open between its wheels: a screen, no verdict.
    verdicts : tuple of Verdict
        None: nothing was simulated.
    """

    robot: Robot
    reading: Reading | None
    lint: tuple[Finding, ...]
    pockets: tuple[Pocket, ...]
    verdicts: tuple[Verdict, ...] = ()

    @property
    def in_words(self) -> str:
        """The short form, as ``python -m crawler2d audit --lint`` prints it."""
        title = self.robot.in_words if self.reading is None else self.reading.in_words
        return text_of_lint(title, self.lint, self.pockets)

    def __repr__(self) -> str:
        """Write the short form."""
        return self.in_words


def linted(robot: Robot | Reading | str | os.PathLike[str], **reading: Unpack[HowToRead]) -> Linted:
    """Look for what is hardly meant in a model, and measure its pockets, without a run.

    What only the simulator doubts is not found.

    Parameters
    ----------
    robot : Robot, Reading or path
        As for `audit`.
    **reading
        For a path: the keywords of `read_robot`.

    Raises
    ------
    ScenarioError
        If the file cannot be read.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> found = linted(c2d.robots.marv(track="public"))
    >>> [each.rule for each in found.lint], len(found.pockets)
    (['no track'], 15)
    """
    own, read, _ = subject_of(robot, reading)
    return Linted(robot=own, reading=read, lint=lint(own, read), pockets=pockets(own))
