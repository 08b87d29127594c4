"""Differences by rounding are not changes of a file."""

import pytest

import crawler2d as c2d
from crawler2d.patching.changes import _share
from crawler2d.patching.patch import _change_plugins, patch_file
from crawler2d.writing.document import Document
from tests.patching.test_patch import on_chassis
from tests.reading.carts import FILES, quietly


@pytest.fixture(scope="module")
def reading() -> c2d.Reading:
    return quietly(FILES / "cart.urdf")


@pytest.mark.parametrize("off", [9e-7, -9e-7])
def test_a_radius_that_differs_by_rounding_changes_no_size_and_no_limit(
    reading: c2d.Reading, off: float
) -> None:
    wanted = patch_file(reading, on_chassis(reading, 2, 0.125)).text
    assert patch_file(reading, on_chassis(reading, 2, 0.125 + off)).text == wanted


def test_a_robot_that_differs_by_rounding_has_no_change_to_make(reading: c2d.Reading) -> None:
    with pytest.raises(c2d.ScenarioError, match="must have wheels that differ from the file's"):
        patch_file(reading, on_chassis(reading, 3, 0.125 + 9e-7))


@pytest.mark.parametrize(
    ("of_wheels", "stay", "factor"),
    [
        ([1.0, 2.0, 3.0], [0, 1, 2], 1.0),
        ([1.0, 2.0, 3.0], [0, 2], 1.5),
        ([1.0, 2.0, 3.0], [0, 1, 2, 2], 6.0 / 9.0),
        ([1.0, 9e-7], [0], 1.0),
        ([1.0, 2e-6], [0], 1.000002),
        ([0.0, 0.0], [0], 1.0),
        ([0.0, 2.0], [0], 1.0),
    ],
)
def test_those_that_stay_share_the_total_of_all(
    of_wheels: list[float], stay: list[int], factor: float
) -> None:
    assert _share(of_wheels, stay) == pytest.approx(factor, rel=1e-15)
    assert (_share(of_wheels, stay) == 1.0) is (factor == 1.0)


def test_a_shift_that_is_rounding_moves_no_wheel(reading: c2d.Reading) -> None:
    text = patch_file(reading, on_chassis(reading, 2, 0.1)).text
    places = [line for line in text.splitlines() if "<origin xyz" in line]
    assert places
    assert not any("e-" in line for line in places)


@pytest.mark.parametrize(("factor", "text"), [(1.000999, "0.1000999"), (1.001001, "0.1")])
def test_one_size_in_a_plugin_is_changed_for_wheels_that_differ_by_less_than_a_thousandth(
    factor: float, text: str
) -> None:
    lines = "<m><plugin><a>rear</a><a>front</a><wheel_radius>{}</wheel_radius></plugin></m>"
    document = Document(lines.format("0.1"))
    kept = _change_plugins(document, document.root, {"rear": {1.0}, "front": {factor}})
    assert document.text == lines.format(text)
    assert len(kept) == (text == "0.1")
