"""The size of the reproduction, its layouts and motors, and how runs are made.

The layout for each row follows from the text of the paper, not from results.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

import crawler2d as c2d
from crawler2d.parameters.terrain import Terrain
from crawler2d.studies.campaign import RateSampling, Sampling
from crawler2d.sweeps.figure_dataset import FigureDataset
from research import paper
from research.models import StudyModel, study_models, study_robot

# [-] No interval is so narrow, so the number of runs decides.
_NO_WIDTH = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class Design:
    """The size of the study."""

    field_repeats: int
    """Runs per cell of Table 2; 20 in the paper."""
    field_layouts: tuple[str, ...]
    """Layouts of Table 2; () takes all."""
    heights: tuple[float, ...]
    """[m] Heights of the parallelepiped of Table 3."""
    height_repeats: int
    """Runs per model and height."""
    driving_repeats: int
    """Runs per model on level ground."""
    angles: tuple[float, ...]
    """[rad] Angles of slopes, besides the declared and the measured one of Table 1."""
    slope_repeats: int
    """Runs per model and slope."""
    computing_repeats: int
    """Measurements of the real-time factor."""
    claim_repeats: int
    """Runs per cell of an experiment on a claim."""


FULL = Design(
    field_repeats=100,
    field_layouts=(),
    heights=tuple(0.02 * step for step in range(2, 13)),
    height_repeats=10,
    driving_repeats=3,
    angles=tuple(map(math.radians, (35.0, 40.0, 42.0, 44.0, 45.0, 46.0))),
    slope_repeats=5,
    computing_repeats=5,
    claim_repeats=20,
)
QUICK = Design(
    field_repeats=5,
    field_layouts=(
        *("16 all round, spaced", "line of 3", "line of 3 gears", "16 gears all round, spaced"),
        *("belt", "belt with grousers", "line of 5 gears"),
    ),
    heights=(0.06, 0.10, 0.14, 0.20),
    height_repeats=3,
    driving_repeats=2,
    angles=tuple(map(math.radians, (35.0, 45.0))),
    slope_repeats=2,
    computing_repeats=1,
    claim_repeats=4,
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Work:
    """The whole reproduction: its size, and how runs are made."""

    store: Path
    """The file that keeps every run."""
    design: Design = FULL
    seed: int = 0
    """Seed of all draws."""
    threads: int | None = None
    """See `simulate_many`."""
    progress: bool = True
    """Whether to show a bar for each part."""
    tried: Counter[str] = field(default_factory=Counter)
    """Numbers of "settings" and "runs" that the studies have tried."""

    @property
    def sampling(self) -> Sampling:
        """The keywords of a study that measures."""
        return Sampling(
            seed=self.seed, threads=self.threads, store=self.store, progress=self.progress
        )

    def sampling_of(self, repeats: int) -> RateSampling:
        """Return the keywords for a study of rates with the same number of runs in all cells."""
        until = c2d.Until(width=_NO_WIDTH, min_runs=repeats, max_runs=repeats)
        return RateSampling(**self.sampling, until=until)

    def success_rate(
        self, grounds: Mapping[str, Terrain], models: Mapping[str, Any], repeats: int
    ) -> FigureDataset:
        """Drive robots over several grounds, with the same number of runs each."""
        base, options = climb(next(iter(grounds.values()))), self.sampling_of(repeats)
        return self.count(
            c2d.studies.success_rate(base, terrains=grounds, models=models, **options)
        )

    def count(self, figures: FigureDataset) -> FigureDataset:
        """Count the runs of a study, and return it; runs of two studies count twice."""
        self.tried.update({name: figures.attrs[name] for name in ("settings", "runs")})
        return figures


@dataclass(frozen=True, slots=True, kw_only=True)
class Setting:
    """Limits of the motors, and friction of the ground."""

    name: str
    max_torque: float
    """[N m] Torque of one sprocket, or of one wheel if each has its own motor."""
    friction: float
    """[-] Friction between track and ground."""
    reason: str
    """Its source."""
    a_wheel: bool = False
    """Whether every wheel has its own motor; a track without wheels has one sprocket."""
    rotor_inertia: float | None = None
    """[kg m^2] Rotor inertia of one track, at its sprocket; None takes the robot's."""

    def on(self, robot: c2d.Robot) -> c2d.Robot:
        """Give a robot these motors."""
        sharing, torque = "track", self.max_torque
        if self.a_wheel and isinstance(
            robot.track, (c2d.LineOfWheels, c2d.CircumferentialWheels, c2d.HybridWheels)
        ):
            # The core gives each of the N wheels of a side 1/N of the torque of a sprocket.
            sharing, torque = "wheel", torque * robot.wheels()["side"].tolist().count("left")
        inertia = self.rotor_inertia
        drivetrain = replace(
            robot.drivetrain,
            max_torque=torque,
            torque_sharing=sharing,  # type: ignore[arg-type] # a plain str to mypy
            rotor_inertia=robot.drivetrain.rotor_inertia if inertia is None else inertia,
        )
        return replace(robot, drivetrain=drivetrain)


