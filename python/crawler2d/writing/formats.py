"""A tree of links as SDF, URDF and MJCF, with its drives in each."""

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
    "texts",
    "urdf_of",
]

XML = ElementTree.Element
"""An element."""

SDF = Format(
    name="SDF",
    moves_surfaces=True,
    has_hulls=False,
    has_rotors=False,
    reserved="world|.*::.*|__.*__",
)
"""SDF has meshes only in separate files, and rotor inertia only in extensions of Drake."""

# Newer versions add nothing that is needed here, and DART reads none of them.
_VERSION = "1.6"

_KINDS = {"hinge": "revolute", "fixed": "fixed"}

URDF = Format(name="URDF", moves_surfaces=False, has_hulls=False, has_rotors=False)
"""URDF has meshes only in separate files, rotor inertia only in extensions of Drake, and no moving
surfaces."""

_MOMENTS = {f"i{'xyz'[i]}{'xyz'[j]}": (i, j) for i in range(3) for j in range(i, 3)}

MJCF = Format(name="MJCF", moves_surfaces=True, has_hulls=True, has_rotors=True)
"""MJCF has the corners of meshes in the file itself, and moving surfaces."""

# A motor without a controller has its full torque at an error of this fraction of its largest
# speed, or of this angle.
_OFF_SPEED, _OFF_ANGLE = 0.02, 0.02  # [-] and [rad]


def element(tag: str, *children: XML | None, text: str = "", **attributes: str) -> XML:
    """Build an element with attributes, text and children; None stands for no child."""
    built = ElementTree.Element(tag, attributes)
    built.text = text or None
    built.extend([child for child in children if child is not None])
    return built


def texts(**values: str | float | Iterable[float]) -> list[XML]:
    """Build an element for each value."""
    return [
        element(tag, text=value if isinstance(value, str) else numbers(value))
        for tag, value in values.items()
    ]


def numbers(values: Iterable[float] | Array | float) -> str:
    """Write numbers with twelve digits, and negative zeros as 0.

    The last four digits of a sum or rotation are rounding errors, and would clutter the file. The
    exact robot is in the comment.

    Examples
    --------
    >>> numbers((0.1 + 0.2, -0.0, 1e-7))
    '0.3 0 1e-07'
    """
    return " ".join(f"{value:.12g}" for value in _each(values))


def exactly(values: Iterable[float] | Array | float) -> str:
    """Write numbers so that they are read back exactly.

    Moments of inertia need this: those of thin bodies are on the limit of their inequality, and
    must not exceed it.

    Examples
    --------
    >>> exactly((0.1 + 0.2, -0.0))
    '0.30000000000000004 0.0'
    """
    return " ".join(repr(value) for value in _each(values))


def document(root: XML, comment: str) -> str:
    """Write an element as a complete file, with a comment before it.

    Parameters
    ----------
    root : Element
        The root.
    comment : str
        Lines of ASCII.

    Returns
    -------
    str
        The text, with a line feed at its end.
    """
    ElementTree.indent(root)
    body = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="utf-8"?>\n<!--\n{comment}\n-->\n{body}\n'


def commented(value: object) -> str:
    r"""Write plain data as JSON for a comment: in ASCII, and without two hyphens in a row.

    Examples
    --------
    >>> commented({"name": "a--b", "mass": -1.5})
    '{"name":"a-\\u002db","mass":-1.5}'
    """
    text = json.dumps(value, separators=(",", ":"))
    # Only strings can have two hyphens in a row, and JSON may escape any of their characters.
    return re.sub("(?<=-)-", r"\\u002d", text)


def sdf_of(tree: Tree, across: Across, limits: Limits, stand: Pose) -> XML:
    """Write a model with its chassis frame at the pose `stand`."""
    model = element("model", *texts(pose=pose_text(stand)), name=tree.name)
    for link in tree.links:
        model.append(_sdf_link(link))
        if link.name in tree.joints:
            model.append(_sdf_joint(tree.joints[link.name]))
    model.extend(_plugins(tree, across, limits))
    return element("sdf", model, version=_VERSION)


