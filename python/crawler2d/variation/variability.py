"""Ranges of what varies between runs of one robot on one ground, for `vary` of sweeps.

A rate over them is the fraction of many attempts of the same robot that would succeed.

>>> import crawler2d as c2d
>>> c2d.variability.of_start() | c2d.variability.of_contact()
Ranges
  start.approach: Shifted(low=-0.125, high=0.125, unit='robot.outline.axle_distance', minimum=0.0)
      a quarter of the axle distance: the wheel spacing of a line of five
  start.track_phase: Shifted(low=0.0, high=1.0, unit='robot.outline.grouser_pitch')
      one grouser pitch, after which the track looks the same
  drive.speed: Scaled(low=0.98, high=1.02)
      estimate: how well a controller holds a speed
  terrain.friction: Scaled(low=0.98, high=1.02)
      estimate: patches of one floor
"""

from __future__ import annotations

from crawler2d.variation.distributions import Ranges, scaled, shifted, uniform_int

__all__ = ["of_contact", "of_field", "of_start"]


def __dir__() -> list[str]:
    """List what is public, for completion."""
    return sorted(__all__)


def of_start() -> Ranges:
    """Vary where the robot meets the obstacle: its approach, and the phase of its track.

    Returns
    -------
    Ranges
        For `vary`. The lengths are those of the sweep's scenario, the same for every cell.

    Examples
    --------
    >>> list(of_start())
    ['start.approach', 'start.track_phase']
    """
    approach = shifted(-0.125, 0.125, unit="robot.outline.axle_distance", minimum=0.0)
    spacing = "a quarter of the axle distance: the wheel spacing of a line of five"
    phase = shifted(0.0, 1.0, unit="robot.outline.grouser_pitch")
    pitch = "one grouser pitch, after which the track looks the same"
    ranges = {"start.approach": (approach, spacing), "start.track_phase": (phase, pitch)}
    return Ranges.with_sources(ranges, optional=True)


def of_contact() -> Ranges:
    """Vary how the robot meets the ground: its speed, and the friction of a patch of the floor.

    Returns
    -------
    Ranges
        For `vary`. The mean friction of the floor is not included: it is constant but rarely known;
        see `unknowns.of_ground`.

    Examples
    --------
    >>> list(of_contact())
    ['drive.speed', 'terrain.friction']
    """
    ranges = {
        "drive.speed": (scaled(0.98, 1.02), "estimate: how well a controller holds a speed"),
        "terrain.friction": (scaled(0.98, 1.02), "estimate: patches of one floor"),
    }
    return Ranges.with_sources(ranges, optional=True)


def of_field() -> Ranges:
    """Vary the heights of a random step field: every run gets its own field.

    Returns
    -------
    Ranges
        For `vary`. Terrains without a seed are not changed.

    Examples
    --------
    >>> list(of_field())
    ['terrain.seed']
    """
    seeds = uniform_int(0, 2**31 - 1), "any field of the same measures"
    return Ranges.with_sources({"terrain.seed": seeds}, optional=True)
