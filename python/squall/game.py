"""A single game: its phase, the seeds of the next games, its pictures and recordings."""

from __future__ import annotations

import enum
import functools
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from squall.picture import draw
from squall.recording import Recordings, folder_to_show
from squall.reward import RewardFunction
from squall.setup import File, Options, check_render_mode, native_environment


class Phase(enum.Enum):
    """The phase of an environment."""

    NEW = "call reset first"
    """The first game has begun, but no reset has returned it."""
    PLAYING = ""
    OVER = "the game is over: call reset first"
    CLOSED = "the environment is closed"


def check_phase(phase: Phase) -> None:
    """Raises ResetNeeded or ClosedEnvironmentError if no step can be played."""
    if phase is Phase.CLOSED:
        raise gymnasium.error.ClosedEnvironmentError(phase.value)
    if phase is not Phase.PLAYING:
        raise gymnasium.error.ResetNeeded(phase.value)


class Recreated:
    """An environment that is pickled and copied as its options: a copy begins with its first game."""

    _recipe: functools.partial[Any]
    phase: Phase

    def __reduce__(self) -> tuple[Any, ...]:
        return self._recipe, (), {"spec": getattr(self, "spec", None)}

    def __deepcopy__(self, memo: dict[int, Any]) -> Any:
        if self.phase is Phase.PLAYING:
            raise TypeError(
                f"a {type(self).__name__} cannot be copied during a game: create another one, reset it with the game's"
                " seed, and play the same actions"
            )
        copied = self._recipe()
        copied.__dict__.update(spec=getattr(self, "spec", None))
        return copied


class Game:
    """The only game of an environment. When it ends, it keeps its final state until it is reset."""

    def __init__(
        self,
        owner: object,
        options: Options,
        *,
        seed: int | None,
        render_mode: str | None,
        mates: File | None = None,
        state: bool = False,
    ) -> None:
        check_render_mode(render_mode, ["human", "rgb_array"])
        record = folder_to_show(render_mode)
        function = options.get("reward")
        self.native = native_environment(
            options, seed=seed, games=1, threads=1, mates=mates, state=state or function is not None, record=record
        )
        self._recordings = Recordings(owner, self.native, render_mode)
        self._reward = None if function is None else RewardFunction(function, self.native)
        self._is_drawn = options.get("starts") is None
        self._render_mode = render_mode
        self.phase = Phase.NEW

    def reset(self, seed: int | None, random: np.random.Generator) -> None:
        """Starts the game with this seed. None: the first game if no reset has returned it, otherwise a new one."""
        if self.phase is Phase.CLOSED:
            check_phase(self.phase)
        if seed is not None:
            self.native.restart(seed)
        elif self.phase is not Phase.NEW:
            # Drawn, so that environments with consecutive seeds do not play the same games.
            self.native.restart_games([(0, int(random.integers(2**32)) if self._is_drawn else None)])
        self._recordings.show()
        self.phase = Phase.PLAYING
        if self._reward is not None:
            self._reward.begin()

    def step(self, actions: NDArray[Any]) -> tuple[NDArray[np.float32], bool, bool]:
        """Plays a step. Returns the boats' rewards, and whether the game is over or was cut off."""
        native = self.native
        native.step(actions, restarts=False)
        terminated, truncated = bool(native.terminated[0]), bool(native.truncated[0])
        if terminated or truncated:
            self.phase = Phase.OVER
            self._recordings.show()
        return native.rewards if self._reward is None else self._reward.rewards(actions), terminated, truncated

    def picture(self) -> NDArray[np.uint8] | None:
        """The game from above, (height, width, 3). None unless the render mode is "rgb_array"."""
        return draw(self.native.scene(0)) if self._render_mode == "rgb_array" else None

    def close(self) -> None:
        """Completes the recording, and shows it if it is rendered for people."""
        self.phase = Phase.CLOSED
        self._recordings.end()
