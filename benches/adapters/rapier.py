"""The bare engine that crawler2d builds on: rapier2d in double precision, from Rust.

A small binary, `benches/src/bin/bare_rapier.rs`, takes a job as JSON, each in a process of its own;
only its loop of steps is timed. Rapier's tolerances are meant for parts of about a metre. The tuned
setting searches for contacts up to 5 mm ahead, allows an error of 0.1 mm, finds contacts anew in
each step and stiffens them to 240 Hz at a damping ratio of 5, as this project's tests use the
engine. The ground is the scene's cuboids, or the one-sided polyline round them: a wheel that rolls
from one cuboid to the next can catch on the seam. Sleeping is off, because slowly driven wheels
would fall asleep.
"""

import json
import os
import subprocess
import tomllib
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from benches.adapters.planar import Motion, Scene, Setting

_ROOT = Path(__file__).parents[2]


class Rapier:
    """Rapier's own dynamics, without crawler2d."""

    name = "rapier2d"
    version: str
    defaults = Setting(1 / 60, substeps=4, iterations=1, tuned=False)
    grid: Sequence[Setting] = [
        Setting(dt * 1e-3, substeps=substeps, iterations=iterations, ground=ground)
        for dt in (8.0, 4.0, 2.0, 1.0, 0.5)
        for substeps, iterations in ((1, 1), (2, 1), (4, 1), (8, 1), (4, 4))
        for ground in ("boxes", "profile")
    ]
    finest = Setting(0.25e-3, substeps=8, iterations=2, ground="profile")
    next_finest = Setting(0.5e-3, substeps=4, iterations=1, ground="profile")

    def __init__(self) -> None:
        lock = tomllib.loads((_ROOT / "Cargo.lock").read_text(encoding="utf-8"))
        (self.version,) = (p["version"] for p in lock["package"] if p["name"] == "rapier2d-f64")
        self._binary = _build()

    def wall_time(self, scene: Scene, setting: Setting, duration: float) -> float:
        """[s] Time a run."""
        return float(self._do(scene, setting, duration)["wall"])

    def record(self, scene: Scene, setting: Setting, duration: float, interval: float) -> Motion:
        """Run and sample all poses."""
        figures = self._do(scene, setting, duration, setting.stride(interval))
        poses = np.reshape(figures["poses"], (-1, len(scene.bodies), 3))
        return Motion.of(figures["time"], poses)

    def _do(self, scene: Scene, setting: Setting, duration: float, sample_every: int = 0) -> Any:
        job = {
            "scene": asdict(scene) | {"profile": scene.profile()},
            "settings": asdict(setting),
            "duration": duration,
            "sample_every": sample_every,
        }
        text = json.dumps(job, default=np.ndarray.tolist)
        done = subprocess.run(
            [self._binary], input=text.encode(), stdout=subprocess.PIPE, check=True
        )
        return json.loads(done.stdout)


def _build() -> Path:
    """Build the binary, unless it is up to date."""
    command = ["cargo", "build", "--release", "--quiet", "--package", "crawler2d-benches"]
    subprocess.run([*command, "--bin", "bare_rapier"], cwd=_ROOT, check=True)
    target = Path(os.environ.get("CARGO_TARGET_DIR", "target"))
    return _ROOT / target / "release" / "bare_rapier"
