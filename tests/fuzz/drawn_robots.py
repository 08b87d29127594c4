"""Legal robots, drawn over the whole range of every field: the ranges of rust_core/src/scenario."""

import math
import random
from collections.abc import Callable
from typing import Any, Literal

import crawler2d as c2d
from crawler2d.common.bodies import Disc, end_discs
from crawler2d.parameters.track import OpenTrack, Track

TINY = 1e-20
"""Low end of what is drawn where any number above 0 is legal."""


class Draw(random.Random):
    """Numbers that are usual with some probability, else anywhere in the range of a field."""

    wild = 0.3
    """How often a field leaves what is usual."""

    def size(self, low: float, high: float, usual: tuple[float, float]) -> float:
        """A positive number by magnitude, one in six of the wild ones at an end of the range."""
        if self.random() < self.wild:
            if self.random() < 0.16:
                return self.choice((low, high))
        else:
            low, high = (min(max(end, low), high) for end in usual)
        return min(max(math.exp(self.uniform(math.log(low), math.log(high))), low), high)

    def size_or_zero(self, low: float, high: float, usual: tuple[float, float]) -> float:
        return 0.0 if self.random() < 0.3 * self.wild else self.size(low, high, usual)

    def signed(self, high: float, usual: float, low: float = 1e-12) -> float:
        """A number of either sign, or 0."""
        number = self.size_or_zero(low, high, (0.01 * usual, usual))
        return number if self.random() < 0.6 else -number

    def whole(self, low: int, high: int, usual: tuple[int, int]) -> int:
        return (
            low - 1 + round(self.size(1, high - low + 1, (usual[0] - low + 1, usual[1] - low + 1)))
        )

    def maybe(self, chance: float, value: float) -> float | None:
        return value if self.random() < chance else None

    def maybe_whole(self, chance: float, value: int) -> int | None:
        return value if self.random() < chance else None


def smallest_end(outline: c2d.TrackOutline) -> float:
    return min(radius for _, _, radius in outline.discs)


def drawn_outline(draw: Draw) -> c2d.TrackOutline:
    axles = draw.size(1e-3, 100.0, (0.1, 1.5))
    usual = (0.1 * axles, 0.45 * axles)
    front = draw.size(1e-3, 100.0, usual)
    rear = front
    if draw.random() < 0.5:
        rear = draw.size(max(1e-3, front - 0.999 * axles), min(100.0, front + 0.999 * axles), usual)
    discs = None if draw.random() < 0.7 else drawn_discs(draw, axles, rear, front)
    smallest = min(front, rear) if discs is None else min(radius for _, _, radius in discs)
    around = 2.0 * axles + 2.0 * math.pi * max(front, rear)
    pitch = draw.size(max(1e-3, around / 200.0), 100.0, (around / 60.0, around / 8.0))
    ends: Any = {"axle_distance": axles, "front_radius": front, "rear_radius": rear}
    return c2d.TrackOutline(
        **(ends if discs is None else {"discs": discs}),
        grouser_height=draw.size_or_zero(1e-9, 0.999 * smallest, (0.01 * smallest, 0.2 * smallest)),
        grouser_pitch=pitch,
        grouser_thickness=draw.size_or_zero(1e-9, 0.999 * pitch, (0.05 * pitch, 0.3 * pitch)),
    )


def drawn_discs(draw: Draw, axles: float, rear: float, front: float) -> list[Disc] | None:
    """Ends at any heights with discs below and above, in any order; most bend the track."""
    half = 0.5 * axles

    def height(share: float) -> float:
        # Coordinates are within 100 m.
        return min(100.0, draw.size_or_zero(1e-12, 100.0, (0.1 * share * axles, share * axles)))

    discs = [(-half, height(0.4), rear), (half, height(0.4), front)]
    for side in draw.sample((-1, -1, -1, 1), draw.whole(0, 4, (1, 3))):
        x = draw.uniform(-0.7, 0.7) * half
        radius = draw.size(1e-3, 100.0, (0.1 * axles, 0.3 * axles))
        discs.append((x, max(-100.0, side * height(0.3) if side < 0 else height(0.9)), radius))
    draw.shuffle(discs)
    rear_end, front_end = end_discs(discs)
    # One disc may reach farthest in both directions.
    return discs if front_end[0] > rear_end[0] else None


