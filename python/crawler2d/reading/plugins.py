"""What plugins do: turn joints, or move the surface of links."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from crawler2d.models.tree import Plugin, Tree
from crawler2d.models.where import Where
from crawler2d.reading.elements import Element

__all__ = ["driven_by", "moved_links", "named_tracks", "plugin_of", "wheel_torques"]

_DEEPEST_SETTING = 3  # no setting of a plugin that is read lies deeper


def plugin_of(plugin: Element) -> Plugin:
    """Flatten the settings of a plugin."""
    settings: list[tuple[str, str, Where]] = []
    waiting = [(child, child.tag) for child in reversed(plugin.children)]
    while waiting:
        element, path = waiting.pop()
        settings.append((path, element.text, element.where))
        if path.count("/") < _DEEPEST_SETTING:
            waiting.extend((child, f"{path}/{child.tag}") for child in reversed(element.children))
    name, filename = (plugin.attributes.get(key, "") for key in ("name", "filename"))
    return Plugin(name=name, filename=filename, settings=tuple(settings), at=plugin.where)


def driven_by(plugins: tuple[Plugin, ...]) -> dict[str, Where]:
    """Return the joints that a differential drive turns, and the lines that say so."""
    return {
        joint: where
        for plugin in plugins
        if "diff" in f"{plugin.name} {plugin.filename}".lower()
        for joint, where in plugin.values("left_joint", "right_joint", "leftJoint", "rightJoint")
    }


def wheel_torques(plugins: tuple[Plugin, ...]) -> dict[str, tuple[float, Where]]:
    """[N m] Return the torques that differential drives of Gazebo Classic give to joints."""
    found: dict[str, tuple[float, Where]] = {}
    for plugin in plugins:
        for text, where in plugin.values("max_wheel_torque", "wheelTorque", "torque"):
            try:
                torque = float(text)
            except ValueError:
                continue
            if 0.0 < torque < math.inf:
                found |= dict.fromkeys(driven_by((plugin,)), (torque, where))
    return found


def moved_links(tree: Tree) -> dict[str, Where]:
    """Return the links whose surface is moved, and the lines that say so."""
    links = tree.by_name
    named = {name: where for name, where in named_tracks(tree.plugins) if name in links}
    return named | {name: links[name].at for name in tree.tracks}


def named_tracks(plugins: Iterable[Plugin]) -> Iterator[tuple[str, Where]]:
    """Yield what plugins name as tracks, with the lines; not all of it need be links."""
    for plugin in plugins:
        if "track" in f"{plugin.name} {plugin.filename}".lower():
            for path, text, where in plugin.settings:
                if path.rpartition("/")[2] in _TRACKS:
                    yield text, where


# Gazebo's TrackController has link; its TrackedVehicle left_track/link and right_track/link; the
# plugins of Gazebo classic name the links of tracks and flippers like this.
_TRACKS = {"link", "left_track", "right_track", "left_flipper", "right_flipper"}
