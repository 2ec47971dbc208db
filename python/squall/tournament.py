"""A tournament over a cluster of Ray: `python -m squall.tournament FILE`.

The same games as `squall tournament FILE` plays, and the same tables. See docs/cluster.md.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from pathlib import Path

from squall._native import TournamentPlan
from squall.cluster import check, parser_of, remark, run
from squall.cluster_task import play_tournament


@dataclass
class Kept:
    """The games of a tournament that were played."""

    records: list[str] = field(default_factory=list)

    @property
    def done(self) -> int:
        """How many they are."""
        return len(self.records)

    def add(self, index: int, result: str) -> None:
        """Adds the next game."""
        assert index == len(self.records)
        self.records.append(result)


def main(words: list[str] | None = None) -> int:
    """Runs a tournament; returns 0, 1 where a game could not start or something failed, or 130 where it was stopped."""
    parser = parser_of("squall.tournament", __doc__, "tournament")
    parser.add_argument("--json", type=Path, metavar="FILE", help="writes everything to this file, every game with its digest")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="writes a line for each entry to this file")
    arguments = parser.parse_args(words)
    check(parser, arguments)
    files = [path for path in (arguments.json, arguments.csv) if path is not None]
    try:
        plan = TournamentPlan.open(arguments.file, arguments.games, arguments.seed)
        for path in files:  # Better now than after hours of games.
            path.touch()
    except (ValueError, OverflowError, OSError) as error:
        remark(f"Error: {error}")
        return 1
    if (arguments.games or 0) % 2:
        remark(f"{arguments.games} games a pairing are {arguments.games + 1}: half of them on each side")
    study = Kept()
    failed = run(plan, study, play_tournament, arguments)
    text, json, csv, failures = plan.report(study.records)
    try:
        for path, content in ((arguments.json, json), (arguments.csv, csv)):
            if path is not None:
                path.write_text(content)
    except OSError as error:
        failed = failed or error
    print(text, end="", flush=True)
    if failed is not None:
        remark(f"Error: {failed}")
        return 1
    if study.done < plan.games:
        return 130
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
