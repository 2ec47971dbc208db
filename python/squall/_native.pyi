"""The native module. Private: use what `squall` exports."""

from pathlib import Path
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

__version__: str

class Setup(TypedDict):
    """A setup. Paths are scenario files; `squall.VectorEnv` explains the rest."""

    game: str
    team_sizes: list[list[int]] | None
    """By team: minimum and maximum."""
    observation: str
    frames: int
    action: str
    helm: str | None
    decision_s: float | None
    decision_min_s: float
    """Minimum time that an action holds, s, if `decision_s` is None."""
    episode_max_s: float | None
    starts: int | None
    team: str | None
    mates: str | None
    opponents: list[tuple[float, str | None]]
    rewards: str | None
    discount: float
    state: bool

class Scene(TypedDict):
    """The truth about a game: m along the field from the first team's end, and m across it to that team's port."""

    width_m: float
    depth_m: float
    boats: NDArray[np.float64]
    """(boats, 6): m along, m across, heading in rad anticlockwise from along, team, tagged, carrying."""
    flags: NDArray[np.float64]
    """(flags, 4): home in m along and m across, team, index of the carrier or -1."""
    score: list[int]
    time_s: float

class VectorEnvironment:
    """Parallel games. Each restarts in the step in which it ends.

    A row is a boat that receives actions: within each game first the boats of the learning team and then, if any opponent is the
    policy itself, their enemies. Each team has as many rows as its largest size.

    The arrays are created once. Only `step`, `restart` and `restart_games` overwrite them.
    """

    def __init__(
        self, setup: Setup, seed: int, games: int, threads: int, record: tuple[str, int] | None = None
    ) -> None:
        """Starts `games` games. Seeds count up from `seed`, first across the games, then across their episodes.

        `record` is a folder, created if necessary, and n: every n-th game is recorded, counted like seeds. Raises ValueError with all faults
        of the setup and its files, or of the folder.
        """

    observations: NDArray[np.float32]
    """(rows, values): the observations."""
    final_observations: NDArray[np.float32]
    """(rows, values): the last observations of games that ended in the last step. Other rows are stale."""
    states: NDArray[np.float32]
    """(rows, len(state_names)): the truth from the view of each row's boat; 0 for boats without actions. Empty without the setup's
    `state`."""
    final_states: NDArray[np.float32]
    """The same at the end of games that ended in the last step. Other rows are stale."""
    rewards: NDArray[np.float32]
    """(rows,)"""
    counts: NDArray[np.bool_]
    """(rows,): whether the row's next action takes effect."""
    terminated: NDArray[np.bool_]
    """(rows,): whether the row's game is over."""
    truncated: NDArray[np.bool_]
    """(rows,): whether the row's game was truncated."""
    rows: int
    rows_per_game: int
    rows_per_team: int
    observation_names: list[str]
    state_names: list[str]
    """The names of the values of a state; empty without the setup's `state`."""
    action_count: int | None
    """The number of discrete actions; None if actions are continuous."""
    action_names: list[str] | None
    """The names of the discrete actions: the values of a strategy's variable, or what they order."""
    step_s: float
    """Simulated time per step, s."""
    boat_names: list[str]
    boat_teams: list[int]
    team_names: list[str]

    def step(self, actions: NDArray[Any], restarts: bool = True) -> None:
        """Plays one step of every game, without the interpreter's lock. Games that end restart in the same step or, without
        `restarts`, in the next one, which ignores their actions.

        `actions` are (rows,) int64 below `action_count`, or (rows, 2) finite float32. Otherwise raises ValueError and plays nothing.

        In a child process, this and the restarts start new threads, or raise RuntimeError if games are recorded.
        """

    def restart(self, seed: int | None = None) -> None:
        """Restarts all games. Seeds count up from `seed`, or continue."""

    def restart_games(self, chosen: list[tuple[int, int | None]]) -> None:
        """Restarts some games, each with its seed or its next one."""

    def end_recordings(self) -> None:
        """Completes all recordings and stops recording.

        Like `step` and `restart`, warns about what could not be recorded.
        """

    def take_recording(self) -> Path | None:
        """The newest recording completed since the last call, if any."""

    def boats(self, game: int) -> list[int | None]:
        """The boat of each row of a game, as an index into `boat_names`; None if no boat receives the row's actions."""

    def standing(self, game: int) -> dict[str, int]:
        """The state of play of a game: its seed, the players, points and counts."""

    def finished(self) -> list[tuple[int, bool, dict[str, int]]]:
        """The games that ended in the last step: index, whether truncated, and final state of play."""

    def events(self, game: int) -> list[tuple[str, float, int | None, int | None, int | None]]:
        """The events of a game's last step: name, time in s, boat, other boat, team; as in `squall.Event`."""

    def digest(self, game: int) -> str:
        """The digest of a game's state: equal digests mean equal games."""

    def scene(self, game: int) -> Scene:
        """A game seen from above; if it ended in the last step, as it was at its end."""

