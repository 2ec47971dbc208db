"""Runs a competition entry in a separate process: `python -m squall.host FOLDER`.

An entry of the Maritime Capture the Flag competition has a class `solution` with a method `compute_action`. Without
`--serve`, this program asks it once for each boat and shows the answers. `squall run --blue host:FOLDER` starts it with
`--serve`: each line of standard input is then a request, each line of standard output an answer, both in JSON. Needs
only numpy, so that it runs in the entry's own environment.
"""

from __future__ import annotations

import argparse
import importlib.util
import inspect
import json
import math
import os
import queue
import random
import signal
import sys
import threading
import time
import traceback
from collections.abc import Mapping
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

ACTIONS = 17
OWN = (
    *(f"{place}_{what}" for place in ("opponent_home", "own_home") for what in ("bearing", "distance")),
    *(f"wall_{i}_{what}" for i in range(4) for what in ("bearing", "distance")),
    *("scrimmage_line_bearing", "scrimmage_line_distance", "speed", "has_flag", "on_side", "tagging_cooldown"),
    *("is_tagged", "is_disabled", "team_score", "opponent_score"),
)
OTHER = (
    *("bearing", "distance", "relative_heading", "speed", "has_flag", "on_side", "tagging_cooldown"),
    *("is_tagged", "is_disabled"),
)
GAME = {
    "seed": 1,
    "team": 0,
    "boats": [3, 3],
    "field_m": [160.0, 80.0],
    "flags_m": [[20.0, 40.0], [140.0, 40.0]],
    "top_m_s": 3.0,
    "cooldown_s": 60.0,
    "score_max": 20.0,
    "has_disabled": True,
}
"""The description of a game in the first request; these are the values of 2026."""

Point = tuple[float, float]
Numbers = dict[Any, Any]


def vector(bearing_deg: float, distance_m: float) -> Point:
    return distance_m * math.sin(math.radians(bearing_deg)), distance_m * math.cos(math.radians(bearing_deg))


def to(start: Point, end: Point, heading_deg: float = 0.0) -> Point:
    """Bearing relative to the heading, clockwise from -180 to 180 degrees, and distance."""
    east_m, north_m = end[0] - start[0], end[1] - start[1]
    bearing_deg = math.degrees(math.atan2(east_m, north_m)) - heading_deg
    return (bearing_deg + 180.0) % 360.0 - 180.0, math.hypot(east_m, north_m)