def drawn_wheel(draw: Draw, radius: float) -> c2d.RoundWheel | c2d.GearWheel:
    """Round, or with grousers that fit on a root circle."""
    if draw.random() < 0.4:
        return c2d.RoundWheel()
    count = draw.whole(3, 200, (5, 20))
    height = draw.size(1e-9, 0.99 * radius, (0.02 * radius, 0.2 * radius))
    # Between its neighbours, and with flanks outside the root circle.
    half = min(math.pi / count, math.acos((radius - height) / radius))
    room = 2.0 * (radius - height) * math.sin(min(half, 0.5 * math.pi))
    base = draw.size(1e-9, max(0.95 * room, 1e-8), (0.1 * room, 0.6 * room))
    return c2d.GearWheel(
        grouser_count=draw.maybe_whole(0.8, count),
        grouser_height=draw.maybe(0.8, height),
        tip_thickness=draw.maybe(0.8, draw.size(1e-9, max(base, 1e-8), (0.3 * base, base))),
        base_thickness=draw.maybe(0.7, base),
        phase_fraction=draw.size_or_zero(1e-9, 1.0, (0.1, 1.0)),
    )


def drawn_chain(draw: Draw, outline: c2d.TrackOutline) -> c2d.SegmentalTrack:
    """Shoes that are short enough to go round the smallest disc."""
    radius = smallest_end(outline) - outline.grouser_height
    larger = max(radius for _, _, radius in outline.discs) - outline.grouser_height
    around = 2.0 * outline.axle_distance + 2.0 * math.pi * larger
    fewest = min(400, math.ceil(1.2 * around / min(2.0 * radius, 0.5 * outline.axle_distance)) + 1)
    sprocket = draw.random() < 0.5 and len(outline.discs) == 2
    return c2d.SegmentalTrack(
        shoe_count=draw.maybe_whole(0.9, draw.whole(fewest, 400, (fewest, min(400, fewest + 25)))),
        mechanism="sprocket" if sprocket else "guide",
        shoe_shape=draw.choice(("rectangle", "trapezoid")),
        plate_thickness=draw.maybe(0.4, draw.size(1e-4, min(1.0, radius), (1e-3, 1e-2))),
        pre_tension=draw.maybe(0.4, draw.size(1e-3, 1e6, (1.0, 100.0))),
        tensioner_stiffness=draw.maybe(0.4, draw.size(1e-3, 1e9, (1e2, 1e5))),
        tensioner_damping=draw.maybe(0.4, draw.size_or_zero(1e-9, 1e9, (1.0, 1e3))),
        pin_stiffness=draw.size_or_zero(1e-9, 1e9, (1e-2, 10.0)),
        pin_damping=draw.size_or_zero(1e-9, 1e9, (1e-4, 0.1)),
        road_wheel_count=draw.maybe_whole(0.4 * sprocket, draw.whole(0, 200, (0, 12))),
        return_roller_count=draw.maybe_whole(0.4 * sprocket, draw.whole(0, 200, (0, 6))),
    )


