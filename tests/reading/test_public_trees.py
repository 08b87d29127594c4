"""Main files of public repositories, read in their trees by default, agree with their keys."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from tests.kept import refusing
from tests.reading.carts import SAID, quietly
from tests.robots.tree_keys import Key, keys

# sekirei2020_gazebo has its belts by macros of a package that is not there: what is left of it is
# the other file, as its key says.
STANDS_FOR = {"sekirei2020_gazebo": "sekirei2020"}
READ = [key for key in keys().values() if key.data["on_shapes"]]
each_read = pytest.mark.parametrize("key", READ, ids=[key.name for key in READ])


def figures_of(reading: c2d.Reading) -> dict[str, Any]:
    """The values of a reading for a key, in the frame of the model, x forward and z up."""
    robot, wheels = reading.robot, reading.wheels
    place, turn = reading.frame.place, reading.frame.turn

    def in_model(x: float, y: float) -> list[float]:
        at = place + turn @ (x, 0.0, y)
        return [float(at @ turn[:, 0]), float(at[2])]

    half = 0.5 * robot.outline.axle_distance
    discs = robot.outline.discs or (
        (-half, 0.0, robot.outline.rear_radius),
        (half, 0.0, robot.outline.front_radius),
    )
    outline = [[*in_model(x, y), radius] for x, y, radius in discs]
    own = (wheels["side"] == "left") & (wheels["carrier"] == "chassis")
    found = {
        "wheels_a_side": int(own.sum()),
        "driven_a_side": int((own & (wheels["mass"] > 0.0)).sum()),
        "outline": outline,
        "axles": [disc[:2] for disc in outline],
        "radii": [disc[2] for disc in outline],
        "pitch": robot.outline.axle_distance,
        "gauge": robot.gauge,
        "mass": robot.mass,
        "center_of_mass": in_model(*robot.center_of_mass),
        "flipper_count": 0,
    }
    if own.sum() == 1:  # which is no outline
        x, y = wheels["x"][own], wheels["y"][own]
        found["axles"] = np.column_stack([x, y]).tolist()
        found["radii"] = wheels["radius"][own].tolist()
    arms = robot.flippers
    if arms is not None:
        ends = [outline[0], outline[-1]][slice(arms.ends == "front", 1 + (arms.ends != "rear"))]
        found["flipper_count"] = 2 * len(ends)
        found["flippers"] = [
            [*end[:2], arms.length, arms.root_radius, arms.tip_radius] for end in ends
        ]
    return found


@each_read
def test_a_file_with_shapes_on_the_ground_is_read_as_its_key_says(key: Key) -> None:
    reading = quietly(key.file)
    found, told = figures_of(reading), keys()[STANDS_FOR.get(key.name, key.name)].figures
    for name in found.keys() & told.keys():
        assert np.allclose(found[name], told[name], atol=2e-5), (name, found[name], told[name])
    assert told.keys() - found.keys() <= {"forward", "castors"}
    assert f"{told['forward']} is forward" in " ".join(reading.notes)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("maxii", "a file of macros only is read through the file that calls them"),
        ("myzharbot", "link.Left_wheel. must have a collision shape, as visuals"),
        ("tank", "link.wheel1_link. must have a collision shape that can be read.*wheel.stl"),
    ],
)
def test_a_file_without_shapes_on_the_ground_is_refused_with_a_remedy(name: str, said: str) -> None:
    key = keys()[name]
    assert "cure" in key.data
    with refusing(SAID, said):
        quietly(key.file)
