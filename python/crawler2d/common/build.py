"""Version and build of the compiled core, for runs, stores and bug reports."""

from __future__ import annotations

from crawler2d import _core

__all__ = ["build_info"]


def build_info() -> dict[str, str | int]:
    """Return version and build of the compiled core.

    Runs store it as `Run.build`, and tables of sweeps as attributes ``build_...``.

    Returns
    -------
    dict of str to str or int
        A new dict at each call:

        ==========  ===============================================================================
        key         meaning
        ==========  ===============================================================================
        `version`   version of crawler2d
        `profile`   "release", or "debug" if it was built without optimisation and is slow
        `engine`    the physics engine included for comparison, with its version
        `target`    processor and system of the build, such as "x86_64-linux"
        `schema`    version of scenario files, a whole number
        `build_id`  digest of the source code, by which stores distinguish cores
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
