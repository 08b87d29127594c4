"""Make a system call that writes, opens or renames fail. Only on Linux on x86-64."""

import ctypes
import os
import signal
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

__all__ = ["CALLS", "Ending", "ends_with"]

_TRACE_ME, _GET, _SET, _GO_ON, _OPTIONS = 0, 12, 13, 24, 0x4200  # requests of ptrace(2)
_SAY_THAT_IT_IS_A_CALL, _CALL_STOP = 1, signal.SIGTRAP | 0x80

CALLS = {
    1: "write",
    2: "open",
    9: "mmap",
    18: "pwrite64",
    74: "fsync",
    75: "fdatasync",
    76: "truncate",
    77: "ftruncate",
    82: "rename",
    83: "mkdir",
    87: "unlink",
    257: "openat",
    263: "unlinkat",
    264: "renameat",
    285: "fallocate",
    316: "renameat2",
}
"""Those that fail, by their numbers on x86-64."""

_TO_FILES = ("write", "pwrite64")
_LEAST = 3
"""Descriptors below this are those of the terminal."""

_NAMES = (
    "r15 r14 r13 r12 rbp rbx r11 r10 r9 r8 rax rcx rdx rsi rdi orig_rax rip cs eflags rsp ss"
    " fs_base gs_base ds es fs gs"
)


class _Registers(ctypes.Structure):
    _fields_ = [(name, ctypes.c_ulonglong) for name in _NAMES.split()]


class Ending(IntEnum):
    """How work ended: its own result, or that it was interrupted."""

    DONE = 0
    REFUSED = 3
    """An error that users are told to expect."""
    BROKEN = 4
    """Any other exception, which is printed."""
    LOST = 5
    """A signal, such as that of an abort or a bad address."""


@dataclass(frozen=True)
class Fault:
    """The call that failed, "" if there were fewer, and how the work ended."""

    call: str
    ending: Ending


def ends_with(
    work: Callable[[], object],
    at: int,
    error: int,
    expected: tuple[type[BaseException], ...],
) -> Fault:
    """Do some work in a child process, in which the `at`-th of `CALLS` returns an error number.

    A number of 0 lets a write write the first half alone, which is no failure. Only the thread that
    works is stopped at its calls.
    """
    trace = ctypes.CDLL(None).ptrace
    trace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
    trace.restype = ctypes.c_long
    child = os.fork()
    if child == 0:
        trace(_TRACE_ME, 0, None, None)
        os.kill(os.getpid(), signal.SIGSTOP)
        os._exit(_ending_of(work, expected))
    os.waitpid(child, 0)
    trace(_OPTIONS, child, None, _SAY_THAT_IT_IS_A_CALL)
    counted, registers, signalled, enters = _Counted(at, error), _Registers(), 0, True
    while True:
        trace(_GO_ON, child, None, signalled)
        _, status = os.waitpid(child, 0)
        if not os.WIFSTOPPED(status):
            ending = Ending(os.WEXITSTATUS(status)) if os.WIFEXITED(status) else Ending.LOST
            return Fault(counted.failed, ending)
        signalled = 0
        if os.WSTOPSIG(status) != _CALL_STOP:
            signalled = os.WSTOPSIG(status)  # one of its own, which is passed on
            continue
        trace(_GET, child, None, ctypes.addressof(registers))
        if counted.enter(registers) if enters else counted.leave(registers):
            trace(_SET, child, None, ctypes.addressof(registers))
        enters = not enters


def _ending_of(work: Callable[[], object], expected: tuple[type[BaseException], ...]) -> Ending:
    try:
        work()
    except expected:
        return Ending.REFUSED
    except BaseException:
        traceback.print_exc()
        return Ending.BROKEN
    return Ending.DONE


class _Counted:
    """Counts calls, and changes the registers of one so that it fails."""

    def __init__(self, at: int, error: int) -> None:
        self._left, self._error, self._fails = at, error, False
        self.failed = ""

    def enter(self, registers: _Registers) -> bool:
        """Count the call that begins; return whether registers were changed."""
        name = CALLS.get(registers.orig_rax, "")
        if not name or (name in _TO_FILES and registers.rdi < _LEAST):
            return False
        self._left -= 1
        if self._left != 0:
            return False
        self.failed, self._fails = name, self._error != 0
        if self._fails:
            registers.orig_rax = ctypes.c_ulonglong(-1).value  # there is no such call
        elif name in _TO_FILES:
            registers.rdx = max(registers.rdx // 2, 1)
        return True

    def leave(self, registers: _Registers) -> bool:
        """Return the error of the call that ends, if it is to fail."""
        fails, self._fails = self._fails, False
        if fails:
            registers.rax = ctypes.c_ulonglong(-self._error).value
        return fails
