"""The environments' ids for `gymnasium.make` and `gymnasium.make_vec`."""

from __future__ import annotations

from typing import Any

import gymnasium

_PYQUATICUS = {"game": "pyquaticus_2v2", "observation": "pyquaticus", "rewards": "pyquaticus", "decision_s": 0.1}

_ENVIRONMENTS: list[tuple[str, str, str, dict[str, Any]]] = [
    ("Squall/CaptureTheFlag-v0", "squall.single:TeamEnv", "squall.registration:team_vector", {}),
    ("Squall/CaptureTheFlagBoat-v0", "squall.single:BoatEnv", "squall.registration:boat_vector", {}),
    ("Squall/Pyquaticus-v0", "squall.single:TeamEnv", "squall.registration:team_vector", _PYQUATICUS),
    ("Squall/PyquaticusBoat-v0", "squall.single:BoatEnv", "squall.registration:boat_vector", _PYQUATICUS),
]


def register() -> None:
    """Registers all ids, once."""
    for name, entry_point, vector_entry_point, kwargs in _ENVIRONMENTS:
        if name not in gymnasium.registry:
            gymnasium.register(
                name,
                entry_point=entry_point,
                vector_entry_point=vector_entry_point,
                kwargs=kwargs,
                # Fewer wrappers around each step; the tests check the environments instead.
                disable_env_checker=True,
            )


def team_vector(num_envs: int = 1, **options: Any) -> gymnasium.vector.VectorEnv[Any, Any, Any]:
    """A `VectorEnv` of this many games, each like a `TeamEnv`."""
    from squall.vector import VectorEnv

    return VectorEnv(num_envs, row="team", **options)


def boat_vector(num_envs: int = 1, **options: Any) -> gymnasium.vector.VectorEnv[Any, Any, Any]:
    """A `VectorEnv` of this many games, each like a `BoatEnv`."""
    from squall.vector import VectorEnv

    return VectorEnv(num_envs, row="boat", **{"mates": "pav01", **options})
