"""What pages are put together from: files of the package, hashes for their policy, data as text."""

from __future__ import annotations

import base64
import hashlib
import json
from importlib.resources import files
from typing import Any

__all__ = ["as_json", "page_template", "policy", "read_part", "replay_script", "replay_style"]

_HERE = "crawler2d.pictures.page"

# Joined into one script; each part uses only those before it.
_SCRIPTS = (
    "data.js",
    "camera.js",
    "marks.js",
    "carrier.js",
    "robot.js",
    "lane.js",
    "scene.js",
    "strip.js",
    "pointer.js",
    "replay.js",
)

# Escaped as \u sequences, these mean the same in JSON and nothing in HTML.
_MARKUP = str.maketrans({"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"})


def read_part(name: str, package: str = _HERE) -> str:
    """Read a file that stands beside the modules of a package."""
    return (files(package) / name).read_text(encoding="utf-8")


def replay_style() -> str:
    """Return the style of a replay."""
    return read_part("page.css") + read_part("replay.css")


def replay_script() -> str:
    """Return the script of a replay."""
    return '"use strict";\n(() => {\n' + "\n".join(map(read_part, _SCRIPTS)) + "})();\n"


def page_template(name: str, package: str = _HERE) -> str:
    """Read the body of a page, and put the head that all pages have before it."""
    return read_part("head.html") + read_part(name, package)


def policy(*texts: str) -> str:
    """Name scripts, or styles, for the security policy of a page."""
    hashes = (hashlib.sha256(text.encode()).digest() for text in texts)
    return " ".join(f"'sha256-{base64.b64encode(each).decode('ascii')}'" for each in hashes)


def as_json(data: Any) -> str:
    """Write data as JSON in which nothing means anything in HTML."""
    return json.dumps(data, allow_nan=False, separators=(",", ":")).translate(_MARKUP)
