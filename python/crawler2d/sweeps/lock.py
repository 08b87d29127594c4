"""One process alone writes into a file."""

from __future__ import annotations

import os
import sys
import threading
from pathlib import Path

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

__all__ = ["Lock"]

# Beyond the end of every file, and of what SQLite locks of it.
_BYTE = 2**62

# What this process has locked: the system's locks keep out other processes alone.
_locked: set[tuple[int, int]] = set()
_guard = threading.Lock()


class Lock:
    """Keeps every other writer out of a file, by whatever name it finds the file.

    It ends with this process, however that ends. Nothing lies beside the file that could be
    removed. Readers, and SQLite itself, do not notice.

    Parameters
    ----------
    file : Path
        It is made, empty, if it does not exist.

    Raises
    ------
    BlockingIOError
        If there is another writer.
    OSError
        If the file cannot be made or written.
    """

    def __init__(self, file: Path) -> None:
        self._file = file
        with _guard:
            # Not even opened: to close it again would undo what SQLite has locked in this process.
            if file.exists() and _key(file.stat()) in _locked:
                raise BlockingIOError
            self._descriptor = os.open(file, os.O_RDWR | os.O_CREAT, 0o666)
            try:
                if sys.platform == "win32":
                    os.lseek(self._descriptor, _BYTE, os.SEEK_SET)
                    msvcrt.locking(self._descriptor, msvcrt.LK_NBLCK, 1)
                self.keep()
            except BaseException:
                os.close(self._descriptor)
                raise
            self._key = _key(os.fstat(self._descriptor))
            _locked.add(self._key)

    def keep(self) -> None:
        """Lock the byte again; nothing happens if it is.

        Where a lock belongs to the process, whatever unlocks or closes the file undoes it: SQLite
        whenever it reads or writes without a log, another part of the program that copies it.

        Raises
        ------
        BlockingIOError
            If there is another writer by now.
        """
        if sys.platform != "win32":
            try:
                fcntl.lockf(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, _BYTE)
            except PermissionError as error:  # so some systems call it
                raise BlockingIOError from error

    def is_there(self) -> bool:
        """Whether the file is still where it was."""
        try:
            return _key(self._file.stat()) == self._key
        except OSError:
            return False

    def close(self) -> None:
        """Let others write."""
        with _guard:
            if self._descriptor >= 0:
                _locked.remove(self._key)
                os.close(self._descriptor)
                self._descriptor = -1


def _key(status: os.stat_result) -> tuple[int, int]:
    return status.st_dev, status.st_ino
