//! One step of an evaluation: reads some values and writes others after them.

use super::elementwise::{Function, Operation};
use super::linear::Linear;
use super::row::{Scale, Tie};
use std::ops::Range;

/// The output always comes after the inputs.
pub(super) struct Step {
    pub(super) work: Work,
    pub(super) input: Range<usize>,
    pub(super) output: Range<usize>,
}

pub(super) enum Work {
    Function(Function),
    Binary { operation: Operation, right: Range<usize> },
    Linear(Linear),
    Softmax { scale: Scale, row_size: usize },
    ArgMax { tie: Tie, row_size: usize },
    Copy(Blocks),
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
        let (before, after) = values.split_at_mut(self.output.start);
        let (input, output) = (&before[self.input.clone()], &mut after[..self.output.len()]);
        match &self.work {
            Work::Function(function) => function.apply(input, output),
            Work::Binary { operation, right } => operation.apply(input, &before[right.clone()], output),
            Work::Linear(linear) => linear.apply(input, output),
            Work::Softmax { scale, row_size } => scale.apply(*row_size, input, output),
            Work::ArgMax { tie, row_size } => tie.apply(*row_size, input, output),
            Work::Copy(blocks) => blocks.copy(input, output),
        }
    }
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
