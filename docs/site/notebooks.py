"""Notebooks to take along: the page of each links to its file."""

import shutil
from pathlib import Path


def offer(notebooks: Path, pages: Path) -> None:
    """Copy the notebooks of a folder beside their pages, each with a link below its title.

    Raises
    ------
    ValueError
        If a page has no title.
    """
    for notebook in sorted(notebooks.glob("*.ipynb")):
        page = pages / f"{notebook.stem}.html"
        begin, title, rest = page.read_text(encoding="utf-8").partition("</h1>")
        if not title:
            raise ValueError(f"{page}: has no title")
        link = f'\n<p><a href="{notebook.name}" download>Download this notebook</a></p>'
        page.write_text(f"{begin}{title}{link}{rest}", encoding="utf-8")
        shutil.copy2(notebook, pages)
