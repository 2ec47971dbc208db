"""Converts a trained policy to ONNX: `python -m squall.convert FILE`.

Reads `policy_state.pkl` of RLlib, `state_dict` files of PyTorch as CleanRL and simpleMARL write them, and the zip files
of Stable-Baselines3. Needs numpy and onnx, but neither PyTorch nor the trainer. Code in these files is never executed:
only the names in `_SAFE` are resolved; `_OPAQUE` names become placeholders, and any other is refused.
"""

from __future__ import annotations

import argparse
import io
import json
import pickle
import re
import sys
import zipfile
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

BYTES_MAX = 1 << 28
"""Maximum size of a file, unpacked."""
SUPPORTED = (
    "policy_state.pkl of RLlib, a state_dict that torch.save wrote (CleanRL, simpleMARL), or a zip file of"
    " Stable-Baselines3"
)
ACTIVATIONS = {"tanh": "Tanh", "relu": "Relu", "elu": "Elu", "sigmoid": "Sigmoid", "leakyrelu": "LeakyRelu", "none": ""}
KINDS = {"pyquaticus_2026": (22, 9), "pyquaticus": (21, 8), "pyquaticus_2023": (19, 8)}
"""Kinds of observations, with their values for the own boat and for each other boat."""


class ConversionError(ValueError):
    """A file is not a policy that can be converted."""


# Files: reading them without executing code.


class _OpaqueType(type):
    def __call__(cls, *_: object, **__: object) -> Any:
        return cls

    def __setitem__(cls, key: object, value: object) -> None:
        pass


class _Opaque(metaclass=_OpaqueType):
    """A placeholder for a class, function or object that a policy does not need, such as a trainer's settings."""

    def __new__(cls, *_: object, **__: object) -> Any:
        return cls

    @classmethod
    def _ignore(cls, *_: object) -> None:
        pass

    __setstate__ = append = extend = add = _ignore


@dataclass(frozen=True)
class _Storage:
    """The type of a PyTorch storage."""

    dtype: str


def _tensor(storage: np.ndarray, offset: int, size: tuple[int, ...], stride: tuple[int, ...], *_: object) -> np.ndarray:
    if not isinstance(storage, np.ndarray) or len(size) != len(stride):
        raise ConversionError("a tensor has no storage")
    numbers = [offset, *size, *stride]
    if not all(isinstance(number, int) and number >= 0 for number in numbers):
        raise ConversionError("a tensor has a negative size")
    last = offset + sum((n - 1) * step for n, step in zip(size, stride))
    if 0 not in size and last >= storage.size:
        raise ConversionError("a tensor goes beyond its storage")
    if 0 in size:
        return np.zeros(size, storage.dtype)
    strides = tuple(step * storage.itemsize for step in stride)
    return np.lib.stride_tricks.as_strided(storage[offset:], size, strides).copy()


def _parameter(data: np.ndarray, *_: object) -> np.ndarray:
    return data


def _array_names() -> dict[tuple[str, str], Any]:
    # Pickle with numpy itself to find the functions, because their modules have been renamed.
    found: dict[tuple[str, str], Any] = {("numpy", "ndarray"): np.ndarray, ("numpy", "dtype"): np.dtype}
    reconstruct = np.zeros(1).__reduce__()[0]
    scalar = np.float32(0).__reduce__()[0]
    from_buffer = np.zeros(1).__reduce_ex__(5)[0]
    for module in ("numpy.core", "numpy._core"):
        found[f"{module}.multiarray", "_reconstruct"] = reconstruct
        found[f"{module}.multiarray", "scalar"] = scalar
        found[f"{module}.numeric", "_frombuffer"] = from_buffer
    return found


def _encoded(text: str, encoding: str = "latin1") -> bytes:
    """Bytes in pickles of old protocols."""
    if encoding not in ("latin1", "latin-1"):
        raise ConversionError(f"bytes are encoded as {encoding!r}, expected latin1")
    return text.encode("latin1")


