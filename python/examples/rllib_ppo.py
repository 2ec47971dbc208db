"""RLlib's PPO with one policy for all boats of a team: `python rllib_ppo.py --iterations 100`.

Needs `pip install "ray[rllib]==2.60.0" gymnasium==1.2.2 torch pettingzoo`, 6 GB on Linux, where PyPI's torch includes CUDA.
"""

from __future__ import annotations

import argparse

from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from ray.tune.registry import register_env

import squall

GAME = {
    "game": "pyquaticus_2v2",
    "observation": "pyquaticus",
    "team": "blue",
    "opponents": "pav01",
    "episode_max_s": 120.0,
}


def config_of(runners: int, seed: int) -> PPOConfig:
    """The PPO configuration: every boat of the team uses the policy "boat"."""
    return (
        PPOConfig()
        .environment("squall", env_config=GAME)
        .env_runners(num_env_runners=runners, num_envs_per_env_runner=8)
        .multi_agent(policies={"boat"}, policy_mapping_fn=lambda agent, episode, **_: "boat")
        .training(
            train_batch_size_per_learner=2048, minibatch_size=512, num_epochs=4, lr=3e-4, gamma=0.99, lambda_=0.95
        )
        .debugging(seed=seed)
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--iterations", type=int, default=5, help="iterations of 2048 steps (5)")
    parser.add_argument("--runners", type=int, default=1, help="processes that play games; 0: this process (1)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    register_env("squall", lambda options: ParallelPettingZooEnv(squall.parallel_env(**options)))
    algorithm = config_of(arguments.runners, arguments.seed).build_algo()
    for iteration in range(1, arguments.iterations + 1):
        result = algorithm.train()
        played = result["env_runners"]
        print(
            f"{iteration}: {played['num_env_steps_sampled_lifetime']} steps,"
            f" reward per game {played.get('episode_return_mean', float('nan')):.2f}",
            flush=True,
        )
    print(f"saved in {algorithm.save_to_path()}")
    algorithm.stop()


if __name__ == "__main__":
    main()
