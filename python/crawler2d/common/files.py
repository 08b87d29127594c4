"""Write files that appear only when complete."""

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
    """Return a temporary path that replaces a file when complete.

    Parameters
    ----------
    path : str or path-like
        The final path. Its old content stays until the end, and after a failure.

    Yields
    ------
    Path
        A new path in the same folder, with the same suffix, as some programs choose the format by
        it.

    Raises
    ------
    OSError
        If it cannot be written, or the path exists and is not a file.
    """
    place = Path(os.path.realpath(path))  # links stay links
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
        # Errors from writing name no file, and the temporary name would not help a user.
        raise OSError(error.errno, error.strerror, os.fspath(path)) from None
    finally:
        part.unlink(missing_ok=True)


@contextlib.contextmanager
def written_whole(path: str | os.PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a binary file that replaces another one when complete.

    See `part_of` for parameter and errors.
    """
    with part_of(path) as part, part.open("wb") as file:
        yield file


def write_text(path: str | os.PathLike[str], text: str) -> Path:
    """Write text as UTF-8, completely or not at all; raises the errors of `part_of`."""
    with written_whole(path) as file:
        file.write(text.encode())
    return Path(path)
