"""All starts of all cells in one engine, kept in a file as they end."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import Any

from benches.models import ode_child
from benches.models.cases import CASES
from benches.models.changed import VARIANTS, patch, variant
from benches.models.driving import driven
from benches.models.engine import Engine
from benches.models.files import ModelFile, exported, public
from benches.models.predict import PREDICTIONS, robot_of
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario

__all__ = ["ENGINES", "FILES", "RESULTS", "engine_of", "model_of", "run"]

RESULTS = Path(__file__).with_name("results")

ENGINES = (
    *("bullet", "bullet-pyramid", "bullet-prisms"),
    *("dart", "dart-dantzig"),
    *("ode-fine", "ode"),
)
"""Bullet with true cylinders, with these and friction limited along and across, and with what its
readers make of cylinders by default; DART with Coulomb's law, and with its usual solver; ODE
finely, and as Gazebo classic sets it."""


FILES = {
    "public": "original",
    "export": "original",
    "repair": "repair",
    "patch": "repair",
    **dict.fromkeys(VARIANTS, "original"),
}
"""The files of a case, each with the prediction that it is to be compared with: the public one,
crawler2d's of the same robot, and of the repaired one, the public one with the wheels of the
repair, and variants of the public one."""


def engine_of(name: str, time_step: float | None = None) -> Engine:
    """Return an engine, with its own time step or another one [s].

    Raises
    ------
    ImportError
        If it is not installed.
    """
    if name.startswith("bullet"):
        from benches.models.engine_bullet import Bullet  # noqa: PLC0415 - loads Bullet

        is_round, is_cone = name != "bullet-prisms", name != "bullet-pyramid"
        if time_step is None:
            return Bullet(is_round=is_round, is_cone=is_cone)
        return Bullet(time_step, is_round=is_round, is_cone=is_cone)
    if name.startswith("ode"):
        from benches.models.engine_ode import Ode  # noqa: PLC0415 - only for ODE

        return Ode(ode_child.GAZEBO if name == "ode" else ode_child.FINE, time_step)
    from benches.models.engine_dart import Dart  # noqa: PLC0415 - loads DART

    is_coulomb = name == "dart"
    if time_step is None:
        return Dart(is_coulomb=is_coulomb)
    return Dart(time_step, is_coulomb=is_coulomb)


def run(
    engine: str,
    case: str,
    file: str,
    labels: Iterable[str],
    path: Path,
    *,
    starts: int,
    time_step: float | None,
    jobs: int,
) -> None:
    """Drive a file of a case over cells, and add the results to a JSON file.

    Starts that the file already has are not driven again, and labels of other cases are left out.
    """
    results: dict[str, Any] = {}
    if path.exists():
        results = json.loads(path.read_text(encoding="utf-8"))
    path.parent.mkdir(parents=True, exist_ok=True)
    predictions = json.loads(PREDICTIONS.read_text(encoding="utf-8"))
    robot = robot_of(predictions[case][FILES[file]])
    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor(jobs) as pool:
        model = model_of(engine, case, file, robot, Path(folder))
        for label in labels:
            key = f"{case} | {file} | {label}"
            if label in CASES[case].cells:
                own = results.setdefault(key, [])
                scenarios = CASES[case].scenarios(label, robot)[len(own) : starts]
                own += pool.map(partial(_one, engine, time_step, model), scenarios)
                path.write_text(json.dumps(results) + "\n", encoding="utf-8")


def model_of(engine: str, case: str, file: str, robot: Robot, folder: Path) -> ModelFile:
    """Write one of the files of a case into a folder; the public ones are not made of the robot.

    Bullet has true cylinders from URDF alone.
    """
    form = "urdf" if engine in ("bullet", "bullet-pyramid") else CASES[case].form
    if file == "public":
        return public(CASES[case], form, folder)
    if file == "patch":
        return patch(CASES[case], robot, form, folder)
    if file in VARIANTS:
        return variant(CASES[case], file, folder)
    return exported(CASES[case], robot, form, f"{case}_{file}", folder)


def _one(
    engine: str, time_step: float | None, model: ModelFile, scenario: Scenario
) -> dict[str, Any]:
    return driven(engine_of(engine, time_step), model, scenario)
