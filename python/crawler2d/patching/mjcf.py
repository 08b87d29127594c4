"""Wheels of an MJCF: places, sizes, masses and limits in its text."""

from __future__ import annotations

from typing import NoReturn

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Pose
from crawler2d.models.tree import Link, Tree
from crawler2d.patching.changes import Change
from crawler2d.writing.document import Document, written
from crawler2d.writing.spans import Span
from crawler2d.writing.xml import numbers

__all__ = ["change_mjcf"]

_NOT_ROUND = ("box", "mesh", "ellipsoid", "plane", "hfield")
_INHERITED = ("class", "friction", "condim", "priority", "contype", "conaffinity", "solref")


def change_mjcf(document: Document, scope: Span, change: Change, tree: Tree) -> None:
    """Change a wheel; the arguments are those of `change_urdf`."""
    every = [each for each in scope.within() if each.tag == "body" and each.name in change.links]
    if len(every) != len(change.links):
        _refuse(change.link, "no name", "must have a name, to be found in the text")
    body = next(each for each in every if each.name == change.link)
    if change.shift.any():
        if body.parent is not None and body.parent.tag == "frame":
            _refuse(change.link, "a <frame>", "must stand in another body itself, to be moved")
        shift = tree.by_name[change.joint.parent].pose.turn.T @ change.shift
        document.add_to(body, shift.tolist(), "pos")
    for each in every:
        _change_body(document, each, change, tree.by_name[each.name])
    motors = [
        each
        for each in scope.within()
        if each.attributes.get("joint") == change.joint.name and "actuator" in _above(each)
    ]
    for motor in motors:
        _change_motor(document, motor, change)
    has_rotor = any("armature" in each.attributes for each in (*motors, *body.all("joint")))
    for joint in body.all("joint"):
        document.multiply(joint, [change.effort] * 2, "actuatorfrcrange")
        document.multiply(joint, [change.inertia], "armature")
        if not has_rotor and change.joint.armature > 0.0 and change.inertia != 1.0:  # by a class
            rotor = change.inertia * change.joint.armature
            document.set_attribute(joint, "armature", written([rotor]))
    _add_grousers(document, body, change, tree.by_name[change.link].pose)


def _above(span: Span) -> list[str]:
    return [] if span.parent is None else [span.parent.tag, *_above(span.parent)]


def _change_motor(document: Document, motor: Span, change: Change) -> None:
    """Change what a motor can do; that of a `motor` without a limit of force is its gear."""
    if "forcerange" in motor.attributes or motor.tag != "motor":
        document.multiply(motor, [change.effort] * 2, "forcerange")
    elif change.effort != 1.0:
        gear = motor.attributes.get("gear", "1").split()
        document.set_attribute(
            motor, "gear", " ".join([written([float(gear[0]) * change.effort]), *gear[1:]])
        )
    if motor.tag in ("velocity", "intvelocity"):
        document.multiply(motor, [1.0 / change.size] * 2, "ctrlrange")
    for name in ("kv", "armature"):
        document.multiply(motor, [change.inertia], name)


def _change_body(document: Document, body: Span, change: Change, link: Link) -> None:
    inertial = body.only("inertial")
    if inertial is not None:
        document.multiply(inertial, [change.share], "mass")
        for name, count in (("diaginertia", 3), ("fullinertia", 6)):
            document.multiply(inertial, [change.inertia] * count, name, is_exact=True)
    geoms = [geom for geom in body.all("geom") if geom.attributes.get("type") not in _NOT_ROUND]
    for geom in geoms:
        if "size" in geom.attributes:
            document.multiply(geom, [change.round_size], "size")
        elif change.round_size != 1.0:
            (shape,) = link.shapes if len(link.shapes) == len(geoms) == 1 else (None,)
            if shape is None:
                _refuse(body.name, "geoms of a class", "must state the sizes of its wheels")
            sizes = [change.round_size * shape.radius, 0.5 * shape.length]
            document.set_attribute(geom, "size", written(sizes))
    if inertial is None and (change.share, change.round_size) != (1.0, 1.0) and link.mass > 0.0:
        if len(body.all("geom")) != 1:
            _refuse(body.name, "no <inertial>", "must state its mass, for wheels to share it")
        document.set_attribute(body.all("geom")[0], "mass", written([change.share * link.mass]))


def _refuse(body: str, value: str, rule: str) -> NoReturn:
    raise ScenarioError(f"body[{body}]", value, rule)


def _add_grousers(document: Document, body: Span, change: Change, pose: Pose) -> None:
    geom = body.only("geom")
    alike = {} if geom is None else geom.attributes
    given = "".join(f' {name}="{alike[name]}"' for name in _INHERITED if name in alike)
    for shape, place in change.grousers_on(pose):
        where = f'pos="{written(place.place)}" quat="{numbers(place.quaternion)}"'
        size = f'size="{written(0.5 * shape.size)}"'
        # Its mass is that of the wheel already; without a name, as names must differ.
        document.append(body, f'<geom type="box" {where} {size} mass="0"{given}/>')
