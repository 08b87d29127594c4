"""The README of a folder is its page on the site, and lists what the folder holds."""

import posixpath
import re
from collections.abc import Iterator
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.transforms.post_transforms import SphinxPostTransform

FOLDER = re.compile(r"(?<=\]\()[\w./-]+(?=\))")
PAGE = re.compile(r"\]\(([\w./-]+)\.(?:md|ipynb)\)")


def read_page(app: Sphinx, docname: str, source: list[str]) -> None:
    """Lead links to folders to their READMEs, and put the pages of a README in the contents."""
    page = Path(app.srcdir, docname)

    def readme(link: re.Match[str]) -> str:
        has_one = (page.parent / link[0] / "README.md").is_file()
        return posixpath.join(link[0], "README.md") if has_one else link[0]

    if Path(f"{page}.md").is_file():
        source[0] = FOLDER.sub(readme, source[0])
    if page.name == "README" and page.parent != Path(app.srcdir):
        pages = "\n".join(dict.fromkeys(PAGE.findall(source[0])))
        source[0] += f"\n```{{toctree}}\n:hidden:\n\n{pages}\n```\n"


class NameFigures(SphinxPostTransform):
    """Give the figures of notebooks the title of their section as text."""

    default_priority = 20  # after myst-nb has chosen the form of each output

    def run(self) -> None:
        """Name the figures of one page."""
        for image in self.document.findall(nodes.image):
            section = next(_sections_around(image), None)
            if "alt" not in image and section is not None:
                image["alt"] = f"Figure: {section.next_node(nodes.title).astext()}"


def _sections_around(node: nodes.Node) -> Iterator[nodes.section]:
    while node := node.parent:
        if isinstance(node, nodes.section):
            yield node


def setup(app: Sphinx) -> dict[str, bool]:
    """Follow the reading of pages."""
    app.connect("source-read", read_page)
    app.add_post_transform(NameFigures)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
