"""A build of the core with a sample of its faults, each behind a switch.

This is known as mutant schemata (Untch, Offutt and Harrold 1993). `switch.rs` says how one is put
on, and how those that are reached are found.
"""

import json
import os
import re
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.mutants.weaving import Fault, woven

ROOT = Path(__file__).resolve().parents[2]
FOLDER = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve() / "mutants"
TREE = FOLDER / "tree"
PROFILE = "profile.release.package.crawler2d-core.codegen-units=16"
NOT_SOURCES = shutil.ignore_patterns("target", ".*", "out", "dist", "docs", "__pycache__")
SWITCH = re.compile(rb"crate::switch::on\((\d+)\)")
MORE = 1.5
"""This many times as many faults are tried as are asked for, because some do not compile."""


def built(faults: list[Fault], size: int) -> tuple[list[Fault], list[Path]]:
    """Build the first `size` faults that compile; return them and the programs of the tests."""
    shutil.rmtree(TREE, ignore_errors=True)
    shutil.copytree(ROOT, TREE, ignore=NOT_SOURCES)
    shutil.copy(Path(__file__).with_name("switch.rs"), TREE / "rust_core/src")
    with (TREE / "rust_core/src/lib.rs").open("a", encoding="utf-8") as file:
        file.write("\nmod switch;\n")
    kept = weave(faults[: round(MORE * size)])
    while broken := set(uncompiled()):
        kept = weave([fault for fault in kept if fault.number not in broken])
    kept = weave(kept[:size])
    return kept, list(programs())


def weave(faults: list[Fault]) -> list[Fault]:
    """Write the sources with some faults, and return those that could be put in."""
    there = []
    for file in {path.relative_to(ROOT) for path in ROOT.glob("rust_core/src/*/**/*.rs")}:
        own = [fault for fault in faults if Path(fault.file) == file]
        text = (ROOT / file).read_text(encoding="utf-8")
        text = woven(text, own) if own else text
        (TREE / file).write_text(text, encoding="utf-8")
        there += [fault for fault in own if fault.on in text]
    return sorted(there, key=faults.index)


def uncompiled() -> Iterator[int]:
    """Yield the numbers of faults that do not compile."""
    for message in cargo("check", "--lib"):
        if message["reason"] != "compiler-message" or message["message"]["level"] != "error":
            continue
        # If a match lacks an arm, the fault is in what follows.
        is_match = (message["message"]["code"] or {}).get("code") == "E0004"
        for span in message["message"]["spans"]:
            if span["is_primary"]:
                source = (TREE / span["file_name"]).read_bytes()
                yield fault_behind(source, span) if is_match else fault_at(source, span)


def fault_at(source: bytes, span: Any) -> int:
    """Return the number of the fault that begins at a place, or is in its line before, or in it."""
    begin, end = span["byte_start"], span["byte_end"]
    line = source.rfind(b"\n", 0, begin) + 1
    at = SWITCH.match(source, begin)
    found = [at[1]] if at else SWITCH.findall(source[line:begin])[-1:]
    found += SWITCH.findall(source[begin:end]) + SWITCH.findall(source[:begin])[::-1]
    return int(found[0])


def fault_behind(source: bytes, span: Any) -> int:
    """Return the number of the next fault behind a place."""
    return int(SWITCH.findall(source[span["byte_end"] :])[0])


def programs() -> Iterator[Path]:
    for message in cargo("test", "--no-run", "--lib", "--test=facts"):
        if message["reason"] == "compiler-artifact" and message["executable"]:
            yield Path(message["executable"])


def cargo(verb: str, *what: str) -> Iterator[Any]:
    """Yield cargo's messages about the core with the faults; warnings do not matter."""
    options = ["--release", "--config", PROFILE, "--package=crawler2d-core"]
    told = subprocess.run(
        ["cargo", verb, *options, *what, "--quiet", "--message-format=json"],
        check=False,
        cwd=TREE,
        env=os.environ | {"CARGO_TARGET_DIR": str(FOLDER), "RUSTFLAGS": "--cap-lints=allow"},
        stdout=subprocess.PIPE,
        text=True,
    )
    return map(json.loads, told.stdout.splitlines())
