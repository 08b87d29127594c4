"""Safe access to the files named by a model, and search for their packages.

All files of a model are read here and nowhere else: the model itself, its includes, meshes and
textures, YAML settings, manifests of packages. A file is read if it

- is in the folder of the model, in its package, in another package of its tree, or in a folder
  named by the user (``packages=`` or the variables in which ROS and Gazebo look for packages); or
  is the only file of the tree that fits a name, if no manifest has the name of its package. Links
  and ``..`` are resolved first, so they cannot lead outside;
- is a regular file: a pipe may never answer, a device never end;
- is not too large, alone and together with all others of its model.

Refusals are `ScenarioError`s that name the file, the rule and a remedy.

Packages are searched by their manifests in the tree of the model, then in the folders of the
variables of ROS and Gazebo. If no manifest has the name, a file of the package may still be
identified by its path. The search reads only manifests, in a limited number and depth of folders.
"""

from __future__ import annotations

import errno
import os
import re
import stat
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from crawler2d.errors import ScenarioError
from crawler2d.reading.log import ReadingWarning

__all__ = ["LARGEST_MODEL", "LARGEST_TOGETHER", "VARIABLES", "Files", "is_absent", "reason_of"]

MANIFESTS = ("package.xml", "manifest.xml", "model.config")
"""Manifests: files that make a folder a package."""

VARIABLES = {
    "AMENT_PREFIX_PATH": ("share/{name}",),
    "COLCON_PREFIX_PATH": ("share/{name}", "{name}/share/{name}"),
    "GZ_SIM_RESOURCE_PATH": ("{name}",),
    "IGN_GAZEBO_RESOURCE_PATH": ("{name}",),
    "GAZEBO_MODEL_PATH": ("{name}",),
    "SDF_PATH": ("{name}",),
    "ROS_PACKAGE_PATH": (),
    "ROS_ROOT": (),
}
"""Variables, with the paths of a package in one of its folders; () for anywhere below."""

_NAME = re.compile(rb"<name\s*>([^<]+)</name\s*>")
_ALLOWED = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+ -]*")
_LARGEST = 64_000  # [bytes] of a manifest
_FARTHEST = 8  # folders, from that of the model upwards, that may be a repository
_WIDER = 2  # folders above a package outside of repositories
_DEEPEST = 7  # levels below the folder in which a search starts
_MOST = 4000  # folders of one search

LARGEST_MODEL = 4_000_000
"""[bytes] Limit of a file of elements or settings. The largest public models have 150 kB."""

LARGEST_TOGETHER = 30_000_000
"""[bytes] Limit of all files of a model, and so of a mesh: 600,000 facets of a binary STL."""

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

# What is opened does not block, does not become the terminal, and is not a link swapped in.
_FLAGS = os.O_RDONLY

for _name in ("O_NONBLOCK", "O_NOCTTY", "O_NOFOLLOW", "O_BINARY"):
    _FLAGS |= getattr(os, _name, 0)

_ELSEWHERE = "is not among the files of the model"


