//! MatMul and Gemm with constant weights.

use super::NetworkError;
use super::arrangement::transposed_row;
use super::error::shape_text;
use super::node::Node;
use super::plan::{Planner, Row, Value, floats};
use super::step::Work;

/// Number of outputs summed in parallel, in registers.
const LANES: usize = 16;

/// A weight matrix and a bias, laid out for evaluation.
///
/// Each output is `bias + x[0] w[0] + x[1] w[1] + …`. Products are added one by one in this order,
/// with separate rounding of product and sum. Only different outputs are computed in parallel, so
/// the register width does not affect the result.
pub(super) struct Linear {
    inputs: usize,
    outputs: usize,
    /// The weights of a group of outputs for one input, by group and by input.
    weights: Vec<[f32; LANES]>,
    /// The biases, by group of outputs.
    biases: Vec<[f32; LANES]>,
}

impl Linear {
    fn new(
        inputs: usize,
        outputs: usize,
        weight: impl Fn(usize, usize) -> f32,
        bias: &[f32],
    ) -> Linear {
        let groups = outputs.div_ceil(LANES);
        let lanes = |group: usize, number: &dyn Fn(usize) -> f32| {
            std::array::from_fn(|lane| {
                let output = group * LANES + lane;
                if output < outputs {
                    number(output)
                } else {
                    0.0
                }
            })
        };
        let weights = (0..groups).flat_map(|group| (0..inputs).map(move |input| (group, input)));
        Linear {
            inputs,
            outputs,
            weights: weights
                .map(|(group, input)| lanes(group, &|output| weight(input, output)))
                .collect(),
            biases: (0..groups)
                .map(|group| lanes(group, &|output| bias[output]))
                .collect(),
        }
    }

    pub(super) fn apply(&self, input: &[f32], output: &mut [f32]) {
        for (from, to) in input
            .chunks_exact(self.inputs)
            .zip(output.chunks_exact_mut(self.outputs))
        {
            let groups = self.weights.chunks_exact(self.inputs).zip(&self.biases);
            for (to, (weights, bias)) in to.chunks_mut(LANES).zip(groups) {
                to.copy_from_slice(&sums(from, weights, *bias)[..to.len()]);
            }
        }
    }
}

/// The sums of a group of outputs.
#[inline]
fn sums(input: &[f32], weights: &[[f32; LANES]], bias: [f32; LANES]) -> [f32; LANES] {
    let mut sums = bias;
    for (x, weights) in input.iter().zip(weights) {
        for (sum, weight) in sums.iter_mut().zip(weights) {
            *sum += x * weight;
        }
    }
    sums
}

/// Plans `MatMul`: the input times constant weights.
pub(super) fn mat_mul(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    let tensor = planner.constant(node, 1)?;
    let weights = floats(node, 1, &tensor)?;
    let (inputs, outputs) = matrix(node, &tensor.shape)?;
    check_rows(node, &input, (inputs, outputs))?;
    add(
        planner,
        input,
        (inputs, outputs),
        |input, output| weights[input * outputs + output],
        None,
    )
}

/// Plans `Gemm`: alpha · input · weights + beta · bias, with constant weights and bias.
pub(super) fn gemm(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let mut input = planner.row(node, 0)?;
    if input.shape.len() != 2 {
        return Err(node.wrong(
            format!("{} as input 0", shape_text(&input.shape)),
            "two dimensions",
        ));
    }
    if node.integer("transA", 0)? != 0 {
        input = transposed_row(planner, input, &[1, 0])?;
    }
    let alpha = node.float("alpha", 1.0)?;
    let beta = node.float("beta", 1.0)?;
    let tensor = planner.constant(node, 1)?;
    let weights = floats(node, 1, &tensor)?;
    let (rows, columns) = matrix(node, &tensor.shape)?;
    let is_transposed = node.integer("transB", 0)? != 0;
    let (inputs, outputs) = if is_transposed {
        (columns, rows)
    } else {
        (rows, columns)
    };
    check_rows(node, &input, (inputs, outputs))?;
    let bias = match node.input(2) {
        Some(_) => Some(bias(planner, node, outputs, beta)?),
        None => None,
    };
    let weight = |input: usize, output: usize| {
        alpha
            * weights[if is_transposed {
                output * columns + input
            } else {
                input * columns + output
            }]
    };
    add(planner, input, (inputs, outputs), weight, bias)
}

/// The bias of a `Gemm`: one per output, or one for all.
fn bias(
    planner: &Planner,
    node: &Node,
    outputs: usize,
    beta: f32,
) -> Result<Vec<f32>, NetworkError> {
    let tensor = planner.constant(node, 2)?;
    let numbers = floats(node, 2, &tensor)?;
    let last = tensor.shape.last().copied().unwrap_or(1);
    if tensor.shape.len() > 2
        || last != numbers.len()
        || !(numbers.len() == outputs || numbers.len() == 1)
    {
        let found = format!("{} as input 2", shape_text(&tensor.shape));
        return Err(node.wrong(found, format!("one bias, or {outputs}, one per output")));
    }
    Ok((0..outputs)
        .map(|output| beta * numbers[output % numbers.len()])
        .collect())
}

/// The two dimensions of weights.
fn matrix(node: &Node, shape: &[usize]) -> Result<(usize, usize), NetworkError> {
    match shape {
        [rows, columns] => Ok((*rows, *columns)),
        _ => Err(node.wrong(
            format!("{} as input 1", shape_text(shape)),
            "two dimensions",
        )),
    }
}

/// Rejects an input whose row size does not match the weights.
fn check_rows(
    node: &Node,
    input: &Row,
    (inputs, outputs): (usize, usize),
) -> Result<(), NetworkError> {
    if input.shape.last() == Some(&inputs) {
        return Ok(());
    }
    let found = format!(
        "{} with {inputs} x {outputs} weights",
        shape_text(&input.shape)
    );
    Err(node.wrong(found, format!("rows of {inputs} numbers")))
}

/// Adds a layer of `inputs` by `outputs` weights to the plan.
fn add(
    planner: &mut Planner,
    input: Row,
    (inputs, outputs): (usize, usize),
    weight: impl Fn(usize, usize) -> f32,
    bias: Option<Vec<f32>>,
) -> Result<Value, NetworkError> {
    let laid_out = outputs
        .div_ceil(LANES)
        .checked_mul(LANES)
        .and_then(|outputs| outputs.checked_mul(inputs));
    planner.count_weights(laid_out, input.place.len() / inputs)?;
    let mut shape = input.shape;
    shape.pop();
    shape.push(outputs);
    let linear = Linear::new(
        inputs,
        outputs,
        weight,
        &bias.unwrap_or_else(|| vec![0.0; outputs]),
    );
    planner
        .add(Work::Linear(linear), input.place, shape)
        .map(Value::Computed)
}
