"""Optional packages: missing ones are distinguished from failed or interrupted imports."""

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from crawler2d.common.extras import extra
from crawler2d.runs.progress import reporter

# Its second half cannot be loaded twice, like that of many compiled packages.
HALF = """
import sys
import halved.core
if not hasattr(sys, "_halved_core"):
    sys._halved_core = True
    raise KeyboardInterrupt
raise {error}
"""

INTERRUPTED = """
import os, signal
os.kill(os.getpid(), signal.SIGINT)
for _ in range(1000):
    pass  # the answer to the signal would come here
whole = True
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder that packages are imported from, forgotten afterwards."""
    monkeypatch.syspath_prepend(tmp_path)
    known = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - known:
        del sys.modules[name]
    vars(sys).pop("_halved_core", None)


def package(folder: Path, text: str) -> None:
    (folder / "halved").mkdir()
    (folder / "halved" / "core.py").touch()
    (folder / "halved" / "__init__.py").write_text(text)


def test_a_package_that_is_not_there_names_its_extra() -> None:
    with pytest.raises(ImportError, match=r"^this needs halved: pip install 'crawler2d\[half\]'$"):
        extra("halved.core", "half")


@pytest.mark.parametrize(
    "error",
    [
        'ImportError("cannot load module more than once per process")',
        "AttributeError(\"partially initialized module 'halved' has no attribute 'core'\")",
        'ModuleNotFoundError("No module named \'other\'", name="other")',
    ],
)
def test_a_partly_imported_package_is_not_called_missing(folder: Path, error: str) -> None:
    package(folder, HALF.format(error=error))
    with pytest.raises(KeyboardInterrupt):
        extra("halved", "half")
    with pytest.raises(ImportError) as caught:
        extra("halved", "half")
    kind, _, rest = error.partition("(")
    assert f"halved is installed, but its import failed: {kind}: " in str(caught.value)
    assert rest[1:20] in str(caught.value)
    assert "pip install" not in str(caught.value)
    assert type(caught.value.__cause__).__name__ == kind
    assert caught.value.name == "halved"


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to itself")
def test_ctrl_c_during_an_import_is_answered_after_it(folder: Path) -> None:
    package(folder, INTERRUPTED)
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        extra("halved", "half")
    assert sys.modules["halved"].whole
    assert extra("halved", "half") is sys.modules["halved"]
    assert signal.getsignal(signal.SIGINT) is before
    with pytest.raises(KeyboardInterrupt):
        os.kill(os.getpid(), signal.SIGINT)


@pytest.mark.skipif(sys.platform == "win32", reason="no SIGINT to itself")
def test_ctrl_c_that_is_ignored_stays_ignored(folder: Path) -> None:
    package(folder, INTERRUPTED)
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        assert extra("halved", "half").whole
        assert signal.getsignal(signal.SIGINT) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGINT, before)


def test_another_thread_may_import(folder: Path) -> None:
    package(folder, "whole = True")
    found: list[bool] = []
    thread = threading.Thread(target=lambda: found.append(extra("halved", "half").whole))
    thread.start()
    thread.join()
    assert found == [True]


def test_progress_is_a_line_where_the_import_of_tqdm_fails(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "tqdm").mkdir()
    (folder / "tqdm" / "__init__.py").write_text("raise AttributeError('half')")
    for name in [name for name in sys.modules if name.partition(".")[0] == "tqdm"]:
        monkeypatch.delitem(sys.modules, name)
    with reporter(True, 1) as report:
        report(1)
    assert capsys.readouterr().err.startswith("1 of 1 runs")


def test_a_log_gets_a_line_for_every_tenth_and_no_carriage_return(
    capsys: pytest.CaptureFixture[str],
) -> None:
    with reporter(True, 1000) as report:
        for _ in range(1000):
            report(1)
    text = capsys.readouterr().err
    assert [line.partition(" runs")[0] for line in text.splitlines()] == [
        f"{done} of 1000" for done in range(100, 1001, 100)
    ]
    assert "\r" not in text


def test_tables_can_be_made_where_dask_cannot_be_imported(folder: Path) -> None:
    """With /proc hidden, dask raises psutil.NoSuchProcess on import."""
    (folder / "dask.py").write_text('raise RuntimeError("no such process")')
    code = """
import crawler2d as c2d
base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05), duration=0.1)
print(dict(c2d.sweep(base, {"terrain.height": [0.01, 0.02]}, repeats=1, progress=False).sizes))
"""
    path = os.pathsep.join([str(folder), *sys.path])
    made = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert made.stdout == "{'height': 2, 'repeat': 1}\n", made.stderr
