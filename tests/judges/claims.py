"""Compares the sentence of a stop with its run, to find false claims.

What is seen is held against the second judge, which knows the tables of the run and plane geometry;
what was tried, against runs that continue from the same instants as scenarios made here. Nothing is
taken from the diagnosis but its sentence, and the instant that it speaks of.
"""

import dataclasses
import math
import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import crawler2d as c2d
from crawler2d import _core
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Lanes
from tests.judges.judge import Judge

STOPS = {
    "moves back and forth": "cycling",
    "hangs on its belly": "hung_up",
    "is stalled": "stalled",
    "slips": "slipping",
}
"""How a trial ends that ends in a stop without a jam: the symptom."""
ENDS = {
    "clears": "cleared",
    "tips over": "tipped_over",
    "leaves the ground": "left_terrain",
    "throws its track": "detracked",
}
PLACE = re.compile(
    r"the ground at x = (-?[\d.]+) m, y = (-?[\d.]+) m stands (\d+) mm inside"
    r" the (?P<of>track(?: of the (?P<arm>[a-z ]+flipper))?|(?:left|right) track)"
    r"(?: \((?:(\d+) mm past|not as far as) the grouser roots\))?(?P<where>.*)"
)
JAM = re.compile(
    r"is jammed(?P<again> again)?(?:,?(?P<where> (?:between|under|at) .+?))?"
    r"(?:, in the (?:(?:left|right) )?track(?: of the (?P<arm>[a-z ]+flipper))?"
    r" at x = (?P<x>-?[\d.]+) m, y = (?P<y>-?[\d.]+) m)?$"
)
FROM_THE_START = re.compile(r" from the start$")
AWAY = re.compile(r" (?:(?P<mm>\d+) mm (?:further on|short of here)|here)$")
BETWEEN = re.compile(r" between wheels (\d+) and (\d+)")
LOAD = re.compile(r"(under a load of|under|with) (\d+) N")


