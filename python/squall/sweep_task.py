"""What a worker of a cluster does of a sweep: it plays a batch of games, in its own process."""

from __future__ import annotations

from pathlib import Path
from typing import TypeAlias

from squall._native import SweepPlan

Packed: TypeAlias = tuple[str, list[tuple[Path, bytes]], str]
"""A plan as `SweepPlan.pack` gives it: the last is its digest."""
_plans: dict[str, SweepPlan] = {}
"""The plan that this process plays, by its digest: it is unpacked once."""


def play(packed: Packed, begin: int, end: int) -> list[tuple[str, str]]:
    """The lines of the games from `begin` to before `end`.

    Raises ValueError where this machine's Squall is another version than that which packed the plan.
    """
    *_, digest = packed
    if digest not in _plans:
        _plans.clear()
        _plans[digest] = SweepPlan.unpack(packed)
    return _plans[digest].lines(begin, end)


def nothing(packed: Packed, begin: int, end: int) -> list[tuple[str, str]]:
    """The same for games of which none is played: what a task costs by itself."""
    return [("", "")] * (end - begin)
