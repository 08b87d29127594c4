"""The one door to the files that a model names.

Whatever a model is made of is read here and nowhere else: the model itself, what it includes, its
meshes and textures, settings in YAML, manifests of packages. A file is read if it

- lies in the folder of the model, in the package round that, in another package of its tree, or in
  a folder that the user named: one of ``packages=``, or of the variables in which ROS and Gazebo
  look for packages; or is the one file of the tree that a name fits, though no manifest has that of
  its package. Links and ``..`` are followed first, so none of them leads out;
- is a regular file: a pipe may never answer, a device never end;
- is not too large, by itself and with all others of its model.

Each refusal is a `ScenarioError` that names the file, the rule and what to do.
"""

from __future__ import annotations

import errno
import os
import re
import stat
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from crawler2d.errors import ScenarioError
from crawler2d.reading.packages import MANIFESTS, VARIABLES, Packages, folders
from crawler2d.reading.telling import Doubt

__all__ = ["LARGEST_MODEL", "LARGEST_TOGETHER", "Files", "is_absent", "why"]

LARGEST_MODEL = 4_000_000
"""[bytes] Of one file of elements or settings. The largest public models have 150 kB."""

LARGEST_TOGETHER = 30_000_000
"""[bytes] Of all files of one model, and so of any mesh: 600,000 facets of a binary STL."""

_IN_PACKAGE = re.compile(
    r"(?:file://)?(?:(?:package|model)://([^/]*)|\$\((?:find|find-pkg-share)\s+([^)\s]+)\s*\))(.*)",
    re.DOTALL,
)
_KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}
# Nothing that is opened waits, becomes the terminal, or is a link put there in the meantime.
_FLAGS = os.O_RDONLY
for _name in ("O_NONBLOCK", "O_NOCTTY", "O_NOFOLLOW", "O_CLOEXEC", "O_BINARY"):
    _FLAGS |= getattr(os, _name, 0)

_ELSEWHERE = "is not among the files of the model"


