"""What of a tree is driven: wheels by their radius, belts, and flippers."""

from __future__ import annotations

from dataclasses import dataclass

from crawler2d.models.tree import Joint, Link, Tree

__all__ = ["Limits", "flipper_joints", "moved_links", "wheels_by_radius"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """What the motors of a robot can do together.

    Parameters
    ----------
    speed : float
        [m/s] Largest speed of the tracks.
    acceleration, deceleration : float
        [m/s^2] Largest rates at which the commanded speed rises and falls.
    track_height : float
        [m] From the lower to the upper run.
    """

    speed: float
    acceleration: float
    deceleration: float
    track_height: float


def wheels_by_radius(tree: Tree, limits: Limits) -> list[tuple[float, list[Joint]]]:
    """[m] Return the joints of all wheels, by the radius at which they have the largest speed."""
    found: dict[float, list[Joint]] = {}
    for joint in tree.joints.values():
        if joint.is_unlimited and joint.velocity:
            found.setdefault(joint.velocity, []).append(joint)
    return [(limits.speed / velocity, joints) for velocity, joints in found.items()]


def flipper_joints(tree: Tree) -> list[Joint]:
    """Return the joints that turn flippers."""
    return [
        joint for joint in tree.joints.values() if not joint.is_locked and not joint.is_unlimited
    ]


def moved_links(tree: Tree) -> list[Link]:
    """Return the links whose surface moves."""
    return [link for link in tree.links if any(shape.surface_speed for shape in link.shapes)]
