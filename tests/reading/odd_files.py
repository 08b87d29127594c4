"""Names that are not files of a model: pipes, devices, folders, sockets, links."""

import contextlib
import os
import socket
import stat
from collections.abc import Callable, Iterable
from pathlib import Path


def _pipe(path: Path) -> None:
    os.mkfifo(path)


def _folder(path: Path) -> None:
    path.mkdir()


def _socket(path: Path) -> None:
    here = Path.cwd()
    os.chdir(path.parent)  # names of sockets are short
    with socket.socket(socket.AF_UNIX) as made:
        made.bind(path.name)
    os.chdir(here)


def _device(path: Path) -> None:
    """Make one that never ends, in the folder itself; only root may, others get a link to it."""
    try:
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 5))
    except PermissionError:
        path.symlink_to("/dev/zero")


def _linked_pipe(path: Path) -> None:
    os.mkfifo(path.with_name(f"end_of_{path.name}"))
    path.symlink_to(f"end_of_{path.name}")


def _circle(path: Path) -> None:
    path.symlink_to(path.name)


def _linked(to: str) -> Callable[[Path], None]:
    return lambda path: path.symlink_to(to)


ODD: dict[str, Callable[[Path], None]] = {
    "pipe": _pipe,
    "linked_pipe": _linked_pipe,
    "folder": _folder,
    "socket": _socket,
    "device": _device,
    "zero": _linked("/dev/zero"),
    "random": _linked("/dev/random"),
    "tty": _linked("/dev/tty"),
    "elsewhere": _linked("/etc/passwd"),
    "circle": _circle,
    "nowhere": _linked("there is no such file"),
}
"""By name what makes each at a path."""


def lay_out(folder: Path, suffixes: Iterable[str]) -> None:
    """Put one of each with each suffix into a folder: ``pipe.stl``, ``zero.xacro`` and so on."""
    for suffix in suffixes:
        for name, make in ODD.items():
            with contextlib.suppress(FileExistsError):
                make(folder / f"{name}.{suffix}")