class Files:
    """The files of one model, of which each that is read counts.

    Parameters
    ----------
    model : path
        The file of the model, to whose folder names are relative.
    packages : mapping of str to path
        Folders of packages by name.

    Attributes
    ----------
    folder : Path
        That of the model, with all links followed.
    doubts : list of Doubt
        Files that were taken for those of packages that are not found.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> _ = (folder / "wheel.obj").write_bytes(b"v 0 0 0")
    >>> files = Files(folder / "cart.urdf", packages={"parts": folder / "parts"})
    >>> files.read("wheel.obj", at="cart.urdf:3")
    b'v 0 0 0'
    >>> files.read("package://parts/wheel.obj", at="cart.urdf:4")  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ...
    crawler2d.errors.ScenarioError: cart.urdf:4 must be a regular file that can be read (No such ...
    """

    def __init__(
        self, model: str | os.PathLike[str], packages: Mapping[str, str | os.PathLike[str]]
    ) -> None:
        self._model = _real(model, "path")
        self.folder = self._model.parent
        self._given = {name: _real(folder, "packages") for name, folder in packages.items()}
        self._packages = Packages(self.folder, self._given, _read_regular)
        named = [folder for variable in VARIABLES for folder in folders(variable)]
        self._roots = [_package_round(self.folder), *self._given.values(), *named]
        self._left = LARGEST_TOGETHER
        self._taken: dict[str, Path] = {}
        self.doubts: list[Doubt] = []

    @property
    def plain(self) -> dict[str, Any]:
        """The parameters, for another process."""
        packages = {name: str(folder) for name, folder in self._given.items()}
        return {"model": str(self._model), "packages": packages}

    @property
    def looked(self) -> str:
        """Where packages are looked for, for errors."""
        return self._packages.looked

    def model(self) -> bytes:
        """Read the model itself; see `read`."""
        return self.read(str(self._model), at="path")

    def read(self, name: str, *, at: str, most: int = LARGEST_MODEL) -> bytes:
        """Read a file.

        Parameters
        ----------
        name : str
            Relative to the folder of the model, absolute, or with ``package://``, ``model://``,
            ``file://`` or ``$(find ...)``.
        at : str
            Who names it, as the path of errors.
        most : int
            [bytes] The largest size.

        Returns
        -------
        bytes
            All of it.

        Raises
        ------
        ScenarioError
            If it must not or cannot be read; the system's error, if there is one, is the cause. See
            `is_absent`.
        """
        path = self.path(name, at=at)
        inside = any(path.is_relative_to(root) for root in self._roots)
        if not inside and not self._packages.hold(path) and path not in self._taken.values():
            rule = (
                "must be in the folder or package of its model, in another package of its tree, or"
                " in a folder that is named: packages={name: folder}"
            )
            raise ScenarioError(at, name, rule) from _absent(name)
        try:
            data = _read_regular(path, most + 1)
        except OSError as error:
            rule = f"must be a regular file that can be read ({error.strerror})"
            raise ScenarioError(at, name, rule) from error
        if len(data) > most:
            raise ScenarioError(at, name, f"must have at most {most} bytes")
        if len(data) > self._left:
            rule = f"must, with the other files of its model, have at most {LARGEST_TOGETHER} bytes"
            raise ScenarioError(at, name, rule)
        self._left -= len(data)
        return data

    def package(self, name: str) -> Path | None:
        """Return the folder of a package; None if there is none."""
        return self._packages.find(name)

    def settings(self) -> list[Path]:
        """List the files of YAML in the package round the model, or else its repository."""
        return self._packages.files((".yaml", ".yml"))

    def path(self, name: str, *, at: str) -> Path:
        """Say where a file is that a model names; see `read`."""
        found = _IN_PACKAGE.fullmatch(name)
        if found is None:
            return _real(self.folder / name.removeprefix("file://"), at)
        package, inside = found[1] or found[2] or "", found[3]
        folder = self.package(package)
        if folder is not None:
            return _real(folder / inside.lstrip("/"), at)
        if name not in self._taken:
            taken = self._packages.file(package, inside)
            if taken is None:
                rule = (
                    f"must be in a package that is found in {self.looked}, or whose folder is"
                    " given: packages={name: folder}"
                )
                raise ScenarioError(at, name, rule) from _absent(name)
            self._taken[name] = taken
        doubt = (at, name, f"is taken to be {self._taken[name]}: no package has that name")
        if doubt not in self.doubts:
            self.doubts.append(doubt)
        return _real(self._taken[name], at)


def is_absent(error: BaseException) -> bool:
    """Whether a file was refused because there is none among those of the model."""
    return isinstance(error.__cause__, (FileNotFoundError, NotADirectoryError))


def _absent(name: str) -> FileNotFoundError:
    return FileNotFoundError(errno.ENOENT, _ELSEWHERE, name)


def why(error: ScenarioError) -> str:
    """Say why a file could not be read, and which one it is if it is not there."""
    cause = error.__cause__
    if isinstance(cause, FileNotFoundError) and cause.strerror != _ELSEWHERE:
        return f"there is no file {cause.filename}"
    return error.rule


def _read_regular(path: Path, most: int) -> bytes:
    """Read so many bytes of what was opened, which also says what it is: nothing comes between."""
    number = os.open(path, _FLAGS)
    try:
        kind = stat.S_IFMT(os.fstat(number).st_mode)
        if kind != stat.S_IFREG:
            raise OSError(errno.EINVAL, f"{_KINDS.get(kind, 'what it is')} is none")
        with os.fdopen(number, "rb", closefd=False) as file:
            return file.read(most) or b""  # None if the system has nothing ready
    finally:
        os.close(number)


def _real(path: str | os.PathLike[str], at: str) -> Path:
    """Follow all links; a circle of them is refused when it is opened."""
    try:
        return Path(os.path.realpath(path))
    except (OSError, ValueError) as error:  # a name with a null byte is a ValueError
        raise ScenarioError(at, str(path), f"must be the name of a file ({error})") from None


def _package_round(folder: Path) -> Path:
    """Return the innermost folder with a manifest round a folder, or else that itself."""
    for each in (folder, *folder.parents):
        if any(os.path.exists(each / name) for name in MANIFESTS):
            return each
    return folder
