//! The supported ONNX operators and the functions that plan them.

use super::NetworkError;
use super::arrangement;
use super::elementwise::{self, Function, Operation};
use super::linear;
use super::node::Node;
use super::plan::{Planner, Value};
use super::row;
use std::ops::RangeInclusive;

pub(super) struct Operator {
    pub(super) name: &'static str,
    /// Attributes that are supported or have no effect here.
    pub(super) attributes: &'static [&'static str],
    pub(super) inputs: RangeInclusive<usize>,
    pub(super) plan: fn(&mut Planner, &Node) -> Result<Value, NetworkError>,
}

/// All supported operators, by name; defined at <https://onnx.ai/onnx/operators/>.
pub(super) const OPERATORS: [Operator; 25] = [
    operator("Add", &[], 2..=2, |planner, node| elementwise::binary(planner, node, Operation::Add)),
    operator("ArgMax", &["axis", "keepdims", "select_last_index"], 1..=1, row::arg_max),
    operator("Cast", &["to", "saturate", "round_mode"], 1..=1, arrangement::cast),
    operator("Clip", &["min", "max"], 1..=3, elementwise::clip),
    operator("Concat", &["axis"], 1..=1024, arrangement::concat),
    operator(
        "Constant",
        &["value", "value_float", "value_floats", "value_int", "value_ints"],
        0..=0,
        arrangement::constant,
    ),
    operator("Div", &[], 2..=2, |planner, node| elementwise::binary(planner, node, Operation::Divide)),
    operator("Elu", &["alpha"], 1..=1, |planner, node| {
        elementwise::function(planner, node, Function::Elu { alpha: node.float("alpha", 1.0)? })
    }),
    operator("Flatten", &["axis"], 1..=1, arrangement::flatten),
    operator("Gemm", &["alpha", "beta", "transA", "transB"], 2..=3, linear::gemm),
    operator("Identity", &[], 1..=1, |planner, node| planner.value(node, 0)),
    operator("LeakyRelu", &["alpha"], 1..=1, |planner, node| {
        elementwise::function(planner, node, Function::LeakyRelu { alpha: node.float("alpha", 0.01)? })
    }),
    operator("LogSoftmax", &["axis"], 1..=1, |planner, node| row::softmax(planner, node, row::Scale::Logarithmic)),
    operator("MatMul", &[], 2..=2, linear::mat_mul),
    operator("Mul", &[], 2..=2, |planner, node| elementwise::binary(planner, node, Operation::Multiply)),
    operator("Neg", &[], 1..=1, |planner, node| elementwise::function(planner, node, Function::Negative)),
    operator("Relu", &[], 1..=1, |planner, node| elementwise::function(planner, node, Function::Relu)),
    operator("Reshape", &["allowzero"], 2..=2, arrangement::reshape),
    operator("Sigmoid", &[], 1..=1, |planner, node| elementwise::function(planner, node, Function::Sigmoid)),
    operator("Slice", &["axes", "starts", "ends"], 1..=5, arrangement::slice),
    operator("Softmax", &["axis"], 1..=1, |planner, node| row::softmax(planner, node, row::Scale::Linear)),
    operator("Squeeze", &["axes"], 1..=2, arrangement::squeeze),
    operator("Sub", &[], 2..=2, |planner, node| elementwise::binary(planner, node, Operation::Subtract)),
    operator("Tanh", &[], 1..=1, |planner, node| elementwise::function(planner, node, Function::Tanh)),
    operator("Unsqueeze", &["axes"], 1..=2, arrangement::unsqueeze),
];

const fn operator(
    name: &'static str,
    attributes: &'static [&'static str],
    inputs: RangeInclusive<usize>,
    plan: fn(&mut Planner, &Node) -> Result<Value, NetworkError>,
) -> Operator {
    Operator { name, attributes, inputs, plan }
}