class World:
    """The game as one boat knows it, in the terms of Pyquaticus: x to the right, y up, blue on the left."""

    def __init__(self, game: Mapping[str, Any], request: Mapping[str, Any]) -> None:
        # Flags that move are in every request.
        self.game = {**game, **{key: request[key] for key in ("flags_m",) if key in request}}
        self.width_m, self.depth_m = game["field_m"]
        self.diagonal_m = math.hypot(self.width_m, self.depth_m)
        self.me = int(request["boat"]) + (game["boats"][0] if game["team"] == 1 else 0)
        self.numbers = np.array(request["observation"], np.float32)
        own = self._read(OWN, self.numbers[: len(OWN)])
        at = (request["at_m"][0], request["at_m"][1])
        self.boats: dict[int, Numbers] = {self.me: {**own, "at": at, "heading": request["heading_deg"]}}
        scores = [own["team_score"], own["opponent_score"]]
        self.scores = scores if game["team"] == 0 else scores[::-1]
        for i, other in enumerate(self._others(self.me)):
            begin = len(OWN) + i * len(OTHER)
            seen = self._read(OTHER, self.numbers[begin : begin + len(OTHER)])
            east_m, north_m = vector(request["heading_deg"] + seen["bearing"], seen["distance"])
            place = (at[0] + east_m, at[1] + north_m)
            heading_deg = to(place, at, -seen["relative_heading"])[0]
            self.boats[other] = {**seen, "at": place, "heading": heading_deg}

    def _team(self, boat: int) -> int:
        return int(boat >= self.game["boats"][0])

    def _others(self, boat: int) -> list[int]:
        """The other boats as observations list them: teammates first."""
        others = [other for other in range(sum(self.game["boats"])) if other != boat]
        return sorted(others, key=lambda other: self._team(other) != self._team(boat))

    def _ends(self, name: str) -> tuple[float, float]:
        """The values of the named quantity that are scaled to -1 and 1."""
        if name.endswith(("bearing", "heading")):
            return -180.0, 180.0
        most = {"speed": "top_m_s", "tagging_cooldown": "cooldown_s", "team_score": "score_max"}
        most["opponent_score"] = "score_max"
        if name in most:
            return 0.0, self.game[most[name]]
        return 0.0, self.diagonal_m if name.endswith("distance") else 1.0

    def _read(self, names: tuple[str, ...], numbers: np.ndarray) -> Numbers:
        found: Numbers = {}
        for name, number in zip(names, numbers.tolist()):
            low, high = self._ends(name)
            value = low + 0.5 * (number + 1.0) * (high - low)
            found[name] = value > 0.5 if name in ("has_flag", "on_side", "is_tagged", "is_disabled") else value
        return found

    def _scrimmage(self, at: Point) -> Point:
        return self.width_m / 2.0, min(max(at[1], 0.0), self.depth_m)

    def observed(self, boat: int) -> Numbers:
        """The observation of a boat in metres, degrees and seconds, by the names of Pyquaticus."""
        own, team = self.boats[boat], self._team(boat)
        at, heading_deg = own["at"], own["heading"]
        inside = min(max(at[0], 0.0), self.width_m), min(max(at[1], 0.0), self.depth_m)
        walls = [(inside[0], 0.0), (0.0, inside[1]), (inside[0], self.depth_m), (self.width_m, inside[1])]
        walls = walls if team == 0 else walls[2:] + walls[:2]
        flags = [tuple(flag) for flag in self.game["flags_m"]]
        values: list[Any] = []
        for place in (flags[1 - team], flags[team], *walls, self._scrimmage(at)):
            values += to(at, place, heading_deg)
        values += [own[name] for name in OWN[len(values) : -2]]
        found: Numbers = dict(zip(OWN, [*values, self.scores[team], self.scores[1 - team]]))
        counts = [0, 0]
        for other in self._others(boat):
            seen, is_enemy = self.boats[other], self._team(other) != team
            name = f"opponent_{counts[1]}" if is_enemy else f"teammate_{counts[0]}"
            counts[is_enemy] += 1
            back_deg = to(seen["at"], at)[0]
            relative_deg = (seen["heading"] - back_deg + 180.0) % 360.0 - 180.0
            values = [*to(at, seen["at"], heading_deg), relative_deg, *(seen[each] for each in OTHER[3:])]
            found.update({(name, each): value for each, value in zip(OTHER, values)})
        if not self.game["has_disabled"]:
            found = {name: value for name, value in found.items() if "is_disabled" not in name}
        return found

    def normalised(self, boat: int) -> np.ndarray:
        """A boat's observation as numbers from -1 to 1; for the boat that decides, exactly as received from Squall."""
        found = self.observed(boat)
        if boat == self.me:
            names = [*OWN, *(each for _ in range(len(self.boats) - 1) for each in OTHER)]
            kept = np.array([self.game["has_disabled"] or name != "is_disabled" for name in names])
            exact: np.ndarray = self.numbers[kept]
            return exact
        numbers = []
        for name, value in found.items():
            low, high = self._ends(name if isinstance(name, str) else name[1])
            numbers.append(2.0 * (value - low) / (high - low) - 1.0)
        scaled: np.ndarray = np.clip(numbers, -1.0, 1.0).astype(np.float32)
        return scaled

    def state(self) -> Numbers:
        """The global state by the names of Pyquaticus, in metres, degrees and seconds."""
        state: Numbers = {}
        for boat in sorted(self.boats):
            own, name = self.boats[boat], f"agent_{boat}"
            at = own["at"]
            bearing_deg, distance_m = to(at, self._scrimmage(at), own["heading"])
            is_out = not (0.0 < at[0] < self.width_m and 0.0 < at[1] < self.depth_m)
            state |= {
                (name, "pos"): np.array(at),
                (name, "heading"): (own["heading"] + 180.0) % 360.0 - 180.0,
                (name, "scrimmage_line_bearing"): bearing_deg,
                (name, "scrimmage_line_distance"): distance_m,
                (name, "oob"): is_out,
            }
            state |= {(name, each): own[each] for each in OTHER[3:-1]}
            if self.game["has_disabled"]:
                state[name, "is_disabled"] = own["is_disabled"]
        for team, colour in enumerate(("blue", "red")):
            home = np.array(self.game["flags_m"][team])
            carriers = [own["at"] for boat, own in self.boats.items() if own["has_flag"] and self._team(boat) != team]
            state |= {
                f"{colour}_flag_home": home,
                f"{colour}_flag_pos": np.array(carriers[0]) if carriers else home,
                f"{colour}_flag_pickup": bool(carriers),
                f"{colour}_team_score": self.scores[team],
            }
        return state

    def field_point(self, name: str) -> Point:
        """A point of the Aquaticus field, such as CH, for the team of the boat that decides."""
        rows = {row: i for i, row in enumerate(("B", "F", "H", "M", "C", "MX", "HX", "FX", "BX"))}
        columns = {"PP": 1.0, "P": 0.75, "C": 0.5, "S": 0.25, "SS": 0.0}
        for column, share in columns.items():
            if name.startswith(column) and name[len(column) :] in rows:
                x_m, y_m = self.width_m * rows[name[len(column) :]] / 8.0, self.depth_m * share
                return (x_m, y_m) if self.game["team"] == 0 else (self.width_m - x_m, self.depth_m - y_m)
        raise ValueError(f"the action {name!r} is not a point of the field, such as CH")

    def order(self, action: Any) -> int | list[float]:
        """An entry's answer as one of 17 actions, or a speed in m/s and a turn in degrees.

        Raises ValueError if it is neither, nor the name of a point on the field.
        """
        if isinstance(action, str):
            own = self.boats[self.me]
            bearing_deg, distance_m = to(own["at"], self.field_point(action), own["heading"])
            return [self.game["top_m_s"] if distance_m > 2.0 else 0.0, bearing_deg]
        numbers = np.asarray(action, np.float64).ravel() if action is not None else np.empty(0)
        if not np.isfinite(numbers).all():
            raise ValueError(f"the action is {action!r}, which is not finite")
        if numbers.size == 1 and numbers[0] == int(numbers[0]) and -ACTIONS <= numbers[0] < ACTIONS:
            return int(numbers[0]) % ACTIONS  # As in Python lists, -1 is the last.
        if numbers.size >= 2:
            # A turn of up to 180 degrees keeps its side; a larger one goes the shorter way round.
            turn_deg = float(numbers[1])
            return [float(numbers[0]), turn_deg if abs(turn_deg) <= 180.0 else (turn_deg + 180.0) % 360.0 - 180.0]
        raise ValueError(f"the action is {action!r}, expected one of {ACTIONS}, or a speed and a turn")


