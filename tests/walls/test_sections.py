"""The equations are in docs/physics.md: every file that uses them names its section."""

import re

import pytest

from tests.walls.houses import files_of
from tests.walls.rooms import ROOT, House

TEXT = (ROOT / "docs/physics.md").read_text(encoding="utf-8")
SECTIONS = re.findall(r"^#+ (.+)$", TEXT, re.MULTILINE)
ROOMS = ("contact/", "solver/", "dynamics/")
FILES = [file for file in files_of(House.read("core")) if file.startswith(ROOMS)]


@pytest.mark.parametrize("file", FILES)
def test_a_file_of_the_physics_names_its_section(file: str) -> None:
    text = (ROOT / "rust_core/src" / file).read_text(encoding="utf-8")
    comment = "\n".join(line for line in text.splitlines() if line.startswith("//!"))
    named = re.findall(r'docs/physics\.md, "([^"]+)"', comment)
    assert named, 'its first comment must name its section, as in: docs/physics.md, "Levers"'
    assert [name for name in named if name not in SECTIONS] == []


def test_every_section_of_the_physics_has_files() -> None:
    texts = [(ROOT / "rust_core/src" / file).read_text(encoding="utf-8") for file in FILES]
    assert len(FILES) > 30
    assert sum(f'"{section}"' in text for text in texts for section in SECTIONS) >= len(FILES)


def test_every_section_names_its_files() -> None:
    parts = re.split(r"^## (.+)$", TEXT, flags=re.MULTILINE)
    named = {}
    for section, text in zip(parts[1::2], parts[2::2], strict=True):
        code = re.search(r"^\*Code\*: ([^.]*(?:\.rs[^.]*)+)\.$", text, re.MULTILINE)
        named[section] = re.findall(r"`([^`]+)`", code[1]) if code else []
    texts = {file: (ROOT / "rust_core/src" / file).read_text(encoding="utf-8") for file in FILES}
    expected = {
        section: [file for file, text in texts.items() if f'docs/physics.md, "{section}"' in text]
        for section in named
    }
    assert named == expected
