"""Squall for Python: boats that play capture the flag, as environments for reinforcement learning.

`VectorEnv` plays many games at a time, `TeamEnv` one game with one team's boats, `BoatEnv` one with a single boat, and
`parallel_env` one with every boat an agent. All play the games of the program `squall`: the same referee, sea, boats and opponents.
"""

from squall._native import __version__
from squall.registration import register
from squall.scenario import SCENARIOS
from squall.setup import Options
from squall.single import BoatEnv, TeamEnv
from squall.vector import VectorEnv

__all__ = ["SCENARIOS", "BoatEnv", "Options", "TeamEnv", "VectorEnv", "__version__", "parallel_env", "register"]

register()


def __getattr__(name: str) -> object:
    # PettingZoo is optional, so it is imported by whoever asks for what needs it.
    if name == "parallel_env":
        from squall.parallel import parallel_env

        return parallel_env
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
