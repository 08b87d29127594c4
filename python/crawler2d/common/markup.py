"""Pieces of HTML: any text made harmless, and figures as a table."""

from __future__ import annotations

import html
from collections.abc import Iterable

__all__ = ["escaped", "table"]


def escaped(text: str) -> str:
    """Make any text harmless in HTML and valid in UTF-8."""
    return html.escape(text.encode("utf-8", "replace").decode())


def table(rows: Iterable[tuple[str, str]]) -> str:
    """Write names with their values, one below the other; nothing if there are none."""
    written = "".join(
        f"<tr><th>{escaped(name)}</th><td>{escaped(value)}</td></tr>" for name, value in rows
    )
    return f"<table><tbody>{written}</tbody></table>" if written else ""
