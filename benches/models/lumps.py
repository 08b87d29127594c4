"""The links of a model file as rigid bodies: the chassis with its flippers, and the wheels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from benches.models.files import ModelFile
from benches.models.ode_child import plain_body
from crawler2d.model_tree import Joint, Link, Pose, from_quaternion
from crawler2d.reading.wheels import below

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
        See `plain_body`.
    """
    tree = model.tree
    hanging = below(tree)
    to_chassis = Pose(place=-model.origin)
    moves = dict.fromkeys(hanging, to_chassis)
    for flipper, angle in model.held.items():
        moves |= dict.fromkeys(
            hanging[flipper], to_chassis.then(_turned(tree.joints[flipper], angle))
        )
    links = {link.name: _moved(link, moves[link.name]) for link in tree.links}
    wheels = {wheel: [links[name] for name in hanging[wheel]] for wheel in model.wheels}
    turning = {link.name for parts in wheels.values() for link in parts}
    chassis = _body([link for name, link in links.items() if name not in turning])
    return [
        plain_body(chassis, None, None, None),
        *(
            plain_body(_body(parts), model.axles[name].tolist(), model.radii[name], torque)
            for name, parts in wheels.items()
        ),
    ]


def _turned(joint: Joint, angle: float) -> Pose:
    """Return what a turn about a joint makes of the frame of the model."""
    along = np.sin(0.5 * angle) * joint.axis / np.linalg.norm(joint.axis)
    turn = from_quaternion((np.cos(0.5 * angle), *along)).turn
    return Pose(place=joint.place - turn @ joint.place, turn=turn)


def _moved(link: Link, move: Pose) -> Link:
    """Return a link as it is seen from another frame."""
    return replace(
        link,
        center=move.at(link.center),
        inertia=move.turn @ link.inertia @ move.turn.T,
        shapes=tuple(
            replace(shape, pose=move.then(shape.pose))
            for shape in link.shapes
            if shape.kind != "mesh"
        ),
    )


def _body(links: Sequence[Link]) -> Link:
    """Make one body of links, under the name of the first."""
    mass = sum(link.mass for link in links)
    center = sum((link.mass * link.center for link in links), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for link in links:
        arm = link.center - center
        inertia += link.inertia + link.mass * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    shapes = tuple(shape for link in links for shape in link.shapes)
    return replace(links[0], mass=mass, center=center, inertia=inertia, shapes=shapes)
