"""Odd environments give the same results, or an error that says what to do, one row each."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

Say = Callable[[str], None]

PROGRAM = Path(__file__).with_name("small_work.py")

SAME = ""
"""Expected of a row: what comes out is what comes out in usual surroundings, bit by bit."""


class Row(NamedTuple):
    """An odd environment, as shell commands, and the expected result."""

    shell: str = ""
    """What is done before Python begins; $FOLDER is where the program keeps its files."""
    flags: str = ""
    """Of Python."""
    before: str = ""
    """Python that goes before the program."""
    folder: bytes = b"files"
    """Where the program keeps its files, within a temporary folder."""
    expected: str = SAME
    """Else the beginning of an error."""
    needs: str = "true"
    """A command; if it fails, the row is skipped."""
    soon: bool = False
    """Whether the row is tried in every `make test`."""


def mounted(*commands: str) -> Row:
    """Mounts that only this process sees, with its files at /mnt."""
    lines = " && ".join(("mount --bind $FOLDER /mnt", *commands, 'exec "$@"'))
    return Row(f"exec unshare -m sh -ec '{lines}' sh \"$@\"", needs="unshare -m true")


def registers(call: str) -> str:
    """Python code that changes floating-point modes: MXCSR is at byte 28 of glibc's fenv_t."""
    return (
        "import ctypes, ctypes.util\n"
        "m = ctypes.CDLL(ctypes.util.find_library('m') or 'libm.so.6')\n"
        "env = (ctypes.c_uint32 * 8)()\n"
        f"m.fegetenv(env)\n{call}\n"
    )


X86 = "uname -m | grep -q x86_64"
NO_FILES = "mount -t tmpfs -o ro none"
EARLY, LATE = "1970-01-01 00:00:05", "2100-06-01 00:00:00"

