//! Elementwise operators on one or two inputs.

use super::NetworkError;
use super::activation;
use super::arrangement;
use super::error::{shape_text, shown};
use super::node::Node;
use super::plan::{Element, Planner, Row, Value};
use super::step::Work;
use super::tensor::{Numbers, Tensor, product};
use std::ops::Range;

/// A function of one number. A NaN input yields NaN.
#[derive(Clone, Copy)]
pub(super) enum Function {
    Absolute,
    Celu {
        alpha: f32,
    },
    Clip {
        min: f32,
        max: f32,
    },
    Elu {
        alpha: f32,
    },
    Erf,
    Exp,
    Gelu,
    GeluByTanh,
    HardSigmoid {
        alpha: f32,
        beta: f32,
    },
    HardSwish,
    LeakyRelu {
        alpha: f32,
    },
    Logarithm,
    Mish,
    Negative,
    Reciprocal,
    Relu,
    Selu {
        alpha: f32,
        gamma: f32,
    },
    Sigmoid,
    Softplus,
    Softsign,
    SquareRoot,
    Swish {
        alpha: f32,
    },
    Tanh,
    /// Rounds towards zero.
    Truncate,
}

impl Function {
    pub(super) fn apply(self, input: &[f32], output: &mut [f32]) {
        match self {
            Function::Absolute => each(input, output, f32::abs),
            Function::Celu { alpha } => {
                each(input, output, |x| {
                    if x < 0.0 {
                        alpha * (libm::expf(x / alpha) - 1.0)
                    } else {
                        x
                    }
                });
            }
            Function::Clip { min, max } => each(input, output, |x| clip_to(x, min, max)),
            Function::Elu { alpha } => {
                each(input, output, |x| {
                    if x < 0.0 {
                        alpha * (libm::expf(x) - 1.0)
                    } else {
                        x
                    }
                });
            }
            Function::Erf => each(input, output, libm::erff),
            Function::Exp => each(input, output, libm::expf),
            Function::Gelu => each(input, output, activation::gelu),
            Function::GeluByTanh => each(input, output, activation::gelu_by_tanh),
            Function::HardSigmoid { alpha, beta } => {
                each(input, output, |x| clip_to(alpha * x + beta, 0.0, 1.0))
            }
            Function::HardSwish => each(input, output, |x| x * clip_to(x / 6.0 + 0.5, 0.0, 1.0)),
            Function::LeakyRelu { alpha } => {
                each(input, output, |x| if x < 0.0 { alpha * x } else { x })
            }
            Function::Logarithm => each(input, output, libm::logf),
            Function::Mish => each(input, output, |x| {
                x * activation::tanh(activation::softplus(x))
            }),
            Function::Negative => each(input, output, |x| -x),
            Function::Reciprocal => each(input, output, |x| 1.0 / x),
            Function::Relu => each(input, output, |x| if x < 0.0 { 0.0 } else { x }),
            Function::Selu { alpha, gamma } => {
                each(input, output, |x| {
                    gamma
                        * if x < 0.0 {
                            alpha * (libm::expf(x) - 1.0)
                        } else {
                            x
                        }
                });
            }
            Function::Sigmoid => each(input, output, activation::sigmoid),
            Function::Softplus => each(input, output, activation::softplus),
            Function::Softsign => each(input, output, |x| x / (1.0 + x.abs())),
            Function::SquareRoot => each(input, output, f32::sqrt),
            Function::Swish { alpha } => {
                each(input, output, |x| x * activation::sigmoid(alpha * x))
            }
            Function::Tanh => each(input, output, activation::tanh),
            Function::Truncate => each(input, output, f32::trunc),
        }
    }
}

/// NaN remains NaN.
fn clip_to(x: f32, min: f32, max: f32) -> f32 {
    let above = if x < min { min } else { x };
    if above > max { max } else { above }
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
    /// 1 if both are equal, else 0.
    Equal,
    Least,
    Greatest,
    Power,
    /// The left number, multiplied by the right one if the left is negative.
    Slope,
}

