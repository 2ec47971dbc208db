"""Squall for Python: games of capture the flag between boats, as environments for reinforcement learning.

`VectorEnv` plays many games in parallel, `TeamEnv` one game with the boats of one team, `BoatEnv` one game with a single boat, and
`parallel_env` one game in which every boat is an agent. They play the games of the program `squall`: the same referee, sea, boats and
opponents.
"""

import importlib

from squall._native import __version__
from squall.registration import register
from squall.reward import BoatStep, Event, State
from squall.scenario import SCENARIOS
from squall.setup import Options
from squall.single import BoatEnv, TeamEnv
from squall.vector import VectorEnv

__all__ = [
    "SCENARIOS",
    "BoatEnv",
    "BoatStep",
    "Event",
    "Options",
    "State",
    "TeamEnv",
    "VectorEnv",
    "__version__",
    "parallel_env",
    "register",
]

register()


def __getattr__(name: str) -> object:
    # PettingZoo and Stable-Baselines3 are optional, so they are imported only on demand.
    if name == "parallel_env":
        from squall.parallel import parallel_env

        return parallel_env
    if name == "sb3":
        return importlib.import_module("squall.sb3")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