ROWS = {
    "32 open files": Row("ulimit -n 32", soon=True),
    "a stack of 256 kB": Row("ulimit -s 256", soon=True),
    "4 GB of addresses": Row("export OPENBLAS_NUM_THREADS=1; ulimit -v 4000000"),
    "no core files": Row("ulimit -c 0"),
    "the locale C": Row("export LC_ALL=C", soon=True),
    "the locale C without UTF-8": Row("export LC_ALL=C PYTHONCOERCECLOCALE=0 PYTHONUTF8=0"),
    "a locale that nobody has": Row("export LC_ALL=xx_YY.ISO-8859-9 LANGUAGE=tr"),
    "no UTF-8 mode": Row("export PYTHONUTF8=0"),
    "Latin 1 for input and output": Row("export PYTHONIOENCODING=latin-1"),
    "a path that is no UTF-8": Row(folder=b"of \xff\xfe", soon=True),
    "a path that is no UTF-8, in C": Row("export LC_ALL=C", folder=b"of \xff\xfe"),
    "a path with spaces and signs": Row(folder=b"a 'b' \"c\" #d?e%20&f;g\\h*"),
    "a path with emoji": Row(folder="\U0001f69c \u00e4".encode()),
    "a path with a line break": Row(folder=b"a\nb"),
    "a path of 400 characters": Row(folder=b"/".join([b"x" * 150] * 2)),
    "a path of 900 characters": Row(
        folder=b"/".join([b"x" * 180] * 5), expected="StoreError: "
    ),  # SQLite takes 512
    "no HOME": Row("unset HOME"),
    "a HOME that is not there": Row("export HOME=/nowhere"),
    "a HOME that cannot be written": Row("export HOME=/proc XDG_CACHE_HOME= XDG_CONFIG_HOME="),
    "no environment": Row('exec env -i "$@"'),
    "TMPDIR that is not there": Row("export TMPDIR=/nowhere"),
    "nowhere to put temporary files": mounted(
        f"{NO_FILES} /var/tmp", f"{NO_FILES} /tmp", "cd /proc"
    ),
    "no shared memory": mounted(f"{NO_FILES} /dev/shm"),
    "no /proc": mounted("umount -l /proc"),
    "no /sys": mounted("umount -l /sys"),
    "a system that is read only": mounted("mount -o remount,bind,ro /"),
    "a working directory that is read only": Row("cd /proc"),
    "a working directory that is gone": Row("mkdir $FOLDER/w; cd $FOLDER/w; rmdir $FOLDER/w"),
    "stdin closed": Row("exec 0<&-"),
    "stdout closed": Row("exec 1>&-"),
    "stderr closed": Row("exec 2>&-"),
    "stdin, stdout and stderr closed": Row("exec 0<&- 1>&- 2>&-", soon=True),
    "stdout full": Row("exec 1>/dev/full"),
    "stderr full": Row("exec 2>/dev/full"),
    "without assertions": Row(flags="-O"),
    "without docstrings": Row(flags="-OO"),
    "isolated": Row(flags="-I"),
    "development mode, warnings are errors": Row(flags="-X dev -W error"),
    "no byte code": Row(flags="-B -X importtime", shell="exec 2>/dev/null"),
    "frozen modules off": Row(flags="-X frozen_modules=off"),
    "hash seed 0": Row("export PYTHONHASHSEED=0"),
    "hash seed 1": Row("export PYTHONHASHSEED=1"),
    "hash seed 4711": Row("export PYTHONHASHSEED=4711"),
    "the year 1970": Row(f'exec faketime "{EARLY}" "$@"', needs="faketime -v"),
    "the year 2100": Row(f'exec faketime "{LATE}" "$@"', needs="faketime -v"),
    "a clock that goes backwards": Row('exec faketime -f "+0 x-1" "$@"', needs="faketime -v"),
    "one thread of OpenMP": Row("export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1"),
    "64 threads of OpenMP": Row("export OMP_NUM_THREADS=64"),
    "one thread": Row("export CRAWLER2D_THREADS=1"),
    "a thousand threads": Row("export CRAWLER2D_THREADS=1000"),
    "no number of threads": Row(
        "export CRAWLER2D_THREADS=many",
        expected="LimitError: environment variable CRAWLER2D_THREADS must be",
    ),
    "one processor": Row('exec taskset -c 0 "$@"', needs="taskset -c 0 true"),
    "the lowest priority": Row('exec nice -n 19 "$@"'),
    "signals ignored": Row("trap '' INT TERM HUP PIPE QUIT CHLD"),
    "subnormal numbers are zero": Row(
        before=registers("env[7] |= 0x8040; m.fesetenv(env)"), needs=X86
    ),
    "rounding upwards": Row(
        before=registers("m.fesetround(0x800)"),
        expected="InternalError: this thread ",
        needs=X86,
        soon=True,
    ),
    "rounding towards zero": Row(
        before=registers("m.fesetround(0xC00)"), expected="InternalError: this thread ", needs=X86
    ),
}

SHORT = [name for name, row in ROWS.items() if row.soon]


def answer(row: Row, place: Path, *more: str) -> dict[str, Any]:
    """Run the program in such an environment; its error is an answer, too."""
    folder = os.path.join(os.fsencode(place), row.folder)
    os.makedirs(folder)
    within = b"/mnt" if "/mnt" in row.shell else folder
    read, write = os.pipe()
    program = [sys.executable, *row.flags.split(), str(PROGRAM)]
    if row.before:
        start = f"{row.before}import runpy, sys\nsys.argv[0] = {str(PROGRAM)!r}\n"
        start += "runpy.run_path(sys.argv[0], run_name='__main__')\n"
        program = [sys.executable, *row.flags.split(), "-c", start]
    command: list[Any] = ["sh", "-c", f'{row.shell}\nexec "$@"', "sh", *program]
    try:
        done = subprocess.run(
            [*command, within, str(write), *more],
            env={**os.environ, "FOLDER": os.fsdecode(folder)},
            pass_fds=(write,),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=120.0,
            check=False,
        )
    finally:
        os.close(write)
    with os.fdopen(read, "rb") as told:
        text = told.read()
    assert text, done.stderr.decode(errors="replace")[-2000:]
    assert done.returncode == 0, (done.returncode, text, done.stderr[-2000:])
    assert b"Traceback" not in done.stderr, done.stderr.decode(errors="replace")
    found: dict[str, Any] = json.loads(text)
    return found