impl Operation {
    /// A shorter operand is repeated.
    pub(super) fn apply(self, left: &[f32], right: &[f32], output: &mut [f32]) {
        match self {
            Operation::Add => pairs(left, right, output, |a, b| a + b),
            Operation::Subtract => pairs(left, right, output, |a, b| a - b),
            Operation::Multiply => pairs(left, right, output, |a, b| a * b),
            Operation::Divide => pairs(left, right, output, |a, b| a / b),
            Operation::Equal => pairs(left, right, output, |a, b| f32::from(u8::from(a == b))),
            Operation::Least => pairs(
                left,
                right,
                output,
                |a, b| if b < a || b.is_nan() { b } else { a },
            ),
            Operation::Greatest => {
                pairs(
                    left,
                    right,
                    output,
                    |a, b| if b > a || b.is_nan() { b } else { a },
                )
            }
            Operation::Power => pairs(left, right, output, power),
            Operation::Slope => pairs(left, right, output, |a, b| if a < 0.0 { a * b } else { a }),
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
        for ((to, a), b) in output
            .iter_mut()
            .zip(left.iter().cycle())
            .zip(right.iter().cycle())
        {
            *to = operation(*a, *b);
        }
    }
}

/// Squares, which normalisations use, are computed as products rather than with `powf`.
fn power(base: f32, exponent: f32) -> f32 {
    if exponent == 2.0 {
        base * base
    } else {
        libm::powf(base, exponent)
    }
}

/// Plans an elementwise function of one input.
pub(super) fn function(
    planner: &mut Planner,
    node: &Node,
    function: Function,
) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    Ok(Value::Computed(apply(planner, function, input)?))
}

pub(super) fn apply(
    planner: &mut Planner,
    function: Function,
    input: Row,
) -> Result<Row, NetworkError> {
    planner.add(Work::Function(function), input.place, input.shape)
}

pub(super) fn gelu(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    match node.text("approximate", "none")? {
        "none" => function(planner, node, Function::Gelu),
        "tanh" => function(planner, node, Function::GeluByTanh),
        other => Err(node.wrong(format!("approximate = {}", shown(other)), "none or tanh")),
    }
}

/// Plans `Clip`. In old files its bounds are attributes.
pub(super) fn clip(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let min = planner
        .bound(node, 1)?
        .map_or_else(|| node.float("min", f32::MIN), Ok)?;
    let max = planner
        .bound(node, 2)?
        .map_or_else(|| node.float("max", f32::MAX), Ok)?;
    function(planner, node, Function::Clip { min, max })
}

/// Plans an elementwise function of two inputs; further inputs are combined from left to right.
pub(super) fn binary(
    planner: &mut Planner,
    node: &Node,
    operation: Operation,
) -> Result<Value, NetworkError> {
    if let Some(integers) = integers(planner, node, operation)? {
        return Ok(Value::Constant(integers));
    }
    // Sums and similar results of integers of up to 24 bits are exact in floats, unlike quotients.
    let is_whole = !matches!(
        operation,
        Operation::Divide | Operation::Power | Operation::Slope
    );
    let is_of_integers = |index| {
        planner
            .value(node, index)
            .is_ok_and(|value| value.is_integer())
    };
    let element = match is_whole && (0..node.proto.input.len()).all(is_of_integers) {
        true => Element::Integer,
        false => Element::Float,
    };
    let mut left = planner.row_of(node, 0, element)?;
    for index in 1..node.proto.input.len() {
        let right = planner.row_of(node, index, element)?;
        left = combine(planner, node, operation, left, right)?;
    }
    Ok(Value::Computed(Row { element, ..left }))
}

/// The result of an operation on two integer constants, such as parts of a shape.
fn integers(
    planner: &mut Planner,
    node: &Node,
    operation: Operation,
) -> Result<Option<Tensor>, NetworkError> {
    if node.proto.input.len() != 2 {
        return Ok(None);
    }
    let [Value::Constant(left), Value::Constant(right)] =
        [planner.value(node, 0)?, planner.value(node, 1)?]
    else {
        return Ok(None);
    };
    let function: fn(i64, i64) -> Option<i64> = match operation {
        Operation::Add => i64::checked_add,
        Operation::Subtract => i64::checked_sub,
        Operation::Multiply => i64::checked_mul,
        Operation::Divide => i64::checked_div,
        Operation::Least => |a, b| Some(a.min(b)),
        Operation::Greatest => |a, b| Some(a.max(b)),
        Operation::Equal => |a, b| Some((a == b).into()),
        Operation::Power | Operation::Slope => return Ok(None),
    };
    if [&left, &right]
        .iter()
        .any(|tensor| matches!(&*tensor.numbers, Numbers::Floats(_)))
    {
        return Ok(None);
    }
    let (shape, [a, b]) = alike(planner, node, [&left, &right])?;
    let numbers = a
        .into_iter()
        .zip(b)
        .map(|(a, b)| function(a, b))
        .collect::<Option<Vec<i64>>>();
    let Some(numbers) = numbers else {
        return Err(node.wrong("an integer beyond 64 bits", "a smaller one"));
    };
    Ok(Some(Tensor::new(shape, Numbers::Integers(numbers))))
}

