"""The report of the study: Markdown from the results."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from benches.peers import machine, markdown
from benches.scaling.scenes import BLOCKS, CUT, FLAT, LEVEL, STEP
from benches.scaling.slopes import Curve, curves, deviations

AIM = 1.3
"""[-] Largest cost of flat ground in the most pieces, relative to ground in one piece."""


def render(result: dict[str, Any]) -> str:
    """Write the report."""
    rows = result["rows"]
    return markdown.page(
        [
            _head(result),
            _WHEELS,
            _exponents(curves(rows, "wheels"), (FLAT, STEP)),
            _stopped(rows),
            _WHEELS_MEAN,
            _GROUSERS,
            _exponents(curves(rows, "grousers"), (FLAT, STEP)),
            _POINTS,
            _exponents(curves(rows, "points"), (CUT, BLOCKS)),
            _ratios(rows),
            _POINTS_MEAN,
            _THREADS,
            _speed_ups(result["threads"]),
            _ACCURACIES,
            _accuracies(rows),
        ]
    )


def parts(result: dict[str, Any]) -> dict[str, str]:
    """Write what the page has of the report, by name."""
    return {
        "measured": machine.sentence(result["machine"], result["wall"]),
        "wheels": _exponents(curves(result["rows"], "wheels"), (FLAT, STEP)),
    }


def _head(result: dict[str, Any]) -> str:
    return f"""
# What a simulated second costs, and how the cost grows

What `make bench-scaling` measures. The robot is always the Servosila Engineer without flippers. It
drives at 0.4 m/s over flat ground (4 m, 11 s) or over a step of 50 mm (6 s); one number grows along
each curve. Runs do not end at a goal or a stop: all runs of a panel take the same simulated time.
`python -m benches.scaling --quick` tries everything in half a minute.

{machine.sentence(result["machine"], result["wall"])}

- *The cost* is the wall time of `Simulation.advance` divided by the simulated time: reading the
  scenario and building the model do not count, and nothing is recorded. The solver's settings are
  the defaults; it takes steps as long as its accuracy allows.
- Each time is the shortest of several rounds in which all points of a panel took turns, on one
  thread.
- An *exponent* is the slope of a curve on logarithmic scales: 0 costs the same, 1 grows in
  proportion. The first exponent is fitted to all points, the second is the one between the last
  two.
"""


_WHEELS = """
## Wheels

![Cost against the number of wheels](scaling/wheels.svg)

Only the number changes: wheels of a line keep the outline's radius of 64 mm and overlap if there
are 4 or more; circumferential wheels keep a radius of 16 mm, are spaced equally and overlap if
there are 33 or more. Three circumferential wheels only just carry the robot: two of them stand on
the ground.
"""

_WHEELS_MEAN = """
- The cost grows roughly in proportion to the number of wheels that carry load: all of a line, the
  lower third of circumferential ones. Wheels in the air are skipped quickly.
- Where many grousers carry load at the same time, as in a line of 96 gear wheels, the solver takes
  longer to find which of them stick.
"""

_GROUSERS = """
## Grousers

![Cost against the number of grousers](scaling/grousers.svg)

Gear wheels only: a line of 3, and 24 circumferential ones of 16 mm with tips 1 mm thick, so that 48
grousers fit on them. Only grousers near the ground are checked, but the more there are, the more of
them carry load at the same time.
"""

_POINTS = """
## Pieces of the ground

![Cost against the pieces of the ground](scaling/points.svg)

Ground 6 m long, cut into pieces of equal length, with random heights of all their ends within 0.1
um up and down: points that are level to within 1 nm would be joined into one straight piece.
100,000 pieces are 0.06 mm long each. The blocks are 0.2 m long and up to 30 mm high, and their tops
are cut in the same way. Runs of 2 s; the first point is uncut ground.
"""

_POINTS_MEAN = """
- Finding contacts is a small part of the cost: a hierarchy leads to the pieces that face a wheel
  and, below a belt, to those that rise above the chord between its first and last contact. Level
  pieces are joined when the scenario is read.
- The expensive part is that the contacts change: with a few pieces passed in each step, different
  corners carry load each time, and the solver has to find anew which contacts are open, stick or
  slide; its steps become shorter, too.
- Between two grousers, flat ground reaches up to 2.6 mm into the taut belt round gear wheels.
  Whenever the monitor looks for ground inside the track, it visits all the pieces there.
