//! Normalisation layers, as compositions of simpler steps.

use super::NetworkError;
use super::elementwise::{Function, Operation, apply, combine};
use super::error::shape_text;
use super::node::Node;
use super::plan::{Planner, Row, Value, floats};
use super::row::{Reduction, reduced};

/// Plans `LayerNormalization`: zero mean and unit variance over the last axes, then a scale and a
/// bias.
pub(super) fn layer(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    let axis = node.axis(node.integer("axis", -1)?, input.shape.len())?;
    let of_rows: Vec<usize> = input
        .shape
        .iter()
        .enumerate()
        .map(|(i, dim)| if i < axis { *dim } else { 1 })
        .collect();
    let mean = reduced(planner, Reduction::Mean, input.clone(), of_rows.clone())?;
    let centred = combine(planner, node, Operation::Subtract, input, mean)?;
    let squares = combine(
        planner,
        node,
        Operation::Multiply,
        centred.clone(),
        centred.clone(),
    )?;
    let variance = reduced(planner, Reduction::Mean, squares, of_rows)?;
    let epsilon = planner.new_constant(vec![], &[node.float("epsilon", 1e-5)?])?;
    let positive = combine(planner, node, Operation::Add, variance, epsilon)?;
    let deviation = apply(planner, Function::SquareRoot, positive)?;
    let normalised = combine(planner, node, Operation::Divide, centred, deviation)?;
    let scale = planner.row(node, 1)?;
    let scaled = combine(planner, node, Operation::Multiply, normalised, scale)?;
    if node.input(2).is_none() {
        return Ok(Value::Computed(scaled));
    }
    let bias = planner.row(node, 2)?;
    Ok(Value::Computed(combine(
        planner,
        node,
        Operation::Add,
        scaled,
        bias,
    )?))
}

/// Plans `BatchNormalization` as in inference: a factor and an offset for each channel, which is
/// axis 1.
pub(super) fn batch(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    if node.integer("training_mode", 0)? != 0 {
        return Err(node.wrong(
            "training_mode = 1",
            "training_mode = 0: export the model in evaluation mode",
        ));
    }
    if node.integer("spatial", 1)? != 1 {
        return Err(node.wrong("spatial = 0", "spatial = 1: one factor per channel"));
    }
    let input = planner.row(node, 0)?;
    let [scale, bias, mean, variance] = channels(planner, node, &input)?;
    let epsilon = node.float("epsilon", 1e-5)?;
    let factors: Vec<f32> = scale
        .iter()
        .zip(&variance)
        .map(|(scale, variance)| scale / (variance + epsilon).sqrt())
        .collect();
    let offsets: Vec<f32> = bias
        .iter()
        .zip(&mean)
        .zip(&factors)
        .map(|((bias, mean), factor)| bias - mean * factor)
        .collect();
    let mut shape = vec![factors.len()];
    shape.resize(input.shape.len().saturating_sub(1).max(1), 1);
    let factors = planner.new_constant(shape.clone(), &factors)?;
    let offsets = planner.new_constant(shape, &offsets)?;
    let scaled = combine(planner, node, Operation::Multiply, input, factors)?;
    Ok(Value::Computed(combine(
        planner,
        node,
        Operation::Add,
        scaled,
        offsets,
    )?))
}

/// The four constants of a `BatchNormalization`, with one number per channel.
fn channels(planner: &Planner, node: &Node, input: &Row) -> Result<[Vec<f32>; 4], NetworkError> {
    let count = input.shape.get(1).copied().unwrap_or(1);
    let mut lists: [Vec<f32>; 4] = Default::default();
    for (i, list) in lists.iter_mut().enumerate() {
        let tensor = planner.constant(node, i + 1)?;
        let numbers = floats(node, i + 1, &tensor)?;
        if numbers.len() != count {
            let found = format!(
                "{} numbers as input {} for {}",
                numbers.len(),
                i + 1,
                shape_text(&input.shape)
            );
            return Err(node.wrong(found, format!("{count}, one per channel")));
        }
        numbers.clone_into(list);
    }
    Ok(lists)
}

/// Plans `Dropout`, which changes nothing in inference.
pub(super) fn dropout(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    if node.input(2).is_some() && planner.integers(node, 2)?.is_some_and(|mode| mode != [0]) {
        return Err(node.wrong(
            "training mode",
            "inference: export the model in evaluation mode",
        ));
    }
    planner.value(node, 0)
}
