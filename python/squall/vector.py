"""Many parallel games, as gymnasium's `VectorEnv`."""

from __future__ import annotations

import functools
import os
from collections.abc import Sequence
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray
from typing_extensions import Unpack

from squall.game import Phase, Recreated, check_phase
from squall.picture import draw
from squall.recording import Recordings
from squall.reward import RewardFunction
from squall.setup import (
    File,
    Options,
    action_mask,
    action_space,
    actions_for,
    check_render_mode,
    checked_seed,
    has_boat,
    native_environment,
    observation_space,
    team_mean,
)

# gymnasium 1.0 lacks this enumeration.
_MODES = {mode: getattr(gymnasium.vector, "AutoresetMode", str)(mode) for mode in ("SameStep", "NextStep")}


class VectorEnv(Recreated, gymnasium.vector.VectorEnv[NDArray[np.float32], NDArray[Any], NDArray[Any]]):
    """Parallel games, with one environment per row.

    A row is a boat (`row="boat"`, the default), for policies shared by boats, or a team (`row="team"`). For a team an observation is
    (boats, values), an action has one entry for each boat, and the reward is the mean over the boats. Rows are ordered by game; within a
    game the learning team comes first and then, in self-play, the other team. `num_envs` is the number of rows. The rows of a game end
    together.

    A game restarts in the step in which it ends (`AutoresetMode.SAME_STEP`): that step returns the first observation of the new game,
    `info["final_obs"]` has the last one of the old game, and `info["final_info"]` its final state of play. With
    `autoreset_mode="NextStep"`, for wrappers such as `NormalizeObservation`, the last observation is the step's own; the next step
    returns the first one of the new game, and ignores the actions of its rows.

    `info["counts"]` (num_envs,) says whether a row's next action takes effect: a tagged boat drives home whatever its action, against a
    strategy the enemies need no actions, and with `team_sizes` a boat may be absent (the rows of both are 0). A policy should ignore samples
    where it is False; a critic should learn from them, or it misjudges being tagged. With discrete actions, `info["action_mask"]` has 1 for
    each possible action of each boat: only the last one if none takes effect. `info["seed"]` (num_envs,) is the seed of the game.

    With `record`, every game or every `record_every`th is recorded. Each has an open file and a thread that writes it.

    With `copy=False`, `step` and `reset` return the environment's own arrays, which the next call overwrites.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 (gymnasium's own declaration)
        "render_modes": ["rgb_array"],
        "render_fps": 10,
        "autoreset_mode": _MODES["SameStep"],
    }

    # gymnasium also closes an environment whose creation failed.
    _recordings: Recordings | None = None

    def __init__(
        self,
        games: int = 1,
        *,
        row: Literal["boat", "team"] = "boat",
        threads: int | None = None,
        seed: int | None = None,
        mates: File | None = None,
        copy: bool = True,
        state: bool = False,
        render_mode: str | None = None,
        autoreset_mode: Any = "SameStep",
        **options: Unpack[Options],
    ) -> None:
        """Starts `games` games on this many threads (None: one per core), with seeds that count up from `seed` (None: any).

        `mates` is a strategy for all but one boat of a team, as in `BoatEnv`; None: all boats are rows. Results depend only on seed and
        actions, not on threads. With `state`, `states` is available. Raises ValueError with all faults of options and scenario files.
        """
        if row not in ("boat", "team"):
            raise ValueError(f'row is {row!r}, expected "boat" or "team"')
        check_render_mode(render_mode, self.metadata["render_modes"])
        mode = getattr(autoreset_mode, "value", autoreset_mode)
        if mode not in _MODES:
            raise ValueError(f'autoreset_mode is {mode!r}, expected "SameStep" or "NextStep"')
        self.metadata = {**self.metadata, "autoreset_mode": _MODES[mode]}
        self._is_same_step = mode == "SameStep"
        self._recipe = functools.partial(
            type(self),
            games,
            row=row,
            threads=threads,
            seed=seed,
            mates=mates,
            copy=copy,
            state=state,
            render_mode=render_mode,
            autoreset_mode=mode,
            **options,
        )
        threads = min(games, os.cpu_count() or 1) if threads is None else threads
        function = options.get("reward")
        self.native = native_environment(
            options,
            seed=seed,
            games=games,
            threads=max(threads, 1),
            mates=mates,
            state=state or function is not None,
        )
        self._reward = None if function is None else RewardFunction(function, self.native)
        self._recordings = Recordings(self, self.native)
        self.render_mode, self.copy, self.games = render_mode, copy, games
        native = self.native
        self.boats_per_team = native.rows_per_team
        self.boats_per_row = self.boats_per_team if row == "team" else 1
        self.rows_per_game = native.rows_per_game // self.boats_per_row
        self.num_envs = games * self.rows_per_game
        boats = self.boats_per_row if row == "team" else None
        self.single_observation_space = observation_space(native, options, boats)
        self.single_action_space = action_space(native, boats)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self._observations = native.observations.reshape(self.observation_space.shape)
        self._final_observations = native.final_observations.reshape(self.observation_space.shape)
        self._first_of_row = slice(None, None, self.boats_per_row)
        self.phase = Phase.NEW
        self._note_seeds()

    @property
    def observation_names(self) -> list[str]:
        """The names of the values of a boat's observation, in order."""
        return self.native.observation_names

    @property
    def action_names(self) -> list[str] | None:
        """The names of the discrete actions, in order; None if actions are continuous."""
        return self.native.action_names

    def action_masks(self) -> NDArray[np.bool_]:
        """The possible actions of each row, one boat after the other, for sb3-contrib. Raises ValueError if actions are continuous."""
        mask = action_mask(self.native)
        if mask is None:
            raise ValueError("continuous actions have no mask")
        return mask.astype(bool).reshape(self.num_envs, -1)

    @property
    def states(self) -> NDArray[np.float32]:
        """The truth from the view of each row's boat, (rows, values), for critics that know more than a policy.

        With `row="team"` there is still one per boat: (games x boats, values). 0 for boats without actions. Empty unless `state=True` or
        `reward` is given.
        """
        return self._shown(self.native.states)

    @property
    def final_states(self) -> NDArray[np.float32]:
        """The same at the end of games that ended in the last step; other rows are stale."""
        return self._shown(self.native.final_states)

    @property
    def state_names(self) -> list[str]:
        """The names of the values of a state, in order; empty unless `state=True` or `reward` is given."""
        return self.native.state_names

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Restarts games.

        An int: seeds count up from it, as at creation. A sequence: a seed for each game, or None for its next one. None: the next seeds; at
        first those of creation.
        `options={"reset_mask": mask}`, (num_envs,) bool, restarts only games with a True row.
        """
        if self.phase is Phase.CLOSED:
            check_phase(self.phase)
        mask = (options or {}).get("reset_mask")
        if mask is None and not isinstance(seed, (Sequence, np.ndarray)):
            if seed is not None or self.phase is not Phase.NEW:
                self.native.restart(None if seed is None else checked_seed(seed))
        else:
            self.native.restart_games(self._chosen(seed, mask))
        self.phase = Phase.PLAYING
        if self._reward is not None:
            self._reward.begin()
        self._note_seeds()
        return self._shown(self._observations), self._info()

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[np.float32], NDArray[Any], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Plays a step of all games with one action per row. Raises ValueError, and plays nothing, for invalid actions."""
        check_phase(self.phase)
        native = self.native
        rows = actions_for(native, actions, self.action_space.shape)
        has_ended = not self._is_same_step and (native.terminated | native.truncated)
        native.step(rows, restarts=self._is_same_step)
        rewards = native.rewards if self._reward is None else self._reward.rewards(rows, has_ended)
        if self.boats_per_row > 1:
            rewards = team_mean(rewards.reshape(self.num_envs, self.boats_per_row), self._has_boat)
        terminated, truncated = native.terminated[self._first_of_row], native.truncated[self._first_of_row]
        if np.any(has_ended):
            self._note_seeds()
        info = self._info()
        if terminated.any() or truncated.any():
            self._add_final(info, terminated | truncated)
        shown = self._shown
        return shown(self._observations), shown(rewards), shown(terminated), shown(truncated), info

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """A picture of each row's game, (height, width, 3); of its end if it ended in the last step. None without `render_mode`."""
        if self.render_mode is None:
            return None
        pictures = [draw(self.native.scene(game)) for game in range(self.games)]
        return tuple(pictures[env // self.rows_per_game] for env in range(self.num_envs))

    def close_extras(self, **kwargs: Any) -> None:
        """Completes the recordings."""
        self.phase = Phase.CLOSED
        if self._recordings is not None:
            self._recordings.end()

    def _shown(self, array: NDArray[Any]) -> NDArray[Any]:
        return array.copy() if self.copy else array

    def _chosen(self, seed: int | Sequence[int | None] | None, mask: Any) -> list[tuple[int, int | None]]:
        seeds: list[int | None] = [None] * self.games
        if isinstance(seed, (Sequence, np.ndarray)):
            seeds = [None if one is None else checked_seed(one) for one in seed]
        elif seed is not None:
            seeds = [checked_seed(seed) + game for game in range(self.games)]
        if len(seeds) != self.games:
            raise ValueError(f"seed has {len(seeds)} numbers, expected one for each of {self.games} games")
        rows = np.ones(self.num_envs, dtype=bool) if mask is None else np.asarray(mask, dtype=bool)
        if rows.shape != (self.num_envs,):
            raise ValueError(f"reset_mask has the shape {rows.shape}, expected ({self.num_envs},)")
        chosen = rows.reshape(self.games, self.rows_per_game).any(axis=1)
        return [(int(game), seeds[game]) for game in np.flatnonzero(chosen)]

    def _note_seeds(self) -> None:
        seeds = [self.native.standing(game)["seed"] for game in range(self.games)]
        self._seeds = np.repeat(np.array(seeds, dtype=np.uint64), self.rows_per_game)
        if self.boats_per_row > 1:
            self._has_boat = has_boat(self.native).reshape(self.num_envs, self.boats_per_row)

    def _info(self) -> dict[str, Any]:
        counts = self.native.counts
        if self.boats_per_row > 1:
            counts = counts.reshape(self.num_envs, self.boats_per_row)
        everywhere = np.ones(self.num_envs, dtype=bool)
        info = {
            "counts": self._shown(counts),
            "_counts": everywhere,
            "seed": self._shown(self._seeds),
            "_seed": everywhere,
        }
        if (mask := action_mask(self.native)) is not None:
            info.update(action_mask=mask.reshape(*counts.shape, -1), _action_mask=everywhere)
        return info

    def _add_final(self, info: dict[str, Any], ended: NDArray[np.bool_]) -> None:
        """Adds `final_obs` and `final_info`, as gymnasium's own vector environments do."""
        observations = np.full(self.num_envs, None, dtype=object)
        for env in np.flatnonzero(ended):
            observations[env] = self._final_observations[env].copy()
        final: dict[str, Any] = {}
        for game, _, standing in self.native.finished():
            for place in range(self.rows_per_game):
                is_enemy = place * self.boats_per_row >= self.boats_per_team
                for name, number in (seen_by_enemy(standing) if is_enemy else standing).items():
                    dtype = np.uint64 if name == "seed" else np.int64
                    array = final.setdefault(name, np.zeros(self.num_envs, dtype=dtype))
                    array[game * self.rows_per_game + place] = number
        final.update({f"_{name}": ended.copy() for name in list(final)})
        info.update(final_info=final, _final_info=ended.copy())
        if self._is_same_step:
            info.update(final_obs=observations, _final_obs=ended)
            self._note_seeds()
            info["seed"] = self._shown(self._seeds)


def seen_by_enemy(standing: dict[str, int]) -> dict[str, int]:
    """A state of play from the other team's view."""
    swapped = dict(standing, team=1 - standing["team"])
    for name, number in standing.items():
        if name.startswith("enemy_"):
            own = name.removeprefix("enemy_")
            swapped[own], swapped[name] = number, standing[own]
    return swapped
