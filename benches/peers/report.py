"""The parts of the report, some of which docs/studies/peers.md shows."""

from typing import Any

from benches.adapters.planar import ENGINES
from benches.shared.measuring import millimetres, sentence
from research.tables import group_by, table

Rows = list[dict[str, Any]]


def render(result: dict[str, Any]) -> dict[str, str]:
    """Return the parts by name, also of unfinished results."""
    parts = {"measured": sentence(result["machine"], result["wall"])}
    for kind in ("own", "common") if "defaults" in result else ():
        rows = [row for row in result["defaults"] if row["kind"] == kind]
        settings = {row["engine"]: row["setting"] for row in rows}
        line = "; ".join(f"{name}: {setting}" for name, setting in settings.items())
        parts[f"{kind} steps"] = f"{line}.\n\n{_DEFAULTS}\n\n{_by_scene(rows, _default_cell)}"
    if "accuracy" in result:
        rows = result["accuracy"]
        parts["speeds"] = _by_scene(rows, _speed_cell)
        cells = _by_scene(rows, _accuracy_cell)
        parts["equal accuracy"] = f"{_ACCURACY}\n\n{cells}\n\n{_standing(rows)}"
        parts["limits"] = f"{_ENGINE_LIMITS}\n\n{_by_scene(rows, _limit_cell)}"
    if "yardstick" in result:
        parts["yardstick"] = _yardstick(result["yardstick"])
    if "batches" in result:
        parts["batches"] = _batches(result["batches"])
    return parts | (chain_parts(result["chains"]) if "chains" in result else {})


_DEFAULTS = (
    "Cells: real-time factor; whether it cleared, with the last x of the chassis [m]; overlap / gap"
    " [mm]."
)
_ACCURACY = (
    "Cells: real-time factor; the setting; for chaotic scenes the rate of the setting; how far its"
    " paths deviate from those of the limit in the first draws."
)
_ENGINE_LIMITS = (
    "Cells: how far the two finest settings are apart [mm]; how many runs cleared, with the last x"
    " of the nominal run [m]; overlap / gap [mm]."
)
_SIDE_BY_SIDE = (
    "Cells: wall time of a simulated second; widest gap of a pin, and how many of the starts kept"
    " the chain on; how far the chassis got and, on flat ground, the error of its mean speed; how"
    " far the path deviates from the one with steps half as long (crawler2d: with a quarter of the"
    " accuracy)."
)
_EQUAL_GAPS = (
    "The cheapest setting of a grid with which no pin in pymunk opens wider than 0.2 mm, or than"
    " crawler2d's. Cells: cost of a simulated second, and how many times that of crawler2d it is."
)


def speeds(rows: Rows) -> dict[str, dict[str, float]]:
    """Return the real-time factors at equal accuracy, by scene and engine."""
    return {
        scene: {row["engine"]: 1.0 / row["per_second"] for row in own if row["found"]}
        for scene, own in group_by(rows, "scene").items()
    }


def _speed_cell(row: dict[str, Any]) -> str:
    return f"{1.0 / row['per_second']:.0f}x" if row["found"] else "none"


def _default_cell(row: dict[str, Any]) -> str:
    return (
        f"{1.0 / row['per_second']:.0f}x<br>"
        f"{'cleared' if row['cleared'] else 'not'} ({row['final_x']:.2f})<br>"
        f"{_short(row['penetration'])} / {_short(row['gap'])}"
    )


def _standing(rows: Rows) -> str:
    """Compare crawler2d with the fastest of the others, scene by scene."""
    lines = []
    for scene, found in speeds(rows).items():
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
    return f"{cell}<br>{_short(last['distance'])} mm off"


def _limit_cell(row: dict[str, Any]) -> str:
    limit = row["limit"]
    kind = "chaotic" if limit["is_chaotic"] else "converged"
    return (
        f"{kind}, {_short(limit['spread'])}<br>"
        f"{limit['cleared']}/{limit['count']} ({limit['final_x']:.2f})<br>"
        f"{_short(limit['penetration'])} / {_short(limit['gap'])}"
    )


