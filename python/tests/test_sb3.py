"""Stable-Baselines3 trains on `squall.sb3.VecEnv`. Without it, some tests use a stub of its base class."""

import importlib
import sys
from collections.abc import Iterator
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest

import squall


class BaseVecEnv:
    """The parts of Stable-Baselines3's `VecEnv` that `squall.sb3` uses."""

    def __init__(self, num_envs: int, observation_space: Any, action_space: Any) -> None:
        self.num_envs, self.observation_space, self.action_space = num_envs, observation_space, action_space
        self._reset_seeds()

    def seed(self, seed: int) -> None:
        self._seeds = [seed + row for row in range(self.num_envs)]

    def step(self, actions: np.ndarray) -> Any:
        self.step_async(actions)  # type: ignore[attr-defined]
        return self.step_wait()  # type: ignore[attr-defined]

    def _reset_seeds(self) -> None:
        self._seeds: list[int | None] = [None] * self.num_envs

    def _reset_options(self) -> None:
        pass

    def _get_indices(self, indices: Any) -> Any:
        return range(self.num_envs) if indices is None else indices


@pytest.fixture
def sb3(monkeypatch: pytest.MonkeyPatch) -> Iterator[ModuleType]:
    """The module `squall.sb3`."""
    try:
        import stable_baselines3  # noqa: F401
    except ImportError:
        for name in ("stable_baselines3", "stable_baselines3.common"):
            monkeypatch.setitem(sys.modules, name, ModuleType(name))
        vec_env: Any = SimpleNamespace(VecEnv=BaseVecEnv)
        monkeypatch.setitem(sys.modules, "stable_baselines3.common.vec_env", vec_env)
    yield importlib.import_module("squall.sb3")
    sys.modules.pop("squall.sb3", None)


def test_rows_are_those_of_the_vector(sb3: ModuleType) -> None:
    options = {"seed": 5, "episode_max_s": 5.0, "opponents": [(1, "policy"), (1, "pav01")]}
    ours, vector = sb3.VecEnv(2, **options), squall.VectorEnv(2, **options)
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


def test_ppo_learns(sb3: ModuleType) -> None:
    ppo = pytest.importorskip("stable_baselines3.ppo").PPO
    # With tiny networks, several threads mostly wait for each other.
    pytest.importorskip("torch").set_num_threads(1)
    from stable_baselines3.common.evaluation import evaluate_policy
    from stable_baselines3.common.vec_env import VecMonitor

    # Rewards are for turning to starboard, so that a few updates are enough.
    environment = VecMonitor(sb3.VecEnv(8, seed=1, episode_max_s=16.0, reward=lambda step: float(step.action == 0)))
    model = ppo("MlpPolicy", environment, n_steps=32, batch_size=128, learning_rate=3e-3, seed=1, device="cpu")
    before, _ = evaluate_policy(model, environment, n_eval_episodes=16, deterministic=False)
    model.learn(32 * 16 * 10)
    after, _ = evaluate_policy(model, environment, n_eval_episodes=16, deterministic=False)
    assert after > before + 5, "of 32 steps"


def test_masks_are_those_of_sb3_contrib(sb3: ModuleType) -> None:
    contrib = pytest.importorskip("sb3_contrib")
    model = contrib.MaskablePPO("MlpPolicy", sb3.VecEnv(2, seed=1), n_steps=16, batch_size=32, seed=1, device="cpu")
    model.learn(128)
    team = contrib.MaskablePPO("MlpPolicy", sb3.VecEnv(2, seed=1, row="team"), n_steps=16, batch_size=32, device="cpu")
    team.learn(64)


def test_pictures_and_attributes_are_the_vectors(sb3: ModuleType) -> None:
    environment = sb3.VecEnv(2, row="team", render_mode="rgb_array")
    environment.reset()
    assert [picture.shape[2] for picture in environment.get_images()] == [3, 3]
    assert environment.get_attr("observation_names", [0]) == [environment.games.observation_names]
    assert [mask.shape for mask in environment.env_method("action_masks")] == [(34,), (34,)]
    assert environment.env_is_wrapped(object) == [False, False]
    environment.set_attr("copy", False)
    assert environment.get_attr("copy") == [False, False]
    environment.close()
