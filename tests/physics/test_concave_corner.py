"""Friction far above 1 in a concave corner, where it locks a smooth belt: by statics.

Whatever the nose does there, it moves farther than the tail, but a belt has one speed, so the tail
has to slide. It cannot if the line from tail to nose is within its cone of friction: the harder the
belt pulls, the harder the nose presses the tail down. So the friction that locks is the cotangent
of the angle between that line and the ground. See "Belts in a corner" in docs/physics.md.
"""

import dataclasses
import itertools
import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad  # type: ignore[import-untyped]
from scipy.optimize import brentq, linprog  # type: ignore[import-untyped]

import crawler2d as c2d
from crawler2d.parameters.scenario import Scenario
from tests.judges.geometry import Array, cross, right_of
from tests.judges.statics import Balance, Bearing
from tests.shared import ROBOT

OUTLINE = ROBOT.outline
LENGTH, RADIUS = OUTLINE.axle_distance, OUTLINE.front_radius
BELT_RADIUS = RADIUS - OUTLINE.grouser_height
GRAVITY = 9.81
WEIGHT = ROBOT.mass * GRAVITY
# The program warns of such friction.
pytestmark = pytest.mark.filterwarnings("ignore::crawler2d.ScenarioWarning")
TAIL = (np.zeros(2), np.array([0.0, 1.0]))
Place = tuple[Array, Array]
"""[m] Where it touches, from where the tail stands, and the normal of the ground; x along the
ground behind the corner."""


def drive_force(torque: float) -> float:
    """[-] Force of both motors in weights, for a torque [N m] per sprocket."""
    return 2.0 * torque / BELT_RADIUS / WEIGHT


@dataclasses.dataclass(frozen=True)
class Corner:
    """Ground that falls by `down` [rad], then rises to some height, with a total turn [rad]."""

    turn: float = math.pi / 2.0
    height: float = 1.0
    down: float = 0.0

    def terrain(self, friction: float) -> Any:
        if self.turn == math.pi / 2.0 and self.down == 0.0:
            return c2d.terrains.step(self.height, friction=friction)
        fall, rise = math.tan(self.down), math.tan(self.turn - self.down)
        points = [[-3.0, 3.0 * fall], [0.0, 0.0], [1.0, rise], [4.0, rise]]
        return c2d.terrains.from_points(points, goal=1.0, friction=friction)

    def nose(self, angle: float = 0.0) -> Place:
        """The nose with the chassis at an angle [rad] to the ground behind."""
        axle = np.array([LENGTH * math.cos(angle), RADIUS + LENGTH * math.sin(angle)])
        normal = np.array([-math.sin(self.turn), math.cos(self.turn)])
        if axle[1] - RADIUS * normal[1] > self.height:  # on the edge
            down = axle[1] - self.height
            normal = np.array([-math.sqrt(RADIUS**2 - down**2), down]) / RADIUS
        return axle - RADIUS * normal, normal

    def weight(self, angle: float) -> Place:
        """Point of application of the weight, and its direction."""
        ahead, above = 0.5 * LENGTH + ROBOT.center_of_mass[0], ROBOT.center_of_mass[1]
        c, s = math.cos(angle), math.sin(angle)
        place = np.array([ahead * c - above * s, RADIUS + ahead * s + above * c])
        return place, np.array([math.sin(self.down), -math.cos(self.down)])

    def locking_friction(self, angle: float = 0.0) -> float:
        x, y = self.nose(angle)[0]
        return float(x / y)

    def force_to_climb(self, friction: float, angle: float = 0.0) -> float:
        """[-] Force of the motors in weights, with sliding tail and rolling nose; inf if locked."""
        (nose, normal), (place, down) = self.nose(angle), self.weight(angle)
        tangent = right_of(normal)
        rows = np.zeros((3, 3))  # forces along x and y, moment; of the tail, the nose's two
        rows[:2] = np.column_stack([[friction, 1.0], normal, tangent])
        rows[2, 1:] = cross(nose, normal), cross(nose, tangent)
        tail, _, nose_friction = np.linalg.solve(rows, -np.array([*down, cross(place, down)]))
        return float(friction * tail + nose_friction) if tail > 0.0 else math.inf

    def stall(self, friction: float, torque: float) -> float:
        """[rad] The angle beyond which motors cannot raise the nose."""
        force = drive_force(torque)

        def spare(angle: float) -> float:
            return 1.0 / force - 1.0 / self.force_to_climb(friction, angle)

        return float(brentq(spare, 0.0, 0.8)) if spare(0.0) < 0.0 else 0.0

    def threshold(self, torque: float) -> float:
        """[-] The friction above which motors cannot raise the nose at all."""
        force = drive_force(torque)
        return float(
            brentq(
                lambda friction: 1.0 / self.force_to_climb(friction) - 1.0 / force,
                1.0,
                self.locking_friction(),
            )
        )


