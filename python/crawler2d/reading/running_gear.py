"""The side view of a model, with its left and right wheels and drums paired, and its flippers."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from crawler2d.errors import ScenarioError
from crawler2d.model_tree import Array, Joint, Link, Shape, Tree
from crawler2d.reading.surfaces import Surfaces
from crawler2d.reading.wheels import (
    PARALLEL,
    Arm,
    Runner,
    RunningGear,
    grousers_on,
    is_parallel,
    radius_about,
    subtrees,
    wheel_shapes,
    why_no_wheel,
)

__all__ = [
    "Pair",
    "SideView",
    "centers",
    "is_belted",
    "middle_of",
    "pair_runners",
    "running_gear_of",
    "side_view",
]

_MOST_RUNNERS = 400  # of one carrier, both sides together; every pair is compared
_UP = np.array([0.0, 0.0, 1.0])
_DRUMS = ("cylinder", "capsule", "sphere")

# [rad] An axis this close to an axis of the model is taken as that axis: files have 3.1415 for pi.
_SNAP = 0.01

_FORWARDS = {
    f"{sign}{name}": (1.0 if sign == "+" else -1.0) * np.eye(3)[axis]
    for sign in "+-"
    for axis, name in enumerate("xy")
}
_FRONT, _REAR = re.compile(r"front|fore"), re.compile(r"rear|back|hind")

# [m] Wheels that lie less than this behind a pivot do not count as behind it.
_BEHIND = 0.005


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class Pair:
    """A wheel or drum on the left, with its partner at the same position on the right.

    Parameters
    ----------
    left, right : tuple of Runner
        One on each side, or several that stand side by side.
    x, y, radius : float
        [m] Means of both sides; x is forward, y up.
    """

    left: tuple[Runner, ...]
    right: tuple[Runner, ...]
    x: float
    y: float
    radius: float

    @property
    def both(self) -> tuple[Runner, ...]:
        """All runners of the pair."""
        return self.left + self.right


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class SideView:
    """The frame of the side view: x forward, y up and z to the left.

    Parameters
    ----------
    forward, left : ndarray, shape (3,)
        Directions in the frame of the model, whose z axis is up.
    reason : str
        How the forward direction was found.
    tolerance : float
        [m] Allowed difference of positions and radii between the sides.
    middle : float
        [m] Lateral position of the middle plane.
    """

    forward: Array
    left: Array
    reason: str
    tolerance: float
    middle: float = 0.0

    @property
    def up(self) -> Array:
        """The upward direction in the frame of the model."""
        return _UP

    def of(self, point: Array) -> Array:
        """[m] Return forward, up and left coordinates of points, shape (3,) or (n, 3)."""
        turned: Array = np.asarray(point) @ np.stack([self.forward, _UP, self.left], axis=1)
        return turned

    def about_left(self, tensor: Array) -> float:
        """[kg m^2] Return the moment of inertia about the lateral axis."""
        return float(self.left @ tensor @ self.left)

    def is_same(self, first: Runner, second: Runner) -> bool:
        """Whether two runners agree in position and radius in side view, within the tolerance."""
        off = (first.x - second.x, first.y - second.y, first.radius - second.radius)
        return max(map(abs, off)) <= self.tolerance


def centers(pairs: Iterable[Pair]) -> Array:
    """[m] Return the positions of pairs in the side view, shape (n, 2)."""
    return np.array([[pair.x, pair.y] for pair in pairs])


def is_belted(runners: list[Runner], path: str) -> bool:
    """Whether runners are drums with a belt, among which at most half turn, as its sprockets.

    Raises
    ------
    ScenarioError
        If there are drums, but fewer than wheels.
    """
    turning = sum(runner.joint is not None for runner in runners)
    if 0 < len(runners) - turning < turning:
        rule = "must be wheels, or drums of a moved belt and at most one sprocket for each"
        raise ScenarioError(path, f"{turning} wheels and {len(runners) - turning} drums", rule)
    return turning < len(runners)


def middle_of(runners: Iterable[Runner]) -> float:
    """[m] Return the lateral position of the middle plane, halfway between the outermost wheels."""
    across = [runner.z for runner in runners]
    return 0.5 * (min(across) + max(across)) if across else 0.0


def pair_runners(runners: list[Runner], view: SideView) -> list[Pair]:
    """Pair the left and right runners of one carrier, from the rear to the front.

    Raises
    ------
    ScenarioError
        If a wheel has no partner, or stands in the middle.
    """
    if len(runners) > _MOST_RUNNERS:
        rule = f"must have at most {_MOST_RUNNERS} wheels per carrier"
        raise ScenarioError(str(runners[0].link.at), len(runners), rule)
    for runner in runners:
        if abs(runner.z - view.middle) <= view.tolerance:
            _refuse(runner, "in the middle", "must stand on the left or on the right")
    order = sorted(runners, key=lambda runner: (runner.x, runner.y, runner.radius))
    right = [runner for runner in order if runner.z <= view.middle]
    pairs: list[Pair] = []
    for runner in order:
        if runner.z <= view.middle:
            continue
        partner = next((other for other in right if view.is_same(runner, other)), None)
        if partner is None:
            _refuse_alone(runner, "right", view)
        right.remove(partner)
        double = next((pair for pair in pairs if view.is_same(runner, pair.left[0])), None)
        if double is not None:  # a double wheel is one wheel in side view
            pairs.remove(double)
        pairs.append(
            Pair(
                left=(runner, *(double.left if double else ())),
                right=(partner, *(double.right if double else ())),
                x=0.5 * (runner.x + partner.x),
                y=0.5 * (runner.y + partner.y),
                radius=0.5 * (runner.radius + partner.radius),
            )
        )
    for runner in right:
        _refuse_alone(runner, "left", view)
    return pairs


def side_view(tree: Tree, surfaces: Surfaces, forward: str | None, tolerance: float) -> SideView:
    """Find the lateral axis from the axes of wheels and drums, and which way is forward from names.

    Parameters
    ----------
    tree : Tree
        The model.
    surfaces : Surfaces
        Which surfaces move.
    forward : {"+x", "-x", "+y", "-y"}, optional
        The forward direction; None finds it.
    tolerance : float
        [m] Allowed difference between the sides.

    Raises
    ------
    ScenarioError
        If there are no wheels or drums, their common axis is not horizontal, or forward is
        ambiguous or not normal to the axes.
    """
    lateral = _lateral(tree, surfaces)
    ahead = np.cross(lateral, _UP)
    if forward is not None:
        if not isinstance(forward, str) or forward not in _FORWARDS:
            rule = f"must be one of {', '.join(_FORWARDS)}, or None"
            raise ScenarioError("forward", forward, rule)
        if not is_parallel(_FORWARDS[forward], ahead):
            rule = (
                f"must be normal to the axes of the wheels, which point along {_axis_text(lateral)}"
            )
            raise ScenarioError("forward", forward, rule)
        sign, reason = float(np.sign(_FORWARDS[forward] @ ahead)), "forward was given"
    elif by_names := _sign_by_names(tree, ahead):
        sign, reason = by_names
    elif is_parallel(ahead, np.array([1.0, 0.0, 0.0])):
        sign, reason = float(np.sign(ahead[0])), "no link is called front or rear"
    else:
        rule = 'is ambiguous, as no link is called front or rear: pass forward="+y" or "-y"'
        raise ScenarioError("forward", forward, rule)
    ahead = sign * ahead
    left = np.cross(_UP, ahead)
    return SideView(forward=ahead, left=left, reason=reason, tolerance=tolerance)


def running_gear_of(tree: Tree, view: SideView, surfaces: Surfaces) -> RunningGear:
    """Sort everything that can touch the ground by what carries it.

    Raises
    ------
    ScenarioError
        If wheels or tracks are on springs, slides, rockers or steered joints, or a wheel has
        another axis than the others.
    """
    return _Sorting(tree, view, surfaces).gear()


def _refuse(runner: Runner, value: str, rule: str) -> NoReturn:
    raise ScenarioError(runner.path, value, rule)


def _refuse_alone(runner: Runner, side: str, view: SideView) -> NoReturn:
    within = f"within {1e3 * view.tolerance:g} mm; tolerance= allows more"
    value = f"radius {runner.radius:.4g} m at x = {runner.x:.4g} m, y = {runner.y:.4g} m"
    _refuse(runner, value, f"must have a partner on the {side}, in side view {within}")


def _lateral(tree: Tree, surfaces: Surfaces) -> Array:
    """Return the horizontal direction shared by most axes of wheels and drums of tracks."""
    axes = [tree.joints[child].axis for child in wheel_shapes(tree)]
    axes += [
        shape.axis
        for link in tree.links
        for shape in link.shapes
        if shape.kind in ("cylinder", "capsule") and shape in surfaces.moved
    ]
    if not axes:
        rule = (
            "must have wheels (round collision shapes on horizontal joints without limits, bare or"
            " with equal grousers evenly round them) or tracks that a plugin moves or tracks= names"
        )
        count = sum(shape.kind in _DRUMS for link in tree.links for shape in link.shapes)
        got = f"{count} round shapes, none of them a wheel" if count else "no round shape"
        rule += f"; {why_no_wheel(tree)}" if count else ""
        raise ScenarioError(str(tree.at), got, rule)
    rows = np.array(axes)
    alike = np.abs(rows @ rows.T) >= math.cos(PARALLEL)
    most = rows[alike[alike.sum(axis=0).argmax()]]
    # Outer products do not depend on the sign of an axis: their sum has the common direction.
    lateral: Array = np.linalg.eigh(most.T @ most)[1][:, -1]
    for axis in np.eye(3):
        if np.linalg.norm(np.cross(lateral, axis)) <= _SNAP:
            lateral = axis
    if abs(lateral @ _UP) > _SNAP:
        got = _axis_text(lateral)
        raise ScenarioError(str(tree.at), got, "must have wheels with horizontal axes")
    flat: Array = lateral - (lateral @ _UP) * _UP
    flat /= np.linalg.norm(flat)
    return flat


def _axis_text(axis: Array) -> str:
    return f"({', '.join(f'{round(part, 3) + 0.0:g}' for part in axis)})"


def _sign_by_names(tree: Tree, ahead: Array) -> tuple[float, str] | None:
    """Return the sign of the direction in which links called front lie; None if it is not clear."""
    along: dict[bool, list[float]] = {True: [], False: []}
    for link in tree.links:
        name = link.name.lower()
        is_front, is_rear = bool(_FRONT.search(name)), bool(_REAR.search(name))
        if is_front != is_rear:
            along[is_front].append(float(link.pose.place @ ahead))
    if not along[True] or not along[False]:
        return None
    difference = float(np.mean(along[True]) - np.mean(along[False]))
    if abs(difference) < 1e-6:  # [m] they are in the same place
        return None
    return float(np.sign(difference)), "links called front are ahead of those called rear"


class _Sorting:
    """Sorts links from the root down; a link has its parent's carrier, or its own joint as one."""

    def __init__(self, tree: Tree, view: SideView, surfaces: Surfaces) -> None:
        self.tree = tree
        self.view = view
        self.hanging = subtrees(tree)
        self.moved = surfaces.moved
        self.links = tree.by_name
        self.wheels = wheel_shapes(tree)
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
        driven = {
            child for child in self.wheels if self.tree.joints[child].name in self.tree.driven
        }
        gear.passive = set(self.wheels) - driven if driven else set()
        gear.arms = [self.arm(joint) for joint in arms.values()]
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
        """Return the joint that moves a link, None if the chassis carries it; record flippers."""
        places = list(self.places(joint))
        if joint.kind == "fixed":
            return above
        if not places:
            return above if joint.is_locked or above is not None else joint
        if self.is_arm(joint, places):
            if above is not None:
                self.refuse(joint, "must not be a flipper on another moving part")
            if joint.stiffness > 0.0:
                self.refuse(joint, "must have no spring: a side view has no suspension")
            arms[joint.child] = joint
            return joint
        if joint.is_locked:
            return above
        return self.refuse(joint, self.rule(joint))

    def rule(self, joint: Joint) -> str:
        """Return the rule broken by a joint that carries wheels, but is not a flipper's pivot."""
        if joint.kind == "slide" or joint.stiffness > 0.0:
            return "must carry no wheels: a side view has no suspension"
        if joint.kind != "hinge":
            return "must be fixed or turn about an axis, to carry wheels"
        if is_parallel(joint.axis, self.view.left):
            return "must carry no wheels on both sides of it: a side view has no rocker"
        return "must carry no wheels: a side view has no steering"

    def refuse(self, joint: Joint, rule: str) -> NoReturn:
        raise ScenarioError(joint.path, joint.kind, rule)

    def places(self, joint: Joint) -> Iterator[Array]:
        """[m] Yield the positions of the wheels and drums that a joint carries."""
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
        """Return the shapes of a link, none if it is part of a wheel."""
        return () if link.name in self.turning else link.shapes

    def runners_of(self, link: Link) -> Iterator[Runner]:
        """Yield a link as a wheel if it is one, and its drums."""
        if link.name in self.wheels:
            yield self.wheel(self.tree.joints[link.name])
        for shape in self.still(link):
            if shape in self.moved and shape.kind in _DRUMS:
                yield self.drum(link, shape)

    def wheel(self, joint: Joint) -> Runner:
        shapes = self.wheels[joint.child]
        if not is_parallel(joint.axis, self.view.left):
            self.refuse(
                joint, "must turn about the axis of the other wheels: a side view has no steering"
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
            path = shape.path
            raise ScenarioError(
                path, shape.kind, "must have a lateral axis to be a drum of a track"
            )
        x, y, z = (float(part) for part in self.view.of(shape.pose.place))
        name = f"{link.name}/{shape.name}"
        return Runner(name=name, x=x, y=y, z=z, radius=shape.radius, link=link, shape=shape)

    def arm(self, joint: Joint) -> Arm:
        links = [self.links[name] for name in self.hanging[joint.child]]
        return Arm(
            joint=joint,
            pivot=self.view.of(joint.place),
            links=tuple(links),
            runners=tuple(runner for link in links for runner in self.runners_of(link)),
            shapes=tuple(
                (link, shape)
                for link in links
                for shape in self.still(link)
                if shape not in self.moved or shape.kind not in _DRUMS
            ),
        )
