//! A writer of consecutive numbers.

use std::slice::IterMut;

/// A slice filled from the front.
pub(super) struct Numbers<'a>(IterMut<'a, f32>);

impl<'a> Numbers<'a> {
    pub(super) fn new(all: &'a mut [f32]) -> Numbers<'a> {
        Numbers(all.iter_mut())
    }

    /// Writes the next number.
    pub(super) fn push(&mut self, number: f64) {
        // Spaces report their size to trainers before values are written, so a mismatch is a bug.
        *self.0.next().expect("the slice has space for every number") = number as f32;
    }

    /// Writes several numbers.
    pub(super) fn extend(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|number| self.push(number));
    }

    /// Writes 1 for true or 0 for false.
    pub(super) fn flag(&mut self, is: bool) {
        self.push(f64::from(u8::from(is)));
    }

    /// Writes `count` zeros.
    pub(super) fn skip(&mut self, count: usize) {
        (0..count).for_each(|_| self.push(0.0));
    }
}
