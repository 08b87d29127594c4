"""What the compiled core is, as runs, stores and reports of faults name it."""

from __future__ import annotations

from crawler2d import _core

__all__ = ["build_info"]


def build_info() -> dict[str, str | int]:
    """Return version and build of the compiled core.

    Runs keep it as `Run.build`, and tables of sweeps as the attributes ``build_...``.

    Returns
    -------
    dict of str to str or int
        A new one at each call:

        ==========  ===============================================================================
        key         meaning
        ==========  ===============================================================================
        `version`   of crawler2d
        `profile`   "release", or "debug" if it was built without optimisation and is slow
        `engine`    the physics engine that it holds besides its own, with its version
        `target`    processor and system for which it was built, such as "x86_64-linux"
        `schema`    version of scenario files, a whole number
        `build_id`  digest of its source code, by which stores tell cores apart
        ==========  ===============================================================================

    Examples
    --------
    >>> import crawler2d as c2d
    >>> list(c2d.build_info())
    ['version', 'profile', 'engine', 'target', 'schema', 'build_id']
    >>> c2d.build_info()["version"] == c2d.__version__
    True
    """
    return _core.build_info()