def pose_text(pose: Pose) -> str:
    """Write a pose: position, then roll, pitch and yaw."""
    return numbers([*pose.place, *pose.rpy])


def surface(friction: Friction) -> XML:
    """Write coefficients of friction."""
    ode = element("ode", *texts(mu=friction.first, mu2=friction.second))
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
            pair = texts(mu1=friction, mu2=friction)
            root.append(element("gazebo", *pair, reference=link.name))
    return root


def mjcf_of(tree: Tree, stand: Pose) -> XML:
    """Write a model without ground, with its chassis frame at the pose `stand`."""
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
        # It integrates the servos implicitly; other integrators would need tiny steps.
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
    center, moments = _inertial(link)
    inertial = element(
        "inertial",
        *texts(pose=f"{center} 0 0 0", mass=link.mass),
        element("inertia", *texts(**moments)),
    )
    built = element("link", *texts(pose=pose_text(link.pose)), inertial, name=link.name)
    for shape in link.shapes:
        pose = pose_text(shape.pose.seen_from(link.pose))
        collision, visual = (
            element(tag, *texts(pose=pose), _sdf_geometry(shape), name=f"{shape.name}_{tag}")
            for tag in ("collision", "visual")
        )
        if shape.friction is not None:
            collision.append(surface(shape.friction))
        built.extend([collision, visual])
    return built


def _inertial(link: Link) -> tuple[str, dict[str, str]]:
    """Return centre of mass and moments of inertia in the frame of a link, as texts."""
    center = Pose(place=link.center).seen_from(link.pose).place
    tensor = link.pose.turn.T @ link.inertia @ link.pose.turn
    moments = {name: exactly(float(tensor[i, j])) for name, (i, j) in _MOMENTS.items()}
    return numbers(center), moments


def _sdf_geometry(shape: Shape) -> XML:
    if shape.kind == "box":
        return element("geometry", element("box", *texts(size=shape.size)))
    return element(
        "geometry", element("cylinder", *texts(radius=shape.radius, length=shape.length))
    )


def _sdf_joint(joint: Joint) -> XML:
    built = element(
        "joint",
        *texts(parent=joint.parent, child=joint.child),
        name=joint.name,
        type=_KINDS[joint.kind],
    )
    if joint.kind != "fixed":
        limits = _limits(joint, "lower", "upper", "effort", "velocity")
        limit = element("limit", *texts(**limits))
        built.append(element("axis", *texts(xyz=joint.axis), limit))
    return built


def _limits(joint: Joint, *names: str) -> dict[str, str]:
    """Return the limits that a joint has, as texts."""
    given = [name for name in names if not (joint.is_unlimited and name in ("lower", "upper"))]
    values = {name: getattr(joint, name) for name in given}
    return {name: numbers(value) for name, value in values.items() if value is not None}


def _plugins(tree: Tree, across: Across, limits: Limits) -> Iterator[XML]:
    """Yield the drives of the model, which obey its cmd_vel, and servos of its flippers."""
    for radius, joints in wheels_by_radius(tree, limits):
        # Each drive has one radius; all obey the same command.
        yield _plugin(
            "DiffDrive",
            "diff-drive",
            *(element(f"{_side(joint.place)}_joint", text=joint.name) for joint in joints),
            *texts(
                wheel_separation=across.gauge,
                wheel_radius=radius,
                max_linear_velocity=limits.speed,
                min_linear_velocity=-limits.speed,
                max_linear_acceleration=limits.acceleration,
                min_linear_acceleration=-limits.deceleration,
            ),
        )
    belts = moved_links(tree)
    if belts:
        yield _plugin(
            "TrackedVehicle",
            "tracked-vehicle",
            *(element(f"{_side(link.pose.place)}_track", *texts(link=link.name)) for link in belts),
            *texts(tracks_separation=across.gauge, tracks_height=limits.track_height),
        )
    for link in belts:
        speeds = texts(link=link.name, min_velocity=-limits.speed, max_velocity=limits.speed)
        yield _plugin("TrackController", "track-controller", *speeds)
    for joint in flipper_joints(tree):  # turned to the commanded angle, initially their own
        rate = joint.velocity or 0.0
        names = texts(joint_name=joint.name, use_velocity_commands="true")
        limits_of_rate = texts(cmd_max=rate, cmd_min=-rate)
        yield _plugin(
            "JointPositionController", "joint-position-controller", *names, *limits_of_rate
        )


