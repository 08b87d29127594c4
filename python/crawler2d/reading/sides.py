"""Left and right as one: what stands on both sides at the same place of the side view."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Array
from crawler2d.models.where import Where
from crawler2d.reading.parts import Runner

__all__ = ["Pair", "centers", "is_belted", "middle_of", "paired"]

_MOST = 400  # wheels of one track, on both sides: any two are compared


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Pair:
    """A wheel or drum on the left, and the one at the same place on the right.

    Parameters
    ----------
    left, right : tuple of Runner
        One of each, or more where several stand side by side.
    x, y, radius : float
        [m] Mean of both, forward and up.
    """

    left: tuple[Runner, ...]
    right: tuple[Runner, ...]
    x: float
    y: float
    radius: float

    @property
    def both(self) -> tuple[Runner, ...]:
        """All of them."""
        return self.left + self.right


def centers(pairs: Iterable[Pair]) -> Array:
    """[m] Return where pairs stand in side view, shape (n, 2)."""
    return np.array([[pair.x, pair.y] for pair in pairs])


def is_belted(runners: list[Runner], path: str) -> bool:
    """Whether a belt runs round them: drums, and no more wheels among them than sprockets.

    Raises
    ------
    ScenarioError
        If more of them turn than are fixed.
    """
    turning = sum(runner.joint is not None for runner in runners)
    if 0 < len(runners) - turning < turning:
        rule = "must be wheels, or drums of a moved belt and at most one sprocket for each"
        raise ScenarioError(path, f"{turning} wheels and {len(runners) - turning} drums", rule)
    return turning < len(runners)


def middle_of(runners: Iterable[Runner]) -> float:
    """[m] Return where the middle plane lies: halfway between the outermost wheels."""
    across = [runner.z for runner in runners]
    return 0.5 * (min(across) + max(across)) if across else 0.0


def paired(runners: list[Runner], *, middle: float, tolerance: float, at: Where) -> list[Pair]:
    """Pair what is on the left with what is on the right.

    Parameters
    ----------
    runners : list of Runner
        Of one carrier.
    middle : float
        [m] Where the middle plane lies.
    tolerance : float
        [m] By how much places and radii of a pair may differ in side view; across, by any.
    at : Where
        Line of the model, for errors.

    Returns
    -------
    list of Pair
        From the rear to the front.

    Raises
    ------
    ScenarioError
        If a wheel has no partner, or stands in the middle.
    """
    if len(runners) > _MOST:
        raise ScenarioError(str(at), len(runners), f"must have at most {_MOST} wheels a carrier")
    for runner in runners:
        if abs(runner.z - middle) <= tolerance:
            _refuse(runner, "in the middle", "must stand on the left or on the right")
    order = sorted(runners, key=lambda runner: (runner.x, runner.y, runner.radius))
    left = [runner for runner in order if runner.z > middle]
    right = [runner for runner in order if runner.z <= middle]
    pairs: list[Pair] = []
    for runner in left:
        partner = next((other for other in right if _same(runner, other, tolerance)), None)
        if partner is None:
            _refuse(runner, _words(runner), _rule("right", tolerance))
        right.remove(partner)
        beside = next((p for p in pairs if _same(runner, p.left[0], tolerance)), None)
        if beside is not None:  # a double wheel is one wheel in side view
            pairs.remove(beside)
        pairs.append(
            Pair(
                left=(runner, *(beside.left if beside else ())),
                right=(partner, *(beside.right if beside else ())),
                x=0.5 * (runner.x + partner.x),
                y=0.5 * (runner.y + partner.y),
                radius=0.5 * (runner.radius + partner.radius),
            )
        )
    for runner in right:
        _refuse(runner, _words(runner), _rule("left", tolerance))
    return pairs


def _same(first: Runner, second: Runner, tolerance: float) -> bool:
    return (
        abs(first.x - second.x) <= tolerance
        and abs(first.y - second.y) <= tolerance
        and abs(first.radius - second.radius) <= tolerance
    )


def _rule(side: str, tolerance: float) -> str:
    within = f"within {1e3 * tolerance:g} mm: tolerance= may say more"
    return f"must have a partner on the {side}, in side view {within}"


def _words(runner: Runner) -> str:
    return f"radius {runner.radius:.4g} m at x = {runner.x:.4g} m, y = {runner.y:.4g} m"


def _refuse(runner: Runner, value: str, rule: str) -> NoReturn:
    raise ScenarioError(f"{runner.shape.at}: wheel[{runner.name}]", value, rule)
