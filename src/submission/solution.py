"""A policy trained with Squall, as an entry for the Maritime Capture the Flag competition. It needs only numpy.

`policy.onnx` is the network, read and evaluated here. All boats of the team use it.
"""

import math
import os
import struct

import numpy as np

OBSERVATION = "@OBSERVATION@"  # the observation that the network was trained with
OUTPUT = "@OUTPUT@"  # the network's output that holds the action
CONTINUOUS = @CONTINUOUS@  # whether its action is a turn and a speed, rather than one of several
ACTIONS = None  # a table of its actions, each a fraction of the top speed and a turn in degrees
SAMPLED = @SAMPLED@  # whether actions are sampled from the network's probabilities
SPEED_MAX_M_S = 3.0  # of the competition's Surveyor
DIAGONAL_M = math.hypot(160.0, 80.0)  # of its field

# How many numbers describe the boat itself and each other boat, including `is_disabled`, which was added in 2026.
OWN, OTHER = 22, 9


class solution:
    def __init__(self):
        folder = os.path.dirname(os.path.abspath(__file__))
        with open(os.path.join(folder, "policy.onnx"), "rb") as file:
            self.network = Network(file.read())
        self.random = np.random.default_rng()

    def compute_action(self, agent_id, full_obs_normalized, full_obs, global_state):
        observation = observed(np.asarray(full_obs_normalized[agent_id], np.float32).ravel())
        output = self.network.evaluate(observation)[OUTPUT].ravel()
        if CONTINUOUS:
            turn, speed = np.clip(output[:2], -1.0, 1.0)
            return np.array([0.5 * (1.0 + speed) * SPEED_MAX_M_S, 180.0 * turn], np.float32)
        if output.size == 1:
            action = int(output[0])
        elif SAMPLED:
            action = int(self.random.choice(output.size, p=softmax(output.astype(np.float64), -1)))
        else:
            action = int(np.argmax(output))
        return action if ACTIONS is None else [ACTIONS[action][0] * SPEED_MAX_M_S, ACTIONS[action][1]]


def observed(numbers):
    """Converts an observation of the competition to that of the network."""
    disabled = np.zeros(numbers.size, bool)
    scores = np.zeros(numbers.size, bool)
    distance = np.zeros(numbers.size, bool)
    has_disabled = (numbers.size - OWN) % OTHER == 0
    own, other = (OWN, OTHER) if has_disabled else (OWN - 1, OTHER - 1)
    if has_disabled:
        disabled[19] = True
        disabled[own + other - 1 :: other] = True
    scores[own - 2 : own] = True
    distance[1:14:2] = True
    distance[own + 1 :: other] = True
    if OBSERVATION == "pyquaticus_2026":
        if not has_disabled:
            raise ValueError("the network needs is_disabled, which these observations do not have")
        return numbers
    if OBSERVATION == "pyquaticus":
        return numbers[~disabled]
    # The observations of 2023 have no scores. Their distances are relative to the diagonal plus 10 m, or, to the
    # scrimmage line, to half the field.
    most_m = np.full(numbers.size, DIAGONAL_M + 10.0)
    most_m[13] = 80.0
    scaled = ((numbers + 1.0) * (DIAGONAL_M / most_m) - 1.0).astype(np.float32)
    return np.where(distance, scaled, numbers)[~(disabled | scores)]


# The network: a reader of ONNX files (protocol buffers), and its operators.


def varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        value |= (byte & 0x7F) << shift
        at, shift = at + 1, shift + 7
        if byte < 0x80:
            return (value - (1 << 64) if value >> 63 else value), at


def fields(data):
    """The fields of a message, by number."""
    found, at = {}, 0
    while at < len(data):
        key, at = varint(data, at)
        if key & 7 == 0:
            value, at = varint(data, at)
        else:
            size = {1: 8, 5: 4}.get(key & 7)
            if size is None:
                size, at = varint(data, at)
            value = data[at : at + size]
            at += size
        found.setdefault(key >> 3, []).append(value)
    return found


def integers(values):
    """Repeated integers, packed or not."""
    found = []
    for value in values:
        at = 0
        if isinstance(value, int):
            found.append(value)
            continue
        while at < len(value):
            number, at = varint(value, at)
            found.append(number)
    return found


def tensor(data):
    message = fields(data)
    kind = message[2][0]
    shape = integers(message.get(1, []))
    types = {1: "<f4", 6: "<i4", 7: "<i8", 9: "?", 10: "<u2", 11: "<f8", 16: "<u2"}
    if 9 in message:
        values = np.frombuffer(b"".join(message[9]), types[kind])
    elif kind in (1, 11):
        values = np.frombuffer(b"".join(message.get(4 if kind == 1 else 10, [])), types[kind])
    else:
        values = np.array(integers(message.get(7 if kind == 7 else 5, []))).astype(types[kind])
    if kind == 10:
        values = values.view("<f2")
    elif kind == 16:
        values = (values.astype("<u4") << 16).view("<f4")
    return values.reshape(shape)


