"""The compiled core belongs to these sources."""

import hashlib
import tomllib
from pathlib import Path

import crawler2d as c2d

ROOT = Path(__file__).parents[2]


def test_the_core_was_built_from_these_sources() -> None:
    sources = [ROOT / "Cargo.lock"]
    sources += (ROOT / "rust_core/src").rglob("*.rs")
    digest = hashlib.sha256()
    # Like the build script: by path, folder by folder.
    for source in sorted(sources, key=lambda path: path.relative_to(ROOT).parts):
        digest.update(source.read_bytes())
    assert c2d.build_info()["build_id"] == digest.hexdigest()[:16], "run `make build`"


def test_the_core_is_a_release_build() -> None:
    assert c2d.build_info()["profile"] == "release"


def test_the_docstring_names_every_key() -> None:
    assert c2d.build_info.__doc__ is not None
    rows = c2d.build_info.__doc__.splitlines()
    named = [row.split("`")[1] for row in rows if row.lstrip().startswith("`")]
    assert named == list(c2d.build_info())


def test_flags_of_a_benchmark_reach_benchmarks_alone() -> None:
    # Cargo hands them to libtest as well, which knows none of them, of whatever else may be one.
    for crate in ("rust_core", "benches"):
        manifest = tomllib.loads((ROOT / crate / "Cargo.toml").read_text(encoding="utf-8"))
        binaries = [ROOT / crate / each["path"] for each in manifest.get("bin", [])]
        assert set((ROOT / crate / "src/bin").glob("*.rs")) == set(binaries)
        others = [manifest["lib"], *manifest.get("bin", [])]
        assert all(each["bench"] is False for each in others)
