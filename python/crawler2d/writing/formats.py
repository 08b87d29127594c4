"""A tree of links as SDF, URDF and MJCF, with what drives it in each."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from xml.etree import ElementTree

from crawler2d.model_tree import Array, Friction, Joint, Link, Pose, Shape, Tree
from crawler2d.writing.carriers import Across, Format
from crawler2d.writing.model import Limits, flipper_joints, moved_links, wheels_by_radius

__all__ = [
    "MJCF",
    "SDF",
    "URDF",
    "XML",
    "commented",
    "document",
    "element",
    "exactly",
    "mjcf_of",
    "numbers",
    "pose_text",
    "sdf_of",
    "surface",
    "urdf_of",
]

XML = ElementTree.Element
"""An element."""

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

URDF = Format(name="URDF", moves_surfaces=False, has_hulls=False, has_rotors=False)
"""URDF has meshes in files of their own only, and nothing that moves a surface. A rotor inertia has
a place in extensions of Drake only."""
_UPPER = [(row, column) for row in range(3) for column in range(row, 3)]

MJCF = Format(name="MJCF", moves_surfaces=True, has_hulls=True, has_rotors=True)
"""MJCF has the corners of meshes in the file itself, and surfaces that move."""

# A motor without a controller gives all of its torque where it is off by this share of its largest
# speed, or this angle.
_OFF_SPEED, _OFF_ANGLE = 0.02, 0.02  # [-] and [rad]


def element(tag: str, *children: XML | None, text: str = "", **attributes: str) -> XML:
    """Make an element with attributes, text and children; None stands for no child."""
    made = ElementTree.Element(tag, attributes)
    made.text = text or None
    made.extend([child for child in children if child is not None])
    return made


def numbers(values: Iterable[float] | Array | float) -> str:
    """Write numbers of twelve digits; there is only one zero.

    The last four digits of a sum or a turn are rounding, and nobody wants to read them. The exact
    robot is in the comment.

    Examples
    --------
    >>> numbers((0.1 + 0.2, -0.0, 1e-7))
    '0.3 0 1e-07'
    """
    return " ".join(f"{value:.12g}" for value in _each(values))


def exactly(values: Iterable[float] | Array | float) -> str:
    """Write numbers that read back to the same bits.

    Moments of inertia are: those of thin bodies just obey their inequality, and still must.

    Examples
    --------
    >>> exactly((0.1 + 0.2, -0.0))
    '0.30000000000000004 0.0'
    """
    return " ".join(repr(value) for value in _each(values))


def document(root: XML, comment: str) -> str:
    """Write an element as a file of its own, with a comment before it.

    Parameters
    ----------
    root : Element
        The root.
    comment : str
        In lines of ASCII.

    Returns
    -------
    str
        The text, with a line feed at its end.
    """
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n<!--\n{comment}\n-->\n{body}\n'


def commented(value: object) -> str:
    r"""Write plain data as JSON that may stand in a comment: in ASCII, and without two hyphens.

    Examples
    --------
    >>> commented({"name": "a--b", "mass": -1.5})
    '{"name":"a-\\u002db","mass":-1.5}'
    """
    text = json.dumps(value, separators=(",", ":"))
    # Only a string can have two hyphens in a row, and JSON may write any letter of it like this.
    return re.sub("(?<=-)-", r"\\u002d", text)


def sdf_of(tree: Tree, across: Across, limits: Limits, stand: Pose) -> XML:
    """Write a model, its chassis frame where it stands."""
    model = element("model", element("pose", text=pose_text(stand)), name=tree.name)
    for link in tree.links:
        model.append(_sdf_link(link))
        if link.name in tree.joints:
            model.append(_sdf_joint(tree.joints[link.name]))
    model.extend(_plugins(tree, across, limits))
    return element("sdf", model, version=_VERSION)


def pose_text(pose: Pose) -> str:
    """Write a pose: place, then roll, pitch and yaw."""
    return numbers([*pose.place, *pose.rpy])


def surface(friction: Friction) -> XML:
    """Write coefficients of friction."""
    first, second = friction.first, friction.second
    ode = element("ode", element("mu", text=numbers(first)), element("mu2", text=numbers(second)))
    return element("surface", element("friction", ode))


def urdf_of(tree: Tree) -> XML:
    """Write a robot in the frame of its root."""
    links = tree.by_name
    root = element("robot", name=tree.name)
    for link in tree.links:
        root.append(_urdf_link(link))
        if link.name in tree.joints:
            joint = tree.joints[link.name]
            root.append(_urdf_joint(joint, link, links[joint.parent]))
    for link in tree.links:
        friction = _friction(link)
        if friction is not None:
            pair = (element(f"mu{n}", text=numbers(friction)) for n in (1, 2))
            root.append(element("gazebo", *pair, reference=link.name))
    return root


def mjcf_of(tree: Tree, stand: Pose) -> XML:
    """Write a model without a ground, its chassis frame where it stands."""
    bodies: dict[str, XML] = {}
    world = element("worldbody")
    links = tree.by_name
    for link in tree.links:
        joint = tree.joints.get(link.name)
        if joint is None:
            body = _body(link, stand.then(link.pose))
            body.insert(0, element("freejoint", name=f"{link.name}_joint"))
            world.append(body)
        else:
            body = _body(link, link.pose.seen_from(links[joint.parent].pose))
            if joint.kind != "fixed":
                body.insert(0, _mjcf_joint(joint, link))
            bodies[joint.parent].append(body)
        bodies[link.name] = body
    meshes = [
        element("mesh", name=shape.name, vertex=numbers((shape.points - shape.pose.place).ravel()))
        for link in tree.links
        for shape in link.shapes
        if shape.kind == "hull"
    ]
    motors = [_motor(joint) for joint in tree.joints.values() if joint.name in tree.driven]
    return element(
        "mujoco",
        element("compiler", angle="radian", autolimits="true"),
        # Its steps take the servos implicitly, which others could only do with tiny ones.
        element("option", integrator="implicitfast"),
        element("asset", *meshes) if meshes else None,
        world,
        element("actuator", *motors),
        model=tree.name,
    )


def _each(values: Iterable[float] | Array | float) -> Iterator[float]:
    for value in [values] if isinstance(values, float | int) else values:
        yield float(value) + 0.0


def _sdf_link(link: Link) -> XML:
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
            element(
                tag, element("pose", text=pose), _sdf_geometry(shape), name=f"{shape.name}_{tag}"
            )
            for tag in ("collision", "visual")
        )
        if shape.friction is not None:
            collision.append(surface(shape.friction))
        made.extend([collision, visual])
    return made


def _sdf_geometry(shape: Shape) -> XML:
    if shape.kind == "box":
        return element("geometry", element("box", element("size", text=numbers(shape.size))))
    radius = element("radius", text=numbers(shape.radius))
    length = element("length", text=numbers(shape.length))
    return element("geometry", element("cylinder", radius, length))


def _sdf_joint(joint: Joint) -> XML:
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


def _plugin(system: str, file: str, *children: XML) -> XML:
    name = f"gz::sim::systems::{system}"
    return element("plugin", *children, filename=f"gz-sim-{file}-system", name=name)


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


def _urdf_link(link: Link) -> XML:
    center = Pose(place=link.center).seen_from(link.pose)
    moments = link.pose.turn.T @ link.inertia @ link.pose.turn
    inertia = {f"i{'xyz'[i]}{'xyz'[j]}": exactly(float(moments[i, j])) for i, j in _UPPER}
    made = element(
        "link",
        element(
            "inertial",
            _origin(Pose(place=center.place)),
            element("mass", value=numbers(link.mass)),
            element("inertia", **inertia),
        ),
        name=link.name,
    )
    for shape in link.shapes:
        origin = shape.pose.seen_from(link.pose)
        for tag in ("collision", "visual"):
            made.append(
                element(tag, _origin(origin), _urdf_geometry(shape), name=f"{shape.name}_{tag}")
            )
    friction = _friction(link)
    if friction is not None:
        made.append(element("contact", element("lateral_friction", value=numbers(friction))))
    return made


def _origin(pose: Pose) -> XML:
    return element("origin", xyz=numbers(pose.place), rpy=numbers(pose.rpy))


def _urdf_geometry(shape: Shape) -> XML:
    if shape.kind == "box":
        return element("geometry", element("box", size=numbers(shape.size)))
    sizes = {"radius": numbers(shape.radius), "length": numbers(shape.length)}
    return element("geometry", element("cylinder", **sizes))


def _friction(link: Link) -> float | None:
    """[-] Return the coefficient of a link: URDF has one for all of its shapes."""
    return next((shape.friction.first for shape in link.shapes if shape.friction), None)


def _urdf_joint(joint: Joint, link: Link, parent: Link) -> XML:
    kind = {"fixed": "fixed", "hinge": "continuous" if joint.is_unlimited else "revolute"}
    made = element(
        "joint",
        element("parent", link=joint.parent),
        element("child", link=joint.child),
        _origin(link.pose.seen_from(parent.pose)),
        name=joint.name,
        type=kind[joint.kind],
    )
    if joint.kind == "fixed":
        return made
    limits = [("effort", joint.effort), ("velocity", joint.velocity)]
    if not joint.is_unlimited:
        limits += [("lower", joint.lower), ("upper", joint.upper)]
    given = {name: numbers(value) for name, value in limits if value is not None}
    axis = link.pose.turn.T @ joint.axis
    made.extend([element("axis", xyz=numbers(axis)), element("limit", **given)])
    return made


def _body(link: Link, pose: Pose) -> XML:
    center = Pose(place=link.center).seen_from(link.pose)
    moments = link.pose.turn.T @ link.inertia @ link.pose.turn
    order = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    inertial = element(
        "inertial",
        pos=numbers(center.place),
        mass=numbers(link.mass),
        fullinertia=exactly(float(moments[i, j]) for i, j in order),
    )
    geoms = [_geom(shape, link) for shape in link.shapes]
    return element("body", inertial, *geoms, name=link.name, **_placed(pose))


def _geom(shape: Shape, link: Link) -> XML:
    kinds = {"box": "box", "cylinder": "cylinder", "hull": "mesh"}
    given = {"name": shape.name, "type": kinds[shape.kind]}
    given |= _placed(shape.pose.seen_from(link.pose))
    if shape.kind == "box":
        given["size"] = numbers(0.5 * shape.size)
    elif shape.kind == "cylinder":
        given["size"] = numbers((shape.radius, 0.5 * shape.length))
    else:
        given["mesh"] = shape.name
    if shape.friction is not None:
        # Of two surfaces the larger friction holds, unless one has the higher priority.
        given |= {"friction": numbers(shape.friction.first), "priority": "1"}
    if shape.surface_speed:
        given["surfacevel"] = numbers(_surface_velocity(shape))
    # Parts of the robot do not touch each other, but everything else.
    return element("geom", **given, contype="1", conaffinity="0")


def _placed(pose: Pose) -> dict[str, str]:
    return {"pos": numbers(pose.place), "quat": numbers(pose.quaternion)}


def _surface_velocity(shape: Shape) -> list[float]:
    """[m/s, rad/s] Return what turns a surface like a wheel that drives forward."""
    if shape.kind == "cylinder":
        return [0.0, 0.0, 0.0, 0.0, 0.0, shape.surface_speed / shape.radius]
    return [0.0, 0.0, 0.0, 0.0, 2.0 * shape.surface_speed / float(shape.size[2]), 0.0]


def _mjcf_joint(joint: Joint, link: Link) -> XML:
    made = element("joint", name=joint.name, type="hinge")
    made.set("axis", numbers(link.pose.turn.T @ joint.axis))
    if not joint.is_unlimited:
        made.set("range", numbers((joint.lower, joint.upper)))
    if joint.armature:
        made.set("armature", numbers(joint.armature))
    return made


def _motor(joint: Joint) -> XML | None:
    """Return a servo of the speed of a wheel, or of the angle of a flipper; None without torque."""
    if not joint.effort or not joint.velocity:
        return None
    given = {
        "name": joint.name,
        "joint": joint.name,
        "ctrlrange": numbers((-joint.velocity, joint.velocity)),
        "forcerange": numbers((-joint.effort, joint.effort)),
    }
    if joint.is_unlimited:
        firm = joint.effort / (_OFF_SPEED * joint.velocity)
        gain = firm if joint.gain is None else joint.gain
        return element("velocity", kv=numbers(gain), **given)
    angles = numbers((joint.lower, joint.upper))
    gain = joint.effort / _OFF_ANGLE
    return element("intvelocity", kp=numbers(gain), dampratio="1", actrange=angles, **given)
