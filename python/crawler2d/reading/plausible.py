"""Of a tree, what no robot has: wheels and tracks without a shape, and inertias without a body."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.models.tree import Link, Tree
from crawler2d.reading.parts import farthest
from crawler2d.reading.plugins import moved_links
from crawler2d.reading.rounds import below, radius_about
from crawler2d.reading.surfaces import surfaces_of
from crawler2d.reading.telling import Doubt, named
from crawler2d.reading.wheels import wheel_of

__all__ = ["bounded", "refuse_unread", "size_of"]

_UPRIGHT = 0.5  # [-] Upward part of an axis from which it is no axle, but that of a lidar, say.

_SHOWN = 5  # names of links
_LIGHT = 0.01  # [-] Share of the robot's mass below which a link is light.
_MATTERS = 0.01  # [-] Share of the robot's moment of inertia from which a false one is doubted.


def refuse_unread(tree: Tree) -> None:
    """Refuse a model if what touches the ground would have to be guessed.

    What was left out may be a wheel or a track if the link has no other shape, and its surface
    moves, or it turns without limit on an axle that is no higher than the wheels are. If nothing
    that was read turns on an axle or is a track, it may be any link.

    Parameters
    ----------
    tree : Tree
        The model.

    Raises
    ------
    ScenarioError
        If there is such a link; it names what was left out, why, and what to do.
    """
    lacking = {link.name: link for link in tree.links if link.unread and not link.shapes}
    moved = moved_links(tree)
    hanging = below(tree)
    tops = list(_tops(tree, hanging))
    if not tops:
        _refuse_bare(tree, hanging)
    if not lacking:
        return
    suspects = [link for name, link in lacking.items() if name in moved]
    links = tree.by_name
    is_on_wheels = bool(tops)  # or would be, if what turns were round
    for child, joint in tree.joints.items():
        if joint.is_unlimited and abs(joint.axis[2]) <= _UPRIGHT:
            turning = [links[name] for name in hanging[child]]
            if any(link.shapes for link in turning):
                is_on_wheels = True
            elif joint.place[2] <= max(tops, default=np.inf):
                suspects += [link for link in turning if link.unread]
    if not suspects and not is_on_wheels:
        suspects = list(lacking.values())
    if suspects:
        _refuse(list(dict.fromkeys(link.name for link in suspects)), lacking)


def _refuse_bare(tree: Tree, hanging: dict[str, list[str]]) -> None:
    """Refuse a model whose wheels are only seen."""
    links = tree.by_name
    bare = [
        links[child]
        for child, joint in tree.joints.items()
        if joint.is_unlimited
        and not any(links[name].shapes or links[name].unread for name in hanging[child])
    ]
    if bare:
        others = f"; so must {named([link.name for link in bare[1:]], _SHOWN)}" if bare[1:] else ""
        rule = (
            f"must have a collision shape, for what is only seen touches no ground{others}: give"
            " each the cylinder that is seen, and a mass"
        )
        raise ScenarioError(f"{bare[0].at}: link[{bare[0].name}]", "no collision shape", rule)


def _tops(tree: Tree, hanging: dict[str, list[str]]) -> Iterator[float]:
    """[m] Yield how high each wheel and each drum reaches that was read."""
    for joint in tree.joints.values():
        for _, shape in wheel_of(tree, joint, hanging):
            yield float(joint.place[2]) + (radius_about(shape, joint.place, joint.axis) or 0.0)
    for shape in surfaces_of(tree).moved:
        if shape.radius > 0.0:
            yield float(shape.pose.place[2]) + shape.radius


def _refuse(names: list[str], links: dict[str, Link]) -> None:
    link = links[names[0]]
    unread = link.unread[0]
    others = f"; so must {named(names[1:], _SHOWN)}" if len(names) > 1 else ""
    rule = (
        "must have a collision shape that can be read, for it may be a wheel or a track, which"
        f" nothing may guess ({unread.reason}){others}: put its mesh there, give it a cylinder or a"
        " box, or name links whose surface moves with tracks="
    )
    raise ScenarioError(f"{unread.at}: link[{link.name}]", unread.name, rule)


def bounded(tree: Tree, doubts: list[Doubt]) -> Tree:
    """Return the tree with no moment of inertia that its mass cannot have inside of the robot.

    One that is larger is doubted, and scaled down to that of the mass on the outermost point of the
    robot if the link is light and no wheel: files have such where somebody took a figure that an
    engine does not stumble over. Heavy links, and what turns without limit, keep what their file
    states. As long as all of them together make no difference to the robot, they stay as they are.

    Parameters
    ----------
    tree : Tree
        The model.
    doubts : list of Doubt
        Where they are noted, the worst with its line.
    """
    if not any(link.shapes for link in tree.links):
        return tree
    size = size_of(tree)
    whole = sum(link.mass for link in tree.links)
    hanging = below(tree)
    turning = {n for child, j in tree.joints.items() if j.is_unlimited for n in hanging[child]}
    links = []
    false: dict[bool, list[tuple[float, float, Link]]] = {True: [], False: []}
    for link in tree.links:
        largest = float(np.linalg.eigvalsh(link.inertia)[-1])
        most = link.mass * size**2
        scale = 1.0
        if largest > most * (1.0 + 1e-6):
            is_light = link.mass < _LIGHT * whole
            if not is_light or link.name not in turning:
                false[is_light].append((largest, most, link))
                scale = most / largest if is_light else 1.0
        links.append(replace(link, inertia=scale * link.inertia))
    is_same = _largest_moment(tree.links) <= (1.0 + _MATTERS) * _largest_moment(links)
    for is_light, found in false.items():
        if not found or (is_light and is_same):
            continue
        largest, most, worst = max(found, key=lambda each: each[0])
        others = [link.name for _, _, link in found if link is not worst]
        reason = (
            f"is {f'taken as {most:.3g} kg m^2' if is_light else 'kept'}, but {worst.mass:.3g} kg"
            f" have at most {most:.3g} kg m^2 within {size:.3g} m, the reach of the robot"
            f"{f'; likewise those of {named(others, _SHOWN)}' if others else ''}"
        )
        doubts.append((f"{worst.mass_at}: link[{worst.name}]/inertia", largest, reason))
    return tree if is_same else replace(tree, links=tuple(links))


def _largest_moment(links: Sequence[Link]) -> float:
    """[kg m^2] Return the largest moment of inertia of all links together."""
    mass = np.array([link.mass for link in links])
    away = np.array([link.center for link in links])
    away -= mass @ away / mass.sum() if mass.sum() > 0.0 else 0.0
    swung = (mass * (away**2).sum(axis=1)).sum() * np.eye(3) - (mass * away.T) @ away
    return float(np.linalg.eigvalsh(swung + sum(link.inertia for link in links))[-1])


def size_of(tree: Tree) -> float:
    """[m] Return how far any shape or centre of mass is from the middle of all shapes.

    There must be a shape.
    """
    shapes = [shape for link in tree.links for shape in link.shapes]
    middle = np.mean([shape.pose.place for shape in shapes], axis=0)
    centers = [float(np.linalg.norm(link.center - middle)) for link in tree.links]
    return max(*(farthest(shape, middle) for shape in shapes), *centers)
