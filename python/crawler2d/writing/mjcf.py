"""A neutral tree as MJCF: wheels and flippers with servos, belts with surfaces that move."""

from __future__ import annotations

from crawler2d.models.poses import Pose
from crawler2d.models.tree import Joint, Link, Shape, Tree
from crawler2d.writing.held import Format
from crawler2d.writing.xml import XML, element, exactly, numbers

__all__ = ["MJCF", "mjcf_of"]

MJCF = Format(name="MJCF", moves_surfaces=True, has_hulls=True, has_rotors=True)
"""MJCF has the corners of meshes in the file itself, and surfaces that move."""

# A motor without a controller gives all of its torque where it is off by this share of its largest
# speed, or this angle.
_OFF_SPEED, _OFF_ANGLE = 0.02, 0.02  # [-] and [rad]


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
                body.insert(0, _joint(joint, link))
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


def _placed(pose: Pose) -> dict[str, str]:
    return {"pos": numbers(pose.place), "quat": numbers(pose.quaternion)}


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


def _surface_velocity(shape: Shape) -> list[float]:
    """[m/s, rad/s] Return what turns a surface like a wheel that drives forward."""
    if shape.kind == "cylinder":
        return [0.0, 0.0, 0.0, 0.0, 0.0, shape.surface_speed / shape.radius]
    return [0.0, 0.0, 0.0, 0.0, 2.0 * shape.surface_speed / float(shape.size[2]), 0.0]


def _joint(joint: Joint, link: Link) -> XML:
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