def attribute(data):
    message = fields(data)
    for number, read in (
        (2, lambda values: struct.unpack("<f", values[0])[0]),
        (3, lambda values: values[0]),
        (4, lambda values: values[0].decode()),
        (5, lambda values: tensor(values[0])),
        (7, lambda values: list(np.frombuffer(b"".join(values), "<f4"))),
        (8, integers),
    ):
        if number in message:
            return read(message[number])
    return 0


class Network:
    def __init__(self, data):
        model = fields(data)
        graph = fields(model[7][0])
        versions = [fields(data) for data in model[8]]
        version = next(fields[2][0] for fields in versions if fields.get(1, [b""])[0] in (b"", b"ai.onnx"))
        self.weights = {}
        for data in graph.get(5, []):
            self.weights[fields(data)[8][0].decode()] = tensor(data)
        self.input = next(
            name for name in (fields(data)[1][0].decode() for data in graph[11]) if name not in self.weights
        )
        self.nodes = []
        for node in map(fields, graph[1]):
            names = [[name.decode() for name in node.get(number, [])] for number in (1, 2)]
            attributes = {fields(data)[1][0].decode(): attribute(data) for data in node.get(5, [])}
            attributes["version"] = version
            self.nodes.append((OPERATORS[node[4][0].decode()], attributes, *names))

    def evaluate(self, observation):
        """All values of the network, by name, for one observation."""
        values = {**self.weights, "": None, self.input: observation.reshape(1, -1)}
        for operator, attributes, inputs, outputs in self.nodes:
            values[outputs[0]] = operator(attributes, *(values[name] for name in inputs))
        return values


def constant(a):
    if "value" in a:
        return a["value"]
    name = next(name for name in a if name.startswith("value_"))
    return np.array(a[name], np.int64 if "int" in name else np.float32)


def gemm(a, x, y, z=0.0):
    x = x.T if a.get("transA") else x
    y = y.T if a.get("transB") else y
    return (a.get("alpha", 1.0) * (x @ y) + a.get("beta", 1.0) * z).astype(x.dtype)


def softmax_of(a, x):
    if a["version"] >= 13:
        return softmax(x, a.get("axis", -1))
    return softmax(x.reshape(math.prod(x.shape[: a.get("axis", 1)]), -1), 1).reshape(x.shape)


def softmax(x, axis):
    powers = np.exp(x - x.max(axis, keepdims=True))
    return powers / powers.sum(axis, keepdims=True)


def layer_normalised(a, x, scale, bias=0.0):
    axes = tuple(range(a.get("axis", -1) % x.ndim, x.ndim))
    off = x - x.mean(axes, keepdims=True)
    return off / np.sqrt((off * off).mean(axes, keepdims=True) + a.get("epsilon", 1e-5)) * scale + bias


def batch_normalised(a, x, scale, bias, mean, variance):
    channels = (1, -1) + (1,) * (x.ndim - 2)
    scale, bias, mean, variance = (given.reshape(channels) for given in (scale, bias, mean, variance))
    return (x - mean) / np.sqrt(variance + a.get("epsilon", 1e-5)) * scale + bias


def clipped(a, x, low=None, high=None):
    low = a.get("min", -np.inf) if low is None else low
    high = a.get("max", np.inf) if high is None else high
    return np.clip(x, low, high).astype(x.dtype)


def reshaped(a, x, shape):
    return x.reshape([x.shape[i] if n == 0 and not a.get("allowzero") else int(n) for i, n in enumerate(shape)])


def sliced(a, x, starts=None, ends=None, axes=None, steps=None):
    at = [slice(None)] * x.ndim
    starts, ends = (a["starts"], a["ends"]) if starts is None else (starts, ends)
    axes = a.get("axes", range(len(starts))) if axes is None else axes
    for i, axis in enumerate(axes):
        at[axis] = slice(int(starts[i]), int(ends[i]), None if steps is None else int(steps[i]))
    return x[tuple(at)]


def axes_of(a, axes):
    given = a.get("axes") if axes is None else axes
    return None if given is None else tuple(int(axis) for axis in given)


def unsqueezed(a, x, axes=None):
    return np.expand_dims(x, axes_of(a, axes))


def reduced(function):
    return lambda a, x, axes=None: function(x, axes_of(a, axes), keepdims=bool(a.get("keepdims", 1)))


def arg_max(a, x):
    index = np.argmax(x, a.get("axis", 0))
    return np.expand_dims(index, a.get("axis", 0)) if a.get("keepdims", 1) else index


def erf(x):
    return np.vectorize(math.erf, otypes=[x.dtype])(x)


def gelu(a, x):
    if a.get("approximate") == "tanh":
        return 0.5 * x * (1.0 + np.tanh(math.sqrt(2.0 / math.pi) * (x + 0.044715 * x**3)))
    return 0.5 * x * (1.0 + erf(x / np.float32(math.sqrt(2.0))))


def softplus(x):
    return np.logaddexp(x, np.zeros_like(x))


def sigmoid(x):
    return 1.0 / (1.0 + np.exp(-np.clip(x, -80.0, 80.0)))


