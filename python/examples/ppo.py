"""PPO in one file, with one policy for all boats, in the style of CleanRL. Needs torch: `python ppo.py --steps 2000000`."""

from __future__ import annotations

import argparse
import time

import numpy as np
import torch
from torch import nn

import squall

GAMES, STEPS, EPOCHS, MINIBATCH = 64, 64, 4, 2048
DISCOUNT, LAMBDA, CLIP, ENTROPY, VALUE, LEARNING_RATE = 0.995, 0.95, 0.2, 0.01, 0.5, 3e-4


class Policy(nn.Module):
    """Computes the logits of the 17 actions, and the value, from an observation."""

    def __init__(self, numbers: int, actions: int) -> None:
        super().__init__()
        self.body = nn.Sequential(nn.Linear(numbers, 128), nn.Tanh(), nn.Linear(128, 128), nn.Tanh())
        self.logits, self.value = nn.Linear(128, actions), nn.Linear(128, 1)
        nn.init.orthogonal_(self.logits.weight, 0.01)

    def forward(self, observations: torch.Tensor) -> tuple[torch.distributions.Categorical, torch.Tensor]:
        hidden = self.body(observations)
        return torch.distributions.Categorical(logits=self.logits(hidden)), self.value(hidden).squeeze(-1)


def advantages_of(rewards, values, next_values, ends):
    """Generalised advantages, (steps, rows). `next_values` are the values after each step, still in the old game."""
    advantages, later = torch.zeros_like(rewards), torch.zeros_like(rewards[0])
    for i in reversed(range(len(rewards))):
        surprise = rewards[i] + DISCOUNT * next_values[i] - values[i]
        later = surprise + DISCOUNT * LAMBDA * (1 - ends[i]) * later
        advantages[i] = later
    return advantages


def played(environment, policy, observations, counts):
    """Plays some steps of all games. Returns tensors (steps, rows, ...) and the scores of games that ended."""
    keys = ("observations", "actions", "log_probabilities", "values", "rewards", "next_values", "ends", "counts")
    batch, finished = {key: [] for key in keys}, []
    for _ in range(STEPS):
        shown = torch.as_tensor(observations)
        with torch.no_grad():
            chances, values = policy(shown)
            actions = chances.sample()
        observations, rewards, terminated, truncated, info = environment.step(actions.numpy())
        with torch.no_grad():
            next_values = policy(torch.as_tensor(observations))[1]
            if "final_obs" in info:
                ended = np.flatnonzero(info["_final_obs"])
                last = torch.as_tensor(np.stack(info["final_obs"][ended]))
                # The value after the end of a game is 0, but not after an episode that was cut off.
                next_values[ended] = policy(last)[1] * torch.as_tensor(~terminated[ended])
                final = info["final_info"]
                finished += list(zip(final["score"][ended], final["enemy_score"][ended], strict=True))
        step = (shown, actions, chances.log_prob(actions), values, rewards, next_values, terminated | truncated, counts)
        for key, value in zip(keys, step, strict=True):
            batch[key].append(torch.as_tensor(value))
        counts = info["counts"]
    tensors = {key: torch.stack(values) for key, values in batch.items()}
    tensors["ends"] = tensors["ends"].float()
    return tensors, finished, observations, counts


def learn(policy, optimiser, batch):
    """Trains for some epochs of PPO. The policy learns only from actions that counted, the critic from all samples."""
    advantages = advantages_of(*(batch[key] for key in ("rewards", "values", "next_values", "ends")))
    flat = {key: value.flatten(0, 1) for key, value in batch.items()}
    flat["advantages"] = advantages.flatten()
    flat["returns"] = flat["advantages"] + flat["values"]
    for _ in range(EPOCHS):
        for chosen in torch.randperm(len(flat["actions"])).split(MINIBATCH):
            one = {key: value[chosen] for key, value in flat.items()}
            chances, values = policy(one["observations"])
            error = (values - one["returns"]).square().mean()
            counts = one["counts"]
            chances = torch.distributions.Categorical(logits=chances.logits[counts])
            one = {key: value[counts] for key, value in one.items()}
            ratio = (chances.log_prob(one["actions"]) - one["log_probabilities"]).exp()
            gain = (one["advantages"] - one["advantages"].mean()) / (one["advantages"].std() + 1e-8)
            surrogate = torch.min(ratio * gain, ratio.clamp(1 - CLIP, 1 + CLIP) * gain).mean()
            loss = VALUE * error - surrogate - ENTROPY * chances.entropy().mean()
            optimiser.zero_grad()
            loss.backward()
            nn.utils.clip_grad_norm_(policy.parameters(), 0.5)
            optimiser.step()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--steps", type=int, default=2_000_000, help="total number of agent steps")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    torch.manual_seed(arguments.seed)
    environment = squall.VectorEnv(
        GAMES, game="pyquaticus_2v2", opponents="pav01", discount=DISCOUNT, seed=arguments.seed, episode_max_s=300
    )
    policy = Policy(environment.single_observation_space.shape[0], environment.single_action_space.n)
    optimiser = torch.optim.Adam(policy.parameters(), LEARNING_RATE, eps=1e-5)
    observations, info = environment.reset()
    counts, begun = info["counts"], time.perf_counter()
    for update in range(1, arguments.steps // (STEPS * environment.num_envs) + 1):
        batch, finished, observations, counts = played(environment, policy, observations, counts)
        learn(policy, optimiser, batch)
        steps = update * STEPS * environment.num_envs
        scores = f"{np.mean(finished, axis=0)} points, own and enemies'" if finished else "no game ended"
        rate = steps / (time.perf_counter() - begun)
        print(f"{steps} steps, {rate:.0f} per second, reward {batch['rewards'].mean():.4f} per step, {scores}", flush=True)
    torch.save(policy.state_dict(), "policy.pt")


if __name__ == "__main__":
    main()
