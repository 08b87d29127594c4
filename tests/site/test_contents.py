"""The reference lists all public names, and every page can be reached from the start page."""

import ast
import re
from pathlib import Path
from pkgutil import resolve_name
from types import ModuleType

import pytest

import crawler2d as c2d

ROOT = Path(__file__).parents[2]
REFERENCE = ROOT / "docs/reference"
NAMED = re.findall(
    r"^   ([\w.]+)$",
    "".join(page.read_text(encoding="utf-8") for page in REFERENCE.glob("[!i]*.rst")),  # no index
    re.MULTILINE,
)
PAGES = [*ROOT.glob("docs/**/*.md"), *ROOT.glob("studies/*.md"), *ROOT.glob("studies/*.ipynb")]
GALLERY = sorted(ROOT.glob("docs/gallery/*.py"))
KINDS = (".md", ".rst", ".ipynb")
RELATIVE = re.compile(r"\]\((?!https?:)([^)#\s]+)(?:#[^)]*)?\)")


def public_names() -> set[str]:
    """Return the names that users write after `c2d.`."""
    names = set()
    for name in c2d.__all__:
        value = getattr(c2d, name)
        is_module = isinstance(value, ModuleType)
        names |= {f"{name}.{each}" for each in value.__all__} if is_module else {name}
    return names


def listed_in(page: Path) -> set[Path]:
    """Return the pages that a page adds to the contents of the site."""
    text = page.read_text(encoding="utf-8")
    if page.name == "README.md":  # its links, which docs/site/extensions/contents.py reads
        return {(page.parent / link).resolve() for link in RELATIVE.findall(text)}
    entries = re.findall(r"^(?:\w[\w ]* <([\w./-]+)>|   ([\w./-]+))$", text, re.MULTILINE)
    paths = [page.parent / (titled or bare) for titled, bare in entries]
    return {path.with_name(f"{path.name}{kind}").resolve() for path in paths for kind in KINDS}


def test_every_public_name_is_in_the_reference_once() -> None:
    assert len(NAMED) > 100
    assert public_names() - set(NAMED) == set()
    assert sorted(NAMED) == sorted(set(NAMED))


@pytest.mark.parametrize("name", NAMED)
def test_every_name_of_the_reference_is_there(name: str) -> None:
    assert resolve_name(f"crawler2d.{name}") is not None


def test_every_page_is_in_the_contents_of_the_site() -> None:
    found, new = set[Path](), {ROOT / "docs/index.md"}
    while new:
        found |= new
        pages = [page for page in new if page.suffix in KINDS and page.parent != ROOT]
        listed = {page for each in pages for page in listed_in(each)}
        new = {page for page in listed - found if page.is_file()}
    assert len(PAGES) > 50
    assert [str(page.relative_to(ROOT)) for page in PAGES if page not in found] == []


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_link_to_a_file_leads_somewhere(page: Path) -> None:
    links = RELATIVE.findall(page.read_text(encoding="utf-8"))
    assert [link for link in links if not (page.parent / link).exists()] == []


def test_the_gallery_has_short_programs_with_a_title() -> None:
    assert len(GALLERY) >= 20
    for path in GALLERY:
        text = path.read_text(encoding="utf-8")
        title, line, *_ = (ast.get_docstring(ast.parse(text)) or "").splitlines()
        code = [each for each in text.rpartition('"""')[2].splitlines() if each.strip()]
        assert (path.name, len(title)) == (path.name, len(line)), "a line of = under the title"
        assert (path.name, 5 <= len(code) <= 40) == (path.name, True)
