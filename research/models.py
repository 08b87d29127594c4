"""The track models of the seizure study, each with its source in the paper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from crawler2d.parameters.track import (
    BeltTrack,
    CircumferentialWheels,
    ForceTrack,
    GearWheel,
    GrouserBeltTrack,
    HybridWheels,
    LineOfWheels,
    RoundWheel,
    SegmentalTrack,
    Track,
)
from research.paper.published import CWA_GEAR, CWA_ROUND, LWA_GEAR, LWA_ROUND

__all__ = ["StudyModel", "gear_pairs", "study_models"]


@dataclass(frozen=True, slots=True, kw_only=True)
class StudyModel:
    """A track model and where it comes from."""

    track: Track
    source: str
    """Figure or section of the paper, or "ours"."""
    row: str | None = None
    """The row of the paper's Table 3 with this kind of model; None if there is none."""


def study_models(axle_distance: float) -> dict[str, StudyModel]:
    """List the track models of the study by name.

    Parameters
    ----------
    axle_distance : float
        [m] Axle distance of the robot; in a line of four, wheels of a sixth of it touch.

    Returns
    -------
    dict of str to StudyModel
        The models, in the order of the tables.

    Examples
    --------
    >>> study_models(0.365)["line of 3"].source
    'Fig. 3'
    """
    gear = GearWheel()
    end, low = 0.5 * axle_distance, -0.034
    hybrid = (
        (-end, 0.0, 0.064),
        (-0.07, low, 0.03),
        (0.0, low, 0.03),
        (0.07, low, 0.03),
        (end, 0.0, 0.064),
    )
    return {
        "belt": StudyModel(track=BeltTrack(), source="ours"),
        "belt with grousers": StudyModel(track=GrouserBeltTrack(), source="ours"),
        "chain of 22 shoes": StudyModel(
            track=SegmentalTrack(shoe_count=22), source="2.3, Figs. 9, 10"
        ),
        "force on skids": StudyModel(track=ForceTrack(), source="2.1"),
        "force on wheels": StudyModel(track=ForceTrack(support="wheels"), source="2.1"),
        "line of 3": StudyModel(track=LineOfWheels(3), source="Fig. 3", row=LWA_ROUND),
        "line of 4, touching": StudyModel(
            track=LineOfWheels(4, wheel_radius=axle_distance / 6.0), source="Fig. 2", row=LWA_ROUND
        ),
        "line of 5": StudyModel(track=LineOfWheels(5), source="Fig. 1", row=LWA_ROUND),
        "line of 9": StudyModel(track=LineOfWheels(9), source="Fig. 1", row=LWA_ROUND),
        "line of 3 gears": StudyModel(
            track=LineOfWheels(3, wheel=gear), source="Figs. 11, 13", row=LWA_GEAR
        ),
        "line of 5 gears": StudyModel(
            track=LineOfWheels(5, wheel=gear), source="Figs. 11, 13", row=LWA_GEAR
        ),
        "24 all round": StudyModel(
            track=CircumferentialWheels(24), source="Figs. 5, 6", row=CWA_ROUND
        ),
        "24 gears all round": StudyModel(
            track=CircumferentialWheels(24, wheel=gear), source="Fig. 12", row=CWA_GEAR
        ),
        "16 all round, spaced": StudyModel(
            track=CircumferentialWheels(16, wheel_radius=0.02), source="Fig. 7", row=CWA_ROUND
        ),
        "hybrid": StudyModel(track=HybridWheels(hybrid), source="Fig. 8"),
        "hybrid gears": StudyModel(track=HybridWheels(hybrid, wheel=gear), source="ours"),
    }


def gear_pairs(models: Mapping[str, StudyModel]) -> dict[str, str]:
    """Pair each model with gear wheels with the same model with round wheels.

    Parameters
    ----------
    models : mapping of str to StudyModel
        Models by name.

    Returns
    -------
    dict of str to str
        From the name of each model with gear wheels to that with round ones.

    Examples
    --------
    >>> gear_pairs(study_models(0.365))["line of 3 gears"]
    'line of 3'
    """
    names = {model.track: name for name, model in models.items()}
    pairs = {}
    for name, model in models.items():
        track = model.track
        if not isinstance(track, (LineOfWheels, CircumferentialWheels, HybridWheels)):
            continue
        if not isinstance(track.wheel, GearWheel):
            continue
        twin = names.get(replace(track, wheel=RoundWheel()))
        if twin is not None:
            pairs[name] = twin
    return pairs
