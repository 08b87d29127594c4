"""The report: Markdown from the results, for the screen, `out/` and docs/studies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from benches.peers import chains_report, machine, markdown
from benches.peers.accuracy import COST_SPAN
from benches.peers.engines import NAMES
from benches.peers.errors import JOINT_GAP, PATH, PENETRATION

Rows = list[dict[str, Any]]


def render(result: dict[str, Any]) -> str:
    """Write the report, also of unfinished results."""
    sections: dict[str, Callable[[Any], str]] = {
        "defaults": _defaults,
        "accuracy": _accuracy,
        "yardstick": _yardstick,
        "batches": _batches,
        "chains": chains_report.render,
    }
    parts = [_head(result)]
    parts += [write(result[name]) for name, write in sections.items() if name in result]
    parts.append(_LIMITS)
    return markdown.page(parts)


def parts(result: dict[str, Any]) -> dict[str, str]:
    """Write what the page has of the report, by name."""
    return {
        "measured": machine.sentence(result["machine"], result["wall"]),
        "speeds": _by_scene(result["accuracy"], _speed_cell),
    }


def speeds(rows: Rows) -> dict[str, dict[str, float]]:
    """Return the real-time factors at equal accuracy, by scene and engine."""
    found: dict[str, dict[str, float]] = {}
    for row in rows:
        factors = found.setdefault(row["scene"], {})
        if row["found"]:
            factors[row["engine"]] = 1.0 / row["per_second"]
    return found


def _speed_cell(row: dict[str, Any]) -> str:
    return f"{1.0 / row['per_second']:.0f}x" if row["found"] else "none"


def _head(result: dict[str, Any]) -> str:
    return f"""
# The same task in other engines

What `make bench-peers` measures. A robot of 20 kg with 0.6 m between its end axles drives at 0.4
m/s towards a step of 0.15 m, or over 20 blocks up to 0.15 m high, on a line of 5 wheels (`lwa5`) or
on 24 small ones all round (`cwa24`), round or with grousers (`gear`). The scenes are files in
`benches/peers/scenes` that do not depend on any engine; `tests/benches/test_peer_scenes.py` checks
that crawler2d's own form of them describes the same robots and grounds.

{machine.sentence(result["machine"], result["wall"])}

