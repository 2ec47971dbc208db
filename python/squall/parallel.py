"""One game in which every boat is an agent, as PettingZoo's `ParallelEnv`."""

from __future__ import annotations

from typing import Any, ClassVar

import gymnasium
import numpy as np
from numpy.typing import NDArray
from pettingzoo import ParallelEnv
from typing_extensions import Unpack

from squall.picture import draw
from squall.recording import Recordings, folder_to_show
from squall.setup import (
    Options,
    action_space,
    check_render_mode,
    native_environment,
    needs_no_policy,
    observation_space,
    state_space,
)
from squall.vector import seen_by_enemy

Shown = dict[str, NDArray[np.float32]]


class SquallParallelEnv(ParallelEnv[str, NDArray[np.float32], Any]):  # type: ignore[misc]
    """A game whose agents are boats, with their names in the game.

    With `state=True`, `state()` is the truth about the game, for critics that know more than any agent; see the package's README.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "render_modes": ["human", "rgb_array"],
        "render_fps": 10,
        "name": "squall_v0",
    }

    def __init__(self, *, seed: int | None, render_mode: str | None, state: bool, options: Options) -> None:
        check_render_mode(render_mode, self.metadata["render_modes"])
        record = folder_to_show(render_mode)
        self.native = native_environment(options, seed=seed, games=1, threads=1, state=state, record=record)
        self._recordings = Recordings(self, self.native, render_mode)
        self.render_mode = render_mode
        names = self.native.boat_names
        self.possible_agents = [names[boat] for boat in self.native.boats(0) if boat is not None]
        self.agents: list[str] = []
        self._per_team = len(names) // 2
        spaces = observation_space(self.native, options, None), action_space(self.native, None)
        self.observation_spaces = dict.fromkeys(self.possible_agents, spaces[0])
        self.action_spaces = {agent: action_space(self.native, None) for agent in self.possible_agents}
        if state:
            self.state_space = state_space(self.native)
        self._is_new = True
        self._is_over = False

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
        """The names of the values of the state, in order; empty without `state=True`."""
        return self.native.state_names

    def state(self) -> NDArray[np.float32]:
        """The truth about the game from the view of its first agent; after the last step, at the end of the game.

        Raises NotImplementedError without `state=True`.
        """
        if not self.native.state_names:
            raise NotImplementedError("state() needs parallel_env(state=True)")
        states = self.native.final_states if self._is_over else self.native.states
        first: NDArray[np.float32] = states[0].copy()
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
        """Starts the game with this seed, or the next one."""
        if seed is not None or not self._is_new:
            self.native.restart(seed)
            self._recordings.show()
        self.agents, self._is_new, self._is_over = list(self.possible_agents), True, False
        return self._by_agent(self.native.observations.copy()), self._infos(self.native.standing(0))

    def step(
        self, actions: dict[str, Any]
    ) -> tuple[Shown, dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Plays a step. Raises ValueError, and plays nothing, if an action is missing or outside the space."""
        if not self.agents:
            raise gymnasium.error.ResetNeeded("the game is over: call reset first")
        native, agents = self.native, self.possible_agents
        missing = [agent for agent in agents if agent not in actions]
        if missing:
            raise ValueError(f"actions has no entries for {missing}")
        kind = np.float32 if native.action_count is None else np.int64
        native.step(np.array([actions[agent] for agent in agents], dtype=kind))
        terminated, truncated = bool(native.terminated[0]), bool(native.truncated[0])
        is_over = terminated or truncated
        shown = native.final_observations if is_over else native.observations
        infos = self._infos(native.finished()[0][2] if is_over else native.standing(0))
        rewards = dict(zip(agents, native.rewards.tolist(), strict=True))
        self._is_new = self._is_over = is_over
        if is_over:
            self.agents = []
            self._recordings.show()
        ends = dict.fromkeys(agents, terminated), dict.fromkeys(agents, truncated)
        return self._by_agent(shown.copy()), rewards, *ends, infos

    def render(self) -> NDArray[np.uint8] | None:
        """The game from above, (height, width, 3); after its last step the next game. None except for "rgb_array".

        With "human", Squall's page in a browser shows each game when it has ended: see the package's README.
        """
        return draw(self.native.scene(0)) if self.render_mode == "rgb_array" else None

    def close(self) -> None:
        """Completes the recording. With `render_mode="human"`, shows it."""
        self._recordings.end()

    def _by_agent(self, observations: NDArray[np.float32]) -> Shown:
        return dict(zip(self.possible_agents, observations, strict=True))

    def _infos(self, standing: dict[str, int]) -> dict[str, dict[str, Any]]:
        counts = self.native.counts.tolist()
        views = [standing, seen_by_enemy(standing)] if len(counts) > self._per_team else [standing]
        infos = [{"counts": is_counted, **views[place // self._per_team]} for place, is_counted in enumerate(counts)]
        return dict(zip(self.possible_agents, infos, strict=True))


def parallel_env(
    *, seed: int | None = None, render_mode: str | None = None, state: bool = False, **options: Unpack[Options]
) -> SquallParallelEnv:
    """One game as PettingZoo's `ParallelEnv`.

    With `team`, the agents are the boats of that team, and `opponents` are as in the other environments. Without it, all boats are
    agents, and `opponents` is not allowed. An agent's `info` is its team's state of play, as for `TeamEnv`, and in `counts` whether its
    actions take effect: a tagged boat drives home. With `state`, the environment also has `state()` and `state_space`: the truth about
    the game. Raises ValueError with all faults of options and scenario files.
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
