"""The map of the rooms: whether it is beautiful is for people to judge."""

from tests.walls.houses import HOUSES
from tests.walls.map import drawn
from tests.walls.rooms import House


def test_the_map_names_every_room() -> None:
    (ax,) = drawn().axes
    words = {text.get_text() for text in ax.texts}
    rooms = {room.rstrip("/") for name in HOUSES for room in House.read(name).rooms}
    assert rooms <= words
