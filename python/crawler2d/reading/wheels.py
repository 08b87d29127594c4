"""What turns on a joint is a wheel: round about it, or round with grousers."""

from __future__ import annotations

from crawler2d.models.tree import Joint, Link, Shape, Tree
from crawler2d.reading.grousers import grousers_on
from crawler2d.reading.rounds import radius_about

__all__ = ["wheel_of"]


def wheel_of(tree: Tree, joint: Joint, hanging: dict[str, list[str]]) -> list[tuple[Link, Shape]]:
    """Return the shapes of the wheel that turns on a joint; none if what turns on it is no wheel.

    A wheel turns without limit, and everything that turns with it is round about its axis, or a
    grouser of equal ones evenly round it.
    """
    names = hanging[joint.child]
    if not joint.is_unlimited or any(not tree.joints[n].is_locked for n in names[1:]):
        return []
    links = tree.by_name
    found = [(links[n], shape) for n in names for shape in links[n].shapes]
    shapes = [shape for _, shape in found]
    is_round = all(radius_about(s, joint.place, joint.axis) is not None for s in shapes)
    return found if is_round or grousers_on(shapes, joint) is not None else []