"""

_THREADS = """
## Threads

![Speed-up against threads](scaling/threads.svg)

`simulate_many` with 64 lines of 3 gear wheels over the step, from the scenarios to the runs. For
comparison, loops that only count, one process per core: they show what the machine itself gains at
the same time. If these gain little either, other jobs were using the cores.
"""

_ACCURACIES = """
## Accuracy

![Cost and error against the accuracy of the solver](scaling/accuracy.svg)

A line of 3 gear wheels. The accuracy limits the local error of each step. How far the robot is off
at the end is another matter: the table compares its final x with that at the finest accuracy.
"""


def _exponents(drawn: Sequence[Curve], panels: tuple[str, str]) -> str:
    """Write the ends and the exponents of the curves, both panels side by side."""
    found = {(curve.panel, curve.name): curve for curve in drawn}
    table = [
        [name, *(_ends(found.get((panel, name))) for panel in panels)]
        for name in dict.fromkeys(curve.name for curve in drawn)
    ]
    cells = "ms per simulated second at the first and last point; exponent over all, the last two"
    return f"Cells: {cells}.\n\n" + markdown.table(["curve", *panels], table)


def _ends(curve: Curve | None) -> str:
    if curve is None:
        return ""
    first, last = curve.per_second[0] * 1e3, curve.per_second[-1] * 1e3
    return f"{_short(first)} to {_short(last)}; {curve.slope:.2f}, {curve.last_slope:.2f}"


def _stopped(rows: Sequence[dict[str, Any]]) -> str:
    """Name the robots that the step stops; their cost is that of a stopped robot."""
    held: dict[str, list[str]] = {}
    for row in rows:
        if row["figure"] == "wheels" and row["panel"] == STEP and row["final_x"] < 0.0:
            held.setdefault(row["curve"], []).append(f"{row['x']:g}")
    names = [f"{curve}, {', '.join(counts)}" for curve, counts in held.items()]
    return f"Still in front of the step at the end: {'; '.join(names) or 'none'}."


def _ratios(rows: Sequence[dict[str, Any]]) -> str:
    """Compare the finest cuts of flat ground with ground in one piece."""
    own = {(row["curve"], row["x"]): row["per_second"] for row in rows if row["panel"] == CUT}
    most = max(x for _, x in own)
    names = [name for name, x in own if x == 1]
    endings = {"level": f", {LEVEL}", "rough": ""}
    cuts = {kind: end for kind, end in endings.items() if (names[0] + end, most) in own}
    table = []
    for name in names:
        whole, costs = own[name, 1], [own[name + end, most] for end in cuts.values()]
        ratios = [f"{cost / whole:.2f}" for cost in costs]
        table.append([name, *(_short(cost * 1e3) for cost in (whole, *costs)), *ratios])
    head = ["track", "whole", *cuts, *(f"{kind} / whole" for kind in cuts)]
    text = f"""
Flat ground in {most:,} pieces, ms per simulated second: *level* means pieces of equal height,
*rough* those of the figure. The aim is a ratio of at most {AIM}.
"""
    return text + "\n" + markdown.table(head, table)


def _speed_ups(rows: Sequence[dict[str, Any]]) -> str:
    table = [
        [
            str(row["threads"]),
            f"{row['real_time']:,.0f}x",
            f"{row['worlds']:.2f}",
            f"{row['loops']:.2f}",
        ]
        for row in rows
    ]
    return markdown.table(["threads", "real time", "speed-up", "of a loop that counts"], table)


def _accuracies(rows: Sequence[dict[str, Any]]) -> str:
    drawn = curves(rows, "accuracy")
    off = [["", *(f"{1e3 * way:.2g}" for way in deviations(rows, curve))] for curve in drawn]
    table = [
        [
            f"{accuracy * 1e6:g}",
            *(_short(curve.per_second[i] * 1e3) for curve in drawn),
            *(own[i] for own in off),
        ]
        for i, accuracy in enumerate(drawn[0].x)
    ]
    panels = [curve.panel for curve in drawn]
    head = ["accuracy [um]", *(f"{panel}, ms a simulated second" for panel in panels)]
    return markdown.table([*head, *(f"{panel}, mm off" for panel in panels)], table)


def _short(value: float) -> str:
    return f"{value:,.0f}" if value >= 100.0 else f"{value:.3g}"
