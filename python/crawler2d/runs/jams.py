"""All jams: poses in which a robot can stand still while its drives run."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import NoneType
from typing import TYPE_CHECKING, Any

from crawler2d import _core
from crawler2d.common.bodies import BodyKind, Disc, end_discs
from crawler2d.parameters.track import BeltTrack, ClosedTrack
from crawler2d.runs.batch import complete

if TYPE_CHECKING:
    from crawler2d.parameters.robot import Robot
    from crawler2d.parameters.scenario import Scenario
    from crawler2d.parameters.terrain import Terrain

__all__ = ["Jam", "JamContact", "jams", "on_belt"]

_STILL = 1e-6
"""[-] Fraction of the weight below which a contact counts as unloaded."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JamContact:
    """A load-bearing contact of a jammed robot.

    Attributes
    ----------
    body : int
        Number of the body, as in the contacts of a run.
    body_kind : BodyKind
        Its kind.
    edge : int or None
        Number of the edge of the ground that it touches, None on a face.
    x, y : float
        [m] Position of the contact.
    normal_x, normal_y : float
        [-] Unit vector from the ground to the robot.
    normal_force : float
        [N] Force along the normal.
    friction_force : float
        [N] Force along the normal turned by -90 degrees: on level ground, above 0 is forwards.
    """

    body: int
    body_kind: BodyKind
    edge: int | None
    x: float
    y: float
    normal_x: float
    normal_y: float
    normal_force: float
    friction_force: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Jam:
    """A pose in which a robot can stand still while its drives run; ``str(jam)`` describes it.

    Attributes
    ----------
    position : tuple of 2 floats
        [m] Origin of the chassis frame.
    chassis_angle : float
        [rad] Nose up > 0.
    contacts : tuple of JamContact
        Load-bearing contacts, from the rear. If statics does not determine the loads, as on three
        wheels in a row, they are the mean over all sets of three contacts that can carry the robot.
    between : tuple of 2 ints or None
        Numbers of the bodies on either side of the ground that reaches deepest into the track, the
        smaller one first; None without such ground.
    depth : float
        [m] Its depth inside the belt round the circumscribed circles; 0 without such ground.
    stable : bool
        Whether the robot stays within 1 mm and 0.01 rad in a simulation of 2 s that pushes it
        forwards and then back with 1 % of its weight.
    belt_holds : bool
        Whether a belt round the same bodies jams at the same place: it has a stable jam with both
        ends of the track closer to their positions here than the smallest radius of the wheels in
        contact.
    """

    position: tuple[float, float]
    chassis_angle: float
    contacts: tuple[JamContact, ...]
    between: tuple[int, int] | None
    depth: float
    stable: bool
    belt_holds: bool

    def __str__(self) -> str:
        """Describe it in one line."""
        held = ", ".join(map(_contact_text, self.contacts))
        where = f"x = {self.position[0]:z.3f} m, {math.degrees(self.chassis_angle):z.1f} degrees"
        if self.between is not None and self.between[0] != self.between[1]:
            rear, front = self.between
            depth = f"{1e3 * self.depth:.0f} mm of ground"
            where = f"{where}, with {depth} between wheels {rear} and {front}"
        stable = "stable" if self.stable else "not stable"
        belt = "; a belt is held there, too" if self.belt_holds else ""
        return f"jam at {where}: {held}; {stable}{belt}"


def _contact_text(contact: JamContact) -> str:
    place = "a face" if contact.edge is None else f"edge {contact.edge}"
    kind = contact.body_kind.name.lower().replace("_", " ")
    return f"{kind} {contact.body} on {place} with {contact.normal_force:.0f} N"


