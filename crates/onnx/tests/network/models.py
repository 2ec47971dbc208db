#!/usr/bin/env python3
"""Creates the models in this folder that need no trainer, and the expected outputs of all, with ONNX Runtime.

    python -m venv venv && venv/bin/pip install onnx==1.23.2 onnxruntime==1.32.0 numpy
    venv/bin/python models.py

`sb3_torchscript.onnx` and `sb3_dynamo.onnx` are the logits of one policy: PPO of Stable-Baselines3 2.9.2 with layers of 48, from
both exporters of PyTorch 2.15 (`dynamo=False`; `dynamo=True, external_data=False`), without their notes about source lines.
`sb3_full.onnx` is a whole policy of PPO as Stable-Baselines3 describes its export: action, value and log probability.
"""

import json
import pathlib

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

HERE = pathlib.Path(__file__).parent
ROWS = 4
numbers = np.random.default_rng(7)


def normal(*shape):
    return numbers.standard_normal(shape).astype(np.float32)


def integers(*values):
    return np.array(values, dtype=np.int64)


class Graph:
    """Nodes and constants. With `shape`, each node's output is an output of the model."""

    def __init__(self):
        self.nodes, self.constants, self.outputs = [], [], []

    def constant(self, name, array, listed=False):
        if listed:
            tensor = helper.make_tensor(name, helper.np_dtype_to_tensor_dtype(array.dtype), array.shape, array.flatten())
        else:
            tensor = numpy_helper.from_array(array, name)
        self.constants.append(tensor)
        return name

    def node(self, operator, inputs, output, shape=None, kind=TensorProto.FLOAT, **attributes):
        self.nodes.append(helper.make_node(operator, inputs, [output], output, **attributes))
        if shape is not None:
            self.outputs.append(helper.make_tensor_value_info(output, kind, shape))
        return output

    def write(self, name, inputs, version, ir_version, constants_are_inputs=False):
        ports = [helper.make_tensor_value_info(port, TensorProto.FLOAT, shape) for port, shape in inputs]
        if constants_are_inputs:
            ports += [helper.make_tensor_value_info(c.name, c.data_type, c.dims) for c in self.constants]
        graph = helper.make_graph(self.nodes, name, ports, self.outputs, self.constants)
        sets = [helper.make_opsetid("", version)]
        model = helper.make_model(graph, opset_imports=sets, ir_version=ir_version)
        helper.set_model_props(model, {"layout": "test", "made by": "models.py"})
        onnx.checker.check_model(model, full_check=True)
        onnx.save(model, HERE / f"{name}.onnx")