def file_of(path: Path) -> Path:
    """The entry's `solution.py`, from its folder or its own path."""
    file = path / "solution.py" if path.is_dir() else path
    if not file.is_file():
        raise FileNotFoundError(f"there is no {file}, expected the folder of an entry, or its solution.py")
    return file.resolve()


class Entry:
    """A loaded entry. Its folder becomes the working folder of this process."""

    def __init__(self, path: Path, game: Mapping[str, Any]) -> None:
        self.game = game
        file = file_of(path)
        os.chdir(file.parent)
        sys.path.insert(0, str(file.parent))
        self.config = self._config(file.parent / "gen_config.py")
        if self.config.get("lidar_obs"):
            raise ValueError("gen_config.py asks for lidar observations, which Squall does not have")
        module = self._imported("solution", file)
        random.seed(game["seed"])
        np.random.seed(game["seed"] % 2**32)  # Entries use numpy's global generator.
        if "torch" in sys.modules:
            sys.modules["torch"].manual_seed(game["seed"])
        self.solution = module.solution()
        parameters = inspect.signature(self.solution.compute_action).parameters.values()
        positional = [each for each in parameters if each.kind in (each.POSITIONAL_ONLY, each.POSITIONAL_OR_KEYWORD)]
        self.count = len([each for each in positional if each.default is each.empty])
        if self.count not in (3, 4, 5):
            raise ValueError(f"compute_action takes {self.count} arguments, expected 3 (2024), 4, or 5 with info")
        self.ages = sorted({i for end in ("short", "long") for i in self._ages(end)})
        self.before: dict[tuple[int, int], list[tuple[np.ndarray, Numbers]]] = {}
        """Older observations, newest first, by the boat that decides and the observed boat."""

    @staticmethod
    def _imported(name: str, file: Path) -> Any:
        spec = importlib.util.spec_from_file_location(name, file)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        sys.modules[name] = module
        spec.loader.exec_module(module)
        return module

    def _config(self, file: Path) -> Mapping[str, Any]:
        """The entry's configuration; empty if there is none, or if it imports a missing package such as Pyquaticus."""
        try:
            module = self._imported("gen_config", file) if file.is_file() else None
        except ImportError:
            module = None
        found = (getattr(module, name, None) for name in ("config_dict_competition", "config_dict_std"))
        return next((config for config in found if isinstance(config, Mapping)), {})

    def _ages(self, end: str) -> range:
        length = int(self.config.get(f"{end}_obs_hist_length", 1))
        interval = int(self.config.get(f"{end}_obs_hist_interval", 1))
        return range(0, length * interval, interval)

    def _with_history(self, world: World, boat: int) -> tuple[Any, Any]:
        newest = world.normalised(boat), world.observed(boat)
        before = self.before.get((world.me, boat), [newest] * self.ages[-1])
        frames = [newest, *before]
        self.before[world.me, boat] = frames[: self.ages[-1]]
        if len(self.ages) == 1:
            return newest
        return np.stack([frames[age][0] for age in self.ages]), np.array([frames[age][1] for age in self.ages])

    def answer(self, request: Mapping[str, Any]) -> int | list[float]:
        """The entry's action for a request.

        Raises whatever the entry raises, or ValueError if its answer is not an action.
        """
        world = World(self.game, request)
        # Each boat knows its own observation; those of the others follow from it.
        boats = [world.me] if self.count == 3 else sorted(world.boats)
        both = {f"agent_{boat}": self._with_history(world, boat) for boat in boats}
        if self.count == 3:
            action = self.solution.compute_action(world.me, *both[f"agent_{world.me}"])
        else:
            normalised, plain = ({name: pair[i] for name, pair in both.items()} for i in (0, 1))
            state = world.state()
            info = {name: {"global_state": state, "unnorm_obs": plain[name]} for name in both}
            given = (normalised, plain, state, info)[: self.count - 1]
            action = self.solution.compute_action(f"agent_{world.me}", *given)
        return world.order(action)


