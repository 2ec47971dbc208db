"""Conversion of trained policies to ONNX.

`policies` has files of the trainers themselves (ray 2.60, stable-baselines3 2.9, torch 2.15), whose layers have 4
neurons, and in `expected.npz` observations and the outputs that PyTorch gives for them.
"""

import os
import pickle
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from squall import convert

onnx = pytest.importorskip("onnx")

POLICIES = Path(__file__).parent / "policies"
TOLERANCE = 1e-6
"""Tolerance of logits, which are of the order of 1."""


def outputs(data: bytes, observations: np.ndarray) -> np.ndarray:
    """A model's outputs by the evaluator of the package onnx."""
    from onnx.reference import ReferenceEvaluator

    model = ReferenceEvaluator(onnx.load_from_string(data))
    return np.concatenate([model.run(None, {"observation": row[None]})[0] for row in observations])


@pytest.mark.parametrize(
    ("name", "inputs", "activation", "options"),
    [
        ("cleanrl.pt", 61, "tanh", {}),
        ("simplemarl.pt", 43, "tanh", {}),
        ("sb3.zip", 67, "relu", {}),
        ("sb3_box.zip", 67, "relu", {}),
        ("rllib_policy_state.pkl", 61, "tanh", {}),
        ("rllib_box_policy_state.pkl", 61, "tanh", {"continuous": True}),
    ],
)
def test_each_format_gives_the_logits_of_pytorch(
    name: str, inputs: int, activation: str, options: dict[str, Any]
) -> None:
    policy = convert.policy_of(POLICIES / name, **options)
    assert (policy.inputs, policy.activation) == (inputs, activation)
    expected = np.load(POLICIES / "expected.npz")
    want = expected[name.split(".")[0].removesuffix("_policy_state")]
    if "box" in name:
        # A turn and a speed; Stable-Baselines3 in degrees and m/s, RLlib from -1 to 1.
        want = want[:, [1, 0]] / [180.0, 1.5] - [0.0, 1.0] if "sb3" in name else want[:, [1, 0]]
    got = outputs(convert.onnx_of(policy, {}), expected["observations"][:, :inputs])
    assert np.ptp(want) > 0.1
    np.testing.assert_allclose(got, want, rtol=0, atol=TOLERANCE)


def test_rllib_says_its_activation(tmp_path: Path) -> None:
    file = tmp_path / "policy_state.pkl"
    weights = {"_logits._model.0.weight": np.zeros((17, 61))}
    for given, want in [("relu", "relu"), ("linear", "none"), ("tanh", "tanh")]:
        model = {"model": {"fcnet_activation": given}}
        file.write_bytes(pickle.dumps({"weights": weights, "policy_spec": {"config": model}}))
        assert convert.policy_of(file).activation == want
    assert convert.policy_of(file, activation="elu").activation == "elu"


def test_the_strategy_names_what_was_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    tomllib = pytest.importorskip("tomllib")
    (tmp_path / "policies").mkdir()
    out = tmp_path / "policies" / "imported.onnx"
    assert convert.main([str(POLICIES / "rllib_policy_state.pkl"), "--out", str(out)]) == 0
    shown = capsys.readouterr()
    learned = tomllib.loads(shown.out)["behaviour"]["learned"]
    assert learned["model"] == "../policies/imported.onnx" and learned["action"] == "pyquaticus"
    assert learned["observation"] == {"kind": "pyquaticus"} and learned["sampled"] and learned["direct"]
    assert "_logits._model.0 (4 to 17)" in shown.err and "left out: _value_branch" in shown.err
    metadata = {entry.key: entry.value for entry in onnx.load(out).metadata_props}
    assert metadata["squall.action"] == "pyquaticus" and metadata["squall.period_s"] == "1"
    assert convert.main([str(POLICIES / "cleanrl.pt"), "--out", str(out)]) == 0
    assert "the 31 actions in order" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("size", "kind", "others"), [(43, "pyquaticus_2023", 3), (61, "pyquaticus", 5), (67, "pyquaticus_2026", 5)]
)
def test_the_number_of_observations_tells_their_kind(size: int, kind: str, others: int) -> None:
    assert convert.kinds_of(size)[0] == (kind, others)


class _Call:
    """When unpickled by pickle, calls a function."""

    def __init__(self, function: Callable[..., object], *arguments: object) -> None:
        self.made = function, arguments

    def __reduce__(self) -> Any:
        return self.made