- Times are the shortest of several rounds in which all engines took turns, on one thread. *RTF*
  (real-time factor) is the simulated time divided by the wall time: at 100x, a simulated second
  costs 10 ms. crawler2d chooses the length of its steps by their accuracy, and has its one default
  accuracy throughout; the others take steps of a given length. Each engine runs the fastest loop
  that it offers from Python (rapier2d's is in Rust), nothing is recorded, and building the world
  does not count, except for crawler2d, where one call does everything.
- Errors come from recorded poses, sampled every 2 ms or every longer step, with the same geometry
  code for all engines. *Overlap* is the deepest overlap of any part with the ground, *gap* the
  widest opening of a pin.
- *Cleared* means that the rear axle got past the last edge, within 10 s (step) or 15 s (field).
- Every engine has a docstring in `benches/peers` that says how it was set up, and why.
"""


def _defaults(rows: Rows) -> str:
    titles = {
        "own": "At each engine's own time step",
        "common": "All others at steps of 2 ms, everything else at the defaults",
    }
    text = [
        "## At the engines' defaults",
        "These times come with very different errors: read each one together with its outcome."
        " Chipmunk's slop is scaled to metres, and sleeping is off; otherwise nothing would work."
        " Cells: RTF, outcome with the last x of the chassis [m], overlap / gap [mm].",
    ]
    for kind, title in titles.items():
        text.append(f"### {title}")
        chosen = [row for row in rows if row["kind"] == kind]
        settings = {row["engine"]: row["setting"] for row in chosen}
        text.append("; ".join(f"{name}: {setting}" for name, setting in settings.items()) + ".")
        text.append(_by_scene(chosen, _default_cell))
    return "\n\n".join(text)


def _default_cell(row: dict[str, Any]) -> str:
    return (
        f"{1.0 / row['per_second']:.0f}x<br>"
        f"{'cleared' if row['cleared'] else 'not'} ({row['final_x']:.2f})<br>"
        f"{_millimetres(row['penetration'])} / {_millimetres(row['gap'])}"
    )


def _accuracy(rows: Rows) -> str:
    return "\n\n".join(
        [
            "## At equal accuracy",
            f"""
For each scene and each other engine, the cheapest setting of a grid that keeps these limits; for
crawler2d its one default accuracy, if that keeps them. Overlap is at most
{_millimetres(PENETRATION)} mm, gaps are at most {_millimetres(JOINT_GAP)} mm, and the result agrees
with the engine's own converged one, its *limit*. The limit is its finest setting. Where its path
differs by at most {_millimetres(PATH)} mm from that of the next finest, coarser by a factor of two
in every respect (crawler2d: by four in accuracy, which makes its steps twice as long), the
setting's path must be as close to it, at equal times and in each of the first draws. Otherwise the
scene is *chaotic* for the engine: over all draws, the Wilson interval (95 %) of the
setting's rate of clearing must contain the rate of the limit. The draws of approach (over 50 mm),
speed and friction (2 % either way) are the same for all. Settings are tried in the order of their
cost over the first {COST_SPAN:g} s; `out/peers.json` lists all that were tried, and why they were
rejected. A robot that flies off counts as infinite overlap.

Cells: RTF, the setting; for chaotic scenes the rate of the setting; how far its paths
deviate from those of the limit in the first draws.
""".strip(),
            _by_scene(rows, _accuracy_cell),
            _standing(rows),
            """
The engines' limits: how far the two finest settings are apart [mm], how many runs cleared, last x
of the nominal run [m], overlap / gap [mm]. A chaotic scene is the *easier* case for the engine,
because no path has to be matched; an engine that converges has to match its path.
""".strip(),
            _by_scene(rows, _limit_cell),
        ]
    )


def _standing(rows: Rows) -> str:
    """Compare crawler2d with the fastest of the others, scene by scene."""
    lines = []
    for scene in dict.fromkeys(row["scene"] for row in rows):
        found = {
            row["engine"]: 1.0 / row["per_second"]
            for row in rows
            if row["scene"] == scene and row["found"]
        }
        own = found.pop("crawler2d", None)
        best = max(found, key=lambda name: found[name], default=None)
        if own is None:
            lines.append(f"- {scene}: the default of crawler2d does not keep the limits.")
        elif best is None:
            lines.append(f"- {scene}: crawler2d alone keeps the limits.")
        else:
            lines.append(
                f"- {scene}: crawler2d runs at {own / found[best]:.2f} times the speed of {best}."
            )
    return "\n".join(["Compared with the fastest of the others:", "", *lines])


def _accuracy_cell(row: dict[str, Any]) -> str:
    if row["found"] is None:
        return "none in the grid"
    last = row["tried"][-1]
    cell = f"**{1.0 / row['per_second']:.0f}x**<br>{row['setting']}"
    if "count" in last:
        cell += f"<br>{last['cleared']}/{last['count']}"
    return f"{cell}<br>{_millimetres(last['distance'])} mm off"


def _limit_cell(row: dict[str, Any]) -> str:
    limit = row["limit"]
    kind = "chaotic" if limit["is_chaotic"] else "converged"
    return (
        f"{kind}, {_millimetres(limit['spread'])}<br>"
        f"{limit['cleared']}/{limit['count']} ({limit['final_x']:.2f})<br>"
        f"{_millimetres(limit['penetration'])} / {_millimetres(limit['gap'])}"
    )


def _yardstick(rows: Rows) -> str:
    cases = list(rows[0]["per_second"])
    table = [
        [
            f"{row['robot']}, {row['terrain']}",
            *(f"{row['per_second'][case] * 1e3:.1f}" for case in cases),
            *(
                f"{row['per_second']['crawler2d gear'] / row['per_second'][bare]:.2f}"
                for bare in ("bare round", "bare round, tuned")
            ),
        ]
        for row in rows
    ]
    head = ["scene", *cases, "gear / bare round", "gear / bare round, tuned"]
    return "\n\n".join(
        [
            "## Grousers against round wheels in the bare engine",
            "The cost of crawler2d's gear wheels compared with round wheels on cuboids in a plain"
            " loop of rapier2d, in ms of wall time per simulated second. crawler2d has its default"
            " accuracy, the bare engine steps of 1 ms with 4 substeps, and its default tolerances"
            " or, where it says *tuned*, those suitable for grousers. `lwa3` is `lwa5` without"
            " its second and fourth wheel. The aim is a ratio of at most 1.25.",
            markdown.table(head, table),
        ]
    )


def _batches(rows: Rows) -> str:
    table = []
    for row in rows:
        rates = [f"{rate:,.0f}x" for rate in row.get("real_time", [])] or ["", ""]
        table.append(
            [row["scene"], row["engine"], str(row["worlds"]), *rates, f"{row['scaling']:.2f}"]
        )
    head = ["scene", "engine", "worlds", "RTF on one", "RTF on two", "scaling"]
    return "\n\n".join(
        [
            "## Batches",
            "Worlds with different draws: on one thread and on two, or one process and two (pymunk,"
            " Box2D, rapier2d). The other engines take steps of 1 ms, tuned. The RTF is that of all"
            " worlds together. *spin* is a loop that only counts: it shows what the machine itself"
            " gains at the same time.",
            markdown.table(head, table),
        ]
    )


_LIMITS = """
## What cannot be compared

- **Accuracy is measured against an engine's own limit.** No engine is taken as the truth here; the
  limits themselves differ, see the table of limits.
- **Mechanics.** crawler2d solves one body and the spins of its wheels: except in chains it has no
  pins that could open, and its wheels cannot shake on them. MuJoCo has no gaps either, but is a 3D
  engine constrained to the plane. Box2D works in single precision.
- **Chains.** pymunk's chain has teeth, lugs and play; crawler2d's drive has no teeth, and its guide
  has a tensioner. Apart from that, the robots are the same.
- **Additional work.** crawler2d's time includes building the model and monitoring for stops.
- **The grid is coarse**, with a factor of two between settings. A cheaper setting of the other
  engines may lie between its points, and costs that differ by less than the noise of a shared
  machine may change places.
- **Rates of few runs** have wide intervals: the rule for chaotic scenes only rejects gross errors.
"""


def _by_scene(rows: Rows, cell: Any) -> str:
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    cells = {(row["scene"], row["engine"]): cell(row) for row in rows}
    table = [[scene, *(cells.get((scene, name), "") for name in NAMES)] for scene in scenes]
    return markdown.table(["scene", *NAMES], table)


def _millimetres(length: float) -> str:
    value = length * 1e3
    return f"{value:.0f}" if value >= 100.0 else f"{value:.2g}" if value >= 0.01 else "0"