FACE, EDGE_50, EDGE_30 = Corner(), Corner(height=0.05), Corner(height=0.03)
RAMP_45 = Corner(turn=math.radians(45.0))
NAMED = {"face": FACE, "edge 50": EDGE_50, "edge 30": EDGE_30, "ramp 45": RAMP_45}
CORNERS = pytest.mark.parametrize("corner", NAMED.values(), ids=NAMED)


def entering(
    corner: Corner,
    friction: float,
    torque: float,
    *,
    speed: float = 0.05,
    approach: float = 0.02,
    solver: c2d.Solver | None = None,
) -> Scenario:
    drivetrain = dataclasses.replace(ROBOT.drivetrain, max_torque=torque)
    return Scenario(
        dataclasses.replace(ROBOT, drivetrain=drivetrain),
        corner.terrain(friction),
        drive=c2d.Drive(speed=speed),
        start=c2d.Start(approach=approach, angle=-corner.down),
        duration=0.5 / speed + 4.0,
        solver=solver or c2d.Solver(),
    )


def risen(corner: Corner, run: c2d.Run) -> float:
    """[rad] Angle of the chassis to the ground behind the corner."""
    return run.metrics["max_angle"] + corner.down


# What statics says


def test_the_locking_frictions_of_the_documentation() -> None:
    """Closed forms: at a face, at an edge, in a corner that turns by an angle."""
    assert FACE.locking_friction() == pytest.approx((LENGTH + RADIUS) / RADIUS)
    for corner in (EDGE_50, EDGE_30):
        h = corner.height
        expected = (LENGTH + math.sqrt(2.0 * RADIUS * h - h * h)) / h
        assert corner.locking_friction() == pytest.approx(expected)
    found = [FACE, EDGE_50, EDGE_30, Corner(height=3.88e-3)]
    assert [c.locking_friction() for c in found] == pytest.approx([6.7, 8.5, 14.0, 100], rel=0.01)
    for turn, expected in ((60.0, 13.1), (45.0, 21.9), (30.0, 46.3), (20.02, 100.0)):
        angle = math.radians(turn)
        by_turn = (LENGTH + RADIUS * math.sin(angle)) / (RADIUS * (1.0 - math.cos(angle)))
        assert Corner(turn=angle).locking_friction() == pytest.approx(by_turn)
        assert by_turn == pytest.approx(expected, rel=0.005)


@CORNERS
def test_the_load_on_a_tail_that_slides_grows_without_limit_up_to_the_locking_friction(
    corner: Corner,
) -> None:
    (x, y), _ = corner.nose()
    (ahead, _), _ = corner.weight(0.0)
    for share in (0.5, 0.9, 0.999):
        friction = share * x / y
        tail = (x - ahead) / (x - friction * y)
        _, normal = corner.nose()
        rest = np.array([-friction * tail, 1.0 - tail])  # on the nose
        expected = friction * tail + right_of(normal) @ rest
        assert corner.force_to_climb(friction) == pytest.approx(expected)
    assert corner.force_to_climb(1.001 * x / y) == math.inf


