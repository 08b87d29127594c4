"""Robots of the literature: every figure has its source or is marked as an estimate.

A figure read from a file has file and line as its source, such as ``marv.sdf:521``; for a sum, the
source says what was summed. The unchanged files are in ``tests/robots`` of the project, whose
README says where each is from. Tests compare them with the presets.
"""

from crawler2d.presets.robots.engineer import engineer
from crawler2d.presets.robots.gazebo import absolem, gz_tracked_vehicle, marv

__all__ = ["absolem", "engineer", "gz_tracked_vehicle", "marv"]


def __dir__() -> list[str]:
    """List what is public, for completion."""
    return sorted(__all__)
