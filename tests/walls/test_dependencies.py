"""docs/dependencies.md gives a reason for each direct dependency, and for no other."""

import re
import subprocess
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/dependencies.md").read_text(encoding="utf-8")


def listed(*titles: str) -> set[str]:
    """The first cells of the tables under some titles."""
    sections = [PAGE.partition(f"## {title}\n")[2].partition("\n## ")[0] for title in titles]
    return {name for section in sections for name in re.findall(r"(?m)^\| `([^`]+)` \|", section)}


def read(path: Path) -> dict[str, Any]:
    return tomllib.loads(path.read_text(encoding="utf-8"))


def crates() -> Iterator[str]:
    members = read(ROOT / "Cargo.toml")["workspace"]["members"]
    for member in members:
        manifest = read(ROOT / member / "Cargo.toml")
        for kind in ("dependencies", "dev-dependencies", "build-dependencies"):
            yield from manifest.get(kind, {})


def packages() -> Iterator[str]:
    manifest = read(ROOT / "pyproject.toml")
    lists = [manifest["project"]["dependencies"], manifest["build-system"]["requires"]]
    lists += manifest["project"]["optional-dependencies"].values()
    lists += manifest["dependency-groups"].values()
    for requirement in [each for some in lists for each in some]:
        yield re.split(r"[^\w.-]", requirement)[0]


def test_every_crate_has_its_line() -> None:
    found = {name for name in crates() if not name.startswith("crawler2d")}
    assert len(found) > 10
    assert found == listed("Crates")


def test_every_package_has_its_line() -> None:
    found = {name for name in packages() if name != "crawler2d"}
    assert len(found) > 40
    assert found == listed("Packages that a user installs", "Tools")


KINDS = {".css", ".html", ".js", ".mplstyle", ".py", ".pyi", ".sdf", ".typed", ".urdf", ".xml"}
LARGEST = 100_000
"""[bytes] Of a file that is written by hand."""


def test_the_package_holds_nothing_but_code_pages_and_samples() -> None:
    """The wheel takes every file in the folder that git does not ignore."""
    command = ["git", "ls-files", "--cached", "--others", "--exclude-standard", "python/crawler2d"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True)
    files = [ROOT / line for line in done.stdout.splitlines()]
    files = [file for file in files if file.is_file()]  # not one that was just removed
    assert len(files) > 100
    assert [str(file) for file in files if file.suffix not in KINDS] == []
    assert [str(file) for file in files if file.stat().st_size > LARGEST] == []
