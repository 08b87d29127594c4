"""The taut belt round discs from their support function, and touching round wheels inside it."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass

Discs = tuple[tuple[float, float, float], ...]


@dataclass(frozen=True)
class Hull:
    """Arcs of a belt in the direction of belt travel, from the rear end of its lower run."""

    discs: Discs
    arcs: tuple[tuple[int, float, float], ...]
    """Disc, direction at the start [rad] and how far it turns, clockwise."""
    length: float
    """[m] All the way round."""

    def bend(self, disc: int) -> float:
        """[rad] Angle by which the belt bends round a disc."""
        return sum(turn for which, _, turn in self.arcs if which == disc)

    def runs(self) -> list[float]:
        """[m] The straight runs, each behind its arc."""
        behind = (*self.arcs[1:], self.arcs[0])
        lengths = []
        for (a, start, turn), (b, *_) in zip(self.arcs, behind, strict=True):
            (ax, ay, _), (bx, by, _) = self.discs[a], self.discs[b]
            along = start - turn - 0.5 * math.pi
            lengths.append((bx - ax) * math.cos(along) + (by - ay) * math.sin(along))
        return lengths


@functools.lru_cache(maxsize=4096)
def hull_of(discs: Discs) -> Hull:
    """In each direction the belt lies on the disc that reaches farthest."""
    if len(discs) == 1:
        return Hull(discs, ((0, -0.5 * math.pi, 2.0 * math.pi),), 2.0 * math.pi * discs[0][2])
    turns = {0.0}
    for i, (x, y, radius) in enumerate(discs):
        for other_x, other_y, other in discs[:i]:
            apart = math.hypot(x - other_x, y - other_y)
            if apart > abs(radius - other):
                axis = math.atan2(y - other_y, x - other_x)
                half = math.acos((other - radius) / apart)
                turns |= {(axis + half) % (2.0 * math.pi), (axis - half) % (2.0 * math.pi)}
    ordered = sorted(turns)
    arcs: list[tuple[int, float, float]] = []  # counter-clockwise
    for low, high in zip(ordered, (*ordered[1:], ordered[0] + 2.0 * math.pi), strict=True):
        middle = 0.5 * (low + high)
        c, s = math.cos(middle), math.sin(middle)
        disc = max(range(len(discs)), key=lambda i: discs[i][0] * c + discs[i][1] * s + discs[i][2])
        if arcs and arcs[-1][0] == disc:
            arcs[-1] = (disc, arcs[-1][1], high)
        else:
            arcs.append((disc, low, high))
    if len(arcs) > 1 and arcs[0][0] == arcs[-1][0]:
        arcs[0] = (arcs[0][0], arcs.pop()[1] - 2.0 * math.pi, arcs[0][2])
    length = sum(
        discs[i][2] * (high - low)
        + discs[i][0] * (math.sin(high) - math.sin(low))
        - discs[i][1] * (math.cos(high) - math.cos(low))
        for i, low, high in arcs
    )
    clockwise = [(disc, high, high - low) for disc, low, high in reversed(arcs)]
    # Behind the lower run, whose outward direction is nearest to straight down, the walk begins.
    lower = min(range(len(clockwise)), key=lambda k: math.sin(clockwise[k][1] - clockwise[k][2]))
    start = (lower + 1) % len(clockwise)
    return Hull(discs, (*clockwise[start:], *clockwise[:start]), length)


def grown(discs: Discs, by: float) -> Discs:
    """The same discs with other radii."""
    return tuple((x, y, radius + by) for x, y, radius in discs)


class Walk:
    """Steps of one straight distance along a hull."""

    def __init__(self, hull: Hull) -> None:
        # Pieces: length, and place and direction at their start, with their curvature.
        self.pieces: list[tuple[float, float, float, float, float]] = []
        runs = hull.runs() if len(hull.arcs) > 1 else [0.0]
        for (i, start, turn), run in zip(hull.arcs, runs, strict=True):
            x, y, radius = hull.discs[i]
            self.pieces.append((radius * turn, x, y, start, radius))
            end = start - turn
            at = (x + radius * math.cos(end), y + radius * math.sin(end))
            self.pieces.append((run, *at, end - 0.5 * math.pi, -1.0))
        self.length = sum(piece[0] for piece in self.pieces)

    def place(self, piece: int, along: float) -> tuple[float, float]:
        """[m] A point on a piece."""
        _, x, y, angle, radius = self.pieces[piece]
        if radius < 0.0:
            return x + along * math.cos(angle), y + along * math.sin(angle)
        turned = angle - (along / radius if radius > 0.0 else 0.0)
        return x + radius * math.cos(turned), y + radius * math.sin(turned)

    def spread(self, count: int) -> list[tuple[float, float]]:
        """[m] Points that divide its length evenly."""
        places, piece, before = [], 0, 0.0
        for k in range(count):
            at = self.length * k / count
            while at > before + self.pieces[piece][0] and piece + 1 < len(self.pieces):
                before += self.pieces[piece][0]
                piece += 1
            places.append(self.place(piece, at - before))
        return places

    def farther(self, distance: float, count: int) -> float:
        """[m] Length of a number of steps, each to the next point at this distance."""
        piece, along, gone = 0, 0.0, 0.0
        for _ in range(count):
            start = self.place(piece, along)
            for _ in self.pieces:
                to_x, to_y = self.place(piece, self.pieces[piece][0])
                if math.hypot(to_x - start[0], to_y - start[1]) >= distance:
                    break
                gone += self.pieces[piece][0] - along
                piece, along = (piece + 1) % len(self.pieces), 0.0
            else:
                return math.inf
            next_ = min(max(self._at(piece, start, distance), along), self.pieces[piece][0])
            gone, along = gone + next_ - along, next_
        return gone

    def _at(self, piece: int, start: tuple[float, float], distance: float) -> float:
        """[m] Position on a piece at this distance from a point behind it."""
        _, x, y, angle, radius = self.pieces[piece]
        x, y = x - start[0], y - start[1]
        if radius < 0.0:
            along = x * math.cos(angle) + y * math.sin(angle)
            return math.sqrt(max(0.0, along**2 - x * x - y * y + distance**2)) - along
        apart = math.hypot(x, y)
        cosine = (apart**2 + radius**2 - distance**2) / (2.0 * apart * radius)
        turned = math.atan2(-y, -x) - math.acos(min(1.0, max(-1.0, cosine)))
        turn = (angle - turned) % (2.0 * math.pi)
        return 0.0 if turn > 2.0 * math.pi - 1e-9 else radius * turn


def _overlap(discs: Discs, count: int, radius: float) -> float:
    """[m] Excess length of a number of touching wheels inside a belt."""
    walk = Walk(hull_of(grown(discs, -radius)))
    return walk.farther(2.0 * radius, count) - walk.length


@functools.lru_cache(maxsize=4096)
def tight_room(discs: Discs, count: int) -> float:
    """[m] The same with the largest wheels: those of half the smallest radius."""
    return _overlap(discs, count, 0.5 * min(disc[2] for disc in discs))


@functools.lru_cache(maxsize=4096)
def tight_radius(discs: Discs, count: int) -> float:
    """[m] Radius of wheels that touch each other and the belt all the way round."""
    low, high = 0.0, 0.5 * min(disc[2] for disc in discs)
    below, above = -hull_of(discs).length, tight_room(discs, count)
    for _ in range(60):
        # A secant, unless that hardly narrows the interval.
        middle = low + (high - low) * min(0.98, max(0.02, -below / (above - below)))
        overlap = _overlap(discs, count, middle)
        if overlap < 0.0:
            low, below = middle, overlap
            above *= 0.5
        else:
            high, above = middle, overlap
            below *= 0.5
        if high - low < 1e-13 * high or overlap == 0.0:
            break
    return high
