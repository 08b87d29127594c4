"""Run the benchmark; it writes progress to stderr, the report to `out/`, and its page and picture.

Usage, from the repository root: ``python -m benches.peers [--quick] [--sections SECTION ...]``.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from benches.peers import accuracy, chains, dots, machine, report, scenes, sections
from benches.peers.accuracy import Effort
from benches.peers.batches import batches
from benches.peers.engine import Setting
from benches.peers.engines import NAMES, engine, engines
from benches.peers.timing import interleaved, progress
from research.markdown import spliced

_ROOT = Path(__file__).parents[2]
_RESULT = _ROOT / "out" / "peers.json"
_PAGE = _ROOT / "docs" / "studies" / "peers.md"
_REPEATS = 5
_WORLDS = 8
_ENSEMBLE = 12
_SHOES = (22, 36, 44)
_SECTIONS = ("defaults", "yardstick", "batches", "accuracy", "chains")


def main() -> None:
    """Parse the arguments and run."""
    parser = argparse.ArgumentParser(prog="python -m benches.peers", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two scenes, and no report")
    parser.add_argument(
        "--scenes",
        nargs="+",
        choices=scenes.NAMES,
        default=scenes.NAMES,
        metavar="SCENE",
        help="only these scenes, and no report",
    )
    parser.add_argument(
        "--sections",
        nargs="+",
        choices=_SECTIONS,
        default=_SECTIONS,
        metavar="SECTION",
        help=f"only these sections; the others stay as they are: {', '.join(_SECTIONS)}",
    )
    parser.add_argument("--render", action="store_true", help="only write the report again")
    arguments = parser.parse_args()
    path = _RESULT.with_stem("peers-quick") if arguments.quick else _RESULT
    is_whole = arguments.quick or set(arguments.sections) == set(_SECTIONS)
    if arguments.render or not is_whole:
        _refuse_without_a_run(parser, path)
    if not arguments.render:
        result = _begun() if is_whole else json.loads(path.read_text(encoding="utf-8"))
        start = time.perf_counter()
        for section in quick() if arguments.quick else full(arguments.scenes, arguments.sections):
            result |= section
            if is_whole:
                result["wall"] = time.perf_counter() - start
            path.parent.mkdir(exist_ok=True)
            path.write_text(json.dumps(result, indent=1) + "\n", encoding="utf-8")
    result = json.loads(path.read_text(encoding="utf-8"))
    text = report.render(result)
    sys.stdout.write(text)
    path.with_suffix(".md").write_text(text, encoding="utf-8", newline="\n")
    if not arguments.quick and arguments.scenes == scenes.NAMES:
        page = spliced(_PAGE.read_text(encoding="utf-8"), report.parts(result))
        _PAGE.write_text(page, encoding="utf-8", newline="\n")
        factors = report.speeds(result["accuracy"])
        dots.draw(factors, "simulated time / wall time", _PAGE.with_suffix(".svg"), scale="log")


def _refuse_without_a_run(parser: argparse.ArgumentParser, path: Path) -> None:
    """End before anything is measured if the report would lack what only a whole run brings."""
    found = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    missing = [name for name in ("machine", "wall") if name not in found]
    if missing:
        parser.error(
            f"--sections and --render change a report: {path} must hold a whole run, "
            f"and lacks {' and '.join(missing)}; run once without them"
        )


def quick() -> Iterator[dict[str, Any]]:
    """Run everything on a small scale, in less than a minute."""
    names = ["lwa5-round-step", "lwa5-gear-step"]
    yield {"defaults": sections.defaults(names, engines(), 1)}
    yield {"yardstick": sections.yardstick(["lwa3", "lwa5"], ["step"], 2)}
    yield {"chains": of_chains([22], ["flat"], 1, chains.GRID[10:14])}
    yield {"batches": batches(["lwa3-gear-step"], scenes.draws(2), NAMES, 1)}
    yield {"accuracy": equal_accuracy(names[0], Effort(1, 4, 0.9e-3), 1)}


def full(names: Sequence[str], chosen: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Run the chosen sections; `names` are the scenes for the first two sections."""
    robots, terrains = ["lwa3", "lwa5", "cwa24"], ["step", "field"]
    lines = ["lwa5-gear-step", "lwa3-gear-step"]
    if "chains" in chosen:
        yield {"chains": of_chains(_SHOES, chains.TERRAINS, _REPEATS)}
    if "defaults" in chosen:
        yield {"defaults": sections.defaults(names, engines(), _REPEATS)}
    if "yardstick" in chosen:
        yield {"yardstick": sections.yardstick(robots, terrains, _REPEATS)}
    if "batches" in chosen:
        yield {"batches": batches(lines, scenes.draws(_WORLDS), NAMES, 3)}
    rows: list[dict[str, Any]] = []
    for name in names if "accuracy" in chosen else ():
        rows += equal_accuracy(name, Effort(3, _ENSEMBLE), _REPEATS)
        yield {"accuracy": rows}


def of_chains(
    counts: Sequence[int],
    terrains: Sequence[str],
    repeats: int,
    grid: Sequence[Setting] = chains.GRID,
) -> dict[str, Any]:
    """Run the section on chains; it names its own machine, because it can be run alone."""
    versions = {name: engine(name).version for name in ("pymunk", "crawler2d")}
    found: dict[str, Any] = {"machine": machine.describe(versions)}
    start = time.perf_counter()
    found["side_by_side"] = chains.side_by_side(counts, terrains, repeats)
    found["engineer"] = chains.engineer(repeats)
    found["equal_gaps"] = chains.equal_gaps(counts, terrains, grid)
    return found | {"wall": time.perf_counter() - start}


def _begun() -> dict[str, Any]:
    versions = {each.name: each.version for each in engines()}
    return {"machine": machine.describe(versions)}


def equal_accuracy(name: str, effort: Effort, repeats: int) -> list[dict[str, Any]]:
    """Find each engine's cheapest accurate setting on a scene, then time them together."""
    progress(f"equal accuracy: {name}")
    scene, draws = scenes.load(name), scenes.draws(effort.ensemble)
    found = {each.name: accuracy.search(each, scene, draws, effort) for each in engines()}
    settings = {
        each: Setting(**search["found"]) for each, search in found.items() if search["found"]
    }
    times = interleaved(
        {
            each: partial(engine(each).wall_time, scene, setting, scene.duration)
            for each, setting in settings.items()
        },
        repeats,
    )
    rows = []
    for each, search in found.items():
        row = {"scene": name, "engine": each, **search}
        if each in times:
            row["per_second"] = times[each].least / scene.duration
            row["setting"] = str(settings[each])
        rows.append(row)
    return rows


if __name__ == "__main__":
    main()
