"""Wheels of a URDF: places, sizes, masses and limits in its text."""

from __future__ import annotations

from crawler2d.models.poses import Pose
from crawler2d.models.tree import Tree
from crawler2d.patching.changes import Change
from crawler2d.writing.document import Document, written
from crawler2d.writing.spans import Span, joint_in, links_in
from crawler2d.writing.xml import numbers

__all__ = ["change_urdf"]

_ROUNDS = ("cylinder", "sphere", "capsule")


def change_urdf(document: Document, scope: Span, change: Change, tree: Tree) -> None:
    """Change a wheel.

    Parameters
    ----------
    document : Document
        The text.
    scope : Span
        The element in which its links and joints are.
    change : Change
        What becomes of it.
    tree : Tree
        The model as it was read.
    """
    joint = joint_in(scope, change.joint.name)
    if change.shift.any():
        shift = tree.by_name[change.joint.parent].pose.turn.T @ change.shift
        origin = joint.only("origin")
        if origin is None:
            document.append(joint, f'<origin xyz="{written(shift)}"/>')
        else:
            document.add_to(origin, shift.tolist(), "xyz")
    limit = joint.only("limit")
    document.multiply(limit, [change.effort], "effort")
    document.multiply(limit, [1.0 / change.size], "velocity")
    for link in links_in(scope, change.links):
        document.multiply(link.only("inertial/mass"), [change.share], "value")
        inertia = link.only("inertial/inertia")
        for name in inertia.attributes if inertia is not None else ():
            document.multiply(inertia, [change.inertia], name, is_exact=True)
        for shape in link.all("collision", "visual"):
            for each in (shape.only(f"geometry/{kind}") for kind in _ROUNDS):
                document.multiply(each, [change.round_size], "radius")
        if link.name == change.link:
            _add_grousers(document, link, change, tree.by_name[change.link].pose)


def _add_grousers(document: Document, link: Span, change: Change, pose: Pose) -> None:
    for shape, place in change.grousers_on(pose):
        origin = f'<origin xyz="{written(place.place)}" rpy="{numbers(place.rpy)}"/>'
        box = f'<geometry><box size="{written(shape.size)}"/></geometry>'
        for tag in ("collision", "visual"):
            document.append(link, f'<{tag} name="{shape.name}_{tag}">{origin}{box}</{tag}>')
