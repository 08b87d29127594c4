"""Files that appear once they are complete."""

from __future__ import annotations

import contextlib
import errno
import os
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import IO

__all__ = ["part_of", "write_text", "written_whole"]


@contextlib.contextmanager
def part_of(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Name a file that takes the place of another one when it is complete.

    Parameters
    ----------
    path : str or path-like
        Its place. Until the end, and after a failure, what was there is still there.

    Yields
    ------
    Path
        Beside that place, with the same suffix, for programs that choose a format by it. Nothing
        is there yet.

    Raises
    ------
    OSError
        If it cannot be written, or something other than a file is in its place.
    """
    place = Path(os.path.realpath(path))  # a link stays one
    if place.exists() and not place.is_file():
        number = errno.EISDIR if place.is_dir() else errno.EINVAL
        raise OSError(number, os.strerror(number), os.fspath(path))
    writer = f"{os.getpid()}-{threading.get_ident()}"
    part = place.with_name(f".{place.stem}.{writer}.part{Path(path).suffix}")
    try:
        yield part
        part.replace(place)
    except OSError as error:
        if error.errno is None or error.filename not in (None, str(part)):
            raise
        # Writing names no file, and the name of the part would tell a user nothing.
        raise OSError(error.errno, error.strerror, os.fspath(path)) from None
    finally:
        part.unlink(missing_ok=True)


@contextlib.contextmanager
def written_whole(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file for bytes that takes the place of another one when it is complete.

    See `part_of` for the parameter and the errors.
    """
    with part_of(path) as part, part.open("wb") as file:
        yield file


def write_text(path: str | os.PathLike[str], text: str) -> Path:
    """Write a text as UTF-8, whole or not at all; errors are those of `part_of`."""
    with written_whole(path) as file:
        file.write(text.encode())
    return Path(path)
