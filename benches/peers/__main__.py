"""Run the benchmark; it writes progress to stderr, the report to `out/`, and its page and picture.

Usage, from the repository root: ``python -m benches.peers [--quick] [--sections SECTION ...]``.
"""

import argparse
import json
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

from benches.adapters.planar import ENGINES, SCENES, draws, load_engines
from benches.peers import chains, report
from benches.peers.accuracy import Effort, equal_accuracy
from benches.peers.chains import measure_chains
from benches.peers.sections import batches, defaults, yardstick
from benches.shared.measuring import machine, write_parts
from research.figures import draw_dots

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
    parser.add_argument("--quick", action="store_true", help="two scenes, and no page")
    parser.add_argument(
        "--scenes",
        nargs="+",
        choices=SCENES,
        default=SCENES,
        metavar="SCENE",
        help="only these scenes, and no page",
    )
    parser.add_argument(
        "--sections",
        nargs="+",
        choices=_SECTIONS,
        default=_SECTIONS,
        metavar="SECTION",
        help=f"only these sections; the others stay as they are: {', '.join(_SECTIONS)}",
    )
    parser.add_argument("--render", action="store_true", help="only write the page again")
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
    is_kept = not arguments.quick and arguments.scenes == SCENES
    result = json.loads(path.read_text(encoding="utf-8"))
    write_parts(report.render(result), _PAGE if is_kept else None, path.with_suffix(".md"))
    if is_kept:
        factors = report.speeds(result["accuracy"])
        draw_dots(factors, "simulated time / wall time", _PAGE.with_suffix(".svg"), scale="log")


def _refuse_without_a_run(parser: argparse.ArgumentParser, path: Path) -> None:
    """Exit before any measurement if the page would lack results of a full run."""
    found = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    missing = [name for name in ("machine", "wall") if name not in found]
    if missing:
        parser.error(
            f"--sections and --render change a page: {path} must hold a whole run, "
            f"and lacks {' and '.join(missing)}; run once without them"
        )


def quick() -> Iterator[dict[str, Any]]:
    """Run everything on a small scale, in less than a minute."""
    names = ["lwa5-round-step", "lwa5-gear-step"]
    yield {"defaults": defaults(names, load_engines(), 1)}
    yield {"yardstick": yardstick(["lwa3", "lwa5"], ["step"], 2)}
    yield {"chains": measure_chains([22], ["flat"], 1, chains.GRID[10:14])}
    yield {"batches": batches(["lwa3-gear-step"], draws(2), ENGINES, 1)}
    yield {"accuracy": equal_accuracy(names[0], Effort(1, 4, 0.9e-3), 1)}


def full(names: Sequence[str], chosen: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Run the chosen sections; `names` are the scenes for the first two sections."""
    robots, terrains = ["lwa3", "lwa5", "cwa24"], ["step", "field"]
    lines = ["lwa5-gear-step", "lwa3-gear-step"]
    sections: dict[str, Callable[[], Any]] = {
        "chains": lambda: measure_chains(_SHOES, chains.TERRAINS, _REPEATS),
        "defaults": lambda: defaults(names, load_engines(), _REPEATS),
        "yardstick": lambda: yardstick(robots, terrains, _REPEATS),
        "batches": lambda: batches(lines, draws(_WORLDS), ENGINES, 3),
    }
    for section, measure in sections.items():
        if section in chosen:
            yield {section: measure()}
    rows: list[dict[str, Any]] = []
    for name in names if "accuracy" in chosen else ():
        rows += equal_accuracy(name, Effort(3, _ENSEMBLE), _REPEATS)
        yield {"accuracy": rows}


def _begun() -> dict[str, Any]:
    versions = {each.name: each.version for each in load_engines()}
    return {"machine": machine(versions)}


if __name__ == "__main__":
    main()
