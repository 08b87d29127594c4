"""A second, independent judge of stops, from the tables of a run and plane geometry.

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
from tests.judges.statics import Balance, Bearing, Hinge
from tests.judges.stop import Stop

# [-] Speed into the ground for a surface speed of 1, from which a surface is a flank.
FLANK = 0.05
# Of the contact table: guide, sprocket, idler, road wheel, return roller.
INSIDE_A_CHAIN = (6, 7, 8, 9, 10)


@dataclass(frozen=True, kw_only=True)
class Opinion:
    """The judge's findings about a stop."""

    symptom: str
    jammed: bool
    mechanism: str | None
    imbalance: float
    """[-] Share of the weight that no choice of forces balances."""
    figures: dict[str, float] = field(default_factory=dict)
    """What was compared with a criterion, to read a disagreement."""


class Judge(Stop):
    """Finds out the reason of a stop."""

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

    # Opinion

    def to_and_fro(self) -> float:
        """[m] Width of the range in which the chassis frame moved."""
        scale = np.array([1.0, 1.0, self.half_length])
        return float(np.ptp(self.poses[:, :3] * scale, axis=0).max())

    def stalled(self) -> NDArray[np.bool_]:
        """Which motors stand still at their torque limit."""
        full = abs(self.drive_forces) >= self.criteria.torque_limit * self.limit
        return np.asarray(full & (abs(self.drive_speeds[: self.motors]) < self.slow))

    def within(self, speed: float) -> tuple[float, float]:
        """[-] Possible forces of a motor at a speed, in weights.

        A self-locking gear holds any load at rest, and brakes any load that pulls it on.
        """
        most = self.limit / self.weight
        if not self.locks:
            return -most, most
        back, ahead = speed <= -self.slow, speed >= self.slow
        return (-most if back else -math.inf), (most if ahead else math.inf)

    def stalled_share(self) -> float:
        """[-] Fraction of the motors that act on the ground, or on the chassis."""
        loaded = {c.drive for c in self.contacts if c.normal_force > 0.0}
        bearing = [j for j in range(self.motors) if self.is_force or j in loaded]
        return float(self.stalled()[bearing].mean()) if bearing else 0.0

    def belly_share(self) -> float:
        """[-] Fraction of the lift; downward forces on a wedged robot do not count."""
        lifts = {True: 0.0, False: 0.0}
        for c in self.contacts:
            force = c.normal_force * c.normal + c.friction_force * c.tangent
            lifts[c.body >= self.bodies] += max(float(force[1]), 0.0)
        total = sum(lifts.values())
        return lifts[True] / total if total > 0.0 else 0.0

    def into_ground(self) -> float:
        """[-] Largest speed into the ground of a surface on the most loaded piece."""
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
        inside = {c.body for c in on_it if c.kind in INSIDE_A_CHAIN}
        if any(by_body[body] > 0.5 * least for body in inside):
            return "fouled"
        if self.pinches(on_it):
            return "pinched"
        return self.held(on_it, by_body)

    def held(self, on_it: list[Bearing], by_body: dict[int, float]) -> str | None:
        """Held by motors that cannot turn, or by surfaces that can."""
        if self.stalled_share() >= 0.5:
            return "interlocked" if self.into_ground() > FLANK else "blocked"
        least = 0.5 * self.criteria.intrusion_load * self.weight
        if sum(force > least for force in by_body.values()) >= 2:
            return "straddled"
        return "undercut" if any(c.slides for c in on_it) else None

    def opinion(self) -> Opinion:
        # All motors may be anywhere within their limits: the certificate asks whether the pose may
        # be an equilibrium, not what holds it.
        motors = [self.within(speed) for speed in self.drive_speeds[: self.motors]]
        found = self.balance().imbalance(self.contacts, [c.pin for c in self.contacts], motors)
        cycle, belly, stalled = self.to_and_fro(), self.belly_share(), self.stalled_share()
        stationary = cycle <= self.criteria.stationary_distance
        symptom = "slipping"
        if cycle > self.criteria.cycling_distance:
            symptom = "cycling"
        elif belly >= self.criteria.belly_load:
            symptom = "hung_up"
        elif stalled >= 0.5:
            symptom = "stalled"
        return Opinion(
            symptom=symptom,
            jammed=bool(self.pockets),
            mechanism=self.mechanism(),
            imbalance=found,
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
    """Judge a recorded stop before any trials.

    Parameters
    ----------
    run : Run
        One that ended in a stop, with its history.
    """
    return Judge(run).opinion()