def holds(corner: Corner, friction: float, force: float) -> bool:
    """Whether tail and nose can hold a force of the motors [weights], by a linear program."""
    place, _ = corner.weight(0.0)
    bearings = [
        Bearing(
            body=0,
            drive=0,
            point=point,
            arm=point - place,
            normal=normal,
            motion=-right_of(normal),
            friction=friction,
        )
        for point, normal in (TAIL, corner.nose())
    ]
    balance = Balance(drives=1, half_length=0.5 * LENGTH)
    # In units of the force, so that a large one is not lost in the tolerance of the program.
    return balance.imbalance(bearings, [None, None], [(force, force)]) < 1e-7 * max(force, 1.0)


@CORNERS
def test_beyond_the_locking_friction_a_belt_at_rest_holds_any_force(corner: Corner) -> None:
    locking = corner.locking_friction()
    assert all(holds(corner, 1.01 * locking, force) for force in (1.0, 10.0, 1e3, 1e5))
    friction = 0.99 * locking
    most = corner.force_to_climb(friction)
    assert holds(corner, friction, 0.999 * most)
    assert not holds(corner, friction, 1.001 * most)


def quickest_rise(corner: Corner, friction: float, force: float) -> float:
    """[rad/s^2] Largest acceleration of the nose from rest that Coulomb's law allows.

    Tail, nose and the front end on the ground behind are open, stick or slide in all combinations;
    accelerations and forces are the unknowns of a linear program.
    """
    mass = np.array([ROBOT.mass, ROBOT.mass, 0.0, ROBOT.track_mass * RADIUS**2])
    mass[2] = ROBOT.moment_of_inertia - mass[3]
    place, down = corner.weight(0.0)
    load = WEIGHT * np.array([*down, force * RADIUS, -force * RADIUS])
    levers = []
    for point, normal in (TAIL, (np.array([LENGTH, 0.0]), TAIL[1]), corner.nose()):
        arm = point - place
        spins = ((normal, 0.0), (right_of(normal), RADIUS))  # the belt runs against the tangent
        levers += [np.array([*u, cross(arm, u) - r, r]) for u, r in spins]
    # Unknown: four accelerations, then forces along normal and tangent of each contact.
    motion = np.hstack([np.diag(mass), -np.column_stack(levers)])
    best = -math.inf
    for grips in itertools.product(("open", "sticks", 1.0, -1.0), repeat=3):
        equal, right, below = [*motion], [*load], []
        for i, grip in enumerate(grips):
            n, t = np.zeros(10), np.zeros(10)
            n[4 + 2 * i], t[5 + 2 * i] = 1.0, 1.0
            opens, slips = (np.array([*lever, *np.zeros(6)]) for lever in levers[2 * i : 2 * i + 2])
            if grip == "open":
                equal += [n, t]
                below.append(-opens)
            elif grip == "sticks":
                equal += [opens, slips]
                below += [t - friction * n, -t - friction * n]
            else:
                assert isinstance(grip, float)
                equal += [opens, t - grip * friction * n]
                below.append(grip * slips)
        right += [0.0] * (len(equal) - 4)
        bounds = [(None, None)] * 4 + [(0.0, None), (None, None)] * 3
        goal = np.zeros(10)
        goal[2] = -1.0
        found = linprog(goal, below, np.zeros(len(below)), equal, right, bounds, method="highs")
        assert found.status in (0, 2), found.message
        if found.status == 0:
            best = max(best, -found.fun)
    return best


@pytest.mark.parametrize("corner", [FACE, EDGE_30], ids=["face", "edge 30"])
def test_beyond_the_locking_friction_coulombs_law_leaves_nothing_but_rest(corner: Corner) -> None:
    locking = corner.locking_friction()
    still = 1e-6 * GRAVITY / LENGTH
    assert abs(quickest_rise(corner, 1.01 * locking, 1e3)) < still
    friction = 0.9 * locking
    needed = corner.force_to_climb(friction)
    assert abs(quickest_rise(corner, friction, 0.99 * needed)) < still
    assert quickest_rise(corner, friction, 1.01 * needed) > 1e3 * still