PRESET = Setting(
    name="preset",
    max_torque=6.0,
    friction=0.9,
    reason="the preset without rotors; both figures are estimates (6 N m holds the 45 degrees of"
    " Table 1 with a margin of 1.6)",
)
STRONG = Setting(
    name="strong motors",
    max_torque=60.0,
    friction=0.9,
    reason="ten times the torque: motors that hold their speed",
)
PUBLIC = Setting(
    name="public simulation",
    max_torque=100.0,
    friction=1.0,
    a_wheel=True,
    reason="the public simulation model: an effort of 100 N m a wheel, and the smaller of its"
    " friction, 100, and the ground's, 1.0 by default",
)
SETTINGS = (PRESET, STRONG, PUBLIC)


_SPACED_GEARS = "16 gears all round, spaced"


class Reading(NamedTuple):
    """The layout for a row or column of the paper."""

    row: str
    """As in the paper's tables."""
    layout: str
    """One of `layouts`."""
    reason: str
    """Reason, only from the text of the paper."""


READINGS = (
    Reading(
        paper.CWA_ROUND,
        "16 all round, spaced",
        "section 3 starts from Fig. 7: small wheels, spaced",
    ),
    Reading(
        paper.LWA_ROUND,
        "line of 3",
        "Fig. 3 is by the same team, and eq. (1) turns the wheels by thirds",
    ),
    Reading(
        paper.CWA_GEAR,
        _SPACED_GEARS,
        "section 3 replaces the wheels of Fig. 7 by gears of the same size (Fig. 12)",
    ),
    Reading(
        paper.LWA_GEAR, "line of 3 gears", "the line of large wheels, with gears instead (Fig. 13)"
    ),
    Reading(paper.GEAR_MODEL, "line of 3 gears", "the model that the paper ends up with (Fig. 13)"),
    Reading(
        paper.GEAR_MODEL_OTHERWISE,
        _SPACED_GEARS,
        "Figs. 15 to 17, of these fields, show small gears all round",
    ),
    Reading(
        paper.REAL_ROBOT,
        "belt with grousers",
        "our choice: it has the outline and the grousers of the robot",
    ),
)
"""From the text of the paper; all other layouts are ours."""


def layouts() -> dict[str, StudyModel]:
    """List all layouts by name: the track models of the study, and spaced small gears.

    Examples
    --------
    >>> layouts()["16 all round, spaced"].source
    'Fig. 7'
    """
    spaced = c2d.CircumferentialWheels(16, wheel_radius=0.02, wheel=c2d.GearWheel())
    return study_models() | {_SPACED_GEARS: StudyModel(spaced, "Fig. 12")}


def models_of(
    names: Iterable[str], setting: Setting = PRESET, *, flippers: bool = True
) -> dict[str, Any]:
    """Put layouts with the motors of a setting on the robot, as `models` for studies."""
    known, robot = layouts(), study_robot("built" if flippers else None)
    return {name: {"robot": setting.on(known[name].on(robot))} for name in names}


def climb(ground: Terrain, setting: Setting = PRESET, *, flippers: bool = True) -> c2d.Scenario:
    """Drive the robot with the motors of a setting, the gait `Climb` and the paper's speed."""
    drive = c2d.Drive(speed=paper.TABLE_1.max_speed, gait=c2d.Climb())
    robot = setting.on(study_robot("built" if flippers else None))
    return c2d.Scenario(robot, ground, drive=drive)
