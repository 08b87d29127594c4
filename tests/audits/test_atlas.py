"""The atlas: files taken as models, and a page of files read and not read."""

import re
import shutil
from pathlib import Path
from typing import Any

import pytest

from crawler2d.__main__ import main
from crawler2d.commands.atlas import Entry, licence_of, main_files
from tests.reading.carts import FILES, WHEELS, urdf


@pytest.fixture
def forest(tmp_path: Path) -> Path:
    """Two repositories: one with a cart, one with a macro, its caller and a broken file."""
    cart, other = tmp_path / "trees" / "cart", tmp_path / "trees" / "other" / "urdf"
    cart.mkdir(parents=True)
    other.mkdir(parents=True)
    shutil.copy(FILES / "cart.urdf", cart)
    (cart / "LICENSE").write_text("\nMIT License\n\nCopyright", encoding="utf-8")
    (cart / "notes.xml").write_text("<notes/>", encoding="utf-8")
    (other.parent / "package.xml").write_text("<license>BSD</license>", encoding="utf-8")
    macro = "<robot xmlns:xacro='x'><xacro:macro name='m'><link name='a'/></xacro:macro></robot>"
    (other / "part.xacro").write_text(macro, encoding="utf-8")
    caller = "<robot xmlns:xacro='x'><xacro:include filename='part.xacro'/><link name='b'/></robot>"
    (other / "whole.xacro").write_text(caller, encoding="utf-8")
    (other / "<b>.urdf").write_text(urdf(WHEELS).replace("</robot>", ""), encoding="utf-8")
    return tmp_path / "trees"


def test_files_that_others_include_and_files_of_macros_are_no_models(forest: Path) -> None:
    names = [path.as_posix() for path in main_files(forest)]
    assert names == ["cart/cart.urdf", "other/urdf/<b>.urdf", "other/urdf/whole.xacro"]


def test_a_file_that_is_named_as_a_model_but_holds_none_is_listed_as_not_read(forest: Path) -> None:
    (forest / "cart" / "empty.sdf").touch()
    (forest / "cart" / "wide.urdf").write_text(urdf(WHEELS), encoding="utf-16")
    (forest / "cart" / "large.xml").write_text(urdf(WHEELS) + " " * 4_000_000, encoding="utf-8")
    names = [path.name for path in main_files(forest)]
    assert names[-3:] == ["empty.sdf", "large.xml", "wide.urdf"]


