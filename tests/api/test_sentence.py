"""A diagnosis in plain English: every clause of its sentence."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest

import crawler2d as c2d
from crawler2d.common.arrays import Table
from crawler2d.results.findings import Intrusion, TrialResult

CONTACTS = {
    "body": [2, 1, 0],
    "body_kind": [0, 0, 0],
    "edge": [1, 1, -1],
    "x": [0.61, 0.6, 0.5],
    "y": [0.1, 0.1, 0.0],
    "normal_x": [0.0, 0.0, 0.0],
    "normal_y": [1.0, 1.0, 1.0],
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
    side="both",
    carrier="chassis",
    depth=0.041,
    root_depth=0.041,
    x=0.6,
    y=0.1,
    force=190.0,
)
OUT = c2d.Outcome


def tried(name: str, time: float = math.inf, **fields: Any) -> TrialResult:
    """Make a trial: it frees the robot if it takes a finite time."""
    freed = math.isfinite(time)
    plain: dict[str, Any] = {
        "name": name,
        "freed": freed,
        "starts": 1,
        "freeing": int(freed),
        "distance": 0.3 if freed else -0.001,
        "time": time,
        "outcome": OUT.CLEARED if freed else OUT.SLIPPING,
        "jammed": False,
        "intrusion": PIECE if fields.get("jammed") else None,
        "duration": 5.125,
        "position": (0.8, 0.1),
        "chassis_angle": 0.0,
        "flipper_angles": (),
    }
    return TrialResult(**(plain | fields))


def piece(**fields: Any) -> Intrusion:
    """Make ground inside the track like that of the stop, at another position."""
    return dataclasses.replace(PIECE, **fields)


BELT = tried("closed track", 0.34)


def made(contacts: Any = None, **fields: Any) -> c2d.Diagnosis:
    """Make a diagnosis, by default with wheels 2 and 1 sliding on edge 3."""
    columns = {name: np.array(column) for name, column in (CONTACTS | (contacts or {})).items()}
    plain: dict[str, Any] = {
        "outcome": OUT.SEIZED,
        "symptom": OUT.SLIPPING,
        "transient": False,
        "trials": (),
        "jammed": True,
        "mechanism": c2d.Mechanism.STRADDLED,
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
    }
    return c2d.Diagnosis(**(plain | {"contacts": Table(columns)} | fields))


INSIDE = "the ground at x = 0.600 m, y = 0.100 m stands 41 mm inside the track"
ON_IT = "wheel 2 slides on it under a load of 150 N, wheel 1 under 40 N"
SEIZED = f"seized between wheels 3 and 4: {INSIDE}; {ON_IT}"


def test_a_sentence_names_intrusion_contacts_and_trials() -> None:
    assert str(made()) == SEIZED
    controls = (tried("unchanged"), tried("rebuilt"))
    assert str(made(trials=controls)) == SEIZED
    assert str(made(trials=(*controls, BELT, tried("torque x 2", jammed=True)))) == (
        f"{SEIZED}. Tried: closed track: free after 0.3 s, then clears; "
        "twice the torque: is jammed again"
    )


@pytest.mark.parametrize(
    ("trial", "said"),
    [
        (BELT, "closed track: free after 0.3 s, then clears"),
        (
            tried("closed track, clear of the ground", 1.26),
            "closed track, set down clear of the ground: free after 1.3 s, then clears",
        ),
        (
            tried("closed smooth track", outcome=OUT.TIMED_OUT),
            "smooth closed track: still moving, but not free",
        ),
        (
            tried("friction x 2", 0.4, outcome=OUT.STALLED, jammed=True),
            "twice the friction: free after 0.4 s, then is jammed again",
        ),
        (
            tried("friction x 2", 0.4, outcome=OUT.TIMED_OUT),
            "twice the friction: free after 0.4 s",
        ),
        # A robot that tips over or is lost is not free, however far it got.
        (
            tried("no belly", outcome=OUT.TIPPED_OVER, distance=0.12),
            "without its belly: tips over 120 mm further on",
        ),
        (tried("no belly", outcome=OUT.TIPPED_OVER), "without its belly: tips over"),
        (tried("torque x 10", outcome=OUT.LEFT_TERRAIN), "ten times the torque: leaves the ground"),
        (tried("flippers level", outcome=OUT.DETRACKED), "flippers level: throws its track"),
        (
            tried("torque x 2", distance=0.0034, jammed=True),
            "twice the torque: is jammed again 3 mm further on",
        ),
        (
            tried("torque x 2", jammed=True, intrusion=piece(bodies=(2, 1))),
            "twice the torque: is jammed again, between wheels 1 and 2",
        ),
        (
            tried("torque x 2", distance=0.3, jammed=True, intrusion=piece(edge=5, x=0.7)),
            "twice the torque: is jammed between wheels 3 and 4, in the track at x = 0.700 m, "
            "y = 0.100 m",
        ),
        (
            tried("torque x 2", jammed=True, intrusion=piece(carrier="front flipper")),
            "twice the torque: is jammed between wheels 3 and 4, in the track of the front flipper "
            "at x = 0.600 m, y = 0.100 m",
        ),
        (tried("torque x 2", distance=0.0034), "twice the torque: slips 3 mm further on"),
        (tried("belt", 0.3), "belt along its outline: free after 0.3 s, then clears"),
        (
            tried("belt, from the start", 3.26),
            "belt from the start: past here after 3.3 s, then clears",
        ),
        (tried("torque x 2", outcome=OUT.STALLED), "twice the torque: is stalled"),
        (tried("one motor", outcome=OUT.CYCLING), "one motor for all wheels: moves back and forth"),
        (tried("flippers level", outcome=OUT.HUNG_UP), "flippers level: hangs on its belly"),
        # Trials of a rattling robot start from several instants.
        (
            tried("torque x 2", 0.6, starts=5, freeing=4),
            "twice the torque: free after 0.6 s, then clears (4 of 5 times free)",
        ),
        (
            tried("torque x 2", starts=3, freeing=1),
            "twice the torque: slips (1 of 3 times free)",
        ),
    ],
)
def test_the_result_of_a_trial_is_said_in_a_few_words(trial: TrialResult, said: str) -> None:
    assert str(made(trials=(trial,))) == f"{SEIZED}. Tried: {said}"


def test_only_a_robot_that_was_jammed_is_jammed_again() -> None:
    trial = tried("torque x 2", 0.6, outcome=OUT.STALLED, jammed=True)
    free = made(trials=(trial,), jammed=False, outcome=OUT.STALLED, symptom=OUT.STALLED)
    assert "then is jammed between wheels 3 and 4, in the track at x = 0.600 m" in str(free)


@pytest.mark.parametrize(
    ("belt", "closed", "said"),
    [
        (0.02, -0.093, "belt from the start: slips 20 mm further on; closed track from the start: "
        "slips 93 mm short of here. No belt got past here from the start"),
        (-0.02, -0.0931, "slips 93 mm short of here. No belt came this far from the start"),
        (0.0001, -0.0931, "belt from the start: slips here; closed"),
    ],
)  # fmt: skip
def test_a_stop_that_no_belt_gets_past_says_so(belt: float, closed: float, said: str) -> None:
    trials = (
        tried("belt, from the start", distance=belt),
        tried("closed track, from the start", distance=closed),
    )
    found = made(trials=trials)
    assert said in str(found)
    assert found.reached_by_belt is (belt >= 0.0)
    assert made().reached_by_belt is None
    for past in (
        tried("belt, from the start", 3.0),
        tried("belt, from the start", outcome=OUT.TIPPED_OVER, distance=0.2),
    ):
        assert "No belt" not in str(made(trials=(past,)))


@pytest.mark.parametrize(
    ("control", "said"),
    [
        ("unchanged", "It goes on by itself: free after 0.3 s, then clears"),
        ("rebuilt", "With its track rebuilt it goes on: free after 0.3 s, then clears"),
    ],
)
def test_the_sentence_of_a_transient_stop_says_only_how_it_went_on(control: str, said: str) -> None:
    stop = made(
        transient=True, outcome=OUT.TIMED_OUT, trials=(dataclasses.replace(BELT, name=control),)
    )
    assert str(stop) == (
        f"temporarily slipping: {INSIDE} between wheels 3 and 4; {ON_IT}; "
        f"the track slips at 0.40 m/s. {said}".replace("; the track slips at 0.40 m/s", "")
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
        # A contact with a hundredth of the force is not named.
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
    assert f"; {said}" in f"{d};"


@pytest.mark.parametrize(
    ("piece", "said"),
    [
        ({}, "seized between wheels 3 and 4: the ground at x = 0.600 m, y = 0.100 m stands 41 mm"),
        ({"x": -1e-9}, "the ground at x = 0.000 m"),
        ({"root_depth": 0.029}, "inside the track (29 mm past the grouser roots);"),
        ({"root_depth": 0.0}, "inside the track (not as far as the grouser roots);"),
        ({"side": "left"}, "41 mm inside the left track;"),
        ({"carrier": "front flipper"}, "41 mm inside the track of the front flipper;"),
        (
            {"carrier": "rear flipper", "side": "right"},
            "41 mm inside the track of the right rear flipper;",
        ),
        (
            {"root_depth": 0.0, "bodies": (4, 4)},
            "seized between two grousers of wheel 4: the ground",
        ),
        ({"bodies": (4, 4)}, "seized at wheel 4: the ground"),
        # What a chain runs on has no numbers that a reader could count.
        ({"body_kinds": (9, 9)}, "seized under the shoes between a road wheel and the next:"),
        ({"body_kinds": (9, 7)}, "seized under the shoes between a road wheel and the sprocket:"),
        ({"bodies": (44, 44), "body_kinds": (6, 6)}, "seized between two shoes: the ground"),
        (
            {"bodies": (0, 0), "body_kinds": (1, 1), "root_depth": 0.029},
            "seized between two grousers of the belt: the ground",
        ),
    ],
)
def test_ground_inside_is_described_by_place_and_depth(piece: Any, said: str) -> None:
    assert said in str(made(intrusion=dataclasses.replace(PIECE, **piece)))


def test_ground_inside_that_does_not_stop_the_robot_follows_the_outcome() -> None:
    for outcome in (OUT.SLIPPING, OUT.STALLED):
        said = str(made(outcome=outcome, symptom=outcome))
        assert said.startswith(f"{outcome}: {INSIDE} between wheels 3 and 4; {ON_IT}")


@pytest.mark.parametrize(
    ("fields", "said"),
    [
        (
            {"outcome": "stalled", "stalled_share": 1.0},
            "stalled: the motors are at their torque limit",
        ),
        (
            {"outcome": "stalled", "stalled_share": 0.6},
            "stalled: 60 % of the motors are at their torque limit",
        ),
        ({"outcome": "slipping"}, "slipping: the track slips at 0.40 m/s"),
        (
            {"outcome": "hung_up", "belly_share": 0.995},
            "hung up: the belly carries 100 % of the supporting force",
        ),
        (
            {"outcome": "cycling", "progress": 0.031},
            "cycling: it moves back and forth; it still creeps at 3 % of the commanded speed",
        ),
        (
            {"outcome": "slipping", "certified": False, "imbalance": 0.034},
            "slipping: the track slips at 0.40 m/s; no contact forces balance it: the smallest "
            "residual is 3.4 % of the weight",
        ),
        (
            {"outcome": "slipping", "certified": False, "imbalance": None},
            "slipping: the track slips at 0.40 m/s; the balance of forces could not be computed",
        ),
    ],
)
def test_a_stop_without_ground_inside_is_described_by_motors_and_surfaces(
    fields: dict[str, Any], said: str
) -> None:
    outcome = OUT(fields["outcome"])
    given: dict[str, Any] = {"mechanism": None, "intrusion": None, "jammed": False, **fields}
    given |= {"outcome": outcome, "symptom": outcome}
    assert str(made({"in_pocket": [False] * 3}, **given)) == said


@pytest.mark.parametrize(
    ("angle", "normal", "side", "said"),
    [
        (
            0.1,
            (0.0, 1.0),
            "underside",
            "hung up: the belly carries 40 % of the supporting force{AT}",
        ),
        (
            1.05,
            (0.0, 1.0),
            "tail",
            "hung up on the tail of its hull: the tail carries 40 % of the supporting force{AT}",
        ),
        (
            -1.05,
            (0.0, 1.0),
            "nose",
            "hung up on the nose of its hull: the nose carries 40 % of the supporting force{AT}",
        ),
        # A steep robot on an edge still lies on its underside.
        (
            1.05,
            (-0.87, 0.5),
            "underside",
            "hung up: the belly carries 40 % of the supporting force{AT}",
        ),
    ],
)
def test_standing_on_the_tail_differs_from_lying_on_the_belly(
    angle: float, normal: tuple[float, float], side: str, said: str
) -> None:
    contacts = {
        "body_kind": [3, 0, 0],
        "in_pocket": [False] * 3,
        "normal_x": [normal[0], 0.0, 0.0],
        "normal_y": [normal[1], 1.0, 1.0],
    }
    hung = made(
        contacts,
        outcome=OUT.HUNG_UP,
        symptom=OUT.HUNG_UP,
        chassis_angle=angle,
        belly_share=0.4,
        mechanism=None,
        intrusion=None,
        jammed=False,
    )
    assert hung.belly_side == side
    assert str(hung) == said.format(AT=" at x = 0.610 m, y = 0.100 m")
    assert made().belly_side == ""


@pytest.mark.parametrize(("kind", "name"), [(1, "the belt"), (2, "the skid")])
def test_the_body_of_a_closed_track_is_no_wheel(kind: int, name: str) -> None:
    # Ground that was inside a branch at its start.
    contacts = {"body": [0, 0, 0], "body_kind": [kind] * 3, "in_pocket": [True, False, False]}
    piece = dataclasses.replace(PIECE, bodies=(0, 0), body_kinds=(kind, kind))
    said = str(made(contacts, intrusion=piece, outcome=OUT.SLIPPING))
    assert f"inside the track at {name};" in said
    assert f"; {name} slides on it under a load of 150 N;" in said
    assert "wheel" not in said
