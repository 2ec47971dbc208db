//! Elementwise operators on one or two inputs.

use super::NetworkError;
use super::activation;
use super::error::shape_text;
use super::node::Node;
use super::plan::{Planner, Row, Value};
use super::step::Work;

/// A function of one number. NaN in gives NaN out.
#[derive(Clone, Copy)]
pub(super) enum Function {
    Clip { min: f32, max: f32 },
    Elu { alpha: f32 },
    LeakyRelu { alpha: f32 },
    Negative,
    Relu,
    Sigmoid,
    Tanh,
}

impl Function {
    pub(super) fn apply(self, input: &[f32], output: &mut [f32]) {
        match self {
            Function::Clip { min, max } => each(input, output, |x| {
                let above = if x < min { min } else { x };
                if above > max { max } else { above }
            }),
            Function::Elu { alpha } => {
                each(input, output, |x| if x < 0.0 { alpha * (libm::expf(x) - 1.0) } else { x });
            }
            Function::LeakyRelu { alpha } => each(input, output, |x| if x < 0.0 { alpha * x } else { x }),
            Function::Negative => each(input, output, |x| -x),
            Function::Relu => each(input, output, |x| if x < 0.0 { 0.0 } else { x }),
            Function::Sigmoid => each(input, output, activation::sigmoid),
            Function::Tanh => each(input, output, activation::tanh),
        }
    }
}

fn each(input: &[f32], output: &mut [f32], function: impl Fn(f32) -> f32) {
    for (to, from) in output.iter_mut().zip(input) {
        *to = function(*from);
    }
}

/// A function of two numbers.
#[derive(Clone, Copy)]
pub(super) enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
}

impl Operation {
    /// A shorter operand is repeated.
    pub(super) fn apply(self, left: &[f32], right: &[f32], output: &mut [f32]) {
        match self {
            Operation::Add => pairs(left, right, output, |a, b| a + b),
            Operation::Subtract => pairs(left, right, output, |a, b| a - b),
            Operation::Multiply => pairs(left, right, output, |a, b| a * b),
            Operation::Divide => pairs(left, right, output, |a, b| a / b),
        }
    }
}

fn pairs(left: &[f32], right: &[f32], output: &mut [f32], operation: impl Fn(f32, f32) -> f32) {
    // No modulo (`cycle`) if neither operand is repeated, so that the loop vectorises.
    if left.len() == right.len() {
        for ((to, a), b) in output.iter_mut().zip(left).zip(right) {
            *to = operation(*a, *b);
        }
    } else {
        for ((to, a), b) in output.iter_mut().zip(left.iter().cycle()).zip(right.iter().cycle()) {
            *to = operation(*a, *b);
        }
    }
}

/// Plans a function of single numbers.
pub(super) fn function(planner: &mut Planner, node: &Node, function: Function) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    planner.add(Work::Function(function), input.place, input.shape).map(Value::Computed)
}

/// Plans `Clip`. In old files its bounds are attributes.
pub(super) fn clip(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let min = planner.scalar(node, 1)?.map_or_else(|| node.float("min", f32::MIN), Ok)?;
    let max = planner.scalar(node, 2)?.map_or_else(|| node.float("max", f32::MAX), Ok)?;
    function(planner, node, Function::Clip { min, max })
}

/// Plans a function of pairs of numbers.
pub(super) fn binary(planner: &mut Planner, node: &Node, operation: Operation) -> Result<Value, NetworkError> {
    let (left, right) = (planner.row(node, 0)?, planner.row(node, 1)?);
    let (long, short) = if left.shape.len() >= right.shape.len() { (&left, &right) } else { (&right, &left) };
    let mut shape = long.shape.clone();
    let offset = shape.len() - short.shape.len();
    for (dim, other) in shape[offset..].iter_mut().zip(&short.shape) {
        *dim = if *dim == 1 { *other } else { *dim };
    }
    for operand in [&left, &right] {
        if !repeats(operand, &shape) {
            let found = format!("{} with {}", shape_text(&left.shape), shape_text(&right.shape));
            return Err(node.wrong(found, "equal shapes, a shape that ends the other one, or a single number"));
        }
    }
    planner.add(Work::Binary { operation, right: right.place }, left.place, shape).map(Value::Computed)
}

/// Whether the row can be repeated to this shape: without leading ones, its own is a suffix of it.
fn repeats(row: &Row, shape: &[usize]) -> bool {
    let ones = row.shape.iter().take_while(|dim| **dim == 1).count();
    shape.ends_with(&row.shape[ones..])
}
