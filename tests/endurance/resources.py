"""Resources of this process: memory, descriptors, threads."""

import gc
import os
import threading
import time
from typing import NamedTuple


class Held(NamedTuple):
    """At one instant."""

    megabytes: float
    """Resident, after Python's own garbage is collected."""
    descriptors: int
    threads: int
    """Those of Python and all others."""


def held() -> Held:
    gc.collect()
    with open("/proc/self/statm") as statm:
        pages = int(statm.read().split()[1])
    return Held(
        pages * os.sysconf("SC_PAGESIZE") / 2**20,
        len(os.listdir("/proc/self/fd")),
        _threads(),
    )


def _threads() -> int:
    """Return their number; a joined thread stays in the list until the system has ended it."""
    found = []
    for _ in range(5):
        found.append(len(os.listdir("/proc/self/task")))
        time.sleep(0.01)
    return min(found)


def check_flat(before: Held, after: Held, megabytes: float) -> str:
    """Describe growth; fail if memory grew by more than a limit, or anything else grew."""
    assert after.descriptors <= before.descriptors, (before, after)
    assert after.threads <= before.threads, (before, after, threading.enumerate())
    assert after.megabytes - before.megabytes < megabytes, (before, after)
    return (
        f"memory {after.megabytes - before.megabytes:+.2f} MB at {after.megabytes:.0f} MB,"
        f" descriptors {after.descriptors - before.descriptors:+d},"
        f" threads {after.threads - before.threads:+d}"
    )