def _yardstick(rows: Rows) -> str:
    return table(
        {"scene": f"{row['robot']}, {row['terrain']}"}
        | {case: f"{cost * 1e3:.1f}" for case, cost in row["per_second"].items()}
        | {
            f"gear / {bare}": f"{row['per_second']['crawler2d gear'] / row['per_second'][bare]:.2f}"
            for bare in ("bare round", "bare round, tuned")
        }
        for row in rows
    )


def _batches(rows: Rows) -> str:
    written = []
    for row in rows:
        one, two = [f"{rate:,.0f}x" for rate in row.get("real_time", [])] or ["", ""]
        written.append(
            {
                "scene": row["scene"],
                "engine": row["engine"],
                "worlds": str(row["worlds"]),
                "RTF on one": one,
                "RTF on two": two,
                "scaling": f"{row['scaling']:.2f}",
            }
        )
    return table(written)


def _short(length: float) -> str:
    return millimetres(length, 0.01)


def _by_scene(rows: Rows, cell: Any) -> str:
    return table(
        {"scene": scene} | dict.fromkeys(ENGINES, "") | {row["engine"]: cell(row) for row in own}
        for scene, own in group_by(rows, "scene").items()
    )


# [ms] Largest time per simulated second, and a better target.
_AIMS = {
    "belt with grousers": (18, 10),
    "22 shoes": (50, 35),
    "44 shoes": (95, 75),
    "22 shoes, sprocket": (65, 65),
}


def chain_parts(result: dict[str, Any]) -> dict[str, str]:
    """Return the parts about chains of shoes."""
    rows = result["side_by_side"]
    return {
        "chains": sentence(result["machine"], result["wall"]),
        "side by side": f"{_SIDE_BY_SIDE}\n\n{_side_by_side(rows)}\n\n{_chain_standing(rows)}",
        "equal gaps": f"{_EQUAL_GAPS}\n\n{_equal_gaps(result['equal_gaps'])}",
        "own tracks": _engineer(result["engineer"]),
    }


def _side_by_side(rows: Rows) -> str:
    return table(
        {"shoes, ground": f"{shoes}, {terrain}"} | {row["engine"]: _chain_cell(row) for row in own}
        for (shoes, terrain), own in group_by(rows, "shoes", "terrain").items()
    )


def _chain_standing(rows: Rows) -> str:
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


def _chain_cell(row: dict[str, Any]) -> str:
    speed = f", {100.0 * row['speed_error']:+.1f} %" if row["terrain"] == "flat" else ""
    return (
        f"**{row['per_second'] * 1e3:.1f} ms**<br>"
        f"{millimetres(row['gap'])} mm, {row['survived']}/{row['count']}<br>"
        f"{row['distance_gone']:.2f} m{speed}<br>"
        f"{millimetres(row['distance'])} mm off"
    )


def _equal_gaps(rows: Rows) -> str:
    return table(
        {
            "shoes, ground": f"{row['shoes']}, {row['terrain']}",
            "crawler2d": f"{millimetres(row['gap'])} mm"
            f"<br>{1e3 * row['per_second']['crawler2d']:.1f} ms",
            "pymunk, 0.2 mm": _equal_gap_cell(row, "allowed"),
            "pymunk, same as crawler2d": _equal_gap_cell(row, "own"),
        }
        for row in rows
    )


def _equal_gap_cell(row: dict[str, Any], aim: str) -> str:
    if aim not in row["found"]:
        setting, gap = row["finest"]
        return f"none in the grid: {millimetres(gap)} mm at {setting}"
    cost, own = row["per_second"][aim], row["per_second"]["crawler2d"]
    return f"{row['found'][aim]}<br>{1e3 * cost:.1f} ms, **{cost / own:.2g} times**"


def _engineer(rows: Rows) -> str:
    written = []
    for track, own in group_by(rows, "track").items():
        must, should = _AIMS[track]
        most = max(row["per_second"] for row in own)
        is_better = should < must and most <= 1e-3 * should
        written.append(
            {"track": track}
            | {row["terrain"]: f"{1e3 * row['per_second']:.1f}" for row in own}
            | {
                "aim": f"{must}, better {should}" if should < must else f"{must}",
                "met": "no" if most > 1e-3 * must else "yes, the better" if is_better else "yes",
            }
        )
    return table(written)
