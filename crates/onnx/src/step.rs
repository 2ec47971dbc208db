//! One step of an evaluation: reads some values and writes others after them.

use super::elementwise::{Function, Operation};
use super::linear::Linear;
use super::row::{Scale, Tie};
use std::ops::Range;

/// The output always comes after the inputs.
pub(super) enum Step {
    Function { function: Function, input: Range<usize>, output: Range<usize> },
    Binary { operation: Operation, left: Range<usize>, right: Range<usize>, output: Range<usize> },
    Linear { linear: Linear, input: Range<usize>, output: Range<usize> },
    Softmax { scale: Scale, row_size: usize, input: Range<usize>, output: Range<usize> },
    ArgMax { tie: Tie, row_size: usize, input: Range<usize>, output: Range<usize> },
    Copy { blocks: Blocks, input: Range<usize>, output: Range<usize> },
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
            Step::Copy { blocks, input, output } => {
                let (before, to) = split(values, output);
                blocks.copy(&before[input.clone()], to);
            }
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
