"""Reads the curves of a training with TensorBoard, and compares them with its table of updates.

    python tests/training/events_check.py FOLDER

needs the package tensorboard.
"""

import csv
import math
import sys
from pathlib import Path

from tensorboard.backend.event_processing.event_accumulator import EventAccumulator


def main() -> None:
    folder = Path(sys.argv[1])
    events = EventAccumulator(str(folder), size_guidance={"scalars": 0}).Reload()
    with open(folder / "updates.csv", newline="") as file:
        updates = list(csv.DictReader(file))
    assert updates, "there are no updates"
    for name in ["reward", "policy_loss", "value_loss", "entropy", "divergence", "clipped", "epochs"]:
        # What an algorithm does not have is an empty cell and no point of a curve.
        known = [update for update in updates if update[name]]
        scalars = events.Scalars(f"learning/{name}") if known else []
        assert [scalar.step for scalar in scalars] == [int(update["samples"]) for update in known], name
        for scalar, update in zip(scalars, known):
            assert math.isclose(scalar.value, float(update[name]), rel_tol=1e-6, abs_tol=1e-12), (name, scalar, update)
    with open(folder / "evaluations.csv", newline="") as file:
        evaluations = list(csv.DictReader(file))
    for opponent in {evaluation["opponent"] for evaluation in evaluations}:
        seen = [evaluation for evaluation in evaluations if evaluation["opponent"] == opponent]
        ahead = [float(one["points"]) - float(one["points_against"]) for one in seen]
        scalars = events.Scalars(f"points_ahead/{opponent}")
        assert all(math.isclose(s.value, a, abs_tol=1e-5) for s, a in zip(scalars, ahead, strict=True)), opponent
    print(f"{len(updates)} updates and {len(evaluations)} evaluations, as TensorBoard reads them")


if __name__ == "__main__":
    main()
