"""The complete content of a reading as lines of text: tree, robot and messages."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d.model_tree import Joint, Link


def account(reading: c2d.Reading) -> str:
    """Describe a reading, with the folder of its file as FOLDER."""
    lines = [f"friction = {told(reading.friction)}", f"engine = {reading.engine}"]
    tree = reading.tree
    lines += [f"tree {tree.name} at {tree.at}: {tree.format}, {tree.file}"]
    for link in tree.links:
        lines += of_link(link)
    lines += [of_joint(joint) for joint in tree.joints.values()]
    for plugin in tree.plugins:
        lines.append(f"plugin {plugin.name} ({plugin.filename}) at {plugin.at}")
        lines += [f"  {path} = {text} at {where}" for path, text, where in plugin.settings]
    lines += [f"driven {name} at {where}" for name, where in tree.driven.items()]
    lines += [f"frame: {told(reading.frame.place)}, turned {told(reading.frame.turn)}"]
    figures = dict(leaves(dataclasses.asdict(reading.robot), "robot"))
    lines += [f"{path} = {told(value)}" for path, value in figures.items()]
    lines += [f"{path} from {source}" for path, source in reading.sources.items()]
    wheels = reading.wheels
    for row in zip(*(wheels[name].tolist() for name in wheels), strict=True):
        lines.append(f"wheel {', '.join(told(value) for value in row)}")
    for each in reading.silhouettes:
        low, high = each.outline.min(axis=0), each.outline.max(axis=0)
        reach = f"{len(each.outline)} corners, {told(low)} to {told(high)}"
        lines.append(f"silhouette {each.kind} of {each.link} at {each.at}: {reach}")
    lines += [f"note: {note}" for note in reading.notes]
    lines += [f"warning: {warning}" for warning in reading.warnings]
    text = "".join(f"{line.rstrip()}\n" for line in lines)
    return text.replace(str(reading.path.parent), "FOLDER")


def of_link(link: Link) -> Iterator[str]:
    """Yield the lines of a link."""
    yield f"link {link.name} at {link.at}"
    yield f"  pose {told(link.pose.place)}, turned {told(link.pose.rpy)} at {link.pose_at}"
    yield f"  mass {told(link.mass)} at {link.mass_at}, centre {told(link.center)}"
    yield f"  inertia {told(link.inertia[np.triu_indices(3)])}"
    for shape in link.shapes:
        yield f"  {shape.kind} {shape.name} at {shape.at}"
        yield f"    pose {told(shape.pose.place)}, axis {told(shape.axis)} at {shape.pose_at}"
        sizes = (shape.radius, shape.length, *shape.size, shape.surface_speed)
        yield f"    sizes {told(sizes)} at {shape.size_at}"
        if len(shape.points):
            reach = f"{told(shape.points.min(axis=0))} to {told(shape.points.max(axis=0))}"
            yield f"    {len(shape.points)} points, {reach}"
        if shape.friction is not None:
            values = (
                told(value) for name, value in own(shape.friction) if name != "slips" or value
            )
            yield f"    friction {', '.join(values)}"
    for unread in link.unread:
        yield f"  unread {unread.name} at {unread.at}: {unread.reason}"


def of_joint(joint: Joint) -> str:
    """Return the line of a joint with its values, except defaults."""
    usual = {each.name: each.default for each in dataclasses.fields(joint)}
    parts = (
        f"{name} {told(value)}"
        for name, value in own(joint)
        if isinstance(value, np.ndarray) or (value != usual[name] and value != joint.at)
    )
    return f"joint at {joint.at}: {', '.join(parts)}"


def own(part: Any) -> Iterator[tuple[str, Any]]:
    """Yield the fields of a part with their names."""
    for each in dataclasses.fields(part):
        yield each.name, getattr(part, each.name)


def leaves(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield the values of nested mappings with their paths."""
    if isinstance(value, Mapping):
        for name, inner in value.items():
            yield from leaves(inner, f"{path}.{name}")
    else:
        yield path, value


def told(value: Any) -> str:
    """Write a value, numbers with few digits."""
    if isinstance(value, (float, np.floating)):
        return f"{round(float(value), 9) + 0.0:.6g}"  # smaller values are rounding errors
    if isinstance(value, np.ndarray):
        return told(value.tolist())
    if isinstance(value, (tuple, list)):
        return f"({' '.join(told(each) for each in value)})"
    return str(value)
