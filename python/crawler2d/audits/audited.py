"""What an audit knows before the first run, and what it has found, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from crawler2d.audits.assumptions import Assumed
from crawler2d.audits.beside import Belt
from crawler2d.audits.call import Call
from crawler2d.audits.finding import Finding
from crawler2d.audits.pockets import Pocket
from crawler2d.audits.repairs import Repair, Repaired
from crawler2d.audits.verdicts import Verdict
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.terrain import Terrain
from crawler2d.reading.reading import Reading

if TYPE_CHECKING:
    import xarray

__all__ = ["Audited", "Begun"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Begun:
    """What an audit knows before the first run.

    Parameters
    ----------
    robot : Robot
        What was audited.
    reading : Reading, optional
        What was read, if it was a file.
    lint : tuple of Finding
        What is hardly meant in the model, errors first.
    pockets : tuple of Pocket
        What is open between its wheels: a screen, no verdict.
    belt : Belt
        The robot on belts that it was compared with, and which belts these are, and why.
    obstacles : mapping of str to terrain
        What it drives over, in this order: where it is likely to seize comes first.
    vary, unknown : mapping of str to distribution
        What differs from run to run, and what is not known.
    drive : Drive
        How it is driven.
    call : Call
        What was asked for.
    """

    robot: Robot
    reading: Reading | None
    lint: tuple[Finding, ...]
    pockets: tuple[Pocket, ...]
    belt: Belt
    obstacles: Mapping[str, Terrain]
    vary: Mapping[str, Any]
    unknown: Mapping[str, Any]
    drive: Drive
    call: Call


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Audited(Begun):
    """What an audit found, as data.

    Parameters
    ----------
    verdicts : tuple of Verdict
        One for each obstacle, in their order.
    assumed : tuple of Assumed
        What becomes of each seizure under other assumptions; none if `unknown` was given.
    repaired : Repaired, optional
        What the search for repairs came to; None if there was none.
    table : xarray.Dataset
        The runs behind the verdicts, as from `sweep`: dimensions `model` ("model", "belt"),
        `terrain`, `sample` and `repeat`. Without unknowns the repeats stand in `sample`. The
        coordinate `speed` [m/s] is that of each run, without its scatter. Runs that no verdict
        needed were not made, and have the outcome "". Its attributes `vary` and `unknown` name
        what the rates are rates over.
    """

    verdicts: tuple[Verdict, ...]
    assumed: tuple[Assumed, ...]
    repaired: Repaired | None
    table: xarray.Dataset

    @property
    def seizes(self) -> bool:
        """Whether it seizes on an obstacle by the rule of `Verdict.word`: the belt clears that."""
        return any(each.word == "seizes" for each in self.verdicts)

    @property
    def repairs(self) -> tuple[Repair, ...]:
        """The best of each kind that was tried: those that are confirmed, the least changed first.

        Each says in `confirmed` whether fresh runs bear it out; empty without a search.
        """
        return () if self.repaired is None else self.repaired.repairs
