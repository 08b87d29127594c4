"""The model files that the engines load: public, exported, patch_file, and changed ones."""

import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from benches.adapters.robots import RobotModel, Wheel, cleaned, rigid_bodies
from benches.models.cases import CASES, Case
from crawler2d import Reading, Robot, read_robot
from crawler2d.model_tree import Link, Shape, Tree
from crawler2d.patching.patch import patch_file
from crawler2d.reading.wheels import subtrees
from crawler2d.writing.formats import document, urdf_of

_LEFT = np.array([0.0, 1.0, 0.0])
_SURFACE = 1.0  # [-] friction of robots in exported files: that of the ground decides
_NO_LIMIT = 1e4  # [N m], [rad/s] far more than any wheel here needs

FILES = {
    "public": "original",
    "export": "original",
    "repair": "repair",
    "patch": "repair",
    "balanced": "original",
    "on-axles": "original",
    "balanced-on-axles": "original",
}
"""The files of a case, each with the prediction that it is to be compared with: the public one,
crawler2d's of the same robot, and of the repaired one, the public one with the wheels of the
repair, and variants of the public one."""


def model_of(engine: str, case: str, file: str, robot: Robot) -> RobotModel:
    """Return one of the files of a case; the public ones do not depend on the robot.

    Bullet has true cylinders from URDF alone.
    """
    own = CASES[case]
    form = "urdf" if engine in ("bullet", "bullet-pyramid") else own.form
    if file == "public":
        return loaded(own.reading(), form, own.angle)
    if file == "patch":
        return patch(own, robot, form)
    return variant(own, file) if file in VARIANTS else exported(own, robot, form, f"{case}_{file}")


def exported(case: Case, robot: Robot, form: str, name: str) -> RobotModel:
    """Return crawler2d's file of a robot."""
    text = robot.to_sdf(friction=_SURFACE) if form == "sdf" else robot.to_urdf(friction=_SURFACE)
    return loaded(_reread(text, f"{name}.{form}"), form, case.angle)


def patch(case: Case, robot: Robot, form: str) -> RobotModel:
    """Return the public file with its wheels changed to those of a robot by `Audit.patch`.

    Parameters
    ----------
    case : Case
        Whose file.
    robot : Robot
        Has the wheels; that its flippers are held and its motors firm is not in the file.
    form : str
        Format that the engine needs, "sdf" or "urdf".
    """
    reading = case.reading()
    own, flippers = reading.robot, reading.robot.flippers
    if flippers is not None and robot.flippers is not None:
        flippers = replace(flippers, track=robot.flippers.track)
    text = patch_file(reading, replace(own, track=robot.track, flippers=flippers)).text
    file = f"{Path(case.file).stem}_patch.{case.form}"
    return loaded(_reread(text, file, **case.how), form, case.angle)


def variant(case: Case, name: str) -> RobotModel:
    """Return the robot of a public file with the changes of a variant, as URDF for all engines."""
    reading = case.reading()
    for change in VARIANTS[name]:
        text = document(urdf_of(_limited(change(reading))), case.file)
        reading = _reread(text, f"{Path(case.file).stem}_{name}.urdf", **case.how)
    return loaded(reading, "urdf", case.angle)


def _reread(text: str, file: str, **how: Any) -> Reading:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / file
        path.write_text(text, encoding="utf-8")
        return read_robot(path, **how)


