"""Checks the numpy code of competition entries: networks against ONNX Runtime, observations against Pyquaticus' own.

Usage: entry_check.py, in the root of the repository.
"""

import json
import math
import sys
import types
from pathlib import Path

import numpy as np
import onnxruntime

ERROR_MAX = 1e-5


def check(condition, what):
    if not condition:
        sys.exit(f"entry_check: {what}")


def entry(observation):
    """The module of an entry with these observations."""
    text = Path("src/submission/solution.py").read_text().replace("@OBSERVATION@", observation)
    module = types.ModuleType("solution")
    exec(text.replace("@CONTINUOUS@", "False").replace("@SAMPLED@", "False"), module.__dict__)
    return module


def networks():
    solution = entry("pyquaticus")
    random = np.random.default_rng(1)
    files = [*Path("crates/onnx/tests/network").glob("*.onnx"), *Path("scenarios/policies").glob("*.onnx")]
    check(len(files) > 10, "files are missing")
    for file in sorted(files):
        session = onnxruntime.InferenceSession(file, providers=["CPUExecutionProvider"])
        if len(session.get_inputs()) > 1:
            continue
        port = session.get_inputs()[0]
        shape = [size if isinstance(size, int) else 1 for size in port.shape]
        observation = random.normal(size=shape).astype(np.float32)
        given = observation.astype(np.float64 if port.type == "tensor(double)" else np.float32)
        found = solution.Network(file.read_bytes()).evaluate(observation)
        for output, want in zip(session.get_outputs(), session.run(None, {port.name: given})):
            want = np.asarray(want, np.float64).ravel()
            error = np.max(np.abs(np.asarray(found[output.name], np.float64).ravel() - want) / (1 + np.abs(want)))
            check(error < ERROR_MAX, f"{file.name}: {output.name} differs by {error}")
    print(f"{len(files)} networks give the results of ONNX Runtime")


def observations():
    reference = json.loads(Path("agent/tests/helm/pyquaticus/2026_3v3.json").read_text())
    names = reference["names"]
    diagonal_m = math.hypot(160, 80)
    for state in reference["states"]:
        for boat in state["boats"]:
            numbers = np.array(boat["observation"], np.float32)
            given = list(zip(names, numbers))
            check(np.array_equal(entry("pyquaticus_2026").observed(numbers), numbers), "2026")
            kept = [number for name, number in given if not name.endswith("is_disabled")]
            check(np.array_equal(entry("pyquaticus").observed(numbers), kept), "2025")
            kept = [
                (number + 1) * diagonal_m / (80 if "scrimmage" in name else diagonal_m + 10) - 1
                if name.endswith("distance")
                else number
                for name, number in given
                if not name.endswith(("is_disabled", "score"))
            ]
            check(np.allclose(entry("pyquaticus_2023").observed(numbers), kept, atol=1e-6), "2023")
            # From the competition of 2025, without `is_disabled`.
            numbers = entry("pyquaticus").observed(numbers)
            check(np.array_equal(entry("pyquaticus").observed(numbers), numbers), "2025 of 2025")
            check(np.allclose(entry("pyquaticus_2023").observed(numbers), kept, atol=1e-6), "2023 of 2025")
    print("observations of 2023, 2025 and 2026")


if __name__ == "__main__":
    networks()
    observations()
