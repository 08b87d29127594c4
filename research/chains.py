"""Chains of shoes and the simpler models that replace them: how often each clears a step."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from crawler2d.parameters.track import SegmentalTrack
from crawler2d.presets.robots import engineer
from research.models import StudyModel, study_models
from research.sweeps import FULL, QUICK

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["CHAINS", "CHAINS_QUICK", "chain_models"]

CHAINS = replace(FULL, heights={"step": tuple(0.01 * tens for tens in range(3, 17))}, repeats=40)
"""Steps of 30 to 160 mm."""
CHAINS_QUICK = replace(QUICK, heights={"step": (0.06, 0.10)}, repeats=4)


def chain_models() -> Mapping[str, StudyModel]:
    """List the models; all have the Engineer's grousers.

    Returns
    -------
    mapping of str to StudyModel
        Tracks first, then wheels.
    """
    models = study_models(engineer(flippers=None).outline.axle_distance)
    finer = StudyModel(track=SegmentalTrack(shoe_count=44), source="ours")
    return {
        "belt with grousers": models["belt with grousers"],
        "chain of 22 shoes": models["chain of 22 shoes"],
        "chain of 44 shoes": finer,
        "line of 3 gears": models["line of 3 gears"],
        "24 gears all round": models["24 gears all round"],
    }
