"""The wheel names all libraries in its core with their authors, in the locked version."""

import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_every_library_in_the_core_has_its_notice() -> None:
    """`make notices` writes them again."""
    command = ["cargo", "tree", "--offline", "--locked", "--package", "crawler2d-python"]
    command += ["--edges", "normal", "--prefix", "none", "--format", "{p}"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    needed = {tuple(line.split()[:2]) for line in done.stdout.splitlines() if line.strip()}
    libraries = {f"{name} {version[1:]}" for name, version in needed if "crawler2d" not in name}
    assert len(libraries) > 50
    notices = (ROOT / "THIRD-PARTY-NOTICES").read_text(encoding="utf-8")
    assert libraries <= set(re.findall(r"(?m)^  (\S+ \d\S*)$", notices))