# What is simulated


@pytest.mark.parametrize("corner", [EDGE_50, EDGE_30], ids=["edge 50", "edge 30"])
@pytest.mark.parametrize("torque", [20.0, 100.0, 1000.0])
def test_a_step_stops_a_belt_from_that_friction_on(corner: Corner, torque: float) -> None:
    friction = corner.threshold(torque)
    assert friction < corner.locking_friction()
    # At 5 mm/s the remaining speed carries the nose 0.3 % beyond.
    climbs, stays = (
        c2d.simulate(entering(corner, share * friction, torque, speed=0.005), record="summary")
        for share in (0.997, 1.004)
    )
    assert risen(corner, climbs) > math.radians(0.2)
    assert risen(corner, stays) < math.radians(0.05)
    assert stays.outcome == "stalled"


@pytest.mark.parametrize(
    ("friction", "torque"),
    [(1.5, 10.0), (1.5, 20.0), (2.0, 20.0), (2.0, 60.0), (2.0, 1000.0), (3.0, 60.0), (5.0, 100.0)],
)
def test_at_a_face_the_nose_rises_to_the_angle_at_which_the_force_runs_out(
    friction: float, torque: float
) -> None:
    run = c2d.simulate(entering(FACE, friction, torque, speed=0.005))
    assert run.outcome == "stalled"
    stall = FACE.stall(friction, torque)
    beyond = risen(FACE, run) - stall
    # As far as the speed of 5 mm/s carries it.
    assert 0.0 < beyond < math.radians(0.07)
    assert FACE.locking_friction(stall) > friction
    # Most of the work goes into heat where the tail slides.
    work, _ = quad(
        lambda angle: FACE.force_to_climb(friction, angle) * FACE.nose(angle)[0][0], 0.0, stall
    )
    at_most = work + drive_force(torque) * FACE.nose(stall)[0][0] * beyond
    assert 0.999 * work < run.metrics["drive_work"] / WEIGHT < 1.001 * at_most
    assert run.metrics["unresolved_solves"] == 0.0


@pytest.mark.parametrize(
    ("turn", "down"), [(30, 0), (45, 0), (60, 0), (60, 15), (60, 30), (90, 45)]
)
def test_in_a_valley_a_belt_locks_by_the_angle_through_which_that_turns(
    turn: float, down: float
) -> None:
    corner = Corner(turn=math.radians(turn), down=math.radians(down))
    locking = corner.locking_friction()
    for friction in (0.5 * locking, 0.9 * locking, 1.02 * locking, 100.0):
        run = c2d.simulate(entering(corner, friction, 1000.0), record="summary")
        expected = corner.stall(friction, 1000.0)
        assert (expected > 0.0) == (friction < locking)
        assert run.outcome == "stalled"
        # Contacts that bear a hundred weights yield by 30 um.
        assert risen(corner, run) == pytest.approx(expected, abs=math.radians(0.06))


def forces_at_the_stop(run: c2d.Run) -> tuple[Array, Array, Array, Array]:
    """[m], [N] Arms about the centre of mass, normals, forces along normal and tangent."""
    table = run.contacts
    last = table["time"] == run.time[-1]
    turned = np.array([-np.sin(run.chassis_angle[-1]), np.cos(run.chassis_angle[-1])])
    center = run.position[-1] + ROBOT.center_of_mass[1] * turned
    points = np.column_stack([table["x"][last], table["y"][last]])
    normals = np.column_stack([table["normal_x"][last], table["normal_y"][last]])
    forces = table["normal_force"][last], table["friction_force"][last]
    return points - center, normals, *forces


