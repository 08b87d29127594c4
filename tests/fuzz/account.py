"""Shared by the fuzz tests: amount, seed, and an account of the results."""

import os
import signal
import time
from collections import Counter
from collections.abc import Callable
from typing import Any, TypeVar

T = TypeVar("T")

SEED = int(os.environ.get("CRAWLER2D_FUZZ_SEED", "1"))
"""Of everything that is drawn, and of what make fuzz changes."""


def cases(name: str, usual: int) -> int:
    """How many cases the long form of a test has, unless an environment variable says.

    It is named after TEXTS, OBJECTS, RULES, RUNS, MODELS, MESHES, MJCF, XACRO or CHILDREN.
    """
    return int(os.environ.get(f"CRAWLER2D_FUZZ_{name}", usual))


class Account:
    """Results of many cases, and those that must not occur: counted by kind, with examples."""

    EXAMPLES = 3

    def __init__(self, name: str) -> None:
        self.name = name
        self.counts: Counter[str] = Counter()
        self.faults: Counter[str] = Counter()
        self.examples: dict[str, list[str]] = {}
        self.reasons: Counter[str] = Counter()
        self.slowest = (0.0, "")
        self.latest = 0.0  # [s] answer to an interrupt
        self.megabytes = 0.0  # memory, where it is measured

    def fault(self, kind: str, example: str) -> None:
        self.faults[kind] += 1
        examples = self.examples.setdefault(kind, [])
        if len(examples) < self.EXAMPLES:
            examples.append(example)

    def took(self, seconds: float, case: str) -> None:
        self.slowest = max(self.slowest, (seconds, case))

    def __str__(self) -> str:
        counts = ", ".join(f"{count} {kind}" for kind, count in self.counts.most_common())
        seconds, case = self.slowest
        lines = [f"{self.name}, seed {SEED}: {counts}; slowest {seconds:.2f} s ({case})"]
        if self.megabytes:
            lines[0] += f"; {self.megabytes:.0f} MB"
        lines += [f"{count} x {reason}" for reason, count in self.reasons.most_common()]
        for kind, count in self.faults.most_common():
            lines += [f"FAULT {count} x {kind}", *(f"    {e}" for e in self.examples[kind])]
        return "\n  ".join(lines)


class Interrupt(BaseException):
    """Raised by a signal, as Ctrl-C raises a KeyboardInterrupt; the tester's own still ends all."""


def interrupted(after: float, call: Callable[[], T]) -> tuple[T | None, float | None]:
    """Call, and interrupt it as Ctrl-C does when it has taken so much processor time [s].

    Returns
    -------
    object or None
        What the call returned, if it ended by itself.
    float or None
        [s] Processor time from the interrupt to its answer, if there was one.
    """

    def interrupt(*_: Any) -> None:
        raise Interrupt

    before = signal.signal(signal.SIGPROF, interrupt)
    begin = time.process_time()
    try:
        signal.setitimer(signal.ITIMER_PROF, after)
        result = call()
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        return result, None
    except Interrupt:
        return None, time.process_time() - begin - after
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.signal(signal.SIGPROF, before)
