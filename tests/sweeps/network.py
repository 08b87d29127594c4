"""A simulated cluster: an executor with random events, determined by a seed."""

import random
from collections import Counter
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, InvalidStateError
from types import SimpleNamespace
from typing import Any

FATES = {
    "answers": 30,
    "answers twice": 4,
    "dies": 4,
    "dies, and answers late": 4,
    "is cancelled, and answers late": 2,
    "answers for another task": 3,
    "answers too little": 2,
    "was interrupted": 2,
    "answers garbage": 4,
    "is of another build": 1,
    "meets Ctrl-C": 1,
}
"""How often they happen, beside each other."""

OTHER_BUILD = "0123456789abcdef"


class Network(Executor):
    """Tasks answer in any order, twice, late, wrongly or never; without threads and clocks.

    Parameters
    ----------
    seed : float
        Of all that happens.
    trouble : float
        [-] Weight of all fates but the first; 0 is a sound cluster.
    refusal : float
        [-] How often a task is not taken.
    happened : Counter
        Counts what happens.
    """

    def __init__(self, seed: float, trouble: float, refusal: float, happened: Counter[str]) -> None:
        self.draw = random.Random(seed)
        self.fates = {name: n * trouble for name, n in FATES.items()} | {"answers": 30}
        self.refusal, self.happened = refusal, happened
        self.tasks: list[tuple[Future[Any], Callable[[], Any]]] = []
        self.late: list[tuple[Future[Any], Any]] = []
        self.last: Any = None

    def submit(self, call: Any, /, *args: Any, **options: Any) -> Future[Any]:
        """Take a task."""
        if self.draw.random() < self.refusal:
            self.happened["refuses a task"] += 1
            raise BrokenExecutor("no worker is left")
        future: Future[Any] = Future()
        self.tasks.append((future, lambda: call(*args, **options)))
        return future

    def wait(self, futures: Any, return_when: Any) -> Any:
        """Simulate events until one of the futures is done, instead of `futures.wait`."""
        assert return_when == "FIRST_COMPLETED"
        while not (done := [each for each in futures if each.done()]):
            self.step()
        return SimpleNamespace(done=done)

    def step(self) -> None:
        """Simulate an event for a task, and sometimes the arrival of a late answer."""
        if self.late and self.draw.random() < 0.2:
            self.arrive_late()
        future, compute = self.tasks.pop(self.draw.randrange(len(self.tasks)))
        fate = self.draw.choices(list(self.fates), list(self.fates.values()))[0]
        self.happened[fate] += 1
        if fate == "meets Ctrl-C":
            self.tasks.append((future, compute))
            raise KeyboardInterrupt
        answer = compute()
        if "late" in fate or "twice" in fate:
            self.late.append((future, answer))
        match fate:
            case "answers" | "answers twice":
                future.set_result(answer)
            case "dies" | "dies, and answers late":
                future.set_exception(BrokenExecutor("a worker was killed"))
            case "is cancelled, and answers late":
                future.cancel()
            case "answers for another task":
                future.set_result(self.last)
            case "answers too little":
                future.set_result((answer[0], answer[1][:-1]))
            case "was interrupted":
                build, [*rows, (identity, _)] = answer
                future.set_result((build, [*rows, (identity, None)]))
            case "is of another build":
                future.set_result((OTHER_BUILD, self.draw.choice([[], answer[1]])))
            case "answers garbage":
                future.set_result(self.draw.choice(garbage(*answer)))
        self.last = answer

    def arrive_late(self) -> None:
        """Let an answer arrive that nobody waits for any longer."""
        future, answer = self.late.pop(self.draw.randrange(len(self.late)))
        try:
            future.set_result(answer)
        except InvalidStateError:
            self.happened["arrives late"] += 1

    def end(self) -> None:
        """Let all pending answers arrive."""
        self.late += [(future, compute()) for future, compute in self.tasks]
        self.tasks = []
        while self.late:
            self.arrive_late()


def garbage(build: str, rows: list[tuple[str, Any]]) -> list[Any]:
    """An answer that no worker should give, but one with the right bits and a wrong field might."""
    (identity, result), *others = rows
    time = result["metrics"]["time"]

    def with_result(**fields: Any) -> Any:
        return build, [(identity, {**result, **fields}), *others]

    return [
        None,
        7,
        "ab",
        (),
        (build,),
        (build, None),
        (build, [None] * len(rows)),
        (build, [*rows, rows[0]]),
        (build, [("", result), *others]),
        (build, [(identity, {}), *others]),
        (build, [(identity, "cleared"), *others]),
        with_result(outcome="won"),
        with_result(outcome=None),
        with_result(metrics={}),
        with_result(metrics={**result["metrics"], "time": str(time)}),
        with_result(metrics={**result["metrics"], "luck": 1.0}),
        with_result(diagnosis={"outcome": "seized"}),
        with_result(wall_time=None),
    ]
