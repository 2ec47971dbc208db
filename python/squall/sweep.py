"""A sweep on a Ray cluster: `python -m squall.sweep FILE`.

Plays the same games as `squall sweep FILE`, and writes the same bytes to the same files. See docs/cluster.md.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path

from squall._native import SweepPlan, SweepStudy
from squall.cluster import check, parser_of, remark, run
from squall.cluster_task import play_sweep


@dataclass
class Kept:
    """The stored results of a sweep in its folder."""

    study: SweepStudy

    @property
    def done(self) -> int:
        """The number of games stored."""
        return self.study.done

    def add(self, index: int, result: tuple[str, str]) -> None:
        """Adds the next game."""
        self.study.add(index, *result)


def main(words: list[str] | None = None) -> int:
    """Runs a sweep. Returns 0, 1 if a game could not start or something failed, or 130 if stopped."""
    parser = parser_of("squall.sweep", __doc__, "sweep")
    parser.add_argument("--out", type=Path, metavar="FOLDER", help="folder for the tables and the report (runs/sweep/NAME)")
    parser.add_argument(
        "--resume", action="store_true", help="resume the sweep in the folder"
    )
    arguments = parser.parse_args(words)
    check(parser, arguments)
    try:
        plan = SweepPlan.open(arguments.file, arguments.games, arguments.seed)
        folder = arguments.out or Path("runs/sweep") / plan.name
        study = plan.resume(folder) if arguments.resume else plan.begin(folder)
    except (ValueError, OverflowError, OSError) as error:
        remark(f"Error: {error}")
        return 1
    remark(f"{plan.points} points with {plan.games_per_point} games each; tables and report in {folder}")
    if study.done > 0:
        remark(f"{study.done} of {plan.games} games were already played")
    if (arguments.games or 0) % 2:
        remark(f"{arguments.games} games per point, rounded up to {arguments.games + 1}: half of them on each side")
    failed = run(plan, Kept(study), play_sweep, arguments)
    if failed is not None:
        remark(f"Error: {failed}\n{study.done} of {plan.games} games are kept; use --resume to continue")
        return 1
    text, failures = study.report()
    print(f"{text}\nwith curves: squall view {folder}", flush=True)
    if study.done < plan.games:
        remark("stopped; use --resume to continue")
        return 130
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
