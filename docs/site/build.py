"""Builds the documentation site into out/site; `make docs` runs it.

Sphinx reads the pages in out/site-pages, in the folders in which they are in the repository: what
it generates stays out of these, and every link means the same on the site and on GitHub.
"""

import shutil
import sys
from pathlib import Path

from check import faults_in
from notebooks import offer
from sphinx.cmd.build import build_main

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
OUT = ROOT / "out"
SITE = OUT / "site"
PAGES = OUT / "site-pages"

FOLDERS = {"docs": "*", "studies": "*", "python/crawler2d": "*.py"}
FILES = ("README.md", "CONTRIBUTING.md", "CHANGELOG.md", "LICENSE")
"""The pages, and what they link to."""


def lay_out() -> None:
    """Copy every file that is read."""
    for folder, pattern in FOLDERS.items():
        for path in (ROOT / folder).rglob(pattern):
            if path.is_file() and "__pycache__" not in path.parts:
                copy = PAGES / path.relative_to(ROOT)
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(path, copy)
    for name in FILES:
        shutil.copy2(ROOT / name, PAGES / name)


def main(arguments: list[str]) -> int:
    """Build and check, with further arguments for Sphinx; return the exit status."""
    for folder in (PAGES, SITE):
        shutil.rmtree(folder, ignore_errors=True)
    lay_out()
    options = [
        "-q",
        "-j",
        "auto",
        "--nitpicky",
        "--fail-on-warning",
        "--keep-going",
        "-c",
        str(HERE),
    ]
    trees = ["-d", str(PAGES / ".trees")]
    if status := build_main([*options, *arguments, *trees, str(PAGES), str(SITE)]):
        return status
    offer(ROOT / "studies", SITE / "studies")
    shutil.copyfile(HERE / "start.html", SITE / "index.html")
    # Sphinx takes no notice of what `<picture>` shows.
    for film in (ROOT / "docs").glob("*.gif"):
        shutil.copyfile(film, SITE / "docs" / film.name)
    faults = faults_in(SITE)
    pages = len(list(SITE.rglob("*.html")))
    print("\n".join(faults) or f"{pages} pages, no broken link: {SITE / 'index.html'}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
