"""The environments for Gymnasium, with its own checks, single and in vectors."""

import dataclasses
import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv, VectorEnv
from numpy.testing import assert_allclose, assert_array_equal

import crawler2d as c2d
from crawler2d.envs import FlipperEnv, FlipperVectorEnv
from crawler2d.parameters.fields import read_path
from tests.shared import refused

IDS = ("crawler2d/FlipperClimb-v0", "crawler2d/StepField-v0")
VIEWS = ("proprioception", "privileged")
COMMANDS = ("rate", "angle")
MODES = list(AutoresetMode)

WHEELED = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.step(0.05), duration=4.0)
AHEAD = np.ones(1, np.float32)
"""A robot without flippers that gets over in time."""


IN_RAPIER = c2d.Scenario(
    c2d.robots.engineer(flippers=None, track=c2d.LineOfWheels(4)).without_rotors(),
    c2d.terrains.step(0.05),
    solver=c2d.Solver(engine="rapier"),
)


def actions_of(env: Any, seed: int, count: int = 1) -> np.ndarray:
    """Return random actions that mostly drive on, shape (count, N, m) or (count, m)."""
    space = env.action_space
    rng = np.random.default_rng(seed)
    found = rng.uniform(-1.0, 1.0, (count, *space.shape)).astype(np.float32)
    found[..., 0] = 1.0
    return found


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("view", VIEWS)
@pytest.mark.parametrize("name", IDS)
def test_gymnasium_finds_no_fault(name: str, view: str, command: str) -> None:
    env = gymnasium.make(name, observe=view, flipper_command=command, render_mode="rgb_array")
    check_env(env.unwrapped)


@pytest.mark.parametrize("ends", ["front", "rear", None])
def test_a_robot_has_actions_for_the_flippers_that_it_has(ends: Any) -> None:
    built = c2d.robots.absolem()
    assert built.flippers is not None
    robot = built.without_flippers()
    if ends:
        robot = robot.with_flippers(dataclasses.replace(built.flippers, ends=ends))
    env = FlipperEnv(WHEELED.replace({"robot": robot}))
    check_env(env, skip_render_check=True)
    assert env.action_space.shape == (1 + (ends is not None),)
    assert [name for name in env.observation_names if "angle" in name] == (
        [f"{ends}_angle"] if ends else []
    )


def test_equal_seeds_give_equal_bits_and_others_other_episodes() -> None:
    def episode(seed: int) -> list[Any]:
        env = FlipperEnv(observe="privileged")
        seen: list[Any] = [env.reset(seed=seed)[0]]
        for action in actions_of(env, 0, 40):
            observation, reward, *_ = env.step(action)
            seen += [observation, np.float64(reward)]
        return seen

    first, again, other = (np.hstack(episode(seed)) for seed in (1, 1, 2))
    assert_array_equal(first, again)
    assert (first != other).any()


def copies(count: int, **options: Any) -> SyncVectorEnv:
    mode = options.pop("autoreset_mode", AutoresetMode.NEXT_STEP)
    return SyncVectorEnv([lambda: FlipperEnv(**options)] * count, autoreset_mode=mode)


def assert_same(one: Any, other: Any) -> None:
    """Compare results of `step` or `reset`, including everything that Gymnasium adds."""
    if isinstance(one, dict):
        assert one.keys() == other.keys()
        for key in one:
            assert_same(one[key], other[key])
    elif isinstance(one, tuple):
        for a, b in zip(one, other, strict=True):
            assert_same(a, b)
    elif isinstance(one, np.ndarray) and one.dtype == object:
        assert len(one) == len(other)
        for a, b in zip(one, other, strict=True):
            assert_same(a, b)
    else:
        assert_array_equal(one, other)


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_many_are_bit_by_bit_and_key_by_key_what_gymnasium_makes_of_single_ones(
    mode: AutoresetMode, threads: int
) -> None:
    options: dict[str, Any] = {"scenario": WHEELED, "observe": "privileged", "dt": 0.25}
    ours = FlipperVectorEnv(5, autoreset_mode=mode, threads=threads, **options)
    theirs = copies(5, autoreset_mode=mode, **options)
    assert ours.single_observation_space == theirs.single_observation_space
    assert ours.observation_space == theirs.observation_space
    assert ours.action_space == theirs.action_space
    assert_same(ours.reset(seed=7), theirs.reset(seed=7))
    ended = 0
    for action in actions_of(ours, 3, 40):
        found = ours.step(action)
        assert_same(found, theirs.step(action))
        ended += int((found[2] | found[3]).sum())
    assert ended >= 5  # each has had an end and a new start