_STORAGES = {
    "FloatStorage": "<f4",
    "DoubleStorage": "<f8",
    "HalfStorage": "<f2",
    "BFloat16Storage": "bfloat16",
    "LongStorage": "<i8",
    "IntStorage": "<i4",
    "ShortStorage": "<i2",
    "CharStorage": "i1",
    "ByteStorage": "u1",
    "BoolStorage": "?",
}
_SAFE: dict[tuple[str, str], Any] = {
    ("collections", "OrderedDict"): OrderedDict,
    ("_codecs", "encode"): _encoded,
    ("torch._utils", "_rebuild_tensor_v2"): _tensor,
    ("torch._utils", "_rebuild_parameter"): _parameter,
    ("torch", "Size"): tuple,
    **{("torch", name): _Storage(dtype) for name, dtype in _STORAGES.items()},
    **_array_names(),
}
_OPAQUE = re.compile(
    r"(ray|gymnasium|gym|pettingzoo|pyquaticus|squall|stable_baselines3|tree|torch|packaging|cloudpickle|__main__"
    r"|policy_mapping_fn|abc|enum|types|typing|logging|datetime|pathlib|numpy\.random)(\..*)? .*"
    r"|builtins (set|frozenset|slice|range|type|object|int|float|bool|str|bytes|tuple|list|dict|complex)"
    r"|collections (defaultdict|deque|namedtuple)"
)
"""Names, each with its module, whose objects are read as `_Opaque`: nothing is imported."""


class _Reader(pickle.Unpickler):
    """Reads a pickle and resolves safe names only."""

    def __init__(self, data: bytes, storages: Callable[[str, str, int], np.ndarray] | None = None) -> None:
        super().__init__(io.BytesIO(data), encoding="latin1")
        self.storages = storages

    def find_class(self, module: str, name: str) -> Any:
        found = _SAFE.get((module, name))
        if found is not None:
            return found
        if _OPAQUE.fullmatch(f"{module} {name}"):
            return _Opaque
        raise ConversionError(f"it uses {module}.{name}, expected arrays and tensors only; nothing was executed")

    def persistent_load(self, pid: Any) -> np.ndarray:
        if self.storages is None or not (isinstance(pid, tuple) and len(pid) == 5 and pid[0] == "storage"):
            raise ConversionError("it refers to data outside the file")
        _, kind, key, _, count = pid
        if not isinstance(kind, _Storage):
            raise ConversionError(f"its storage {key} is of an unknown type, expected numbers")
        return self.storages(kind.dtype, str(key), int(count))


def _load(data: bytes, storages: Callable[[str, str, int], np.ndarray] | None = None) -> Any:
    try:
        return _Reader(data, storages).load()
    except ConversionError:
        raise
    except Exception as error:  # A damaged pickle can raise nearly anything.
        raise ConversionError(f"it is not a valid pickle ({type(error).__name__}: {error})") from error


def _entry(archive: zipfile.ZipFile, name: str) -> bytes:
    if archive.getinfo(name).file_size > BYTES_MAX:
        raise ConversionError(f"{name} has more than {BYTES_MAX} bytes")
    return archive.read(name)


def _load_torch(archive: zipfile.ZipFile, root: str) -> Any:
    """The content of a file of torch.save, whose `data.pkl` is in the folder `root`."""
    names = set(archive.namelist())
    order = _entry(archive, f"{root}byteorder").decode() if f"{root}byteorder" in names else "little"
    if order != "little":
        raise ConversionError(f"its byte order is {order}, expected little")

    def storage(dtype: str, key: str, count: int) -> np.ndarray:
        name = f"{root}data/{key}"
        if name not in names:
            raise ConversionError(f"it has no {name}")
        data = _entry(archive, name)
        if dtype == "bfloat16":
            return (np.frombuffer(data, "<u2", count).astype("<u4") << 16).view("<f4")
        return np.frombuffer(data, dtype, count)

    return _load(_entry(archive, f"{root}data.pkl"), storage)


