"""Violations that the walls detect: small trees of files, each with one fault or none."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from tests.walls.houses import files_of, imports_of
from tests.walls.rooms import House, Import, circles, violations

GROUND, UPPER = "ground/", "upper/"


def package(folder: Path, texts: Mapping[str, str]) -> House:
    """Write a package of two rooms; missing files are empty."""
    files = {"ground/low.py": "", "upper/high.py": "", **texts}
    return written(folder / "house", files, "nowhere")


def crate(folder: Path, texts: Mapping[str, str]) -> House:
    """Write a crate of two rooms below its `lib.rs`; missing files are empty."""
    files = {"ground/mod.rs": "", "ground/low.rs": "", "upper/mod.rs": "", "upper/high.rs": ""}
    lib = {"lib.rs": "mod ground;\nmod upper;\npub use upper::High;\n"}
    house = written(folder / "src", {**files, **lib, **texts}, "inside a room")
    return House(house.folder, [*house.rooms, "lib.rs"], house.circles)


def written(folder: Path, texts: Mapping[str, str], circles: str) -> House:
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return House(folder, [GROUND, UPPER], circles)


def faults(house: House) -> list[str]:
    """The violations of a house, without the path of its folder."""
    found = violations(house, files_of(house), imports_of(house))
    return [fault.removeprefix(f"{house.folder.as_posix()}/") for fault in found]


def upwards(line: int, ending: str = "py") -> list[str]:
    """The fault of an import of the upper room in the ground room."""
    return [
        f"ground/low.{ending}:{line}: imports upper/high.{ending}, but ground/ must not know"
        " upper/, which docs/rooms.toml lists later"
    ]


DOWN = {"upper/high.py": "from house.ground.low import x\nimport house.ground.low\nimport sys\n"}


def test_imports_downwards_and_from_elsewhere_are_fine(tmp_path: Path) -> None:
    house = package(tmp_path, DOWN)
    assert len(imports_of(house)) == 2
    assert faults(house) == []


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("import house.upper.high\n", 1),
        ("\nfrom house.upper import high\n", 2),
        ("from house.upper.high import (\n    x,\n    y,\n)\n", 1),
        ("from ..upper.high import x\n", 1),
        ("from ..upper import high\n", 1),
        ("def f():\n    from house.upper.high import x\n    return x\n", 2),
        ("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import house.upper.high\n", 3),
    ],
    ids=["module", "from room", "names", "relative", "relative module", "function", "type"],
)
def test_an_import_upwards_is_a_fault(tmp_path: Path, text: str, line: int) -> None:
    assert faults(package(tmp_path, {"ground/low.py": text})) == upwards(line)


def test_a_room_is_imported_by_its_own_file(tmp_path: Path) -> None:
    texts = {"upper/__init__.py": "", "ground/low.py": "from house.upper import x\n"}
    (fault,) = faults(package(tmp_path, texts))
    assert fault.startswith("ground/low.py:1: imports upper/__init__.py, but")


def test_a_circle_inside_a_room_of_the_package_is_a_fault(tmp_path: Path) -> None:
    texts = {
        "ground/low.py": "from house.ground.other import x\n",
        "ground/other.py": "\nfrom house.ground.third import x\n",
        "ground/third.py": "def f():\n    from house.ground.low import x\n",
    }
    assert faults(package(tmp_path, texts)) == [
        "ground/low.py:1: imports ground/other.py, which leads back to it: ground/low.py ->"
        " ground/other.py -> ground/third.py -> ground/low.py; files may import each other in a"
        " circle nowhere"
    ]


def test_every_import_cycle_is_named_once() -> None:
    edges = {"a": {"b"}, "b": {"a", "c"}, "c": {"d"}, "d": {"c"}, "e": {"a", "e"}}
    assert list(circles(edges)) == [["a", "b"], ["c", "d"], ["e"]]


def test_a_file_without_a_room_and_a_room_without_files_are_faults(tmp_path: Path) -> None:
    house = package(tmp_path, {"attic/old.py": ""})
    house = House(house.folder, [*house.rooms, "cellar/"], house.circles)
    assert faults(house) == [
        "attic/old.py: lies in no room of docs/rooms.toml",
        "cellar/: docs/rooms.toml lists this room, but no file lies there",
    ]


HIGH = "pub struct High;\n"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("use crate::upper::high::High;\n", 1),
        ("\nuse crate::upper::high;\n", 2),
        ("use std::fmt;\nuse crate::{\n    ground,\n    upper::{high::{self, High}},\n};\n", 4),
        ("use super::super::upper::high::High as Tall;\n", 1),
        ("fn f() {\n    crate::upper::high::call();\n}\n", 2),
        ("type T = super::super::upper::high::High;\n", 1),
        ("pub(crate) use crate::upper::high::*;\n", 1),
        ("#[cfg(test)]\nmod tests {}\nuse crate::upper::high::High;\n", 3),
    ],
    ids=["item", "module", "braces", "super", "call", "type", "glob", "after tests"],
)
def test_a_use_upwards_is_a_fault(tmp_path: Path, text: str, line: int) -> None:
    house = crate(tmp_path, {"ground/low.rs": text, "upper/high.rs": HIGH})
    assert faults(house) == upwards(line, "rs")


@pytest.mark.parametrize(
    "text",
    [
        "// crate::upper::high\n/* use crate::upper::high;\n*/\n",
        'const TEXT: &str = "{ crate::upper::high";\n',
        "#[cfg(test)]\nmod tests {\n    use crate::upper::high::High;\n    fn f() {}\n}\n",
        "#[cfg(test)]\nuse crate::upper::high::{self, High};\n",
        "#[cfg(test)]\npub(crate) fn f(x: [u8; 3]) {\n    crate::upper::high::call();\n}\n",
        "use std::upper::high;\nuse rapier::high::High;\n",
    ],
    ids=["comment", "text", "tests", "test use", "test function", "elsewhere"],
)
def test_other_paths_of_the_core_are_no_imports(tmp_path: Path, text: str) -> None:
    house = crate(tmp_path, {"ground/low.rs": text, "upper/high.rs": HIGH})
    assert [each for each in imports_of(house) if each.file == "ground/low.rs"] == []


def test_files_of_unit_tests_may_use_everything(tmp_path: Path) -> None:
    use = "use crate::upper::high::High;\n"
    tests = {f"ground/low/{name}.rs": use for name in ("tests", "tests/more")}
    low = "#[cfg(test)]\nmod draw;\n#[cfg(test)]\nmod tests;\n"
    drawn = {"ground/low/draw.rs": use, "ground/low.rs": low}
    assert faults(crate(tmp_path, {**tests, **drawn, "upper/high.rs": HIGH})) == []


def test_a_path_of_a_submodule_is_an_import(tmp_path: Path) -> None:
    house = crate(tmp_path, {"upper/mod.rs": "mod high;\nuse high::High;\n"})
    assert Import("upper/mod.rs", 2, "upper/high.rs") in imports_of(house)


def test_a_name_that_a_room_hands_on_is_imported_from_where_it_is_defined(tmp_path: Path) -> None:
    face = "mod high;\nmod other;\npub use high::High;\n"
    texts = {"upper/mod.rs": face, "upper/other.rs": "use super::High;\n"}
    house = crate(tmp_path, texts)
    assert imports_of(house) == [
        Import("lib.rs", 3, "upper/high.rs"),
        Import("upper/other.rs", 1, "upper/high.rs"),
    ]


def test_a_name_that_is_handed_on_twice_is_imported_from_where_it_is_defined(
    tmp_path: Path,
) -> None:
    texts = {
        "ground/mod.rs": "mod low;\npub use low::Lowest as Floor;\n",
        "ground/low/mod.rs": "mod lowest;\npub use lowest::Lowest;\n",
        "ground/low/lowest.rs": "pub struct Lowest;\n",
        "upper/high.rs": "use crate::ground::Floor;\nuse crate::ground::low::Lowest;\n",
    }
    house = crate(tmp_path, texts)
    (house.folder / "ground/low.rs").unlink()
    assert [each for each in imports_of(house) if each.file == "upper/high.rs"] == [
        Import("upper/high.rs", 1, "ground/low/lowest.rs"),
        Import("upper/high.rs", 2, "ground/low/lowest.rs"),
    ]


def test_a_circle_through_names_that_are_handed_on_is_a_fault(tmp_path: Path) -> None:
    texts = {
        "upper/mod.rs": "mod checked;\nmod high;\npub use checked::Checked;\n",
        "upper/checked.rs": "use super::high::LIMIT;\npub struct Checked;\n",
        "upper/high.rs": "mod pace;\npub use pace::LIMIT;\nuse super::Checked;\n",
        "upper/high/pace.rs": "pub const LIMIT: f64 = 1.0;\n",
    }
    house = crate(tmp_path, texts)
    (fault,) = faults(House(house.folder, house.rooms, "nowhere"))
    assert fault.startswith("upper/checked.rs:1: imports upper/high.rs, which leads back to it")


def test_a_name_from_above_cannot_be_handed_on(tmp_path: Path) -> None:
    house = crate(tmp_path, {"ground/low.rs": "pub use crate::upper::high::High;\n"})
    assert faults(house) == upwards(1, "rs")


def test_definitions_in_lib_are_above_every_room(tmp_path: Path) -> None:
    (fault,) = faults(crate(tmp_path, {"upper/high.rs": "use crate::BUILD_ID;\n"}))
    assert fault.startswith("upper/high.rs:1: imports lib.rs, but upper/ must not know lib.rs")


def test_a_circle_inside_a_room_of_the_core_is_fine_and_across_rooms_it_is_not(
    tmp_path: Path,
) -> None:
    inside = {"ground/low.rs": "use super::x;\n", "ground/mod.rs": "mod low;\npub use low::x;\n"}
    assert faults(crate(tmp_path / "inside", inside)) == []
    across = {
        "ground/low.rs": "use crate::upper::high::x;\n",
        "upper/high.rs": "use crate::ground::low::y;\n",
    }
    up, circle = faults(crate(tmp_path / "across", across))
    assert [up] == upwards(1, "rs")
    assert circle.startswith("ground/low.rs:1: imports upper/high.rs, which leads back to it")
