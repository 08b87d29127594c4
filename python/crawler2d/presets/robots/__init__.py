"""Presets: robots of the literature, every figure with its source or marked as an estimate.

Figures read from a file name file and line, as ``marv.sdf:521``; those that are sums name what was
summed. The files, unchanged, are in ``tests/robots`` of the project, whose README says where each
is from; the tests compare them with the presets.
"""

from crawler2d.presets.robots.absolem import absolem
from crawler2d.presets.robots.engineer import engineer
from crawler2d.presets.robots.gazebo import gz_tracked_vehicle
from crawler2d.presets.robots.marv import marv

__all__ = ["absolem", "engineer", "gz_tracked_vehicle", "marv"]
