"""Copies of environments: pickled, by `deepcopy`, and in a child process after a fork."""

import copy
import multiprocessing
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

import squall

KINDS: list[Callable[..., Any]] = [
    squall.BoatEnv,
    squall.TeamEnv,
    lambda **options: squall.VectorEnv(2, **options),
    lambda **options: squall.parallel_env(**options),
    lambda **options: squall.parallel_env(team="red", **options),
    lambda **options: gymnasium.make("Squall/PyquaticusBoat-v0", **options),
]


@pytest.mark.parametrize("make", KINDS)
def test_an_environment_is_pickled_as_its_options(make: Callable[..., Any]) -> None:
    pytest.importorskip("pettingzoo")
    environment = make(seed=5, episode_max_s=20, action="continuous")
    first = environment.reset()
    for copied in (pickle.loads(pickle.dumps(environment)), copy.deepcopy(make(seed=5, episode_max_s=20))):
        assert type(copied) is type(environment)
        assert str(copied.reset()[1]) == str(copied.reset(seed=5)[1])
    again = pickle.loads(pickle.dumps(environment))
    assert again.unwrapped.action_names is None, "actions are continuous"
    assert str(again.reset()) == str(first)


def test_a_pickled_environment_has_its_spec() -> None:
    environment = gymnasium.make("Squall/CaptureTheFlagBoat-v0", episode_max_s=5)
    assert pickle.loads(pickle.dumps(environment.unwrapped)).spec == environment.unwrapped.spec is not None


@pytest.mark.parametrize("make", KINDS)
def test_a_copy_during_a_game_is_refused(make: Callable[..., Any]) -> None:
    pytest.importorskip("pettingzoo")
    environment = make()
    environment.reset()
    with pytest.raises(TypeError, match="cannot be copied during a game"):
        copy.deepcopy(environment.unwrapped)


def test_supersuit_and_pettingzoo_train_as_in_their_tutorial() -> None:
    supersuit = pytest.importorskip("supersuit")
    parallel = supersuit.pettingzoo_env_to_vec_env_v1(squall.parallel_env(episode_max_s=20))
    environment = supersuit.concat_vec_envs_v1(parallel, 2, num_cpus=1, base_class="gymnasium")
    observations, _ = environment.reset(seed=1)
    for _ in range(50):
        observations, *_ = environment.step(np.full(8, 3))
    assert observations.shape[0] == 8


def in_child(work: Callable[[], object]) -> str:
    """The result of some work in a forked process, or its error."""
    context = multiprocessing.get_context("fork")
    results: Any = context.Queue()

    def child() -> None:
        try:
            results.put(repr(work()))
        except Exception as error:  # noqa: BLE001 (reported to the parent)
            results.put(repr(error))

    process = context.Process(target=child)
    process.start()
    try:
        said: str = results.get(timeout=60)
        process.join(timeout=60)
        assert process.exitcode == 0
        return said
    finally:
        process.kill()


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_games_continue_after_a_fork() -> None:
    environment = squall.VectorEnv(4, threads=2, seed=1)
    environment.reset()
    environment.step(np.zeros(8, dtype=int))

    def work() -> str:
        environment.step(np.ones(8, dtype=int))
        return environment.native.digest(0)

    said = in_child(work)
    assert said == repr(work()), "the child has played the same step"
    assert in_child(lambda: environment.reset()[0].shape) == repr(environment.observation_space.shape)


@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_recordings_stay_with_the_process_that_began_them(tmp_path: Path) -> None:
    environments = [squall.VectorEnv(2, threads=2, seed=1, record=tmp_path)]
    environments[0].reset()
    environments[0].step(np.zeros(4, dtype=int))
    assert "RuntimeError('this environment records" in in_child(lambda: environments[0].step(np.zeros(4, dtype=int)))
    assert in_child(environments.clear) == "None", "nothing waits for threads of the parent"
    environments[0].step(np.zeros(4, dtype=int))
    environments[0].close()
    assert all(file.read_bytes().endswith(b"\x89MCAP0\r\n") for file in tmp_path.iterdir())
