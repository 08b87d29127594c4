"""Public files that were changed: in their wheels, as an audit does it, or to find what matters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from benches.models.cases import Case
from benches.models.files import ModelFile, of_reading
from crawler2d.model_tree import Link, Shape, Tree
from crawler2d.parameters.robot import Robot
from crawler2d.patching.patch import patched
from crawler2d.reading.reading import Reading, read_robot
from crawler2d.reading.wheels import below
from crawler2d.writing.formats import document, urdf_of

__all__ = ["VARIANTS", "balanced", "on_axles", "patch", "variant"]

_AMPLE = 1e4  # [N m], [rad/s] far more than any wheel here needs


def patch(case: Case, robot: Robot, form: str, folder: Path) -> ModelFile:
    """Return the public file with only its wheels changed to those of a robot: `Audit.patch`.

    Parameters
    ----------
    case : Case
        Whose file.
    robot : Robot
        Has the wheels; that its flippers are held and its motors firm is none of the file's.
    form : str
        Format that the engine is to have, "sdf" or "urdf".
    folder : Path
        Where to write.
    """
    reading = case.reading()
    own, flippers = reading.robot, reading.robot.flippers
    if flippers is not None and robot.flippers is not None:
        flippers = replace(flippers, track=robot.flippers.track)
    text = patched(reading, replace(own, track=robot.track, flippers=flippers)).text
    path = folder / f"{Path(case.file).stem}_patch.{case.form}"
    path.write_text(text, encoding="utf-8")
    return of_reading(read_robot(path, **case.how), form, case.angle, folder)


def balanced(reading: Reading) -> Tree:
    """Return a robot with the centres of mass of its wheels on their axles.

    The hull's moves the other way, so that the centre of mass of the robot stays where it is.
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
    """Return a robot whose flippers, with all that hangs on them, pivot on the end axles."""
    tree, height = reading.tree, reading.frame.place[2]
    hanging = below(tree)
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
    """State the limits of motors that a file leaves out: DART's reader of URDF asks for them."""

    def or_ample(limit: float | None) -> float:
        return _AMPLE if limit is None else limit

    joints = {
        name: replace(joint, effort=or_ample(joint.effort), velocity=or_ample(joint.velocity))
        for name, joint in tree.joints.items()
    }
    return replace(tree, joints=joints)


def _moved(link: Link, by: np.ndarray) -> Link:
    def shape(each: Shape) -> Shape:
        return replace(each, pose=replace(each.pose, place=each.pose.place + by))

    return replace(
        link,
        pose=replace(link.pose, place=link.pose.place + by),
        center=link.center + by,
        shapes=tuple(shape(each) for each in link.shapes),
    )


VARIANTS: dict[str, tuple[Callable[[Reading], Tree], ...]] = {
    "balanced": (balanced,),
    "on-axles": (on_axles,),
    "balanced-on-axles": (balanced, on_axles),
}
"""Changes of the robot that a public file states, each after the other."""


def variant(case: Case, name: str, folder: Path) -> ModelFile:
    """Return the robot of a public file with the changes of a variant, as URDF for all engines."""
    reading = case.reading()
    path = folder / f"{Path(case.file).stem}_{name}.urdf"
    for change in VARIANTS[name]:
        tree = _limited(change(reading))
        path.write_text(document(urdf_of(tree), case.file), encoding="utf-8")
        reading = read_robot(path, **case.how)
    return of_reading(reading, "urdf", case.angle, folder)
