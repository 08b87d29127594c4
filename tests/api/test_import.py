"""Import of the package: time, build, public names."""

import os
import subprocess
import sys
from collections.abc import Callable
from types import ModuleType

import pytest

import crawler2d as c2d

MEASURE = """
import time
before = time.perf_counter()
import numpy
begin = time.perf_counter()
import crawler2d
end = time.perf_counter()
print(end - begin, begin - before)
"""

LAZY = """
import sys
import crawler2d
heavy = {"matplotlib", "pandas", "xarray", "scipy", "tqdm"} & set(sys.modules)
assert not heavy, heavy
"""

WHEN_NAMED = """
import sys
import crawler2d
rooms = {f"crawler2d.{name}" for name in ("audits", "reading", "studies", "sweeps")}
assert not rooms & set(sys.modules)
assert set(crawler2d.__all__) <= set(dir(crawler2d))
for name in crawler2d.__all__:
    getattr(crawler2d, name)
assert rooms <= set(sys.modules)
"""

SHADOWED = """
import crawler2d.presets.robots.engineer
import crawler2d.sweeps.sweep
import crawler2d.sweeps.sweep
assert callable(crawler2d.compare)
assert callable(crawler2d.sweep)
assert callable(crawler2d.robots.engineer)
"""


@pytest.mark.parametrize(
    "module",
    [c2d.terrains, c2d.robots, c2d.samples, c2d.unknowns, c2d.variability, c2d.studies, c2d.envs],
    ids=lambda module: module.__name__,
)
def test_completion_offers_public_names_only(module: ModuleType) -> None:
    assert dir(module) == sorted(module.__all__)


def test_completion_of_the_package_offers_its_errors_and_environments_too() -> None:
    assert {each for each in dir(c2d) if each[0] != "_"} == {*c2d.__all__, "envs", "errors"}


def python(program: str, **environment: str) -> str:
    command = [sys.executable, "-W", "error", "-c", program]
    environment = {**os.environ, **environment}
    return subprocess.run(
        command, env=environment, check=True, capture_output=True, text=True
    ).stdout


def test_the_import_costs_less_than_twice_that_of_numpy(say: Callable[[str], None]) -> None:
    # An installed package has its byte code; here the first of the runs writes it. Ours takes 0.5
    # to 1.0 of numpy's 57 to 80 ms; an optional package would add a hundred or more.
    compiled = {"PYTHONDONTWRITEBYTECODE": ""}
    both = [map(float, python(MEASURE, **compiled).split()) for _ in range(5)]
    ours, numpys = (min(times) for times in zip(*both, strict=True))
    say(f"import crawler2d took {1000 * ours:.1f} ms beyond numpy's {1000 * numpys:.1f}")
    assert ours < 2.0 * numpys


def test_the_import_brings_no_optional_package() -> None:
    python(LAZY)


def test_optional_rooms_are_imported_when_they_are_first_used() -> None:
    python(WHEN_NAMED)
    with pytest.raises(AttributeError, match="'crawler2d' has no attribute 'nothing'"):
        c2d.nothing  # type: ignore[attr-defined] # noqa: B018 - read for its error


def test_the_core_is_a_release_build() -> None:
    info = c2d.build_info()
    assert info["profile"] == "release"
    assert info["version"] == c2d.__version__


def test_a_function_takes_precedence_over_the_module_of_its_name() -> None:
    python(SHADOWED)


def test_every_public_name_exists_and_is_documented() -> None:
    values = [getattr(c2d, name) for name in c2d.__all__]
    # One screen, without kinds of tracks, wheels and gaits, as there will be more models.
    assert len([value for value in values if not getattr(value, "kind", "")]) < 58
    for name in c2d.__all__:
        assert getattr(c2d, name).__doc__, name
