"""What pages are put together from: files of the package, hashes for their policy, data as text."""

from __future__ import annotations

import base64
import hashlib
import json
from importlib.resources import files
from typing import Any

__all__ = ["as_json", "page_template", "policy", "read_part", "replay_style", "scene_script"]

_HERE = "crawler2d.pictures.page"

# What draws a run from the side; each part uses only those before it.
_SCENE = (
    "data.js",
    "camera.js",
    "marks.js",
    "carrier.js",
    "robot.js",
    "lane.js",
    "scene.js",
    "pointer.js",
    "player.js",
)

# Escaped as \u sequences, these mean the same in JSON and nothing in HTML.
_MARKUP = str.maketrans({"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"})


def read_part(name: str, package: str = _HERE) -> str:
    """Read a file that stands beside the modules of a package."""
    return (files(package) / name).read_text(encoding="utf-8")


def replay_style() -> str:
    """Return the style of a replay."""
    return read_part("page.css") + read_part("replay.css")


def scene_script(*parts: str) -> str:
    """Join what draws a run from the side and what a page does with that into one script."""
    return '"use strict";\n(() => {\n' + "\n".join([*map(read_part, _SCENE), *parts]) + "})();\n"


def page_template(name: str, package: str = _HERE) -> str:
    """Read the body of a page, and put the head that all pages have before it."""
    return read_part("head.html") + read_part(name, package)


def policy(text: str) -> str:
    """Name a script, or a style, for the security policy of a page."""
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


def as_json(data: Any) -> str:
    """Write data as JSON in which nothing means anything in HTML."""
    return json.dumps(data, allow_nan=False, separators=(",", ":")).translate(_MARKUP)
