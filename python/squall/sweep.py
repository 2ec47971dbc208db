"""A sweep over a cluster of Ray: `python -m squall.sweep FILE`.

The same games as `squall sweep FILE` plays, and the same bytes in the same files. A task plays a batch of games in a worker's process; this
process writes their lines, in order. Workers read no files: the plan travels with all that it needs. See docs/cluster.md.
"""

from __future__ import annotations

import argparse
import contextlib
import signal
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from squall._native import SweepPlan, SweepStudy
from squall.sweep_task import Packed, play

PACKED_BYTES_MAX = 256 << 20
"""The most bytes of files that are sent to workers."""
RETRIES = 5
"""How often a batch is played again whose worker or machine was lost."""
BATCH = 50
"""Games in a batch, by default at most, on a cluster of up to 2000 CPUs."""
IN_FLIGHT = 2
"""Batches for each CPU that are played or about to be."""
AHEAD = 16
"""Batches for each CPU that may be played before the one that is due: what waits in memory for it."""
WAIT_S = 1.0
"""How long results are waited for before the cluster is looked at again, s."""
LINE_EVERY_S = 30.0
"""How often a line is written where there is no terminal, s."""


@dataclass
class InOrder:
    """Results that come in any order, and go on in order."""

    due: int
    """The place of the next one to go on."""
    waiting: dict[int, list[tuple[str, str]]] = field(default_factory=dict)
    """Batches that came early, by the place of their first game."""

    def put(self, begin: int, lines: list[tuple[str, str]]) -> Iterator[tuple[int, str, str]]:
        """Takes a batch, and gives all games that can go on."""
        self.waiting[begin] = lines
        while (batch := self.waiting.pop(self.due, None)) is not None:
            first, self.due = self.due, self.due + len(batch)
            for place, (game, boats) in enumerate(batch, first):
                yield place, game, boats


class Progress:
    """How far it is, on standard error: one line that changes on a terminal, a line now and then elsewhere."""

    def __init__(self, done: int, games: int) -> None:
        self.first, self.games = done, games
        self.begun = self.told = time.monotonic()
        self.is_terminal = sys.stderr.isatty()

    def show(self, done: int, cpus: int) -> None:
        """So many are kept by now, on so many CPUs."""
        now = time.monotonic()
        if now - self.told < (WAIT_S if self.is_terminal else LINE_EVERY_S):
            return
        self.told = now
        rate = (done - self.first) / (now - self.begun)
        left = f"{(self.games - done) / rate:.0f} s left" if rate > 0 else "time left unknown"
        line = f"{done} of {self.games} games, {rate:.1f} games/s on {cpus} CPUs, {left}"
        print(
            f"\r{line}\x1b[K" if self.is_terminal else line,
            end="" if self.is_terminal else "\n",
            file=sys.stderr,
            flush=True,
        )

    def end(self, done: int) -> None:
        """Says how fast it was."""
        wall_s = time.monotonic() - self.begun
        played = done - self.first
        start = "\r\x1b[K" if self.is_terminal else ""
        print(f"{start}{played} games in {wall_s:.1f} s: {played / max(wall_s, 1e-9):.1f} games/s", file=sys.stderr)


def engine() -> Any:
    """The package ray; SystemExit where it is not installed."""
    try:
        import ray
    except ImportError:
        raise SystemExit("the Python package ray is not installed: pip install 'squall[ray]'") from None
    return ray


def cpus_of(ray: Any) -> int:
    """The CPUs of the cluster, at least 1 where none has joined yet."""
    return max(1, int(ray.cluster_resources().get("CPU", 0)))