@dataclass
class Source:
    """The content of a file."""

    trainer: str
    content: Any
    facts: Mapping[str, Any] = field(default_factory=dict)
    """The `data` of Stable-Baselines3."""


def read(path: Path) -> Source:
    """Reads a file of any supported kind.

    Raises ConversionError if its kind is not supported, or it uses names that a policy does not need.
    """
    if path.is_dir():
        found = sorted(str(each.relative_to(path)) for each in path.glob("**/policy_state.pkl"))
        if len(found) != 1:
            listed = ", ".join(found) or "no policy_state.pkl"
            raise ConversionError(f"it is a folder with {listed}, expected one file")
        path = path / found[0]
    data = path.read_bytes()
    if len(data) > BYTES_MAX:
        raise ConversionError(f"it has {len(data)} bytes, expected at most {BYTES_MAX}")
    if not zipfile.is_zipfile(io.BytesIO(data)):
        if data[:1] != b"\x80":
            raise ConversionError(f"its first bytes are {data[:8]!r}, expected {SUPPORTED}")
        if data[2:16].find(b"\xfc\x9c\x46\xf9\x20\x6a\xa8\x50\x19") >= 0:
            raise ConversionError("it has the format of PyTorch before 1.6: load it with a newer PyTorch, and save it again with torch.save")
        return Source("RLlib", _load(data))
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        names = archive.namelist()
        roots = [name[: -len("data.pkl")] for name in names if re.fullmatch(r"([^/]+/)?data\.pkl", name)]
        if roots:
            return Source("PyTorch", _load_torch(archive, roots[0]))
        if "policy.pth" in names and "data" in names:
            facts = json.loads(_entry(archive, "data"))
            inner = _entry(archive, "policy.pth")
            if not zipfile.is_zipfile(io.BytesIO(inner)):
                raise ConversionError("its policy.pth is not a file of torch.save")
            with zipfile.ZipFile(io.BytesIO(inner)) as policy:
                root = next((name[: -len("data.pkl")] for name in policy.namelist() if name.endswith("data.pkl")), "")
                return Source("Stable-Baselines3", _load_torch(policy, root), facts)
        raise ConversionError(f"it is a zip file with {', '.join(names[:6])}, expected {SUPPORTED}")


# Networks: recognising layers by their names and shapes.


@dataclass
class Layer:
    """A fully connected layer."""

    name: str
    weight: np.ndarray
    """Shape (outputs, inputs)."""
    bias: np.ndarray

    def __str__(self) -> str:
        return f"{self.name} ({self.weight.shape[1]} to {self.weight.shape[0]})"


_CRITIC = re.compile(r"(^|[._/])(critic|value|vf|qf?\d|target|q_net_target|log_?std|logstd)", re.IGNORECASE)


def _tables(content: Any, path: str = "") -> Iterator[tuple[str, dict[str, np.ndarray]]]:
    """All tables of arrays in the content, with their paths."""
    if not isinstance(content, Mapping):
        return
    arrays = {str(name): array for name, array in content.items() if isinstance(array, np.ndarray)}
    if any(array.ndim == 2 for array in arrays.values()):
        yield path, arrays
    for name, inner in content.items():
        if "optim" not in str(name):
            yield from _tables(inner, f"{path}.{name}" if path else str(name))


def _weights(content: Any, key: str | None) -> dict[str, np.ndarray]:
    tables = dict(_tables(content))
    if key is not None:
        tables = {path: arrays for path, arrays in tables.items() if path == key}
    if len(tables) != 1:
        found = ", ".join(repr(path) for path in tables) or "none"
        hint = "; choose one with --key" if tables else ""
        raise ConversionError(f"its tables of weights are: {found}, expected one{hint}")
    return next(iter(tables.values()))


