"""The environments conform to gymnasium, PettingZoo and Stable-Baselines3."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import squall

IDS = [name for name in gymnasium.registry if name.startswith("Squall/")]


def test_all_ids_are_registered() -> None:
    assert IDS == [
        "Squall/CaptureTheFlag-v0",
        "Squall/CaptureTheFlagBoat-v0",
        "Squall/Pyquaticus-v0",
        "Squall/PyquaticusBoat-v0",
    ]


@pytest.mark.parametrize("action", ["pyquaticus", "continuous"])
@pytest.mark.parametrize("name", IDS)
@pytest.mark.filterwarnings("ignore:.*A Box observation space m.*imum value is.*infinity")
@pytest.mark.usefixtures("page")
def test_gymnasium_accepts(name: str, action: str) -> None:
    environment = gymnasium.make(name, action=action, render_mode="rgb_array")
    check_env(environment.unwrapped)


@pytest.mark.parametrize("name", IDS)
def test_make_vec_gives_as_many_as_asked(name: str) -> None:
    environment = gymnasium.make_vec(name, num_envs=3)
    assert isinstance(environment.unwrapped, squall.VectorEnv)
    observations, _ = environment.reset(seed=1)
    assert environment.num_envs == 3 and observations in environment.observation_space
    for _ in range(3):
        observations, rewards, terminated, truncated, _ = environment.step(environment.action_space.sample())
        assert observations in environment.observation_space
        assert rewards.shape == terminated.shape == truncated.shape == (3,)


@pytest.mark.parametrize("options", [{}, {"team": "red"}, {"action": "continuous", "game": "pyquaticus_2v2"}])
def test_pettingzoo_accepts(options: dict) -> None:
    testing = pytest.importorskip("pettingzoo.test")
    testing.parallel_api_test(squall.parallel_env(episode_max_s=20, **options), num_cycles=200)
    testing.parallel_seed_test(lambda: squall.parallel_env(episode_max_s=20, **options), num_cycles=100)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("name", IDS)
def test_stable_baselines3_accepts(name: str) -> None:
    checker = pytest.importorskip("stable_baselines3.common.env_checker")
    checker.check_env(gymnasium.make(name))


def test_every_game_with_equal_teams_has_an_environment_by_default() -> None:
    games = sorted(file.stem for file in squall.SCENARIOS.glob("games/*.toml") if "500v500" not in file.name)
    assert "mctf_2026" in games
    for game in games:
        if game != "uneven_3v2":
            environment = squall.TeamEnv(game=game, seed=1)
            environment.reset()
            environment.step(environment.action_space.sample())
            assert environment.native.step_s == (1.0 if game.startswith("mctf_2026") else 0.5)


def test_single_games_are_those_of_the_vector() -> None:
    vector = squall.VectorEnv(1, row="team", seed=7, episode_max_s=30)
    single = squall.TeamEnv(seed=7, episode_max_s=30)
    assert (vector.reset()[0][0] == single.reset()[0]).all()
    rng = np.random.default_rng(1)
    for _ in range(60):
        action = rng.integers(0, 17, 2)
        shown, rewards, _, cut_off, info = vector.step(action[np.newaxis])
        observation, reward, _, truncated, single_info = single.step(action)
        assert truncated == cut_off[0] and abs(rewards[0] - reward) < 1e-6
        assert (observation == (info["final_obs"][0] if truncated else shown[0])).all()
    assert truncated
    assert single_info["seed"] == info["final_info"]["seed"][0] == 7
    assert {f"_{name}" for name in single_info if name not in ("counts", "action_mask")} <= info["final_info"].keys()
    assert (single.reset(seed=8)[0] == shown[0]).all() and info["seed"][0] == 8


def test_a_team_is_its_boats() -> None:
    boats = squall.VectorEnv(3, seed=2, opponents="policy")
    teams = squall.VectorEnv(3, seed=2, opponents="policy", row="team")
    assert (boats.num_envs, teams.num_envs) == (12, 6)
    first, second = boats.reset()[0], teams.reset()[0]
    actions = np.arange(12) % 17
    for _ in range(20):
        assert (first.reshape(6, 2, -1) == second).all()
        first, rewards, *_ = boats.step(actions)
        second, team_rewards, *_ = teams.step(actions.reshape(6, 2))
        np.testing.assert_allclose(rewards.reshape(6, 2).mean(axis=1), team_rewards, atol=1e-6)


def test_an_observation_of_pyquaticus_has_45_numbers_two_against_two() -> None:
    environment = squall.VectorEnv(1, game="pyquaticus_2v2", observation="pyquaticus")
    assert environment.single_observation_space.shape == (45,)
    names = environment.observation_names
    assert len(set(names)) == 45 and names[0] == "enemy_flag_bearing" and names[-1] == "enemy_2_tagged"


def test_frames_are_the_newest_first() -> None:
    environment = squall.VectorEnv(1, frames=3, seed=1)
    size = environment.single_observation_space.shape[0] // 3
    before = environment.reset()[0]
    assert (before[:, :size] == before[:, 2 * size :]).all()
    after = environment.step(np.zeros(2, dtype=int))[0]
    assert (after[:, size : 2 * size] == before[:, :size]).all() and environment.observation_names[size].startswith(
        "t-1."
    )


def test_a_boat_has_teammates_that_a_strategy_drives() -> None:
    environment = squall.BoatEnv(mates="strategy_4", game="pyquaticus_2v2", seed=3)
    observation, info = environment.reset(seed=3)
    assert observation.ndim == 1 and info["seed"] == 3 and info["team"] == 1 and info["counts"] is True
    assert {environment.native.boats(0)[0] for seed in range(4) if environment.reset(seed=seed)} == {0, 1, 2, 3}


def test_pictures_show_the_field() -> None:
    environment = squall.VectorEnv(2, row="team", render_mode="rgb_array")
    pictures = environment.render()
    assert len(pictures) == 2 and pictures[0].dtype == np.uint8 and pictures[0].shape[1:] == (640, 3)
    assert len(np.unique(pictures[0].reshape(-1, 3), axis=0)) >= 5
    assert squall.VectorEnv(1).render() is None