class Packages:
    """The packages that a model may name.

    Parameters
    ----------
    folder : Path
        That of the model, with all links followed.
    given : mapping of str to Path
        Folders that the user named, which take precedence.
    read : callable
        Reads so many bytes of a regular file.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> _ = (folder / "package.xml").write_text("<package><name>cart</name></package>")
    >>> (folder / "urdf").mkdir()
    >>> (folder / ".git").mkdir()
    >>> packages = Packages(folder / "urdf", {}, lambda path, most: path.read_bytes())
    >>> packages.find("cart") == folder, packages.find("tank")
    (True, None)
    """

    def __init__(
        self, folder: Path, given: Mapping[str, Path], read: Callable[[Path, int], bytes]
    ) -> None:
        self._given = given
        self._read = read
        self._starts, self._siblings = _starts(folder)

    def find(self, name: str) -> Path | None:
        """Return the folder of a package; None if there is none."""
        if name in self._given:
            return self._given[name]
        if not _ALLOWED.fullmatch(name):
            return None
        return self._in_tree.get(name) or self._by_variable(name) or self._in_ros.get(name)

    def file(self, package: str, inside: str) -> Path | None:
        """Return the file of a package without a manifest, if its path identifies it.

        That is the only file of the tree whose path ends in the name of the package and the path
        inside, or else in the path inside, if that has a folder. The package of the model is
        searched first, then what it is part of.
        """
        parts = tuple(part for part in inside.split("/") if part not in ("", "."))
        if not parts or ".." in parts or not _ALLOWED.fullmatch(package):
            return None
        for tree in self._trees:
            paths = [folder / parts[-1] for folder, files in tree.items() if parts[-1] in files]
            for ending in ((package, *parts), parts):
                matches = [path for path in paths if path.parts[-len(ending) :] == ending]
                if matches and len(ending) > 1:
                    return matches[0] if len(matches) == 1 else None
        return None

    def files(self, suffixes: tuple[str, ...]) -> list[Path]:
        """List files in the package of the model, or else in its repository or folder."""
        return [
            folder / name
            for folder, names in self._trees[0].items()
            for name in sorted(names)
            if name.endswith(suffixes)
        ]

    def hold(self, path: Path) -> bool:
        """Whether a path, with all links resolved, is in a package of the tree."""
        return any(path.is_relative_to(folder) for folder in self._in_tree.values())

    @property
    def looked(self) -> str:
        """The folders and variables that are searched, for errors."""
        variables = [variable for variable in VARIABLES if os.environ.get(variable)]
        widest = [*self._starts, *self._siblings][-1]
        return " and in ".join([f"{widest} and below", *variables])

    def _by_variable(self, name: str) -> Path | None:
        """Look in the folders of variables with a known layout."""
        for variable, patterns in VARIABLES.items():
            for folder in folders(variable):
                for pattern in patterns:
                    path = folder / pattern.format(name=name)
                    if path.is_dir():
                        return path
        return None

    @cached_property
    def _trees(self) -> list[dict[Path, set[str]]]:
        """Folders with their files, of the package of the model and of what that is part of."""
        return [dict(_within([start])) for start in self._starts]

    @cached_property
    def _in_tree(self) -> dict[str, Path]:
        """Packages by name, those close to the model first."""
        folders: dict[Path, set[str]] = {}
        for tree in (*self._trees, dict(_within(self._siblings))):
            folders |= tree
        return self._with_manifest(folders.items())

    @cached_property
    def _in_ros(self) -> dict[str, Path]:
        searched = [variable for variable, patterns in VARIABLES.items() if not patterns]
        return self._with_manifest(
            _within(each for variable in searched for each in folders(variable))
        )

    def _with_manifest(self, folders: Iterable[tuple[Path, set[str]]]) -> dict[str, Path]:
        """Look for manifests; of two packages of one name, the first counts."""
        packages: dict[str, Path] = {}
        for folder, files in folders:
            for name in self._names(folder, files):
                packages.setdefault(name, folder)
        return packages

    def _names(self, folder: Path, files: set[str]) -> list[str]:
        """Return the names of a package: ROS uses the manifest, Gazebo the folder."""
        names = [] if {"manifest.xml", "model.config"}.isdisjoint(files) else [folder.name]
        for manifest in ("package.xml", "model.config"):
            if manifest in files:
                try:
                    data = self._read(folder / manifest, _LARGEST)
                except OSError:  # a pipe, say
                    continue
                stated = _NAME.search(_without_comments(data))
                names += [stated[1].decode(errors="replace").strip()] if stated else []
        return names


