"""Unknown or missing keywords are refused at once, with the valid ones."""

import inspect
import pickle
from collections.abc import Callable, Iterator
from types import ModuleType
from typing import Any

import pytest

import crawler2d as c2d
from crawler2d.common.keywords import suggestion
from crawler2d.errors import ArgumentError

ROBOT = c2d.robots.engineer(flippers=None)
BASE = c2d.Scenario(ROBOT, c2d.terrains.step(0.05))


def public(owner: Any = c2d) -> Iterator[tuple[str, Callable[..., Any]]]:
    """Yield the public classes, functions and methods with their public names."""
    names = getattr(owner, "__all__", None) or [each for each in dir(owner) if each[0] != "_"]
    for name in names:
        found = getattr(owner, name)
        if isinstance(found, ModuleType):
            yield from ((f"{name}.{inner}", each) for inner, each in public(found))
        elif isinstance(found, type) and not issubclass(found, (BaseException, int, str)):
            yield name, found
            methods = inspect.getmembers(found, inspect.isfunction)
            yield from ((f"{name}.{each}", f) for each, f in methods if each[0] != "_")
        elif inspect.isfunction(found):
            yield name, found


def keywords(function: Callable[..., Any]) -> list[str]:
    """Return the keywords that a function names explicitly."""
    parameters = inspect.signature(function).parameters.values()
    named = (inspect.Parameter.KEYWORD_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    optional = [p.name for p in parameters if p.kind in named and p.name != "self"]
    return [name for name in optional if len(name) > 5]


OTHERS = {
    # They pass on unknown keywords.
    *("simulate", "terrains.from_points", "terrains.knife_edge", "terrains.stepfield_with_barrier"),
    *("terrains.from_csv", "explore", "jams"),
    "studies.real_time_factor",  # which explains why it does not accept keywords of other studies
    *("Run", "Diagnosis", "Reading", "Audit"),  # results, which users do not construct
}
CALLED = [
    (name, function)
    for name, function in public()
    # Methods of distributions on numbers are not for users.
    if keywords(function) and name not in OTHERS and not name.endswith((".resolve", ".values"))
]


def test_there_are_public_names_that_take_keywords() -> None:
    assert len(CALLED) > 50


@pytest.mark.parametrize("function", [each for _, each in CALLED], ids=[n for n, _ in CALLED])
def test_a_misspelt_keyword_is_answered_with_the_nearest(function: Callable[..., Any]) -> None:
    for keyword in keywords(function):
        misspelt = keyword[:2] + keyword[3:]
        with pytest.raises(ArgumentError, match=rf"\(did you mean {keyword}\?\)") as caught:
            function(**{misspelt: 1})
        assert caught.value.path == misspelt
        assert str(pickle.loads(pickle.dumps(caught.value))) == str(caught.value)


def test_the_radius_of_a_wheel_is_found_by_half_its_name() -> None:
    with pytest.raises(ArgumentError, match=r"\(did you mean wheel_radius\?\)"):
        c2d.LineOfWheels(4, radius=0.06)  # type: ignore[call-arg]


@pytest.mark.parametrize(
    ("function", "arguments", "place", "names"),
    [
        (c2d.Drive, (0.8,), "argument 1 of Drive", "speed, schedule, gait"),
        (c2d.LineOfWheels, (4, 0.06), "argument 2 of LineOfWheels", "wheel_radius, wheel"),
        (c2d.robots.engineer, (None,), "argument 1 of engineer", "flippers, track"),
        (c2d.Robot.simple, (20.0, 0.4), "argument 2 of Robot.simple", "axle_distance, radius"),
    ],
    ids=["class", "second", "function", "classmethod"],
)
def test_an_argument_that_needs_a_keyword_is_answered_with_the_keywords(
    function: Callable[..., Any], arguments: tuple[Any, ...], place: str, names: str
) -> None:
    with pytest.raises(ArgumentError, match=rf"must be given by keyword, got .*{names}") as caught:
        function(*arguments)
    assert caught.value.path == place


def test_an_argument_too_many_for_which_there_is_no_keyword_is_left_to_python() -> None:
    belt: Callable[..., Any] = c2d.BeltTrack
    with pytest.raises(TypeError, match="takes 1 positional argument but 2 were given"):
        belt(0.06)


@pytest.mark.parametrize(
    ("field", "meant"),
    [
        ("gait", "drive.gait"),
        ("recrod", "record"),
        ("durations", "duration"),
        ("friction", "terrain.friction"),
        ("max_torqe", "robot.drivetrain.max_torque"),
    ],
)
def test_simulate_knows_its_own_keywords_and_nested_fields(field: str, meant: str) -> None:
    fields: dict[str, Any] = {field: 1}
    with pytest.raises(ArgumentError, match=rf"\(did you mean {meant}\?\)"):
        c2d.simulate(BASE, **fields)


def test_the_error_for_a_field_without_its_path_gives_the_path() -> None:
    with pytest.raises(c2d.ScenarioError, match=r"\(did you mean terrain\.height\?\)"):
        c2d.sweep(BASE, {"height": [0.1]}, progress=False)


@pytest.mark.parametrize(
    "ask",
    [
        lambda **how: c2d.terrains.step(0.1, **how),
        lambda **how: c2d.simulate(BASE, **how),
        lambda **how: c2d.Simulation(BASE).command(**how),
        lambda **how: BASE.replace(how),
    ],
    ids=["terrain", "simulate", "command", "replace"],
)
@pytest.mark.parametrize("name", ["yaw", "roll_angle", "soil", "suspension", "stl", "pid"])
def test_an_error_about_the_third_dimension_states_the_limits_of_a_side_view(
    ask: Callable[..., Any], name: str
) -> None:
    with pytest.raises(c2d.ScenarioError, match=r"side view.*README, Limits"):
        ask(**{name: 1.0})


@pytest.mark.parametrize("name", ["PID", "Suspension", "mesh_terrain"])
def test_an_error_about_a_name_of_the_third_dimension_states_the_limits_of_a_side_view(
    name: str,
) -> None:
    for module in (c2d, c2d.terrains):
        with pytest.raises(AttributeError, match=f"'{name}'.*README, Limits"):
            getattr(module, name)


def test_a_field_of_the_side_view_comes_before_its_limits() -> None:
    assert suggestion("yaw", ["height"], ["terrain.yaw"]) == " (did you mean terrain.yaw?)"


def test_examples_of_a_function_with_keywords_are_still_run() -> None:
    import doctest  # noqa: PLC0415

    from crawler2d.runs import batch  # noqa: PLC0415

    found = {each.name for each in doctest.DocTestFinder().find(batch) if each.examples}
    assert "crawler2d.runs.batch.simulate_many" in found
