"""A claim of the paper: the experiment that settles it, what came out, and so whether it holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from crawler2d.sweeps.statistics import newcombe

__all__ = ["OFTEN", "SELDOM", "Check", "Claim", "clears", "fewer"]

OFTEN, SELDOM = 0.9, 0.1
"""[-] A model whose rate is at least the one clears an obstacle; one up to the other does not."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Check:
    """One thing that must be so if the claim holds."""

    what: str
    found: str
    """The figures, with counts."""
    holds: bool | None
    """None if so few runs do not tell."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """A claim with its checks."""

    section: str
    """Where the paper says so."""
    text: str
    experiment: str
    checks: tuple[Check, ...] = ()
    """None if it cannot be asked here."""

    @property
    def verdict(self) -> str:
        """Whether it holds: in part if only some of the checks do.

        Examples
        --------
        >>> yes, no, open = (Check(what="", found="", holds=each) for each in (True, False, None))
        >>> for checks in ((yes, yes), (no,), (yes, no), (open, no), ()):
        ...     print(Claim(section="", text="", experiment="", checks=checks).verdict)
        holds
        does not hold
        holds in part
        not shown
        cannot be asked here
        """
        held = [check.holds for check in self.checks]
        if not held:
            return "cannot be asked here"
        if all(held):
            return "holds"
        if any(held):
            return "holds in part"
        return "not shown" if None in held else "does not hold"


def clears(what: str, found: Sequence[tuple[str, int, int]], *, never: bool = False) -> Check:
    """Check that every model clears as often as `OFTEN`, or as `SELDOM`.

    Parameters
    ----------
    what : str
        What must be so.
    found : sequence of str, int and int
        Label, runs that cleared and all runs of each.
    never : bool
        Whether they must not clear.

    Examples
    --------
    >>> clears("gears clear", [("3 gears", 18, 20), ("5 gears", 0, 20)]).found
    '3 gears 18 of 20, 5 gears 0 of 20'
    """
    rates = [cleared / count for _, cleared, count in found]
    holds = all(rate <= SELDOM if never else rate >= OFTEN for rate in rates)
    told = ", ".join(f"{name} {cleared} of {count}" for name, cleared, count in found)
    return Check(what=what, found=told, holds=holds)


def fewer(what: str, less: tuple[str, int, int], more: tuple[str, int, int]) -> Check:
    """Check that one model clears less often than another, by Newcombe's 95 % interval.

    It does not if its rate is no lower, and so few runs do not tell if the interval holds 0.

    Parameters
    ----------
    what : str
        What must be so.
    less, more : tuple of str, int and int
        Label, runs that cleared and all runs.

    Examples
    --------
    >>> check = fewer("heavier sticks more", ("heavy", 2, 20), ("light", 15, 20))
    >>> check.holds, check.found
    (True, 'heavy 2 of 20, light 15 of 20: difference -0.65 (-0.81 to -0.35)')
    """
    (one, a, n), (other, b, m) = less, more
    difference, low, high = newcombe(a, n, b, m)
    told = (
        f"{one} {a} of {n}, {other} {b} of {m}: difference {difference:+.2f}"
        f" ({low:+.2f} to {high:+.2f})"
    )
    holds = True if high < 0.0 else None if difference < 0.0 else False
    return Check(what=what, found=told, holds=holds)
