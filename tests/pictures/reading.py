"""Reads pictures and pages back: arrays of a page, distances from drawn lines."""

import base64
import json
import re
from typing import Any

import numpy as np

import crawler2d as c2d


def page_of(run: c2d.Run) -> Any:
    """Return the data that the page of a run draws."""
    found = re.search(r'id="recording"[^>]*>(.*?)</script>', run.to_html(), re.DOTALL)
    assert found
    return json.loads(found[1])


def unpacked(column: dict[str, Any]) -> Any:
    """As `unpack` of data.js."""
    data = base64.b64decode(column["data"])
    if column["bits"] == 32:
        return np.frombuffer(data, "<f4").astype(float)
    counts = np.frombuffer(data, f"<u{column['bits'] // 8}")
    return column["start"] + column["step"] * counts.astype(float)


def placed(points: Any, pose: Any) -> Any:
    """Transform points, shape (n, 2), from a frame with a pose."""
    *origin, angle = pose
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return points @ turn.T + origin


class PageRobot:
    """The robot of a page, as positioned by its scripts."""

    def __init__(self, page: Any) -> None:
        self.robot, self.frames = page["robot"], page["frames"]
        self.carriers = self.robot["carriers"]
        self._columns = [unpacked(column) for column in self.robot["columns"]]
        self._chassis = [unpacked(self.frames[name]) for name in ("x", "y", "angle")]
        self._shapes = [unpacked(outline).reshape(-1, 2) for outline in self.robot["outlines"]]

    def value(self, entry: Any, frame: int) -> float:
        """As `value` of a moment in data.js."""
        return float(self._columns[entry["column"]][frame] if isinstance(entry, dict) else entry)

    def pose(self, carrier: Any, frame: int) -> list[Any]:
        """Poses of nested frames, the innermost first."""
        names = ("x", "y", "angle")
        of_chassis = [column[frame] for column in self._chassis]
        return [[self.value(carrier[name], frame) for name in names], of_chassis]

    def outlines(self, frame: int) -> list[Any]:
        """[m] Outlines of everything drawn, in the world frame, and the numbers of the bodies."""
        found = []
        for carrier in self.carriers:
            frames = self.pose(carrier, frame)
            for body in carrier["bodies"]:
                own, _ = self.pose(body, frame)
                for outline in body["outlines"]:
                    line = _through(self._shapes[outline], [own, *frames])
                    found.append((body["look"], body["body"], line))
            for outline, own in self.grousers(carrier["circuit"], frame):
                line = _through(self._shapes[outline], [own, *frames])
                found.append(("grouser", None, line))
        return found

    def grousers(self, circuit: Any, frame: int) -> list[Any]:
        """Outlines and poses of the grousers of a belt, like `Circuit` of carrier.js."""
        if circuit is None:
            return []
        poses = np.column_stack([unpacked(circuit[name]) for name in ("x", "y", "angle")])
        ways, travel = unpacked(circuit["ways"]), self.value(circuit["travel"], frame)
        found = []
        for outline, start in zip(circuit["grousers"], circuit["starts"], strict=True):
            way = (travel + start) % circuit["length"]
            found.append((outline, [np.interp(way, ways, column) for column in poses.T]))
        return found


def _through(points: Any, frames: list[Any]) -> Any:
    for frame in frames:
        points = placed(points, frame)
    return points


def distance(point: Any, outline: Any) -> float:
    """[m] Of a point from a closed line."""
    start, way = outline[:-1], np.diff(outline, axis=0)
    keep = np.hypot(*way.T) > 0.0  # a path ends twice
    start, way = start[keep], way[keep]
    share = np.sum((point - start) * way, axis=1) / np.sum(way * way, axis=1)
    feet = start + np.clip(share, 0.0, 1.0)[:, None] * way
    return float(np.hypot(*(feet - point).T).min())


def lay_out(ax: Any) -> None:
    """Place everything in the figure, as drawing does, but paint nothing."""
    ax.figure.draw_without_rendering()
