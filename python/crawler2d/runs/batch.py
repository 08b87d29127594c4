"""Simulate one scenario, or many on several threads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal

from crawler2d import _core
from crawler2d.common.arrays import is_iterable
from crawler2d.common.keywords import read_choice, refuse_unknown, takes_keywords
from crawler2d.errors import RunUnfinished, ScenarioError, own_error, raise_first
from crawler2d.parameters.fields import field_hints, known_paths, robot_inside
from crawler2d.parameters.robot import Robot
from crawler2d.parameters.scenario import Scenario
from crawler2d.parameters.terrain import Terrain
from crawler2d.runs.branch import RecordMode, Trials, check_recording, trial_names
from crawler2d.runs.progress import Progress, reporter, thread_count
from crawler2d.runs.run import Run

__all__ = ["BatchInterrupted", "complete", "simulate", "simulate_many"]


class BatchInterrupted(KeyboardInterrupt):
    """Ctrl-C ended a batch early.

    Parameters
    ----------
    runs : sequence of Run
        One per scenario, in order. An unfinished run has a `RunUnfinished` as its `error`.
    store : str
        File that holds the finished runs; "" if there is none.
    """

    runs: list[Run]
    store: str

    def __init__(self, runs: Sequence[Run], store: str = "") -> None:
        super().__init__(list(runs), store)
        self.runs = list(runs)
        self.store = store

    def __str__(self) -> str:
        """Return how many runs were finished."""
        finished = sum(not isinstance(run.error, RunUnfinished) for run in self.runs)
        kept = f"{self.store} keeps them" if self.store else ".runs holds them"
        return f"interrupted after {finished} of {len(self.runs)} runs; {kept}"


def simulate(
    scenario: Scenario | Robot,
    terrain: Terrain | None = None,
    *,
    record: RecordMode = "full",
    sample_interval: float = 0.01,
    trials: Trials = "auto",
    **fields: Any,
) -> Run:
    """Simulate one scenario to its end.

    Parameters
    ----------
    scenario : Scenario or Robot
        A scenario, or a robot with a `terrain`.
    terrain : Terrain, optional
        The ground; replaces the scenario's.
    record : {"full", "summary"}
        Whether to keep the history, or only outcome, metrics and events.
    sample_interval : float
        [s] Time between samples of the history, which fall on its multiples and on the end.
    trials : {"auto", "all"} or sequence of str, optional
        Trials to make if the run ends in a stop, see `Run.trials`. Those that decide the outcome
        are always made: whether the stop lasts and, if the robot is jammed, a closed track. None
        adds nothing, "auto" adds twice the torque and twice the friction.
    **fields : object
        Other fields of the scenario, such as ``duration=5.0``.

    Returns
    -------
    Run
        Outcome, metrics and history.

    Raises
    ------
    ScenarioError
        If the scenario breaks a rule; nothing is simulated.
    ArgumentError
        If a keyword is neither an argument nor a field of the scenario.
    LimitError
        If the run needs more memory than the system has, or than the environment variable
        CRAWLER2D_MEMORY allows [GiB]; the default is 8.
    SimulationDiverged
        If the state became non-finite.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> run = c2d.simulate(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05))
    >>> run.outcome
    <Outcome.CLEARED: 'cleared'>
    """
    own = ("record", "sample_interval", "trials")
    whole = complete("simulate", own, scenario, terrain, fields)
    kept = (*check_recording(sample_interval, record), list(trial_names(trials)))
    return Run(whole, _core.simulate(whole.to_json(), *kept))


@takes_keywords
def simulate_many(
    scenarios: Iterable[Scenario],
    *,
    threads: int | None = None,
    record: RecordMode = "full",
    sample_interval: float = 0.01,
    trials: Trials = None,
    progress: bool | Progress | None = False,
    on_error: Literal["raise", "record"] = "raise",
) -> list[Run]:
    """Simulate many scenarios; the results do not depend on the number of threads.

    Parameters
    ----------
    scenarios : iterable of Scenario
        What to simulate.
    threads : int, optional
        1 to 1024; None takes every core of this process. The environment variable
        CRAWLER2D_THREADS is an upper limit.
    record : {"full", "summary"}
        Whether to keep the histories, or only outcomes, metrics and events.
    sample_interval : float
        [s] Time between samples of the histories, which fall on its multiples and on the end.
    trials : {"auto", "all"} or sequence of str, optional
        Trials to make in every run that ends in a stop; see `simulate`.
    progress : bool or callable
        True shows a progress bar; a callable gets the numbers of finished and of all runs.
    on_error : {"raise", "record"}
        What to do if a scenario gives no result. "raise" raises its error: before the first run if
        a scenario breaks a rule, after the last run if a run failed. "record" stores the error in
        `Run.error` and keeps all other runs.

    Returns
    -------
    list of Run
        In the order of the scenarios.

    Raises
    ------
    ScenarioError
        If a scenario or an argument breaks a rule; the path begins with ``scenarios[i]``.
    LimitError
        If `threads` or an environment variable is out of range, or the batch needs more memory
        than the system has or than CRAWLER2D_MEMORY allows [GiB]; the default is 8.
    SimulationDiverged
        If a state became non-finite.
    BatchInterrupted
        On Ctrl-C; its `runs` holds the finished runs and the scenarios of the others.

    Examples
    --------
    >>> import crawler2d as c2d
    >>> base = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.03))
    >>> runs = c2d.simulate_many([base, base.replace({"terrain.height": 0.2})], record="summary")
    >>> [str(run.outcome) for run in runs]
    ['cleared', 'tipped_over']
    """
    read_choice(on_error, "on_error", ("raise", "record"))
    kept = (*check_recording(sample_interval, record), list(trial_names(trials)))
    count = thread_count(threads)
    if not is_iterable(scenarios):
        raise ScenarioError("scenarios", scenarios, "must be several: give them in a list")
    batch = list(scenarios)
    checked = _validate(batch)
    if on_error == "raise":
        raise_first(checked)
    runs = _simulate_valid(batch, checked, kept, threads=count, progress=progress)
    if on_error == "raise":
        raise_first([run.error for run in runs])
    return runs


def _simulate_valid(
    scenarios: Sequence[Scenario],
    checked: Sequence[_core.PreparedScenario | ScenarioError],
    kept: tuple[float, str, list[str]],
    *,
    threads: int,
    progress: bool | Progress | None,
) -> list[Run]:
    """Simulate the valid scenarios; the others become runs with their errors."""
    valid = [each for each in checked if isinstance(each, _core.PreparedScenario)]
    results: list[dict[str, Any] | None] = [None] * len(valid)
    _core.warn(valid)
    with reporter(progress, len(valid)) as report:

        def take(finished: list[tuple[int, dict[str, Any]]]) -> None:
            for index, result in finished:
                results[index] = result
            report(len(finished))

        interrupted = _core.simulate_many(valid, threads, *kept, take)
    remaining = iter(results)
    runs = [
        _run(scenario, each if isinstance(each, ScenarioError) else next(remaining))
        for scenario, each in zip(scenarios, checked, strict=True)
    ]
    if interrupted:
        raise BatchInterrupted(runs)
    return runs


def complete(
    call: str,
    own: Sequence[str],
    scenario: Scenario | Robot,
    terrain: Terrain | None,
    fields: dict[str, Any],
) -> Scenario:
    """Make a scenario from the arguments of a call that also has keywords of its own."""
    if isinstance(scenario, Scenario):
        whole = scenario if terrain is None else scenario.replace({"terrain": terrain})
    elif not isinstance(scenario, Robot):
        inside = robot_inside(scenario, (Robot,))
        remedy = f"; use {inside}" if inside else ""
        raise ScenarioError("scenario", scenario, f"must be a Scenario or a Robot{remedy}")
    elif terrain is None:
        raise ScenarioError("terrain", terrain, "must be given with a robot")
    else:
        whole = Scenario(scenario, terrain)
    names = {name: value for name, value in fields.items() if name.isidentifier()}
    refuse_unknown(call, names, (*own, *field_hints(Scenario)), known_paths(whole))
    return whole.replace(fields)


def _validate(batch: list[Scenario]) -> list[_core.PreparedScenario | ScenarioError]:
    """Validate each scenario; return the error of those that break a rule."""
    results: list[_core.PreparedScenario | ScenarioError] = []
    last = None
    for index, scenario in enumerate(batch):
        path = f"scenarios[{index}]"
        if not isinstance(scenario, Scenario):
            raise ScenarioError(path, scenario, "must be a Scenario")  # a Run could not hold it
        try:
            last = _core.PreparedScenario(scenario.to_json(), last)
            results.append(last)
        except ScenarioError as error:
            results.append(ScenarioError(f"{path}.{error.path}", error.value, error.rule))
    return results


def _run(scenario: Scenario, result: dict[str, Any] | ScenarioError | None) -> Run:
    if result is None:
        error = RunUnfinished("the batch was interrupted before this run had ended")
        return Run(scenario, {}, error)
    if isinstance(result, ScenarioError):
        return Run(scenario, {}, result)
    failure = result.get("error")
    return Run(scenario, result) if failure is None else Run(scenario, {}, own_error(failure))
