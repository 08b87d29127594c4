"""Command line: `python -m explorer` writes out/explorer.html."""

import gzip
from pathlib import Path

from explorer.page import explorer_page
from explorer.wasm import compile_core

OUT = Path("out/explorer.html")


def main() -> None:
    """Compile the core and write the page."""
    core = compile_core()
    page = explorer_page(core)
    OUT.parent.mkdir(exist_ok=True)
    part = OUT.with_suffix(".part")
    part.write_text(page, encoding="utf-8")
    part.replace(OUT)
    sizes = (len(core), len(gzip.compress(core)), OUT.stat().st_size)
    print("core {:.2f} MB, {:.2f} MB gzipped; page {:.2f} MB".format(*(s / 1e6 for s in sizes)))
    print(OUT)


if __name__ == "__main__":
    main()
