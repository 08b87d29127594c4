"""The frames of an SDF model: links, joints and named frames, each given in another one."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from crawler2d.models.poses import Pose, from_quaternion, from_rpy
from crawler2d.reading.elements import Element
from crawler2d.reading.telling import Doubt

__all__ = ["MODEL", "Frames", "pose_of"]

MODEL = "__model__"


def pose_of(element: Element, doubts: list[Doubt]) -> tuple[Pose, str]:
    """Read the pose of an element, and the name of the frame that it is given in, if any."""
    pose = element.first("pose", doubts)
    if pose is None or not (pose.text or pose.attributes):
        return Pose(), ""
    relative = pose.attributes.get("relative_to", "")
    if not pose.text:
        return Pose(), relative
    form = pose.attributes.get("rotation_format", "euler_rpy")
    if form == "quat_xyzw":
        x, y, z, *xyzw = pose.reals(7)
        if math.hypot(*xyzw) < 1e-6:
            pose.refuse(pose.text, "must have a quaternion that is not 0")
        return from_quaternion((xyzw[3], *xyzw[:3]), (x, y, z)), relative
    if form != "euler_rpy":
        pose.refuse(form, "must be euler_rpy or quat_xyzw", "@rotation_format")
    numbers = pose.reals(6)
    if pose.attributes.get("degrees", "false") in ("true", "1"):
        numbers[3:] = [math.radians(angle) for angle in numbers[3:]]
    return from_rpy(numbers[3:], numbers[:3]), relative


@dataclass(slots=True)
class Frames:
    """Poses by name in the frame of the model, worked out when asked for.

    What is in a nested model has names of its own: its scope, such as ``arm::``, goes before them.
    """

    doubts: list[Doubt]
    given: dict[str, tuple[Pose, str, Element]] = field(default_factory=dict)
    known: dict[str, Pose] = field(default_factory=lambda: {MODEL: Pose()})

    def add(self, name: str, element: Element, usual: str, scope: str) -> None:
        """Add a frame, given in the one that it names, or else in the usual one."""
        pose, relative = pose_of(element, self.doubts)
        within = scope + relative if relative else usual
        self.given.setdefault(name, (pose, within, element))

    def of(self, name: str, asked: Element) -> Pose:
        """Return the pose of a frame.

        Raises
        ------
        ScenarioError
            If there is no such frame, or it is given in itself by way of others.
        """
        chain: list[str] = []
        waiting: set[str] = set()
        while name not in self.known:
            if name not in self.given:
                asked.refuse(name, "must name a link, joint or frame of the model")
            if name in waiting:
                asked.refuse(name, "must not be a frame that is given in itself")
            chain.append(name)
            waiting.add(name)
            _, name, asked = self.given[name]
        for name in reversed(chain):
            pose, within, _ = self.given[name]
            self.known[name] = self.known[within].then(pose)
        return self.known[name] if not chain else self.known[chain[0]]

    def inside(self, element: Element, usual: str, scope: str) -> Pose:
        """Return the pose of something that is no frame itself, such as a collision."""
        pose, relative = pose_of(element, self.doubts)
        return self.of(scope + relative if relative else usual, element).then(pose)
