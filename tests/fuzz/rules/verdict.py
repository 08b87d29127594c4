"""The verdict of the oracle of valid scenarios, and its comparisons of numbers with limits."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

AT_BORDER = 1e-6
"""A number this close to a limit, as a share of it, is at its border."""
ROUNDING = 1e-9
"""By this share two ways to compute a length may differ: nearer to a limit nothing is known."""

ANYWHERE = "*"
"""The path of doubts about all that depends on what is not known."""


@dataclass
class Verdict:
    """The oracle's verdict on a scenario."""

    broken: dict[str, set[str]] = field(default_factory=dict)
    """Rules by the path of the field that breaks them."""
    unknown: dict[str, set[str]] = field(default_factory=dict)
    """Those of which it cannot say whether they are kept."""
    at_border: set[str] = field(default_factory=set)
    """Rules that are just kept."""
    limits: list[tuple[str, str, float]] | None = None
    """Rules, fields and the limits that they set there, where that is a number, if asked for."""

    @property
    def rules_broken(self) -> set[str]:
        """All rules that are broken."""
        return {rule for rules in self.broken.values() for rule in rules}

    def is_clean(self, *paths: str) -> bool:
        """Whether no rule is broken at these paths and below them."""
        return not any(
            at == path or at.startswith((f"{path}.", f"{path}["))
            for at in self.broken
            for path in paths
        )

    def need(self, rule: str, path: str, kept: bool) -> bool:
        """Check a rule without degrees; if it is obeyed, the value is at its border."""
        if kept:
            self.at_border.add(rule)
        else:
            self.broken.setdefault(path, set()).add(rule)
        return kept

    def doubt(self, rule: str, path: str) -> None:
        """Record that the verdict is unknown."""
        self.unknown.setdefault(path, set()).add(rule)

    def at_most(self, rule: str, path: str, value: float, limit: float, **how: Any) -> bool:
        """Hold a number to its upper limit, or with `less` to less; `how` is of `Border`."""
        return self._compare(rule, path, (value, limit), Border(**how), 1.0)

    def at_least(self, rule: str, path: str, value: float, limit: float, **how: Any) -> bool:
        """Hold a number to its lower limit, or with `more` to more."""
        return self._compare(rule, path, (value, limit), Border(**how), -1.0)

    def _compare(
        self, rule: str, path: str, numbers: tuple[float, float], border: Border, sign: float
    ) -> bool:
        value, limit = numbers
        if self.limits is not None:
            there = limit if border.there is None else border.there
            self.limits.append((rule, border.at or path, there))
        value = min(max(value, -1e300), 1e300)  # also of whole numbers beyond float64
        apart, scale = abs(value - limit), max(abs(value), abs(limit))
        if not border.exact and apart <= ROUNDING * scale:
            self.doubt(rule, path)
            return False
        beyond = value > limit if sign > 0.0 else value < limit
        if beyond or ((border.less or border.more) and value == limit):
            self.broken.setdefault(path, set()).add(rule)
            return False
        if apart <= border.near * max(abs(limit), 1e-290):
            self.at_border.add(rule)
        return True


@dataclass(frozen=True)
class Border:
    """A comparison of a number with a limit, and how to reach that limit."""

    less: bool = False
    more: bool = False
    """The limit itself breaks the rule."""
    exact: bool = True
    """Computed in one way only, with which the last digit counts."""
    at: str = ""
    """The field that leads to the border, if it is not the one that breaks the rule ..."""
    there: float | None = None
    """... and its value there, if that is not the limit."""
    near: float = AT_BORDER
    """What is near, as a share of the limit."""
