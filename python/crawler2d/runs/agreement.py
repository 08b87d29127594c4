"""How often both engines ended alike, model by model: what a cross-check is worth."""

from __future__ import annotations

from dataclasses import dataclass

from crawler2d.parameters.robot import Robot
from crawler2d.parameters.track import (
    CircumferentialWheels,
    ForceTrack,
    GearWheel,
    HybridWheels,
    LineOfWheels,
)

__all__ = ["STUDY", "Agreement", "agreement_of"]

STUDY = {
    "force on skids": (128, 128, 32, 32),
    "force on wheels": (128, 128, 32, 32),
    "line of 3": (128, 128, 80, 80),
    "line of 4, touching": (128, 128, 40, 40),
    "line of 5": (128, 128, 120, 120),
    "line of 9": (128, 128, 104, 104),
    "line of 3 gears": (128, 126, 62, 62),
    "line of 5 gears": (128, 126, 98, 100),
    "24 all round": (128, 102, 60, 60),
    "24 gears all round": (128, 93, 49, 70),
    "16 all round, spaced": (128, 128, 16, 16),
    "hybrid": (128, 126, 18, 16),
    "hybrid gears": (128, 117, 69, 78),
}
"""Runs; those in which both got over or neither did; got over in crawler2d; in rapier.

From docs/studies/agreement.md, "The cells of the seizure study"; a test holds both together.
"""

_ERRS = {
    "24 all round": (
        "at steps and a barrier Chipmunk gets over as crawler2d does and rapier stops,"
        " on knife edges Chipmunk and rapier get over where crawler2d stops"
    ),
    "24 gears all round": "at steps Chipmunk gets over as seldom as crawler2d, rapier more often",
}
"""Which way the two differ where a third engine was asked; same page, "as ensembles"."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Agreement:
    """How often both engines ended alike with models of one kind; ``str(...)`` says it.

    Attributes
    ----------
    models : tuple of str
        Those of the study that are of this kind; empty if it has none.
    runs, alike : int
        Number of runs, and of those in which both got over or neither did.
    own, rapier : int
        How many got over in crawler2d's own dynamics, and in rapier's.
    """

    models: tuple[str, ...]
    runs: int
    alike: int
    own: int
    rapier: int

    def __str__(self) -> str:
        """Say how often they ended alike, and which way they differ."""
        if not self.models:
            return "How often both end alike with such a model was not studied"
        kind = " or ".join(self.models)
        said = (
            f"With {kind} in the seizure study both got over or neither did in"
            f" {self.alike} of {self.runs} runs; {self.own} got over in crawler2d's own dynamics,"
            f" {self.rapier} in rapier"
        )
        errs = [_ERRS[model] for model in self.models if model in _ERRS]
        return "; ".join([said, *errs])


def agreement_of(robot: Robot) -> Agreement:
    """Look up how often both engines ended alike with models of the kind of a robot's.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> found = agreement_of(c2d.robots.engineer(track=c2d.CircumferentialWheels(24)))
    >>> found.models, found.alike, found.runs
    (('24 all round',), 102, 128)
    """
    models = _models_like(robot)
    runs, alike, own, rapier = (sum(STUDY[model][k] for model in models) for k in range(4))
    return Agreement(models=models, runs=runs, alike=alike, own=own, rapier=rapier)


def _models_like(robot: Robot) -> tuple[str, ...]:
    """Name the models of the study that are of the kind of a robot's, whatever the numbers."""
    track = robot.track
    if isinstance(track, ForceTrack):
        return ("force on skids", "force on wheels")
    if not isinstance(track, (LineOfWheels, CircumferentialWheels, HybridWheels)):
        return ()
    is_geared = isinstance(track.wheel, GearWheel)
    if isinstance(track, LineOfWheels):
        round_ones = ("line of 3", "line of 4, touching", "line of 5", "line of 9")
        return ("line of 3 gears", "line of 5 gears") if is_geared else round_ones
    if isinstance(track, HybridWheels):
        return ("hybrid gears",) if is_geared else ("hybrid",)
    if track.wheel_radius is not None:
        return () if is_geared else ("16 all round, spaced",)
    return ("24 gears all round",) if is_geared else ("24 all round",)
