"""Whatever is wrong with a model file: it is read or refused, soon and in little memory.

MuJoCo and xacro read in processes of their own, most of whose time goes into imports. Some files go
through the whole door, a process each; thousands are read in forks of a process that has imported
what it needs, under the same limits, with all of the reader round it.
"""

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
from tests.fuzz.model_files import MJCF, ORIGINALS, XACRO, mutated
from tests.fuzz.standing_child import StandingChild

LONGEST = 2.2
"""[s] Of processor time for one file: 2 s for a child, and what the reader itself does."""

MOST = 500
"""[MB] For all files, one after the other, and for any child with its imports."""

TRUSTED: dict[str, Any] = {"trusted": True, "missing": "leave_out", "mesh": "leave_out"}
LOOP = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<link name="${max(range(10**12))}"/></robot>"""


def megabytes(who: int = resource.RUSAGE_SELF) -> float:
    return resource.getrusage(who).ru_maxrss / 1024


def computed() -> float:
    """Processor time of this process and of those that it started [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + used.ru_utime + used.ru_stime


def go_through(
    folder: Path,
    count: int,
    originals: dict[str, bytes],
    standing: StandingChild | None = None,
    **how: Any,
) -> Account:
    """Read that many mutated files; a child that stands ready may do what the reader's do."""
    account = Account("model files")
    names = sorted(originals)
    before, largest_child = megabytes(), megabytes(resource.RUSAGE_CHILDREN)
    for number in range(count):
        draw = random.Random(f"{SEED} {number}")
        # Small files are drawn more often: a fault in them meets more rules.
        name = draw.choices(names, [1.0 / len(originals[n]) for n in names])[0]
        path = folder / name
        path.write_bytes(mutated(originals[name], draw))
        case = f"case {number} of {name}"
        start, asked = computed(), standing.asked if standing else 0
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
        if standing is not None and standing.asked > asked:
            seconds += standing.seconds
        account.took(seconds, case)
        if seconds > LONGEST:
            account.fault("too slow", f"{case}: {seconds:.1f} s")
    # The system keeps the most that any child ever had: one of another test is none of these.
    child = megabytes(resource.RUSAGE_CHILDREN)
    of_children = child if child > largest_child else 0.0
    of_forks = standing.megabytes if standing else 0.0
    account.megabytes = max(megabytes() - before, of_children, of_forks)
    if account.megabytes > MOST:
        account.fault("too much memory", f"{account.megabytes:.0f} MB")
    return account


def check(account: Account) -> None:
    print(account)
    assert not account.faults, str(account)
    assert not account.counts["refused without a path"]
    assert account.counts["read"] > 0
    assert account.counts["refused"] > 0


unix = pytest.mark.skipif(sys.platform == "win32", reason="measures memory as Unix tells it")


@unix
def test_a_mutated_model_file_is_read_or_refused(tmp_path: Path) -> None:
    check(go_through(tmp_path, cases("MODELS", 300), ORIGINALS))


@pytest.mark.soak
def test_20000_mutated_model_files_are_read_or_refused(tmp_path: Path) -> None:
    check(go_through(tmp_path, cases("MODELS", 20_000), ORIGINALS))


def test_a_mutated_mjcf_file_is_read_or_refused(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    check(go_through(tmp_path, cases("CHILDREN", 20), MJCF))


def test_a_mutated_xacro_file_is_read_or_refused(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    check(go_through(tmp_path, cases("CHILDREN", 20), XACRO, **TRUSTED))


@unix
@pytest.mark.soak
def test_20000_mutated_mjcf_files_are_read_or_refused(tmp_path: Path) -> None:
    """Each in a fork of a child that stands ready, under the limits of any child."""
    pytest.importorskip("mujoco")
    with StandingChild("crawler2d.reading.mjcf_child") as standing:
        check(go_through(tmp_path, cases("MJCF", 20_000), MJCF, standing))


@unix
@pytest.mark.soak
def test_20000_mutated_xacro_files_are_read_or_refused(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    with StandingChild("crawler2d.reading.xacro_child") as standing:
        check(go_through(tmp_path, cases("XACRO", 20_000), XACRO, standing, **TRUSTED))


@unix
def test_a_child_that_stands_ready_is_ended_as_any_other(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    path = tmp_path / "loop.xacro"
    path.write_text(LOOP)
    with StandingChild("crawler2d.reading.xacro_child") as standing:
        for _ in range(2):  # the next one is answered again
            with pytest.raises(c2d.ScenarioError, match=r"loop\.xacro must be understood in 2 s"):
                c2d.read_robot(path, trusted=True)
            # The system counts what a timer has run in ticks, and what was used exactly.
            assert 1.5 < standing.seconds < LONGEST
