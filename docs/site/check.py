"""Checks of the built site: links lead somewhere, all is loaded from here, pictures have a text."""

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADS = {"img": "src", "link": "href", "script": "src", "iframe": "src", "object": "data"}
"""Elements that load what an attribute names."""

NAME = (".png", ".svg")
"""How a text ends that is but the name of the file; one that is empty says that titles suffice."""

IN_STYLES = re.compile(r"""(?:url\(|@import)\s*['"]?((?:https?:)?//[^'")\s]+)""")


class Page(HTMLParser):
    """What one page loads, where its links lead, and which anchors it has."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.loads: set[str] = set()
        self.without_text: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what an element refers to."""
        values = {name: value or "" for name, value in attrs}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        if tag == "a" and "href" in values:
            self.links.add(values["href"])
        if LOADS.get(tag) in values:
            self.loads.add(values[LOADS[tag]])
        if tag == "img" and values.get("alt", ".png").endswith(NAME):
            self.without_text.append(values.get("src", ""))
        self.loads |= set(IN_STYLES.findall(values.get("style", "")))
        if "srcdoc" in values:
            self.loads |= Page(values["srcdoc"]).loads


def faults_in(site: Path) -> list[str]:
    """List the faults of all pages of a site."""
    pages = {
        path: Page(path.read_text(encoding="utf-8"))
        for path in sorted(site.rglob("*.html"))
        if "_static" not in path.parts
    }
    faults = [f"{path}: {fault}" for path in pages for fault in _faults_of(path, pages)]
    for path in site.rglob("*.css"):
        found = IN_STYLES.findall(path.read_text(encoding="utf-8"))
        faults += [f"{path}: loads {link}" for link in found]
    return faults if pages else [f"{site}: has no pages"]


def _faults_of(path: Path, pages: dict[Path, Page]) -> Iterator[str]:
    page = pages[path]
    for link in sorted(page.links | page.loads):
        parts = urlsplit(link)
        if parts.netloc or parts.scheme:
            if link in page.loads and parts.scheme != "data":
                yield f"loads {link}"
            continue
        target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
        anchors = pages[target].anchors if target in pages else set()
        if not target.is_file():
            yield f"links to {link}, which is not there"
        elif target in pages and parts.fragment and unquote(parts.fragment) not in anchors:
            yield f"links to {link}, an anchor that is not there"
    for picture in page.without_text:
        yield f"shows {picture} without a text"
