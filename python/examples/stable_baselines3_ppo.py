"""Stable-Baselines3's PPO for one boat, with a strategy for its mate: `pip install stable-baselines3`."""

import argparse

from stable_baselines3 import PPO
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.evaluation import evaluate_policy

import squall  # noqa: F401 (registers the environments)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=200_000)
    arguments = parser.parse_args()
    options = {"game": "pyquaticus_2v2", "opponents": "pav01", "mates": "pav01", "episode_max_s": 120}
    environment = make_vec_env("Squall/CaptureTheFlagBoat-v0", n_envs=8, seed=1, env_kwargs=options)
    model = PPO("MlpPolicy", environment, n_steps=256, batch_size=512, gamma=0.99, verbose=1, seed=1, device="cpu")
    model.learn(arguments.steps)
    mean, deviation = evaluate_policy(model, environment, n_eval_episodes=8)
    print(f"reward per episode: {mean:.2f}, standard deviation {deviation:.2f}")
    model.save("boat")


if __name__ == "__main__":
    main()
