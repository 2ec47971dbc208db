//! Operators on rows of numbers: Softmax, LogSoftmax, ArgMax, GatherElements and the `Reduce…`
//! operators.

use super::NetworkError;
use super::arrangement;
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

/// Which of several equal maxima is chosen.
#[derive(Clone, Copy)]
pub(super) enum Tie {
    First,
    Last,
}

/// Plans `Softmax` and `LogSoftmax`.
pub(super) fn softmax(
    planner: &mut Planner,
    node: &Node,
    scale: Scale,
) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    // Before version 13, all dimensions from the axis on are treated as one.
    let (default, is_flattened) = if node.version < 13 {
        (1, true)
    } else {
        (-1, false)
    };
    let axis = node.axis(node.integer("axis", default)?, input.shape.len())?;
    if !is_flattened {
        check_is_last(node, &input.shape, axis)?;
    }
    let row_size = product(&input.shape[axis..]).unwrap_or(0);
    planner
        .add(Work::Softmax { scale, row_size }, input.place, input.shape)
        .map(Value::Computed)
}

pub(super) fn arg_max(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    let axis = node.axis(node.integer("axis", 0)?, input.shape.len())?;
    check_is_last(node, &input.shape, axis)?;
    let row_size = input.shape[axis];
    let tie = if node.integer("select_last_index", 0)? == 0 {
        Tie::First
    } else {
        Tie::Last
    };
    let mut shape = input.shape;
    if node.integer("keepdims", 1)? == 0 {
        shape.remove(axis);
    } else {
        shape[axis] = 1;
    }
    let output = planner.add(Work::ArgMax { tie, row_size }, input.place, shape)?;
    Ok(Value::Computed(Row {
        element: Element::Integer,
        ..output
    }))
}

/// How a row is reduced to one number.
#[derive(Clone, Copy)]
pub(super) enum Reduction {
    Sum,
    Mean,
    Least,
    Greatest,
    /// The square root of the sum of squares.
    Length,
    LogSumExp,
}

/// Plans the `Reduce…` operators. In old files the axes are an attribute.
pub(super) fn reduce(
    planner: &mut Planner,
    node: &Node,
    reduction: Reduction,
) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    let rank = input.shape.len();
    let asked = arrangement::axes(planner, node)?.unwrap_or_default();
    if asked.is_empty() && node.integer("noop_with_empty_axes", 0)? != 0 {
        return Ok(Value::Computed(input));
    }
    let mut is_reduced = vec![asked.is_empty(); rank];
    for axis in asked {
        is_reduced[node.axis(axis, rank)?] = true;
    }
    let keeps_dims = node.integer("keepdims", 1)? != 0;
    let shape = input.shape.iter().zip(&is_reduced);
    let shape = match keeps_dims {
        true => shape
            .map(|(dim, is_reduced)| if *is_reduced { 1 } else { *dim })
            .collect(),
        false => shape
            .filter(|(_, is_reduced)| !**is_reduced)
            .map(|(dim, _)| *dim)
            .collect(),
    };
    // The reduced axes become the last ones, so that their numbers are adjacent.
    let mut order: Vec<usize> = (0..rank).collect();
    order.sort_by_key(|axis| is_reduced[*axis]);
    let input = if order.is_sorted() {
        input
    } else {
        arrangement::transposed_row(planner, input, &order)?
    };
    let row = reduced(planner, reduction, input, shape)?;
    Ok(Value::Computed(row))
}

/// Reduces adjacent numbers, so that a value of this shape remains.
pub(super) fn reduced(
    planner: &mut Planner,
    reduction: Reduction,
    input: Row,
    shape: Vec<usize>,
) -> Result<Row, NetworkError> {
    let row_size = input.place.len() / product(&shape).unwrap_or(1).max(1);
    planner.add(
        Work::Reduce {
            reduction,
            row_size,
        },
        input.place,
        shape,
    )
}

