"""Import optional packages on first use; the error for a missing one names its extra."""

from __future__ import annotations

import contextlib
import importlib
import signal
import sys
import threading
from collections.abc import Iterator
from typing import Any


def extra(module: str, name: str) -> Any:
    """Import a module of an optional dependency.

    Parameters
    ----------
    module : str
        Dotted name of the module.
    name : str
        The extra of crawler2d that installs it.

    Raises
    ------
    ImportError
        If it is not installed (the message names the extra), or fails to import (the message says
        why).
    """
    top = module.partition(".")[0]
    if top == "xarray" and top not in sys.modules:
        _leave_out_broken("dask")
    try:
        with _without_interrupt():
            return importlib.import_module(module)
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and error.name in (top, module):
            message = f"this needs {top}: pip install 'crawler2d[{name}]'"
        else:
            message = (
                f"{top} is installed, but its import failed: {type(error).__name__}: {error}"
                " (if an earlier import of it was interrupted, only a new Python process helps)"
            )
        raise ImportError(message, name=top) from error


def _leave_out_broken(module: str) -> None:
    """Hide a package that another one would use, if its import fails.

    xarray expects only a missing dask, but dask fails with /proc hidden, as it counts cores.
    """
    try:
        with _without_interrupt():
            importlib.import_module(module)
    except ImportError:
        return
    except Exception:  # whatever the cause, users of the package can do without
        sys.modules[module] = None  # type: ignore[assignment] # makes its import an ImportError


@contextlib.contextmanager
def _without_interrupt() -> Iterator[None]:
    """Delay Ctrl-C until the import is done: an interrupted import often cannot be repeated.

    Removing the partial modules from `sys.modules` does not help pandas and matplotlib.
    """
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    held: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _frame: held.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
        if held:
            signal.raise_signal(signal.SIGINT)
