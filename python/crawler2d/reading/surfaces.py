"""Surfaces that move: those that a file moves, and drums of a track that stand still in the file.

Many models have fixed cylinders as drums of a track. The belt is then moved by a controller
elsewhere, or by one sprocket among them. Such drums are recognized by their positions, with a
warning: in a simulator that has only the file, they slide.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Shape, Tree
from crawler2d.reading.log import ReadingWarning, list_names
from crawler2d.reading.parts import moved_links
from crawler2d.reading.wheels import (
    UPRIGHT,
    corners_of,
    is_parallel,
    radius_about,
    subtrees,
    wheel_shapes,
)

__all__ = ["Surfaces", "refuse_unread", "surfaces_of"]

_SAME = 0.002
"""[m] Allowed difference in side view between a drum and its partner on the other side."""

_APART = 0.01
"""[m] Drums closer than this count as one: a belt round them would have no length."""

_BELOW = 0.01
"""[m] How far a belly may hang below the drums of a track: less than a boss or a bolt head."""

_HORIZONTAL = 0.02  # largest upward component of a horizontal direction
_SHOWN = 4  # names of links in a warning
_MOST_AXES = 100  # that are compared with all others
_LISTED = 5  # names of links in an error


@dataclass(frozen=True, slots=True, eq=False)
class Surfaces:
    """The shapes whose surface moves.

    Parameters
    ----------
    moved : frozenset of Shape
        All of them, whether found in the file or by a rule of this module.
    taken : frozenset of Shape
        Those found by a rule of this module.
    warnings : tuple of ReadingWarning
        One for each rule that was used.
    """

    moved: frozenset[Shape]
    taken: frozenset[Shape]
    warnings: tuple[ReadingWarning, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Drum:
    """A fixed lateral cylinder, or a wheel; its place is forward, up and lateral."""

    shape: Shape
    link: str
    body: str
    place: Array
    radius: float

    def side(self, middle: float) -> str:
        return "left" if self.place[2] > middle else "right"

    def is_at(self, place: Array, within: float) -> bool:
        return bool(np.abs(self.place[:2] - place[:2]).max() <= within)


def surfaces_of(tree: Tree) -> Surfaces:
    """Find the moving surfaces of a model.

    A fixed drum is a lateral cylinder on one side with a partner on the other. Fixed drums are
    taken as those of a track if either

    - the same body has wheels on the same side, at most one for each drum: sprockets;
    - or nothing on that body turns or moves, and there are at least two drums: on the chassis the
      lowest of all shapes, on a flipper with one on its pivot.
    """
    links = moved_links(tree)
    moved = frozenset(
        shape
        for link in tree.links
        for shape in link.shapes
        if shape.surface_speed > 0.0 or link.name in links
    )
    driven, unmoved = _Search(tree, moved).drums()
    warnings = []
    for drums, reason in (
        (driven, "stand still, unlike the wheel on their side: read as a belt round both"),
        (unmoved, "are not moved by anything in the file: read as the drums of moving belts"),
    ):
        if drums:
            names = list_names(list(dict.fromkeys(drum.link for drum in drums)), _SHOWN)
            value = f"{len(drums)} fixed drums: {names}"
            at = str(drums[0].shape.at)
            warnings.append((at, value, f"{reason}; with this file alone they slide"))
    taken = frozenset(drum.shape for drum in (*driven, *unmoved))
    return Surfaces(taken | moved, taken, tuple(warnings))


def refuse_unread(tree: Tree) -> None:
    """Refuse a model if its contact with the ground would have to be guessed.

    A shape that was left out may be a wheel or a track if its link has no other shape, and if its
    surface moves or it turns without limit on an axle no higher than the wheels. If the model has
    no other wheel or track, it may be on any link.

    Raises
    ------
    ScenarioError
        If there is such a link, with the reason why its shape was left out, and what to do.
    """
    lacking = {link.name: link for link in tree.links if link.unread and not link.shapes}
    moved = moved_links(tree)
    hanging = subtrees(tree)
    tops = list(_tops(tree))
    if not tops:
        _refuse_bare(tree, hanging)
    if not lacking:
        return
    suspects = [link for name, link in lacking.items() if name in moved]
    links = tree.by_name
    is_on_wheels = bool(tops)  # or would be, if its turning parts were round
    for child, joint in tree.joints.items():
        if joint.is_unlimited and abs(joint.axis[2]) <= UPRIGHT:
            turning = [links[name] for name in hanging[child]]
            if any(link.shapes for link in turning):
                is_on_wheels = True
            elif joint.place[2] <= max(tops, default=np.inf):
                suspects += [link for link in turning if link.unread]
    if not suspects and not is_on_wheels:
        suspects = list(lacking.values())
    if suspects:
        names = list(dict.fromkeys(link.name for link in suspects))
        link = lacking[names[0]]
        unread = link.unread[0]
        rule = (
            "must have a collision shape that can be read, as it may be a wheel or a track"
            f" ({unread.reason}){_so_must(names[1:])}: provide its mesh, give it a cylinder or a"
            " box, or name links whose surface moves with tracks="
        )
        raise ScenarioError(f"{unread.at}: link[{link.name}]", unread.name, rule)


class _Search:
    """Finds the drums of tracks among cylinders, by rigid body and side."""

    def __init__(self, tree: Tree, moved: frozenset[Shape]) -> None:
        self.tree = tree
        self.moved = moved
        self.body: dict[str, str] = {}
        for link in tree.links:  # parents before children
            joint = tree.joints.get(link.name)
            is_rigid = joint is not None and joint.kind == "fixed"
            self.body[link.name] = self.body[joint.parent] if joint and is_rigid else link.name
        hanging = subtrees(tree)
        self.wheels = wheel_shapes(tree)
        self.turning = {name for child in self.wheels for name in hanging[child]}

    def drums(self) -> tuple[list[_Drum], list[_Drum]]:
        """Return the drums with sprockets, and those without."""
        axis = self._lateral()
        if axis is None:
            return [], []
        drums, wheels = list(self._drums(axis)), list(self._sprockets(axis))
        across = [each.place[2] for each in wheels or drums]
        middle = 0.5 * (min(across) + max(across)) if across else 0.0
        drums = [drum for drum in drums if abs(drum.place[2] - middle) > 0.5 * drum.shape.length]
        drums = [drum for drum in drums if self._has_partner(drum, drums, middle)]
        driven: list[_Drum] = []
        unmoved: list[_Drum] = []
        for body, side in dict.fromkeys((drum.body, drum.side(middle)) for drum in drums):
            group, own = (
                [each for each in some if each.body == body and each.side(middle) == side]
                for some in (drums, wheels)
            )
            if own:
                apart = [d for d in group if not any(d.is_at(w.place, _APART) for w in own)]
                driven += group if apart and len(own) <= len(apart) else []
            elif self._is_track(body, group, axis):
                unmoved += group
        return driven, unmoved

    def _lateral(self) -> Array | None:
        """Return the direction of most axes of wheels, or else of fixed cylinders."""
        axes = [self.tree.joints[child].axis for child in self.wheels] or [
            shape.axis for _, shape in self._cylinders() if abs(shape.axis[2]) < _HORIZONTAL
        ]
        counts = [sum(is_parallel(axis, other) for other in axes) for axis in axes[:_MOST_AXES]]
        return axes[int(np.argmax(counts))] if axes else None

    def _cylinders(self) -> Iterator[tuple[str, Shape]]:
        for link in self.tree.links:
            if link.name not in self.turning:
                yield from (
                    (link.name, shape)
                    for shape in link.shapes
                    if shape.kind == "cylinder" and shape not in self.moved
                )

    def _drums(self, axis: Array) -> Iterator[_Drum]:
        for name, shape in self._cylinders():
            if is_parallel(shape.axis, axis):
                place = _in_side_view(shape.pose.place, axis)
                yield _Drum(shape, name, self.body[name], place, shape.radius)

    def _sprockets(self, axis: Array) -> Iterator[_Drum]:
        for child, parts in self.wheels.items():
            joint = self.tree.joints[child]
            if is_parallel(joint.axis, axis):
                shape = parts[0][1]
                place = _in_side_view(shape.pose.place, axis)
                radius = radius_about(shape, joint.place, joint.axis) or 0.0
                yield _Drum(shape, child, self.body[joint.parent], place, radius)

    def _has_partner(self, drum: _Drum, drums: list[_Drum], middle: float) -> bool:
        return any(
            other.side(middle) != drum.side(middle)
            and other.is_at(drum.place, _SAME)
            and abs(other.radius - drum.radius) <= _SAME
            for other in drums
        )

    def _is_track(self, body: str, group: list[_Drum], axis: Array) -> bool:
        """Whether drums without a sprocket are those of a track that the file does not move."""
        if not any(not drum.is_at(group[0].place, _APART) for drum in group):
            return False
        joint = self.tree.joints.get(body)
        if joint is not None and joint.kind == "hinge":  # a flipper?
            pivot = _in_side_view(joint.place, axis)
            return is_parallel(joint.axis, axis) and any(d.is_at(pivot, _APART) for d in group)
        return not self._moves(body) and self._is_lowest(body, group)

    def _moves(self, body: str) -> bool:
        """Whether anything turns or moves on the chassis."""
        wheels = (self.body[self.tree.joints[child].parent] for child in self.wheels)
        links = (link for link in self.tree.links if self.body[link.name] == body)
        return body in wheels or any(s in self.moved for link in links for s in link.shapes)

    def _is_lowest(self, body: str, group: list[_Drum]) -> bool:
        foot = min(float(drum.place[1]) - drum.radius for drum in group)
        others = (
            float(corner[2])
            for link in self.tree.links
            if self.body[link.name] == body
            for shape in link.shapes
            if shape.kind in ("box", "hull")
            for corner in corners_of(shape)
        )
        return foot <= min(others, default=foot) + _BELOW


def _in_side_view(place: Array, axis: Array) -> Array:
    """[m] Return the forward, upward and lateral coordinates of a position, shape (3,)."""
    forward = np.cross(axis, (0.0, 0.0, 1.0))
    return np.array([place @ forward, place[2], place @ axis])


def _tops(tree: Tree) -> Iterator[float]:
    """[m] Yield the height of the top of each wheel and drum."""
    for child, parts in wheel_shapes(tree).items():
        joint = tree.joints[child]
        for _, shape in parts:
            yield float(joint.place[2]) + (radius_about(shape, joint.place, joint.axis) or 0.0)
    for shape in surfaces_of(tree).moved:
        if shape.radius > 0.0:
            yield float(shape.pose.place[2]) + shape.radius


def _refuse_bare(tree: Tree, hanging: dict[str, list[str]]) -> None:
    """Refuse a model whose wheels have no collision shapes."""
    links = tree.by_name
    bare = [
        links[child]
        for child, joint in tree.joints.items()
        if joint.is_unlimited
        and not any(links[name].shapes or links[name].unread for name in hanging[child])
    ]
    if bare:
        rule = (
            "must have a collision shape, as visuals do not touch the ground"
            f"{_so_must([link.name for link in bare[1:]])}: give each the cylinder of its visual,"
            " and a mass"
        )
        raise ScenarioError(bare[0].path, "no collision shape", rule)


def _so_must(others: list[str]) -> str:
    return f"; so must {list_names(others, _LISTED)}" if others else ""
