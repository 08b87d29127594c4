"""Wheels of an SDF: places, sizes, masses and limits in its text."""

from __future__ import annotations

from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Array, Pose
from crawler2d.models.tree import Tree
from crawler2d.patching.changes import Change
from crawler2d.reading.frames import MODEL
from crawler2d.writing.document import Document, written
from crawler2d.writing.spans import Span, joint_in, links_in
from crawler2d.writing.xml import numbers

__all__ = ["change_sdf"]

_ROUNDS = ("cylinder", "sphere", "capsule")


def change_sdf(document: Document, scope: Span, change: Change, tree: Tree) -> None:
    """Change a wheel; the arguments are those of `change_urdf`."""
    links = links_in(scope, change.links)
    joint = joint_in(scope, change.joint.name)
    # What is given in the frame of the wheel moves with it; a joint usually is.
    for each, usual in [*((link, MODEL) for link in links), (joint, change.link)]:
        pose = each.only("pose")
        frame = usual if pose is None else pose.attributes.get("relative_to", "") or usual
        if change.shift.any() and frame not in change.links:
            _move(document, each, pose, _turned(change.shift, frame, tree, each))
    limit = joint.only("axis/limit")
    if limit is not None:
        for name, factor in (("effort", change.effort), ("velocity", 1.0 / change.size)):
            value = limit.only(name)
            if value is not None and not value.text.startswith(("-", "inf")):
                document.multiply(value, [factor])
    for link in links:
        if change.share != 1.0 and link.only("inertial/mass") is None:
            _refuse(link, "no mass", "must state its mass, for wheels to share it")
        document.multiply(link.only("inertial/mass"), [change.share])
        inertia = link.only("inertial/inertia")
        for moment in inertia.children if inertia is not None else ():
            document.multiply(moment, [change.inertia], is_exact=True)
        for shape in link.all("collision", "visual"):
            for kind in _ROUNDS:
                document.multiply(shape.only(f"geometry/{kind}/radius"), [change.round_size])
        if link.name == change.link:
            _add_grousers(document, link, change, tree.by_name[change.link].pose)


def _move(document: Document, element: Span, pose: Span | None, shift: Array) -> None:
    if pose is None:
        document.append(element, f"<pose>{written([*shift, 0.0, 0.0, 0.0])}</pose>")
    elif not pose.text:
        document.set_text(pose, written([*shift, 0.0, 0.0, 0.0]))
    else:
        document.add_to(pose, shift.tolist())


def _turned(shift: Array, frame: str, tree: Tree, element: Span) -> Array:
    """[m] Return a shift of the model in the frame in which an element is given."""
    if frame == MODEL:
        return shift
    if frame not in tree.by_name:
        _refuse(element, frame, "must be placed in the frame of a link or of the model")
    turned: Array = np.asarray(tree.by_name[frame].pose.turn.T @ shift)
    return turned


def _refuse(element: Span, value: str, rule: str) -> NoReturn:
    raise ScenarioError(f"{element.tag}[{element.name}]", value, rule)


def _add_grousers(document: Document, link: Span, change: Change, pose: Pose) -> None:
    first = link.only("collision")
    surface = None if first is None else first.only("surface")
    of_wheel = "" if surface is None else document.source(surface)
    for shape, place in change.grousers_on(pose):
        pose_text = f"<pose>{written(place.place)} {numbers(place.rpy)}</pose>"
        box = f"<geometry><box><size>{written(shape.size)}</size></box></geometry>"
        for tag, more in (("collision", of_wheel), ("visual", "")):
            document.append(
                link, f'<{tag} name="{shape.name}_{tag}">{pose_text}{box}{more}</{tag}>'
            )
