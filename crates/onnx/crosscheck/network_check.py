"""Checks perceptrons written by the tests with `onnx`, and compares their outputs with ONNX Runtime.

Usage: network_check.py FOLDER, with files from `crates/onnx/tests/network/perceptron.rs`.
"""

import json
import sys
from pathlib import Path

import numpy as np
import onnx
import onnxruntime

# Both round each sum, in different orders.
ERROR_MAX = 1e-5


def check(condition, what):
    if not condition:
        sys.exit(f"network_check: {what}")


def main(folder):
    files = sorted(Path(folder).glob("*.onnx"))
    check(files, f"no files in {folder}")
    for file in files:
        model = onnx.load(file)
        onnx.checker.check_model(model, full_check=True)
        entries = {entry.key: entry.value for entry in model.metadata_props}
        check(entries == {"layout": "1", "actions": "17"}, f"{file.name}: unexpected metadata: {entries}")
        session = onnxruntime.InferenceSession(file, providers=["CPUExecutionProvider"])
        cases = json.loads(file.with_suffix(".json").read_text())
        rows = np.array([case["input"] for case in cases], dtype=np.float32)
        # All rows as one batch, because files accept any number of rows.
        for port, values in zip(session.get_outputs(), session.run(None, {"observation": rows})):
            ours = np.array([case[port.name] for case in cases])
            error = np.max(np.abs(values - ours) / (1 + np.abs(values)))
            check(error < ERROR_MAX, f"{file.name}: {port.name} differs by {error}")
            print(f"{file.name}: {port.name}: {len(rows)} rows, error at most {error:.1e}")


if __name__ == "__main__":
    check(len(sys.argv) == 2, __doc__)
    main(sys.argv[1])
