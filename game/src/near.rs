//! Which boats are near one another: every pair within a reach, in a stated order.
//!
//! Small fleets are compared all with all. Larger ones are sorted into square cells first, so that the
//! cost grows with the number of boats and of near pairs, not with the square of the fleet.

use crate::frame::Ned;

/// Two vehicles (indices, `a < b`) and their squared distance in m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// The lower index.
    pub a: u16,
    /// The higher index.
    pub b: u16,
    /// Squared distance, m².
    pub distance_squared: f64,
}

/// Finds near pairs; keeps its memory between calls.
#[derive(Clone, Debug, Default)]
pub struct Near {
    pairs: Vec<Pair>,
    /// Cell of each vehicle, and vehicles sorted by cell.
    cells: Vec<(i32, i32, u16)>,
}

/// Up to this many boats are compared all with all.
const FEW: usize = 24;

impl Near {
    /// All pairs closer than `reach_m`, sorted by `a`, then `b`. Positions must be finite.
    pub fn pairs(&mut self, at: impl Fn(usize) -> Ned, count: usize, reach_m: f64) -> &[Pair] {
        self.pairs.clear();
        if count <= FEW {
            self.compare_all(&at, count, reach_m);
        } else {
            self.compare_cells(&at, count, reach_m);
        }
        &self.pairs
    }

    fn compare_all(&mut self, at: &impl Fn(usize) -> Ned, count: usize, reach_m: f64) {
        for a in 0..count {
            let here = at(a);
            for b in a + 1..count {
                push_if_near(&mut self.pairs, (a as u16, b as u16), here.distance_squared(at(b)), reach_m);
            }
        }
    }

    fn compare_cells(&mut self, at: &impl Fn(usize) -> Ned, count: usize, reach_m: f64) {
        if reach_m <= 0.0 {
            return;
        }
        // A shade wider than the reach, so that rounding never puts near boats two cells apart.
        let cell_m = reach_m * 1.000_001;
        // Boats that are astray for millions of cells share the last one: it is compared like any other.
        let cell = |metres: f64| (metres / cell_m).floor().clamp(-1e9, 1e9) as i32;
        self.cells.clear();
        self.cells.extend((0..count).map(|i| {
            let here = at(i);
            (cell(here.north), cell(here.east), i as u16)
        }));
        self.cells.sort_unstable();
        for (i, &(north, east, a)) in self.cells.iter().enumerate() {
            let here = at(usize::from(a));
            // Forward half of the neighbourhood: the rest of this cell and the one to the east, then the
            // row to the north.
            let next_row = self.cells.partition_point(|&(n, e, _)| (n, e) < (north + 1, east - 1));
            let this = self.cells[i + 1..].iter().take_while(|&&(n, e, _)| n == north && e <= east + 1);
            let next = self.cells[next_row..].iter().take_while(|&&(n, e, _)| n == north + 1 && e <= east + 1);
            for &(_, _, b) in this.chain(next) {
                let distance_squared = here.distance_squared(at(usize::from(b)));
                push_if_near(&mut self.pairs, (a.min(b), a.max(b)), distance_squared, reach_m);
            }
        }
        self.pairs.sort_unstable_by_key(|pair| (pair.a, pair.b));
    }
}

#[inline]
fn push_if_near(pairs: &mut Vec<Pair>, (a, b): (u16, u16), distance_squared: f64, reach_m: f64) {
    if distance_squared < reach_m * reach_m {
        pairs.push(Pair { a, b, distance_squared });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Stream;

    #[test]
    fn cells_find_the_same_pairs_as_comparing_all() {
        for (seed, count) in [(1, 25), (2, 60), (3, 300)] {
            let mut stream = Stream::new(seed, "near");
            let fleet: Vec<Ned> = (0..count)
                .map(|_| Ned { north: stream.between(-40.0, 40.0), east: stream.between(-80.0, 80.0) })
                .collect();
            let (mut all, mut cells) = (Near::default(), Near::default());
            all.compare_all(&|i| fleet[i], count, 7.0);
            let got = cells.pairs(|i| fleet[i], count, 7.0);
            assert_eq!(got, all.pairs, "seed {seed}");
            assert!(!got.is_empty());
        }
    }

    #[test]
    fn boats_astray_and_boats_that_need_no_reach_do_no_harm() {
        let fleet: Vec<Ned> = (0..30).map(|i| Ned { north: 1e300, east: f64::from(i) * -1e12 }).collect();
        let mut near = Near::default();
        assert_eq!(near.pairs(|i| fleet[i], 30, 7.0), []);
        assert_eq!(near.pairs(|_| fleet[3], 30, 7.0).len(), 30 * 29 / 2);
        assert_eq!(near.pairs(|_| fleet[3], 30, 0.0), []);
    }
}
