//! A table: a utility for each course and speed, for functions without a closed form.

use super::grid::Grid;
use super::lanes::{LANES, Lanes};

/// Utilities by course and speed, initially 100. Courses still at 100 cost nothing.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The numbers of courses and speeds.
    pub(super) courses: usize,
    pub(super) speeds: usize,
    /// By course: as many groups as are needed for all speeds. Undefined for courses that are not
    /// lowered, and beyond the last speed.
    rows: Vec<Lanes<f32>>,
    /// By group of courses: a bit for each lowered course.
    pub(super) lowered: Vec<u16>,
}

impl Table {
    /// A table of a function's utilities.
    pub fn of(grid: &Grid, utility: impl Fn(usize, usize) -> f32) -> Table {
        let mut table = Table::default();
        table.clear(grid);
        for k in (0..grid.courses()).filter(|k| (0..grid.speeds()).any(|j| utility(*k, j) != 100.0))
        {
            for (j, lowered) in table
                .lowered_mut(k)
                .iter_mut()
                .flat_map(|lanes| &mut lanes.0)
                .enumerate()
                .take(grid.speeds())
            {
                *lowered = utility(k, j);
            }
        }
        table
    }

    /// Resets all utilities to 100 on a grid.
    pub fn clear(&mut self, grid: &Grid) {
        (self.courses, self.speeds) = (grid.courses(), grid.speeds());
        self.rows
            .resize(self.courses * self.lanes(), Lanes::splat(100.0));
        self.lowered.clear();
        self.lowered.resize(self.courses.div_ceil(LANES), 0);
    }

    /// The utilities of a course by speed, in groups, to be lowered.
    #[inline(always)]
    pub(crate) fn lowered_mut(&mut self, k: usize) -> &mut [Lanes<f32>] {
        let lanes = self.lanes();
        let row = &mut self.rows[k * lanes..][..lanes];
        let lowered = &mut self.lowered[k / LANES];
        if *lowered >> (k % LANES) & 1 == 0 {
            // Fill them on first use, so that `clear` costs nothing per course.
            *lowered |= 1 << (k % LANES);
            row.fill(Lanes::splat(100.0));
        }
        row
    }

    /// The utilities of a lowered course by speed, in groups.
    #[inline(always)]
    pub(super) fn row(&self, k: usize) -> &[Lanes<f32>] {
        &self.rows[k * self.lanes()..][..self.lanes()]
    }

    /// The utility of course `k` at speed `j`.
    pub fn utility(&self, k: usize, j: usize) -> f32 {
        if self.lowered[k / LANES] >> (k % LANES) & 1 == 0 {
            100.0
        } else {
            self.row(k)[j / LANES].0[j % LANES]
        }
    }

    /// The number of groups needed for all speeds.
    fn lanes(&self) -> usize {
        self.speeds.div_ceil(LANES)
    }
}
