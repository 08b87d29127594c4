"""What pictures and pages show, read back: arrays of a page, distances from what is drawn."""

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
    """As `unpacked` of data.js."""
    data = base64.b64decode(column["data"])
    if column["bits"] == 32:
        return np.frombuffer(data, "<f4").astype(float)
    counts = np.frombuffer(data, f"<u{column['bits'] // 8}")
    return column["start"] + column["step"] * counts.astype(float)


def distance(point: Any, outline: Any) -> float:
    """[m] Of a point from a closed line."""
    start, way = outline[:-1], np.diff(outline, axis=0)
    keep = np.hypot(*way.T) > 0.0  # a path ends twice
    start, way = start[keep], way[keep]
    share = np.sum((point - start) * way, axis=1) / np.sum(way * way, axis=1)
    feet = start + np.clip(share, 0.0, 1.0)[:, None] * way
    return float(np.hypot(*(feet - point).T).min())