def drawn_track(draw: Draw, outline: c2d.TrackOutline, *, on_arm: bool = False) -> OpenTrack:
    """Any model, but no chain of shoes on an arm."""
    smallest, half = smallest_end(outline), 0.5 * outline.axle_distance
    radius = draw.size(1e-3, max(1e-3, 0.999 * smallest), (0.3 * smallest, 0.9 * smallest))
    given = draw.maybe(0.6, draw.size(1e-3, 100.0, (radius, radius)))
    wheel = drawn_wheel(draw, radius)

    def placed() -> Any:
        x, y = draw.signed(100.0, half), draw.signed(100.0, smallest)
        return x, y, draw.size(1e-3, 100.0, (radius, radius))

    def force() -> OpenTrack:
        friction = draw.size_or_zero(1e-12, 100.0, (0.05, 1.0))
        count = draw.whole(2, 200, (2, 9))
        support: Any = draw.choice(("skids", "wheels"))
        if len(outline.discs) > 2:
            support = "skids"
        return c2d.ForceTrack(support=support, skid_friction=friction, wheel_count=count)

    wheels: tuple[Callable[[], OpenTrack], ...] = (
        lambda: c2d.LineOfWheels(draw.whole(2, 200, (2, 12)), wheel_radius=given, wheel=wheel),
        lambda: c2d.CircumferentialWheels(
            draw.whole(3, 200, (6, 40)), wheel_radius=draw.maybe(0.7, radius), wheel=wheel
        ),
        lambda: c2d.HybridWheels(
            tuple(placed() for _ in range(draw.whole(1, 200, (2, 9)))), wheel=wheel
        ),
    )
    belts: tuple[Callable[[], OpenTrack], ...] = (
        lambda: c2d.BeltTrack(),  # noqa: PLW0108 - typed so
        lambda: c2d.GrouserBeltTrack(
            grouser_count=draw.maybe_whole(0.6, draw.whole(1, 200, (3, 40)))
        ),
    )
    of_robots: tuple[Callable[[], OpenTrack], ...] = (
        *(wheels[0], force),
        *(lambda: drawn_chain(draw, outline),) * 2,
    )
    models = (*wheels, *belts, *(() if on_arm else of_robots))
    if len(outline.discs) > 2:
        models = tuple(model for model in models if model is not wheels[0])
    return draw.choice(models)()


def drawn_flippers(
    draw: Draw, outline: c2d.TrackOutline, track: Track, mass: float
) -> c2d.Flippers:
    """Arms, with a force track exactly if the robot has one."""
    smallest, axles = smallest_end(outline), outline.axle_distance
    length = draw.size(1e-3, 100.0, (0.3 * axles, 0.9 * axles))
    low = min(100.0, max(1e-3, 1.001 * outline.grouser_height))
    root = draw.size(low, 100.0, (0.6 * smallest, smallest))
    tip = draw.size(
        max(low, root - 0.999 * length),
        max(low, min(100.0, root + 0.999 * length)),
        (0.5 * root, root),
    )
    own: Track | None = None
    if isinstance(track, c2d.ForceTrack):
        own = track if draw.random() < 0.3 else None
    elif isinstance(track, c2d.HybridWheels) or draw.random() < 0.5:
        arm = c2d.TrackOutline(
            axle_distance=length,
            front_radius=tip,
            rear_radius=root,
            grouser_height=outline.grouser_height,
            grouser_pitch=outline.grouser_pitch,
            grouser_thickness=outline.grouser_thickness,
        )
        own = drawn_track(draw, arm, on_arm=True)
    return c2d.Flippers(
        length=length,
        root_radius=root,
        tip_radius=tip,
        mass=draw.size(1e-3, max(1e-3, 0.2 * mass), (1e-3 * mass, 0.05 * mass)),
        ends=draw.choice(("front", "rear", "both")),
        angle=max(-6.3, min(6.3, draw.signed(6.3, 3.0))),
        rate_limit=draw.size(TINY, 100.0, (0.1, 7.0)),
        torque_limit=draw.size_or_zero(1e-12, 1e6, (0.05 * mass * axles, 50.0 * mass * axles)),
        rotor_inertia=draw.size_or_zero(1e-12, 1e3, (0.01 * mass, 0.1 * mass))
        if draw.random() < 0.3
        else 0.0,
        self_locking=draw.random() < 0.2,
        track=own,
    )


