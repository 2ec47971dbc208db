"""The native module. Private: use what `squall` exports."""

from pathlib import Path
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

__version__: str

class Setup(TypedDict):
    """What is played. Paths are of scenario files; `squall.VectorEnv` explains the rest."""

    game: str
    observation: str
    frames: int
    action: str
    helm: str | None
    decision_s: float | None
    episode_max_s: float | None
    starts: int | None
    team: str | None
    mates: str | None
    opponents: list[tuple[float, str | None]]
    rewards: str | None
    discount: float
    state: bool

class Scene(TypedDict):
    """The truth about a game: m along the field from the first team's end, m across it to that team's port."""

    width_m: float
    depth_m: float
    boats: NDArray[np.float64]
    """(boats, 6): along in m, across in m, heading in rad anticlockwise from along, team, tagged, carrying."""
    flags: NDArray[np.float64]
    """(flags, 4): home along in m, across in m, team, the boat that carries it or -1."""
    score: list[int]
    time_s: float

class VectorEnvironment:
    """Games side by side. Each begins anew in the step in which it ends.

    A row is a boat that is given actions: game by game, first the boats of the team that learns and then, if any opponent is
    the policy itself, their enemies.

    The arrays are made once. `step`, `restart` and `restart_games` overwrite them; nothing else does.
    """

    def __init__(
        self, setup: Setup, seed: int, games: int, threads: int, record: tuple[str, int] | None = None
    ) -> None:
        """Begins `games` games: seeds count up from `seed`, game by game and episode by episode.

        `record` is a folder, which is made where there is none, and n: each nth game is recorded, counted as seeds count. Raises
        ValueError with everything that is wrong with the setup and its files, or with the folder.
        """

    observations: NDArray[np.float32]
    """(rows, numbers): what every boat is shown."""
    final_observations: NDArray[np.float32]
    """(rows, numbers): what it was shown last in a game that ended in the last step. Other rows are stale."""
    states: NDArray[np.float32]
    """(rows, len(state_names)): the truth as a row's boat would tell it; 0 for boats that are given no actions. No numbers without the
    setup's `state`."""
    final_states: NDArray[np.float32]
    """The same at the end of a game that ended in the last step. Other rows are stale."""
    rewards: NDArray[np.float32]
    """(rows,)"""
    counts: NDArray[np.bool_]
    """(rows,): whether a row's next action counts."""
    terminated: NDArray[np.bool_]
    """(rows,): whether its game was over."""
    truncated: NDArray[np.bool_]
    """(rows,): whether its game was cut off."""
    rows: int
    rows_per_game: int
    observation_names: list[str]
    state_names: list[str]
    """What the numbers of a state are called; none without the setup's `state`."""
    action_count: int | None
    """How many discrete actions there are; None where actions are continuous."""
    action_names: list[str] | None
    """What the discrete actions are called: the values of a strategy's variable, or what they ask of a boat."""
    step_s: float
    """Simulated time of a step, s."""
    boat_names: list[str]
    team_names: list[str]

    def step(self, actions: NDArray[Any]) -> None:
        """Plays a step of every game, without the interpreter's lock.

        `actions` are (rows,) int64 below `action_count`, or (rows, 2) float32 from -1 to 1. Raises ValueError, and plays nothing, where
        they are not.
        """

    def restart(self, seed: int | None = None) -> None:
        """Begins all games anew: seeds count up from `seed`, or go on."""

    def restart_games(self, chosen: list[tuple[int, int | None]]) -> None:
        """Begins some games anew, each with its seed or its next one."""

    def end_recordings(self) -> None:
        """Completes all recordings; nothing is recorded from now on.

        Warns, as `step` and `restart` do, of what could not be recorded.
        """

    def take_recording(self) -> Path | None:
        """The newest recording, if one has been completed since this was asked last."""

    def boats(self, game: int) -> list[int | None]:
        """The boat of each row of a game; None where nobody is given actions."""

    def standing(self, game: int) -> dict[str, int]:
        """How a game stands: its seed, who plays whom, points and counts."""

    def finished(self) -> list[tuple[int, bool, dict[str, int]]]:
        """The games that ended in the last step: which, whether they were cut off, how they stood."""

    def digest(self, game: int) -> str:
        """The digest of a game's state: equal digests, equal games."""

    def scene(self, game: int) -> Scene:
        """A game as it looks from above."""