@pytest.mark.parametrize("torque", [6.0, 60.0, 1000.0])
@pytest.mark.parametrize(
    ("name", "friction"),
    [
        (name, friction)
        for name, friction in itertools.product(NAMED, (8.0, 20.0, 100.0))
        if friction > NAMED[name].locking_friction()
    ],
)
def test_a_locked_belt_rests_in_the_one_equilibrium_of_its_two_ends(
    name: str, friction: float, torque: float
) -> None:
    """Four forces on tail and nose follow from weight, moment and motors, whatever the friction."""
    corner = NAMED[name]
    run = c2d.simulate(entering(corner, friction, torque))
    assert run.outcome == "stalled"
    assert run.diagnosis is not None
    assert run.diagnosis.stationary
    assert run.diagnosis.certified
    arms, normals, loads, frictions = forces_at_the_stop(run)
    assert len(loads) == 2  # the front end is off the ground behind
    force = drive_force(torque)
    rows = np.zeros((4, 4))
    for i, (arm, n) in enumerate(zip(arms, normals, strict=True)):
        t = right_of(n)
        rows[:, 2 * i] = *n, cross(arm, n), 0.0
        rows[:, 2 * i + 1] = *t, cross(arm, t), 1.0  # the motors carry the component along the belt
    expected = np.linalg.solve(rows, [0.0, WEIGHT, 0.0, WEIGHT * force])
    found = np.ravel([loads, frictions], order="F")
    assert found == pytest.approx(expected, abs=1e-6 * WEIGHT * max(force, 1.0))
    assert np.all(loads > 0.0)
    # No contact needs more than the locking friction, however large the torque.
    assert np.abs(frictions / loads).max() < 1.001 * corner.locking_friction()
    speeds = run.contacts["surface_speed"][run.contacts["time"] == run.time[-1]]
    assert np.abs(speeds).max() < 1e-6


@pytest.mark.parametrize(
    ("corner", "friction", "torque"),
    [(FACE, 2.0, 60.0), (FACE, 100.0, 60.0), (EDGE_50, 10.0, 60.0), (RAMP_45, 30.0, 60.0)],
    ids=["face 2", "face 100", "edge 10", "ramp 30"],
)
def test_where_a_belt_locks_does_not_depend_on_the_steps(
    corner: Corner, friction: float, torque: float
) -> None:
    solvers = [c2d.Solver(accuracy=accuracy) for accuracy in (3e-7, 3e-8)]
    solvers += [c2d.Solver(time_step=step) for step in (1e-3, 1e-4)]
    scenarios = [entering(corner, friction, torque, solver=solver) for solver in solvers]
    runs = c2d.simulate_many(scenarios, threads=2, record="summary")
    assert {run.outcome for run in runs} == {c2d.Outcome.STALLED}
    angles = [risen(corner, run) for run in runs]
    assert max(angles) - min(angles) < math.radians(0.01)


def test_a_belt_that_arrives_at_full_speed_is_stalled_too() -> None:
    corners = [Corner(height=h) for h in (0.03, 0.04, 0.05, 0.06, 0.1)]
    cases = itertools.product(corners, (8.0, 20.0, 100.0), (6.0, 100.0))
    runs = [
        c2d.simulate(entering(*case, speed=0.4, approach=0.1), record="summary")
        for case in cases
        if case[1] > case[0].locking_friction()
    ]
    assert len(runs) > 20
    assert {run.outcome for run in runs} == {c2d.Outcome.STALLED}
    assert all(run.metrics["unresolved_solves"] == 0.0 for run in runs)
    assert max(run.metrics["max_angle"] for run in runs) < math.radians(0.06)


def test_wheels_with_motors_of_their_own_do_not_lock() -> None:
    """Each turns as fast as necessary; on a common motor they lock like a belt."""
    robot = ROBOT.with_track(c2d.LineOfWheels(3))
    ends = []
    for sharing in ("track", "wheel"):
        drivetrain = dataclasses.replace(robot.drivetrain, torque_sharing=sharing)
        ends.append(
            c2d.simulate(
                dataclasses.replace(robot, drivetrain=drivetrain),
                c2d.terrains.step(0.05, friction=100.0),
                record="summary",
            ).outcome
        )
    assert ends == ["stalled", "cleared"]
