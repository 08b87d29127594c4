"""The checkers of the formats accept the files, if they are installed."""

import shutil
import subprocess
from pathlib import Path

import pytest

import crawler2d as c2d
from tests.shared import with_flippers
from tests.writing.drawn import drawn

GEARS = c2d.LineOfWheels(3, wheel=c2d.GearWheel())
WHEELED = {
    "line": c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4)),
    "line and flippers": with_flippers(c2d.LineOfWheels(3)),
    "gears": with_flippers(GEARS),
    "small gears": c2d.robots.engineer(
        flippers=None, track=c2d.CircumferentialWheels(24, wheel=c2d.GearWheel())
    ),
    "absolem": c2d.robots.absolem(track="public"),
    "marv": c2d.robots.marv(track="public"),
    **{f"drawn {number}": drawn(number, wheels_only=True) for number in range(4)},
}
BELTED = {
    "belt": c2d.robots.engineer(flippers=None),
    "belt and flippers": c2d.robots.absolem(),
    "closed": c2d.robots.engineer(
        flippers=None, track=c2d.ClosedTrack(c2d.CircumferentialWheels(18))
    ),
    **{f"any {number}": drawn(number) for number in range(4)},
}


def said(*command: str) -> str:
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@pytest.mark.skipif(shutil.which("check_urdf") is None, reason="needs check_urdf")
@pytest.mark.parametrize("robot", WHEELED.values(), ids=WHEELED)
def test_check_urdf_accepts_written_files(robot: c2d.Robot, tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    robot.to_urdf(path)
    answer = said("check_urdf", str(path))
    assert "Successfully Parsed XML" in answer
    assert "arning" not in answer


@pytest.mark.skipif(shutil.which("ign") is None, reason="needs ign with libsdformat")
@pytest.mark.parametrize("robot", [*WHEELED.values(), *BELTED.values()], ids=[*WHEELED, *BELTED])
def test_libsdformat_accepts_written_files(robot: c2d.Robot, tmp_path: Path) -> None:
    path = tmp_path / "robot.sdf"
    robot.to_sdf(path)
    answer = said("ign", "sdf", "--check", str(path))
    assert "Valid." in answer
    assert "Warning" not in answer
