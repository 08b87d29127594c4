"""Edits of wheels in the text of an SDF, a URDF or an MJCF: pose, size, mass, limits, copies."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Link, Pose, Tree
from crawler2d.patching.changes import Change
from crawler2d.reading.sdf import MODEL
from crawler2d.writing.document import Document, Span, joint_in, lengths, links_in
from crawler2d.writing.formats import numbers

__all__ = ["change_mjcf", "change_sdf", "change_urdf", "copy_elements", "items_about", "names_of"]

_NO_NAMES = ("class", "childclass", "material", "mesh", "type", "filename")
"""Attributes whose values are not names of links and joints."""

_WITH_NAMES = ("transmission", "actuator")
"""Elements that are about one joint, and need names of their own."""

_NOT_ROUND = ("box", "mesh", "ellipsoid")
_INHERITED = ("class", "friction", "condim", "priority", "contype", "conaffinity", "solref")
_ROUNDS = ("cylinder", "sphere", "capsule")


def names_of(scope: Span, links: Collection[str], joint: str) -> set[str]:
    """Return the names of a wheel, of the joints of its parts, and in MJCF of all in its bodies."""
    names = {*links, joint}
    for each in scope.within():
        if each.tag == "body" and each.name in links:
            names |= {part.name for part in each.within() if part.name}
        child = each.only("child") if each.tag == "joint" else None
        if child is not None and (child.text or child.attributes.get("link")) in links:
            names.add(each.name)
    return names


def items_about(scope: Span, names: Collection[str]) -> list[Span]:
    """Return the outermost elements that are about a wheel.

    These are its links and joints; elements with one of them in an attribute, such as a motor; a
    transmission with its joint; and of a plugin each setting that is one of its names.

    Parameters
    ----------
    scope : Span
        Where to look.
    names : collection of str
        Of the wheel.
    """
    items = []
    for child in scope.children:
        if _is_about(child, names):
            items.append(child)
        elif child.tag not in ("link", "joint"):
            items += items_about(child, names)
    return items


def copy_elements(
    document: Document,
    items: list[Span],
    names: Mapping[str, str],
    change: Callable[[Document, Span], None],
) -> list[str]:
    """Copy elements, changed and under other names.

    Parameters
    ----------
    document : Document
        In which they are.
    items : list of Span
        As from `items_about`.
    names : mapping of str to str
        The new name of each.
    change : callable
        Changes the copies, together in one element.

    Returns
    -------
    list of str
        The text of each copy.
    """
    # Each keeps its parent: a motor is recognized by its <actuator>.
    tags = [_above(item)[0] for item in items]
    whole = "".join(
        f"<{tag}>{document.source(item)}</{tag}>" for tag, item in zip(tags, items, strict=True)
    )
    first = Document(f"<copies>{whole}</copies>")
    change(first, first.root)
    second = Document(first.text)
    for holder in second.root.children:
        _rename(second, holder.children[0], names)
    third = Document(second.text)
    return [third.source(holder.children[0]) for holder in third.root.children]


def change_mjcf(document: Document, scope: Span, change: Change, tree: Tree) -> None:
    """Change a wheel; the arguments are those of `change_urdf`."""
    every = [each for each in scope.within() if each.tag == "body" and each.name in change.links]
    if len(every) != len(change.links):
        _refuse_body(change.link, "no name", "must have a name, to be found in the text")
    body = next(each for each in every if each.name == change.link)
    if change.shift.any():
        if body.parent is not None and body.parent.tag == "frame":
            _refuse_body(change.link, "a <frame>", "must be in another body itself, to be moved")
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
        document.multiply(joint, [change.rotor], "armature")
        if not has_rotor and change.joint.armature > 0.0 and change.rotor != 1.0:  # by a class
            rotor = change.rotor * change.joint.armature
            document.set_attribute(joint, "armature", lengths([rotor]))
    _add_mjcf_grousers(document, body, change, tree.by_name[change.link].pose)


def change_sdf(document: Document, scope: Span, change: Change, tree: Tree) -> None:
    """Change a wheel; the arguments are those of `change_urdf`."""
    joint = joint_in(scope, change.joint.name)
    links = [(link, MODEL) for link in links_in(scope, change.links)]
    # Parts in the frame of the wheel move with it; a joint usually does.
    for each, usual in [*links, (joint, change.link)]:
        pose = each.only("pose")
        frame = usual if pose is None else pose.attributes.get("relative_to", "") or usual
        if change.shift.any() and frame not in change.links:
            _move(document, each, pose, _rotate_shift(change.shift, frame, tree, each))
    limit = joint.only("axis/limit")
    for name, factor in (("effort", change.effort), ("velocity", 1.0 / change.size)):
        value = None if limit is None else limit.only(name)
        if value is not None and not value.text.startswith(("-", "inf")):
            document.multiply(value, [factor])
    _change_links(document, scope, change, tree, is_urdf=False)


def change_urdf(document: Document, scope: Span, change: Change, tree: Tree) -> None:
    """Change a wheel.

    Parameters
    ----------
    document : Document
        The text.
    scope : Span
        The element in which its links and joints are.
    change : Change
        The change.
    tree : Tree
        The model as it was read.
    """
    joint = joint_in(scope, change.joint.name)
    if change.shift.any():
        shift = tree.by_name[change.joint.parent].pose.turn.T @ change.shift
        origin = joint.only("origin")
        if origin is None:
            document.append(joint, f'<origin xyz="{lengths(shift)}"/>')
        else:
            document.add_to(origin, shift.tolist(), "xyz")
    limit = joint.only("limit")
    document.multiply(limit, [change.effort], "effort")
    document.multiply(limit, [1.0 / change.size], "velocity")
    _change_links(document, scope, change, tree, is_urdf=True)


def _is_about(span: Span, names: Collection[str]) -> bool:
    if any(value in names for key, value in span.attributes.items() if key not in _NO_NAMES):
        return True
    if span.tag == "transmission":
        return any(joint.name in names for joint in span.all("joint"))
    return not span.children and span.text in names


def _rename(document: Document, item: Span, names: Mapping[str, str]) -> None:
    suffix = next(new.removeprefix(old) for old, new in names.items())
    for span in item.within():
        for key, value in span.attributes.items():
            if value in names and key not in _NO_NAMES:
                document.set_attribute(span, key, names[value])
            elif key == "name" and (span.tag in _WITH_NAMES or (span is item and _is_mjcf(span))):
                document.set_attribute(span, key, value + suffix)
        if not span.children and span.text in names:
            document.set_text(span, names[span.text])


def _is_mjcf(item: Span) -> bool:
    """Whether it is a motor, a sensor or an exclusion, which MJCF names one by one."""
    return _above(item)[0] in ("actuator", "sensor", "contact", "tendon", "equality")


def _refuse_body(body: str, value: str, rule: str) -> NoReturn:
    raise ScenarioError(f"body[{body}]", value, rule)


def _change_body(document: Document, body: Span, change: Change, link: Link) -> None:
    inertial = body.only("inertial")
    if inertial is not None:
        document.multiply(inertial, [change.mass], "mass")
        for name, count in (("diaginertia", 3), ("fullinertia", 6)):
            document.multiply(inertial, [change.inertia] * count, name, is_exact=True)
    geoms = [geom for geom in body.all("geom") if geom.attributes.get("type") not in _NOT_ROUND]
    for geom in geoms:
        if "size" in geom.attributes:
            document.multiply(geom, [change.round_size], "size")
        elif change.round_size != 1.0:
            (shape,) = link.shapes if len(link.shapes) == len(geoms) == 1 else (None,)
            if shape is None:
                _refuse_body(body.name, "geoms of a class", "must state the sizes of its wheels")
            sizes = [change.round_size * shape.radius, 0.5 * shape.length]
            document.set_attribute(geom, "size", lengths(sizes))
    if inertial is None and (change.mass, change.round_size) != (1.0, 1.0) and link.mass > 0.0:
        if len(body.all("geom")) != 1:
            _refuse_body(body.name, "no <inertial>", "must state its mass, for wheels to share it")
        document.set_attribute(body.all("geom")[0], "mass", lengths([change.mass * link.mass]))


def _above(span: Span) -> list[str]:
    return [] if span.parent is None else [span.parent.tag, *_above(span.parent)]


def _change_motor(document: Document, motor: Span, change: Change) -> None:
    """Change the limits of a motor: of servos their force, of others the gear, which scales all."""
    rotor = change.rotor
    is_servo = change.joint.gain is not None or change.joint.velocity is not None
    if motor.tag == "velocity" and "class" in motor.attributes:
        _write_out_class(document, motor, change)
    if is_servo or motor.tag not in ("motor", "general"):
        document.multiply(motor, [change.effort] * 2, "forcerange")
        if motor.tag in ("velocity", "intvelocity", "general"):
            document.multiply(motor, [1.0 / change.size] * 2, "ctrlrange")
        for name in ("kv", "gainprm", "biasprm"):
            document.multiply(motor, [change.gain] * 3, name)
    elif change.effort != 1.0:
        gear = motor.attributes.get("gear", "1").split()
        document.set_attribute(
            motor, "gear", " ".join([lengths([float(gear[0]) * change.effort]), *gear[1:]])
        )
        rotor /= change.effort**2  # it counts by the square of the gear
    document.multiply(motor, [rotor], "armature")


def _write_out_class(document: Document, motor: Span, change: Change) -> None:
    """Give a servo of speed the changed limits that it has of its class, which others have, too."""
    ratio = float(motor.attributes.get("gear", "1").split()[0])
    force, speed, gain = change.joint.effort, change.joint.velocity, change.joint.gain
    limits = {
        "forcerange": (force, change.effort / ratio, (-1.0, 1.0)),
        "ctrlrange": (speed, ratio / change.size, (-1.0, 1.0)),
        "kv": (gain, change.gain / ratio**2, (1.0,)),
    }
    changed = (change.effort, change.size, change.gain) != (1.0, 1.0, 1.0)
    for name, (figure, factor, signs) in limits.items():
        if changed and figure and name not in motor.attributes:
            value = numbers([sign * figure * factor for sign in signs])
            document.set_attribute(motor, name, value)


def _add_mjcf_grousers(document: Document, body: Span, change: Change, pose: Pose) -> None:
    geom = body.only("geom")
    alike = {} if geom is None else geom.attributes
    given = "".join(f' {name}="{alike[name]}"' for name in _INHERITED if name in alike)
    for shape, place in change.grousers_on(pose):
        where = f'pos="{lengths(place.place)}" quat="{numbers(place.quaternion)}"'
        size = f'size="{lengths(0.5 * shape.size)}"'
        # Its mass is part of the wheel's; it has no name, as names must differ.
        document.append(body, f'<geom type="box" {where} {size} mass="0"{given}/>')


def _move(document: Document, element: Span, pose: Span | None, shift: Array) -> None:
    if pose is None:
        document.append(element, f"<pose>{lengths([*shift, 0.0, 0.0, 0.0])}</pose>")
    elif not pose.text:
        document.set_text(pose, lengths([*shift, 0.0, 0.0, 0.0]))
    else:
        document.add_to(pose, shift.tolist())


def _rotate_shift(shift: Array, frame: str, tree: Tree, element: Span) -> Array:
    """[m] Return a shift of the model in the frame in which an element is given."""
    if frame == MODEL:
        return shift
    if frame not in tree.by_name:
        _refuse(element, frame, "must be placed in the frame of a link or of the model")
    rotated: Array = np.asarray(tree.by_name[frame].pose.turn.T @ shift)
    return rotated


def _refuse(element: Span, value: str, rule: str) -> NoReturn:
    raise ScenarioError(f"{element.tag}[{element.name}]", value, rule)


def _change_links(
    document: Document, scope: Span, change: Change, tree: Tree, *, is_urdf: bool
) -> None:
    """Change mass, moments of inertia and radii: attributes in URDF, elements in SDF."""
    for link in links_in(scope, change.links):
        mass, inertia = link.only("inertial/mass"), link.only("inertial/inertia")
        if mass is None and change.mass != 1.0 and not is_urdf:
            _refuse(link, "no mass", "must state its mass, for wheels to share it")
        document.multiply(mass, [change.mass], "value" if is_urdf else "")
        if inertia is not None:
            for name in inertia.attributes if is_urdf else ():
                document.multiply(inertia, [change.inertia], name, is_exact=True)
            for moment in () if is_urdf else inertia.children:
                document.multiply(moment, [change.inertia], is_exact=True)
        for shape in link.all("collision", "visual"):
            for kind in _ROUNDS:
                radius = shape.only(f"geometry/{kind}" if is_urdf else f"geometry/{kind}/radius")
                document.multiply(radius, [change.round_size], "radius" if is_urdf else "")
        if link.name == change.link:
            pose = tree.by_name[change.link].pose
            _add_grousers(document, link, change, pose, is_urdf=is_urdf)


def _add_grousers(
    document: Document, link: Span, change: Change, pose: Pose, *, is_urdf: bool
) -> None:
    surface = link.only("collision/surface")
    of_wheel = "" if surface is None else document.source(surface)
    for shape, local in change.grousers_on(pose):
        place, angles, size = lengths(local.place), numbers(local.rpy), lengths(shape.size)
        text = f"<pose>{place} {angles}</pose><geometry><box><size>{size}</size></box></geometry>"
        if is_urdf:
            origin = f'<origin xyz="{place}" rpy="{angles}"/>'
            text = f'{origin}<geometry><box size="{size}"/></geometry>'
        for tag, more in (("collision", of_wheel), ("visual", "")):
            document.append(link, f'<{tag} name="{shape.name}_{tag}">{text}{more}</{tag}>')
