"""A standing child process, which imports only once and otherwise works like any child.

Started as a program, it imports what a child of the reader needs. For each question it forks, and
the fork does what the child does when it is started: it sets its limits, reads the question and
answers. A fork that hangs, grows or crashes ends alone.
"""

from __future__ import annotations

import base64
import contextlib
import importlib
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import pytest

from crawler2d.reading import parsing

PATIENCE = 30  # [s] Of the clock, as the reader has it.
ROOT = Path(__file__).parents[2]


class StandingChild:
    """Takes the place of the processes that the reader starts, for one program.

    Parameters
    ----------
    program : str
        Dotted name of the module that the reader would start.
    """

    def __init__(self, program: str) -> None:
        self.program = program
        self.asked = 0
        """How many questions it was asked."""
        self.seconds = 0.0
        """Processor time of the last fork."""
        self.megabytes = 0.0
        """The largest memory of any fork, with what the imports take."""

    def start(self) -> None:
        """Start it, and let it import."""
        command = [sys.executable, "-m", __name__, self.program]
        self.process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, cwd=ROOT, text=True
        )

    def stop(self) -> None:
        """End it."""
        self.process.communicate(timeout=PATIENCE)  # closes its input, which ends it

    def __enter__(self) -> Self:
        self.start()
        self.patch = pytest.MonkeyPatch()
        self.patch.setattr("crawler2d.reading.parsing.subprocess.run", self.run)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.patch.undo()
        self.stop()

    def run(
        self, command: list[str], *, input: bytes, cwd: Path, **_: Any
    ) -> subprocess.CompletedProcess[bytes]:
        """Answer like `subprocess.run`."""
        assert command[-1] == self.program
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        question = [input.decode(), str(cwd), dict(os.environ)]
        print(json.dumps(question), file=self.process.stdin, flush=True)
        told = json.loads(self.process.stdout.readline())
        self.asked += 1
        self.seconds = told["seconds"]
        self.megabytes = max(self.megabytes, told["megabytes"])
        out, err = (base64.b64decode(told[name]) for name in ("out", "err"))
        return subprocess.CompletedProcess(command, told["status"], out, err)


class StandingChildren:
    """One for each program of the reader, started when it is first asked."""

    def __init__(self) -> None:
        self.children: dict[str, StandingChild] = {}
        self.start = subprocess.run

    def run(self, command: list[str], **how: Any) -> subprocess.CompletedProcess[Any]:
        """Take the place of `subprocess.run`, which starts whatever else is asked for."""
        program = command[-1]
        if command[:-1] != [sys.executable, "-P", "-m"] or not program.startswith("crawler2d."):
            return self.start(command, **how)
        if program not in self.children:
            self.children[program] = StandingChild(program)
            self.children[program].start()
        try:
            return self.children[program].run(command, **how)
        except BaseException:
            # Its answer would be taken for that to the next question.
            child = self.children.pop(program)
            child.process.kill()
            child.stop()
            raise

    def stop(self) -> None:
        """End all."""
        for child in self.children.values():
            child.stop()


def _stand(program: str) -> None:
    """Answer the questions on standard input, each in a fork."""
    if "COVERAGE_PROCESS_CONFIG" in os.environ:
        parsing.SECONDS *= 3  # what is traced takes longer
        parsing.CLOCK *= 3
    prepare = importlib.import_module(program).prepare
    prepare()
    for line in sys.stdin:
        question, folder, environment = json.loads(line)
        with contextlib.ExitStack() as stack:
            files = [stack.enter_context(tempfile.TemporaryFile()) for _ in range(3)]
            files[0].write(question.encode())
            files[0].seek(0)
            fork = os.fork()
            if not fork:
                for number, file in enumerate(files):
                    os.dup2(file.fileno(), number)
                _answer(prepare, folder, environment)
            _, status, used = os.wait4(fork, 0)
            for file in files[1:]:
                file.seek(0)
            out, err = (base64.b64encode(file.read()).decode() for file in files[1:])
        told = {
            "status": os.waitstatus_to_exitcode(status),
            "seconds": used.ru_utime + used.ru_stime,
            "megabytes": used.ru_maxrss / 1024,
            "out": out,
            "err": err,
        }
        print(json.dumps(told), flush=True)


def _answer(prepare: Any, folder: str, environment: dict[str, str]) -> None:
    """Do the work of a started child; never return."""
    signal.alarm(PATIENCE)
    status = 1
    try:
        os.chdir(folder)
        os.environ.clear()
        os.environ.update(environment)
        tempfile.tempdir = None  # which the environment says
        sys.stdin, sys.stdout, sys.stderr = open(0), open(1, "w"), open(2, "w")  # noqa: SIM115
        parsing.serve(prepare)
        status = 0
    except BaseException as error:
        print(f"{type(error).__name__}: {error}", file=sys.stderr, flush=True)
    finally:
        os._exit(status)


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    _stand(sys.argv[1])
