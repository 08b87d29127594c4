"""What equal accuracy means, and how a motion is judged."""

from __future__ import annotations

import math
from typing import NamedTuple

from benches.peers import geometry
from benches.peers.engine import Engine, Setting
from benches.peers.motion import Motion
from benches.peers.scenes import Scene

PENETRATION = 1e-3
"""[m] Largest accurate overlap with the ground."""
JOINT_GAP = 0.2e-3
"""[m] Largest accurate gap of a pin."""
PATH = 0.01
"""[m] Largest accurate distance from the limit's path."""

# [s] Time between samples.
_INTERVAL = 0.002


class Judged(NamedTuple):
    """A run and its errors.

    Attributes
    ----------
    motion : Motion
        The recorded motion.
    penetration, gap : float
        [m] Deepest overlap with the ground, largest gap of a pin; infinite if the robot flew off.
    cleared : bool
        Whether the rear axle passed the last edge.
    """

    motion: Motion
    penetration: float
    gap: float
    cleared: bool

    @property
    def is_sound(self) -> bool:
        """Whether the bodies stay out of the ground and on their pins."""
        return self.penetration <= PENETRATION and self.gap <= JOINT_GAP


def judge(engine: Engine, scene: Scene, setting: Setting) -> Judged:
    """Run an engine and measure its errors, by the same geometry for all."""
    motion = engine.record(scene, setting, scene.duration, _INTERVAL)
    if not scene.keeps_course(motion):
        return Judged(motion, math.inf, math.inf, cleared=False)
    return Judged(
        motion,
        max(geometry.penetration(scene, motion), motion.penetration),
        geometry.joint_gap(scene, motion),
        scene.cleared(motion),
    )
