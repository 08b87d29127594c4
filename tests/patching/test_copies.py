"""Names in a copied part of a file, and attributes that are not names of parts."""

import pytest

from crawler2d.patching.edits import copy_elements, items_about, names_of
from crawler2d.writing.document import Document


def copies(text: str, names: dict[str, str]) -> list[str]:
    document = Document(text)
    items = items_about(document.root, set(names))
    return copy_elements(document, items, names, lambda *_: None)


@pytest.mark.parametrize("key", ["class", "childclass", "material", "mesh", "type", "filename"])
def test_an_attribute_that_names_no_part_may_hold_its_name(key: str) -> None:
    text = f'<m><body name="w"><geom {key}="w"/></body><other {key}="w"/></m>'
    assert copies(text, {"w": "w2"}) == [f'<body name="w2"><geom {key}="w"/></body>']


@pytest.mark.parametrize("holder", ["actuator", "sensor", "contact", "tendon", "equality"])
def test_copied_parts_of_mjcf_have_names_of_their_own(holder: str) -> None:
    text = f'<m><{holder}><part name="p" joint="w"/></{holder}><other name="w"/></m>'
    assert copies(text, {"w": "w2"}) == ['<part name="p2" joint="w2"/>', '<other name="w2"/>']
    assert copies('<m><other name="p" joint="w"/></m>', {"w": "w2"}) == [
        '<other name="p" joint="w2"/>'
    ]


def test_a_transmission_and_its_actuator_have_names_of_their_own_as_copies() -> None:
    text = '<m><transmission name="t"><joint name="w"/><actuator name="a"/></transmission></m>'
    assert copies(text, {"w": "w2"}) == [
        text[3:-4].replace('"t"', '"t2"').replace('"w"', '"w2"').replace('"a"', '"a2"')
    ]
    assert copies(text, {"other": "other2"}) == []


def test_the_outermost_parts_about_a_wheel_are_copied_once() -> None:
    """Parts about other links and joints stay; parts with neither are searched."""
    text = (
        '<m><link name="hull"><note of="w"/></link><joint name="j"><child>w</child></joint>'
        '<link name="w"><part of="w"/></link><plugin><list>w</list><list>w v</list></plugin>'
        '<a><b><motor joint="w"/></b></a></m>'
    )
    assert copies(text, {"w": "w2"}) == [
        '<link name="w2"><part of="w2"/></link>',
        "<list>w2</list>",
        '<motor joint="w2"/>',
    ]


def test_a_wheel_has_the_names_of_its_joints_and_of_all_in_its_bodies() -> None:
    text = (
        '<m><joint name="a"><child>w</child></joint><joint name="b"><child link="w"/></joint>'
        '<joint name="c"><child>hull</child></joint><joint name="d"/><link name="e"/>'
        '<body name="w"><geom name="f"/><geom/></body><body name="v"><geom name="g"/></body></m>'
    )
    assert names_of(Document(text).root, ("w",), "own") == {"w", "own", "a", "b", "f"}
