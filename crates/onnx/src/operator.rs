//! The supported ONNX operators and the functions that plan them.

use super::NetworkError;
use super::arrangement;
use super::elementwise::{self, Function, Operation, binary, function};
use super::linear;
use super::node::Node;
use super::normalisation;
use super::plan::{Planner, Value};
use super::row::{self, Reduction};
use std::ops::RangeInclusive;

pub(super) struct Operator {
    pub(super) name: &'static str,
    /// Attributes that are supported or do not affect the result.
    pub(super) attributes: &'static [&'static str],
    pub(super) inputs: RangeInclusive<usize>,
    pub(super) plan: fn(&mut Planner, &Node) -> Result<Value, NetworkError>,
}

/// All supported operators, by name; defined at <https://onnx.ai/onnx/operators/>.
pub(super) const OPERATORS: &[Operator] = &[
    operator("Abs", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Absolute)
    }),
    operator("Add", &[], 2..=2, |planner, node| {
        binary(planner, node, Operation::Add)
    }),
    operator(
        "ArgMax",
        &["axis", "keepdims", "select_last_index"],
        1..=1,
        row::arg_max,
    ),
    operator(
        "BatchNormalization",
        &["epsilon", "momentum", "spatial", "training_mode"],
        5..=5,
        normalisation::batch,
    ),
    operator(
        "Cast",
        &["to", "saturate", "round_mode"],
        1..=1,
        arrangement::cast,
    ),
    operator("Celu", &["alpha"], 1..=1, |planner, node| {
        function(
            planner,
            node,
            Function::Celu {
                alpha: node.float("alpha", 1.0)?,
            },
        )
    }),
    operator("Clip", &["min", "max"], 1..=3, elementwise::clip),
    operator("Concat", &["axis"], 1..=1024, arrangement::concat),
    operator(
        "Constant",
        &[
            "value",
            "value_float",
            "value_floats",
            "value_int",
            "value_ints",
        ],
        0..=0,
        arrangement::constant,
    ),
    operator(
        "ConstantOfShape",
        &["value"],
        1..=1,
        arrangement::constant_of_shape,
    ),
    operator("Div", &[], 2..=2, |planner, node| {
        binary(planner, node, Operation::Divide)
    }),
    operator("Dropout", &["ratio", "seed"], 1..=3, normalisation::dropout),
    operator("Elu", &["alpha"], 1..=1, |planner, node| {
        function(
            planner,
            node,
            Function::Elu {
                alpha: node.float("alpha", 1.0)?,
            },
        )
    }),
    operator("Equal", &[], 2..=2, |planner, node| {
        binary(planner, node, Operation::Equal)
    }),
    operator("Erf", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Erf)
    }),
    operator("Exp", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Exp)
    }),
    operator("Expand", &[], 2..=2, arrangement::expand),
    operator("Flatten", &["axis"], 1..=1, arrangement::flatten),
    operator("Gather", &["axis"], 2..=2, arrangement::gather),
    operator("GatherElements", &["axis"], 2..=2, row::gather_elements),
    operator("Gelu", &["approximate"], 1..=1, elementwise::gelu),
    operator(
        "Gemm",
        &["alpha", "beta", "transA", "transB"],
        2..=3,
        linear::gemm,
    ),
    operator("HardSigmoid", &["alpha", "beta"], 1..=1, |planner, node| {
        let alpha = node.float("alpha", 0.2)?;
        let beta = node.float("beta", 0.5)?;
        function(planner, node, Function::HardSigmoid { alpha, beta })
    }),
    operator("HardSwish", &[], 1..=1, |planner, node| {
        function(planner, node, Function::HardSwish)
    }),
    operator("Identity", &[], 1..=1, |planner, node| {
        planner.value(node, 0)
    }),
    operator(
        "LayerNormalization",
        &["axis", "epsilon", "stash_type"],
        2..=3,
        normalisation::layer,
    ),
    operator("LeakyRelu", &["alpha"], 1..=1, |planner, node| {
        function(
            planner,
            node,
            Function::LeakyRelu {
                alpha: node.float("alpha", 0.01)?,
            },
        )
    }),
    operator("Log", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Logarithm)
    }),
    operator("LogSoftmax", &["axis"], 1..=1, |planner, node| {
        row::softmax(planner, node, row::Scale::Logarithmic)
    }),
    operator("MatMul", &[], 2..=2, linear::mat_mul),
    operator("Max", &[], 1..=1024, |planner, node| {
        binary(planner, node, Operation::Greatest)
    }),
    operator("Min", &[], 1..=1024, |planner, node| {
        binary(planner, node, Operation::Least)
    }),
    operator("Mish", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Mish)
    }),
    operator("Mul", &[], 2..=2, |planner, node| {
        binary(planner, node, Operation::Multiply)
    }),
    operator("Neg", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Negative)
    }),
    operator("PRelu", &[], 2..=2, |planner, node| {
        binary(planner, node, Operation::Slope)
    }),
    operator("Pow", &[], 2..=2, |planner, node| {
        binary(planner, node, Operation::Power)
    }),
    operator("Reciprocal", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Reciprocal)
    }),
    operator("ReduceL2", REDUCE, 1..=2, |planner, node| {
        row::reduce(planner, node, Reduction::Length)
    }),
    operator("ReduceLogSumExp", REDUCE, 1..=2, |planner, node| {
        row::reduce(planner, node, Reduction::LogSumExp)
    }),
    operator("ReduceMax", REDUCE, 1..=2, |planner, node| {
        row::reduce(planner, node, Reduction::Greatest)
    }),
    operator("ReduceMean", REDUCE, 1..=2, |planner, node| {
        row::reduce(planner, node, Reduction::Mean)
    }),
    operator("ReduceMin", REDUCE, 1..=2, |planner, node| {
        row::reduce(planner, node, Reduction::Least)
    }),
    operator("ReduceSum", REDUCE, 1..=2, |planner, node| {
        row::reduce(planner, node, Reduction::Sum)
    }),
    operator("Relu", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Relu)
    }),
    operator("Reshape", &["allowzero"], 2..=2, arrangement::reshape),
    operator("Selu", &["alpha", "gamma"], 1..=1, |planner, node| {
        let alpha = node.float("alpha", 1.673_263_2)?;
        let gamma = node.float("gamma", 1.050_701)?;
        function(planner, node, Function::Selu { alpha, gamma })
    }),
    operator("Shape", &["start", "end"], 1..=1, arrangement::shape),
    operator("Sigmoid", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Sigmoid)
    }),
    operator(
        "Slice",
        &["axes", "starts", "ends"],
        1..=5,
        arrangement::slice,
    ),
    operator("Softmax", &["axis"], 1..=1, |planner, node| {
        row::softmax(planner, node, row::Scale::Linear)
    }),
    operator("Softplus", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Softplus)
    }),
    operator("Softsign", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Softsign)
    }),
    operator("Sqrt", &[], 1..=1, |planner, node| {
        function(planner, node, Function::SquareRoot)
    }),
    operator("Squeeze", &["axes"], 1..=2, arrangement::squeeze),
    operator("Sub", &[], 2..=2, |planner, node| {
        binary(planner, node, Operation::Subtract)
    }),
    operator("Swish", &["alpha"], 1..=1, |planner, node| {
        function(
            planner,
            node,
            Function::Swish {
                alpha: node.float("alpha", 1.0)?,
            },
        )
    }),
    operator("Tanh", &[], 1..=1, |planner, node| {
        function(planner, node, Function::Tanh)
    }),
    operator("Transpose", &["perm"], 1..=1, arrangement::transpose),
    operator("Unsqueeze", &["axes"], 1..=2, arrangement::unsqueeze),
    operator("Where", &[], 3..=3, elementwise::choose),
];

/// The attributes of the `Reduce…` operators.
const REDUCE: &[&str] = &["axes", "keepdims", "noop_with_empty_axes"];

const fn operator(
    name: &'static str,
    attributes: &'static [&'static str],
    inputs: RangeInclusive<usize>,
    plan: fn(&mut Planner, &Node) -> Result<Value, NetworkError>,
) -> Operator {
    Operator {
        name,
        attributes,
        inputs,
        plan,
    }
}
