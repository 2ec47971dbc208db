"""Resets, as gymnasium and PettingZoo define them: seeds, the ends of games, and calls out of order."""

from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import pytest

import squall

AGENTS = dict.fromkeys(["blue_1", "blue_2", "red_1", "red_2"], 3)


def agents(**options: Any) -> Any:
    pytest.importorskip("pettingzoo")
    return squall.parallel_env(**options)


KINDS: list[tuple[Callable[..., Any], Any]] = [
    (squall.BoatEnv, 3),
    (squall.TeamEnv, [3, 3]),
    (lambda **options: squall.VectorEnv(2, **options), np.full(4, 3)),
    (agents, AGENTS),
]
SINGLES = [KINDS[0], KINDS[1], KINDS[3]]


def seed_of(info: dict[str, Any]) -> int:
    """The game's seed: PettingZoo has an info for each agent, a vector an array."""
    return int(np.ravel(info["seed"] if "seed" in info else info["blue_1"]["seed"])[0])


def seeds_after(environment: Any, seed: int, games: int) -> list[int]:
    return [seed_of(environment.reset(seed=seed)[1])] + [seed_of(environment.reset()[1]) for _ in range(games - 1)]


@pytest.mark.parametrize(("make", "action"), KINDS)
def test_two_resets_without_a_seed_are_two_games(make: Callable[..., Any], action: Any) -> None:
    environment = make()
    assert seed_of(environment.reset()[1]) != seed_of(environment.reset()[1])
    assert seed_of(make(seed=7).reset()[1]) == 7, "the seed of its creation"


@pytest.mark.parametrize(("make", "action"), SINGLES)
def test_games_after_a_seed_are_reproducible_and_those_of_neighbours_differ(
    make: Callable[..., Any], action: Any
) -> None:
    workers = [seeds_after(make(), 100 + worker, games=7) for worker in range(8)]
    assert [seeds[0] for seeds in workers] == list(range(100, 108))
    assert len({seed for seeds in workers for seed in seeds}) == 56
    assert seeds_after(make(), 100, games=7) == workers[0]
    created = make(seed=100)
    assert [seed_of(created.reset()[1]) for _ in range(7)] == workers[0]


def test_games_of_vectorised_environments_differ() -> None:
    make = lambda: squall.BoatEnv(episode_max_s=1.0)
    vector = gymnasium.vector.SyncVectorEnv([make] * 8)
    _, info = vector.reset(seed=100)
    seeds = set(info["seed"].tolist())
    for _ in range(18):
        seeds |= set(vector.step(np.full(8, 3))[4]["seed"].tolist())
    assert len(seeds) == 56


@pytest.mark.parametrize(("make", "action"), SINGLES)
def test_repeated_starts_stay_within_their_number(make: Callable[..., Any], action: Any) -> None:
    assert seeds_after(make(starts=3), 5, games=5) == [5, 6, 7, 5, 6]


@pytest.mark.parametrize(("make", "action"), KINDS)
def test_calls_out_of_order_are_refused(make: Callable[..., Any], action: Any) -> None:
    environment = make(episode_max_s=0.5)
    with pytest.raises(gymnasium.error.ResetNeeded, match="call reset first"):
        environment.step(action)
    environment.reset()
    environment.step(action)
    if make is not KINDS[2][0]:
        with pytest.raises(gymnasium.error.ResetNeeded, match="the game is over: call reset first"):
            environment.step(action)
    environment.close()
    environment.close()
    for call in (environment.reset, lambda: environment.step(action)):
        with pytest.raises(gymnasium.error.ClosedEnvironmentError, match="the environment is closed"):
            call()


@pytest.mark.parametrize(("make", "action"), KINDS)
def test_seeds_are_integers(make: Callable[..., Any], action: Any) -> None:
    environment = make(seed=np.int64(5))
    assert seed_of(environment.reset()[1]) == 5
    assert seed_of(environment.reset(seed=np.int64(6))[1]) == 6
    for seed in (-1, 3.7, "7"):
        with pytest.raises(ValueError, match="seed is|seed has"):
            environment.reset(seed=seed)


def test_a_step_without_agents_is_empty() -> None:
    environment = agents(episode_max_s=0.5)
    with pytest.raises(gymnasium.error.ResetNeeded):
        environment.step({})
    environment.reset()
    environment.step(AGENTS)
    assert environment.agents == [] and environment.step({}) == ({}, {}, {}, {}, {})


def test_each_nth_game_is_recorded_whatever_its_seed(tmp_path: Any) -> None:
    environment = squall.BoatEnv(seed=1, record=tmp_path, record_every=3, episode_max_s=0.5)
    seeds = []
    for _ in range(7):
        seeds.append(environment.reset()[1]["seed"])
        environment.step(3)
    environment.close()
    recorded = {int(file.stem.split("_")[-1]) for file in tmp_path.iterdir()}
    assert recorded == {seeds[0], seeds[3], seeds[6]}
