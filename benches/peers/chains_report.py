"""The part of the report that is about chains of shoes."""

from __future__ import annotations

from typing import Any

from benches.peers import machine, markdown

Rows = list[dict[str, Any]]

# [ms] Largest time for a simulated second, and the better aim.
_AIMS = {
    "belt with grousers": (18, 10),
    "22 shoes": (50, 35),
    "44 shoes": (95, 75),
    "22 shoes, sprocket": (65, 65),
}


def render(result: dict[str, Any]) -> str:
    """Write the section from its results."""
    return "\n\n".join(
        [
            "## A chain of shoes",
            """
A robot of 20 kg on a chain, defined in `benches/peers/chain_robot.py`. In pymunk it has shoes on
pivot joints round two sprockets with teeth, carried by the hull and two discs; in crawler2d it is a
`SegmentalTrack` with the same number of shoes on the same outline, with the same weights, torque
and friction, on its guide with a tensioner. The pitch follows from the numbers of shoes and teeth.
{machine}
""".strip().format(machine=machine.sentence(result["machine"], result["wall"])),
            _side_by_side(result["side_by_side"]),
            _equal_gaps(result["equal_gaps"]),
            _engineer(result["engineer"]),
        ]
    )


def _side_by_side(rows: Rows) -> str:
    engines = list(dict.fromkeys(row["engine"] for row in rows))
    cells = {(row["shoes"], row["terrain"], row["engine"]): _cell(row) for row in rows}
    places = dict.fromkeys((row["shoes"], row["terrain"]) for row in rows)
    table = [
        [f"{shoes}, {terrain}", *(cells[shoes, terrain, engine] for engine in engines)]
        for shoes, terrain in places
    ]
    return "\n\n".join(
        [
            "### Side by side",
            "pymunk with steps of 1 ms and 10 iterations, at its defaults and tuned, crawler2d at"
            " its default accuracy; the time is the lower quartile over blocks of half a second,"
            " and the shortest of several rounds. Cells: wall time of a simulated second; widest"
            " gap of a pin, and how many of three starts kept the chain on; how far the chassis"
            " got and, on flat ground, the error of its mean speed; how far the path deviates from"
            " the one with steps half as long (crawler2d: with a quarter of the accuracy).",
            markdown.table(["shoes, ground", *engines], table),
            _standing(rows),
        ]
    )


def _standing(rows: Rows) -> str:
    """Compare crawler2d with pymunk at its defaults."""
    cells = {(row["shoes"], row["terrain"], row["engine"]): row for row in rows}
    pairs = [
        (own, cells[shoes, terrain, "pymunk, defaults"])
        for (shoes, terrain, engine), own in cells.items()
        if engine == "crawler2d"
    ]
    figures = {
        name: [own[name] / theirs[name] for own, theirs in pairs]
        for name in ("per_second", "gap", "distance")
    }
    dearer, tighter, nearer = figures["per_second"], figures["gap"], figures["distance"]
    return (
        f"Compared with pymunk at its defaults, crawler2d costs {min(dearer):.1f} to"
        f" {max(dearer):.1f} times as much; its pins open {1.0 / max(tighter):.0f} to"
        f" {1.0 / min(tighter):.0f} times less, and halving the steps changes its path"
        f" {1.0 / max(nearer):.1f} to {1.0 / min(nearer):.0f} times less."
    )


def _cell(row: dict[str, Any]) -> str:
    speed = f", {100.0 * row['speed_error']:+.1f} %" if row["terrain"] == "flat" else ""
    return (
        f"**{row['per_second'] * 1e3:.1f} ms**<br>"
        f"{_millimetres(row['gap'])} mm, {row['survived']}/{row['count']}<br>"
        f"{row['distance_gone']:.2f} m{speed}<br>"
        f"{_millimetres(row['distance'])} mm off"
    )


def _equal_gaps(rows: Rows) -> str:
    table = []
    for row in rows:
        own = row["per_second"]["crawler2d"]
        table.append(
            [
                f"{row['shoes']}, {row['terrain']}",
                f"{_millimetres(row['gap'])} mm<br>{1e3 * own:.1f} ms",
                _found(row, "allowed", own),
                _found(row, "own", own),
            ]
        )
    return "\n\n".join(
        [
            "### At equal gaps",
            "The cheapest setting of a grid (steps of 2 to 0.125 ms, 10 to 160 iterations, tuned or"
            " not) with which, over three starts, no pin in pymunk opens wider than the 0.2 mm that"
            " the other scenes allow, or than crawler2d's pins at its defaults. The cells have the"
            " cost of a simulated second, and how many times that of crawler2d it is.",
            markdown.table(
                ["shoes, ground", "crawler2d", "pymunk, 0.2 mm", "pymunk, as crawler2d"], table
            ),
        ]
    )


def _found(row: dict[str, Any], aim: str, own: float) -> str:
    if aim not in row["found"]:
        setting, gap = row["finest"]
        return f"none in the grid: {_millimetres(gap)} mm at {setting}"
    cost = row["per_second"][aim]
    return f"{row['found'][aim]}<br>{1e3 * cost:.1f} ms, **{cost / own:.2g} times**"


def _engineer(rows: Rows) -> str:
    grounds = list(dict.fromkeys(row["terrain"] for row in rows))
    times = {(row["track"], row["terrain"]): row["per_second"] for row in rows}
    table = []
    for track in dict.fromkeys(row["track"] for row in rows):
        own = [times[track, ground] for ground in grounds]
        must, should = _AIMS[track]
        most = max(own)
        aim = f"{must}, better {should}" if should < must else f"{must}"
        is_better = should < must and most <= 1e-3 * should
        is_met = "no" if most > 1e-3 * must else "yes, the better" if is_better else "yes"
        times_of = (f"{1e3 * time:.1f}" for time in own)
        table.append([track, *times_of, aim, is_met])
    return "\n\n".join(
        [
            "### The Engineer's own tracks",
            "crawler2d alone, at its default accuracy: wall time of a simulated second [ms],"
            " measured as above. The aims were set before the models were written, from trials with"
            " a general engine at steps of 1 ms.",
            markdown.table(["track", *grounds, "aim", "met"], table),
        ]
    )


def _millimetres(length: float) -> str:
    value = 1e3 * length
    return f"{value:.0f}" if value >= 100.0 else f"{value:.2g}"
