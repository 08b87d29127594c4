"""A diagnosis in plain English: every clause of its sentence."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.table import Table
from crawler2d.results.findings import Condition, Counterfactual, Intrusion

CONTACTS = {
    "body": [2, 1, 0],
    "body_kind": [0, 0, 0],
    "edge": [1, 1, -1],
    "normal_force": [150.0, 40.0, 60.0],
    "surface_speed": [-0.4, -0.4, 0.4],
    "slides": [True, True, True],
    "in_pocket": [True, True, False],
}
PIECE = Intrusion(
    edge=3,
    edges=(3,),
    bodies=(4, 3),
    body_kinds=(0, 0),
    depth=0.041,
    root_depth=0.041,
    x=0.6,
    y=0.1,
    force=190.0,
)
BELT = Counterfactual(freed=True, distance=0.3, time=0.4, outcome=c2d.Outcome.CLEARED)


def made(contacts: Any = None, **fields: Any) -> c2d.Diagnosis:
    """Make a diagnosis: wheels 2 and 1 slide on edge 3, unless told otherwise."""
    columns = {name: np.array(column) for name, column in (CONTACTS | (contacts or {})).items()}
    plain: dict[str, Any] = {
        "outcome": c2d.Outcome.SEIZED,
        "mechanism": c2d.Mechanism.STRADDLED,
        "cause": ((Condition.POCKET,),),
        "seized_at_tips": True,
        "time": 9.0,
        "since": 6.0,
        "position": (0.5, 0.1),
        "chassis_angle": 0.2,
        "intrusion": PIECE,
        "belly_share": 0.0,
        "sliding_share": 1.0,
        "stalled_share": 0.0,
        "progress": 0.0,
        "stationary": True,
        "imbalance": 1e-9,
        "certified": True,
        "escape_force": 61.2,
        "free_escape_force": 400.0,
        "counterfactual": None,
    }
    return c2d.Diagnosis(**(plain | {"contacts": Table(columns)} | fields))


INSIDE = "edge 3 reaches 41 mm into the track between wheels 3 and 4, at x = 0.600 m, y = 0.100 m"
ON_IT = "wheel 2 slides on it under a load of 150 N, wheel 1 under 40 N"


def test_a_sentence_says_what_is_inside_what_bears_and_what_would_free_it() -> None:
    assert str(made()) == (
        f"seized, straddled: {INSIDE}; {ON_IT}; a closed track or a push of 61 N would free it"
    )
    assert str(made(counterfactual=BELT)) == (
        f"seized, straddled: {INSIDE}; {ON_IT}; a push of 61 N would free it; "
        "a closed belt escapes from the same pose"
    )


@pytest.mark.parametrize(
    ("contacts", "mechanism", "said"),
    [
        ({}, "straddled", ON_IT),
        (
            {"slides": [False, True, True]},
            "straddled",
            "wheel 2 bears on it with 150 N and wheel 1 slides on it under a load of 40 N",
        ),
        (
            {"in_pocket": [False, True, False]},
            "undercut",
            "wheel 1 slides on it under a load of 40 N",
        ),
        # Two contacts of one wheel are one wheel.
        ({"body": [2, 2, 0]}, "undercut", "wheel 2 slides on it under a load of 190 N"),
        (
            {"body_kind": [3, 0, 0]},
            "bellied",
            "the belly slides on it under a load of 150 N, wheel 1 under",
        ),
        (
            {"slides": [False] * 3},
            "interlocked",
            "wheel 2 bears on it with 150 N, wheel 1 with 40 N, with the flank of a grouser against"
            " it",
        ),
        # Shoes have no numbers that a reader could count.
        (
            {"body_kind": [5, 5, 5]},
            "undercut",
            "a shoe slides on it under a load of 150 N, another under 40 N",
        ),
        (
            {"body_kind": [6, 4, 4]},
            "undercut",
            "the guide slides on it under a load of 150 N, a grouser under",
        ),
        # A hundredth of the force is not worth a name.
        (
            {"normal_force": [150.0, 1.0, 60.0]},
            "straddled",
            "wheel 2 slides on it under a load of 150 N;",
        ),
    ],
)
def test_bodies_on_the_edge_are_named_by_what_they_do(
    contacts: Any, mechanism: str, said: str
) -> None:
    d = made(contacts, mechanism=c2d.Mechanism(mechanism))
    assert f"; {said}" in str(d)


@pytest.mark.parametrize(
    ("piece", "said"),
    [
        ({}, "41 mm into the track between wheels 3 and 4, at x = 0.600 m, y = 0.100 m;"),
        ({"x": -1e-9}, "between wheels 3 and 4, at x = 0.000 m"),
        ({"root_depth": 0.029}, "into the track (29 mm past the grouser roots) between wheels 3"),
        ({"root_depth": 0.0}, "into the track (not as far as the grouser roots) between wheels 3"),
        ({"root_depth": 0.0, "bodies": (4, 4)}, "the track between two grousers of wheel 4, at"),
        ({"bodies": (4, 4)}, "the track at wheel 4, at x = 0.600 m"),
        # What a chain runs on has no numbers that a reader could count.
        ({"body_kinds": (9, 9)}, "under the shoes between a road wheel and the next, at x = 0.600"),
        ({"body_kinds": (9, 7)}, "under the shoes between a road wheel and the sprocket, at x"),
        ({"bodies": (44, 44), "body_kinds": (6, 6)}, "the track between two shoes, at x = 0.600"),
        (
            {"bodies": (0, 0), "body_kinds": (1, 1), "root_depth": 0.029},
            "the track between two grousers of the belt, at x = 0.600 m",
        ),
    ],
)
def test_ground_inside_is_told_by_its_place_and_depth(piece: Any, said: str) -> None:
    assert said in str(made(intrusion=dataclasses.replace(PIECE, **piece)))


POCKET, BELLY, TORQUE, FRICTION = Condition


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"cause": ((POCKET,), (FRICTION,))}, "a closed track, twice the friction or a push of 61"),
        # A tie is told without the pocket where a belt has been tried.
        (
            {"cause": ((POCKET,), (FRICTION,)), "counterfactual": BELT},
            "; twice the friction or a push of 61 N would free it; a closed belt escapes",
        ),
        ({"cause": ((BELLY, TORQUE),)}, "removing the belly plus more torque or a push"),
        ({"escape_force": 0.2}, "a closed track or the slightest push would free it"),
        ({"escape_force": math.inf}, "a closed track would free it, but no push would"),
        ({"cause": (), "escape_force": math.inf}, "; no push would free it"),
        ({"escape_force": None}, "; a closed track would free it"),
        ({"cause": (), "escape_force": None, "certified": False, "imbalance": 0.034}, "balance"),
    ],
)
def test_what_would_free_it_is_told_once(fields: Any, said: str) -> None:
    assert said in str(made(**fields))


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        (
            {"outcome": "stalled", "stalled_share": 1.0},
            "stalled: the motors are at their torque limit; a push of 61 N would free it, but "
            "more torque would not",
        ),
        (
            {"outcome": "stalled", "stalled_share": 0.6, "escape_force": math.inf},
            "stalled: 60 % of the motors are at their torque limit; neither more torque nor any "
            "push would free it",
        ),
        (
            {"outcome": "stalled", "stalled_share": 1.0, "escape_force": None},
            "stalled: the motors are at their torque limit; more torque would not free it",
        ),
        (
            {"outcome": "slipping", "escape_force": 20.0},
            "slipping: the track slips at 0.40 m/s; a push of 20 N would free it, but twice the "
            "friction would not",
        ),
        (
            {"outcome": "hung_up", "belly_share": 0.995, "cause": ((BELLY,),)},
            "hung up: the belly carries 100 % of the load; removing the belly or a push of "
            "61 N would free it",
        ),
        (
            {"outcome": "cycling", "cause": ((FRICTION,),), "progress": 0.031},
            "cycling: the track slips at 0.40 m/s; it still creeps at 3 % of the commanded speed; "
            "twice the friction or a push of 61 N would free it",
        ),
        (
            {"outcome": "slipping", "certified": False, "escape_force": None, "imbalance": 0.034},
            "slipping: the track slips at 0.40 m/s; no contact forces balance it: the smallest "
            "residual is 3.4 % of the weight",
        ),
        (
            {"outcome": "slipping", "certified": False, "escape_force": None, "imbalance": None},
            "slipping: the track slips at 0.40 m/s; the balance of forces could not be computed",
        ),
    ],
)
def test_a_stop_without_ground_inside_is_told_by_motors_and_surfaces(
    fields: dict[str, Any], said: str
) -> None:
    contacts = {"in_pocket": [False] * 3}
    given: dict[str, Any] = {"mechanism": None, "intrusion": None, "cause": (), **fields}
    assert str(made(contacts, **given | {"outcome": c2d.Outcome(given["outcome"])})) == said


@pytest.mark.parametrize(
    ("belt", "said"),
    [
        ({}, "; a closed belt escapes from the same pose"),
        (
            {"freed": False, "distance": 0.0123},
            "does not escape from the same pose either (it advances 12 mm)",
        ),
        (
            {"freed": False, "distance": 0.0},
            "; a closed belt does not escape from the same pose either",
        ),
    ],
)
def test_a_tried_belt_ends_the_sentence(belt: Any, said: str) -> None:
    assert str(made(counterfactual=dataclasses.replace(BELT, **belt))).endswith(said)


@pytest.mark.parametrize(("kind", "name"), [(1, "the belt"), (2, "the skid")])
def test_the_body_of_a_closed_track_is_no_wheel(kind: int, name: str) -> None:
    # Ground that a branch found inside of it.
    contacts = {"body": [0, 0, 0], "body_kind": [kind] * 3, "in_pocket": [True, False, False]}
    piece = dataclasses.replace(PIECE, bodies=(0, 0), body_kinds=(kind, kind))
    said = str(made(contacts, intrusion=piece))
    assert f"into the track at {name}, at x = 0.600 m" in said
    assert f"; {name} slides on it under a load of 150 N;" in said
    assert "wheel" not in said


def test_of_a_belt_nobody_is_told_that_a_belt_does_the_same() -> None:
    inside = dataclasses.replace(PIECE, bodies=(0, 0), body_kinds=(1, 1))
    for piece in (inside, None):
        fields = {"intrusion": piece, "outcome": c2d.Outcome.SLIPPING, "counterfactual": BELT}
        assert "closed belt" not in str(made({"body_kind": [1, 4, 4]}, **fields))
