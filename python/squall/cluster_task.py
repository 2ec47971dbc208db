"""The task of a worker in a cluster: plays a batch of games in its own process."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from squall._native import SweepPlan, TournamentPlan
from squall.cluster import Packed

Plan = TypeVar("Plan")
_plans: dict[str, object] = {}
"""The plan of this process, by its digest: unpacked only once."""


def plan_of(packed: Packed, unpack: Callable[[Packed], Plan]) -> Plan:
    """Restores the packed plan.

    Raises ValueError if a different version of Squall packed it.
    """
    *_, digest = packed
    if digest not in _plans:
        _plans.clear()
        _plans[digest] = unpack(packed)
    return _plans[digest]  # type: ignore[return-value]  # A digest identifies one kind of plan.


def play_sweep(packed: Packed, begin: int, end: int) -> list[tuple[str, str]]:
    """The lines of a sweep's games from `begin` to before `end`."""
    return plan_of(packed, SweepPlan.unpack).lines(begin, end)


def play_tournament(packed: Packed, begin: int, end: int) -> list[str]:
    """The records of a tournament's games from `begin` to before `end`."""
    return plan_of(packed, TournamentPlan.unpack).records(begin, end)


def nothing(packed: Packed, begin: int, end: int) -> list[tuple[str, str]]:
    """Like `play_sweep` without playing any game: the cost of a task itself."""
    return [("", "")] * (end - begin)
