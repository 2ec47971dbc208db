//! Operators along the last dimension: Softmax, LogSoftmax and ArgMax.

use super::NetworkError;
use super::error::shape_text;
use super::node::Node;
use super::plan::{Element, Planner, Row, Value};
use super::step::Work;
use super::tensor::product;

#[derive(Clone, Copy)]
pub(super) enum Scale {
    Linear,
    Logarithmic,
}

/// Which one of several equal maxima is chosen.
#[derive(Clone, Copy)]
pub(super) enum Tie {
    First,
    Last,
}

/// Plans `Softmax` and `LogSoftmax`.
pub(super) fn softmax(planner: &mut Planner, node: &Node, scale: Scale) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    // Before version 13, the dimensions from the axis on count as one.
    let (default, is_flattened) = if node.version < 13 { (1, true) } else { (-1, false) };
    let axis = node.axis(node.integer("axis", default)?, input.shape.len())?;
    if !is_flattened {
        check_is_last(node, &input.shape, axis)?;
    }
    let row_size = product(&input.shape[axis..]).unwrap_or(0);
    planner.add(Work::Softmax { scale, row_size }, input.place, input.shape).map(Value::Computed)
}

pub(super) fn arg_max(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    let axis = node.axis(node.integer("axis", 0)?, input.shape.len())?;
    check_is_last(node, &input.shape, axis)?;
    let row_size = input.shape[axis];
    let tie = if node.integer("select_last_index", 0)? == 0 { Tie::First } else { Tie::Last };
    let mut shape = input.shape;
    if node.integer("keepdims", 1)? == 0 {
        shape.remove(axis);
    } else {
        shape[axis] = 1;
    }
    let output = planner.add(Work::ArgMax { tie, row_size }, input.place, shape)?;
    Ok(Value::Computed(Row { element: Element::Integer, ..output }))
}

/// Rejects an axis whose elements are not adjacent.
fn check_is_last(node: &Node, shape: &[usize], axis: usize) -> Result<(), NetworkError> {
    if product(&shape[axis + 1..]) == Some(1) {
        return Ok(());
    }
    Err(node.wrong(format!("axis {axis} of {}", shape_text(shape)), "the last axis"))
}

impl Scale {
    /// Softmax of each row. The maximum is subtracted first to prevent overflow.
    pub(super) fn apply(self, row_size: usize, input: &[f32], output: &mut [f32]) {
        for (to, from) in output.chunks_exact_mut(row_size).zip(input.chunks_exact(row_size)) {
            let greatest = from.iter().fold(f32::NEG_INFINITY, |greatest, x| if *x > greatest { *x } else { greatest });
            let mut sum = 0.0;
            for (to, from) in to.iter_mut().zip(from) {
                *to = libm::expf(from - greatest);
                sum += *to;
            }
            match self {
                Scale::Linear => to.iter_mut().for_each(|to| *to /= sum),
                Scale::Logarithmic => {
                    let of_sum = libm::logf(sum);
                    to.iter_mut().zip(from).for_each(|(to, from)| *to = from - greatest - of_sum);
                }
            }
        }
    }
}

impl Tie {
    /// The index of each row's maximum, as a float. NaN is never the maximum.
    pub(super) fn apply(self, row_size: usize, input: &[f32], output: &mut [f32]) {
        for (to, from) in output.iter_mut().zip(input.chunks_exact(row_size)) {
            let mut best = (f32::NEG_INFINITY, 0);
            for (i, x) in from.iter().enumerate() {
                let is_better = match self {
                    Tie::First => *x > best.0,
                    Tie::Last => *x >= best.0,
                };
                best = if is_better { (*x, i) } else { best };
            }
            *to = best.1 as f32;
        }
    }
}
