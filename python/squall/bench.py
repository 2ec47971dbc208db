"""Measures steps per second: `python -m squall.bench`.

Plays games with all four boats observed and random actions, at the game's own period of 0.1 s, in the spaces of Pyquaticus. An agent
step is the step of one boat. Times are CPU times, so that other programs have little effect. If Pyquaticus can be imported
(https://github.com/mit-ll-trusted-autonomy/pyquaticus), it is measured too.
"""

from __future__ import annotations

import argparse
import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np

import squall

STATED_STEPS_PER_S = 430.0
"""Used if Pyquaticus cannot be measured: the result of this program for its version of 2025-11 (c0a3691) on Python 3.10, on a Xeon core
on which Squall's games reached 230,000 through gymnasium.vector."""


def steps_per_s(step: Callable[[], None], seconds: float) -> float:
    """Calls of `step` per second of CPU time: the best of three measurements, each a third of `seconds` long."""
    step()
    best = 0.0
    for _ in range(3):
        begun, count = time.process_time(), 0
        while (passed := time.process_time() - begun) < seconds / 3:
            step()
            count += 1
        best = max(best, count / passed)
    return best


def vector_step(game: str, games: int, *, copy: bool) -> Callable[[], None]:
    """A step of this many games on one thread through gymnasium.vector."""
    environment = squall.VectorEnv(
        games, game=game, observation="pyquaticus", decision_s=None, opponents="policy", threads=1, seed=1, copy=copy
    )
    environment.reset()
    # Draw the actions in advance: a policy would not draw them with numpy, so that cost must not count.
    actions = np.random.default_rng(1).integers(0, 17, (256, environment.num_envs))
    turn = 0

    def step() -> None:
        nonlocal turn
        environment.step(actions[turn])
        turn = (turn + 1) % len(actions)

    return step


def parallel_step(environment: Any) -> Callable[[], None]:
    """A step of a game through PettingZoo's dictionaries, with a reset at the end."""
    environment.reset()
    actions = np.random.default_rng(1).integers(0, 17, (256, 4)).tolist()
    turn = 0

    def step() -> None:
        nonlocal turn
        if not environment.agents:
            environment.reset()
        environment.step(dict(zip(environment.agents, actions[turn], strict=True)))
        turn = (turn + 1) % len(actions)

    return step


def pyquaticus_environment() -> Any:
    """Pyquaticus' own environment with two against two, or None if it is not installed."""
    try:
        from pyquaticus.config import get_std_config
        from pyquaticus.envs.pyquaticus import PyQuaticusEnv
    except ImportError:
        return None
    return PyQuaticusEnv(team_size=2, config_dict=get_std_config())


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(prog="python -m squall.bench", description=__doc__)
    parser.add_argument("--games", type=int, default=64, help="games in a batch (64)")
    parser.add_argument("--seconds", type=float, default=6.0, help="time per row, s (6)")
    arguments = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    other = pyquaticus_environment()
    if other is None:
        print(
            f"Pyquaticus is not installed: ratios refer to {STATED_STEPS_PER_S:.0f} steps per second, measured earlier"
        )
        bar = STATED_STEPS_PER_S
    else:
        bar = steps_per_s(parallel_step(other), arguments.seconds)
    print(f"{'one core':52} {'steps/s':>10} {'agent steps/s':>14} {'ratio':>8}")

    def row(name: str, rate: float) -> None:
        print(f"{name:52} {rate:10,.0f} {4 * rate:14,.0f} {rate / bar:7.1f}x", flush=True)

    if other is not None:
        row("Pyquaticus, PettingZoo, 1 game", bar)
    for game in ("pyquaticus_2v2", "surveyor_2v2"):
        for copy in (True, False):
            step = vector_step(game, arguments.games, copy=copy)
            rate = arguments.games * steps_per_s(step, arguments.seconds)
            row(f"{game}, gymnasium.vector, {arguments.games} games{'' if copy else ', copy=False'}", rate)
    try:
        from squall.parallel import parallel_env
    except ImportError:
        print("PettingZoo is not installed")
        return
    for game in ("pyquaticus_2v2", "surveyor_2v2"):
        environment = parallel_env(game=game, observation="pyquaticus", decision_s=None, seed=1)
        row(f"{game}, PettingZoo, 1 game", steps_per_s(parallel_step(environment), arguments.seconds))


if __name__ == "__main__":
    main()