def test_a_mask_resets_some_episodes() -> None:
    ours = FlipperVectorEnv(4, WHEELED, dt=0.25, autoreset_mode="Disabled")
    theirs = copies(4, scenario=WHEELED, dt=0.25, autoreset_mode=AutoresetMode.DISABLED)
    assert_same(ours.reset(seed=1), theirs.reset(seed=1))
    resets = 0
    for action in actions_of(ours, 0, 30):
        found = ours.step(action)
        assert_same(found, theirs.step(action))
        ended = found[2] | found[3]
        if ended.any():
            with pytest.raises(gymnasium.error.ResetNeeded, match="mask"):
                ours.step(action)
            begun, _ = ours.reset(options={"reset_mask": ended})
            assert_array_equal(begun, theirs.reset(options={"reset_mask": ended})[0])
            resets += 1
    assert resets


@pytest.mark.parametrize("name", IDS)
def test_vector_environments_are_made_by_their_ids(name: str) -> None:
    many = gymnasium.make_vec(name, num_envs=3, vectorization_mode="vector_entry_point")
    assert isinstance(many, VectorEnv)
    assert isinstance(many.unwrapped, FlipperVectorEnv)
    single = gymnasium.make(name)
    observations, _ = many.reset(seed=5)
    assert observations in many.observation_space
    for k in range(3):
        assert_array_equal(observations[k], single.reset(seed=5 + k)[0])
    assert many.spec is not None
    assert many.spec.id == name


def test_copies_in_other_processes_are_the_same() -> None:
    options: dict[str, Any] = {"scenario": WHEELED, "dt": 0.25}
    here = FlipperVectorEnv(2, **options)
    there = AsyncVectorEnv([lambda: FlipperEnv(**options)] * 2, context="spawn")
    try:
        assert_same(here.reset(seed=2), there.reset(seed=2))
        for action in actions_of(here, 1, 20):
            assert_same(here.step(action), there.step(action))
    finally:
        there.close()


@pytest.mark.parametrize("env", [FlipperEnv(WHEELED, dt=0.1), FlipperVectorEnv(2, WHEELED, dt=0.1)])
def test_a_pickled_one_begins_as_the_first_did(env: Any) -> None:
    other = pickle.loads(pickle.dumps(env))
    assert_same(env.reset(seed=3), other.reset(seed=3))
    action = actions_of(env, 0)[0]
    assert_same(env.step(action), other.step(action))


def test_rewards_are_the_sum_of_their_terms_and_progress_ends_at_the_goal() -> None:
    env = FlipperEnv(WHEELED, randomize={}, shock_weight=2.0, effort_weight=0.5)
    env.reset(seed=0)
    far = env.state.to_goal[0]
    sums = dict.fromkeys(("progress", "shock", "effort", "ending"), 0.0)
    done = False
    while not done:
        _, reward, terminated, truncated, info = env.step(np.array([1.0]))
        terms = {name: info[f"reward_{name}"] for name in sums}
        assert reward == pytest.approx(sum(terms.values()), abs=1e-12)
        sums = {name: sums[name] + terms[name] for name in sums}
        done = terminated or truncated
    assert info["outcome"] == "cleared"
    assert sums["progress"] == pytest.approx(far, abs=1e-9)
    assert sums["ending"] == 1.0
    # The work of the motors is in the run, too, and must be enough to lift the robot by the step.
    work = env.run.metrics["drive_work"]
    robot = WHEELED.robot
    assert sums["effort"] == pytest.approx(-0.5 * work / (robot.mass * 9.81), rel=1e-9)
    assert work > robot.mass * 9.81 * 0.05
    assert -1.0 < sums["shock"] < 0.0


def test_the_run_of_an_episode_is_what_happened_in_it() -> None:
    env = FlipperEnv()
    env.reset(seed=4)
    for action in actions_of(env, 2, 60):
        if env.step(action)[2]:
            break
    run, state = env.run, env.state
    # The last sample may be interpolated to a time that differs by rounding.
    assert_allclose(run.position[-1], state.position[0], rtol=0.0, atol=1e-12)
    assert run.time[-1] == pytest.approx(state.time[0], abs=1e-9)
    many = FlipperVectorEnv(3)
    many.reset(seed=2)
    for action in actions_of(env, 2, 20):
        many.step(np.tile(action, (3, 1)))
    assert many.run(1).chassis_angle[-1] == pytest.approx(many.state.chassis_angle[1], abs=1e-12)


