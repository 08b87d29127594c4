"""The sweeps of the seizure study: over obstacles, robots, flat ground and phases."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.settings import Drive
from crawler2d.parameters.track import GearWheel, LineOfWheels
from crawler2d.presets import terrains
from crawler2d.presets.robots import engineer
from crawler2d.sweeps.sweep import sweep
from research.models import StudyModel, study_models
from research.stops import TRIED

if TYPE_CHECKING:
    import xarray

    from crawler2d.parameters.robot import Robot
    from crawler2d.parameters.terrain import Terrain

__all__ = ["FULL", "QUICK", "Design", "Study", "robots_of_the_study"]

# [-] An estimate, like those of the robot; the same everywhere.
_FRICTION = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """How much is simulated."""

    heights: Mapping[str, tuple[float, ...]]
    """[m] By obstacle: "step", "barrier", "knife edge"."""
    repeats: int
    """Runs per model, obstacle and height; 20 in the paper."""
    robot_heights: tuple[float, ...]
    """[m] Heights of the step for the other robots."""
    robot_repeats: int
    ride_repeats: int
    """Runs per model on flat ground."""
    phase_fractions: tuple[float, ...]
    """[-] Phase fractions of the gear wheels on flat ground."""


FULL = Design(
    heights={
        "step": (0.040, 0.060, 0.075, 0.090, 0.100, 0.125, 0.150),
        "barrier": (0.040, 0.060, 0.080, 0.100, 0.125),
        "knife edge": (0.020, 0.040, 0.060, 0.100),
    },
    repeats=20,
    robot_heights=(0.060, 0.090, 0.125),
    robot_repeats=5,
    ride_repeats=2,
    phase_fractions=tuple(twelfth / 12.0 for twelfth in range(13)),
)
QUICK = Design(
    heights={"step": (0.060, 0.100), "barrier": (0.060,), "knife edge": (0.040,)},
    repeats=4,
    robot_heights=(0.090,),
    robot_repeats=1,
    ride_repeats=1,
    phase_fractions=(0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0),
)


def robots_of_the_study() -> dict[str, Robot]:
    """List the robots: the preset without rotors, and variants that test its estimates.

    The centre of mass moves up with a raised arm, and forward with an arm or flippers stretched
    out. The belly hangs lower, or is removed. The motors are twice as strong: a gear wheel that
    hooks into an edge needs more torque than a round one that slides on it.
    """
    base = engineer(flippers=None)
    strong = replace(base.drivetrain, max_torque=2.0 * base.drivetrain.max_torque)
    robots = {
        "preset": base,
        "mass 20 mm up": engineer(flippers=None, center_of_mass=(0.0, 0.04)),
        "mass 30 mm forward": engineer(flippers=None, center_of_mass=(0.03, 0.02)),
        "belly at 20 mm": engineer(flippers=None, belly_clearance=0.020),
        "no belly": replace(base, belly=None),
        "torque doubled": replace(base, drivetrain=strong),
    }
    return {name: robot.without_rotors() for name, robot in robots.items()}


def _obstacles(height: float) -> dict[str, Terrain]:
    return {
        "step": terrains.step(height, friction=_FRICTION),
        "barrier": terrains.barrier(height, 0.1, friction=_FRICTION),
        "knife edge": terrains.knife_edge(height, thickness=0.01, friction=_FRICTION),
    }


def _base() -> Scenario:
    robot = engineer(flippers=None).without_rotors()
    return Scenario(robot, _obstacles(0.1)["step"], drive=Drive(speed=0.4))


def _models() -> dict[str, StudyModel]:
    return study_models(engineer(flippers=None).outline.axle_distance)


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """The simulations of the study; each method runs one sweep, with the same draws.

    Parameters
    ----------
    design : Design
        How much to simulate.
    base : Scenario
        What all runs share; by default the Engineer without flippers.
    models : mapping of str to StudyModel
        The models; by default those of `study_models`.
    seed : int
        Seed of the draws.
    threads : int, optional
        See `simulate_many`.
    progress : bool
        Whether to show a progress bar.
    """

    design: Design = FULL
    base: Scenario = field(default_factory=_base)
    models: Mapping[str, StudyModel] = field(default_factory=_models)
    seed: int = 0
    threads: int | None = None
    progress: bool = True

    def on_obstacle(self, obstacle: str) -> xarray.Dataset:
        """Run every model over one obstacle: track, height, repeat; makes trials of every stop."""
        heights = self.design.heights[obstacle]
        over = {**self._tracks(), "terrain.height": heights}
        base = self.base.replace({"terrain": _obstacles(heights[0])[obstacle]})
        return self._sweep(base, over, self.design.repeats)

    def on_other_robots(self) -> xarray.Dataset:
        """Run every model of every robot over a step, with trials: robot, track, height, repeat."""
        over: dict[Any, Any] = {
            "robot": robots_of_the_study(),
            **self._tracks(),
            "terrain.height": self.design.robot_heights,
        }
        return self._sweep(self.base, over, self.design.robot_repeats)

    def on_the_flat(self) -> xarray.Dataset:
        """Run every model over flat ground: track, repeat."""
        return self._sweep(self._flat(), self._tracks(), self.design.ride_repeats)

    def over_phases(self) -> xarray.Dataset:
        """Run lines of gear wheels on the flat: robot_track_count, phase_fraction, repeat."""
        over = {
            "robot.track.count": [3, 4, 5],
            "robot.track.wheel.phase_fraction": self.design.phase_fractions,
        }
        base = self._flat().replace({"robot.track": LineOfWheels(3, wheel=GearWheel())})
        return self._sweep(base, over, self.design.ride_repeats)

    def _flat(self) -> Scenario:
        # Ten times the robot's acceleration: steady after 0.2 s, not 2 s.
        acceleration = 10.0 * self.base.robot.drivetrain.max_acceleration
        ground = terrains.flat(friction=_FRICTION)
        return self.base.replace(
            {"terrain": ground, "robot.drivetrain.max_acceleration": acceleration}
        )

    def _tracks(self) -> dict[Any, Any]:
        """Return the axis of models."""
        return {"robot.track": {name: model.track for name, model in self.models.items()}}

    def _sweep(
        self,
        base: Scenario,
        over: Mapping[Any, Any],
        repeats: int,
    ) -> xarray.Dataset:
        return sweep(
            base,
            over,
            repeats=repeats,
            seed=self.seed,
            threads=self.threads,
            progress=self.progress,
            on_error="record",
            trials=TRIED,
            wall_time=True,
        )
