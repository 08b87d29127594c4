"""Round bodies of tracks, and the outlines that they are made of."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from tests.fuzz.rules.fields import Json
from tests.fuzz.rules.hulls import Discs
from tests.fuzz.rules.verdict import Verdict


@dataclass
class Body:
    """[m] A round body of a track: centre, circumscribed radius, bounds of the root radius."""

    x: float
    y: float
    tip: float
    root: tuple[float, float]
    grousers: float = 0.0
    """[m] Height of its grousers."""
    is_sure: bool = True
    """Its place and size are known."""


class Unbuilt(Exception):
    """A model cannot be built, or may be impossible; its verdict says why."""


def must(kept: bool) -> None:
    """Continue only if a rule is obeyed."""
    if not kept:
        raise Unbuilt


def round_bodies(discs: Any) -> list[Body]:
    """Bodies without grousers."""
    return [Body(x, y, radius, (radius, radius)) for x, y, radius in discs]


@dataclass
class Outline:
    """[m] Discs in the direction of x, and the grousers round them."""

    discs: Discs
    given: Json
    takes_more_wheels: bool = False
    """Small wheels all round are added where there are too few to touch."""

    @property
    def height(self) -> float:
        """[m] Of the grousers."""
        return float(self.given["grouser_height"])

    @property
    def smallest(self) -> float:
        """[m] The smallest radius."""
        return min(disc[2] for disc in self.discs)

    def count(self, length: float, bounds: tuple[int, int], v: Verdict) -> int:
        """Number of grousers on a belt of a length, at their pitch."""
        pitch, (least, most) = float(self.given["grouser_pitch"]), bounds
        path, rule = "robot.outline.grouser_pitch", f"at most {most} pitches on a belt"
        must(v.at_least(rule, path, pitch, length / (most + 0.5), exact=False))
        near = length / pitch
        if abs(near - math.floor(near) - 0.5) < 1e-9:
            v.doubt("the nearest number of grousers", path)
        return max(least, round(near))