def reason(error: BaseException) -> str:
    """An error in one line, with the place in the entry's code."""
    own = globals().get("__file__", "<string>")  # Squall passes this program to Python as a string.
    frames = [frame for frame in traceback.extract_tb(error.__traceback__) if frame.filename != own]
    frames = [frame for frame in frames if "importlib" not in frame.filename and not frame.filename.startswith("<")]
    # The entry's own line is more helpful than a line in a library that it calls.
    frames = [frame for frame in frames if frame.filename.startswith(os.getcwd() + os.sep)] or frames
    place = f"{Path(frames[-1].filename).name}:{frames[-1].lineno}: " if frames else ""
    return f"{place}{type(error).__name__}: {error}".replace("\n", " ")[:300]


def feed(requests: BinaryIO, lines: queue.Queue[bytes]) -> None:
    for line in requests:
        lines.put(line)
    # The game is over, or its program is gone. The entry may be busy, and may have started other processes.
    if hasattr(os, "killpg") and os.getpgrp() == os.getpid():
        os.killpg(os.getpgrp(), signal.SIGKILL)
    os._exit(0)


def serve(path: Path) -> None:
    """Answers requests until standard input ends. Discards the entry's output; its standard input is empty."""
    if hasattr(os, "setsid") and os.getpgrp() != os.getpid():
        os.setsid()
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb", 0)
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    lines: queue.Queue[bytes] = queue.Queue()
    threading.Thread(target=feed, args=(requests, lines), daemon=True).start()

    def reply(number: int, answer: Mapping[str, Any]) -> None:
        answers.write(json.dumps({"number": number, **answer}).encode() + b"\n")

    try:
        entry = Entry(path, json.loads(lines.get()))
        reply(0, {"action": 0})
    except (Exception, SystemExit) as error:  # The entry's code may raise anything.
        reply(0, {"error": reason(error)})
        return
    while True:
        line = lines.get()
        while not lines.empty():  # Requests that arrived while the entry was late are obsolete.
            line = lines.get()
        request = json.loads(line)
        try:
            reply(request["number"], {"action": entry.answer(request)})
        except (Exception, SystemExit) as error:
            reply(request["number"], {"error": reason(error)})