class SweepPlan:
    """Which games a sweep consists of. It never changes, and threads may share it."""

    @staticmethod
    def open(path: str | Path, games: int | None = None, seed: int | None = None) -> SweepPlan:
        """Reads a sweep file, and the game at every point of it.

        `games` (of each entry at each point) and `seed` take the place of the file's. Raises ValueError with everything that is wrong at
        any point.
        """

    @staticmethod
    def unpack(packed: tuple[str, list[tuple[Path, bytes]], str]) -> SweepPlan:
        """The plan that was packed elsewhere; no file is read. Raises ValueError where another version of Squall packed it."""

    def pack(self) -> tuple[str, list[tuple[Path, bytes]], str]:
        """All that its games need, for a process on another machine: the checked sweep as JSON, its files, its digest."""

    name: str
    digest: str
    """What identifies it: equal digests, equal games. It does not depend on where the files lie."""
    points: int
    games_per_point: int
    games: int

    def lines(self, begin: int, end: int, threads: int = 1) -> list[tuple[str, str]]:
        """Plays the games from `begin` to before `end` in this process, without the interpreter's lock.

        Returns for each its line in the table of games, and the lines of its boats. A game that cannot start has a line that says why.
        Ctrl-C ends it with KeyboardInterrupt. Raises IndexError where there are no such games.
        """

    def begin(self, folder: str | Path) -> SweepStudy:
        """A new study in a folder, which is made. Raises ValueError where there is one already, OSError where it cannot be written."""

    def resume(self, folder: str | Path) -> SweepStudy:
        """The study of a folder, taken up again; raises ValueError where there is none, or one of another sweep."""

class SweepStudy:
    """What came of a sweep, in a folder: the same files as `squall sweep` writes."""

    done: int
    """How many games it has: the next one's place."""

    def add(self, index: int, game_line: str, boat_lines: str) -> None:
        """Adds the next game, as `SweepPlan.lines` has it. Raises IndexError if it is another one, OSError where it cannot be written."""

    def report(self) -> tuple[str, int]:
        """Writes the report of all games so far: for people, and the number of games that could not start."""

class TournamentPlan:
    """Which games a tournament consists of. It never changes, and threads may share it."""

    @staticmethod
    def open(path: str | Path, games: int | None = None, seed: int | None = None) -> TournamentPlan:
        """Reads a tournament file, and the game of every pairing.

        `games` (of each pairing) and `seed` take the place of the file's. Raises ValueError with everything that is wrong.
        """

    @staticmethod
    def unpack(packed: tuple[str, list[tuple[Path, bytes]], str]) -> TournamentPlan:
        """The plan that was packed elsewhere; no file is read. Raises ValueError where another version of Squall packed it."""

    def pack(self) -> tuple[str, list[tuple[Path, bytes]], str]:
        """All that its games need, for a process on another machine: the checked file as JSON, its files, its digest."""

    name: str
    digest: str
    """What identifies it: equal digests, equal games. It does not depend on where the files lie."""
    games: int

    def records(self, begin: int, end: int, threads: int = 1) -> list[str]:
        """Plays the games from `begin` to before `end` in this process, without the interpreter's lock.

        Returns a record of each, JSON. Ctrl-C ends it with KeyboardInterrupt. Raises IndexError where there are no such games.
        """

    def report(self, records: list[str]) -> tuple[str, str, str, int]:
        """What the records of the first games come to: for people, as JSON and as CSV, and the number of games that could not start.

        Raises ValueError where a record is none, IndexError where they are not those of the first games in their order.
        """
