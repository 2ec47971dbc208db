"""Episodes: reproducible from their seeds on any number of threads; and when arrays are overwritten."""

import threading

import numpy as np
import pytest

import squall


def played(environment: squall.VectorEnv, steps: int, seed: int | None = None) -> list[np.ndarray]:
    """All results of some steps, with actions that depend on the last observations."""
    observations, info = environment.reset(seed=seed)
    shown = [observations, info["seed"]]
    for _ in range(steps):
        bits = np.ascontiguousarray(observations).view(np.uint32).reshape(environment.num_envs, -1)
        actions = (bits.sum(axis=1, dtype=np.uint64) % 17).astype(np.int64)
        observations, *rest, info = environment.step(actions)
        shown += [observations, *rest, info["counts"], info["seed"]]
        if "final_obs" in info:
            shown += [np.stack(info["final_obs"][info["_final_obs"]]), info["final_info"]["score"]]
    return [array.copy() for array in shown]


def same(one: list[np.ndarray], other: list[np.ndarray]) -> bool:
    return len(one) == len(other) and all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


OPTIONS = {"opponents": [(1.0, "pav01"), (1.0, "policy")], "episode_max_s": 20}


@pytest.mark.parametrize("control", ["direct", "teleop"])
def test_a_seed_is_the_same_games_on_any_number_of_threads_and_again(control: str) -> None:
    environments = [squall.VectorEnv(5, threads=n, seed=11, control=control, **OPTIONS) for n in (1, 2, 3)]
    first, *others = [played(environment, 100) for environment in environments]
    assert all(same(first, other) for other in others)
    assert same(first, played(environments[0], 100, seed=11))
    assert not same(first, played(environments[0], 100, seed=12))


def test_an_episode_can_be_played_again_by_its_seed() -> None:
    environment = squall.VectorEnv(3, seed=5, game="pyquaticus_2v2", episode_max_s=10)
    shown = played(environment, 45)
    seeds = shown[-1]
    assert set(seeds) == {11, 12, 13}
    alone = squall.VectorEnv(1, game="pyquaticus_2v2", episode_max_s=10)
    _, info = alone.reset(seed=int(seeds[2]))
    assert (info["seed"] == seeds[2]).all()
    # Two games of 20 steps, and then five steps of this one, with the actions chosen from its observations.
    again = played(alone, 5, seed=int(seeds[2]))
    assert np.array_equal(shown[-6][2:4], again[-6])


def test_the_next_games_come_without_a_seed() -> None:
    environment = squall.VectorEnv(2, seed=1, game="pyquaticus_2v2", row="team")
    assert environment.reset()[1]["seed"].tolist() == [1, 2], "the games that have already started"
    environment.step(np.zeros((2, 2), dtype=int))
    assert environment.reset()[1]["seed"].tolist() == [3, 4]
    assert environment.reset(seed=[70, None])[1]["seed"].tolist() == [70, 6]
    environment.step(np.zeros((2, 2), dtype=int))
    masked = {"reset_mask": np.array([True, False])}
    assert environment.reset(options=masked)[1]["seed"].tolist() == [72, 6]
    assert environment.native.standing(1)["steps"] == 1, "the other game continues"
    assert environment.reset()[1]["seed"].tolist() == [74, 8], "no step has been played"


def test_unseeded_environments_differ() -> None:
    assert squall.TeamEnv().reset()[1]["seed"] != squall.TeamEnv().reset()[1]["seed"]


def test_arrays_are_the_callers_unless_copying_is_off() -> None:
    for copy in (True, False):
        environment = squall.VectorEnv(2, seed=1, copy=copy)
        first = environment.reset()[0]
        kept = first.copy()
        second = environment.step(np.zeros(environment.num_envs, dtype=int))[0]
        assert np.array_equal(first, kept) == copy
        assert (first is second or np.shares_memory(first, second)) != copy


def test_a_team_that_is_named_learns() -> None:
    environment = squall.VectorEnv(4, seed=1, game="pyquaticus_2v2", team="red")
    assert {environment.native.standing(game)["team"] for game in range(4)} == {1}
    by_turns = squall.VectorEnv(4, seed=1, game="pyquaticus_2v2")
    assert [by_turns.native.standing(game)["team"] for game in range(4)] == [1, 0, 1, 0]


def test_starts_come_round() -> None:
    environment = squall.VectorEnv(2, seed=1, starts=3, game="pyquaticus_2v2", episode_max_s=1, row="team")
    seeds = [environment.reset()[1]["seed"].tolist()]
    for _ in range(6):
        seeds.append(environment.step(np.zeros((2, 2), dtype=int))[4]["seed"].tolist())
    assert seeds[::2] == [[1, 2], [3, 1], [2, 3], [1, 2]]
    with pytest.raises(ValueError, match="seed is 9, expected 1 to 3"):
        environment.reset(seed=[9, None])


def test_a_step_leaves_the_interpreter_to_others() -> None:
    # Ten seconds of 64 games take a tenth of a second at least.
    environment = squall.VectorEnv(64, threads=1, seed=1, opponents="policy", decision_s=10.0)
    environment.reset()
    actions = np.zeros(environment.num_envs, dtype=int)
    is_over, wakings = threading.Event(), 0

    def wake() -> None:
        nonlocal wakings
        while not is_over.wait(timeout=0.001):
            wakings += 1

    thread = threading.Thread(target=wake)
    thread.start()
    try:
        before = wakings
        environment.step(actions)
        within = wakings - before
    finally:
        is_over.set()
        thread.join()
    assert within > 10, "with the interpreter's lock held there would be one or two"