def batch_of(left: int, cpus: int) -> int:
    """How many games make a batch: four batches for each CPU, but none so long that losing it matters, nor so short that tasks are more
    than one driver can hand out (about 200 a second, where a game takes 0.2 s)."""
    return max(1, min(left // (4 * cpus), max(BATCH, cpus // 40)))


def play_all(
    plan: SweepPlan,
    study: SweepStudy,
    *,
    batch: int | None = None,
    show: Callable[[int, int], None] = lambda done, cpus: None,
    task: Callable[[Packed, int, int], list[tuple[str, str]]] = play,
) -> None:
    """Plays all games that a study lacks on the cluster that Ray is connected to.

    `show` is told how many games are kept, and how many CPUs there are. Raises what a task raises; what the study has by then is kept.
    """
    ray = engine()
    packed = plan.pack()
    size = sum(len(content) for _, content in packed[1])
    if size > PACKED_BYTES_MAX:
        raise ValueError(f"the sweep's files have {size} bytes, expected at most {PACKED_BYTES_MAX}")
    cpus, looked = cpus_of(ray), time.monotonic()
    games = batch or batch_of(plan.games - study.done, cpus)
    # What a task itself raises is raised again by every retry.
    remote = ray.remote(num_cpus=1, max_retries=RETRIES, retry_exceptions=False)(task)
    reference = ray.put(packed)
    order, begin = InOrder(study.done), study.done
    in_flight: dict[Any, int] = {}
    try:
        while study.done < plan.games:
            if time.monotonic() - looked > 10 * WAIT_S:
                cpus, looked = cpus_of(ray), time.monotonic()
            limit = study.done + AHEAD * cpus * games
            while begin < min(plan.games, limit) and len(in_flight) < IN_FLIGHT * cpus:
                end = min(begin + games, plan.games)
                in_flight[remote.remote(reference, begin, end)] = begin
                begin = end
            # Not one by one: waiting takes as long as there are tasks.
            some = max(1, len(in_flight) // 16)
            ready, _ = ray.wait(list(in_flight), num_returns=some, timeout=WAIT_S)
            for one, lines in zip(ready, ray.get(ready), strict=True):
                for index, game, boats in order.put(in_flight.pop(one), lines):
                    study.add(index, game, boats)
            show(study.done, cpus)
    finally:
        for one in in_flight:
            ray.cancel(one)


def connect(address: str | None) -> None:
    """Connects to a cluster, or starts one on this machine."""
    ray = engine()
    if not ray.is_initialized():
        options = {"include_dashboard": False} if address == "local" else {}
        ray.init(address=address, logging_level="warning", **options)


def arguments_of(words: list[str] | None) -> argparse.Namespace:
    """What the command line says."""
    parser = argparse.ArgumentParser(prog="python -m squall.sweep", description=__doc__)
    parser.add_argument("file", type=Path, help="the sweep file")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="for the tables and the report (runs/sweep/NAME)")
    parser.add_argument(
        "--resume", action="store_true", help="go on with the sweep that the folder holds, whoever began it"
    )
    parser.add_argument("--games", type=int, metavar="N", help="games of each entry at each point (as the file says)")
    parser.add_argument("--seed", type=int, metavar="N", help="the first seed (as the file says)")
    parser.add_argument("--batch", type=int, metavar="N", help="games in a task (by the size of the cluster)")
    parser.add_argument(
        "--address",
        metavar="ADDR",
        help="the cluster's, or local for one of this machine alone (RAY_ADDRESS, or what runs here)",
    )
    arguments = parser.parse_args(words)
    if arguments.batch is not None and arguments.batch < 1:
        parser.error(f"--batch is {arguments.batch}, expected at least 1")
    for name in ("games", "seed"):
        if (getattr(arguments, name) or 0) < 0:
            parser.error(f"--{name} is {getattr(arguments, name)}, expected none below 0")
    return arguments


def remark(text: str) -> None:
    """A line on standard error."""
    print(text, file=sys.stderr, flush=True)


def main(words: list[str] | None = None) -> int:
    """Runs a sweep; returns 0, 1 where a game could not start or something failed, or 130 where it was stopped."""
    arguments = arguments_of(words)
    try:
        plan = SweepPlan.open(arguments.file, arguments.games, arguments.seed)
        folder = arguments.out or Path("runs/sweep") / plan.name
        study = plan.resume(folder) if arguments.resume else plan.begin(folder)
    except (ValueError, OverflowError, OSError) as error:
        remark(f"Error: {error}")
        return 1
    remark(f"{plan.points} points with {plan.games_per_point} games each; tables and report in {folder}")
    if study.done > 0:
        remark(f"{study.done} of {plan.games} games were played before")
    if plan.games_per_point and (arguments.games or 0) % 2:
        remark(f"{arguments.games} games a point are {arguments.games + 1}: half of them on each side")
    # What ends a job asks in this way.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    progress, failed = Progress(study.done, plan.games), None
    with contextlib.suppress(KeyboardInterrupt):
        try:
            if study.done < plan.games:
                connect(arguments.address)
                play_all(plan, study, batch=arguments.batch, show=progress.show)
        except Exception as error:  # noqa: BLE001  Whatever a cluster says: what was played is kept.
            failed = error
    progress.end(study.done)
    if failed is not None:
        remark(f"Error: {failed}\n{study.done} of {plan.games} games are kept; --resume goes on")
        return 1
    text, failures = study.report()
    print(f"{text}\nwith curves: {folder / 'report.html'}", flush=True)
    if study.done < plan.games:
        remark("stopped; --resume goes on with it")
        return 130
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
