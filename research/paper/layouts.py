"""The layouts of the paper's figures as models, and which of them stands for which of its rows.

Which stands for which follows from the text of the paper, not from what comes out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from crawler2d.parameters.track import CircumferentialWheels, GearWheel, LineOfWheels, Track
from crawler2d.presets.robots import engineer
from research.models import study_models
from research.paper.published import CWA_GEAR, CWA_ROUND, LWA_GEAR, LWA_ROUND, REAL_ROBOT

if TYPE_CHECKING:
    from crawler2d.parameters.robot import Robot

__all__ = [
    "GEAR_MODEL",
    "GEAR_MODEL_OTHERWISE",
    "READINGS",
    "Layout",
    "Reading",
    "layouts",
]

_SPACED_GEARS = "16 gears all round, spaced"

GEAR_MODEL = "model with gear wheels"
"""The last column of the paper's Table 2."""

GEAR_MODEL_OTHERWISE = "model with gear wheels, read otherwise"
"""The same column: its text does not say which of its two models with gear wheels is meant."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """A model of the track of the Engineer with its flippers."""

    track: Track
    source: str
    """Figure or section of the paper, or "ours"."""
    arms: Track | None = None
    """The track of the flippers; None takes the model of the robot's."""

    def on(self, robot: Robot) -> Robot:
        """Put it on a robot, and on its flippers if it has some."""
        arms = robot.flippers
        arms = None if arms is None else replace(arms, track=self.arms)
        return replace(robot, track=self.track, flippers=arms)


@dataclass(frozen=True, slots=True, kw_only=True)
class Reading:
    """Which layout stands for a row or a column of the paper."""

    row: str
    """As in the paper's tables."""
    layout: str
    """One of `layouts`."""
    reason: str
    """From the text of the paper alone."""


READINGS = (
    Reading(
        row=CWA_ROUND,
        layout="16 all round, spaced",
        reason="section 3 starts from Fig. 7: small wheels, spaced",
    ),
    Reading(
        row=LWA_ROUND,
        layout="line of 3",
        reason="Fig. 3 is by the same team, and eq. (1) turns the wheels by thirds",
    ),
    Reading(
        row=CWA_GEAR,
        layout=_SPACED_GEARS,
        reason="section 3 replaces the wheels of Fig. 7 by gears of the same size (Fig. 12)",
    ),
    Reading(
        row=LWA_GEAR,
        layout="line of 3 gears",
        reason="the line of large wheels, with gears instead (Fig. 13)",
    ),
    Reading(
        row=GEAR_MODEL,
        layout="line of 3 gears",
        reason="the model that the paper ends up with (Fig. 13)",
    ),
    Reading(
        row=GEAR_MODEL_OTHERWISE,
        layout=_SPACED_GEARS,
        reason="Figs. 15 to 17, of these fields, show small gears all round",
    ),
    Reading(
        row=REAL_ROBOT,
        layout="belt with grousers",
        reason="our choice: it has the outline and the grousers of the robot",
    ),
)
"""From the text; all other layouts stand beside them as ours."""


def layouts() -> dict[str, Layout]:
    """List all layouts by name: the track models of the study, and small gears with spaces.

    The flippers take the model of the robot. Wheels that touch on the robot, or are placed by hand,
    have no place on an arm that tapers: there a line of four wheels takes theirs, which is about
    where four touch.

    Examples
    --------
    >>> layouts()["16 all round, spaced"].source
    'Fig. 7'
    """
    models = study_models(engineer().outline.axle_distance)
    four, gears = LineOfWheels(4), LineOfWheels(4, wheel=GearWheel())
    arms = {"line of 4, touching": four, "hybrid": four, "hybrid gears": gears}
    spaced = CircumferentialWheels(16, wheel_radius=0.02, wheel=GearWheel())
    return {
        **{
            name: Layout(track=model.track, source=model.source, arms=arms.get(name))
            for name, model in models.items()
        },
        _SPACED_GEARS: Layout(track=spaced, source="Fig. 12"),
    }