/// The integers of constants, repeated to their common shape.
fn alike<const COUNT: usize>(
    planner: &mut Planner,
    node: &Node,
    tensors: [&Tensor; COUNT],
) -> Result<(Vec<usize>, [Vec<i64>; COUNT]), NetworkError> {
    let mut shape = vec![];
    for tensor in tensors {
        shape = broadcast(&shape, &tensor.shape).ok_or_else(|| {
            let found = format!("{} with {}", shape_text(&shape), shape_text(&tensor.shape));
            node.wrong(found, "shapes whose dimensions are equal or 1")
        })?;
    }
    planner.count_weights(product(&shape).and_then(|size| size.checked_mul(COUNT)), 0)?;
    let mut lists: [Vec<i64>; COUNT] = std::array::from_fn(|_| vec![]);
    for (list, tensor) in lists.iter_mut().zip(tensors) {
        let Numbers::Integers(integers) = &*tensor.numbers else {
            return Err(node.wrong("constant floats", "constant integers"));
        };
        let from = arrangement::repeated(&tensor.shape, &shape);
        *list = from.into_iter().map(|i| integers[i as usize]).collect();
    }
    Ok((shape, lists))
}

/// Plans `Where` for constant integers.
pub(super) fn choose(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let [condition, if_true, if_false] = [
        planner.constant(node, 0)?,
        planner.constant(node, 1)?,
        planner.constant(node, 2)?,
    ];
    let (shape, [conditions, a, b]) = alike(planner, node, [&condition, &if_true, &if_false])?;
    let choices = conditions.into_iter().zip(a.into_iter().zip(b));
    let chosen = choices.map(|(is_true, (a, b))| if is_true == 0 { b } else { a });
    Ok(Value::Constant(Tensor::new(
        shape,
        Numbers::Integers(chosen.collect()),
    )))
}

/// Applies an operation to two rows of equal shapes, or of shapes that broadcast to one.
pub(super) fn combine(
    planner: &mut Planner,
    node: &Node,
    operation: Operation,
    left: Row,
    right: Row,
) -> Result<Row, NetworkError> {
    let Some(shape) = broadcast(&left.shape, &right.shape) else {
        let found = format!(
            "{} with {}",
            shape_text(&left.shape),
            shape_text(&right.shape)
        );
        return Err(node.wrong(found, "shapes whose dimensions are equal or 1"));
    };
    let left = repeatable(planner, left, &shape)?;
    let right = repeatable(planner, right, &shape)?;
    planner.add(Work::Binary { operation, right }, left, shape)
}

/// The memory of numbers that, repeated, fill this shape: the row's own if its shape, without
/// leading dimensions of 1, is a suffix of that shape; otherwise an expanded copy.
fn repeatable(
    planner: &mut Planner,
    row: Row,
    shape: &[usize],
) -> Result<Range<usize>, NetworkError> {
    let ones = row.shape.iter().take_while(|dim| **dim == 1).count();
    if shape.ends_with(&row.shape[ones..]) {
        return Ok(row.place);
    }
    Ok(arrangement::expanded_row(planner, row, shape)?.place)
}

/// The common shape of two shapes, if each dimension, counted from the last, is equal or 1.
pub(super) fn broadcast(left: &[usize], right: &[usize]) -> Option<Vec<usize>> {
    let (long, short) = if left.len() >= right.len() {
        (left, right)
    } else {
        (right, left)
    };
    let mut shape = long.to_vec();
    let offset = long.len() - short.len();
    for (dim, other) in shape[offset..].iter_mut().zip(short) {
        match (*dim, *other) {
            (1, other) => *dim = other,
            (_, 1) => {}
            (dim, other) if dim == other => {}
            _ => return None,
        }
    }
    Some(shape)
}
