"""What of a model is wheel, track, flipper or chassis, and what a side view cannot hold."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.models.poses import Array
from crawler2d.models.tree import Joint, Link, Shape, Tree
from crawler2d.reading.grousers import grousers_on
from crawler2d.reading.parts import Arm, Runner, RunningGear
from crawler2d.reading.rounds import below, is_parallel, radius_about
from crawler2d.reading.surfaces import Surfaces
from crawler2d.reading.view import SideView
from crawler2d.reading.wheels import wheel_of

__all__ = ["running_gear_of"]

# [m] What lies this little behind its pivot does not lie behind it.
_BEHIND = 0.005
_DRUMS = ("cylinder", "capsule", "sphere")


def running_gear_of(tree: Tree, view: SideView, surfaces: Surfaces) -> RunningGear:
    """Sort everything that can touch the ground.

    Parameters
    ----------
    tree : Tree
        The model.
    view : SideView
        Its side view.
    surfaces : Surfaces
        Those that move.

    Returns
    -------
    RunningGear
        What was found.

    Raises
    ------
    ScenarioError
        If wheels or tracks hang on springs, slides, rockers or steered joints, or a wheel turns
        about another axis.
    """
    return _Sorting(tree, view, surfaces).gear()


class _Sorting:
    """Walks down the tree; what hangs on a link is known when it is its turn."""

    def __init__(self, tree: Tree, view: SideView, surfaces: Surfaces) -> None:
        self.tree = tree
        self.view = view
        self.hanging = below(tree)
        self.moved = surfaces.moved
        self.links = tree.by_name
        self.wheels: dict[str, list[tuple[Link, Shape]]] = {}
        for child, joint in tree.joints.items():
            if shapes := wheel_of(tree, joint, self.hanging):
                self.wheels[child] = shapes
        self.turning = {n for child in self.wheels for n in self.hanging[child]}
        self.carrier: dict[str, Joint | None] = {}

    def gear(self) -> RunningGear:
        gear = RunningGear()
        arms: dict[str, Joint] = {}
        for link in self.tree.links:
            joint = self.tree.joints.get(link.name)
            above = None if joint is None else self.carrier[joint.parent]
            if joint is not None and link.name not in self.turning:
                above = self.carried(joint, above, arms)
            self.carrier[link.name] = above
        gear.passive = self.passive()
        for arm in arms.values():
            gear.arms.append(self.arm(arm))
        for link in self.tree.links:
            carrier = self.carrier[link.name]
            if carrier is None:
                gear.runners += self.runners_of(link)
                for shape in self.still(link):
                    if shape not in self.moved:
                        gear.shapes.append((link, shape))
                    elif shape.kind not in _DRUMS:
                        gear.bars.append((link, shape))
            elif carrier.child not in arms:
                gear.moving += [(carrier, link, shape) for shape in link.shapes]
        return gear

    def carried(self, joint: Joint, above: Joint | None, arms: dict[str, Joint]) -> Joint | None:
        """Return the joint on which a link moves, None for the chassis; note the arms."""
        places = list(self.places(joint))
        if joint.kind == "fixed":
            return above
        if not places:
            return above if joint.is_locked or above is not None else joint
        if self.is_arm(joint, places):
            if above is not None:
                self.refuse(joint, "must not be a flipper on another moving part")
            if joint.stiffness > 0.0:
                self.refuse(joint, "must have no spring: a side view holds no suspension")
            arms[joint.child] = joint
            return joint
        if joint.is_locked:
            return above
        return self.refuse(joint, self.reason(joint))

    def reason(self, joint: Joint) -> str:
        """Return the rule that a joint breaks that carries wheels and is no flipper's."""
        if joint.kind == "slide" or joint.stiffness > 0.0:
            return "must carry no wheels: a side view holds no suspension"
        if joint.kind != "hinge":
            return "must be fixed or turn about an axis, to carry wheels"
        if is_parallel(joint.axis, self.view.left):
            return "must carry no wheels on both sides of it: a side view holds no rocker"
        return "must carry no wheels: a side view holds no steering"

    def refuse(self, joint: Joint, rule: str) -> NoReturn:
        raise ScenarioError(f"{joint.at}: joint[{joint.name}]", joint.kind, rule)

    def places(self, joint: Joint) -> Iterator[Array]:
        """Yield where the wheels and drums are that hang on a joint."""
        for name in self.hanging[joint.child]:
            if name in self.wheels:
                yield self.view.of(self.tree.joints[name].place)
            for shape in self.still(self.links[name]):
                if shape in self.moved:
                    yield self.view.of(shape.pose.place)

    def is_arm(self, joint: Joint, places: list[Array]) -> bool:
        """Whether a joint is the pivot of a flipper: all wheels lie on one side of it."""
        if joint.kind != "hinge" or not is_parallel(joint.axis, self.view.left):
            return False
        out = np.array([place[:2] for place in places]) - self.view.of(joint.place)[:2]
        reach = np.hypot(*out.T)
        if reach.max() <= _BEHIND:
            return False
        along = out @ out[reach.argmax()] / reach.max()
        return bool(along.min() >= -_BEHIND)

    def still(self, link: Link) -> tuple[Shape, ...]:
        """Return the shapes of a link that is no wheel."""
        return () if link.name in self.turning else link.shapes

    def runners_of(self, link: Link) -> Iterator[Runner]:
        """Yield the wheel that a link is, or the drums that it has."""
        if link.name in self.wheels:
            yield self.wheel(self.tree.joints[link.name])
        for shape in self.still(link):
            if shape in self.moved and shape.kind in _DRUMS:
                yield self.drum(link, shape)

    def wheel(self, joint: Joint) -> Runner:
        shapes = self.wheels[joint.child]
        if not is_parallel(joint.axis, self.view.left):
            self.refuse(
                joint, "must turn about the axis of the other wheels: a side view holds no steering"
            )
        radii = [radius_about(shape, joint.place, joint.axis) or 0.0 for _, shape in shapes]
        largest = int(np.argmax(radii))
        grousers = grousers_on([shape for _, shape in shapes], joint)
        x, y, _ = self.view.of(joint.place)
        link, shape = shapes[largest]
        turning = [self.links[name] for name in self.hanging[joint.child]]
        across = self.view.of(np.array([part.center for part in turning])) - (x, y, 0.0)
        swung = [
            part.mass * float(c[0] ** 2 + c[1] ** 2)
            for part, c in zip(turning, across, strict=True)
        ]
        middle = shape.pose.place if shape.kind != "hull" else shape.points.mean(axis=0)
        return Runner(
            name=joint.child,
            x=float(x),
            y=float(y),
            z=float(self.view.of(middle)[2]),
            radius=radii[largest] if grousers is None else grousers.radius,
            link=link,
            shape=shape,
            joint=joint,
            mass=sum(part.mass for part in turning),
            inertia=sum(self.view.about_left(part.inertia) for part in turning) + sum(swung),
            grousers=grousers,
        )

    def drum(self, link: Link, shape: Shape) -> Runner:
        if shape.kind != "sphere" and not is_parallel(shape.axis, self.view.left):
            path = f"{shape.at}: collision[{shape.name}]"
            raise ScenarioError(path, shape.kind, "must lie across, to be a drum of a track")
        x, y, z = (float(part) for part in self.view.of(shape.pose.place))
        name = f"{link.name}/{shape.name}"
        return Runner(name=name, x=x, y=y, z=z, radius=shape.radius, link=link, shape=shape)

    def arm(self, joint: Joint) -> Arm:
        links = [self.links[name] for name in self.hanging[joint.child]]
        still = [(link, shape) for link in links for shape in self.still(link)]
        return Arm(
            joint=joint,
            pivot=self.view.of(joint.place),
            links=tuple(links),
            runners=tuple(runner for link in links for runner in self.runners_of(link)),
            shapes=tuple(
                (link, shape)
                for link, shape in still
                if shape not in self.moved or shape.kind not in _DRUMS
            ),
        )

    def passive(self) -> set[str]:
        """Return the wheels that nothing drives, if the file says what drives others."""
        driven = {
            child for child in self.wheels if self.tree.joints[child].name in self.tree.driven
        }
        return set(self.wheels) - driven if driven else set()
