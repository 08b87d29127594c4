"""The walls: files import only from their own room or below, and not in circles."""

import pytest

from tests.walls.houses import HOUSES, files_of, imports_of
from tests.walls.rooms import House, violations


@pytest.mark.parametrize("name", HOUSES)
def test_imports_are_from_the_same_room_or_below(name: str) -> None:
    house = House.read(name)
    found = list(violations(house, files_of(house), imports_of(house)))
    assert not found, "\n" + "\n".join(found)


@pytest.mark.parametrize("name", HOUSES)
def test_imports_are_found(name: str) -> None:
    house = House.read(name)
    assert len(files_of(house)) > 60
    assert len(imports_of(house)) > 3 * len(files_of(house))