def log_sum_exp(x, axes, keepdims):
    most = x.max(axes, keepdims=True)
    return np.log(np.exp(x - most).sum(axes, keepdims=keepdims)) + (most if keepdims else most.max(axes))


def celu_below(alpha, x):
    return np.minimum(alpha * np.expm1(np.minimum(x, 0) / alpha), 0)


def selu(a, x):
    alpha, gamma = a.get("alpha", 1.67326319), a.get("gamma", 1.05070102)
    return (gamma * np.where(x > 0, x, alpha * np.expm1(np.minimum(x, 0)))).astype(x.dtype)


TYPES = {1: np.float32, 6: np.int32, 7: np.int64, 9: bool, 10: np.float16, 11: np.float64}
OPERATORS = {
    "Abs": lambda a, x: np.abs(x),
    "Add": lambda a, x, y: x + y,
    "ArgMax": arg_max,
    "BatchNormalization": batch_normalised,
    "Cast": lambda a, x: x.astype(TYPES[a["to"]]),
    "Celu": lambda a, x: (np.maximum(x, 0) + celu_below(a.get("alpha", 1.0), x)).astype(x.dtype),
    "Clip": clipped,
    "Concat": lambda a, *xs: np.concatenate(xs, a["axis"]),
    "Constant": constant,
    "ConstantOfShape": lambda a, shape: np.full(shape, a["value"][0] if "value" in a else np.float32(0)),
    "Div": lambda a, x, y: x / y,
    "Dropout": lambda a, x, *_: x,
    "Elu": lambda a, x: np.where(x > 0, x, a.get("alpha", 1.0) * np.expm1(np.minimum(x, 0))).astype(x.dtype),
    "Equal": lambda a, x, y: x == y,
    "Erf": lambda a, x: erf(x),
    "Exp": lambda a, x: np.exp(x),
    "Expand": lambda a, x, shape: x * np.ones(shape, x.dtype),
    "Flatten": lambda a, x: x.reshape(math.prod(x.shape[: a.get("axis", 1)]), -1),
    "Gather": lambda a, x, at: np.take(x, at, a.get("axis", 0)),
    "GatherElements": lambda a, x, at: np.take_along_axis(x, at, a.get("axis", 0)),
    "Gelu": gelu,
    "Gemm": gemm,
    "HardSigmoid": lambda a, x: np.clip(a.get("alpha", 0.2) * x + a.get("beta", 0.5), 0, 1).astype(x.dtype),
    "HardSwish": lambda a, x: x * np.clip(x / 6 + 0.5, 0, 1),
    "Identity": lambda a, x: x,
    "LayerNormalization": layer_normalised,
    "LeakyRelu": lambda a, x: np.where(x < 0, a.get("alpha", 0.01) * x, x).astype(x.dtype),
    "Log": lambda a, x: np.log(x),
    "LogSoftmax": lambda a, x: np.log(softmax_of(a, x)),
    "MatMul": lambda a, x, y: x @ y,
    "Max": lambda a, *xs: np.maximum.reduce(np.broadcast_arrays(*xs)),
    "Min": lambda a, *xs: np.minimum.reduce(np.broadcast_arrays(*xs)),
    "Mish": lambda a, x: x * np.tanh(softplus(x)),
    "Mul": lambda a, x, y: x * y,
    "Neg": lambda a, x: -x,
    "PRelu": lambda a, x, slope: np.where(x < 0, slope * x, x),
    "Pow": lambda a, x, y: np.power(x, y).astype(x.dtype),
    "Reciprocal": lambda a, x: 1 / x,
    "ReduceL2": reduced(lambda x, axes, keepdims: np.sqrt((x * x).sum(axes, keepdims=keepdims))),
    "ReduceLogSumExp": reduced(log_sum_exp),
    "ReduceMax": reduced(np.max),
    "ReduceMean": reduced(np.mean),
    "ReduceMin": reduced(np.min),
    "ReduceSum": reduced(np.sum),
    "Relu": lambda a, x: np.maximum(x, 0),
    "Reshape": reshaped,
    "Selu": selu,
    "Shape": lambda a, x: np.array(x.shape[a.get("start", 0) : a.get("end")], np.int64),
    "Sigmoid": lambda a, x: sigmoid(x),
    "Slice": sliced,
    "Softmax": softmax_of,
    "Softplus": lambda a, x: softplus(x),
    "Softsign": lambda a, x: x / (1 + np.abs(x)),
    "Sqrt": lambda a, x: np.sqrt(x),
    "Squeeze": lambda a, x, axes=None: np.squeeze(x, axes_of(a, axes)),
    "Sub": lambda a, x, y: x - y,
    "Swish": lambda a, x: x * sigmoid(a.get("alpha", 1.0) * x),
    "Tanh": lambda a, x: np.tanh(x),
    "Transpose": lambda a, x: np.transpose(x, a.get("perm")),
    "Unsqueeze": unsqueezed,
    "Where": lambda a, is_first, x, y: np.where(is_first, x, y),
}
