"""Whatever is wrong with a model file: it is read or refused, soon and in little memory."""

import random
import resource
import sys
import time
import warnings
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from tests.fuzz.account import SEED, Account, cases
from tests.fuzz.model_files import CARTS, ORIGINALS, mutated
from tests.robots.robot_files import FOLDER

LONGEST = 2.0  # [s] of processor time for one file
MOST = 500  # [MB] for all, one after the other


def megabytes() -> float:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def computed() -> float:
    """Processor time of this process and of those that it started [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + used.ru_utime + used.ru_stime


def go_through(folder: Path, count: int, originals: dict[str, bytes], **how: Any) -> Account:
    """Read that many mutated files."""
    account = Account("model files")
    names = sorted(originals)
    before = megabytes()
    for number in range(count):
        draw = random.Random(f"{SEED} {number}")
        # Small files are drawn more often: a fault in them meets more rules.
        name = draw.choices(names, [1.0 / len(originals[n]) for n in names])[0]
        path = folder / name
        path.write_bytes(mutated(originals[name], draw))
        case = f"case {number} of {name}"
        start = computed()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", c2d.ScenarioWarning)
                mesh = draw.choice(("leave_out", "hull"))
                reading = c2d.read_robot(path, **{"mesh": mesh, **how})
            account.counts["read"] += 1
            assert reading.robot.wheels() is not None
        except c2d.ScenarioError as error:
            account.counts["refused" if error.path else "refused without a path"] += 1
        except Exception as error:
            account.fault(type(error).__name__, f"{case}: {error}")
        seconds = computed() - start
        account.took(seconds, case)
        if seconds > LONGEST:
            account.fault("too slow", f"{case}: {seconds:.1f} s")
    if megabytes() - before > MOST:
        account.fault("too much memory", f"{megabytes() - before:.0f} MB more")
    return account


def check(account: Account) -> None:
    print(account)
    assert not account.faults, str(account)
    assert not account.counts["refused without a path"]
    assert account.counts["read"] > 0
    assert account.counts["refused"] > 0


@pytest.mark.skipif(sys.platform == "win32", reason="measures memory as Unix tells it")
def test_a_mutated_model_file_is_read_or_refused(tmp_path: Path) -> None:
    check(go_through(tmp_path, cases("MODELS", 300), ORIGINALS))


@pytest.mark.soak
def test_20000_mutated_model_files_are_read_or_refused(tmp_path: Path) -> None:
    check(go_through(tmp_path, cases("MODELS", 20_000), ORIGINALS))


def test_a_mutated_mjcf_file_is_read_or_refused(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    originals = {"cart.xml": (CARTS / "cart.xml").read_bytes()}
    check(go_through(tmp_path, cases("CHILDREN", 20), originals))


def test_a_mutated_xacro_file_is_read_or_refused(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    originals = {"eng.xacro": (FOLDER / "eng.xacro").read_bytes()}
    how = {"trusted": True, "missing": "leave_out", "mesh": "leave_out"}
    check(go_through(tmp_path, cases("CHILDREN", 20), originals, **how))
