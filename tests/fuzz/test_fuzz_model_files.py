"""A faulty model file is read or refused, quickly and in little memory.

MuJoCo and xacro read in processes of their own, most of whose time goes into imports. Some files go
through the whole door, a process each; thousands are read in forks of a process that has imported
what it needs, under the same limits, with all of the reader round it.
"""

import random
import resource
import signal
import sys
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import crawler2d as c2d
from tests.fuzz.account import SEED, Account, cases
from tests.fuzz.model_files import MESHES, MJCF, ON_MESHES, PARTS, SDF, URDF, XACRO, mutated
from tests.fuzz.standing_child import StandingChild
from tests.reading.odd_files import ODD, lay_out

LONGEST = 2.2
"""[s] Of processor time for one file: 2 s for a child, and what the reader itself does."""

PATIENCE = 10.0
"""[s] Of the clock for one file; what takes longer waits for something, and is ended."""

ODD_SHARE = 0.02
"""Of all models, how many are no file, but a pipe, a device or the like."""

MOST = 500
"""[MB] For all files, one after the other, and for any child with its imports."""

LENIENT: dict[str, Any] = {"missing": "leave_out", "mesh": "leave_out"}
NAMED_BY_XACRO = tuple(name for name in PARTS if name.endswith(("xacro", "yaml")))
TRUST = pytest.mark.parametrize("trusted", [True, False])
LOOP = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
<link name="${max(range(10**12))}"/></robot>"""


def megabytes(who: int = resource.RUSAGE_SELF) -> float:
    return resource.getrusage(who).ru_maxrss / 1024


def computed() -> float:
    """Processor time of this process and of those that it started [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + used.ru_utime + used.ru_stime


def put_parts(folder: Path, parts: tuple[str, ...], draw: random.Random | None = None) -> None:
    """Write the files that models name; with random draws, one is mutated every other time."""
    faulty = draw.choice(parts) if draw and parts and draw.random() < 0.5 else None
    for name in parts:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        data = PARTS[name]
        (folder / name).write_bytes(mutated(data, draw) if draw and name == faulty else data)


def go_through(
    folder: Path,
    count: int,
    originals: dict[str, bytes],
    standing: StandingChild | None = None,
    models: dict[str, bytes] | None = None,
    parts: tuple[str, ...] = (),
    **how: Any,
) -> Account:
    """Read that many mutated files; a child that stands ready may do what the reader's do.

    Where there are models, what is mutated is the mesh that each names. Of the parts that are
    given, one is mutated, too, in every other case.
    """
    account = Account("model files")
    names = sorted(originals)
    lay_out(folder, sorted({Path(name).suffix[1:] for name in (*names, *PARTS)}))
    put_parts(folder, tuple(PARTS))
    before, largest_child = megabytes(), megabytes(resource.RUSAGE_CHILDREN)
    for number in range(count):
        draw = random.Random(f"{SEED} {number}")
        # Small files are drawn more often: a fault in them meets more rules.
        name = draw.choices(names, [1.0 / len(originals[n]) for n in names])[0]
        path = folder / name
        path.write_bytes(mutated(originals[name], draw))
        if models is not None:
            path = folder / "cart.urdf"
            path.write_bytes(models[name])
        elif draw.random() < ODD_SHARE:
            path = folder / f"{draw.choice(list(ODD))}{path.suffix}"
        put_parts(folder, parts, draw)
        case = f"case {number} of {path.name if models is None else name}"
        start, asked = computed(), standing.asked if standing else 0
        signal.setitimer(signal.ITIMER_REAL, PATIENCE)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", c2d.ScenarioWarning)
                mesh = draw.choice(("leave_out", "hull"))
                reading = c2d.read_robot(path, **{"mesh": mesh, **how})
            account.counts["read"] += 1
            assert reading.robot.wheels() is not None
        except c2d.ScenarioError as error:
            account.counts["refused" if error.path else "refused without a path"] += 1
            if "regular file" in error.rule or "folder or package of its model" in error.rule:
                account.counts["of them for a file"] += 1
        except Exception as error:
            account.fault(type(error).__name__, f"{case}: {error}")
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0.0)
        seconds = computed() - start
        if standing is not None and standing.asked > asked:
            seconds += standing.seconds
        account.took(seconds, case)
        if seconds > LONGEST:
            account.fault("too slow", f"{case}: {seconds:.1f} s")
    # The system keeps the most that any child ever had, and counts what a child is forked from: the
    # whole of this process. What is no more than either says nothing of these children.
    child = megabytes(resource.RUSAGE_CHILDREN)
    of_children = child if child > max(largest_child, megabytes()) else 0.0
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


pytestmark = [
    pytest.mark.skipif(sys.platform == "win32", reason="has pipes and limits of Unix"),
    pytest.mark.usefixtures("children_of_its_own"),
]


