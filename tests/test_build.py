"""The compiled core is the one of these sources."""

import hashlib
from pathlib import Path

import crawler2d as c2d

ROOT = Path(__file__).parents[1]


def test_the_core_was_built_from_these_sources() -> None:
    sources = [ROOT / "Cargo.lock"]
    sources += (ROOT / "rust_core/src").rglob("*.rs")
    digest = hashlib.sha256()
    # As the build script does: by path, folder by folder.
    for source in sorted(sources, key=lambda path: path.relative_to(ROOT).parts):
        digest.update(source.read_bytes())
    assert c2d.build_info()["build_id"] == digest.hexdigest()[:16], "run `make build`"


def test_the_core_is_a_release_build() -> None:
    assert c2d.build_info()["profile"] == "release"