def is_there(command: str) -> bool:
    return subprocess.run(["sh", "-c", command], capture_output=True, check=False).returncode == 0


def check(name: str, place: Path, usual: dict[str, Any], *more: str) -> None:
    row = ROWS[name]
    if not is_there(row.needs):
        pytest.skip(f"`{row.needs}` fails here")
    found = answer(row, place, *more)
    if row.expected:
        assert found.get("error", "no error").startswith(row.expected)
    else:
        assert found == usual


pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="a shell, limits and mounts")


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    found = answer(Row(), tmp_path_factory.mktemp("usual"))
    assert "error" not in found
    assert found["damage"] == []
    assert found["saved"]
    return found


@pytest.mark.parametrize("name", SHORT)
def test_odd_surroundings_change_no_result(
    name: str, tmp_path: Path, usual: dict[str, Any]
) -> None:
    check(name, tmp_path, usual)


@pytest.fixture(scope="module")
def usual_audit(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    found = answer(Row(), tmp_path_factory.mktemp("usual"), "audit")
    assert "error" not in found
    return found


@pytest.mark.soak
@pytest.mark.parametrize("name", ROWS)
def test_odd_surroundings_change_no_result_of_an_audit(
    name: str, tmp_path: Path, usual_audit: dict[str, Any]
) -> None:
    check(name, tmp_path, usual_audit, "audit")


def test_a_name_of_300_characters_is_an_error_of_one_line(tmp_path: Path) -> None:
    """No file system accepts it."""
    import crawler2d as c2d  # noqa: PLC0415

    scenario = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat(), duration=0.1)
    path = tmp_path / ("x" * 300)
    with pytest.raises(c2d.StoreError, match="name too long"):
        c2d.sweep(scenario, {}, store=path, progress=False)
    with pytest.raises(OSError, match="name too long"):
        c2d.simulate(scenario).save(path)


COMMANDS = {
    "info": "info",
    "demo": "demo --out $FOLDER/demo.html",
    "run": "run $FOLDER/scenario.json",
    "view": "view $FOLDER/scenario.json --out $FOLDER/page.html",
    "schema": "schema",
    "audit": "audit $FOLDER/rover.sdf --lint",
    "help": "--help",
}

ENDS = {
    "closed": (">&-", {0, 1, 2}),
    "closed for errors, too": (">&- 2>&-", {0, 1, 2}),
    "full": (">/dev/full", {0, 1, 2}),
    "read for one line": ("| head -n 1 >/dev/null", {0, 1, 141}),
    "not read": ("| true", {0, 1, 141}),
    "without an input": ("<&-", {0, 1}),
}


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the input of commands."""
    import crawler2d as c2d  # noqa: PLC0415

    folder = tmp_path_factory.mktemp("commands")
    robot = c2d.robots.engineer(flippers=None)
    scenario = c2d.Scenario(robot, c2d.terrains.step(0.05), duration=3.0)
    (folder / "scenario.json").write_text(scenario.to_json())
    shutil.copy(c2d.samples.path(), folder)
    return folder


def check_command(command: str, end: str, files: Path, say: Say = print) -> None:
    redirection, statuses = ENDS[end]
    called = f"set -o pipefail; $PYTHON -m crawler2d {COMMANDS[command]} {redirection}"
    done = subprocess.run(
        ["bash", "-c", called],
        env={**os.environ, "FOLDER": str(files), "PYTHON": sys.executable},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=120.0,
        check=False,
    )
    say(f"{command}, {end}: {done.returncode} {done.stderr.strip()}")
    assert done.returncode in statuses
    # If help cannot be printed to the output, argparse prints it to the error stream.
    assert "Traceback" not in done.stderr
    assert command == "help" or len(done.stderr.splitlines()) <= 1, done.stderr


@pytest.mark.parametrize(("command", "end"), [("info", "closed"), ("help", "full")])
def test_a_command_whose_output_goes_nowhere_ends_in_one_line(
    command: str, end: str, files: Path
) -> None:
    check_command(command, end, files)


@pytest.mark.soak
@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_whose_output_goes_nowhere_ends_in_one_line(
    command: str, end: str, files: Path, say: Say
) -> None:
    check_command(command, end, files, say)