@pytest.mark.parametrize(
    ("function", "argument"),
    [
        (os.system, lambda made: f"touch {made}"),
        (eval, lambda made: f"open({made!r}, 'w')"),
        (subprocess.check_call, lambda made: ["touch", made]),
        (getattr, None),
    ],
)
def test_a_hostile_file_is_refused_and_nothing_runs(
    tmp_path: Path, function: Callable[..., object], argument: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    made = tmp_path / "made"
    weights = {"actor.0.weight": np.zeros((17, 61), np.float32), "actor.0.bias": np.zeros(17, np.float32)}
    name = f"{function.__module__}.{function.__name__}"
    if function is getattr:
        data = b"\x80\x02cbuiltins\ngetattr\n(cos\nsystem\nVname\ntR."  # Pickled by name: modules cannot be pickled.
    else:
        data = pickle.dumps({"weights": weights, "extra": _Call(function, argument(str(made)))})
    for file in (tmp_path / "policy_state.pkl", tmp_path / "policy.pt"):
        if file.suffix == ".pkl":
            file.write_bytes(data)
        else:
            with zipfile.ZipFile(file, "w") as archive:
                archive.writestr("policy/data.pkl", data)
        assert convert.main([str(file)]) == 1
        told = capsys.readouterr().err
        assert str(file) in told and f"it uses {name}" in told and "nothing was executed" in told
    assert not made.exists() and not list(tmp_path.glob("*.onnx"))


@pytest.mark.parametrize(
    ("content", "told"),
    [
        (b"hello", "its first bytes are b'hello', expected policy_state.pkl of RLlib"),
        (b"\x80\x04", "it is not a valid pickle"),
        (pickle.dumps({"a": 1}), "its tables of weights are: none"),
        (pickle.dumps({"weights": {"conv.weight": np.zeros((2, 3, 4))}, "x": {"y": np.zeros((2, 2))}}), "expected"),
        (
            pickle.dumps({"weights": {"actor.0.weight": np.zeros((4, 61)), "actor.2.weight": np.zeros((17, 5))}}),
            "actor.0 (61 to 4); actor.2 (5 to 17), expected a chain",
        ),
        (
            pickle.dumps({"weights": {"actor.0.weight": np.zeros((17, 60))}}),
            "have 60 numbers, expected one of: 22 and 9",
        ),
        (
            pickle.dumps(
                {
                    "weights": {"_logits._model.0.weight": np.zeros((17, 61))},
                    "policy_spec": {"config": {"observation_filter": "MeanStdFilter"}},
                }
            ),
            "its observation_filter is MeanStdFilter, expected NoFilter",
        ),
        (pickle.dumps({name: {"0.weight": np.zeros((17, 61))} for name in "ab"}), "'a', 'b', expected one; choose"),
    ],
)
def test_other_files_are_refused_with_what_was_found(
    tmp_path: Path, content: bytes, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "policy_state.pkl"
    file.write_bytes(content)
    assert convert.main([str(file)]) == 1
    assert told in capsys.readouterr().err


def test_a_tensor_cannot_reach_beyond_its_storage(tmp_path: Path) -> None:
    for offset, size, stride in [(0, (2, 4), (4, 1)), (6, (1, 2), (1, 1)), (0, (1, 2), (1, -1))]:
        fits = offset + sum((n - 1) * step for n, step in zip(size, stride)) < 7 and min(stride) >= 0
        assert not fits
        with pytest.raises(convert.ConversionError, match="tensor"):
            convert._tensor(np.zeros(7, np.float32), offset, size, stride)


def test_networks_of_this_pytorch_give_the_same_logits_in_onnx_runtime(tmp_path: Path) -> None:
    torch = pytest.importorskip("torch")
    runtime = pytest.importorskip("onnxruntime")
    modules = {"tanh": torch.nn.Tanh, "relu": torch.nn.ReLU, "elu": torch.nn.ELU, "leakyrelu": torch.nn.LeakyReLU}
    for activation, module in modules.items():
        torch.manual_seed(1)
        net = torch.nn.Sequential(
            *[torch.nn.Linear(67, 64), module(), torch.nn.Linear(64, 64), module(), torch.nn.Linear(64, 17)]
        )
        file = tmp_path / "actor.pt"
        torch.save({"actor": net.state_dict()}, file)
        data = convert.onnx_of(convert.policy_of(file, activation=activation), {})
        session = runtime.InferenceSession(data)
        observations = np.random.default_rng(2).uniform(-1, 1, (20, 67)).astype(np.float32)
        got = np.concatenate([session.run(None, {"observation": row[None]})[0] for row in observations])
        want = net(torch.from_numpy(observations)).detach().numpy()
        np.testing.assert_allclose(got, want, rtol=0, atol=TOLERANCE)


def test_it_runs_as_a_program_without_the_trainers() -> None:
    code = "import sys; sys.modules.update(dict.fromkeys(['torch', 'ray', 'stable_baselines3'])); import runpy; "
    code += "sys.argv = ['convert', '--help']; runpy.run_module('squall.convert', run_name='__main__')"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert shown.returncode == 0 and "--activation" in shown.stdout
