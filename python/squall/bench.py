"""How many steps a second: `python -m squall.bench`.

Steps of games with all four boats observed and random actions, at the game's own period of 0.1 s, with the spaces of Pyquaticus. An
agent step is one boat's. The time is the processor's, so that other programs change little. Pyquaticus is measured beside it where it can be imported (https://github.com/mit-ll-trusted-autonomy/pyquaticus).
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
"""Of Pyquaticus, where it cannot be measured: what this program measured of its version of 2025-11 (c0a3691) on Python 3.10, on a core
of a Xeon on which Squall's games through gymnasium.vector did 230,000."""


def steps_per_s(step: Callable[[], None], seconds: float) -> float:
    """How often in a second of processor time `step` can be called: the best of three, each a third of `seconds`."""
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
    """A step of so many games on one thread through gymnasium.vector."""
    environment = squall.VectorEnv(
        games, game=game, observation="pyquaticus", decision_s=None, opponents="policy", threads=1, seed=1, copy=copy
    )
    environment.reset()
    # Drawn before, as a policy's actions would not be drawn by numpy either.
    actions = np.random.default_rng(1).integers(0, 17, (256, environment.num_envs))
    turn = 0

    def step() -> None:
        nonlocal turn
        environment.step(actions[turn])
        turn = (turn + 1) % len(actions)

    return step


def parallel_step(environment: Any) -> Callable[[], None]:
    """A step of a game through PettingZoo's dictionaries, with a reset when it is over."""
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
    """Pyquaticus' own environment of two against two, or None where it is not installed."""
    try:
        from pyquaticus.config import get_std_config
        from pyquaticus.envs.pyquaticus import PyQuaticusEnv
    except ImportError:
        return None
    return PyQuaticusEnv(team_size=2, config_dict=get_std_config())


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(prog="python -m squall.bench", description=__doc__)
    parser.add_argument("--games", type=int, default=64, help="games in a batch (64)")
    parser.add_argument("--seconds", type=float, default=6.0, help="time for each row, s (6)")
    arguments = parser.parse_args()
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})
    other = pyquaticus_environment()
    if other is None:
        print(
            f"Pyquaticus is not installed: ratios are against {STATED_STEPS_PER_S:.0f} steps a second, a stated figure"
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