def check(path: Path, team: int) -> int:
    """Asks the entry once for each boat at the start of a game, of 2026 or else of 2025, and shows the answers."""
    file, whys = path.resolve(), []
    for year, has_disabled in ((2026, True), (2025, False)):
        try:
            begun = time.perf_counter()
            entry = Entry(file, {**GAME, "team": team, "has_disabled": has_disabled})
            lines = [f"loaded in {time.perf_counter() - begun:.1f} s; compute_action takes {entry.count} arguments"]
            for boat in range(3):
                x_m, y_m = (50.0, 20.0 * (3 - boat)) if team == 0 else (110.0, 20.0 * (3 - boat))
                observation = [0.0] * (len(OWN) + 5 * len(OTHER))
                request = {"boat": boat, "at_m": [x_m, y_m], "heading_deg": 90.0, "observation": observation}
                begun = time.perf_counter()
                action = entry.answer(request)
                lines.append(f"  boat {boat}: {action} after {1000.0 * (time.perf_counter() - begun):.1f} ms")
        except (Exception, SystemExit) as error:
            whys.append(f"with the observations of {year}: {reason(error)}")
            continue
        print(f"{path}, with the observations of {year}: " + "\n".join(lines))
        print(f"play it with: squall run mctf_{year} --{'blue' if team == 0 else 'red'} host:{path}")
        return 0
    print(f"error: {path}: " + "\n  ".join(whys), file=sys.stderr)
    return 1


def main(arguments: list[str] | None = None) -> int:
    """Checks or serves the entry that the arguments name."""
    parser = argparse.ArgumentParser(
        prog="python -m squall.host",
        description="Runs a competition entry: checks that it answers, or serves it to squall.",
    )
    parser.add_argument("entry", metavar="FOLDER", type=Path, help="folder of the entry, or its solution.py")
    parser.add_argument("--red", action="store_true", help="asks the entry for the actions of the red team's boats")
    parser.add_argument("--serve", action="store_true", help="answers requests on standard input")
    given = parser.parse_args(arguments)
    if given.serve:
        serve(given.entry)
        return 0
    return check(given.entry, int(given.red))


if __name__ == "__main__":
    sys.exit(main())
