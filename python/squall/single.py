"""One game at a time, as gymnasium's `Env`, for a team or for a single boat."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from typing_extensions import Unpack

from squall.picture import draw
from squall.recording import Recordings, folder_to_show
from squall.setup import (
    File,
    Options,
    action_space,
    actions_for,
    check_render_mode,
    native_environment,
    needs_no_policy,
    observation_space,
)


class _GameEnv(gymnasium.Env[NDArray[np.float32], Any]):
    """The common part of both environments."""

    metadata: dict[str, Any] = {"render_modes": ["human", "rgb_array"], "render_fps": 10}  # noqa: RUF012 (gymnasium's own)
    observation_space: gymnasium.spaces.Box  # type: ignore[assignment]

    def __init__(
        self, *, is_team: bool, seed: int | None, mates: File | None, render_mode: str | None, options: Options
    ) -> None:
        check_render_mode(render_mode, self.metadata["render_modes"])
        needs_no_policy(options, type(self).__name__)
        record = folder_to_show(render_mode)
        self.native = native_environment(options, seed=seed, games=1, threads=1, mates=mates, record=record)
        self._recordings = Recordings(self, self.native, render_mode)
        self.render_mode = render_mode
        boats = self.native.rows if is_team else None
        self.observation_space = observation_space(self.native, options, boats)
        self.action_space = action_space(self.native, boats)
        self._is_over = False
        # A game has started that no reset has returned yet.
        self._is_new = True

    @property
    def observation_names(self) -> list[str]:
        """The names of the values of a boat's observation, in order."""
        return self.native.observation_names

    @property
    def action_names(self) -> list[str] | None:
        """The names of the discrete actions, in order; None if actions are continuous."""
        return self.native.action_names

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Starts the game with this seed, or the next one."""
        super().reset(seed=seed)
        if seed is not None or not self._is_new:
            self.native.restart(seed)
            self._recordings.show()
        self._is_over, self._is_new = False, True
        return self._shown(self.native.observations), self._info(self.native.standing(0))

    def step(self, action: Any) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Plays a step. Raises ValueError, and plays nothing, for an action outside the space."""
        if self._is_over:
            raise gymnasium.error.ResetNeeded("the game is over: call reset first")
        native = self.native
        native.step(actions_for(native, action))
        terminated, truncated = bool(native.terminated[0]), bool(native.truncated[0])
        reward = float(native.rewards.mean())
        self._is_over = self._is_new = terminated or truncated
        if self._is_over:
            shown, standing = native.final_observations, native.finished()[0][2]
            self._recordings.show()
        else:
            shown, standing = native.observations, native.standing(0)
        return self._shown(shown), reward, terminated, truncated, self._info(standing)

    def render(self) -> NDArray[np.uint8] | None:
        """The game from above, (height, width, 3); after its last step the next game. None except for "rgb_array".

        With "human", Squall's page in a browser shows each game when it has ended: see the package's README.
        """
        return draw(self.native.scene(0)) if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Completes the recording. With `render_mode="human"`, shows it."""
        self._recordings.end()

    def _shown(self, observations: NDArray[np.float32]) -> NDArray[np.float32]:
        return observations.reshape(self.observation_space.shape).copy()

    def _info(self, standing: dict[str, int]) -> dict[str, Any]:
        counts = self.native.counts
        return {"counts": bool(counts[0]) if len(counts) == 1 else counts.copy(), **standing}


class TeamEnv(_GameEnv):
    """One game, in which an action controls all boats of a team.

    Observations are (boats, values), actions have an entry for each boat, and the reward is the mean over the boats. A strategy plays the
    other team. `info` is the state of play: `seed`, `team` (0 is the game's first), `steps`, `score`, `grabs`, `captures`, `tags`,
    `tagged`, `out_of_bounds`, `collisions`, the same with the prefix `enemy_`, and `counts`: the boats whose actions take effect.
    """

    def __init__(self, *, seed: int | None = None, render_mode: str | None = None, **options: Unpack[Options]) -> None:
        """Starts the game with a seed (None: any). Raises ValueError with all faults of options and files."""
        super().__init__(is_team=True, seed=seed, mates=None, render_mode=render_mode, options=options)


class BoatEnv(_GameEnv):
    """One game, in which an action controls one boat.

    A strategy controls its mates, so that there is one agent and nothing else in its world learns. The seed selects the boat, each in
    turn. To train a policy for all boats of a team, prefer `VectorEnv`, which has a row for each. `info` is that of `TeamEnv`, with a
    single truth value in `counts`.
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
