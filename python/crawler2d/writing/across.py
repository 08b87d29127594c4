"""What three dimensions need and a side view does not have: how wide things are, and where."""

from __future__ import annotations

from dataclasses import dataclass

from crawler2d.common.arrays import real_number
from crawler2d.errors import ScenarioError

__all__ = ["Across", "across_of"]

# Of the gauge, and of the track: those of Absolem's public model are 97 mm wide at a gauge of
# 397 mm, and those of its flippers half as wide, against the outside of the tracks.
_TRACK = 0.25
_FLIPPER = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class Across:
    """Widths and lateral places.

    Parameters
    ----------
    gauge : float
        [m] Lateral distance between the middles of the tracks.
    track_width, chassis_width, flipper_width : float
        [m] Their widths.
    """

    gauge: float
    track_width: float
    chassis_width: float
    flipper_width: float

    @property
    def flippers(self) -> float:
        """[m] Lateral place of the left flippers: outside, against the track."""
        return 0.5 * (self.gauge + self.track_width + self.flipper_width)


def across_of(gauge: float, track_width: float | None, chassis_width: float | None) -> Across:
    """Return the widths that are given, and estimates for the others.

    Raises
    ------
    ScenarioError
        If a width is not a number above 0, or the tracks would meet in the middle.
    """
    track = _TRACK * gauge if track_width is None else real_number(track_width, "track_width")
    if not 0.0 < track < gauge:
        rule = f"must be above 0 and less than robot.gauge = {gauge:g} m"
        raise ScenarioError("track_width", track, rule)
    chassis = gauge - track
    if chassis_width is not None:
        chassis = real_number(chassis_width, "chassis_width")
    if not 0.0 < chassis <= 100.0:
        raise ScenarioError("chassis_width", chassis, "must be above 0 and at most 100 m")
    return Across(
        gauge=gauge,
        track_width=track,
        chassis_width=chassis,
        flipper_width=_FLIPPER * track,
    )
