"""Turn doubts into warnings at the line of user code that led to them."""

from __future__ import annotations

import sys
import warnings

from crawler2d.errors import ScenarioWarning

__all__ = ["warn"]

_PACKAGE = __name__.partition(".")[0]


def warn(path: str, value: object, reason: str) -> None:
    """Issue one doubt as a warning; called by the core, too.

    Parameters
    ----------
    path, value, reason
        See `ScenarioWarning`.
    """
    frame, level = sys._getframe(1), 2
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] == _PACKAGE:
        frame, level = frame.f_back, level + 1
    warnings.warn(ScenarioWarning(path, value, reason), stacklevel=level)
