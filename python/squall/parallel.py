"""One game in which every boat is an agent, as PettingZoo's `ParallelEnv`."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from pettingzoo import ParallelEnv
from typing_extensions import Unpack

from squall.game import Game, Phase, Recreated, check_phase
from squall.recording import available_modes
from squall.setup import (
    Options,
    action_mask,
    action_space,
    actions_for,
    checked_seed,
    checked_team_sizes,
    has_boat,
    native_environment,
    needs_no_policy,
    observation_space,
    state_space,
)
from squall.vector import seen_by_enemy

Shown = dict[str, NDArray[np.float32]]


class SquallParallelEnv(Recreated, ParallelEnv[str, NDArray[np.float32], Any]):  # type: ignore[misc]
    """A game whose agents are boats, with their names in the game.

    With `state=True`, `state()` is the truth about the game, for critics that know more than any agent; see the package's README.
    """

    metadata: dict[str, Any] = {  # noqa: RUF012 (PettingZoo's own)
        "render_modes": ["human", "rgb_array"],
        "render_fps": 10,
        "name": "squall_v0",
    }

    def __init__(self, *, seed: int | None, render_mode: str | None, state: bool, options: Options) -> None:
        self._game = Game(self, options, seed=seed, state=state, render_mode=render_mode)
        self.native = self._game.native
        self.np_random, _ = gymnasium.utils.seeding.np_random(None if seed is None else checked_seed(seed))
        self._recipe = functools.partial(type(self), seed=seed, render_mode=render_mode, state=state, options=options)
        self.metadata = {**self.metadata, "render_modes": available_modes(self.metadata["render_modes"])}
        self.render_mode = render_mode
        self._per_team = self.native.rows_per_team
        self._row = self._rows_of_agents(options)
        self.possible_agents = list(self._row)
        self.agents: list[str] = []
        self._playing: list[str] = []
        spaces = observation_space(self.native, options, None), action_space(self.native, None)
        self.observation_spaces = dict.fromkeys(self.possible_agents, spaces[0])
        self.action_spaces = {agent: action_space(self.native, None) for agent in self.possible_agents}
        if self.native.state_names:
            self.state_space = state_space(self.native)

    @property
    def phase(self) -> Phase:  # type: ignore[override]
        """The phase of the environment."""
        return self._game.phase

    @property
    def observation_names(self) -> list[str]:
        """The names of the values of an observation, in order."""
        return self.native.observation_names

    @property
    def action_names(self) -> list[str] | None:
        """The names of the discrete actions, in order; None if actions are continuous."""
        return self.native.action_names

    @property
    def state_names(self) -> list[str]:
        """The names of the values of the state, in order; empty unless `state=True` or `reward` is given."""
        return self.native.state_names

    def state(self) -> NDArray[np.float32]:
        """The truth about the game from the view of its first agent; after the last step, at the end of the game.

        Raises NotImplementedError unless `state=True` or `reward` is given.
        """
        if not self.native.state_names:
            raise NotImplementedError("state() needs parallel_env(state=True)")
        first: NDArray[np.float32] = self.native.states[0].copy()
        return first

    def observation_space(self, agent: str) -> gymnasium.Space[Any]:
        """The observation space of an agent; always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """The action space of an agent."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Shown, dict[str, dict[str, Any]]]:
        """Starts the game with this seed, or one drawn from `np_random`."""
        if seed is not None:
            seed = checked_seed(seed)
            self.np_random, _ = gymnasium.utils.seeding.np_random(seed)
        self._game.reset(seed, self.np_random)
        present = has_boat(self.native)
        self._playing = [agent for agent in self.possible_agents if present[self._row[agent]]]
        self.agents = list(self._playing)
        return self._shown(), self._infos()

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[Shown, dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Plays a step. Raises ValueError, and plays nothing, if an action is missing, outside the space or for an unknown agent.

        After the end of the game, a step without actions returns empty dictionaries.
        """
        if self.phase is Phase.OVER and not actions:
            return {}, {}, {}, {}, {}
        check_phase(self.phase)
        agents = self._playing
        rewards, terminated, truncated = self._game.step(self._rows_of(actions))
        if terminated or truncated:
            self.agents = []
        ends = dict.fromkeys(agents, terminated), dict.fromkeys(agents, truncated)
        return self._shown(), {agent: float(rewards[self._row[agent]]) for agent in agents}, *ends, self._infos()

    def _rows_of_agents(self, options: Options) -> dict[str, int]:
        """The row of each boat that may play. The rows of the first agents' team come first."""
        boats = list(zip(self.native.boat_names, self.native.boat_teams, strict=True))
        first, sizes = self.native.standing(0)["team"], checked_team_sizes(options.get("team_sizes"))
        rows = {}
        for place, team in enumerate((first, 1 - first)[: self.native.rows // self._per_team]):
            most = self._per_team if sizes is None else sizes[team][1]
            names = [name for name, of_team in boats if of_team == team][:most]
            rows.update({name: place * self._per_team + i for i, name in enumerate(names)})
        return rows

    def _rows_of(self, actions: Any) -> NDArray[Any]:
        """The agents' actions by row; any action for absent boats."""
        if not isinstance(actions, Mapping):
            raise ValueError(f"actions are {actions!r}, expected a dictionary with an entry for each agent")
        agents = self._playing
        unknown = [agent for agent in actions if agent not in agents]
        if unknown:
            raise ValueError(f"actions has entries for {unknown}, expected {agents}")
        missing = [agent for agent in agents if agent not in actions]
        if missing:
            raise ValueError(f"actions has no entries for {missing}")
        is_discrete = self.native.action_count is not None
        rows = np.zeros(self.native.rows, np.int64) if is_discrete else np.zeros((self.native.rows, 2), np.float32)
        for agent in agents:
            try:
                action = actions_for(self.native, actions[agent], self.action_spaces[agent].shape)
            except ValueError as error:
                raise ValueError(f"{agent}: {error}") from None
            rows[self._row[agent]] = action[0]
        return rows

    def render(self) -> NDArray[np.uint8] | None:
        """The game from above, (height, width, 3). None unless the render mode is "rgb_array".

        With "human", Squall's page in a browser shows each game when it has ended: see the package's README.
        """
        return self._game.picture()

    def close(self) -> None:
        """Completes the recording. With `render_mode="human"`, shows it."""
        self._game.close()

    def _shown(self) -> Shown:
        observations = self.native.observations.copy()
        return {agent: observations[self._row[agent]] for agent in self._playing}

    def _infos(self) -> dict[str, dict[str, Any]]:
        standing, counts, masks = self.native.standing(0), self.native.counts.tolist(), action_mask(self.native)
        views = [standing, seen_by_enemy(standing)] if len(counts) > self._per_team else [standing]
        infos = {}
        for agent in self._playing:
            row = self._row[agent]
            infos[agent] = {"counts": counts[row], **views[row // self._per_team]}
            if masks is not None:
                infos[agent]["action_mask"] = masks[row]
        return infos


def parallel_env(
    *, seed: int | None = None, render_mode: str | None = None, state: bool = False, **options: Unpack[Options]
) -> SquallParallelEnv:
    """One game as PettingZoo's `ParallelEnv`.

    With `team`, the agents are the boats of that team, and `opponents` are as in the other environments. Without it, all boats are
    agents, and `opponents` is not allowed. An agent's `info` is its team's state of play, as for `TeamEnv`; its `counts` says whether
    the agent's actions take effect, which they do not while a tagged boat drives home. `action_mask` is as for `BoatEnv`. With
    `team_sizes`, `agents` are the boats of the current game. With `state`, the environment also has `state()` and `state_space`: the
    truth about the game. Raises ValueError with all faults of options and scenario files.
    """
    if options.get("team") is not None:
        needs_no_policy(options, "one team's parallel_env")
        return SquallParallelEnv(seed=seed, render_mode=render_mode, state=state, options=options)
    if "opponents" in options:
        raise ValueError("opponents is given, but all boats are agents: restrict them to one team with `team`")
    options["opponents"] = "policy"
    # With agents on both sides, the team only affects the order of the agents.
    options["team"] = native_environment(options, seed=0, games=1, threads=1).team_names[0]
    return SquallParallelEnv(seed=seed, render_mode=render_mode, state=state, options=options)