def operators():
    graph = Graph()
    node, constant = graph.node, graph.constant
    x, row = "x", ["batch", 6]
    weights, bias = constant("weights", normal(6, 5)), constant("bias", normal(5))
    node("Gemm", [x, weights, bias], "gemm", ["batch", 5])
    node("Gemm", [x, constant("weights_t", normal(5, 6)), constant("bias_one", normal(1))], "gemm_factors", ["batch", 5],
         alpha=0.5, beta=2.0, transB=1)
    node("Gemm", [x, constant("wide", normal(6, 37))], "gemm_no_bias", ["batch", 37])
    node("MatMul", [x, weights], "mat_mul", ["batch", 5])
    node("Add", [x, constant("row", normal(6))], "add", row)
    node("Sub", [constant("one", np.float32(1.5).reshape(())), x], "sub", row)
    node("Mul", [x, x], "mul", row)
    node("Div", [x, constant("divisor", np.float32(0.3).reshape(1))], "div", row)
    for operator in ["Tanh", "Relu", "Sigmoid", "Elu", "LeakyRelu", "Neg", "Softmax", "LogSoftmax", "Identity"]:
        node(operator, [x], operator.lower(), row)
    node("Elu", [x], "elu_alpha", row, alpha=0.3)
    node("LeakyRelu", [x], "leaky_alpha", row, alpha=0.2)
    low, high = constant("low", np.float32(-0.5).reshape(())), constant("high", np.float32(0.7).reshape(()))
    node("Clip", [x, low, high], "clip", row)
    node("Clip", [x, "", high], "clip_above", row)
    node("Clip", [x, low], "clip_below", row)
    node("ArgMax", [x], "arg_max", ["batch", 1], TensorProto.INT64, axis=1)
    node("ArgMax", ["relu"], "arg_max_last", ["batch"], TensorProto.INT64, axis=-1, keepdims=0, select_last_index=1)
    node("Constant", [], "shape", value_ints=[0, 2, -1])
    node("Reshape", [x, "shape"], "reshape", ["batch", 2, 3])
    node("MatMul", ["reshape", constant("of_three", normal(3, 4))], "mat_mul_rows", ["batch", 2, 4])
    node("Add", ["mat_mul_rows", constant("of_rows", normal(4))], "add_rows", ["batch", 2, 4])
    node("Softmax", ["reshape"], "softmax_rows", ["batch", 2, 3])
    node("Flatten", ["reshape"], "flatten", row)
    node("Unsqueeze", [x, constant("axes", integers(1, -1))], "unsqueeze", ["batch", 1, 6, 1])
    node("Squeeze", ["unsqueeze", constant("last", integers(-1))], "squeeze", ["batch", 1, 6])
    node("Concat", [x, "gemm", x], "concat", ["batch", 17], axis=-1)
    node("Concat", ["reshape", "mat_mul_rows"], "concat_rows", ["batch", 2, 7], axis=2)
    node("Slice", [x, constant("from", integers(-4)), constant("to", integers(2**62)), constant("axis", integers(1))],
         "slice", ["batch", 4])
    node("Slice", [x, constant("zero", integers(0)), constant("six", integers(6)), "axis", constant("two", integers(2))],
         "slice_step", ["batch", 3])
    node("Slice", ["reshape", constant("ones", integers(0, 1)), constant("ends", integers(2, 3)),
                   constant("both", integers(1, 2))], "slice_rows", ["batch", 2, 2])
    node("Constant", [], "whole", value_int=3)
    node("Cast", ["whole"], "three", to=TensorProto.FLOAT)
    node("Constant", [], "floats", value_floats=[1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    node("Mul", ["floats", "three"], "products")
    node("Add", [x, "products"], "cast", row)
    node("Constant", [], "tensor", value=numpy_helper.from_array(normal(1, 6)))
    node("Mul", [x, "tensor"], "constant", row)
    graph.write("operators", [(x, row)], 17, 8)


def old_operators():
    """A model of version 9: bounds and axes are attributes, weights are among the inputs, and numbers are not raw data."""
    graph = Graph()
    node, constant = graph.node, graph.constant
    weights, bias = constant("weights", normal(4, 6), listed=True), constant("bias", normal(4), listed=True)
    node("Gemm", ["x", weights, bias], "gemm", [1, 4], transB=1)
    node("Slice", ["x"], "slice", [1, 3], axes=[1], starts=[1], ends=[-2])
    node("Clip", ["x"], "clip", [1, 6], min=-0.4, max=0.4)
    shape = constant("shape", integers(1, 3, 2), listed=True)
    node("Reshape", ["x", shape], "reshape", [1, 3, 2])
    node("Softmax", ["reshape"], "softmax", [1, 3, 2])
    node("Unsqueeze", ["x"], "unsqueeze", [1, 1, 6], axes=[0])
    node("Squeeze", ["unsqueeze"], "squeeze", [1, 6], axes=[1])
    node("Cast", [constant("doubles", numbers.standard_normal(6), listed=True)], "floats", to=TensorProto.FLOAT)
    node("Add", ["x", "floats"], "cast", [1, 6])
    graph.write("old_operators", [("x", [1, 6])], 9, 3, constants_are_inputs=True)


def two_inputs():
    graph = Graph()
    node, constant = graph.node, graph.constant
    node("MatMul", ["boats", constant("of_boat", normal(4, 8))], "each")
    node("Tanh", ["each"], "encoded")
    node("Flatten", ["encoded"], "row")
    node("Concat", ["own", "row"], "all", axis=1)
    node("Gemm", ["all", constant("weights", normal(29, 7)), constant("bias", normal(7))], "logits", ["batch", 7])
    node("Gemm", ["all", constant("of_value", normal(29, 1)), constant("one", normal(1))], "value", ["batch", 1])
    graph.write("two_inputs", [("own", ["batch", 5]), ("boats", ["batch", 3, 4])], 21, 10)


def activations():
    graph = Graph()
    node, constant = graph.node, graph.constant
    row = ["batch", 6]
    for operator in ["Abs", "Celu", "Erf", "Exp", "Gelu", "HardSigmoid", "HardSwish", "Mish", "Selu", "Softplus", "Softsign", "Swish"]:
        node(operator, ["x"], operator.lower(), row)
    node("Gelu", ["x"], "gelu_tanh", row, approximate="tanh")
    node("HardSigmoid", ["x"], "hard_sigmoid_factors", row, alpha=0.3, beta=0.4)
    node("Celu", ["x"], "celu_alpha", row, alpha=0.4)
    node("Swish", ["x"], "swish_alpha", row, alpha=1.5)
    node("PRelu", ["x", constant("slope", normal(6))], "p_relu", row)
    node("Sqrt", ["abs"], "sqrt", row)
    node("Log", ["exp"], "log", row)
    node("Reciprocal", ["exp"], "reciprocal", row)
    node("Pow", ["abs", constant("exponent", np.float32(1.7).reshape(()))], "pow", row)
    node("Pow", ["x", constant("two", np.float32(2).reshape(()))], "square", row)
    node("Max", ["x", constant("floor", normal(6)), "erf"], "max", row)
    node("Min", ["x", "floor"], "min", row)
    low, high = constant("low", np.float32(-np.inf).reshape(())), constant("high", np.float32(np.inf).reshape(()))
    node("Clip", ["x", low, high], "clip", row)
    graph.write("activations", [("x", row)], 24, 11)


def normalisations():
    """Normalisation layers, reductions, and the nodes that exporters add around them."""
    graph = Graph()
    node, constant = graph.node, graph.constant
    row = ["batch", 6]
    scale, bias = constant("scale", normal(6)), constant("bias", normal(6))
    node("LayerNormalization", ["x", scale, bias], "layer", row, epsilon=1e-4)
    node("LayerNormalization", ["x", scale], "layer_no_bias", row)
    mean, variance = constant("mean", normal(6)), constant("variance", np.abs(normal(6)))
    node("BatchNormalization", ["x", scale, bias, mean, variance], "batch_norm", row)
    node("Reshape", ["x", constant("two_rows", integers(0, 2, 3))], "rows")
    pair = [constant(f"pair_{i}", np.abs(normal(2))) for i in range(4)]
    node("BatchNormalization", ["rows", *pair], "batch_norm_rows", ["batch", 2, 3])
    node("LayerNormalization", ["rows", constant("scale_rows", normal(2, 3))], "layer_rows", ["batch", 2, 3], axis=1)
    node("Dropout", ["x"], "dropout", row)
    last, middle = constant("last", integers(-1)), constant("middle", integers(1))
    for operator in ["ReduceMean", "ReduceSum", "ReduceMax", "ReduceMin", "ReduceL2", "ReduceLogSumExp"]:
        node(operator, ["rows", last], operator.lower(), ["batch", 2, 1])
        node(operator, ["rows", middle], f"{operator.lower()}_middle", ["batch", 3], keepdims=0)
    # Layer normalisation as exported before it was an operator, by rows.
    node("Sub", ["rows", "reducemean"], "centred")
    node("Mul", ["centred", "centred"], "squares")
    node("ReduceMean", ["squares", last], "spread")
    node("Add", ["spread", constant("epsilon", np.float32(1e-5).reshape(()))], "positive")
    node("Sqrt", ["positive"], "deviation")
    node("Div", ["centred", "deviation"], "layer_by_hand", ["batch", 2, 3])
    node("Transpose", ["rows"], "transposed", [3, 2, "batch"])
    node("Transpose", ["rows"], "transposed_rows", ["batch", 3, 2], perm=[0, 2, 1])
    node("Transpose", [constant("weights", normal(4, 6))], "weights_t")
    node("MatMul", ["x", "weights_t"], "linear", ["batch", 4])
    node("Exp", [constant("factor_log", normal(6, 4))], "factor")
    node("Mul", ["weights_t", "factor"], "weights_scaled")
    node("MatMul", ["x", "weights_scaled"], "linear_scaled", ["batch", 4])
    node("Gather", ["x", constant("columns", integers(4, -6, 4))], "gather", ["batch", 3], axis=1)
    node("Slice", ["x", constant("from", integers(5)), constant("to", integers(-7)), middle, constant("back", integers(-2))],
         "slice_back", ["batch", 3])
    # The most likely action and its logarithm, as Stable-Baselines3 exports them.
    node("ReduceLogSumExp", ["x", last], "sum")
    node("Sub", ["x", "sum"], "logs")
    node("ArgMax", ["logs"], "action", ["batch"], TensorProto.INT64, axis=1, keepdims=0)
    node("Unsqueeze", ["action", last], "actions")
    node("GatherElements", ["logs", "actions"], "log_of_action", ["batch", 1], axis=1)
    # A view of dynamic size.
    node("Shape", ["x"], "dims")
    node("Gather", ["dims", constant("first", integers(0).reshape(()))], "rows_count", axis=0)
    node("Unsqueeze", ["rows_count", constant("front", integers(0))], "rows_counts")
    node("Concat", ["rows_counts", constant("rest", integers(3, -1))], "view", axis=0)
    node("Reshape", ["x", "view"], "viewed", ["batch", 3, 2])
    node("Concat", ["rows_counts", constant("six", integers(6))], "whole", axis=0)
    node("Expand", [constant("deviation_log", normal(6)), "whole"], "expanded", row)
    node("ConstantOfShape", ["whole"], "zeros", row)
    graph.write("normalisations", [("x", row)], 18, 8)


def wide_numbers():
    """Inputs, weights and outputs that are not in single precision."""
    graph = Graph()
    node, constant = graph.node, graph.constant
    # Products in half precision differ between runtimes, so only the weights are.
    node("Cast", [constant("halves", normal(6, 4).astype(np.float16))], "weights", to=TensorProto.FLOAT)
    node("MatMul", ["x", "weights"], "half_weights", ["batch", 4])
    listed = constant("halves_listed", normal(6).astype(np.float16), listed=True)
    node("Cast", [listed], "listed", to=TensorProto.FLOAT)
    node("Add", ["x", "listed"], "half_listed", ["batch", 6])
    node("Cast", ["x"], "double", to=TensorProto.DOUBLE)
    node("MatMul", ["double", constant("doubles", numbers.standard_normal((6, 4)))], "double_precision", ["batch", 4],
         TensorProto.DOUBLE)
    node("Cast", ["x"], "whole", ["batch", 6], TensorProto.INT64, to=TensorProto.INT64)
    graph.write("wide_numbers", [("x", ["batch", 6])], 17, 8)


def run(name):
    """Writes rows of inputs, with the outputs of ONNX Runtime."""
    session = onnxruntime.InferenceSession(HERE / f"{name}.onnx", providers=["CPUExecutionProvider"])
    cases = []
    for i in range(ROWS):
        fed = {p.name: normal(*[d if isinstance(d, int) else 1 for d in p.shape]) * (i + 1) for p in session.get_inputs()}
        results = session.run(None, fed)
        outputs = {p.name: r.flatten().tolist() for p, r in zip(session.get_outputs(), results)}
        cases.append({"input": np.concatenate([a.flatten() for a in fed.values()]).tolist(), "outputs": outputs})
    lines = ",\n".join(json.dumps(case) for case in cases)
    (HERE / f"{name}.json").write_text(f"[\n{lines}\n]\n")


if __name__ == "__main__":
    operators()
    old_operators()
    two_inputs()
    for model in ["operators", "old_operators", "two_inputs", "sb3_torchscript", "sb3_dynamo"]:
        run(model)
    # The first models keep their numbers when others are added.
    activations()
    normalisations()
    wide_numbers()
    for model in ["activations", "normalisations", "wide_numbers", "sb3_full"]:
        run(model)