class Claims:
    """The claims of the sentence of one run, clause by clause."""

    def __init__(self, run: c2d.Run) -> None:
        assert run.diagnosis is not None
        self.run, self.time = run, run.diagnosis.time
        said = str(run.diagnosis)
        facts, _, tried = said.partition(". Tried: ")
        self.tried, _, self.beyond = tried.partition(". No belt ")
        self.facts, _, self.left = facts.partition(". It goes on by itself: ")
        self.head, _, clauses = self.facts.partition(": ")
        self.clauses = [each for each in clauses.split("; ") if each]
        self.judge = Judge(run)
        self.direction = math.copysign(1.0, run.scenario.drive.speed)
        self.greatest = float((self.direction * run.position[:, 0]).max())

    # What is seen

    def of_what_is_seen(self) -> Iterator[tuple[str, bool]]:
        """Yield each clause about observations, and whether it is true."""
        opinion = self.judge.opinion()
        word = self.head.removeprefix("temporarily ").split(" between")[0]
        word = re.split(r" (?:at|under|on) ", word)[0].replace(" ", "_")
        if word != "seized":
            yield self.head, word in (opinion.symptom, "stalled")
        else:
            yield self.head, opinion.jammed and self.is_between(self.head)
        for clause in self.clauses:
            yield clause, self.is_seen(clause)

    def is_between(self, text: str) -> bool:
        """Whether the most loaded ground inside is between the wheels that a text names."""
        named = BETWEEN.search(text)
        if named is None:
            return True  # chains and grousers, which have no numbers
        assert self.judge.most_loaded is not None
        if self.judge.pieces[self.judge.most_loaded].root_normal is None:
            return True  # the judge considers only root circles
        return sorted(map(int, named.groups())) == sorted(self.judge.beside(self.judge.most_loaded))

    def is_seen(self, clause: str) -> bool:
        """Whether a clause is true."""
        judge = self.judge
        figure = re.search(r"([\d.]+) %", clause)
        share = float(figure[1]) / 100.0 if figure else 1.0
        looks: dict[str, Callable[[], bool]] = {
            "the ground at": lambda: self.is_inside(clause),
            "carries": lambda: abs(judge.belly_share() - share) < 0.02,
            "torque limit": lambda: abs(judge.stalled_share() - share) < 0.02,
            "back and forth": lambda: judge.to_and_fro() > 0.9 * judge.criteria.cycling_distance,
            "creeps": lambda: abs(self.run.metrics["progress"] - share) < 0.01,
            "the track slips": lambda: self.is_slipping(clause),
            "no contact forces": lambda: judge.opinion().imbalance > judge.criteria.imbalance,
        }
        for word, look in looks.items():
            if word in clause:
                return look()
        return self.bears(clause)

    def is_inside(self, clause: str) -> bool:
        judge = self.judge
        found = PLACE.match(clause)
        if found is None or judge.most_loaded is None:
            return False
        piece, loop = judge.pieces[judge.most_loaded], judge.loops[judge.most_loaded]
        arm = found["arm"] is not None
        point = np.array([float(found[1]), float(found[2])])
        # The deepest point of the piece lies on it, within the rounding of the sentence.
        way = judge.grounds[loop.lane].along(point[None])[0]
        on_it = any(first - 0.01 <= way <= last + 0.01 for first, last in piece.spans)
        inside = bool(np.hypot(*(piece.edge - point)) < 0.05) or on_it
        return inside and (loop.carrier > 0) == arm and self.is_between(found["where"])

    def bears(self, clause: str) -> bool:
        """Whether the named bodies bear on the ground inside with these loads."""
        judge = self.judge
        on_it = [c for c in judge.contacts if judge.most_loaded in c.pieces]
        by_body: dict[int, float] = {}
        for c in on_it:
            by_body[c.body] = by_body.get(c.body, 0.0) + c.normal_force
        most = sorted(by_body.values(), reverse=True)
        loads = [float(n) for _, n in LOAD.findall(clause)]
        near = [
            abs(load - force) <= 1.0 + self.looseness() * force
            for load, force in zip(loads, most, strict=False)
        ]
        return bool(loads) and all(near)

    def looseness(self) -> float:
        """[-] Allowed difference of means, which for rattling robots are over other windows."""
        width = self.judge.to_and_fro()
        if width < 1e-4:
            return 0.05
        return 0.25 if width < self.judge.criteria.cycling_distance else 0.6

    def is_slipping(self, clause: str) -> bool:
        found = re.search(r"at ([\d.]+) m/s", clause)
        assert found is not None
        track = [c for c in self.judge.contacts if c.body < self.judge.bodies]
        loads = np.array([c.normal_force for c in track])
        slips = np.array([abs(c.surface_speed) for c in track])
        slip = float(loads @ slips) / float(loads.sum())
        return abs(slip - float(found[1])) < 0.01 + self.looseness() * slip

    # What was tried

    def of_what_was_tried(self) -> Iterator[tuple[str, bool | None]]:
        """Yield each trial in the sentence, and whether its claim is true; None if unknown."""
        if self.left:
            yield f"unchanged: {self.left}", self.went("unchanged", self.left)
        for clause in self.tried.split("; ") if self.tried else ():
            change, _, came = clause.partition(": ")
            yield clause, self.went(change, came)
        if self.beyond:
            yield self.beyond, self.is_beyond_belts()

    def is_beyond_belts(self) -> bool:
        """Whether no belt from the start gets past the stop, or even to it, as claimed."""
        starts = ("belt from the start", "closed track from the start")
        runs = [c2d.simulate(self.variant(change)) for change in starts]
        farthest = max(self.ahead(run) for run in runs)
        if self.beyond.startswith("came this far"):
            return farthest < 0.0
        return 0.0 <= farthest <= self.run.scenario.criteria.escape_distance

    def went(self, change: str, came: str) -> bool | None:
        counted = re.search(r" \((\d) of (\d) times free\)$", came)
        said = came[: counted.start()] if counted else came
        freed = said.startswith(("free after", "past here after"))
        if change.endswith("set down clear of the ground"):
            return self.went_from_clear(said, freed) if counted is None else None
        variant = self.variant(change)
        if FROM_THE_START.search(change):
            run = c2d.simulate(variant)
            return self.gets_away(run) == freed and self.ended(run, said)
        starts = 5 if counted and change != "unchanged" else 1
        runs = [self.continued(variant, k) for k in range(starts)]
        away = [self.gets_away(run) for run in runs]
        if counted:
            return (sum(away) >= 4) == freed
        return away[0] == freed and self.ended(runs[0], said)

    def went_from_clear(self, said: str, freed: bool) -> bool:
        """Check that the start, which the program makes, is clear and at rest."""
        run = self.run.what_if("closed track, clear of the ground").run
        at_rest = not run.velocity[0].any() and not run.angular_velocity[0]
        first = run.contacts["time"] <= run.time[1]
        shallow = not first.any() or float(run.contacts["penetration"][first].max()) < 1e-4
        return at_rest and shallow and self.gets_away(run) == freed and self.ended(run, said)

    def variant(self, change: str) -> Scenario:
        """The scenario with one change."""
        own = self.run.scenario
        track: Any = own.robot.track
        torque = own.robot.drivetrain.max_torque
        slippery = track
        if isinstance(track, c2d.ForceTrack):
            slippery = dataclasses.replace(track, skid_friction=2.0 * track.skid_friction)
        belt: dict[str, Any] = {
            "robot.track": c2d.BeltTrack(),
            "robot.drivetrain.torque_sharing": "track",
        }
        if own.robot.flippers is not None:
            belt["robot.flippers.track"] = None
        changes: dict[str, Callable[[], dict[str, Any]]] = {
            "unchanged": dict,
            "closed track": lambda: {"robot.track": c2d.ClosedTrack(track)},
            "belt along its outline": lambda: belt,
            "smooth closed track": lambda: {
                "robot.track": c2d.ClosedTrack(track, surface="smooth")
            },
            "one motor for all wheels": lambda: {"robot.drivetrain.torque_sharing": "track"},
            "twice the torque": lambda: {"robot.drivetrain.max_torque": 2.0 * torque},
            "ten times the torque": lambda: {"robot.drivetrain.max_torque": 10.0 * torque},
            "twice the friction": lambda: {
                "robot.track": slippery,
                "terrain": with_twice_the_friction(own.terrain),
            },
            "without its belly": lambda: {"robot.belly": None},
            "flippers level": lambda: {"drive.gait": c2d.Hold(0.0)},
        }
        change = FROM_THE_START.sub("", change.replace("belt from", "belt along its outline from"))
        return own.replace(changes[change]())

    def continued(self, variant: Scenario, start: int) -> c2d.Run:
        """The rest of the run as a variant, from the stop or from a fifth of a window later."""
        criteria, speed = variant.criteria, abs(variant.drive.speed)
        pitches = criteria.stop_pitches * variant.robot.outline.grouser_pitch / speed
        at = self.time + start * max(criteria.stop_window, pitches) / 5.0
        lasts = criteria.escape_time + criteria.escape_distance / speed
        variant = dataclasses.replace(variant, duration=lasts)
        text, changed = self.run.scenario.to_json(), variant.to_json()
        result = _core.branch(text, (at, None), changed, (0.0, 0.0), 0.01, "full")
        return c2d.Run(variant, result, parent=(self.run.scenario, at))

    def ahead(self, run: c2d.Run) -> float:
        """[m] Advance of a run beyond the farthest position before the stop."""
        return float((self.direction * run.position[:, 0]).max()) - self.greatest

    def gets_away(self, run: c2d.Run) -> bool:
        """Whether it clears, or gets farther than before and is not lost afterwards."""
        if run.outcome is c2d.Outcome.CLEARED:
            return True
        is_lost = run.outcome in ("tipped_over", "left_terrain", "detracked")
        return not is_lost and self.ahead(run) > run.scenario.criteria.escape_distance

    def ended(self, run: c2d.Run, said: str) -> bool:
        """Whether a run ended as claimed, and where."""
        end = said.rsplit(", then ", maxsplit=1)[-1]
        if away := AWAY.search(end):
            end = end[: away.start()]
            if abs(abs(1e3 * self.ahead(run)) - float(away["mm"] or 0.0)) > 1.0:
                return False
        if end in ENDS:
            return str(run.outcome) == ENDS[end]
        if end.startswith("is jammed"):
            return run.diagnosis is not None and self.is_jammed(Judge(run), end)
        if end in STOPS:
            return run.diagnosis is not None and Judge(run).opinion().symptom == STOPS[end]
        # Free, or still moving, without further claims.
        moves = ("free after", "past here after", "still moving", "is still moving")
        return said.startswith(moves) and run.diagnosis is None

    def is_jammed(self, judge: Judge, end: str) -> bool:
        """Whether a trial ended in a jam, and at the claimed position."""
        found = JAM.match(end)
        if found is None or not judge.opinion().jammed or judge.most_loaded is None:
            return False
        piece, loop = judge.pieces[judge.most_loaded], judge.loops[judge.most_loaded]
        named = BETWEEN.search(found["where"] or "")
        if named and piece.root_normal is not None:
            beside = sorted(judge.beside(judge.most_loaded))
            if sorted(map(int, named.groups())) != beside:
                return False
        if found["again"]:
            was = self.judge.most_loaded
            if was is None:
                return False
            before, around = self.judge.pieces[was], self.judge.loops[was]
            same_track = (loop.lane, loop.carrier) == (around.lane, around.carrier)
            return same_track and bool(np.allclose(piece.edge, before.edge, atol=1e-9))
        place = np.array([float(found["x"]), float(found["y"])])
        way = judge.grounds[loop.lane].along(place[None])[0]
        near = any(first - 0.01 <= way <= last + 0.01 for first, last in piece.spans)
        return near and (loop.carrier > 0) == (found["arm"] is not None)


def with_twice_the_friction(terrain: Any) -> Any:
    """The same ground, of one lane or several."""
    if isinstance(terrain, Lanes):
        lanes = {
            side: with_twice_the_friction(lane)
            for side in ("left", "right", "middle")
            if (lane := getattr(terrain, side)) is not None
        }
        return dataclasses.replace(terrain, **lanes)
    return dataclasses.replace(terrain, friction=2.0 * terrain.friction)


def false_claims(run: c2d.Run) -> tuple[int, list[str]]:
    """Return the number of claims in the sentence of a stop, and the false ones."""
    claims = Claims(run)
    held = [*claims.of_what_is_seen(), *claims.of_what_was_tried()]
    known = [(claim, is_so) for claim, is_so in held if is_so is not None]
    return len(known), [claim for claim, is_so in known if not is_so]
