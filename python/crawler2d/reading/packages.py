"""Where the packages are that a model names.

They are looked for in the tree of the model, by their manifests, then in the folders that the
variables of ROS and Gazebo name. Where no manifest has the name, a file of the package may still be
told by its path. Nothing but manifests is read, and folders are looked into up to a number and a
depth.
"""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path

__all__ = ["MANIFESTS", "VARIABLES", "Packages"]

MANIFESTS = ("package.xml", "manifest.xml", "model.config")
"""Files that make a folder a package."""

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
"""By variable where a package is in one of its folders; without a pattern, anywhere below."""

_NAME = re.compile(rb"<name\s*>([^<]+)</name\s*>")
_ALLOWED = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+ -]*")
_LARGEST = 64_000  # [bytes] of a manifest
_FARTHEST = 8  # folders, that of the model and those round it, that may have a repository
_WIDER = 2  # folders above a package that is in no repository
_DEEPEST = 7  # levels below the folder in which a search starts
_MOST = 4000  # folders of one search


class Packages:
    """The packages that a model may name.

    Parameters
    ----------
    folder : Path
        That of the model, with all links followed.
    given : mapping of str to Path
        Folders that the user named, which come first.
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
        self._starts, self._beside = _starts(folder)

    def find(self, name: str) -> Path | None:
        """Return the folder of a package; None if there is none."""
        if name in self._given:
            return self._given[name]
        if not _ALLOWED.fullmatch(name):
            return None
        return self._in_tree.get(name) or self._named(name) or self._in_ros.get(name)

    def file(self, package: str, inside: str) -> Path | None:
        """Return the file of a package without a manifest, if its path tells it.

        That is the only file of the tree whose path ends in the name of the package and the path
        inside, or else in the path inside, if that has a folder. What is near comes first: the
        package of the model, then what that is part of.
        """
        parts = tuple(part for part in inside.split("/") if part not in ("", "."))
        if not parts or ".." in parts or not _ALLOWED.fullmatch(package):
            return None
        for tree in self._trees:
            paths = [folder / parts[-1] for folder, files in tree.items() if parts[-1] in files]
            for ending in ((package, *parts), parts):
                fit = [path for path in paths if path.parts[-len(ending) :] == ending]
                if fit and len(ending) > 1:
                    return fit[0] if len(fit) == 1 else None
        return None

    def files(self, suffixes: tuple[str, ...]) -> list[Path]:
        """List files of the package round the model, or else of its repository or folder."""
        return [
            folder / name
            for folder, names in self._trees[0].items()
            for name in sorted(names)
            if name.endswith(suffixes)
        ]

    def hold(self, path: Path) -> bool:
        """Whether a path, with all links followed, is in a package of the tree."""
        return any(path.is_relative_to(folder) for folder in self._in_tree.values())

    @property
    def looked(self) -> str:
        """Where packages are looked for, for errors."""
        named = [variable for variable in VARIABLES if os.environ.get(variable)]
        widest = [*self._starts, *self._beside][-1]
        return " and in ".join([f"{widest} and below", *named])

    def _named(self, name: str) -> Path | None:
        """Look where a variable says how its folders are laid out."""
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
        """Packages by name, those near the model first."""
        near: dict[Path, set[str]] = {}
        for tree in (*self._trees, dict(_within(self._beside))):
            near |= tree
        return self._with_manifest(near.items())

    @cached_property
    def _in_ros(self) -> dict[str, Path]:
        searched = [variable for variable, patterns in VARIABLES.items() if not patterns]
        return self._with_manifest(
            _within(each for variable in searched for each in folders(variable))
        )

    def _with_manifest(self, folders: Iterable[tuple[Path, set[str]]]) -> dict[str, Path]:
        """Look for manifests; of two packages of one name, the first counts."""
        found: dict[str, Path] = {}
        for folder, files in folders:
            for name in self._names(folder, files):
                found.setdefault(name, folder)
        return found

    def _names(self, folder: Path, files: set[str]) -> list[str]:
        """Return the names of a package: ROS goes by the manifest, Gazebo by the folder."""
        names = [] if {"manifest.xml", "model.config"}.isdisjoint(files) else [folder.name]
        for manifest in ("package.xml", "model.config"):
            if manifest in files:
                try:
                    data = self._read(folder / manifest, _LARGEST)
                except OSError:  # a pipe, say: what it may name is not known
                    continue
                stated = _NAME.search(_without_comments(data))
                names += [stated[1].decode(errors="replace").strip()] if stated else []
        return names


def folders(variable: str) -> list[Path]:
    """List the folders that an environment variable names, with all links followed."""
    parts = os.environ.get(variable, "").split(os.pathsep)
    return [Path(os.path.realpath(part)) for part in parts if part]


def _starts(folder: Path) -> tuple[list[Path], list[Path]]:
    """Say where to look for packages, the nearest first: the package, then what it is part of.

    Without a repository that is the outermost package; folders above may have packages beside it,
    but not those in which anything may lie.
    """
    near = [folder, *folder.parents][:_FARTHEST]
    packages = [each for each in near if any((each / name).is_file() for name in MANIFESTS)]
    for each in near:
        if (each / ".git").exists():
            return list(dict.fromkeys([*packages[:1], each])), []
    if packages:
        wider = packages[-1].parents[:_WIDER]
        all_in = (Path.home(), Path(os.path.realpath(tempfile.gettempdir())))
        beside = [each for each in wider if not any(wide.is_relative_to(each) for wide in all_in)]
        return list(dict.fromkeys([packages[0], packages[-1]])), beside
    return [folder], []


def _within(starts: Iterable[Path]) -> Iterator[tuple[Path, set[str]]]:
    """Go through folders with what is in them, those near a start first, each once."""
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
                files, inside = _listed(folder)
                yield folder, files
                below += inside
            level = below


def _listed(folder: Path) -> tuple[set[str], list[Path]]:
    """List files, and folders in order, of a folder; hidden and linked ones are passed over."""
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