def _layers(weights: Mapping[str, np.ndarray]) -> tuple[list[Layer], list[str]]:
    """The policy's layers in order, and the names of arrays for the critic or for exploration."""
    layers, left, used = [], [], set()
    for name, array in weights.items():
        if _CRITIC.search(name):
            left.append(name)
        elif match := re.fullmatch(r"(.*)[./](weight|kernel)(:0)?", name):
            stem, kind = match[1], match[2]
            weight = array.T if kind == "kernel" else array
            if weight.ndim != 2:
                raise ConversionError(f"{name} has the shape {array.shape}, expected a fully connected layer")
            bias_name = next((n for n in (f"{stem}.bias", f"{stem}/bias", f"{stem}/bias:0") if n in weights), None)
            bias = np.zeros(weight.shape[0]) if bias_name is None else weights[bias_name]
            if bias.shape != weight.shape[:1]:
                raise ConversionError(f"the bias of {stem} has the shape {bias.shape}, expected {weight.shape[:1]}")
            used |= {name, bias_name}
            layers.append(Layer(stem, weight.astype(np.float32), bias.astype(np.float32)))
    unknown = [name for name in weights if name not in used and name not in left]
    if unknown:
        raise ConversionError(f"it has {', '.join(unknown[:6])}, expected weights and biases of fully connected layers")
    return layers, left


def _chain(layers: list[Layer]) -> list[Layer]:
    """The layers in order from the observation to the action.

    Raises ConversionError if they form no chain.
    """
    # RLlib stores the output layer first.
    outputs = [layer for layer in layers if re.search(r"(^|[._/])(_logits|fc_out|pi|action_net)([._/]|$)", layer.name)]
    chain = [layer for layer in layers if layer not in outputs] + outputs
    sizes = [(layer.weight.shape[1], layer.weight.shape[0]) for layer in chain]
    if not chain or any(size[1] != following[0] for size, following in zip(sizes, sizes[1:])):
        listed = "; ".join(map(str, chain)) or "none"
        raise ConversionError(
            f"its layers of the policy are: {listed}, expected a chain in which each takes the outputs of the one before"
        )
    return chain


def _inside(content: Any, *names: str) -> Any:
    """The value at this path, or None."""
    for name in names:
        content = content.get(name) if isinstance(content, Mapping) else None
    return content


def _activation(source: Source, layers: list[Layer]) -> str:
    """The activation that the file implies."""
    if source.trainer == "RLlib":
        given = _inside(source.content, "policy_spec", "config", "model", "fcnet_activation") or "tanh"
        return "none" if given == "linear" else str(given)
    if source.trainer == "Stable-Baselines3":
        if named := re.search(r"activation\.(\w+)", str(_inside(source.facts, "policy_kwargs", "activation_fn"))):
            return named[1].lower()
        policy = str(_inside(source.facts, "policy_class", "__module__"))
        return "relu" if re.search(r"\.(dqn|sac|td3)\.", policy + ".") else "tanh"
    if all(re.match(r"(actor|actor_mean|module\.actor)\.\d+$", layer.name) for layer in layers):
        return "tanh"
    raise ConversionError("it does not name the activation of its layers: choose one with --activation")


# The ONNX file.


@dataclass
class Policy:
    """A policy found in a file."""

    trainer: str
    layers: list[Layer]
    left_out: list[str]
    activation: str
    picks: list[tuple[int, float, float]] | None
    """A turn and a speed, each as the index of an output, a factor and an addend; None for discrete actions."""

    @property
    def inputs(self) -> int:
        """Number of values of an observation."""
        return int(self.layers[0].weight.shape[1])

    @property
    def outputs(self) -> int:
        """Number of actions, or of values of an action."""
        return int(self.layers[-1].weight.shape[0]) if self.picks is None else 2


