"""A tournament on a Ray cluster: `python -m squall.tournament FILE`.

Plays the same games as `squall tournament FILE`, and prints the same tables. See docs/cluster.md.
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
    """The games of a tournament played so far."""

    records: list[str] = field(default_factory=list)

    @property
    def done(self) -> int:
        """The number of games played."""
        return len(self.records)

    def add(self, index: int, result: str) -> None:
        """Adds the next game."""
        assert index == len(self.records)
        self.records.append(result)


def main(words: list[str] | None = None) -> int:
    """Runs a tournament. Returns 0, 1 if a game could not start or something failed, or 130 if stopped."""
    parser = parser_of("squall.tournament", __doc__, "tournament")
    parser.add_argument("--json", type=Path, metavar="FILE", help="write everything to this file, including every game with its digest")
    parser.add_argument("--csv", type=Path, metavar="FILE", help="write one line per entry to this file")
    arguments = parser.parse_args(words)
    check(parser, arguments)
    files = [path for path in (arguments.json, arguments.csv) if path is not None]
    try:
        plan = TournamentPlan.open(arguments.file, arguments.games, arguments.seed)
        for path in files:  # Fail now rather than after hours of games.
            path.touch()
    except (ValueError, OverflowError, OSError) as error:
        remark(f"Error: {error}")
        return 1
    if (arguments.games or 0) % 2:
        remark(f"{arguments.games} games per pairing, rounded up to {arguments.games + 1}: half of them on each side")
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
