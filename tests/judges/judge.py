"""A second judge of stops: from the tables of a run and plane geometry, in its own words.

It shares no code with the core and never reads `Run.diagnosis`. Belts are followed by the support
functions of their circles, the ground by its arc length, and balance is that of the whole robot and
of each drive, by a linear program.
"""

import itertools
import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import crawler2d as c2d
from tests.judges.geometry import right_of
from tests.judges.statics import Balance, Bearing, Hinge, Range
from tests.judges.stop import Stop

STOPS = ("seized", "hung_up", "stalled", "slipping", "cycling")

# [-] Speed into the ground for a surface speed of 1, from which a surface is a flank.
FLANK = 0.05
# Of the contact table: guide, sprocket, idler, road wheel, return roller.
INSIDE_A_CHAIN = (6, 7, 8, 9, 10)


@dataclass(frozen=True, kw_only=True)
class Opinion:
    """What the judge holds of a stop."""

    outcome: str
    mechanism: str | None
    imbalance: float
    """[-] Share of the weight that no choice of forces balances."""
    relaxed: tuple[float, ...] = ()
    """[-] The same with the pockets closed: as found, all sliding, all at their torque limit."""
    figures: dict[str, float] = field(default_factory=dict)
    """What was compared with a criterion, to read a disagreement."""


