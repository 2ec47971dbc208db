//! Numbers written one after the other.

/// A slice that is filled from the front.
pub(super) struct Numbers<'a> {
    left: &'a mut [f32],
}

impl<'a> Numbers<'a> {
    pub(super) fn new(all: &'a mut [f32]) -> Numbers<'a> {
        Numbers { left: all }
    }

    /// Writes the next one.
    pub(super) fn push(&mut self, number: f64) {
        // Spaces tell trainers their size before anything is written: a writer that disagrees
        // is a mistake of ours.
        let (next, left) = std::mem::take(&mut self.left).split_first_mut().expect("there is room for every number");
        *next = number as f32;
        self.left = left;
    }

    /// Writes the next ones.
    pub(super) fn extend(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|number| self.push(number));
    }

    /// Writes 1 or 0.
    pub(super) fn flag(&mut self, is: bool) {
        self.push(f64::from(u8::from(is)));
    }

    /// Writes this many zeros.
    pub(super) fn skip(&mut self, count: usize) {
        (0..count).for_each(|_| self.push(0.0));
    }
}
