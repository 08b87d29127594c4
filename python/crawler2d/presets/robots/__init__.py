"""Robots from the literature: every figure has a source or is marked as an estimate.

The source of a figure from a file is file and line, such as ``marv.sdf:521``; the source of a sum
lists its terms. The unchanged files are in ``tests/robots`` of the project; its README gives their
origin. Tests compare them with the presets.
"""

from crawler2d.presets.robots.engineer import engineer
from crawler2d.presets.robots.gazebo import absolem, gz_tracked_vehicle, marv

__all__ = ["absolem", "engineer", "gz_tracked_vehicle", "marv"]


def __dir__() -> list[str]:
    """List what is public, for completion."""
    return sorted(__all__)