class Judge(Stop):
    """Says why it is one."""

    # Balance

    def balance(self) -> Balance:
        push, arm = None, 0.0
        if self.is_force:
            angle = self.pose[2]
            push = np.array([math.cos(angle), math.sin(angle)])
            # It acts along the axis through the axles, below the centre of mass.
            arm = self.scenario.robot.center_of_mass[1]
        hinges = []
        for number, hung in enumerate(self.carriers.arms, 1):
            middle, _ = self.carriers.frame(number, self.pose)
            lever = float((middle - self.carriers.pivot(number, self.pose))[0, 0])
            share = hung.mass / self.scenario.robot.mass
            hinge = Hinge(
                carrier=number, weight_arm=share * lever, torque=hung.torque / self.weight
            )
            hinges.append(hinge)
        return Balance(
            drives=self.drives,
            half_length=self.half_length,
            push=push,
            push_arm=arm,
            hinges=tuple(hinges),
            drive_radius=self.robot.drive_radius,
        )

    def motor_ranges(self, standing: tuple[float, float] | None = None) -> list[Range]:
        """[weights] What each motor may push; where it stands at its limit, these shares of it."""
        most = self.limit / self.weight
        ranges: list[Range] = []
        for force, stands in zip(self.drive_forces, self.stalled(), strict=True):
            if stands and standing is not None:
                ends = [math.copysign(share * most, force) for share in standing]
                ranges.append((min(ends), max(ends)))
            else:
                ranges.append((-most, most))
        return ranges

    def closed(self) -> list[Bearing]:
        """The contacts, with one on the root belt for all on each pocket."""
        kept = [c for c in self.contacts if not set(c.pieces) & set(self.pockets)]
        com = self.carriers.center_of_mass(self.pose)[0]
        for i in self.pockets:
            piece, loop = self.pieces[i], self.loops[i]
            assert piece.root_normal is not None
            # A belt would run with either of its neighbours; the faster one drags it. One that
            # nothing drives runs with what runs round it.
            drives = [self.drive_of(body) for body in self.beside(i)]
            driven = [drive for drive in drives if drive >= 0] or [loop.drive]
            drive = max(driven, key=lambda n: self.drive_ways[n] if n >= 0 else 0.0)
            normal = -piece.root_normal
            new = Bearing(
                body=self.beside(i)[0],
                lane=loop.lane,
                carrier=loop.carrier,
                drive=drive,
                point=piece.edge,
                arm=piece.edge - com,
                normal=normal,
                motion=-right_of(normal),
                friction=self.robot.ground_friction(loop.lane),
            )
            if loop.carrier > 0:
                new.pivot_arm = piece.edge - self.carriers.pivot(loop.carrier, self.pose)[0]
            if new.drive >= 0:
                # The robot stands: what the surface runs is what it slides.
                new.surface_speed = -self.drive_speeds[new.drive]
                # A free surface rolls with the ground under it.
                has_motor = new.drive < self.motors
                new.slides = has_motor and bool(self.drive_ways[new.drive] >= self.slow)
            kept.append(new)
        return kept

    def relaxed(self) -> tuple[float, float, float]:
        """[-] Imbalance with the pockets closed: as found, all sliding, all at their limit."""
        balance, contacts = self.balance(), self.closed()
        as_found = [c.pin for c in contacts]
        # What no motor turns, such as a free wheel or the belly, stays as it was found.
        sliding, held_fast = list(as_found), list(as_found)
        for i, c in enumerate(contacts):
            if 0 <= c.drive < self.motors and not self.is_force:
                sliding[i] = -math.copysign(c.friction, self.ahead * float(c.motion @ c.tangent))
                held_fast[i] = None
        full = self.ahead * self.limit / self.weight
        bearing = {c.drive for c in contacts} | ({0} if self.is_force else set())
        at_limit = [
            (full, full) if j in bearing else free for j, free in enumerate(self.motor_ranges())
        ]
        # A motor with nothing left to bear on turns freely.
        ranges = self.motor_ranges(standing=(self.criteria.torque_limit, 1.0))
        held = [
            of_motor if j in bearing else free
            for j, (of_motor, free) in enumerate(zip(ranges, self.motor_ranges(), strict=True))
        ]
        return (
            balance.imbalance(contacts, as_found, held),
            balance.imbalance(contacts, sliding, self.motor_ranges()),
            balance.imbalance(contacts, held_fast, at_limit),
        )

    # Opinion

    def to_and_fro(self) -> float:
        """[m] Width of what the chassis frame moved within."""
        scale = np.array([1.0, 1.0, self.half_length])
        return float(np.ptp(self.poses[:, :3] * scale, axis=0).max())

    def stalled(self) -> NDArray[np.bool_]:
        """Which motors stand at their torque limit."""
        full = abs(self.drive_forces) >= self.criteria.torque_limit * self.limit
        return np.asarray(full & (abs(self.drive_speeds[: self.motors]) < self.slow))

    def stalled_share(self) -> float:
        """[-] Of the motors that bear on the ground, or on the chassis."""
        loaded = {c.drive for c in self.contacts if c.normal_force > 0.0}
        bearing = [j for j in range(self.motors) if self.is_force or j in loaded]
        return float(self.stalled()[bearing].mean()) if bearing else 0.0

    def belly_share(self) -> float:
        """[-] Of the lift; what pulls down where the robot is wedged is none."""
        lifts = {True: 0.0, False: 0.0}
        for c in self.contacts:
            force = c.normal_force * c.normal + c.friction_force * c.tangent
            lifts[c.body >= self.bodies] += max(float(force[1]), 0.0)
        total = sum(lifts.values())
        return lifts[True] / total if total > 0.0 else 0.0

    def into_ground(self) -> float:
        """[-] Greatest speed into the ground of a surface on the most loaded piece."""
        speeds = [
            -self.ahead * float(c.motion @ c.normal)
            for c in self.contacts
            if self.most_loaded in c.pieces and c.drive >= 0
        ]
        return max(speeds, default=0.0)

    def pinches(self, on_it: list[Bearing]) -> bool:
        """Whether two shoes bear on it for most of the time, and close the gap between them."""
        bore: dict[int, set[int]] = {}
        for c in on_it:
            shoe = self.robot.bodies[c.body].shoe if c.body < self.bodies else -1
            if shoe >= 0:
                bore.setdefault(shoe, set()).update(c.samples.tolist())
        stay = [shoe for shoe, samples in bore.items() if len(samples) > 0.5 * len(self.poses)]
        for one, other in itertools.combinations(stay, 2):
            together = np.array(sorted(bore[one] & bore[other]), dtype=np.int64)
            if self.shoes.closes(one, other, together, self.poses[together, :3], self.ahead):
                return True
        return False

    def mechanism(self) -> str | None:
        if self.most_loaded is None:
            return None
        on_it = [c for c in self.contacts if self.most_loaded in c.pieces]
        least = self.criteria.intrusion_load * self.weight
        by_body: dict[int, float] = {}
        for c in on_it:
            by_body[c.body] = by_body.get(c.body, 0.0) + c.normal_force
        if by_body.get(self.bodies, 0.0) > least:
            return "bellied"
        inside = {c.body for c in on_it if c.kind in INSIDE_A_CHAIN}
        if any(by_body[body] > 0.5 * least for body in inside):
            return "fouled"
        if self.pinches(on_it):
            return "pinched"
        return self.held(on_it, by_body)

    def held(self, on_it: list[Bearing], by_body: dict[int, float]) -> str | None:
        """By motors that cannot turn, or by surfaces that can."""
        if self.stalled_share() >= 0.5:
            return "interlocked" if self.into_ground() > FLANK else "blocked"
        least = 0.5 * self.criteria.intrusion_load * self.weight
        if sum(force > least for body, force in by_body.items() if body < self.bodies) >= 2:
            return "straddled"
        return "undercut" if any(c.slides for c in on_it) else None

    def opinion(self) -> Opinion:
        # All motors may be anywhere within their limits: the certificate asks whether the pose may
        # be an equilibrium, not what holds it.
        found = self.balance().imbalance(
            self.contacts, [c.pin for c in self.contacts], self.motor_ranges()
        )
        cycle, belly, stalled = self.to_and_fro(), self.belly_share(), self.stalled_share()
        stationary = cycle <= self.criteria.stationary_distance
        allowed = self.criteria.imbalance if stationary else self.criteria.mean_imbalance
        relaxed = self.relaxed() if self.pockets and found <= allowed else ()
        outcome = "slipping"
        if cycle > self.criteria.cycling_distance:
            outcome = "cycling"
        elif relaxed and min(relaxed) > allowed:
            outcome = "seized"
        elif belly >= self.criteria.belly_load:
            outcome = "hung_up"
        elif stalled >= 0.5:
            outcome = "stalled"
        return Opinion(
            outcome=outcome,
            mechanism=self.mechanism(),
            imbalance=found,
            relaxed=relaxed,
            figures={
                "belly": belly,
                "stalled": float(stalled),
                "cycle": cycle,
                "stationary": float(stationary),
                "load": max(self.forces, default=0.0) / self.weight,
                "pockets": float(len(self.pockets)),
                "into": self.into_ground(),
            },
        )


def judge(run: c2d.Run) -> Opinion:
    """Say why a recorded run stopped.

    Parameters
    ----------
    run : Run
        One that ended in a stop, with its history.
    """
    return Judge(run).opinion()
