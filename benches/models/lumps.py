"""The links of a model file as rigid bodies: the chassis with its flippers, and the wheels."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benches.models.files import ModelFile
from crawler2d.models.poses import Array, Pose
from crawler2d.models.tree import Joint, Link
from crawler2d.reading.rounds import below

__all__ = ["lumps"]


def lumps(model: ModelFile, torque: float) -> list[dict[str, Any]]:
    """Return what the worker of ODE builds: the chassis first, all in the chassis frame.

    What hangs on a wheel turns with it; all else is one body, with the flippers at the angles at
    which they are held.

    Parameters
    ----------
    model : ModelFile
        The robot.
    torque : float
        [N m] Limit of the motor of each wheel.

    Returns
    -------
    list of dict
        `name`, `mass` [kg], `center` [m], `inertia` [kg m^2] row by row, `shapes`, and of a wheel
        `axle` and `radius` [m] and `torque` [N m].
    """
    tree = model.tree
    hanging = below(tree)
    held = {
        name: (tree.joints[flipper], angle)
        for flipper, angle in model.held.items()
        for name in hanging[flipper]
    }
    links = {link.name: _moved(link, *held.get(link.name, (None, 0.0))) for link in tree.links}
    wheels = {wheel: [links[name] for name in hanging[wheel]] for wheel in model.wheels}
    turning = {link["name"] for each in wheels.values() for link in each}
    rest = [link for name, link in links.items() if name not in turning]
    chassis = _body(rest, model.origin) | {"axle": None, "radius": None, "torque": None}
    return [
        chassis,
        *(
            _body(parts, model.origin)
            | {"axle": model.axles[name].tolist(), "radius": model.radii[name], "torque": torque}
            for name, parts in wheels.items()
        ),
    ]


def _moved(link: Link, joint: Joint | None, angle: float) -> dict[str, Any]:
    """Turn a link about a joint, and leave it where it is without one."""
    turn, place = np.eye(3), np.zeros(3)
    if joint is not None:
        turn, place = _about(joint.axis, angle), joint.place
    return {
        "name": link.name,
        "mass": link.mass,
        "center": place + turn @ (link.center - place),
        "inertia": turn @ link.inertia @ turn.T,
        "shapes": [
            (
                shape,
                Pose(place=place + turn @ (shape.pose.place - place), turn=turn @ shape.pose.turn),
            )
            for shape in link.shapes
            if shape.kind != "mesh"
        ],
    }


def _body(links: Sequence[dict[str, Any]], origin: Array) -> dict[str, Any]:
    """Make one body of links."""
    mass = sum(link["mass"] for link in links)
    center = sum((link["mass"] * link["center"] for link in links), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for link in links:
        arm = link["center"] - center
        inertia += link["inertia"] + link["mass"] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return {
        "name": links[0]["name"],
        "mass": mass,
        "center": (center - origin).tolist(),
        "inertia": inertia.ravel().tolist(),
        "shapes": [
            {
                "kind": shape.kind,
                "place": (pose.place - origin).tolist(),
                "turn": pose.turn.ravel().tolist(),
                "radius": shape.radius,
                "length": shape.length,
                "size": shape.size.tolist(),
            }
            for link in links
            for shape, pose in link["shapes"]
        ],
    }


def _about(axis: Array, angle: float) -> Array:
    """Return the rotation about an axis (Rodrigues' formula)."""
    x, y, z = axis / np.linalg.norm(axis)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    turn: Array = np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * skew @ skew
    return turn
