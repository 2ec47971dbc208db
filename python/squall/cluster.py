"""Games on a Ray cluster: the common part of `squall.sweep` and `squall.tournament`.

A task plays a batch of games in a worker process; this process receives the results in order. Workers read no files: the plan includes
everything that they need. See docs/cluster.md.
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
from typing import Any, Generic, Protocol, TypeAlias, TypeVar

Result = TypeVar("Result")
"""The result of a game."""
Taken = TypeVar("Taken", contravariant=True)
"""A result in the form that its receiver needs."""
Packed: TypeAlias = tuple[str, list[tuple[Path, bytes]], str]
"""A packed plan, from its `pack`; the last element is its digest."""
Task: TypeAlias = Callable[[Packed, int, int], list[Result]]
"""A worker's task: the results of the games from the first index to before the second."""

PACKED_BYTES_MAX = 256 << 20
"""Maximum size of files sent to workers, bytes."""
RETRIES = 5
"""How often a batch is rerun after its worker or machine was lost."""
BATCH = 50
"""Default maximum number of games per batch, for clusters of up to 2000 CPUs."""
IN_FLIGHT = 2
"""Batches per CPU in progress or queued."""
AHEAD = 16
"""Maximum number of completed batches per CPU that wait in memory for earlier ones."""
WAIT_S = 1.0
"""How long to wait for results before checking the cluster again, s."""
LINE_EVERY_S = 30.0
"""Interval of progress lines without a terminal, s."""


class Plan(Protocol):
    """The games to be played."""

    @property
    def games(self) -> int: ...

    def pack(self) -> Packed: ...


class Study(Protocol[Taken]):
    """The results of the first games, in order."""

    @property
    def done(self) -> int: ...

    def add(self, index: int, result: Taken) -> None: ...


@dataclass
class InOrder(Generic[Result]):
    """Puts results that arrive in any order into order."""

    due: int
    """The index of the next result to pass on."""
    waiting: dict[int, list[Result]] = field(default_factory=dict)
    """Batches that arrived early, by the index of their first game."""

    def put(self, begin: int, results: list[Result]) -> Iterator[tuple[int, Result]]:
        """Adds a batch. Returns all results that can now be passed on."""
        self.waiting[begin] = results
        while (batch := self.waiting.pop(self.due, None)) is not None:
            first, self.due = self.due, self.due + len(batch)
            yield from enumerate(batch, first)


class Progress:
    """Progress on standard error: one updated line on a terminal, otherwise an occasional line."""

    def __init__(self, done: int, games: int) -> None:
        self.first, self.games = done, games
        self.begun = self.told = time.monotonic()
        self.is_terminal = sys.stderr.isatty()

    def show(self, done: int, cpus: int) -> None:
        """Reports the number of games stored, and of CPUs."""
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
        """Reports the final speed."""
        wall_s = time.monotonic() - self.begun
        played = done - self.first
        start = "\r\x1b[K" if self.is_terminal else ""
        print(f"{start}{played} games in {wall_s:.1f} s: {played / max(wall_s, 1e-9):.1f} games/s", file=sys.stderr)


def engine() -> Any:
    """Imports ray; raises SystemExit if it is not installed."""
    try:
        import ray
    except ImportError:
        raise SystemExit("the Python package ray is not installed: pip install 'squall[ray]'") from None
    return ray


def cpus_of(ray: Any) -> int:
    """The number of CPUs in the cluster; 1 if none has joined yet."""
    return max(1, int(ray.cluster_resources().get("CPU", 0)))


def batch_of(left: int, cpus: int) -> int:
    """The number of games per batch: four batches per CPU, but none so large that losing it matters, nor so small that
    one driver cannot hand out the tasks (about 200 per second, if a game takes 0.2 s)."""
    return max(1, min(left // (4 * cpus), max(BATCH, cpus // 40)))


def play_all(
    plan: Plan,
    study: Study[Result],
    task: Task[Result],
    *,
    batch: int | None = None,
    show: Callable[[int, int], None] = lambda done, cpus: None,
) -> None:
    """Plays all games that a study lacks on the connected Ray cluster.

    Calls `show` with the numbers of games stored and of CPUs. Raises what a task raises; the study keeps its results so far.
    """
    ray = engine()
    packed = plan.pack()
    size = sum(len(content) for _, content in packed[1])
    if size > PACKED_BYTES_MAX:
        raise ValueError(f"the files of the games have {size} bytes, expected at most {PACKED_BYTES_MAX}")
    cpus, looked = cpus_of(ray), time.monotonic()
    games = batch or batch_of(plan.games - study.done, cpus)
    # A task returns the exact lines of the tables, so that the bytes are the same; Arrow data would have to be converted
    # back to them. One driver receives 100,000 games per second; for more CPUs, split the sweep.
    # An error that a task raises itself would be raised again by every retry.
    remote = ray.remote(num_cpus=1, max_retries=RETRIES, retry_exceptions=False)(task)
    reference = ray.put(packed)
    order: InOrder[Result] = InOrder(study.done)
    begin = study.done
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
            # Wait for several tasks, because each wait takes time in proportion to the number of tasks.
            some = max(1, len(in_flight) // 16)
            ready, _ = ray.wait(list(in_flight), num_returns=some, timeout=WAIT_S)
            for one, results in zip(ready, ray.get(ready), strict=True):
                for index, result in order.put(in_flight.pop(one), results):
                    study.add(index, result)
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


def parser_of(module: str, description: str | None, kind: str) -> argparse.ArgumentParser:
    """Parses the common command-line arguments; `check` validates them."""
    parser = argparse.ArgumentParser(prog=f"python -m {module}", description=description)
    parser.add_argument("file", type=Path, help=f"the {kind} file")
    parser.add_argument("--games", type=int, metavar="N", help="number of games (default: key `games` of the file)")
    parser.add_argument("--seed", type=int, metavar="N", help="first seed (default: the seed in the file)")
    parser.add_argument("--batch", type=int, metavar="N", help="games per task (default: depends on the cluster)")
    parser.add_argument(
        "--address",
        metavar="ADDR",
        help="address of the cluster, or local for a new one on this machine (default: RAY_ADDRESS, or a cluster running here)",
    )
    return parser


def check(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> None:
    """Rejects numbers that are invalid in a tournament or sweep."""
    if arguments.batch is not None and arguments.batch < 1:
        parser.error(f"--batch is {arguments.batch}, expected at least 1")
    for name in ("games", "seed"):
        if (getattr(arguments, name) or 0) < 0:
            parser.error(f"--{name} is {getattr(arguments, name)}, expected 0 or more")


def remark(text: str) -> None:
    """Prints a line to standard error."""
    print(text, file=sys.stderr, flush=True)


def run(plan: Plan, study: Study[Result], task: Task[Result], arguments: argparse.Namespace) -> Exception | None:
    """Plays the remaining games until Ctrl-C or SIGTERM. Returns the error, if any; the study keeps all results before it."""
    # Job schedulers send SIGTERM to end a job.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    progress, failed = Progress(study.done, plan.games), None
    with contextlib.suppress(KeyboardInterrupt):
        try:
            if study.done < plan.games:
                connect(arguments.address)
                play_all(plan, study, task, batch=arguments.batch, show=progress.show)
        except Exception as error:  # noqa: BLE001  Whatever the cluster raises, results are kept.
            failed = error
    progress.end(study.done)
    return failed
