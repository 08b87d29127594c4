"""The files that the engines load, and what in them turns."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from benches.models.cases import Case
from crawler2d.model_tree import Tree
from crawler2d.parameters.robot import Robot
from crawler2d.reading.reading import Reading, read_robot
from crawler2d.writing.formats import document, urdf_of

__all__ = ["ModelFile", "cleaned", "exported", "of_reading", "public"]

_LEFT = np.array([0.0, 1.0, 0.0])
_SURFACE = 1.0  # [-] friction of robots in exported files: that of the ground decides


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class ModelFile:
    """A model file as an engine needs it; all robots here have +x forward and z up.

    Parameters
    ----------
    path : Path
        The file, without pictures, sensors and plugins.
    tree : Tree
        What was read from it, for engines that read no files.
    mass : float
        [kg] Of all of its links.
    wheels : mapping of str to float
        [1/m] By link, the angle by which its joint turns for each metre that its surface runs.
    held : mapping of str to float
        [rad] By link, the angle at which the joint of a flipper is held.
    axles : mapping of str to ndarray, shape (3,)
        [m] Of the wheels, flippers held, in the chassis frame.
    radii : mapping of str to float
        [m] Of the wheels.
    origin : ndarray, shape (3,)
        [m] Of the chassis frame, in the frame of the model.
    """

    path: Path
    tree: Tree
    mass: float
    wheels: dict[str, float]
    held: dict[str, float]
    axles: dict[str, NDArray[np.float64]]
    radii: dict[str, float]
    origin: NDArray[np.float64]

    @property
    def foremost(self) -> float:
        """[m] Of its wheels, in the chassis frame."""
        return float(max(axle[0] + self.radii[name] for name, axle in self.axles.items()))

    @property
    def lowest(self) -> float:
        """[m] Of its wheels, in the chassis frame."""
        return float(min(axle[2] - self.radii[name] for name, axle in self.axles.items()))


def cleaned(text: str) -> str:
    """Take out of a file what no engine needs to drive: pictures, sensors, plugins, meshes.

    Joints of links that are not in the file go, too, and SDF gets the zeros for missing damping
    that Bullet's reader asks for. All masses, shapes but meshes, joints and their places stay.
    """
    root = ElementTree.fromstring(text)
    for parent in list(root.iter()):
        for tag in ("visual", "sensor", "plugin", "gazebo", "transmission"):
            for child in parent.findall(tag):
                parent.remove(child)
        for child in parent.findall("collision"):
            if child.find("geometry/mesh") is not None:
                parent.remove(child)
    if root.tag == "robot":
        links = {link.get("name") for link in root.findall("link")}
        for joint in root.findall("joint"):
            ends = [joint.find(tag) for tag in ("parent", "child")]
            if any(end is None or end.get("link") not in links for end in ends):
                root.remove(joint)
    else:
        for dynamics in root.iter("dynamics"):
            for tag in ("damping", "friction"):
                if dynamics.find(tag) is None:
                    ElementTree.SubElement(dynamics, tag).text = "0"
    return ElementTree.tostring(root, encoding="unicode")


def public(case: Case, form: str, folder: Path) -> ModelFile:
    """Return the public file of a case."""
    return of_reading(case.reading(), form, case.angle, folder)


def exported(case: Case, robot: Robot, form: str, name: str, folder: Path) -> ModelFile:
    """Return crawler2d's file of a robot."""
    path = folder / f"{name}.{form}"
    text = robot.to_sdf(friction=_SURFACE) if form == "sdf" else robot.to_urdf(friction=_SURFACE)
    path.write_text(text, encoding="utf-8")
    return of_reading(read_robot(path), form, case.angle, folder)


def of_reading(reading: Reading, form: str, angle: float, folder: Path) -> ModelFile:
    """Write what was read from a file for an engine, and say what turns in it.

    In another format than its own it has the same links, joints, shapes and inertias: those of the
    tree that was read.

    Parameters
    ----------
    reading : Reading
        Of the file.
    form : str
        Format that the engine is to have, "sdf" or "urdf".
    angle : float
        [rad] At which flippers are held.
    folder : Path
        Where to write; a file of the same name there is written over.
    """
    tree = reading.tree
    is_own = tree.format.lower().startswith(form)
    text = reading.text if is_own else document(urdf_of(tree), tree.file)
    path = folder / f"{reading.path.stem}.{form}"
    path.write_text(cleaned(text), encoding="utf-8")
    return _model_file(path, reading, angle)


def _model_file(path: Path, reading: Reading, angle: float) -> ModelFile:
    tree, wheels = reading.tree, reading.wheels
    names = [str(name) for name in wheels["name"]]
    places = np.column_stack([wheels["x"], wheels["z"], wheels["y"]])
    radii = dict(zip(names, wheels["radius"].tolist(), strict=True))
    carriers = dict(zip(names, wheels["carrier"].tolist(), strict=True))
    axles = dict(zip(names, places, strict=True))
    origin = reading.frame.place
    flippers = reading.robot.flippers
    turn = 0.0 if flippers is None else angle - flippers.angle
    held, moved = {}, {}
    for name in names:
        axle = axles[name]
        if carriers[name] != "chassis":
            link, pivot = _flipper(tree, name)
            end = 1.0 if carriers[name].startswith("front") else -1.0
            held[link] = -end * turn / _sense(tree, link)
            cos, sin = np.cos(turn), end * np.sin(turn)
            x, _, z = axle - pivot
            axle = pivot + np.array([cos * x - sin * z, axle[1] - pivot[1], sin * x + cos * z])
        moved[name] = axle - origin
    return ModelFile(
        path=path,
        tree=tree,
        mass=sum(link.mass for link in tree.links),
        wheels={name: _sense(tree, name) / radii[name] for name in names},
        held=held,
        axles=moved,
        radii=radii,
        origin=origin,
    )


def _sense(tree: Tree, link: str) -> float:
    """[-] Return 1 if the joint of a link turns about +y, -1 if about -y."""
    return float(np.sign(tree.joints[link].axis @ _LEFT))


def _flipper(tree: Tree, wheel: str) -> tuple[str, NDArray[np.float64]]:
    """Return the link that carries a wheel, and where it pivots."""
    link = tree.joints[wheel].parent
    return link, tree.joints[link].place
