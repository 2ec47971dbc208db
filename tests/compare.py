#!/usr/bin/env python3
"""Compares the speed of two commits: `tests/compare.py BASE [CHANGED]`.

Both commits are built in worktrees under target/compare, and the benchmark `regression` of crates/learn runs
alternately in each. A case is slower if the 95 % confidence interval of its cost ratio lies above 1 plus the tolerance.
Exits with status 1 if a case is slower. CHANGED defaults to HEAD.
"""

from __future__ import annotations

import argparse
import math
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

STUDENT = {2: 12.706, 3: 4.303, 4: 3.182, 5: 2.776, 6: 2.571, 7: 2.447, 8: 2.365, 9: 2.306, 10: 2.262}
"""Student's t for a 95 % interval, by the number of rounds."""


def output(*command: str, cwd: Path | None = None) -> str:
    return subprocess.run(command, cwd=cwd, check=True, stdout=subprocess.PIPE, text=True).stdout


def built(commit: str, name: str, root: Path) -> Path:
    """The benchmark's program, built from a commit."""
    tree = root / "target/compare" / name
    if (tree / ".git").exists():
        output("git", "checkout", "--quiet", "--detach", commit, cwd=tree)
    else:
        shutil.rmtree(tree, ignore_errors=True)
        output("git", "worktree", "prune", cwd=root)
        output("git", "worktree", "add", "--quiet", "--detach", str(tree), commit, cwd=root)
    command = ["cargo", "bench", "--locked", "-p", "squall-learn", "--bench", "regression", "--no-run"]
    target = root / "target/compare/build"
    error = subprocess.run([*command, "--target-dir", str(target)], cwd=tree, stderr=subprocess.PIPE, text=True)
    if error.returncode != 0:
        sys.exit(f"{error.stderr}\n{commit} has no benchmark `regression`, or does not compile")
    program = error.stderr.rsplit("(", 1)[1].split(")")[0]
    # The second build may overwrite the first.
    kept = root / "target/compare" / f"{name}.bench"
    shutil.copy2(Path(program) if Path(program).is_absolute() else tree / program, kept)
    return kept


def measured(program: Path, tree: Path) -> dict[str, float]:
    rows = output(str(program), "--bench", "--csv", cwd=tree / "crates/learn").splitlines()
    return {name: float(cost) for name, cost in (row.rsplit(",", 1) for row in rows)}


def interval(ratios: list[float]) -> tuple[float, float, float]:
    """The geometric mean of ratios and its 95 % interval."""
    logs = [math.log(ratio) for ratio in ratios]
    mean = statistics.mean(logs)
    half = STUDENT[len(logs)] * statistics.stdev(logs) / math.sqrt(len(logs))
    return math.exp(mean), math.exp(mean - half), math.exp(mean + half)


def main() -> int:
    parser = argparse.ArgumentParser(description="Compares the speed of two commits.")
    parser.add_argument("base", help="commit to compare with")
    parser.add_argument("changed", nargs="?", default="HEAD", help="commit to check [default: HEAD]")
    parser.add_argument("--rounds", type=int, default=6, choices=range(2, 11), metavar="2..10", help="[default: 6]")
    parser.add_argument("--tolerance", type=float, default=0.02, help="cost increase to ignore [default: 0.02]")
    args = parser.parse_args()
    root = Path(output("git", "rev-parse", "--show-toplevel").strip())
    commits = {"base": args.base, "changed": args.changed}
    commits = {name: output("git", "rev-parse", "--verify", f"{commit}^{{commit}}").strip() for name, commit in commits.items()}
    programs = {name: built(commit, name, root) for name, commit in commits.items()}
    ratios: dict[str, list[float]] = {}
    for turn in range(args.rounds):
        # The order alternates, so that a steady drift of the machine cancels out.
        order = sorted(programs, reverse=turn % 2 == 1)
        costs = {name: measured(programs[name], root / "target/compare" / name) for name in order}
        for case in costs["base"].keys() & costs["changed"].keys():
            ratios.setdefault(case, []).append(costs["changed"][case] / costs["base"][case])
        print(f"round {turn + 1} of {args.rounds}", file=sys.stderr)
    slower = False
    print(f"{'case':44}  {'cost':>6}  95 % interval")
    for case, of_case in sorted(ratios.items()):
        ratio, low, high = interval(of_case)
        verdict = "SLOWER" if low > 1 + args.tolerance else "faster" if high < 1 - args.tolerance else ""
        slower |= verdict == "SLOWER"
        print(f"{case:44}  {ratio:>6.3f}  {low:.3f} to {high:.3f}  {verdict}".rstrip())
    return int(slower)


if __name__ == "__main__":
    sys.exit(main())