def test_a_stop_ends_an_episode_if_asked_and_says_why_by_its_run() -> None:
    high = c2d.Scenario(c2d.robots.absolem(), c2d.terrains.step(0.6), duration=30.0)
    for ends, time in ((True, 15.0), (False, 30.0)):
        env = FlipperEnv(high, randomize={}, dt=0.25, end_when_stopped=ends)
        env.reset()
        truncated = False
        while not truncated:
            *_, terminated, truncated, info = env.step(np.array([1.0, 0.0, 0.0]))
            assert not terminated
        assert info["outcome"] == "stopped"
        assert env.state.time[0] == pytest.approx(time, abs=15.0 * ends)
        assert env.run.diagnosis is not None


def test_draws_are_in_the_scenarios_of_the_episodes() -> None:
    many = FlipperVectorEnv(200, randomize={"terrain.height": c2d.uniform(0.1, 0.2)})
    many.reset(seed=0)
    heights = [read_path(many.run(k).scenario, "terrain.height") for k in range(0, 200, 20)]
    assert len(set(heights)) == 10
    assert 0.1 < min(heights) < max(heights) < 0.2
    fields = FlipperEnv("step_field")
    seeds = []
    for seed in (0, 1):
        fields.reset(seed=seed)
        seeds.append(read_path(fields.run.scenario, "terrain.seed"))
    assert seeds[0] != seeds[1]


def test_episodes_are_drawn_from_a_generator_that_is_set() -> None:
    def drawn(seed: int) -> list[float]:
        env = FlipperEnv()
        env.reset(seed=seed)
        env.np_random = np.random.default_rng(5)
        starts = []
        for _ in range(3):
            env.reset()
            starts.append(float(env.state.to_goal[0]))
        return starts

    assert drawn(1) == drawn(2)
    assert len(set(drawn(1))) == 3


def test_a_full_action_is_the_speed_that_was_drawn() -> None:
    flat = c2d.Scenario(c2d.robots.engineer(flippers=None), c2d.terrains.flat(), duration=4.0)
    many = FlipperVectorEnv(3, flat, randomize={"drive.speed": c2d.uniform(0.1, 0.2)})
    many.reset(seed=0)
    for _ in range(40):
        many.step(np.ones((3, 1), np.float32))
    drawn = [many.run(k).scenario.drive.speed for k in range(3)]
    assert len(set(drawn)) == 3
    assert many.state.track_speed == pytest.approx(drawn, rel=1e-3)


def test_a_simulation_that_fails_ends_its_episode_and_the_others_go_on() -> None:
    many = FlipperVectorEnv(2, WHEELED, dt=0.25)
    many.reset(seed=0)
    episodes = many._begun()
    states = episodes._many.state

    def one_failed() -> Any:
        found = states()
        errors = (found.error[0], "the state became non-finite")
        return type(found)(**{**{k: getattr(found, k) for k in found.__slots__}, "error": errors})

    episodes._many.state = one_failed  # type: ignore[method-assign] # as if the second had failed
    *_, terminated, truncated, info = many.step(np.ones((2, 1), np.float32))
    assert truncated.tolist() == [False, True]
    assert not terminated.any()
    assert info["outcome"].tolist() == [None, "diverged"]
    assert "non-finite" in info["error"][1]
    assert info["_error"].tolist() == [False, True]
    del episodes._many.state
    observations, *_, truncated, _ = many.step(np.ones((2, 1), np.float32))
    assert not truncated.any()
    assert np.isfinite(observations).all()
    assert many.state.time.tolist() == [0.5, 0.0]


@pytest.mark.parametrize(("dt", "rate"), [(0.05, 20), (0.2, 5), (3.0, 1)])
def test_a_film_has_as_many_pictures_a_second_as_there_are_steps(dt: float, rate: int) -> None:
    made: list[Any] = [FlipperEnv(WHEELED, dt=dt), FlipperVectorEnv(2, WHEELED, dt=dt)]
    made.append(gymnasium.make(IDS[0], dt=dt, render_mode="rgb_array"))
    made.append(gymnasium.make_vec(IDS[0], num_envs=2, dt=dt))
    assert [env.metadata["render_fps"] for env in made] == [rate] * 4
    assert FlipperEnv.metadata["render_fps"] == 20


