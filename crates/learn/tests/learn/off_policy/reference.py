"""Two optimiser steps of TD3 and of double DQN in numpy, in double precision, as the reference for `step.rs`.

    python crates/learn/tests/learn/off_policy/reference.py > crates/learn/tests/learn/off_policy/reference.txt

Written from the papers (Fujimoto, van Hoof and Meger 2018; van Hasselt, Guez and Silver 2016; Kingma and Ba 2015). Only the order of
parameters is the program's: layer by layer, for each input its weights to all outputs, then the biases. Weights, transitions and noise
are sines of a count, computed by both; `numbers` rounds them to single precision. Each output line has a name and its numbers.
"""

import numpy as np

ROWS = 300  # more than one shard
STATE, ACTIONS, HIDDEN = 3, 4, 5
LEARNING_RATE, DISCOUNT, REWARD_SCALE, TARGET_RATE = 1e-3, 0.9, 0.5, 0.1


def numbers(count, phase, size):
    return (size * np.sin(1.3 * np.arange(count) + phase)).astype(np.float32).astype(np.float64)


class Network:
    """A network with one hidden layer and hyperbolic tangents."""

    def __init__(self, inputs, outputs, phase):
        self.shapes = [(inputs, HIDDEN), (HIDDEN,), (HIDDEN, outputs), (outputs,)]
        self.parameters = numbers(sum(np.prod(shape) for shape in self.shapes), phase, 0.5)

    def parts(self):
        parts, start = [], 0
        for shape in self.shapes:
            parts.append(self.parameters[start : start + np.prod(shape)].reshape(shape))
            start += np.prod(shape)
        return parts

    def forward(self, rows):
        weights, biases, head, head_biases = self.parts()
        hidden = np.tanh(rows @ weights + biases)
        return hidden, hidden @ head + head_biases

    def backward(self, rows, hidden, by_output):
        weights, _, head, _ = self.parts()
        by_sums = (by_output @ head.T) * (1 - hidden**2)
        gradient = [rows.T @ by_sums, by_sums.sum(0), hidden.T @ by_output, by_output.sum(0)]
        return np.concatenate([part.ravel() for part in gradient]), by_sums @ weights.T


class Adam:
    def __init__(self, network, norm_max=None):
        self.network, self.norm_max, self.step_count = network, norm_max, 0
        self.mean, self.square = np.zeros_like(network.parameters), np.zeros_like(network.parameters)

    def step(self, gradient):
        norm = np.sqrt((gradient**2).sum())
        if self.norm_max is not None and norm > self.norm_max:
            gradient = gradient * self.norm_max / norm
        self.step_count += 1
        self.mean = 0.9 * self.mean + 0.1 * gradient
        self.square = 0.999 * self.square + 0.001 * gradient**2
        mean, square = self.mean / (1 - 0.9**self.step_count), self.square / (1 - 0.999**self.step_count)
        self.network.parameters = self.network.parameters - LEARNING_RATE * mean / (np.sqrt(square) + 1e-8)


def show(name, values):
    print(name, *(f"{value:.9g}" for value in np.atleast_1d(values)))


observations = numbers(ROWS * STATE, 0.1, 1.0).reshape(ROWS, STATE)
next_observations = numbers(ROWS * STATE, 0.2, 1.0).reshape(ROWS, STATE)
rewards = numbers(ROWS, 0.3, 4.0)
over = np.arange(ROWS) % 7 == 3
counts = np.arange(ROWS) % 5 != 1


def td3():
    actions = numbers(ROWS * 2, 0.4, 1.0).reshape(ROWS, 2)
    noise = numbers(ROWS * 2, 0.5, 0.5).reshape(ROWS, 2)
    actor, target_actor = Network(STATE, 2, 1), Network(STATE, 2, 2)
    critics = [Network(STATE + 2, 1, phase) for phase in (3, 4)]
    target_critics = [Network(STATE + 2, 1, phase) for phase in (5, 6)]
    actor_optimiser, critic_optimisers = Adam(actor), [Adam(critic) for critic in critics]
    for step in (1, 2):
        next_actions = np.clip(np.tanh(target_actor.forward(next_observations)[1]) + noise, -1, 1)
        next_inputs = np.hstack([next_observations, next_actions])
        expected = np.minimum(*(critic.forward(next_inputs)[1][:, 0] for critic in target_critics))
        targets = REWARD_SCALE * rewards + DISCOUNT * np.where(over, 0, expected)
        inputs, losses = np.hstack([observations, actions]), []
        for critic, optimiser in zip(critics, critic_optimisers):
            hidden, values = critic.forward(inputs)
            off = values[:, 0] - targets
            losses.append(0.5 * (off**2).mean())
            optimiser.step(critic.backward(inputs, hidden, off[:, None] / ROWS)[0])
        show(f"td3.critic_loss.{step}", np.mean(losses))
        if step % 2 == 0:
            rows = observations[counts]
            hidden, sums = actor.forward(rows)
            chosen = np.tanh(sums)
            inputs = np.hstack([rows, chosen])
            critic_hidden, values = critics[0].forward(inputs)
            show(f"td3.actor_loss.{step}", -values.mean())
            _, by_inputs = critics[0].backward(inputs, critic_hidden, np.full_like(values, -1 / len(rows)))
            actor_optimiser.step(actor.backward(rows, hidden, by_inputs[:, STATE:] * (1 - chosen**2))[0])
            for target, network in zip([target_actor, *target_critics], [actor, *critics]):
                target.parameters = (1 - TARGET_RATE) * target.parameters + TARGET_RATE * network.parameters
    for name, network in [
        ("actor", actor),
        ("target_actor", target_actor),
        ("critic.0", critics[0]),
        ("critic.1", critics[1]),
        ("target_critic.0", target_critics[0]),
        ("target_critic.1", target_critics[1]),
    ]:
        show(f"td3.{name}", network.parameters)


def dqn():
    actions = np.arange(ROWS) * 3 % ACTIONS
    network, target = Network(STATE, ACTIONS, 7), Network(STATE, ACTIONS, 8)
    optimiser, rows = Adam(network, norm_max=10.0), np.arange(ROWS)
    for step in (1, 2):
        best = network.forward(next_observations)[1].argmax(1)
        expected = target.forward(next_observations)[1][rows, best]
        targets = REWARD_SCALE * rewards + DISCOUNT * np.where(over, 0, expected)
        hidden, values = network.forward(observations)
        off = values[rows, actions] - targets
        small = np.abs(off) <= 1
        show(f"dqn.loss.{step}", np.where(small, 0.5 * off**2, np.abs(off) - 0.5).mean())
        by_values = np.zeros_like(values)
        by_values[rows, actions] = np.where(small, off, np.sign(off)) / ROWS
        optimiser.step(network.backward(observations, hidden, by_values)[0])
    show("dqn.network", network.parameters)


td3()
dqn()
