"""Progress, a line at a time."""

from __future__ import annotations

import sys

__all__ = ["tell"]


def tell(line: str) -> None:
    """Write a line now: whoever watches a file sees it."""
    sys.stdout.write(line + "\n")
    sys.stdout.flush()
