"""Kill a process at one system call of its work. Only on Linux, whose kernel stops it at each."""

import ctypes
import os
import signal
from collections.abc import Callable

TRACE_ME, GO_ON = 0, 24  # of ptrace(2)


def is_killed(work: Callable[[], object], stop: int) -> bool:
    """Do some work in a child process that is killed at its `stop`-th stop.

    It stops before and after every system call. Returns whether it was still there.
    """
    trace = ctypes.CDLL(None).ptrace
    trace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
    trace.restype = ctypes.c_long
    child = os.fork()
    if child == 0:
        try:
            trace(TRACE_ME, 0, None, None)
            os.kill(os.getpid(), signal.SIGSTOP)
            work()
        finally:
            os._exit(0)
    _, status = os.waitpid(child, 0)
    for _ in range(stop):
        if not os.WIFSTOPPED(status):
            return False
        assert trace(GO_ON, child, None, None) == 0
        _, status = os.waitpid(child, 0)
    if not os.WIFSTOPPED(status):
        return False
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    return True