def _picks(source: Source, outputs: int, continuous: bool) -> list[tuple[int, float, float]] | None:
    """How a turn and a speed from -1 to 1 follow from the outputs."""
    space = source.facts.get("action_space", {})
    if isinstance(space, Mapping) and "low_repr" not in space and "n" in space and not continuous:
        return None
    if isinstance(space, Mapping) and ("low" in space or "low_repr" in space):
        lows, highs = (re.findall(r"-?\d+\.?\d*(?:e[+-]?\d+)?", str(space.get(end, ""))) for end in ("low", "high"))
        if len(lows) != 2 or len(highs) != 2 or outputs != 2:
            raise ConversionError(
                f"its actions are {space}, expected two numbers: a speed in m/s and a turn in degrees"
            )
        lows, highs = [float(low) for low in lows], [float(high) for high in highs]
        if lows == [-1, -1] and highs == [1, 1]:
            return [(0, 1.0, 0.0), (1, 1.0, 0.0)]  # The format of Squall's own environments.
        return [(1, 1 / 180.0, 0.0), (0, 2.0 / highs[0], -1.0)]
    if continuous:
        if outputs not in (2, 4):
            raise ConversionError(f"it has {outputs} outputs, expected 2, or 4 with those for exploration")
        return [(1, 1.0, 0.0), (0, 1.0, 0.0)]  # Pyquaticus: speed, then heading; RLlib scales both to -1 to 1.
    return None


def policy_of(path: Path, *, activation: str | None = None, key: str | None = None, continuous: bool = False) -> Policy:
    """The policy in a file.

    Raises ConversionError if there is none, or its layers form no chain.
    """
    source = read(path)
    filtered = _inside(source.content, "policy_spec", "config", "observation_filter") or "NoFilter"
    if source.trainer == "RLlib" and filtered != "NoFilter":
        raise ConversionError(
            f"its observation_filter is {filtered}, expected NoFilter: the filter's state is not read"
        )
    layers, left = _layers(_weights(source.content, key))
    chain = _chain(layers)
    activation = activation or _activation(source, chain)
    if activation not in ACTIVATIONS:
        raise ConversionError(f"its activation is {activation}, expected one of {', '.join(ACTIVATIONS)}")
    return Policy(source.trainer, chain, left, activation, _picks(source, chain[-1].weight.shape[0], continuous))


def onnx_of(policy: Policy, metadata: Mapping[str, str]) -> bytes:
    """The policy as an ONNX file with one input, `observation`, and one output, `action`."""
    from onnx import TensorProto, helper, numpy_helper

    nodes, weights, at = [], [], "observation"
    operator = ACTIVATIONS[policy.activation]
    for i, layer in enumerate(policy.layers):
        is_last = i == len(policy.layers) - 1
        out = "action" if is_last and policy.picks is None else f"layer_{i}"
        weights += [
            numpy_helper.from_array(layer.weight, f"weight_{i}"),
            numpy_helper.from_array(layer.bias, f"bias_{i}"),
        ]
        nodes.append(helper.make_node("Gemm", [at, f"weight_{i}", f"bias_{i}"], [out], transB=1))
        at = out
        if operator and not is_last:
            at = f"hidden_{i}"
            nodes.append(helper.make_node(operator, [out], [at]))
    if policy.picks is not None:
        picks = np.zeros((2, policy.layers[-1].weight.shape[0]), np.float32)
        addends = np.zeros(2, np.float32)
        for row, (index, factor, addend) in enumerate(policy.picks):
            picks[row, index], addends[row] = factor, addend
        weights += [numpy_helper.from_array(picks, "picks"), numpy_helper.from_array(addends, "addends")]
        nodes.append(helper.make_node("Gemm", [at, "picks", "addends"], ["action"], transB=1))
    number = TensorProto.FLOAT
    graph = helper.make_graph(
        nodes,
        "policy",
        [helper.make_tensor_value_info("observation", number, [1, policy.inputs])],
        [helper.make_tensor_value_info("action", number, [1, policy.outputs])],
        weights,
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8, producer_name="squall")
    helper.set_model_props(model, dict(metadata))
    return bytes(model.SerializeToString())


# The command.