def test_a_picture_is_drawn_if_asked() -> None:
    env = FlipperEnv(WHEELED, render_mode="rgb_array")
    env.reset(seed=0)
    picture = env.render()
    assert picture is not None
    assert picture.shape == (360, 640, 3)
    assert picture.dtype == np.uint8
    assert len(np.unique(picture)) > 20
    assert FlipperEnv(WHEELED).render() is None


@pytest.mark.parametrize(
    ("options", "path"),
    [
        ({"scenario": "climb"}, "scenario"),
        ({"scenario": WHEELED.replace({"drive.gait": c2d.Climb()})}, "drive.gait"),
        ({"scenario": WHEELED.replace({"drive.schedule": [(0.0, 0.1)]})}, "drive.schedule"),
        ({"scenario": WHEELED.replace({"drive.speed": 0.0})}, "drive.speed"),
        ({"scenario": WHEELED.replace({"gravity": 0.0})}, "gravity"),
        ({"dt": 0.0}, "dt"),
        ({"dt": "fast"}, "dt"),
        ({"observe": "all"}, "observe"),
        ({"flipper_command": "torque"}, "flipper_command"),
        ({"randomize": {"terrain.hight": c2d.uniform(0.1, 0.2)}}, "terrain.hight"),
        ({"randomize": {"terrain.height": 0.1}}, "randomize['terrain.height']"),
        ({"shock_weight": -1.0}, "shock_weight"),
        ({"effort_weight": np.nan}, "effort_weight"),
        ({"end_when_stopped": "no"}, "end_when_stopped"),
        ({"render_mode": "human"}, "render_mode"),
        ({"scenario": IN_RAPIER, "render_mode": "rgb_array"}, "render_mode"),
    ],
)
def test_a_wrong_argument_is_refused_before_anything_runs(
    options: dict[str, Any], path: str
) -> None:
    for make in (FlipperEnv, lambda **given: FlipperVectorEnv(2, **given)):
        with pytest.raises(c2d.ScenarioError) as failure:
            make(**options).reset()
        assert failure.value.path == path


def test_a_wrong_number_of_threads_is_refused_at_once() -> None:
    with pytest.raises(c2d.LimitError, match=r"threads must be a whole number from 1 .*, got 0"):
        FlipperVectorEnv(2, threads=0)


def test_a_range_is_refused_by_its_middle_at_once_and_else_when_what_is_drawn_breaks_a_rule() -> (
    None
):
    friction = "terrain.friction"
    for make in (FlipperEnv, lambda **given: FlipperVectorEnv(4, **given)):
        below = {friction: c2d.uniform(-3.0, -1.0)}
        error = refused(lambda make=make, below=below: make(scenario=WHEELED, randomize=below))
        assert (error.path, float(str(error.value))) == (friction, -2.0)
        env: Any = make(scenario=WHEELED, randomize={friction: c2d.uniform(-2.0, 3.0)})
        error = refused(lambda env=env: env.reset(seed=1))
        assert error.path == friction
        assert float(str(error.value)) < 0.0


@pytest.mark.parametrize(
    "action", [[1.0], [1.0, 0.0, np.nan], [[1.0, 0.0, 0.0]], "fast", None, [1.0, "up", 0.0]]
)
def test_a_wrong_action_is_refused(action: Any) -> None:
    env = FlipperEnv()
    env.reset(seed=0)
    with pytest.raises(c2d.ScenarioError, match="action"):
        env.step(action)


def test_the_error_about_an_action_has_its_shape_as_it_was_given() -> None:
    env = c2d.envs.FlipperEnv()
    env.reset(seed=0)
    with pytest.raises(c2d.ScenarioError, match=r"must be 3 numbers, got shape \(2,\)"):
        env.step(np.zeros(2, np.float32))


def test_the_action_of_an_episode_that_has_ended_may_be_anything() -> None:
    def states(after_the_end: float) -> Any:
        env = FlipperVectorEnv(2, WHEELED, dt=0.5)
        env.reset(seed=3)
        actions = np.array([[1.0], [0.0]])
        while not env._ended.any():
            env.step(actions)
        actions[env._ended] = after_the_end
        return env.step(actions)

    for one, other in zip(states(0.0)[:4], states(np.nan)[:4], strict=True):
        assert_array_equal(one, other)