/// Plans `GatherElements` along the last axis, with computed indices.
pub(super) fn gather_elements(planner: &mut Planner, node: &Node) -> Result<Value, NetworkError> {
    let input = planner.row(node, 0)?;
    let axis = node.axis(node.integer("axis", 0)?, input.shape.len())?;
    check_is_last(node, &input.shape, axis)?;
    let indices = match planner.value(node, 1)? {
        Value::Computed(row) if row.element == Element::Integer => row,
        _ => {
            return Err(node.wrong(
                "constants or floats as indices",
                "computed integers; use Gather for constant indices",
            ));
        }
    };
    let row_size = input.shape[axis];
    let mut shape = input.shape.clone();
    shape[axis] = indices.shape.get(axis).copied().unwrap_or(0);
    if shape != indices.shape {
        let found = format!(
            "{} by {}",
            shape_text(&input.shape),
            shape_text(&indices.shape)
        );
        return Err(node.wrong(found, "shapes that differ only in the last axis"));
    }
    let work = Work::Lookup {
        row_size,
        indices: indices.place,
    };
    planner
        .add(work, input.place, indices.shape)
        .map(Value::Computed)
}

/// Rejects an axis whose elements are not adjacent.
fn check_is_last(node: &Node, shape: &[usize], axis: usize) -> Result<(), NetworkError> {
    if product(&shape[axis + 1..]) == Some(1) {
        return Ok(());
    }
    Err(node.wrong(
        format!("axis {axis} of {}", shape_text(shape)),
        "the last axis",
    ))
}

impl Reduction {
    pub(super) fn apply(self, row_size: usize, input: &[f32], output: &mut [f32]) {
        for (to, row) in output.iter_mut().zip(input.chunks_exact(row_size)) {
            *to = self.of(row);
        }
    }

    /// Numbers are added one by one, in order.
    fn of(self, row: &[f32]) -> f32 {
        let sum = |of: fn(f32) -> f32| row.iter().fold(0.0, |sum, x| sum + of(*x));
        let greatest = || {
            row.iter().fold(f32::NEG_INFINITY, |best, x| {
                if *x > best || x.is_nan() { *x } else { best }
            })
        };
        match self {
            Reduction::Sum => sum(|x| x),
            Reduction::Mean => sum(|x| x) / row.len() as f32,
            Reduction::Least => row.iter().fold(f32::INFINITY, |best, x| {
                if *x < best || x.is_nan() { *x } else { best }
            }),
            Reduction::Greatest => greatest(),
            Reduction::Length => sum(|x| x * x).sqrt(),
            // The maximum is subtracted first to prevent overflow.
            Reduction::LogSumExp => {
                let greatest = greatest();
                if greatest.is_infinite() {
                    return greatest;
                }
                greatest
                    + libm::logf(
                        row.iter()
                            .fold(0.0, |sum, x| sum + libm::expf(x - greatest)),
                    )
            }
        }
    }
}

impl Scale {
    /// Softmax of each row, or its logarithm. The maximum is subtracted first to prevent overflow.
    pub(super) fn apply(self, row_size: usize, input: &[f32], output: &mut [f32]) {
        for (to, from) in output
            .chunks_exact_mut(row_size)
            .zip(input.chunks_exact(row_size))
        {
            let greatest =
                from.iter().fold(
                    f32::NEG_INFINITY,
                    |greatest, x| if *x > greatest { *x } else { greatest },
                );
            let mut sum = 0.0;
            for (to, from) in to.iter_mut().zip(from) {
                *to = libm::expf(from - greatest);
                sum += *to;
            }
            match self {
                Scale::Linear => to.iter_mut().for_each(|to| *to /= sum),
                Scale::Logarithmic => {
                    let of_sum = libm::logf(sum);
                    to.iter_mut()
                        .zip(from)
                        .for_each(|(to, from)| *to = from - greatest - of_sum);
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
