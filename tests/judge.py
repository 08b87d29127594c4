"""A second judge of stops: from the tables of a run and plane geometry, in its own words.

It shares no code with the core and never reads `Run.diagnosis`. Belts are followed by the support
functions of their circles, the ground by its arc length, and balance is that of the whole robot and
of each drive, by a linear program.
"""

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

import crawler2d as c2d
from crawler2d import _core
from crawler2d.scenario import Scenario
from judge_geometry import Array, Ground, Piece, pieces, placed, right_of
from judge_statics import Balance, Bearing, Range

STOPS = ("seized", "hung_up", "stalled", "slipping", "cycling")

# [-] Stop windows that means are taken over; the words allow one to two.
WINDOWS = 1.0
# [-] Of the friction limit, from which a sliding contact is at it in the mean.
AT_FRICTION_LIMIT = 0.98
# [-] Speed into the ground for a surface speed of 1, from which a surface is a flank.
FLANK = 0.05
# [m] Contacts of one body on one face that are this far apart are two: a grouser sweeps over it,
# and one mean of all its way would bear where it hardly did.
APART = 5e-3
# [m] Along the ground, within which a contact bears on a piece of it.
BESIDE = 5e-4


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


class Judge:
    """Looks at the last windows of one recorded run."""

    def __init__(self, run: c2d.Run, windows: float = WINDOWS) -> None:
        self.run = run
        self.scenario: Scenario = run.scenario
        s, robot = self.scenario, self.scenario.robot
        self.criteria, self.track = s.criteria, robot.track
        self.command = s.drive.speed
        self.ahead = math.copysign(1.0, self.command)
        self.slow = s.criteria.sliding_speed * abs(self.command)
        self.half_length = 0.5 * robot.outline.axle_distance
        window = max(
            self.criteria.stop_window,
            self.criteria.stop_pitches * robot.outline.grouser_pitch / abs(self.command),
        )
        self.span = min(windows * window, run.time[-1])
        self.weight = robot.mass * s.gravity
        self._robot()
        self._means()
        self._pieces()
        self._contacts()
        self._loads()

    def _robot(self) -> None:
        robot = self.scenario.robot
        wheels, outline = robot.wheels(), robot.outline
        self.geometry = _core.geometry(self.scenario.to_json())
        self.is_force = self.track.kind == "force"
        self.wheels = np.column_stack([wheels["x"], wheels["y"], wheels["radius"]])
        self.is_gear = getattr(getattr(self.track, "wheel", None), "kind", "round") == "gear"
        half = self.half_length
        ends = [[-half, 0.0, outline.rear_radius], [half, 0.0, outline.front_radius]]
        self.tips = self.wheels if len(self.wheels) else np.array(ends)
        self.roots = self.tips.copy()
        if self.is_gear:
            for row, gear in zip(self.roots, self.geometry["gears"], strict=True):
                row[2] = np.hypot(*gear["outline"].T).min()
        self.bodies = max(len(self.wheels), 1)
        shared = robot.drivetrain.torque_sharing == "track"
        self.motors = 1 if shared or not isinstance(self.track, c2d.LineOfWheels) else self.bodies
        self.drives = self.motors + (len(self.wheels) if self.is_force else 0)
        belt_radius = outline.rear_radius - outline.grouser_height
        self.limit = 2.0 * robot.drivetrain.max_torque / belt_radius / self.motors
        self.terrain_friction: float = self.scenario.terrain.friction  # type: ignore[union-attr]

    def drive_of(self, body: int) -> int:
        if body >= self.bodies or (self.is_force and not len(self.wheels)):
            return -1
        if self.is_force:
            return 1 + body  # after the one that pushes the chassis
        return body if self.motors > 1 else 0

    def friction_of(self, body: int) -> float:
        of_body = math.inf
        if isinstance(self.track, c2d.ForceTrack) and not len(self.wheels) and body < self.bodies:
            of_body = self.track.skid_friction
        return min(of_body, self.terrain_friction)

    def _means(self) -> None:
        run = self.run
        since = run.time[-1] - self.span + 1e-9
        late = run.time > since
        self.poses = np.column_stack([run.position, run.chassis_angle])[late]
        self.pose = self.poses.mean(axis=0)
        steps = np.diff(run.time, prepend=0.0)
        share = steps[late] / steps[late].sum()
        self.drive_speeds = share @ run.drive_speeds[late]
        self.drive_ways = share @ abs(run.drive_speeds[late])
        self.drive_forces = share @ run.drive_forces[late][:, : self.motors]
        rows = np.flatnonzero(run.contacts["time"] > since)
        self.table = {name: column[rows] for name, column in run.contacts.items()}
        self.at = np.searchsorted(run.time, self.table["time"])
        self.share = steps[self.at] / steps[late].sum()

    def _pieces(self) -> None:
        self.ground = Ground(np.asarray(self.geometry["lanes"][0][1]))
        edges = np.column_stack([self.run.edges["x"], self.run.edges["y"]])
        self.pieces: list[Piece] = pieces(
            self.ground,
            edges[self.run.edges["angle"] > 0.0],
            placed(self.tips, *self.pose),
            placed(self.roots, *self.pose),
            self.criteria.intrusion_depth,
        )

    def _in_ground(self, local: Array) -> Array:
        """Where points of the chassis frame were at the times of the contacts."""
        angle = self.run.chassis_angle[self.at]
        c, s = np.cos(angle), np.sin(angle)
        x, y = local[..., 0], local[..., 1]
        return np.asarray(
            self.run.position[self.at] + np.stack([c * x - s * y, s * x + c * y], axis=-1)
        )

    def _contacts(self) -> None:
        table = self.table
        points = np.column_stack([table["x"], table["y"]])
        normals = np.column_stack([table["normal_x"], table["normal_y"]])
        arms = points - self._in_ground(np.array(self.scenario.robot.center_of_mass))
        motions = -right_of(normals)
        bodies = table["body"].astype(int)
        if self.is_gear:
            own = np.minimum(bodies, self.bodies - 1)
            spokes = points - self._in_ground(self.wheels[own, :2])
            motions = right_of(spokes) / self.wheels[own, 2][:, None]
        self.contacts: list[Bearing] = []
        for body, group in self._groups(bodies, points):
            loads = table["normal_force"][group] * self.share[group]
            total = loads.sum()
            if total <= 0.0:
                continue
            w = loads / total
            normal = w @ normals[group]
            point = w @ points[group]
            bearing = Bearing(
                body=body,
                drive=self.drive_of(body),
                point=point,
                arm=w @ arms[group],
                normal=normal / np.hypot(*normal),
                motion=w @ motions[group],
                friction=self.friction_of(body),
                piece=self.piece_at(point),
                normal_force=total,
                friction_force=float(table["friction_force"][group] @ self.share[group]),
                surface_speed=w @ table["surface_speed"][group],
            )
            limit = AT_FRICTION_LIMIT * bearing.friction * total
            bearing.slides = (
                abs(bearing.surface_speed) >= self.slow and abs(bearing.friction_force) >= limit
            )
            self.contacts.append(bearing)

    def _groups(
        self, bodies: NDArray[np.int64], points: Array
    ) -> list[tuple[int, NDArray[np.int64]]]:
        """The rows of each contact: of one body, on one edge or one place of a face."""
        edge = self.table["edge"]
        keys = np.column_stack([bodies, edge, np.where(edge < 0, self.table["segment"], -1)])
        found = []
        for key in np.unique(keys, axis=0):
            same = np.flatnonzero((keys == key).all(axis=1))
            way = self.ground.along(points[same])
            while len(same):
                near = way <= way.min() + APART
                found.append((int(key[0]), same[near]))
                same, way = same[~near], way[~near]
        return found

    def piece_at(self, point: Array) -> int:
        """Which piece of the ground a contact bears on; -1: none."""
        way = self.ground.along(point[None])[0]
        beside = [max(piece.first - way, way - piece.last) for piece in self.pieces]
        near = [i for i, distance in enumerate(beside) if distance <= BESIDE]
        return min(near, key=beside.__getitem__, default=-1)

    def _loads(self) -> None:
        self.forces = [0.0] * len(self.pieces)
        for contact in self.contacts:
            if contact.piece >= 0:
                self.forces[contact.piece] += contact.normal_force
        least = self.criteria.intrusion_load * self.weight
        self.loaded = [i for i, force in enumerate(self.forces) if force > least]
        # Between two bodies: what is inside the circle of one is no pocket of the track.
        self.pockets = [
            i
            for i in self.loaded
            if self.pieces[i].root_normal is not None and len(set(self.pieces[i].neighbours)) == 2
        ]
        self.most_loaded = max(self.loaded, key=self.forces.__getitem__, default=None)

    # Balance

    def balance(self) -> Balance:
        push, arm = None, 0.0
        if self.is_force:
            angle = self.pose[2]
            push = np.array([math.cos(angle), math.sin(angle)])
            # It acts along the axis through the axles, below the centre of mass.
            arm = self.scenario.robot.center_of_mass[1]
        return Balance(drives=self.drives, half_length=self.half_length, push=push, push_arm=arm)

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
        kept = [c for c in self.contacts if c.piece not in self.pockets]
        x, y, angle = self.pose
        a, b = self.scenario.robot.center_of_mass
        c, s = math.cos(angle), math.sin(angle)
        com = np.array([x + c * a - s * b, y + s * a + c * b])
        for i in self.pockets:
            piece = self.pieces[i]
            assert piece.root_normal is not None
            body = 0
            if len(self.wheels):
                # A belt would run with either of its neighbours; the faster one drags it.
                body = max(piece.neighbours, key=lambda n: self.drive_ways[self.drive_of(n)])
            normal = -piece.root_normal
            new = Bearing(
                body=body,
                drive=self.drive_of(body),
                point=piece.edge,
                arm=piece.edge - com,
                normal=normal,
                motion=-right_of(normal),
                friction=self.friction_of(body),
            )
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
        return float(np.ptp(self.poses * scale, axis=0).max())

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
            if c.piece == self.most_loaded and c.drive >= 0
        ]
        return max(speeds, default=0.0)

    def mechanism(self) -> str | None:
        if self.most_loaded is None:
            return None
        on_it = [c for c in self.contacts if c.piece == self.most_loaded]
        least = self.criteria.intrusion_load * self.weight
        by_body: dict[int, float] = {}
        for c in on_it:
            by_body[c.body] = by_body.get(c.body, 0.0) + c.normal_force
        if by_body.get(self.bodies, 0.0) > least:
            return "bellied"
        if self.stalled_share() >= 0.5:
            return "interlocked" if self.into_ground() > FLANK else "blocked"
        if sum(force > 0.5 * least for body, force in by_body.items() if body < self.bodies) >= 2:
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
