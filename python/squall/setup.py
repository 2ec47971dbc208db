"""The setup of an environment: the common options, and the native environment that they create."""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Sequence
from typing import Any, Literal, TypedDict

import gymnasium
import numpy as np
from numpy.typing import NDArray

from squall import _native
from squall.reward import Reward
from squall.scenario import path_of

File = str | os.PathLike[str]
"""A scenario file: its path, or the name of one in the package."""

Opponents = File | Sequence[tuple[float, File]]
"""A strategy, or several with their weights. "policy" is the policy itself: self-play."""


TeamSizes = tuple[int, int] | tuple[tuple[int, int], tuple[int, int]]
"""The minimum and maximum size of both teams, or of each."""


class Options(TypedDict, total=False):
    """The options of all environments."""

    game: File
    """The game, by default "surveyor_2v2". Both teams must have the same number of boats."""
    team_sizes: TeamSizes | None
    """The minimum and maximum number of boats, drawn for each team and game, or such a pair for each team; the last boats of a team are
    left out. Needs the observation "squall"; rows of absent boats are 0. None (default): all boats play."""
    observation: Literal["squall", "pyquaticus", "pyquaticus_2023", "pyquaticus_2026"]
    """A boat's observation: "squall" (default), the data of its sensors and radio, or the values of a version of Pyquaticus:
    "pyquaticus" (2024, 2025), "pyquaticus_2023" or "pyquaticus_2026"."""
    frames: int
    """Number of decisions in an observation with "squall", newest first; 1 by default."""
    action: Literal["pyquaticus", "continuous", "options"]
    """A boat's action: one of 17 (default), turn and speed as two numbers from -1 to 1, or one of the options of `control`: the values
    of a strategy's variable, such as attack and defend. The environment's `action_names` lists them."""
    control: File
    """How actions are carried out: "direct" (default) as orders, or through the helms of a strategy with a behaviour of kind `policy`,
    which keep the boat safe. "policy" and "teleop" are such strategies for turns and speeds, "options" is one for options."""
    decision_s: float | None
    """How long an action holds, s: a multiple of the game's own period. By default the smallest multiple of at least 0.5; None: the
    game's own period."""
    episode_max_s: float | None
    """Time after which an episode is truncated (`truncated`), s. None (default): whole games."""
    starts: int | None
    """The number of different starts, used in rotation, so that new games are cheap. None (default): a new start for every game."""
    team: str | None
    """The name of the learning team. None (default): alternates with the seed."""
    opponents: Opponents
    """The other team's players, by default "pav01"."""
    rewards: File | None
    """The rewards, by default "bold"; None: all are 0."""
    reward: Reward | None
    """A function that replaces these rewards: `squall.BoatStep` to number, called for each boat after each step. None (default): none."""
    discount: float
    """The value of a reward one step later, for the potentials in rewards; 0.99 by default."""
    record: str | os.PathLike[str] | None
    """A folder for recordings of games, named by time, game and seed; `squall replay` shows and replays them. None (default): no
    recordings. A game without a played step leaves no file. If a game is reset, or its environment closed, before its end, the part
    that was played is kept."""
    record_every: int
    """Records every n-th game, including the first, counted across the games and then the episodes, like seeds; 1 by default. With the
    number of games in a `VectorEnv`, records the games of its first slot."""


def native_environment(
    options: Options,
    *,
    seed: int | None,
    games: int,
    threads: int,
    mates: File | None = None,
    state: bool = False,
    record: str | os.PathLike[str] | None = None,
) -> _native.VectorEnvironment:
    """Starts the games. `mates` is the strategy of all but one boat of a team; None: all boats receive actions. With `state`, the truth is
    provided too.

    A seed of None is drawn from the system; `standing(game)["seed"]` returns it. `record` is the folder for recordings if the options name
    none. Raises ValueError with all faults.
    """
    unknown = options.keys() - Options.__annotations__.keys()
    if unknown:
        raise ValueError(f"unknown option {sorted(unknown)}, expected one or more of {sorted(Options.__annotations__)}")
    control, rewards = options.get("control", "direct"), options.get("rewards", "bold")
    starts = options.get("starts")
    setup: _native.Setup = {
        "game": path_of("games", options.get("game", "surveyor_2v2")),
        "team_sizes": checked_team_sizes(options.get("team_sizes")),
        "observation": options.get("observation", "squall"),
        "frames": _number("frames", options.get("frames", 1), 255),
        "action": options.get("action", "pyquaticus"),
        "helm": None if control == "direct" else path_of("strategies", control),
        "decision_s": options.get("decision_s"),
        "decision_min_s": 0.0 if "decision_s" in options else 0.5,
        "episode_max_s": options.get("episode_max_s"),
        "starts": None if starts is None else _number("starts", starts, 2**32 - 1),
        "team": options.get("team"),
        "mates": None if mates is None else path_of("strategies", mates),
        "opponents": _opponents(options.get("opponents", "pav01")),
        "rewards": None if rewards is None else path_of("rewards", rewards),
        "discount": options.get("discount", 0.99),
        "state": bool(state),
    }
    if seed is None:
        seed = int(np.random.SeedSequence().generate_state(1)[0])
    folder = record if options.get("record") is None else options.get("record")
    every = _number("record_every", options.get("record_every", 1), 2**64 - 1, least=1)
    return _native.VectorEnvironment(
        setup,
        checked_seed(seed),
        _number("games", games, 10**6),
        _number("threads", threads, 1024),
        None if folder is None else (os.fspath(folder), every),
    )


