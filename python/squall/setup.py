"""What is played in an environment: the options that all of them have, and the native environment made of them."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Literal, TypedDict

import gymnasium
import numpy as np
from numpy.typing import NDArray

from squall import _native
from squall.scenario import path_of

File = str | os.PathLike[str]
"""A scenario file: its path, or the name of one that comes with the package."""

Opponents = File | Sequence[tuple[float, File]]
"""A strategy, or several with the weights by which they are drawn. "policy" is the policy itself: self-play."""


class Options(TypedDict, total=False):
    """What all environments may be told."""

    game: File
    """The game, "surveyor_2v2" by default. Both teams have as many boats."""
    observation: Literal["squall", "pyquaticus"]
    """What a boat is shown: "squall" (default) is what sensors and radio tell, "pyquaticus" the numbers of that environment."""
    frames: int
    """How many decisions "squall" shows together, the newest first: 1 by default."""
    action: Literal["pyquaticus", "continuous", "options"]
    """What a boat may do: one of 17 (default), turn and speed as two numbers from -1 to 1, or one of the options of `control`: the
    values of a strategy's variable, such as attack and defend. `action_names` of an environment tells them."""
    control: File
    """How that is done: "direct" (default) as orders, or through the helms of a strategy with a behaviour of the kind `policy`,
    which keep the boat safe: "policy" and "teleop" are some for turns and speeds, "options" is one for options."""
    decision_s: float | None
    """How long an action holds, s: a multiple of the game's own period. 0.5 by default; None is the game's own."""
    episode_max_s: float | None
    """An episode is cut off (`truncated`) after so long, s. None (default) plays whole games."""
    starts: int | None
    """How many different starts come round again, which makes new games cheap. None (default): every game has its own."""
    team: str | None
    """The name of the team that learns. None (default): the one and the other by turns, seed by seed."""
    opponents: Opponents
    """Who plays the other team: "pav01" by default."""
    rewards: File | None
    """What is worth how much: "bold" by default; None is nothing."""
    discount: float
    """What a reward a step later is worth, for the potentials in rewards: 0.99 by default."""
    record: str | os.PathLike[str] | None
    """A folder for a recording of every game, named by the time, the game and its seed, which `squall replay` shows and plays again.
    None (default): nothing is recorded. A game of which no step is played leaves no file; one that is reset, or whose environment is
    closed, before its end is kept up to there."""
    record_every: int
    """Each so manieth game is recorded, the first included, counted game by game and episode by episode as seeds are: 1 by default.
    With as many as there are games in a `VectorEnv`, those of its first place are recorded."""


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
    """Begins the games. `mates` is the strategy that sails all but one boat of a team; None: actions are for all.
    With `state` the truth is told too.

    A seed of None is drawn from the system; `standing(game)["seed"]` tells it. `record` is the folder for recordings where the options
    name none. Raises ValueError with everything that is wrong.
    """
    unknown = options.keys() - Options.__annotations__.keys()
    if unknown:
        raise ValueError(f"unknown option {sorted(unknown)}, expected some of {sorted(Options.__annotations__)}")
    control, rewards = options.get("control", "direct"), options.get("rewards", "bold")
    setup: _native.Setup = {
        "game": path_of("games", options.get("game", "surveyor_2v2")),
        "observation": options.get("observation", "squall"),
        "frames": _number("frames", options.get("frames", 1), 255),
        "action": options.get("action", "pyquaticus"),
        "helm": None if control == "direct" else path_of("strategies", control),
        "decision_s": options.get("decision_s", 0.5),
        "episode_max_s": options.get("episode_max_s"),
        "starts": options.get("starts"),
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
        _number("seed", seed, 2**64 - 1),
        _number("games", games, 10**6),
        _number("threads", threads, 1024),
        None if folder is None else (os.fspath(folder), every),
    )


def observation_space(native: _native.VectorEnvironment, options: Options, boats: int | None) -> gymnasium.spaces.Box:
    """What one boat is shown, or so many in a table."""
    numbers = len(native.observation_names)
    most = 1.0 if options.get("observation") == "pyquaticus" else np.inf
    return gymnasium.spaces.Box(-most, most, (numbers,) if boats is None else (boats, numbers), np.float32)


def state_space(native: _native.VectorEnvironment) -> gymnasium.spaces.Box:
    """What the truth may be, as one boat would tell it."""
    return gymnasium.spaces.Box(-np.inf, np.inf, (len(native.state_names),), np.float32)


def action_space(native: _native.VectorEnvironment, boats: int | None) -> gymnasium.Space[Any]:
    """What one boat may do, or so many together."""
    count = native.action_count
    if count is None:
        return gymnasium.spaces.Box(-1.0, 1.0, (2,) if boats is None else (boats, 2), np.float32)
    if boats is None:
        return gymnasium.spaces.Discrete(count)
    return gymnasium.spaces.MultiDiscrete(np.full(boats, count))


def actions_for(native: _native.VectorEnvironment, actions: Any) -> NDArray[Any]:
    """Actions of any shape as rows. Raises ValueError where they are of the wrong kind or too few."""
    if native.action_count is None:
        rows = np.asarray(actions, dtype=np.float32)
        if rows.size != 2 * native.rows:
            raise ValueError(
                f"actions have the shape {rows.shape}, expected two numbers for each of {native.rows} boats"
            )
        return rows.reshape(native.rows, 2)
    rows = np.asarray(actions)
    if not np.issubdtype(rows.dtype, np.integer):
        raise ValueError(f"actions are of the type {rows.dtype}, expected integers")
    if rows.size != native.rows:
        raise ValueError(f"actions have the shape {rows.shape}, expected one for each of {native.rows} boats")
    return rows.astype(np.int64, copy=False).reshape(native.rows)


def check_render_mode(render_mode: str | None, modes: Sequence[str]) -> None:
    """Raises ValueError for a mode that there is not."""
    if render_mode is not None and render_mode not in modes:
        expected = " or ".join(["None", *(f'"{mode}"' for mode in modes)])
        raise ValueError(f"render_mode is {render_mode!r}, expected {expected}")


def needs_no_policy(options: Options, where: str) -> None:
    """Raises ValueError where an opponent is the policy itself, whose actions nobody would give."""
    if any(file is None for _, file in _opponents(options.get("opponents", "pav01"))):
        raise ValueError(
            f'opponents has "policy", but {where} has no actions for enemies: use VectorEnv or parallel_env'
        )


def _opponents(given: Opponents) -> list[tuple[float, str | None]]:
    pairs: Sequence[tuple[float, File]] = [(1.0, given)] if isinstance(given, (str, os.PathLike)) else given
    return [(float(weight), None if file == "policy" else path_of("strategies", file)) for weight, file in pairs]


def _number(name: str, number: int, most: int, least: int = 0) -> int:
    if not least <= number <= most:
        raise ValueError(f"{name} is {number}, expected an integer from {least} to {most}")
    return int(number)