def test_a_page_in_a_file_is_refused(forest: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = forest / "cart" / "LICENSE" / "atlas.html"
    assert main(["atlas", str(forest), "--html", str(page)]) == 2
    assert "--html must be a file in a folder that exists" in capsys.readouterr().err


def test_what_a_scene_of_mjcf_includes_is_a_model(tmp_path: Path) -> None:
    """It is read on its own; the scene is refused, as the reader does not follow MJCF includes."""
    folder = tmp_path / "robots"
    folder.mkdir()
    shutil.copy(FILES / "cart.xml", folder)
    scene = "<mujoco><include file='cart.xml'/><worldbody><geom size='1'/></worldbody></mujoco>"
    (folder / "scene.xml").write_text(scene, encoding="utf-8")
    names = [path.as_posix() for path in main_files(tmp_path)]
    assert names == ["robots/cart.xml", "robots/scene.xml"]


def test_files_beside_all_repositories_include_each_other(tmp_path: Path) -> None:
    (tmp_path / "part.xacro").write_text("<robot><link name='a'/></robot>", encoding="utf-8")
    caller = "<robot xmlns:xacro='x'><xacro:include filename='part.xacro'/><link name='b'/></robot>"
    (tmp_path / "whole.xacro").write_text(caller, encoding="utf-8")
    assert [path.name for path in main_files(tmp_path)] == ["whole.xacro"]


@pytest.mark.usefixtures("one_obstacle")
def test_the_page_has_every_model_with_its_licence_and_why_it_was_not_read(
    forest: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "out" / "atlas.html"
    assert main(["atlas", str(forest), "--html", str(page), "--samples", "1"]) == 0
    assert "1 of 3 model files were read" in capsys.readouterr().out
    text = page.read_text(encoding="utf-8")
    for part in ("cart/cart.urdf", "LICENSE: MIT License", "package.xml: BSD", "well-formed XML"):
        assert part in text
    assert "<b>" not in text.replace("&lt;b&gt;", "")
    assert not re.search(r"(src|href)=\"(?!data:)", text)
    assert text.count("<svg") == 1


def test_an_invalid_folder_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["atlas", str(tmp_path / "absent")]) == 2
    assert "must be a folder" in capsys.readouterr().err


def test_a_repository_without_a_licence_says_so(tmp_path: Path) -> None:
    assert licence_of(tmp_path) == "licence: none found"


def test_a_folder_of_too_many_model_files_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("crawler2d.commands.atlas._MOST", 3)
    for place in ("a/1", "a/2", "b/3"):
        (tmp_path / place).parent.mkdir(exist_ok=True)
        (tmp_path / place).with_suffix(".urdf").write_text(
            '<robot name="r"><link name="l"/></robot>'
        )
    assert len(list(main_files(tmp_path))) == 3
    (tmp_path / "c").mkdir()
    (tmp_path / "c" / "4.urdf").write_text('<robot name="r"><link name="l"/></robot>')
    assert main(["atlas", str(tmp_path)]) == 2
    assert "FOLDER must have at most 3 model files" in capsys.readouterr().err


def test_a_licence_that_cannot_be_read_does_not_end_the_atlas(
    tmp_path: Path, monkeypatch: Any
) -> None:
    def denied(path: Path, **_: Any) -> Any:
        raise PermissionError(13, "Permission denied", str(path))

    (tmp_path / "a" / "package.xml").mkdir(parents=True)
    (tmp_path / "b").mkdir()
    (tmp_path / "b" / "package.xml").write_text("<license>BSD</license>", encoding="utf-8")
    assert licence_of(tmp_path) == "licence: package.xml: BSD"
    (tmp_path / "LICENSE").touch()
    monkeypatch.setattr(Path, "open", denied)
    assert licence_of(tmp_path) == "licence: LICENSE: "


def test_after_ctrl_c_the_page_has_what_was_done(
    forest: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    page = tmp_path / "atlas.html"
    done: list[Path] = []

    def entry(_: Path, path: Path, **__: object) -> Entry:
        if len(done) == 1:
            raise KeyboardInterrupt
        done.append(path)
        return Entry(path=path, refusal="not read here")

    monkeypatch.setattr("crawler2d.commands.atlas._entry", entry)
    assert main(["atlas", str(forest), "--html", str(page)]) == 130
    err = capsys.readouterr().err
    assert err == f"crawler2d atlas: interrupted: {page} has the first 1 of the files\n"
    assert "not read here" in page.read_text(encoding="utf-8")
    page.unlink()
    assert main(["atlas", str(forest), "--html", str(page)]) == 130
    assert capsys.readouterr().err == "crawler2d atlas: interrupted: no page was written\n"


@pytest.mark.parametrize("option", ["samples", "threads"])
def test_a_bad_number_is_refused_once_not_for_every_robot(
    forest: Path, tmp_path: Path, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "atlas.html"
    assert main(["atlas", str(forest), "--html", str(page), f"--{option}", "0"]) == 2
    said = f"crawler2d atlas: --{option} must be a whole number from 1"
    assert capsys.readouterr().err.startswith(said)
    assert not page.exists()


def test_a_page_that_cannot_be_written_is_refused_before_the_audits(
    forest: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr("crawler2d.commands.atlas.read_robot", lambda _: 1 / 0)
    assert main(["atlas", str(forest), "--html", str(tmp_path)]) == 2
    assert "--html must be a file in a folder" in capsys.readouterr().err


def test_a_file_that_may_not_be_read_is_one_of_the_refused(
    forest: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    opened = Path.open

    def refuse(path: Path, *how: Any, **options: Any) -> Any:
        if path.name == "cart.urdf":
            raise PermissionError(13, "Permission denied", str(path))
        return opened(path, *how, **options)

    monkeypatch.setattr(Path, "open", refuse)
    assert [path.name for path in main_files(forest)][-1] == "cart.urdf"
