"""One game at a time, as gymnasium's `Env`, for a team or for a single boat."""

from __future__ import annotations

import functools
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from typing_extensions import Unpack

from squall.game import Game, Phase, Recreated, check_phase
from squall.recording import available_modes
from squall.setup import (
    File,
    Options,
    action_mask,
    action_space,
    actions_for,
    checked_seed,
    has_boat,
    needs_no_policy,
    observation_space,
    team_mean,
)


class _GameEnv(Recreated, gymnasium.Env[NDArray[np.float32], Any]):
    """The common part of both environments."""

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 10}  # noqa: RUF012 (gymnasium's own)
    observation_space: gymnasium.spaces.Box  # type: ignore[assignment]

    def __init__(
        self, *, is_team: bool, seed: int | None, mates: File | None, render_mode: str | None, options: Options
    ) -> None:
        needs_no_policy(options, type(self).__name__)
        self._game = Game(self, options, seed=seed, mates=mates, render_mode=render_mode)
        self.native = self._game.native
        if seed is not None:
            super().reset(seed=checked_seed(seed))
        kind: Any = type(self)
        of_kind = {} if is_team else {"mates": mates}
        self._recipe = functools.partial(kind, seed=seed, render_mode=render_mode, **of_kind, **options)
        self.metadata = {**self.metadata, "render_modes": available_modes(self.metadata["render_modes"])}
        self.render_mode = render_mode
        boats = self.native.rows if is_team else None
        self.observation_space = observation_space(self.native, options, boats)
        self.action_space = action_space(self.native, boats)

    @property
    def phase(self) -> Phase:  # type: ignore[override]
        """The phase of the environment."""
        return self._game.phase

    @property
    def observation_names(self) -> list[str]:
        """The names of the values of a boat's observation, in order."""
        return self.native.observation_names

    @property
    def action_names(self) -> list[str] | None:
        """The names of the discrete actions, in order; None if actions are continuous."""
        return self.native.action_names

    def action_masks(self) -> NDArray[np.bool_]:
        """The possible actions of all boats in one row, for sb3-contrib. Raises ValueError if actions are continuous."""
        mask = action_mask(self.native)
        if mask is None:
            raise ValueError("continuous actions have no mask")
        return mask.astype(bool).reshape(-1)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts the game with this seed, or one drawn from `np_random`."""
        seed = None if seed is None else checked_seed(seed)
        super().reset(seed=seed)
        self._game.reset(seed, self.np_random)
        return self._shown(), self._info(self.native.standing(0))

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Plays a step. Raises ValueError, and plays nothing, for an action outside the space."""
        check_phase(self.phase)
        rows = actions_for(self.native, action, self.action_space.shape)
        rewards, terminated, truncated = self._game.step(rows)
        reward = float(team_mean(rewards, has_boat(self.native)))
        return self._shown(), reward, terminated, truncated, self._info(self.native.standing(0))

    def render(self) -> NDArray[np.uint8] | None:
        """The game from above, (height, width, 3). None unless the render mode is "rgb_array".

        With "human", Squall's page in a browser shows each game when it has ended: see the package's README.
        """
        return self._game.picture()

    def close(self) -> None:
        """Completes the recording. With `render_mode="human"`, shows it."""
        self._game.close()

    def _shown(self) -> NDArray[np.float32]:
        return self.native.observations.reshape(self.observation_space.shape).copy()

    def _info(self, standing: dict[str, int]) -> dict[str, Any]:
        counts, mask = self.native.counts, action_mask(self.native)
        is_boat = len(self.observation_space.shape) == 1
        info: dict[str, Any] = {"counts": bool(counts[0]) if is_boat else counts.copy(), **standing}
        if mask is not None:
            info["action_mask"] = mask[0] if is_boat else mask
        return info


class TeamEnv(_GameEnv):
    """One game, in which an action controls all boats of a team.

    Observations are (boats, values), actions have an entry for each boat, and the reward is the mean over the boats. A strategy plays the
    other team. `info` is the state of play: `seed`, `team` (0 is the game's first), `steps`, `score`, `grabs`, `captures`, `tags`,
    `tagged`, `out_of_bounds`, `collisions`, the same with the prefix `enemy_`, and `counts`: the boats whose actions take effect. With
    discrete actions, `action_mask` has a row for each boat, with 1 for each possible action: only the last one if none takes effect.
    """

    def __init__(self, *, seed: int | None = None, render_mode: str | None = None, **options: Unpack[Options]) -> None:
        """Starts the game with a seed (None: any). Raises ValueError with all faults of options and files."""
        super().__init__(is_team=True, seed=seed, mates=None, render_mode=render_mode, options=options)


class BoatEnv(_GameEnv):
    """One game, in which an action controls one boat.

    A strategy controls its teammates, so that only one agent learns. The seed selects the boat: consecutive seeds take the boats in turn.
    To train a policy for all boats of a team, prefer `VectorEnv`, which has a row for each. `info` is that of `TeamEnv`, with a single
    truth value in `counts` and a single row in `action_mask`.
    """

    def __init__(
        self,
        *,
        mates: File = "pav01",
        seed: int | None = None,
        render_mode: str | None = None,
        **options: Unpack[Options],
    ) -> None:
        """Starts the game with a seed (None: any). Raises ValueError with all faults of options and files."""
        super().__init__(is_team=False, seed=seed, mates=mates, render_mode=render_mode, options=options)
