"""One target of the package under libFuzzer: `python -m tests.fuzz.guided_target NAME ...`.

What follows the name are options of libFuzzer, folders of cases, or one case to try again. What the
reader does in processes of its own is done there first, under their limits. What that answers is
then done once more in this process, where its coverage is seen.
"""

from __future__ import annotations

import importlib
import io
import json
import os
import pkgutil
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import atheris

with atheris.instrument_imports(include=["crawler2d", "xacro"]):
    import xacro

    import crawler2d.reading
    import crawler2d.results
    import crawler2d.sweeps

    # The others import what they need when they are first used.
    for room in (crawler2d.reading, crawler2d.results, crawler2d.sweeps):
        for module in pkgutil.iter_modules(room.__path__, f"{room.__name__}."):
            importlib.import_module(module.name)

from crawler2d.errors import ScenarioError
from tests.fuzz.guided_targets import TARGETS, prepare
from tests.fuzz.model_files import mutated
from tests.fuzz.standing_child import StandingChildren

__all__ = ["xacro"]


class Children(StandingChildren):
    """Their work is repeated here."""

    def run(self, command: list[str], **how: Any) -> subprocess.CompletedProcess[Any]:
        done = super().run(command, **how)
        if done.returncode == 0 and "cwd" in how:
            before, here = sys.stdout, Path.cwd()
            try:
                sys.stdout = io.StringIO()
                os.chdir(how["cwd"])
                work = importlib.import_module(command[-1]).prepare()
                work(json.loads(how["input"]))
            except ScenarioError:
                pass  # as in its answer
            finally:
                sys.stdout = before
                os.chdir(here)
        return done


def changed(data: bytes, most: int, seed: int) -> bytes:
    """Put faults into a model file, one time in three those of libFuzzer."""
    draw = random.Random(seed)
    new = mutated(data, draw) if draw.random() < 0.67 else atheris.Mutate(data, most)
    return new[:most]


LONGEST = 10.0
"""[s] Of processor time for one case, in this process."""


def main(name: str, *options: str) -> None:
    """Try cases until the time is over, or a case is a fault."""
    children = Children()
    setattr(subprocess, "run", children.run)  # noqa: B010 - of another type
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        prepare(name, folder)
        how = {} if name == "store" else {"custom_mutator": changed}

        def attempt(data: bytes) -> None:
            begin = time.process_time()
            TARGETS[name](data, folder)
            assert time.process_time() - begin < LONGEST

        # By its first argument libFuzzer calls itself, to merge.
        itself = f"{sys.executable} -m {__spec__.name} {name}"
        atheris.Setup([itself, *options], attempt, **how)
        atheris.Fuzz()


if __name__ == "__main__":
    main(*sys.argv[1:])