def jams(
    scenario: Scenario | Robot,
    terrain: Terrain | None = None,
    *,
    friction: float | None = None,
    **fields: Any,
) -> tuple[Jam, ...]:
    """Find all poses in which a robot can stand still while its drives run.

    Driven surfaces slide at every contact in a known direction, so each contact has one unknown,
    its normal force. Three contacts fix the pose, and three equations of equilibrium fix three
    forces; with one or two contacts, the pose has as many degrees of freedom as forces are missing.
    All such poses are therefore isolated zeros of polynomials, and all zeros are found: see
    docs/studies/jams.md. The result depends on the friction, not on the speed.

    Motors have unlimited torque, and flippers keep their initial angle. On surfaces that do not
    move (the belly) friction may lie anywhere in its cone; jams on them are intervals of poses, and
    those of their ends that are found are returned: not all are.

    Parameters
    ----------
    scenario : Scenario or Robot
        A scenario, or a robot with a `terrain`. Its track model has round wheels or a smooth belt.
    terrain : Terrain, optional
        The ground, the same under both tracks; replaces the scenario's.
    friction : float, optional
        [-] Friction of the ground, above 0; None takes the terrain's.
    **fields : object
        Other fields of the scenario. A `drive.speed` below 0 drives backwards.

    Returns
    -------
    tuple of Jam
        All jams from the rear on, except those tilted by more than `criteria.tip_over_angle`.

    Raises
    ------
    ScenarioError
        If the scenario breaks a rule, or has an unsupported track model, no friction, friction by
        segment, no speed, or different ground under each track.
    SimulationDiverged
        If the simulation that tests stability became non-finite.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> robot = c2d.robots.engineer(flippers=None)
    >>> wheels = robot.with_track(c2d.LineOfWheels(4, wheel_radius=0.0608))
    >>> found = c2d.jams(wheels, c2d.terrains.step(0.075))
    >>> [jam.between for jam in found if jam.stable and not jam.belt_holds]
    [(1, 2)]
    """
    whole = complete("jams", ("friction",), scenario, terrain, fields)
    if friction is not None:
        whole = whole.replace({"terrain.friction": friction})
    found = _core.jams(whole.to_json())
    held = _held(whole) if len(found["x"]) else []
    wheels = whole.robot.wheels()
    radii = dict(zip(wheels["body"].tolist(), wheels["radius"].tolist(), strict=True))
    return tuple(_read(whole, found, k, held, radii) for k in range(len(found["x"])))


def on_belt(scenario: Scenario) -> Scenario:
    """Put a smooth belt round the bodies of a robot's tracks, unless all of them are belts."""
    track, arms = scenario.robot.track, scenario.robot.flippers
    of_arms = None if arms is None else arms.track  # None is the robot's; a closed one closes it
    is_belt = isinstance(track, BeltTrack) and isinstance(of_arms, (BeltTrack, NoneType))
    if is_belt or isinstance(track, ClosedTrack):
        return scenario
    closed = ClosedTrack(track, surface="smooth")
    return scenario.replace({"robot": scenario.robot.with_track(closed)})


def _held(scenario: Scenario) -> list[tuple[float, float, float]]:
    """Stable jams of a belt round the same bodies: position [m] and angle [rad]."""
    found = _core.jams(on_belt(scenario).to_json())
    poses = zip(found["x"], found["y"], found["angle"], found["stable"], strict=True)
    return [(x, y, angle) for x, y, angle, stable in poses if stable]


def _read(
    scenario: Scenario,
    found: dict[str, Any],
    number: int,
    held: list[tuple[float, float, float]],
    radii: dict[int, float],
) -> Jam:
    rows = found["contacts"]
    weight = scenario.robot.mass * scenario.gravity
    of_jam = [i for i, jam in enumerate(rows["jam"]) if jam == number]
    carries = [i for i in of_jam if rows["normal_load"][i] > _STILL]
    contacts = tuple(
        JamContact(
            body=int(rows["body"][i]),
            body_kind=BodyKind(int(rows["body_kind"][i])),
            edge=None if rows["edge"][i] < 0 else int(rows["edge"][i]),
            x=float(rows["x"][i]),
            y=float(rows["y"][i]),
            normal_x=float(rows["normal_x"][i]),
            normal_y=float(rows["normal_y"][i]),
            normal_force=float(weight * rows["normal_load"][i]),
            friction_force=float(weight * rows["friction"][i]),
        )
        for i in sorted(carries, key=lambda i: (rows["x"][i], rows["body"][i]))
    )
    ends = end_discs(scenario.robot.outline.discs)
    touched = [radii[contact.body] for contact in contacts if contact.body in radii]
    reach = min((*touched, *(radius for *_, radius in ends)))
    x, y, angle = (float(found[name][number]) for name in ("x", "y", "angle"))
    return Jam(
        position=(x, y),
        chassis_angle=angle,
        contacts=contacts,
        between=found["between"][number] and tuple(sorted(found["between"][number])),
        depth=float(found["depth"][number]),
        stable=bool(found["stable"][number]),
        belt_holds=any(_is_near(ends, reach, (x, y, angle), other) for other in held),
    )


def _is_near(
    ends: tuple[Disc, Disc], reach: float, pose: tuple[float, ...], other: tuple[float, ...]
) -> bool:
    """Whether the ends of the track are within a distance [m] of each other in two poses."""
    return all(math.dist(_at(pose, disc), _at(other, disc)) < reach for disc in ends)


def _at(pose: tuple[float, ...], disc: Disc) -> tuple[float, float]:
    """Place the centre of a disc [m]."""
    (x, y, angle), (along, up, _) = pose, disc
    cosine, sine = math.cos(angle), math.sin(angle)
    return x + cosine * along - sine * up, y + sine * along + cosine * up
