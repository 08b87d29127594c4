"""A stop for the second judge: means of the last windows, and the ground inside."""

import math

import numpy as np
from numpy.typing import NDArray

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.judges.anatomy import Anatomy, Loop
from tests.judges.carriers import Carriers, turned
from tests.judges.geometry import Array, Ground, Piece, pieces, placed
from tests.judges.shoes import Shoes
from tests.judges.statics import Bearing
from tests.judges.surfaces import carried_by_belt, gear_surface, round_surface

# [-] Stop windows that means are taken over; the words allow one to two.
WINDOWS = 1.0
# [-] Of the friction limit, from which a sliding contact is at it in the mean.
AT_FRICTION_LIMIT = 0.98
# [m] Contacts of one body on one face that are this far apart are two: a grouser sweeps over it,
# and one mean of all its way would bear where it hardly did.
APART = 5e-3
# [m] Along the ground, within which a contact bears on a piece of it.
BESIDE = 5e-4


class Stop:
    """The last windows of one recorded run."""

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
        self.robot = Anatomy(s)
        self.is_force = self.track.kind == "force"
        self.bodies, self.motors = len(self.robot.bodies), self.robot.motors
        self.drives, self.limit = self.robot.drives, self.robot.limit
        self.locks = s.robot.drivetrain.self_locking
        self._means()
        self._pieces()
        self._contacts()
        self._loads()

    def drive_of(self, body: int) -> int:
        return self.robot.bodies[body].drive if body < self.bodies else -1

    def friction_of(self, body: int, lane: int) -> float:
        own = self.robot.bodies[body].friction if body < self.bodies else math.inf
        return min(own, self.robot.ground_friction(lane))

    def _means(self) -> None:
        run = self.run
        since = run.time[-1] - self.span + 1e-9
        late = run.time > since
        self.carriers = Carriers(run, late)
        self.poses, self.pose = self.carriers.poses, self.carriers.mean
        steps = np.diff(run.time, prepend=0.0)
        share = steps[late] / steps[late].sum()
        self.drive_speeds = share @ run.drive_speeds[late]
        self.drive_ways = share @ abs(run.drive_speeds[late])
        self.drive_forces = share @ run.drive_forces[late][:, : self.motors]
        rows = np.flatnonzero(run.contacts["time"] > since)
        self.table = {name: column[rows] for name, column in run.contacts.items()}
        at = np.searchsorted(run.time, self.table["time"])
        self.share = steps[at] / steps[late].sum()
        self.at = at - np.flatnonzero(late)[0]  # among the late samples
        chains = 2 if self.robot.is_split else 1
        self.shoes = Shoes(run.shoe_poses[late], chains)

    def _pieces(self) -> None:
        profiles = {label: Ground(np.asarray(lane)) for label, lane in self.robot.lanes}
        self.grounds = profiles
        edges = self.run.edges
        self.pieces: list[Piece] = []
        self.loops: list[Loop] = []
        """That each piece is inside of."""
        for loop in self.robot.loops:
            own = (edges["angle"] > 0.0) & (edges["lane"] == loop.lane)
            origin, angle = self.carriers.frame(loop.carrier, self.pose)
            pose = (origin[0, 0], origin[0, 1], angle[0])
            found = pieces(
                profiles[loop.lane],
                np.column_stack([edges["x"], edges["y"]])[own],
                placed(loop.tips, *pose),
                placed(loop.roots, *pose),
                self.criteria.intrusion_depth,
            )
            self.pieces += found
            self.loops += [loop] * len(found)

    def _motions(self, bodies: NDArray[np.int64], points: Array, normals: Array) -> Array:
        """[-] Velocities of the surfaces at contacts for a surface speed of 1, held otherwise."""
        found = round_surface(normals)
        for number in np.unique(bodies[bodies < self.bodies]):
            body, rows = self.robot.bodies[number], np.flatnonzero(bodies == number)
            if body.form == "shoe":
                found[rows] = self.shoes.motion(body.shoe, self.at[rows], points[rows])
            elif body.form in ("gear", "grouser"):
                origin, angle = self.carriers.frame(body.carrier, self.poses[self.at[rows]])
                local = turned(points[rows] - origin, -angle)
                if body.form == "gear":
                    moved = gear_surface(local, np.array(body.center), body.radius)
                else:
                    moved = carried_by_belt(local, self.robot.line_of(body))
                found[rows] = turned(moved, angle)
        return found

    def _contacts(self) -> None:
        table = self.table
        points = np.column_stack([table["x"], table["y"]])
        normals = np.column_stack([table["normal_x"], table["normal_y"]])
        poses = self.poses[self.at]
        arms = points - self.carriers.center_of_mass(poses)
        bodies = table["body"].astype(int)
        motions = self._motions(bodies, points, normals)
        self.contacts: list[Bearing] = []
        for body, group in self._groups(bodies, points):
            loads = table["normal_force"][group] * self.share[group]
            total = loads.sum()
            if total <= 0.0:
                continue
            w = loads / total
            normal = w @ normals[group]
            point = w @ points[group]
            lane = int(table["lane"][group[0]])
            carrier = self.robot.bodies[body].carrier if body < self.bodies else 0
            bearing = Bearing(
                body=body,
                kind=int(table["body_kind"][group[0]]),
                lane=lane,
                carrier=carrier,
                drive=self.drive_of(body),
                point=point,
                arm=w @ arms[group],
                normal=normal / np.hypot(*normal),
                motion=w @ motions[group],
                friction=self.friction_of(body, lane),
                # What the belly rests on is not between bodies of a track.
                pieces=self.pieces_at(point, lane, carrier) if body < self.bodies else (),
                normal_force=total,
                friction_force=float(table["friction_force"][group] @ self.share[group]),
                surface_speed=w @ table["surface_speed"][group],
                samples=np.unique(self.at[group]),
            )
            if carrier > 0:
                bearing.pivot_arm = point - w @ self.carriers.pivot(carrier, poses[group])
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
            ground = self.grounds[int(self.table["lane"][same[0]])]
            way = ground.along(points[same])
            while len(same):
                near = way <= way.min() + APART
                found.append((int(key[0]), same[near]))
                same, way = same[~near], way[~near]
        return found

    def pieces_at(self, point: Array, lane: int, carrier: int) -> tuple[int, ...]:
        """Which piece of the ground inside its own track a contact bears on, the nearest."""
        way = self.grounds[lane].along(point[None])[0]
        near = (math.inf, -1)
        for i, (piece, loop) in enumerate(zip(self.pieces, self.loops, strict=True)):
            distance = min(max(first - way, way - last) for first, last in piece.spans)
            if (loop.lane, loop.carrier) == (lane, carrier) and distance <= BESIDE:
                near = min(near, (distance, i))
        return near[1:] if near[1] >= 0 else ()

    def _loads(self) -> None:
        self.forces = [0.0] * len(self.pieces)
        for contact in self.contacts:
            for i in contact.pieces:
                self.forces[i] += contact.normal_force
        least = self.criteria.intrusion_load * self.weight
        self.loaded = [i for i, force in enumerate(self.forces) if force > least]
        # Between two bodies: ground inside the circle of one is not in a pocket of the track.
        self.pockets = [
            i
            for i in self.loaded
            if self.pieces[i].root_normal is not None and len(set(self.beside(i))) == 2
        ]
        inside = self.pockets or self.loaded
        self.most_loaded = max(inside, key=self.forces.__getitem__, default=None)

    def beside(self, piece: int) -> list[int]:
        """The bodies on either side of a piece."""
        loop = self.loops[piece]
        return [loop.bodies[circle] for circle in self.pieces[piece].neighbours]
