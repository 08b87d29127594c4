"""What this process holds of the system: memory, descriptors, threads."""

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
    """How many there are; one that was joined stays in the list until the system has ended it."""
    found = []
    for _ in range(5):
        found.append(len(os.listdir("/proc/self/task")))
        time.sleep(0.01)
    return min(found)


def check_flat(before: Held, after: Held, megabytes: float) -> str:
    """What has grown, in words; fails if it is more than so much memory, or anything else."""
    assert after.descriptors <= before.descriptors, (before, after)
    assert after.threads <= before.threads, (before, after, threading.enumerate())
    assert after.megabytes - before.megabytes < megabytes, (before, after)
    return (
        f"memory {after.megabytes - before.megabytes:+.2f} MB at {after.megabytes:.0f} MB,"
        f" descriptors {after.descriptors - before.descriptors:+d},"
        f" threads {after.threads - before.threads:+d}"
    )
