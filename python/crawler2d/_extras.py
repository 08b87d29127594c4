"""Optional packages: imported when first used, and named with their extra when missing."""

from __future__ import annotations

import importlib
from typing import Any


def extra(module: str, name: str) -> Any:
    """Import a module of an optional dependency.

    Parameters
    ----------
    module : str
        Dotted name of the module.
    name : str
        The extra of crawler2d that brings it.

    Raises
    ------
    ImportError
        If it is not installed; the message names the extra.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        top = module.partition(".")[0]
        message = f"this needs {top}: pip install crawler2d[{name}]"
        raise ImportError(message, name=top) from error