class Files:
    """The files of one model, whose sizes are added up as they are read.

    Parameters
    ----------
    model : path
        The file of the model, to whose folder names are relative.
    packages : mapping of str to path
        Folders of packages by name.

    Attributes
    ----------
    folder : Path
        That of the model, with all links resolved.
    packages : Packages
        The packages that it may name.
    warnings : list of ReadingWarning
        Files that stand in for those of packages that are not found.

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
        self.packages = Packages(self.folder, self._given, _read_regular)
        named = [folder for variable in VARIABLES for folder in folders(variable)]
        self._roots = [_package_around(self.folder), *self._given.values(), *named]
        self._left = LARGEST_TOGETHER
        self._taken: dict[str, Path] = {}
        self.warnings: list[ReadingWarning] = []

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters, for another process."""
        packages = {name: str(folder) for name, folder in self._given.items()}
        return {"model": str(self._model), "packages": packages}

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
            The place that names it, as the path of errors.
        most : int
            [bytes] The largest size.

        Returns
        -------
        bytes
            All of it.

        Raises
        ------
        ScenarioError
            If it must not or cannot be read; its cause is the system's error, if any.
        """
        path = self.path(name, at=at)
        inside = any(path.is_relative_to(root) for root in self._roots)
        if not inside and not self.packages.hold(path) and path not in self._taken.values():
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

    def path(self, name: str, *, at: str) -> Path:
        """Return the path of a file named by a model; see `read`."""
        match = _IN_PACKAGE.fullmatch(name)
        if match is None:
            return _real(self.folder / name.removeprefix("file://"), at)
        package, inside = match[1] or match[2] or "", match[3]
        folder = self.packages.find(package)
        if folder is not None:
            return _real(folder / inside.lstrip("/"), at)
        if name not in self._taken:
            taken = self.packages.file(package, inside)
            if taken is None:
                rule = (
                    f"must be in a package that is found in {self.packages.looked}, or whose folder"
                    " is given: packages={name: folder}"
                )
                raise ScenarioError(at, name, rule) from _absent(name)
            self._taken[name] = taken
        warning = (at, name, f"is taken to be {self._taken[name]}: no package has that name")
        if warning not in self.warnings:
            self.warnings.append(warning)
        return _real(self._taken[name], at)


def folders(variable: str) -> list[Path]:
    """List the folders that an environment variable names, with all links resolved."""
    parts = os.environ.get(variable, "").split(os.pathsep)
    return [Path(os.path.realpath(part)) for part in parts if part]


def is_absent(error: BaseException) -> bool:
    """Whether a file was refused because it does not exist among those of the model."""
    return isinstance(error.__cause__, (FileNotFoundError, NotADirectoryError))


def reason_of(error: ScenarioError) -> str:
    """Return why a file could not be read, and its name if it is missing."""
    cause = error.__cause__
    if isinstance(cause, FileNotFoundError) and cause.strerror != _ELSEWHERE:
        return f"there is no file {cause.filename}"
    return error.rule


def _starts(folder: Path) -> tuple[list[Path], list[Path]]:
    """Return where to look for packages: the innermost package, then its repository.

    Without a repository, that is the outermost package. Folders above it come second, as they may
    have sibling packages, unless they are a home or temporary folder.
    """
    near = [folder, *folder.parents][:_FARTHEST]
    packages = [each for each in near if any(os.path.isfile(each / name) for name in MANIFESTS)]
    for each in near:
        if os.path.exists(each / ".git"):
            return list(dict.fromkeys([*packages[:1], each])), []
    if packages:
        wider = packages[-1].parents[:_WIDER]
        mixed = (Path.home(), Path(os.path.realpath(tempfile.gettempdir())))
        siblings = [each for each in wider if not any(wide.is_relative_to(each) for wide in mixed)]
        return list(dict.fromkeys([packages[0], packages[-1]])), siblings
    return [folder], []


def _within(starts: Iterable[Path]) -> Iterator[tuple[Path, set[str]]]:
    """Yield folders and the names in them once each, those close to a start first."""
    seen: set[Path] = set()
    for start in starts:
        level = [start]
        for _ in range(_DEEPEST):
            below: list[Path] = []
            for folder in level:
                if folder in seen:
                    continue
                if len(seen) == _MOST:
                    return
                seen.add(folder)
                files, inside = _list(folder)
                yield folder, files
                below += inside
            level = below


def _list(folder: Path) -> tuple[set[str], list[Path]]:
    """List the names and the folders in a folder; hidden and linked folders are skipped."""
    try:
        with os.scandir(folder) as entries:
            shown = sorted(
                (each for each in entries if not each.name.startswith(".")),
                key=lambda each: each.name,
            )
            inside = [Path(each.path) for each in shown if each.is_dir(follow_symlinks=False)]
    except OSError:
        return set(), []
    return {each.name for each in shown}, inside


def _without_comments(data: bytes) -> bytes:
    first, *others = data.split(b"<!--")
    return first + b"".join(part.partition(b"-->")[2] for part in others)


def _real(path: str | os.PathLike[str], at: str) -> Path:
    """Resolve all links; circular ones are refused on opening."""
    try:
        return Path(os.path.realpath(path))
    except (OSError, ValueError) as error:  # null bytes in names raise ValueError
        raise ScenarioError(at, str(path), f"must be the name of a file ({error})") from None


def _read_regular(path: Path, most: int) -> bytes:
    """Read bytes of a file that is checked after opening, so it cannot be swapped."""
    number = os.open(path, _FLAGS)
    try:
        kind = stat.S_IFMT(os.fstat(number).st_mode)
        if kind != stat.S_IFREG:
            raise OSError(errno.EINVAL, f"it is {_KINDS.get(kind, 'no file')}")
        with os.fdopen(number, "rb", closefd=False) as file:
            return file.read(most) or b""  # None if no data are ready
    finally:
        os.close(number)


def _package_around(folder: Path) -> Path:
    """Return the innermost folder with a manifest at or above a folder, else that folder."""
    for each in (folder, *folder.parents):
        if any(os.path.exists(each / name) for name in MANIFESTS):
            return each
    return folder


def _absent(name: str) -> FileNotFoundError:
    return FileNotFoundError(errno.ENOENT, _ELSEWHERE, name)
