"""Rewards as a Python function, called for each boat after each step."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from squall import _native


class Event(NamedTuple):
    """An event of the last step, such as a tag. Recordings contain the same events, with the same names."""

    name: str
    """"grabbed", "captured", "tagged", "untagged", "flag_returned", "left_field", "collided", "ended", …"""
    time_s: float
    """Simulated time, s."""
    boat: str | None
    """The boat that grabbed, captured, was tagged, …; the first in a collision; None at the end of a game."""
    team: str | None
    """That boat's team; at the end of a game the winner, or None for a draw."""
    other: str | None
    """The tagger, None if the boundary or an obstacle tagged the boat; the second boat in a collision."""


class State(Mapping[str, float]):
    """The exact state of a game as seen by a boat, by the names in `state_names`."""

    __slots__ = ("_index", "numbers")

    def __init__(self, numbers: NDArray[np.float32], index: Mapping[str, int]) -> None:
        self.numbers, self._index = numbers, index

    def __getitem__(self, name: str) -> float:
        return float(self.numbers[self._index[name]])

    def __iter__(self) -> Iterator[str]:
        return iter(self._index)

    def __len__(self) -> int:
        return len(self._index)


@dataclass(frozen=True, slots=True)
class BoatStep:
    """A boat's last step: the argument of a reward function."""

    boat: str
    team: str
    action: Any
    """An integer, or turn and speed."""
    before: State
    """The state before the step."""
    after: State
    """The state after it; at the end of a game, its last one."""
    events: Sequence[Event]
    """The events of all boats in the step, in order."""
    reward: float
    """The reward according to the file that `rewards` names."""
    terminated: bool
    truncated: bool


Reward = Callable[[BoatStep], float]
"""A function that returns a boat's reward for a step."""


class RewardFunction:
    """A reward function with the states before the next step."""

    def __init__(self, function: Reward, native: _native.VectorEnvironment) -> None:
        if not callable(function):
            raise ValueError(f"reward is {function!r}, expected a function; rewards names a file")
        self._function, self._native = function, native
        self._index = {name: i for i, name in enumerate(native.state_names)}
        self._boats, self._teams = native.boat_names, native.team_names
        self._team_of = [self._teams[team] for team in native.boat_teams]
        self.begin()

    def begin(self) -> None:
        """Stores the states and boats before the next step."""
        native = self._native
        self._before = native.states.copy()
        self._rows = [boat for game in range(native.rows // native.rows_per_game) for boat in native.boats(game)]

    def rewards(self, actions: NDArray[Any], has_ended: NDArray[np.bool_] | bool = False) -> NDArray[np.float32]:
        """The rewards for the last step by row; 0 for boats without actions, and for games that had ended before it."""
        native = self._native
        ended = native.terminated | native.truncated
        after = np.where(ended[:, np.newaxis], native.final_states, native.states)
        rewards = np.zeros(native.rows, dtype=np.float32)
        is_skipped = np.broadcast_to(has_ended, native.rows)
        for row, boat in enumerate(self._rows):
            if row % native.rows_per_game == 0:
                events = [self._event(*parts) for parts in native.events(row // native.rows_per_game)]
            if boat is not None and not is_skipped[row]:
                rewards[row] = self._function(
                    BoatStep(
                        boat=self._boats[boat],
                        team=self._team_of[boat],
                        action=actions[row],
                        before=State(self._before[row], self._index),
                        after=State(after[row], self._index),
                        events=events,
                        reward=float(native.rewards[row]),
                        terminated=bool(native.terminated[row]),
                        truncated=bool(native.truncated[row]),
                    )
                )
        self.begin()
        return rewards

    def _event(self, name: str, time_s: float, boat: int | None, other: int | None, team: int | None) -> Event:
        boats = (None if one is None else self._boats[one] for one in (boat, other))
        return Event(name, time_s, next(boats), None if team is None else self._teams[team], next(boats))
