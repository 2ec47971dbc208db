//! One step of an evaluation: reads some values and writes others after them.

use super::elementwise::{Function, Operation};
use super::linear::Linear;
use super::row::{Reduction, Scale, Tie};
use std::ops::Range;

/// The output always comes after the inputs.
pub(super) struct Step {
    pub(super) work: Work,
    pub(super) input: Range<usize>,
    pub(super) output: Range<usize>,
}

pub(super) enum Work {
    Function(Function),
    Binary {
        operation: Operation,
        right: Range<usize>,
    },
    Linear(Linear),
    Softmax {
        scale: Scale,
        row_size: usize,
    },
    ArgMax {
        tie: Tie,
        row_size: usize,
    },
    Reduce {
        reduction: Reduction,
        row_size: usize,
    },
    /// Copies blocks of `size` numbers to the output, a fixed distance apart, starting at an
    /// offset.
    Spread {
        size: usize,
        offset: usize,
        distance: usize,
    },
    /// Copies the numbers at these indices of the input.
    Pick(Vec<u32>),
    /// Copies, from each row of the input, the numbers at computed indices.
    Lookup {
        row_size: usize,
        indices: Range<usize>,
    },
}

impl Step {
    pub(super) fn take(&self, values: &mut [f32]) {
        let (before, after) = values.split_at_mut(self.output.start);
        let input = &before[self.input.clone()];
        let output = &mut after[..self.output.len()];
        match &self.work {
            Work::Function(function) => function.apply(input, output),
            Work::Binary { operation, right } => {
                operation.apply(input, &before[right.clone()], output)
            }
            Work::Linear(linear) => linear.apply(input, output),
            Work::Softmax { scale, row_size } => scale.apply(*row_size, input, output),
            Work::ArgMax { tie, row_size } => tie.apply(*row_size, input, output),
            Work::Reduce {
                reduction,
                row_size,
            } => reduction.apply(*row_size, input, output),
            Work::Spread {
                size,
                offset,
                distance,
            } => {
                for (i, block) in input.chunks_exact(*size).enumerate() {
                    let at = offset + i * distance;
                    output[at..at + size].copy_from_slice(block);
                }
            }
            Work::Pick(from) => output
                .iter_mut()
                .zip(from)
                .for_each(|(to, from)| *to = input[*from as usize]),
            Work::Lookup { row_size, indices } => {
                look_up(*row_size, input, &before[indices.clone()], output)
            }
        }
    }
}

/// Negative indices count from the end of a row. Indices outside the row give NaN.
fn look_up(row_size: usize, input: &[f32], indices: &[f32], output: &mut [f32]) {
    let rows = input.chunks_exact(row_size);
    let per_row = output.len() / rows.len();
    let indices = indices.chunks_exact(per_row);
    for ((row, indices), to) in rows.zip(indices).zip(output.chunks_exact_mut(per_row)) {
        for (to, index) in to.iter_mut().zip(indices) {
            let from_start = if *index < 0.0 {
                index + row_size as f32
            } else {
                *index
            };
            *to = if from_start >= 0.0 {
                row.get(from_start as usize).copied().unwrap_or(f32::NAN)
            } else {
                f32::NAN
            };
        }
    }
}