@pytest.fixture(autouse=True)
def _nothing_waits() -> Iterator[None]:
    def end(*_: Any) -> None:
        raise TimeoutError(f"no answer within {PATIENCE:g} s")

    before = signal.signal(signal.SIGALRM, end)
    yield
    signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("originals", [SDF, URDF], ids=["sdf", "urdf"])
def test_a_mutated_model_file_is_read_or_refused(
    tmp_path: Path, originals: dict[str, bytes]
) -> None:
    check(go_through(tmp_path, cases("MODELS", 20), originals))


@pytest.mark.soak
@pytest.mark.parametrize("originals", [SDF, URDF], ids=["sdf", "urdf"])
def test_20000_mutated_model_files_are_read_or_refused(
    tmp_path: Path, originals: dict[str, bytes]
) -> None:
    check(go_through(tmp_path, cases("MODELS", 20_000), originals))


MESH_FORMS = pytest.mark.parametrize("form", ["stl", "obj", "dae", "glb", "gltf"])


def meshes_of(form: str) -> dict[str, bytes]:
    pytest.importorskip("trimesh")
    return {name: data for name, data in MESHES.items() if name.endswith(form)}


@pytest.fixture(scope="module")
def mesh_reader() -> Iterator[StandingChild]:
    """Imports trimesh once for all forms; whoever takes it puts it in the reader's place."""
    pytest.importorskip("trimesh")
    standing = StandingChild("crawler2d.reading.meshes")
    standing.start()
    yield standing
    standing.stop()


@MESH_FORMS
def test_a_mutated_mesh_is_read_or_left_out(
    tmp_path: Path, form: str, mesh_reader: StandingChild, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What is left out are wheels, so the model is refused."""
    monkeypatch.setattr("crawler2d.reading.parsing.subprocess.run", mesh_reader.run)
    how: dict[str, Any] = {"models": ON_MESHES, "mesh": "hull"}
    check(go_through(tmp_path, cases("MESHES", 20), meshes_of(form), mesh_reader, **how))


@pytest.mark.soak
@MESH_FORMS
def test_20000_mutated_meshes_are_read_or_left_out(tmp_path: Path, form: str) -> None:
    with StandingChild("crawler2d.reading.meshes") as standing:
        count = cases("MESHES", 20_000)
        how: dict[str, Any] = {"models": ON_MESHES, "mesh": "hull"}
        check(go_through(tmp_path, count, meshes_of(form), standing, **how))


def test_a_mutated_mjcf_file_is_read_or_refused(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    check(go_through(tmp_path, cases("CHILDREN", 12), MJCF))


@TRUST
def test_a_mutated_xacro_file_is_read_or_refused(tmp_path: Path, trusted: bool) -> None:
    pytest.importorskip("xacrodoc")
    how = {"trusted": trusted, **LENIENT}
    check(go_through(tmp_path, cases("CHILDREN", 4), XACRO, parts=NAMED_BY_XACRO, **how))


@pytest.mark.soak
def test_20000_mutated_mjcf_files_are_read_or_refused(tmp_path: Path) -> None:
    """Each in a fork of a child that stands ready, under the limits of any child."""
    pytest.importorskip("mujoco")
    with StandingChild("crawler2d.reading.mjcf") as standing:
        check(go_through(tmp_path, cases("MJCF", 20_000), MJCF, standing))


@pytest.mark.soak
@TRUST
def test_20000_mutated_xacro_files_are_read_or_refused(tmp_path: Path, trusted: bool) -> None:
    pytest.importorskip("xacrodoc")
    how = {"trusted": trusted, **LENIENT}
    with StandingChild("crawler2d.reading.xacro") as standing:
        count = cases("XACRO", 20_000)
        check(go_through(tmp_path, count, XACRO, standing, parts=NAMED_BY_XACRO, **how))


def test_a_waiting_child_process_is_ended_like_any_other(tmp_path: Path) -> None:
    pytest.importorskip("xacrodoc")
    path = tmp_path / "loop.xacro"
    path.write_text(LOOP)
    with StandingChild("crawler2d.reading.xacro") as standing:
        with pytest.raises(c2d.ScenarioError, match=r"loop\.xacro must be parsed in 2 s"):
            c2d.read_robot(path, trusted=True)
        # The system counts what a timer has run in ticks, a whole one for whoever runs when it
        # ends, and what was used exactly: on a busy machine they differ by a quarter and more.
        assert 1 < standing.seconds < LONGEST
        # The next one is answered again: it is read, and is not a robot.
        path.write_text('<robot name="r"><link name="a"/></robot>')
        with pytest.raises(c2d.ScenarioError, match="must have") as caught:
            c2d.read_robot(path, trusted=True)
        assert "in 2 s" not in str(caught.value)
        assert standing.seconds < 1.0
