"""What a user does with the wheel alone; `make test-wheel` runs it where there is no compiler."""

import shutil
import sys
from importlib.metadata import files
from pathlib import Path

import crawler2d as c2d

ROBOTS = Path(__file__).parent / "robots"


def main() -> None:
    """Read a public model, and drive it over a step."""
    assert not any(shutil.which(name) for name in ("cargo", "rustc", "cc", "gcc"))
    assert Path(c2d.__file__).is_relative_to(sys.prefix), "not the wheel, but a working copy"
    assert "LICENSE" in {file.name for file in files("crawler2d") or ()}
    reading = c2d.read_robot(ROBOTS / "absolem.sdf")
    run = c2d.simulate(reading.robot, c2d.terrains.step(0.05, friction=reading.friction))
    print(f"{reading.in_words}\non a step of 50 mm: {run.outcome}")


if __name__ == "__main__":
    main()
