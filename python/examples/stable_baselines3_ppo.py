"""Stable-Baselines3's PPO with one policy for all boats of a team: `pip install stable-baselines3`."""

import argparse

from stable_baselines3 import PPO
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.vec_env import VecMonitor

from squall.sb3 import VecEnv


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=200_000)
    arguments = parser.parse_args()
    environment = VecMonitor(VecEnv(32, game="pyquaticus_2v2", opponents="pav01", episode_max_s=120, seed=1))
    model = PPO("MlpPolicy", environment, n_steps=64, batch_size=512, gamma=0.99, verbose=1, seed=1, device="cpu")
    model.learn(arguments.steps)
    mean, deviation = evaluate_policy(model, environment, n_eval_episodes=64)
    print(f"reward per episode: {mean:.2f}, standard deviation {deviation:.2f}")
    model.save("boat")


if __name__ == "__main__":
    main()
