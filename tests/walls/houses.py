"""The two houses of this project, core and package, and how their files are read."""

from collections.abc import Collection

from tests.walls.python_imports import python_files, python_imports
from tests.walls.rooms import House, Import
from tests.walls.rust_imports import rust_files, rust_imports

HOUSES = ("core", "package")


def files_of(house: House) -> Collection[str]:
    """List the files of a house, from its folder."""
    return (rust_files if is_crate(house) else python_files)(house.folder)


def imports_of(house: House) -> list[Import]:
    """List the imports between its files."""
    return (rust_imports if is_crate(house) else python_imports)(house.folder)


def is_crate(house: House) -> bool:
    """Whether its files are Rust."""
    return (house.folder / "lib.rs").exists()