def observation_space(native: _native.VectorEnvironment, options: Options, boats: int | None) -> gymnasium.spaces.Box:
    """The observation space of one boat, or of several as a table."""
    numbers = len(native.observation_names)
    most = 1.0 if options.get("observation", "").startswith("pyquaticus") else np.inf
    return gymnasium.spaces.Box(-most, most, (numbers,) if boats is None else (boats, numbers), np.float32)


def state_space(native: _native.VectorEnvironment) -> gymnasium.spaces.Box:
    """The space of the truth from the view of one boat."""
    return gymnasium.spaces.Box(-np.inf, np.inf, (len(native.state_names),), np.float32)


def action_space(native: _native.VectorEnvironment, boats: int | None) -> gymnasium.Space[Any]:
    """The action space of one boat, or of several together."""
    count = native.action_count
    if count is None:
        return gymnasium.spaces.Box(-1.0, 1.0, (2,) if boats is None else (boats, 2), np.float32)
    if boats is None:
        return gymnasium.spaces.Discrete(count)
    return gymnasium.spaces.MultiDiscrete(np.full(boats, count))


def actions_for(native: _native.VectorEnvironment, actions: Any, shape: tuple[int, ...] | None) -> NDArray[Any]:
    """Converts actions of this shape, of one boat or several, to rows. Raises ValueError if they have the wrong type or shape."""
    try:
        rows = np.asarray(actions)
    except ValueError:
        raise ValueError(f"actions are {actions!r}, expected an array with the shape {shape}") from None
    is_discrete = native.action_count is not None
    kind, numbers = (np.integer, "one") if is_discrete else (np.number, "two numbers")
    if not np.issubdtype(rows.dtype, kind):
        raise ValueError(f"actions have the type {rows.dtype}, expected {'integers' if is_discrete else 'numbers'}")
    if rows.shape != shape:
        boats = math.prod(shape or ()) // (1 if is_discrete else 2)
        raise ValueError(
            f"actions have the shape {rows.shape}, expected {numbers} for each of {boats} boats in the shape {shape}"
        )
    return (
        rows.astype(np.int64, copy=False).reshape(-1)
        if is_discrete
        else rows.astype(np.float32, copy=False).reshape(-1, 2)
    )


def action_mask(native: _native.VectorEnvironment) -> NDArray[np.int8] | None:
    """By row, 1 for each action that is possible: the last one alone if no action takes effect. None if actions are continuous."""
    if native.action_count is None:
        return None
    mask = np.ones((native.rows, native.action_count), dtype=np.int8)
    mask[~native.counts, :-1] = 0
    return mask


def checked_seed(seed: Any) -> int:
    """Converts a seed. Raises ValueError if it is not an integer of 64 bits."""
    return _number("seed", seed, 2**64 - 1)


def check_render_mode(render_mode: str | None, modes: Sequence[str]) -> None:
    """Raises ValueError for an unknown mode."""
    if render_mode is not None and render_mode not in modes:
        expected = " or ".join(["None", *(f'"{mode}"' for mode in modes)])
        raise ValueError(f"render_mode is {render_mode!r}, expected {expected}")


def needs_no_policy(options: Options, where: str) -> None:
    """Raises ValueError if an opponent is the policy itself, which would receive no actions."""
    if any(file is None for _, file in _opponents(options.get("opponents", "pav01"))):
        raise ValueError(
            f'opponents has "policy", but {where} has no actions for enemies: use VectorEnv or parallel_env'
        )


def _opponents(given: Opponents) -> list[tuple[float, str | None]]:
    pairs: Sequence[tuple[float, File]] = [(1.0, given)] if isinstance(given, (str, os.PathLike)) else given
    return [(float(weight), None if file == "policy" else path_of("strategies", file)) for weight, file in pairs]


def checked_team_sizes(given: TeamSizes | None) -> list[list[int]] | None:
    """The minimum and maximum size by team. Raises ValueError for other values."""
    if given is None:
        return None
    try:
        shape = np.shape(given)
    except ValueError:
        shape = ()
    if shape not in ((2,), (2, 2)):
        raise ValueError(f"team_sizes is {given!r}, expected (minimum, maximum), or such a pair for each team")
    pairs: Sequence[Any] = [given, given] if shape == (2,) else given
    return [[_number("team_sizes", number, 10**4, least=1) for number in pair] for pair in pairs]


def has_boat(native: _native.VectorEnvironment) -> NDArray[np.bool_]:
    """By row, whether a boat of the current game receives the row's actions."""
    games = range(native.rows // native.rows_per_game)
    return np.array([boat is not None for game in games for boat in native.boats(game)])


def team_mean(rewards: NDArray[np.float32], boats: NDArray[np.bool_]) -> Any:
    """The mean reward of the existing boats, by the last axis."""
    return rewards.sum(axis=-1) / np.maximum(boats.sum(axis=-1), 1)


def _number(name: str, number: Any, most: int, least: int = 0) -> int:
    try:
        whole = operator.index(number)
    except TypeError:
        whole = least - 1
    if not least <= whole <= most:
        raise ValueError(f"{name} is {number!r}, expected an integer from {least} to {most}")
    return whole
