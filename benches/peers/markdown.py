"""Markdown of the reports."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Write a table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def page(parts: Iterable[str]) -> str:
    """Join parts, with empty lines between their blocks."""
    blocks = "\n\n".join(part.strip() for part in parts).split("\n\n")
    return "\n\n".join(_wrap(block) for block in blocks) + "\n"


def _wrap(block: str) -> str:
    """Wrap the lines of a paragraph again, because figures change their lengths."""
    is_paragraph = not block.startswith(("|", "#", "-", "!"))
    return textwrap.fill(block, 100, break_on_hyphens=False) if is_paragraph else block