def drawn_belly(draw: Draw, outline: c2d.TrackOutline) -> list[tuple[float, float]] | None:
    """A polygon on an ellipse, or none."""
    if draw.random() < 0.4:
        return None
    half, radius = 0.5 * outline.axle_distance, smallest_end(outline)
    width = draw.size(1e-9, 99.0, (0.5 * half, half))
    height = draw.size(1e-9, 99.0, (0.2 * radius, 0.9 * radius))
    count, turn = draw.whole(3, 64, (4, 8)), draw.random()
    angles = [2.0 * math.pi * (i + turn) / count for i in range(count)]
    return [(width * math.cos(a), height * math.sin(a)) for a in angles]


def drawn_drivetrain(
    draw: Draw, size: tuple[float, float], *, sharing: Literal["track", "wheel"]
) -> c2d.Drivetrain:
    mass, radius = size
    torque, inertia = 10.0 * mass * radius, mass * radius**2
    most = draw.size_or_zero(1e-12, 1e6, (0.01 * torque, 5.0 * torque))
    motors: dict[str, Any] = {}
    if draw.random() < 0.3:
        motors["rotor_inertia"] = draw.size_or_zero(1e-12, 1e3, (0.01 * inertia, 30.0 * inertia))
    if draw.random() < 0.15:
        motors["no_load_speed"] = draw.size(TINY, 100.0, (0.2, 2.0))
    elif draw.random() < 0.15:
        fastest = draw.size(1e-3, 99.0, (0.2, 2.0))
        motors["torque_curve"] = ((0.0, most), (fastest, draw.random() * most), (100.0, 0.0))
    if draw.random() < 0.15:
        gain = draw.size(1e-12, 1e9, (0.1 * torque * radius, 100.0 * torque * radius))
        motors["controller"] = c2d.PI(gain, draw.size_or_zero(1e-12, 1e9, (gain, 30.0 * gain)))
    elif draw.random() < 0.15:
        motors["self_locking"] = True
    return c2d.Drivetrain(
        max_speed=draw.size(TINY, 100.0, (0.2, 2.0)),
        max_acceleration=draw.size(TINY, 1e6, (0.05, 20.0)),
        max_deceleration=draw.size(TINY, 1e6, (0.05, 20.0)),
        max_torque=most,
        torque_sharing=sharing,
        **motors,
    )


def drawn_robot(draw: Draw) -> c2d.Robot:
    """A robot that keeps most rules that join its fields."""
    outline = drawn_outline(draw)
    axles, radius = outline.axle_distance, max(radius for _, _, radius in outline.discs)
    mass = draw.size(2e-3, 1e6, (1.0, 400.0))
    track_mass = draw.size(1e-3, 0.99 * mass, (0.03 * mass, 0.3 * mass))
    least = 1.001 * track_mass * radius**2
    usual = (max(least, 0.3 * mass * axles**2), max(2.0 * least, mass * axles**2))
    track = drawn_track(draw, outline)
    wheels = isinstance(track, c2d.LineOfWheels | c2d.CircumferentialWheels | c2d.HybridWheels)
    flippers = None
    if draw.random() < 0.35:
        flippers = drawn_flippers(draw, outline, track, mass)
    of_wheels = (c2d.LineOfWheels, c2d.CircumferentialWheels, c2d.HybridWheels, type(None))
    own = flippers.track if flippers else None
    share = wheels and isinstance(own, of_wheels) and draw.random() < 0.5
    closed = draw.random() < 0.08
    return c2d.Robot(
        "drawn",
        mass=mass,
        center_of_mass=(draw.signed(100.0, 0.3 * axles), draw.signed(100.0, 0.3 * axles)),
        moment_of_inertia=draw.size(min(max(1e-9, least), 1e9), 1e9, usual),
        track_mass=track_mass,
        outline=outline,
        belly=drawn_belly(draw, outline),  # type: ignore[arg-type]
        flippers=flippers,
        gauge=draw.size(1e-3, 100.0, (0.5 * axles, axles)),
        drivetrain=drawn_drivetrain(draw, (mass, radius), sharing="wheel" if share else "track"),
        track=c2d.ClosedTrack(track, surface=draw.choice(("own", "smooth"))) if closed else track,
    )