def _plugin(system: str, file: str, *children: XML) -> XML:
    name = f"gz::sim::systems::{system}"
    return element("plugin", *children, filename=f"gz-sim-{file}-system", name=name)


def _side(place: Array) -> str:
    return "left" if place[1] > 0.0 else "right"


def _urdf_link(link: Link) -> XML:
    center, moments = _inertial(link)
    inertial = element(
        "inertial",
        element("origin", xyz=center, rpy="0 0 0"),
        element("mass", value=numbers(link.mass)),
        element("inertia", **moments),
    )
    built = element("link", inertial, name=link.name)
    for shape in link.shapes:
        pose = shape.pose.seen_from(link.pose)
        for tag in ("collision", "visual"):
            name = f"{shape.name}_{tag}"
            built.append(element(tag, _origin(pose), _urdf_geometry(shape), name=name))
    friction = _friction(link)
    if friction is not None:
        built.append(element("contact", element("lateral_friction", value=numbers(friction))))
    return built


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
    built = element(
        "joint",
        element("parent", link=joint.parent),
        element("child", link=joint.child),
        _origin(link.pose.seen_from(parent.pose)),
        name=joint.name,
        type=kind[joint.kind],
    )
    if joint.kind != "fixed":
        axis = element("axis", xyz=numbers(link.pose.turn.T @ joint.axis))
        limits = _limits(joint, "effort", "velocity", "lower", "upper")
        built.extend([axis, element("limit", **limits)])
    return built


def _body(link: Link, pose: Pose) -> XML:
    center, moments = _inertial(link)
    order = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
    inertial = element(
        "inertial",
        pos=center,
        mass=numbers(link.mass),
        fullinertia=" ".join(moments[name] for name in order),
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
        # The larger friction of two surfaces counts, unless one has the higher priority.
        given |= {"friction": numbers(shape.friction.first), "priority": "1"}
    if shape.surface_speed:
        given["surfacevel"] = numbers(_surface_velocity(shape))
    # Parts of the robot touch everything except each other.
    return element("geom", **given, contype="1", conaffinity="0")


def _placed(pose: Pose) -> dict[str, str]:
    return {"pos": numbers(pose.place), "quat": numbers(pose.quaternion)}


def _surface_velocity(shape: Shape) -> list[float]:
    """[m/s, rad/s] Return the velocity of a surface that moves like a wheel driving forward."""
    if shape.kind == "cylinder":
        return [0.0, 0.0, 0.0, 0.0, 0.0, shape.surface_speed / shape.radius]
    return [0.0, 0.0, 0.0, 0.0, 2.0 * shape.surface_speed / float(shape.size[2]), 0.0]


def _mjcf_joint(joint: Joint, link: Link) -> XML:
    given = {"name": joint.name, "type": "hinge", "axis": numbers(link.pose.turn.T @ joint.axis)}
    if not joint.is_unlimited:
        given["range"] = numbers((joint.lower, joint.upper))
    if joint.armature:
        given["armature"] = numbers(joint.armature)
    return element("joint", **given)


def _motor(joint: Joint) -> XML | None:
    """Return a servo for the speed of a wheel or the angle of a flipper; None without torque."""
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
