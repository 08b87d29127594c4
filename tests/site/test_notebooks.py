"""The page of a notebook leads to the notebook."""

from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOKS = sorted((ROOT / "studies").glob("*.ipynb"))


@pytest.fixture
def site(monkeypatch: pytest.MonkeyPatch) -> tuple[Any, Any]:
    """The extensions for notebooks and for faults, which are installed where the site is built."""
    monkeypatch.syspath_prepend(ROOT / "docs" / "site")
    return import_module("notebooks"), import_module("check")


def test_every_notebook_is_beside_its_page_which_links_to_it(
    site: tuple[Any, Any], tmp_path: Path
) -> None:
    notebooks, check = site
    for notebook in NOTEBOOKS:
        page = f"<h1>{notebook.stem}</h1><p>text</p><h1>another</h1>"
        (tmp_path / f"{notebook.stem}.html").write_text(page, encoding="utf-8")
    notebooks.offer(ROOT / "studies", tmp_path)
    assert len(NOTEBOOKS) > 5
    for notebook in NOTEBOOKS:
        text = (tmp_path / f"{notebook.stem}.html").read_text(encoding="utf-8")
        link = f'</h1>\n<p><a href="{notebook.name}" download>Download this notebook</a></p><p>text'
        assert text.count(link) == text.count("download") == 1
        assert (tmp_path / notebook.name).read_bytes() == notebook.read_bytes()
    assert check.faults_in(tmp_path) == []


def test_a_page_without_a_title_is_refused(site: tuple[Any, Any], tmp_path: Path) -> None:
    for notebook in NOTEBOOKS:
        (tmp_path / f"{notebook.stem}.html").write_text("<p>text</p>", encoding="utf-8")
    with pytest.raises(ValueError, match="has no title"):
        site[0].offer(ROOT / "studies", tmp_path)