def test_nothing_is_done_before_a_reset_or_after_the_end() -> None:
    env = FlipperEnv(WHEELED, dt=1.0)
    for call in (lambda: env.step(np.array([1.0])), lambda: env.run, lambda: env.state):
        with pytest.raises(gymnasium.error.ResetNeeded, match="reset"):
            call()
    env.reset(seed=0)
    while not any(env.step(np.array([0.0]))[2:4]):
        pass
    with pytest.raises(gymnasium.error.ResetNeeded, match="has ended"):
        env.step(np.array([1.0]))
    with pytest.raises(gymnasium.error.ResetNeeded, match="first"):
        FlipperVectorEnv(2).reset(options={"reset_mask": np.array([True, False])})


def test_an_unknown_keyword_is_refused_with_the_nearest_name() -> None:
    makers: list[Any] = [FlipperEnv, FlipperVectorEnv]
    makers += [lambda **given: gymnasium.make(IDS[0], **given)]
    makers += [lambda **given: gymnasium.make_vec(IDS[0], num_envs=2, **given)]
    for make in makers:
        with pytest.raises(TypeError, match="did you mean randomize"):
            make(randomise={})


@pytest.mark.parametrize(
    ("call", "path", "rule"),
    [
        (lambda env: env.reset(seed=[1, 2, 3]), "seed", "must be one or 2"),
        (lambda env: env.reset(seed=np.int64(1)), "seed", "must be an int, or one each"),
        (lambda env: env.reset(seed=0.5), "seed", "must be an int, or one each"),
        (
            lambda env: env.reset(options={"reset_mask": np.zeros(2, bool)}),
            "options['reset_mask']",
            "must be a mask of shape (2,) with at least one True",
        ),
        (
            lambda env: env.reset(options={"reset_mask": np.ones(3, bool)}),
            "options['reset_mask']",
            "must be a mask of shape (2,) with at least one True",
        ),
        (lambda env: env.reset(options=[1]), "options", "must be a mapping, or None"),
    ],
    ids=["seeds", "NumPy", "half", "nothing", "three", "list"],
)
def test_two_environments_are_reset_by_two_seeds_or_a_mask_of_two(
    call: Any, path: str, rule: str
) -> None:
    env = FlipperVectorEnv(2)
    with pytest.raises(c2d.ScenarioError) as caught:
        call(env)
    assert (caught.value.path, caught.value.rule) == (path, rule)


def test_environments_side_by_side_step_after_a_reset_in_a_mode_of_gymnasium() -> None:
    env = FlipperVectorEnv(2)
    with pytest.raises(gymnasium.error.ResetNeeded, match="call reset"):
        env.step(env.action_space.sample())
    mode: Any = "never"
    with pytest.raises(c2d.ScenarioError, match=r"^autoreset_mode must be one of \['NextStep'"):
        FlipperVectorEnv(2, autoreset_mode=mode)


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_an_episode_ends_at_its_duration_whatever_the_time_between_actions(mode: Any) -> None:
    scenario = WHEELED.replace({"duration": 2.0})
    env = FlipperEnv(scenario, randomize={}, dt=1.5)
    env.reset()
    env.step(AHEAD)
    *_, truncated, info = env.step(AHEAD)
    assert truncated
    assert info["outcome"] == "timed_out" == str(c2d.simulate(scenario).outcome)
    assert env.state.time.tolist() == [2.0]
    many = FlipperVectorEnv(2, scenario, randomize={}, dt=1.5, autoreset_mode=mode)
    many.reset()
    many.step(np.ones((2, 1), np.float32))
    assert many.step(np.ones((2, 1), np.float32))[3].tolist() == [True, True]


def test_a_drawn_duration_is_that_of_the_episode() -> None:
    env = FlipperEnv(WHEELED, randomize={"duration": c2d.uniform(0.3, 0.9)}, dt=0.1)
    lengths = []
    for seed in range(3):
        env.reset(seed=seed)
        while not env.step(AHEAD)[3]:
            pass
        lengths.append(env.state.time.item())
        assert env.run.scenario.duration == pytest.approx(lengths[-1])
    assert 0.3 <= min(lengths) < max(lengths) <= 0.9
