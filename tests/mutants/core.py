"""Whether the tests of the core notice a small fault in it, for a sample of all faults.

    python -m tests.mutants.core [GROUP ...] [--sample 400] [--seed 1]

cargo-mutants puts in one fault at a time, and `.cargo/mutants.toml` says how, and which of them no
test can tell from the core. A fault meets the unit tests of its rooms, which need no optimisation:
seconds each. Those that are left meet the slow ones, too, and facts, which need some: a minute.
Printed are the survivors, and of each group how many were noticed, with Wilson's interval at 95 %.
The exit status is 1 if there are survivors.
"""

import argparse
import json
import os
import random
import re
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from crawler2d import wilson

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = Path(sys.executable).parent / "cargo-mutants"
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
BUILD = {"CARGO_TARGET_DIR": str(TARGET)}


@dataclass(frozen=True)
class Group:
    """Rooms whose faults are drawn together."""

    rooms: tuple[str, ...]
    slow: tuple[str, ...]
    """Unit tests that take seconds, which only meet what the others leave."""
    facts: tuple[str, ...]
    """Files of facts that take seconds, which meet that, too."""


GROUPS = {
    "solver": Group(
        ("solver",),
        ("solver::tests::random",),
        ("basics", "belt::", "blows", "energy", "motors", "rotor", "slopes"),
    ),
    "contact": Group(
        ("contact", "geometry"),
        ("contact::finder", "contact::intrusion", "geometry::shoes::tests::ends_so_unequal"),
        ("basics", "belt::", "flank", "gears", "judged", "lanes", "slopes"),
    ),
    "judges": Group(("observe", "diagnosis"), (), ("basics", "judged", "snapshots", "stops")),
    "runs": Group(
        ("run", "robot", "scenario"),
        ("run::poses", "run::simulation", "run::tests", "run::trials"),
        ("basics", "drive", "judged", "rotor", "snapshots", "stops", "worlds"),
    ),
}


def main() -> int:
    parser = argparse.ArgumentParser()
    parser.add_argument("groups", nargs="*", choices=[*GROUPS, []], metavar="GROUP")
    parser.add_argument("--sample", type=int, default=400, help="faults of each group")
    parser.add_argument("--seed", type=int, default=1, help="which of them")
    asked = parser.parse_args()
    left = 0
    for name in asked.groups or GROUPS:
        left += tried(name, GROUPS[name], asked.sample, asked.seed)
    return 1 if left else 0


def tried(name: str, group: Group, size: int, seed: int) -> int:
    """Try a sample of a group, and return how many of it survived."""
    files = [f"--file=rust_core/src/{room}/**" for room in group.rooms]
    listed = subprocess.run(
        [PROGRAM, "mutants", "--list", *files],
        check=True,
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    )
    every = len(listed.stdout.splitlines())
    # Every so-many-th in the order of the files, from one at random.
    apart = max(every // size, 1)
    first = random.Random(seed).randrange(apart)
    drawn = [*files, f"--shard={first}/{apart}", "--sharding=round-robin"]
    units = [f"{room}::" for room in group.rooms]
    slow = [argument for test in group.slow for argument in ("--skip", test)]
    noticed = met(name, drawn, ["--lib"], [*units, *slow])
    survivors = [mutant for mutant in noticed if not noticed[mutant]]
    if survivors:
        left = [f"--re=^{re.escape(mutant)}$" for mutant in survivors]
        # Names do not choose among fields that are left out: all in these files are tried.
        left += [f"--file={mutant.split(':')[0]}" for mutant in survivors]
        again = met(name, left, ["--lib", "--test=facts"], [*units, *group.facts])
        survivors = [mutant for mutant in survivors if not again[mutant]]
    rate = wilson(len(noticed) - len(survivors), len(noticed))
    print(*survivors, sep="\n")
    print(
        f"{name}: {len(noticed) - len(survivors)} of {len(noticed)} noticed, of {every} in all: "
        f"{rate.rate:.1%} ({rate.low:.1%} to {rate.high:.1%})",
        flush=True,
    )
    return len(survivors)


def met(name: str, chosen: list[str], kinds: list[str], tests: list[str]) -> dict[str, bool]:
    """Return of some mutants that can be built whether a test noticed them."""
    folder = TARGET / "mutants" / name
    folder.mkdir(parents=True, exist_ok=True)
    optimised = {} if kinds == ["--lib"] else {"CARGO_PROFILE_MUTANTS_OPT_LEVEL": "1"}
    built_alone = [f"--cargo-arg={kind}" for kind in kinds]
    ended = subprocess.run(
        [PROGRAM, "mutants", *chosen, "--output", folder, *built_alone, "--", "--", *tests],
        check=False,
        cwd=ROOT,
        env=os.environ | BUILD | optimised,
    )
    # All noticed, some missed, or some noticed by the clock alone.
    if ended.returncode not in (0, 2, 3):
        raise SystemExit(f"cargo-mutants failed with {ended.returncode}")
    outcomes = json.loads((folder / "mutants.out/outcomes.json").read_text(encoding="utf-8"))
    return {
        outcome["scenario"]["Mutant"]["name"]: outcome["summary"] != "MissedMutant"
        for outcome in outcomes["outcomes"]
        if outcome["summary"] not in ("Success", "Unviable")
    }


if __name__ == "__main__":
    raise SystemExit(main())
