//! One step of an evaluation: reads some values and writes others after them.

use super::elementwise::{Function, Operation};
use super::linear::Linear;
use super::row::{Reduction, Scale, Tie};
use std::ops::Range;

/// The output always comes after the inputs.
pub(super) enum Step {
    Function {
        function: Function,
        input: Range<usize>,
        output: Range<usize>,
    },
    Binary {
        operation: Operation,
        left: Range<usize>,
        right: Range<usize>,
        output: Range<usize>,
    },
    Linear {
        linear: Linear,
        input: Range<usize>,
        output: Range<usize>,
    },
    Softmax {
        scale: Scale,
        row_size: usize,
        input: Range<usize>,
        output: Range<usize>,
    },
    ArgMax {
        tie: Tie,
        row_size: usize,
        input: Range<usize>,
        output: Range<usize>,
    },
    Reduce {
        reduction: Reduction,
        row_size: usize,
        input: Range<usize>,
        output: Range<usize>,
    },
    Copy {
        blocks: Blocks,
        input: Range<usize>,
        output: Range<usize>,
    },
    /// Copies the numbers at these indices of the input.
    Pick {
        from: Vec<u32>,
        input: Range<usize>,
        output: Range<usize>,
    },
    /// Copies, from each row of the input, the numbers at computed indices.
    Lookup {
        row_size: usize,
        input: Range<usize>,
        indices: Range<usize>,
        output: Range<usize>,
    },
}

/// Blocks of numbers at regular intervals.
pub(super) struct Blocks {
    pub(super) count: usize,
    pub(super) size: usize,
    /// Offset of the first block, and distance between blocks, in the input.
    pub(super) from: (usize, usize),
    /// The same in the output.
    pub(super) to: (usize, usize),
}

impl Step {
    pub(super) fn take(&self, values: &mut [f32]) {
        match self {
            Step::Function { function, input, output } => {
                let (before, to) = split(values, output);
                function.apply(&before[input.clone()], to);
            }
            Step::Binary { operation, left, right, output } => {
                let (before, to) = split(values, output);
                operation.apply(&before[left.clone()], &before[right.clone()], to);
            }
            Step::Linear { linear, input, output } => {
                let (before, to) = split(values, output);
                linear.apply(&before[input.clone()], to);
            }
            Step::Softmax { scale, row_size, input, output } => {
                let (before, to) = split(values, output);
                scale.apply(*row_size, &before[input.clone()], to);
            }
            Step::ArgMax { tie, row_size, input, output } => {
                let (before, to) = split(values, output);
                tie.apply(*row_size, &before[input.clone()], to);
            }
            Step::Reduce { reduction, row_size, input, output } => {
                let (before, to) = split(values, output);
                reduction.apply(*row_size, &before[input.clone()], to);
            }
            Step::Copy { blocks, input, output } => {
                let (before, to) = split(values, output);
                blocks.copy(&before[input.clone()], to);
            }
            Step::Pick { from, input, output } => {
                let (before, to) = split(values, output);
                let before = &before[input.clone()];
                to.iter_mut().zip(from).for_each(|(to, from)| *to = before[*from as usize]);
            }
            Step::Lookup { row_size, input, indices, output } => {
                let (before, to) = split(values, output);
                look_up(*row_size, &before[input.clone()], &before[indices.clone()], to);
            }
        }
    }
}

/// Negative indices count from the end of a row. Those outside the row give NaN.
fn look_up(row_size: usize, input: &[f32], indices: &[f32], output: &mut [f32]) {
    let rows = input.chunks_exact(row_size);
    let per_row = output.len() / rows.len();
    let indices = indices.chunks_exact(per_row);
    for ((row, indices), to) in rows.zip(indices).zip(output.chunks_exact_mut(per_row)) {
        for (to, index) in to.iter_mut().zip(indices) {
            let from_start = if *index < 0.0 { index + row_size as f32 } else { *index };
            *to = if from_start >= 0.0 { row.get(from_start as usize).copied().unwrap_or(f32::NAN) } else { f32::NAN };
        }
    }
}

/// Splits the values into those that a step may read and its output.
fn split<'a>(values: &'a mut [f32], output: &Range<usize>) -> (&'a [f32], &'a mut [f32]) {
    let (before, after) = values.split_at_mut(output.start);
    (before, &mut after[..output.len()])
}

impl Blocks {
    fn copy(&self, input: &[f32], output: &mut [f32]) {
        let mut place = (self.from.0, self.to.0);
        for _ in 0..self.count {
            output[place.1..place.1 + self.size].copy_from_slice(&input[place.0..place.0 + self.size]);
            place = (place.0 + self.from.1, place.1 + self.to.1);
        }
    }
}
