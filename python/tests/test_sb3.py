"""Stable-Baselines3 trains on `squall.sb3.VecEnv`. Skipped where it is not installed."""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor

import squall
from squall.sb3 import VecEnv


def test_rows_are_those_of_the_vector() -> None:
    options = {"seed": 5, "episode_max_s": 5.0, "opponents": [(1, "policy"), (1, "pav01")]}
    ours, vector = VecEnv(2, **options), squall.VectorEnv(2, **options)
    assert (ours.reset() == vector.reset()[0]).all()
    for step in range(1, 21):
        actions = np.arange(8) + step % 5
        observations, rewards, dones, infos = ours.step(actions)
        expected, expected_rewards, terminated, truncated, info = vector.step(actions)
        assert (observations == expected).all() and (rewards == expected_rewards).all()
        assert (dones == (terminated | truncated)).all() and len(infos) == 8
        assert [one["counts"] for one in infos] == info["counts"].tolist()
        assert [one["seed"] for one in infos] == (info["final_info"] if dones.any() else info)["seed"].tolist()
        for row in np.flatnonzero(dones):
            assert (infos[row]["terminal_observation"] == info["final_obs"][row]).all()
            assert infos[row]["TimeLimit.truncated"] and infos[row]["score"] == info["final_info"]["score"][row]
    ours.seed(70)
    ours.reset()
    assert [one["seed"] for one in ours.reset_infos] == [70] * 4 + [71] * 4


def test_ppo_learns() -> None:
    # Rewards are for turning to starboard, so that a few updates are enough.
    environment = VecMonitor(
        VecEnv(8, seed=1, episode_max_s=16.0, reward=lambda step: float(step.action == 0)),
    )
    model = PPO("MlpPolicy", environment, n_steps=32, batch_size=128, learning_rate=3e-3, seed=1, device="cpu")
    before, _ = evaluate_policy(model, environment, n_eval_episodes=16, deterministic=False)
    model.learn(32 * 16 * 10)
    after, _ = evaluate_policy(model, environment, n_eval_episodes=16, deterministic=False)
    assert after > before + 5, "of 32 steps"


def test_masks_are_those_of_sb3_contrib() -> None:
    contrib = pytest.importorskip("sb3_contrib")
    model = contrib.MaskablePPO("MlpPolicy", VecEnv(2, seed=1), n_steps=16, batch_size=32, seed=1, device="cpu")
    model.learn(128)
    team = contrib.MaskablePPO("MlpPolicy", VecEnv(2, seed=1, row="team"), n_steps=16, batch_size=32, device="cpu")
    team.learn(64)


def test_pictures_and_attributes_are_the_vectors() -> None:
    environment = VecEnv(2, row="team", render_mode="rgb_array")
    environment.reset()
    picture = environment.render("rgb_array")
    assert picture is not None and picture.ndim == 3
    assert environment.get_attr("observation_names", [0]) == [environment.games.observation_names]
    assert environment.env_is_wrapped(VecMonitor) == [False, False]
    environment.close()
