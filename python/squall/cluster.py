"""Games over a cluster of Ray: what `squall.sweep` and `squall.tournament` have in common.

A task plays a batch of games in a worker's process; this process takes what comes of them, in order. Workers read no files: the plan travels
with all that it needs. See docs/cluster.md.
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
"""What comes of a game."""
Taken = TypeVar("Taken", contravariant=True)
"""The same, as what takes it has it."""
Packed: TypeAlias = tuple[str, list[tuple[Path, bytes]], str]
"""A plan as its `pack` gives it: the last is its digest."""
Task: TypeAlias = Callable[[Packed, int, int], list[Result]]
"""What a worker does: the results of the games from the first place to before the second."""

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


class Plan(Protocol):
    """Which games are to be played."""

    @property
    def games(self) -> int: ...

    def pack(self) -> Packed: ...


class Study(Protocol[Taken]):
    """What came of the first of them, in order."""

    @property
    def done(self) -> int: ...

    def add(self, index: int, result: Taken) -> None: ...


@dataclass
class InOrder(Generic[Result]):
    """Results that come in any order, and go on in order."""

    due: int
    """The place of the next one to go on."""
    waiting: dict[int, list[Result]] = field(default_factory=dict)
    """Batches that came early, by the place of their first game."""

    def put(self, begin: int, results: list[Result]) -> Iterator[tuple[int, Result]]:
        """Takes a batch, and gives all games that can go on."""
        self.waiting[begin] = results
        while (batch := self.waiting.pop(self.due, None)) is not None:
            first, self.due = self.due, self.due + len(batch)
            yield from enumerate(batch, first)


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
    plan: Plan,
    study: Study[Result],
    task: Task[Result],
    *,
    batch: int | None = None,
    show: Callable[[int, int], None] = lambda done, cpus: None,
) -> None:
    """Plays all games that a study lacks on the cluster that Ray is connected to.

    `show` is told how many games are kept, and how many CPUs there are. Raises what a task raises; what the study has by then is kept.
    """
    ray = engine()
    packed = plan.pack()
    size = sum(len(content) for _, content in packed[1])
    if size > PACKED_BYTES_MAX:
        raise ValueError(f"the files of the games have {size} bytes, expected at most {PACKED_BYTES_MAX}")
    cpus, looked = cpus_of(ray), time.monotonic()
    games = batch or batch_of(plan.games - study.done, cpus)
    # A task's answer is the very lines of the tables, so that the same bytes come out: Arrow between workers
    # and driver would have to be turned into them again. One driver takes 100,000 games a second; who has more
    # CPUs cuts the sweep.
    # What a task itself raises is raised again by every retry.
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
            # Not one by one: waiting takes as long as there are tasks.
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
    """The command line's arguments that all of them have; `check` looks at what was given."""
    parser = argparse.ArgumentParser(prog=f"python -m {module}", description=description)
    parser.add_argument("file", type=Path, help=f"the {kind} file")
    parser.add_argument("--games", type=int, metavar="N", help="how many games, as the file's key of that name says")
    parser.add_argument("--seed", type=int, metavar="N", help="the first seed (as the file says)")
    parser.add_argument("--batch", type=int, metavar="N", help="games in a task (by the size of the cluster)")
    parser.add_argument(
        "--address",
        metavar="ADDR",
        help="the cluster's, or local for one of this machine alone (RAY_ADDRESS, or what runs here)",
    )
    return parser


def check(parser: argparse.ArgumentParser, arguments: argparse.Namespace) -> None:
    """Refuses numbers that are none of a tournament or sweep."""
    if arguments.batch is not None and arguments.batch < 1:
        parser.error(f"--batch is {arguments.batch}, expected at least 1")
    for name in ("games", "seed"):
        if (getattr(arguments, name) or 0) < 0:
            parser.error(f"--{name} is {getattr(arguments, name)}, expected none below 0")


def remark(text: str) -> None:
    """A line on standard error."""
    print(text, file=sys.stderr, flush=True)


def run(plan: Plan, study: Study[Result], task: Task[Result], arguments: argparse.Namespace) -> Exception | None:
    """Plays what is left to play, until Ctrl-C or SIGTERM; returns what failed, if anything did: what was played before is in the study."""
    # What ends a job asks in this way.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    progress, failed = Progress(study.done, plan.games), None
    with contextlib.suppress(KeyboardInterrupt):
        try:
            if study.done < plan.games:
                connect(arguments.address)
                play_all(plan, study, task, batch=arguments.batch, show=progress.show)
        except Exception as error:  # noqa: BLE001  Whatever a cluster says: what was played is kept.
            failed = error
    progress.end(study.done)
    return failed