class SweepPlan:
    """The games of a sweep. Immutable, so threads may share it."""

    @staticmethod
    def open(path: str | Path, games: int | None = None, seed: int | None = None) -> SweepPlan:
        """Reads a sweep file, and the game at every point.

        `games` (of each entry at each point) and `seed` override the file's. Raises ValueError with the faults at all points.
        """

    @staticmethod
    def unpack(packed: tuple[str, list[tuple[Path, bytes]], str]) -> SweepPlan:
        """Restores a packed plan without reading files. Raises ValueError if a different version of Squall packed it."""

    def pack(self) -> tuple[str, list[tuple[Path, bytes]], str]:
        """Everything that the games need in a process on another machine: the checked sweep as JSON, its files, its digest."""

    name: str
    digest: str
    """Identifies the plan: equal digests mean equal games. Does not depend on where the files are."""
    points: int
    games_per_point: int
    games: int

    def lines(self, begin: int, end: int, threads: int = 1) -> list[tuple[str, str]]:
        """Plays the games from `begin` to before `end` in this process, without the interpreter's lock.

        Returns for each game its line in the table of games, and the lines of its boats. A game that cannot start has a line with the
        reason. Ctrl-C ends the call with KeyboardInterrupt. Raises IndexError if the games do not exist.
        """

    def begin(self, folder: str | Path) -> SweepStudy:
        """Creates a study in a folder. Raises ValueError if the folder already contains one, OSError if it cannot be written."""

    def resume(self, folder: str | Path) -> SweepStudy:
        """Resumes the study in a folder. Raises ValueError if the folder contains none, or that of a different sweep."""

class SweepStudy:
    """The results of a sweep in a folder, in the same files as those of `squall sweep`."""

    done: int
    """The number of games stored, and the index of the next one."""

    def add(self, index: int, game_line: str, boat_lines: str) -> None:
        """Adds the next game, as from `SweepPlan.lines`. Raises IndexError if it is a different game, OSError if it cannot be written."""

    def report(self) -> tuple[str, int]:
        """Writes the report of all games so far. Returns a readable summary, and the number of games that could not start."""

class TournamentPlan:
    """The games of a tournament. Immutable, so threads may share it."""

    @staticmethod
    def open(path: str | Path, games: int | None = None, seed: int | None = None) -> TournamentPlan:
        """Reads a tournament file, and the game of every pairing.

        `games` (of each pairing) and `seed` override the file's. Raises ValueError with all faults.
        """

    @staticmethod
    def unpack(packed: tuple[str, list[tuple[Path, bytes]], str]) -> TournamentPlan:
        """Restores a packed plan without reading files. Raises ValueError if a different version of Squall packed it."""

    def pack(self) -> tuple[str, list[tuple[Path, bytes]], str]:
        """Everything that the games need in a process on another machine: the checked file as JSON, its files, its digest."""

    name: str
    digest: str
    """Identifies the plan: equal digests mean equal games. Does not depend on where the files are."""
    games: int

    def records(self, begin: int, end: int, threads: int = 1) -> list[str]:
        """Plays the games from `begin` to before `end` in this process, without the interpreter's lock.

        Returns a JSON record of each. Ctrl-C ends the call with KeyboardInterrupt. Raises IndexError if the games do not exist.
        """

    def report(self, records: list[str]) -> tuple[str, str, str, int]:
        """Evaluates the records of the first games: a readable summary, JSON, CSV, and the number of games that could not start.

        Raises ValueError for an invalid record, IndexError if they are not the records of the first games in order.
        """
