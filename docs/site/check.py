"""Checks of the built site: links lead somewhere, nothing is loaded from elsewhere, pictures have a text."""

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

LOADS = {"img": "src", "script": "src", "iframe": "src", "source": "src", "object": "data"}
"""Elements that load what an attribute names."""

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
        elif tag == "link" and not {"canonical", "search", "next", "prev", "index", "genindex", "author"} & set(values.get("rel", "").split()):
            self.loads.add(values.get("href", ""))
        elif tag in LOADS and LOADS[tag] in values:
            self.loads.add(values[LOADS[tag]])
        if tag == "img" and not values.get("alt"):
            self.without_text.append(values.get("src", ""))
        self.loads |= set(IN_STYLES.findall(values.get("style", "")))
        if "srcdoc" in values:
            self.loads |= Page(values["srcdoc"]).loads


def is_elsewhere(link: str) -> bool:
    """Tell whether a link leaves the site."""
    parts = urlsplit(link)
    return bool(parts.netloc) or parts.scheme not in {"", "data"}


def faults_in(site: Path) -> list[str]:
    """List the faults of all pages of a site."""
    return [f"{path.relative_to(site)}: {fault}" for path, fault in sorted(_faults(site))]


def _faults(site: Path) -> Iterator[tuple[Path, str]]:
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    if len(pages) < 2:
        yield site, "has no pages"
    for path, page in pages.items():
        for link in page.loads:
            if is_elsewhere(link):
                yield path, f"loads {link}"
        for link in page.links | page.loads:
            if not is_elsewhere(link) and not link.startswith("data:") and link != "#":
                parts = urlsplit(link)
                target = (path.parent / unquote(parts.path)).resolve() if parts.path else path
                if not target.is_file():
                    yield path, f"links to {link}, which is not there"
                elif parts.fragment and target in pages:
                    if unquote(parts.fragment) not in pages[target].anchors:
                        yield path, f"links to {link}, an anchor that is not there"
        for picture in page.without_text:
            yield path, f"shows {picture} without a text"
    for path in site.rglob("*.css"):
        for link in IN_STYLES.findall(path.read_text(encoding="utf-8")):
            yield path, f"loads {link}"
