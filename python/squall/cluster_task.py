"""What a worker of a cluster does: it plays a batch of games, in its own process."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from squall._native import SweepPlan, TournamentPlan
from squall.cluster import Packed

Plan = TypeVar("Plan")
_plans: dict[str, object] = {}
"""The plan that this process plays, by its digest: it is unpacked once."""


def plan_of(packed: Packed, unpack: Callable[[Packed], Plan]) -> Plan:
    """The plan that was packed.

    Raises ValueError where this machine's Squall is another version than that which packed it.
    """
    *_, digest = packed
    if digest not in _plans:
        _plans.clear()
        _plans[digest] = unpack(packed)
    return _plans[digest]  # type: ignore[return-value]  # What a digest stands for is of one kind.


def play_sweep(packed: Packed, begin: int, end: int) -> list[tuple[str, str]]:
    """The lines of a sweep's games from `begin` to before `end`."""
    return plan_of(packed, SweepPlan.unpack).lines(begin, end)


def play_tournament(packed: Packed, begin: int, end: int) -> list[str]:
    """The records of a tournament's games from `begin` to before `end`."""
    return plan_of(packed, TournamentPlan.unpack).records(begin, end)


def nothing(packed: Packed, begin: int, end: int) -> list[tuple[str, str]]:
    """As `play_sweep`, of games of which none is played: what a task costs by itself."""
    return [("", "")] * (end - begin)
