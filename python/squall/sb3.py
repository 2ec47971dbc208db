"""Many parallel games, as Stable-Baselines3's `VecEnv`. Import it yourself: `from squall.sb3 import VecEnv`."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import VecEnv as BaseVecEnv

from squall.vector import VectorEnv


class VecEnv(BaseVecEnv):  # type: ignore[misc]
    """Stable-Baselines3's view of `squall.VectorEnv`: one environment per row, stepped together.

    Each entry of `infos` has the row's values of `VectorEnv`'s info. At the end of a game it also has `terminal_observation`,
    `TimeLimit.truncated` and the final state of play. Wrap it in Stable-Baselines3's `VecMonitor` for statistics of episodes.
    """

    def __init__(self, games: int = 1, **options: Any) -> None:
        """Takes the arguments of `squall.VectorEnv`."""
        self.games = VectorEnv(games, **options)
        self._actions: Any = None
        super().__init__(self.games.num_envs, self.games.single_observation_space, self.games.single_action_space)

    def reset(self) -> NDArray[np.float32]:
        """Restarts all games, with the seed of `seed` if it was called."""
        observations, info = self.games.reset(seed=self._seeds[0])
        self._reset_seeds()
        self._reset_options()
        self.reset_infos = self._infos(info)
        return observations

    def step_async(self, actions: NDArray[Any]) -> None:
        """Stores the actions for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_], list[dict[str, Any]]]:
        """Plays a step. Raises ValueError, and plays nothing, for invalid actions."""
        observations, rewards, terminated, truncated, info = self.games.step(self._actions)
        ended = terminated | truncated
        infos = self._infos(info)
        for row in np.flatnonzero(ended):
            final = info["final_info"]
            infos[row].update({name: final[name][row] for name in final if not name.startswith("_")})
            infos[row]["terminal_observation"] = info["final_obs"][row]
            infos[row]["TimeLimit.truncated"] = bool(truncated[row] and not terminated[row])
        return observations, rewards, ended, infos

    def close(self) -> None:
        """Completes the recordings."""
        self.games.close()

    def get_images(self) -> Sequence[NDArray[np.uint8] | None]:
        """A picture of each row's game; None without `render_mode="rgb_array"`."""
        return self.games.render() or [None] * self.num_envs

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """The attribute of `VectorEnv`, for each row."""
        return [getattr(self.games, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Sets the attribute of `VectorEnv`, which all rows share."""
        setattr(self.games, attr_name, value)

    def env_method(self, method_name: str, *method_args: Any, indices: Any = None, **method_kwargs: Any) -> list[Any]:
        """Calls a method of `VectorEnv` once, and returns its result for each row. "action_masks", for sb3-contrib, has a mask for each."""
        result = getattr(self.games, method_name)(*method_args, **method_kwargs)
        chosen: Iterable[int] = self._get_indices(indices)
        return [result[row] if method_name == "action_masks" else result for row in chosen]

    def env_is_wrapped(self, wrapper_class: Any, indices: Any = None) -> list[bool]:
        """Rows have no wrappers."""
        return [False for _ in self._get_indices(indices)]

    def _infos(self, info: dict[str, Any]) -> list[dict[str, Any]]:
        names = [name for name in ("counts", "seed", "action_mask") if name in info]
        columns = [info[name] for name in names]
        return [dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)]
