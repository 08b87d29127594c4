"""Drawings of the page of an audit: which collision shapes of a file are drawn behind its robot."""

import numpy as np
import pytest

from crawler2d.audits.page.drawings import draw_robot
from crawler2d.model_tree import Where
from crawler2d.reading.assembly import Silhouette
from tests.audits.seizing import SEIZING

AT = Where("cart.urdf", 1)
CORNERS = np.array([[0.0, 0.1], [0.1, 0.1], [0.1, 0.2]])


@pytest.mark.parametrize(("corners", "drawn"), [(0, 0), (1, 0), (2, 0), (3, 1)])
def test_a_collision_shape_without_an_area_in_side_view_is_not_drawn(
    corners: int, drawn: int
) -> None:
    shape = Silhouette(link="hull", kind="hull", outline=CORNERS[:corners], at=AT)
    assert draw_robot(SEIZING, "robot", [shape]).count('class="collision"') == drawn
