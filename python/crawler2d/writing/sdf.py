"""A neutral tree as SDF 1.6, with the plugins of Gazebo that move wheels, belts and flippers."""

from __future__ import annotations

from crawler2d.models.poses import Pose
from crawler2d.models.tree import Friction, Joint, Link, Shape, Tree
from crawler2d.writing.across import Across
from crawler2d.writing.held import Format
from crawler2d.writing.motors import Limits, flipper_joints, moved_links, wheels_by_radius
from crawler2d.writing.xml import XML, element, exactly, numbers

__all__ = ["SDF", "pose_text", "sdf_of", "surface"]

SDF = Format(
    name="SDF",
    moves_surfaces=True,
    has_hulls=False,
    has_rotors=False,
    reserved=".*::.*|__.*__",
)
"""SDF has meshes in files of their own only. A rotor inertia has a place in extensions of Drake
only."""

# Newer versions add nothing that is needed here, and DART reads none of them.
_VERSION = "1.6"
_KINDS = {"hinge": "revolute", "fixed": "fixed"}


def sdf_of(tree: Tree, across: Across, limits: Limits, stand: Pose) -> XML:
    """Write a model, its chassis frame where it stands."""
    model = element("model", element("pose", text=pose_text(stand)), name=tree.name)
    for link in tree.links:
        model.append(_link(link))
        if link.name in tree.joints:
            model.append(_joint(tree.joints[link.name]))
    model.extend(_plugins(tree, across, limits))
    return element("sdf", model, version=_VERSION)


def pose_text(pose: Pose) -> str:
    """Write a pose: place, then roll, pitch and yaw."""
    return numbers([*pose.place, *pose.rpy])


def _link(link: Link) -> XML:
    center = Pose(place=link.center).seen_from(link.pose)
    upper = [(row, column) for row in range(3) for column in range(row, 3)]
    moments = link.pose.turn.T @ link.inertia @ link.pose.turn
    inertia = element(
        "inertia",
        *(
            element(f"i{'xyz'[row]}{'xyz'[column]}", text=exactly(float(moments[row, column])))
            for row, column in upper
        ),
    )
    made = element(
        "link",
        element("pose", text=pose_text(link.pose)),
        element(
            "inertial",
            element("pose", text=numbers([*center.place, 0.0, 0.0, 0.0])),
            element("mass", text=numbers(link.mass)),
            inertia,
        ),
        name=link.name,
    )
    for shape in link.shapes:
        pose = pose_text(shape.pose.seen_from(link.pose))
        collision, visual = (
            element(tag, element("pose", text=pose), _geometry(shape), name=f"{shape.name}_{tag}")
            for tag in ("collision", "visual")
        )
        if shape.friction is not None:
            collision.append(surface(shape.friction))
        made.extend([collision, visual])
    return made


def _geometry(shape: Shape) -> XML:
    if shape.kind == "box":
        return element("geometry", element("box", element("size", text=numbers(shape.size))))
    radius = element("radius", text=numbers(shape.radius))
    length = element("length", text=numbers(shape.length))
    return element("geometry", element("cylinder", radius, length))


def surface(friction: Friction) -> XML:
    """Write coefficients of friction."""
    first, second = friction.first, friction.second
    ode = element("ode", element("mu", text=numbers(first)), element("mu2", text=numbers(second)))
    return element("surface", element("friction", ode))


def _joint(joint: Joint) -> XML:
    made = element(
        "joint",
        element("parent", text=joint.parent),
        element("child", text=joint.child),
        name=joint.name,
        type=_KINDS[joint.kind],
    )
    if joint.kind == "fixed":
        return made
    limit = element("limit")
    bounds = () if joint.is_unlimited else (("lower", joint.lower), ("upper", joint.upper))
    for name, value in (*bounds, ("effort", joint.effort), ("velocity", joint.velocity)):
        if value is not None:
            limit.append(element(name, text=numbers(value)))
    made.append(element("axis", element("xyz", text=numbers(joint.axis)), limit))
    return made


def _plugins(tree: Tree, across: Across, limits: Limits) -> list[XML]:
    """Return what drives the model, by the topic cmd_vel of its name, and holds its flippers."""
    return [
        *(
            _differential(radius, joints, across, limits)
            for radius, joints in wheels_by_radius(tree, limits)
        ),
        *_tracks(tree, across, limits),
        *(_servo(joint) for joint in flipper_joints(tree)),
    ]


def _plugin(system: str, file: str, *children: XML) -> XML:
    name = f"gz::sim::systems::{system}"
    return element("plugin", *children, filename=f"gz-sim-{file}-system", name=name)


def _differential(radius: float, joints: list[Joint], across: Across, limits: Limits) -> XML:
    """Return a drive of wheels of one radius: a drive has one, and all obey the same command."""
    sides = [
        element(f"{'left' if joint.place[1] > 0.0 else 'right'}_joint", text=joint.name)
        for joint in joints
    ]
    return _plugin(
        "DiffDrive",
        "diff-drive",
        *sides,
        element("wheel_separation", text=numbers(across.gauge)),
        element("wheel_radius", text=numbers(radius)),
        element("max_linear_velocity", text=numbers(limits.speed)),
        element("min_linear_velocity", text=numbers(-limits.speed)),
        element("max_linear_acceleration", text=numbers(limits.acceleration)),
        element("min_linear_acceleration", text=numbers(-limits.deceleration)),
    )


def _tracks(tree: Tree, across: Across, limits: Limits) -> list[XML]:
    """Return a controller for each belt, and what commands all of them."""
    belts = moved_links(tree)
    if not belts:
        return []
    sides = [
        element(
            f"{'left' if link.pose.place[1] > 0.0 else 'right'}_track",
            element("link", text=link.name),
        )
        for link in belts
    ]
    vehicle = _plugin(
        "TrackedVehicle",
        "tracked-vehicle",
        *sides,
        element("tracks_separation", text=numbers(across.gauge)),
        element("tracks_height", text=numbers(limits.track_height)),
    )
    controllers = [
        _plugin(
            "TrackController",
            "track-controller",
            element("link", text=link.name),
            element("min_velocity", text=numbers(-limits.speed)),
            element("max_velocity", text=numbers(limits.speed)),
        )
        for link in belts
    ]
    return [vehicle, *controllers]


def _servo(joint: Joint) -> XML:
    """Return what turns a flipper to the angle that is commanded, at first where it is."""
    return _plugin(
        "JointPositionController",
        "joint-position-controller",
        element("joint_name", text=joint.name),
        element("use_velocity_commands", text="true"),
        element("cmd_max", text=numbers(joint.velocity or 0.0)),
        element("cmd_min", text=numbers(-(joint.velocity or 0.0))),
    )