def loaded(reading: Reading, form: str, angle: float) -> RobotModel:
    """Return a file for an engine, in which all robots have +x forward and z up.

    In another format than its own it has the same links, joints, shapes and inertias: those of the
    tree that was read.

    Parameters
    ----------
    reading : Reading
        Of the file.
    form : str
        Format that the engine needs, "sdf" or "urdf".
    angle : float
        [rad] At which flippers are held.
    """
    tree, table, origin = reading.tree, reading.wheels, reading.frame.place
    is_own = tree.format.lower().startswith(form)
    text = reading.text if is_own else document(urdf_of(tree), tree.file)
    flippers = reading.robot.flippers
    turn = 0.0 if flippers is None else angle - flippers.angle
    held, wheels = {}, []
    columns = (table[name].tolist() for name in ("name", "x", "y", "z", "radius", "carrier"))
    for name, x, y, z, radius, carrier in zip(*columns, strict=True):
        axle = np.array([x, z, y])
        if carrier != "chassis":
            link = tree.joints[name].parent
            pivot = tree.joints[link].place
            end = 1.0 if carrier.startswith("front") else -1.0
            held[link] = -end * turn / _sense(tree, link)
            cos, sin = np.cos(turn), end * np.sin(turn)
            along, _, up = axle - pivot
            arm = [cos * along - sin * up, axle[1] - pivot[1], sin * along + cos * up]
            axle = pivot + np.array(arm)
        place = tuple((axle - origin).tolist())
        wheels.append(Wheel(link=name, axle=place, radius=radius, rate=_sense(tree, name) / radius))
    return RobotModel(
        file=f"{reading.path.stem}.{form}",
        tree=tree,
        wheels=tuple(wheels),
        bodies=rigid_bodies(tree, wheels, held, origin),
        text=cleaned(text),
        height=min(wheel.axle[2] - wheel.radius for wheel in wheels),
        held=held,
        origin=origin,
        holds_speed=True,
    )


def _sense(tree: Tree, link: str) -> float:
    """[-] Return 1 if the joint of a link turns about +y, -1 if about -y."""
    return float(np.sign(tree.joints[link].axis @ _LEFT))


def balanced(reading: Reading) -> Tree:
    """Return a robot with the centres of mass of its wheels on their axles.

    That of the hull moves in the other direction, so that the robot's centre of mass stays.
    """
    tree = reading.tree
    wheels = set(reading.wheels["name"].tolist())
    off = {
        link.name: link.center - tree.joints[link.name].place
        for link in tree.links
        if link.name in wheels
    }
    moment = sum(
        (link.mass * off[link.name] for link in tree.links if link.name in off), np.zeros(3)
    )
    root = tree.links[0]
    shifts = {name: -each for name, each in off.items()} | {root.name: moment / root.mass}
    links = [replace(link, center=link.center + shifts.get(link.name, 0.0)) for link in tree.links]
    return replace(tree, links=tuple(links))


def on_axles(reading: Reading) -> Tree:
    """Return a robot whose flippers, with everything attached to them, pivot on the end axles."""
    tree, height = reading.tree, reading.frame.place[2]
    hanging = subtrees(tree)
    table = reading.wheels
    arms = {
        tree.joints[wheel].parent
        for wheel, carrier in zip(table["name"].tolist(), table["carrier"].tolist(), strict=True)
        if carrier != "chassis"
    }
    down = {
        name: np.array([0.0, 0.0, height - tree.joints[arm].place[2]])
        for arm in arms
        for name in hanging[arm]
    }
    joints = {
        name: replace(joint, place=joint.place + down.get(name, 0.0))
        for name, joint in tree.joints.items()
    }
    links = tuple(
        _moved(link, down[link.name]) if link.name in down else link for link in tree.links
    )
    return replace(tree, links=links, joints=joints)


def _limited(tree: Tree) -> Tree:
    """Add missing limits of motors, which DART's reader of URDF requires."""

    def or_ample(limit: float | None) -> float:
        return _NO_LIMIT if limit is None else limit

    joints = {
        name: replace(joint, effort=or_ample(joint.effort), velocity=or_ample(joint.velocity))
        for name, joint in tree.joints.items()
    }
    return replace(tree, joints=joints)


_Part = TypeVar("_Part", Link, Shape)


def _moved(link: Link, by: np.ndarray) -> Link:
    def moved(part: _Part) -> _Part:
        return replace(part, pose=replace(part.pose, place=part.pose.place + by))

    return replace(moved(link), center=link.center + by, shapes=tuple(map(moved, link.shapes)))


VARIANTS: dict[str, tuple[Callable[[Reading], Tree], ...]] = {
    "balanced": (balanced,),
    "on-axles": (on_axles,),
    "balanced-on-axles": (balanced, on_axles),
}
"""Changes of the robot in a public file, one after the other."""