def kinds_of(size: int) -> list[tuple[str, int]]:
    """The kinds of observations of this size, with the number of other boats; those of equal teams first."""
    fits = [(kind, (size - own) // other) for kind, (own, other) in KINDS.items() if (size - own) % other == 0]
    return sorted((fit for fit in fits if fit[1] > 0), key=lambda fit: fit[1] % 2 == 0)


def _strategy(policy: Policy, model: str, kind: str, period_s: float) -> str:
    """The strategy file that plays the policy."""
    if policy.picks is not None:
        action = 'action = "continuous"'
    elif policy.outputs == 17:
        action = 'action = "pyquaticus"'
    else:
        action = (
            f"action = []   # the {policy.outputs} actions in order, each [fraction of the top speed, turn in degrees,"
            " clockwise]"
        )
    sampled = "" if policy.picks is not None else "sampled = true   # draws actions by their probabilities\n"
    return (
        'base = "policy"\n\n[behaviour.learned]\n'
        f"model = {json.dumps(model)}\n"
        f'observation = {{ kind = "{kind}" }}\n{action}\nperiod_s = {period_s:g}\n'
        f"direct = true   # no helm, as in Pyquaticus\n{sampled}"
    )


def main(arguments: list[str] | None = None) -> int:
    """Converts the file that the arguments name. Only the strategy goes to standard output."""
    parser = argparse.ArgumentParser(
        prog="python -m squall.convert",
        description="Converts a trained policy to ONNX, and prints the strategy file that plays it.",
        epilog=f"FILE is {SUPPORTED}. Code in it is never executed.",
    )
    parser.add_argument("file", metavar="FILE", type=Path)
    parser.add_argument("--out", metavar="FILE", type=Path, help="the ONNX file to write [default: FILE.onnx]")
    parser.add_argument("--activation", choices=ACTIVATIONS, help="activation of the hidden layers [default: as the file implies]")
    parser.add_argument("--observation", choices=KINDS, help="kind of observations [default: by their number]")
    parser.add_argument("--continuous", action="store_true", help="actions are a speed and a turn, from -1 to 1")
    parser.add_argument("--period-s", type=float, default=1.0, help="time between decisions, s [default: 1]")
    parser.add_argument("--key", help="table of weights to use, if the file has several")
    given = parser.parse_args(arguments)
    try:
        print(convert(given), end="")
    except (ConversionError, OSError, ImportError) as error:
        print(f"error: {given.file}: {error}", file=sys.stderr)
        return 1
    return 0


def convert(given: argparse.Namespace) -> str:
    """Converts a file. Returns the strategy file that plays it."""
    policy = policy_of(given.file, activation=given.activation, key=given.key, continuous=given.continuous)
    kinds = kinds_of(policy.inputs)
    kind = given.observation or next((kind for kind, _ in kinds), None)
    if kind is None or kind not in dict(kinds):
        allowed = ", ".join(f"{own} and {other} for each other boat ({k})" for k, (own, other) in KINDS.items())
        raise ConversionError(f"its observations have {policy.inputs} numbers, expected one of: {allowed}")

    def note(text: str) -> None:
        print(text, file=sys.stderr)

    note(f"{policy.trainer}: a policy of {len(policy.layers)} layers, with {policy.activation} between them")
    for layer in policy.layers:
        note(f"  {layer}")
    if policy.left_out:
        note(f"left out: {', '.join(policy.left_out)}")
    note(f"observations: {policy.inputs} numbers, {kind} with {dict(kinds)[kind]} other boats")
    note("actions: " + ("a turn and a speed" if policy.picks is not None else f"{policy.outputs}"))
    metadata = {"squall.observation": json.dumps({"kind": kind}), "squall.period_s": f"{given.period_s:g}"}
    if policy.picks is not None or policy.outputs == 17:
        metadata["squall.action"] = "pyquaticus" if policy.picks is None else "continuous"
    out = given.out or given.file.with_name(given.file.name.rstrip("/") + ".onnx")
    data = onnx_of(policy, metadata)
    out.write_bytes(data)
    note(f"wrote {out}, {len(data)} bytes; the strategy for it:")
    model = f"../policies/{out.name}" if out.parent.name == "policies" else out.name
    return _strategy(policy, model, kind, given.period_s)


if __name__ == "__main__":
    sys.exit(main())
