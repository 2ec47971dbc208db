//! Finds pairs of boats within a given reach, in a defined order.
//!
//! Small fleets are compared pair by pair. Larger fleets are first sorted into square cells: the
//! cost then grows with the number of boats and near pairs, not with the square of the fleet.

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

/// Finds near pairs; reuses its memory between calls.
#[derive(Clone, Debug, Default)]
pub struct Near {
    pairs: Vec<Pair>,
    /// Vehicles sorted by cell.
    keys: Vec<u64>,
}

/// Maximum number of boats for which every pair is compared.
const FEW: usize = 32;

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
                push_if_near(
                    &mut self.pairs,
                    (a as u16, b as u16),
                    here.distance_squared(at(b)),
                    reach_m,
                );
            }
        }
    }

    fn compare_cells(&mut self, at: &impl Fn(usize) -> Ned, count: usize, reach_m: f64) {
        if reach_m <= 0.0 {
            return;
        }
        self.keys.clear();
        self.keys
            .extend((0..count).map(|i| key(at(i), reach_m, i as u16)));
        self.keys.sort_unstable();
        let mut row_to_the_north = 0;
        for (i, &key) in self.keys.iter().enumerate() {
            let here = at(vehicle(key));
            let a = key as u16;
            // Forward half of the neighbourhood: the rest of this cell and the next one to the
            // east, then three cells to the north. All of these positions advance with the list.
            let cell = key & !u64::from(u16::MAX);
            let start = cell + ROW - COLUMN;
            let end = cell + ROW + 2 * COLUMN;
            while self
                .keys
                .get(row_to_the_north)
                .is_some_and(|key| *key < start)
            {
                row_to_the_north += 1;
            }
            let this = self.keys[i + 1..]
                .iter()
                .take_while(|key| **key < cell + 2 * COLUMN);
            let north = self.keys[row_to_the_north..]
                .iter()
                .take_while(|key| **key < end);
            for &key in this.chain(north) {
                let there = at(vehicle(key));
                let b = key as u16;
                push_if_near(
                    &mut self.pairs,
                    (a.min(b), a.max(b)),
                    here.distance_squared(there),
                    reach_m,
                );
            }
        }
        self.pairs.sort_unstable_by_key(|pair| (pair.a, pair.b));
    }
}

/// Difference of keys to the next cell east.
const COLUMN: u64 = 1 << 16;
/// Difference of keys to the next cell north.
const ROW: u64 = 1 << 40;

/// A vehicle and its cell as one number: 24 bits for the row, 24 for the column, 16 for the
/// vehicle.
fn key(at: Ned, reach_m: f64, vehicle: u16) -> u64 {
    // Cells are slightly wider than the reach, so that rounding never puts near boats two cells
    // apart.
    let cell_m = reach_m * 1.000_001;
    // Boats millions of cells away share the outermost cell, which is searched like any other.
    let cell = |metres: f64| ((metres / cell_m).floor().clamp(-8e6, 8e6) + 8_388_608.0) as u64;
    cell(at.north) * ROW + cell(at.east) * COLUMN + u64::from(vehicle)
}

fn vehicle(key: u64) -> usize {
    usize::from(key as u16)
}

#[inline]
fn push_if_near(pairs: &mut Vec<Pair>, (a, b): (u16, u16), distance_squared: f64, reach_m: f64) {
    if distance_squared < reach_m * reach_m {
        pairs.push(Pair {
            a,
            b,
            distance_squared,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Stream;

    #[test]
    fn cells_find_the_same_pairs_as_comparing_all() {
        for (seed, count) in [(1, 33), (2, 60), (3, 300)] {
            let mut stream = Stream::new(seed, "near");
            let fleet: Vec<Ned> = (0..count)
                .map(|_| Ned {
                    north: stream.between(-40.0, 40.0),
                    east: stream.between(-80.0, 80.0),
                })
                .collect();
            let mut all = Near::default();
            let mut cells = Near::default();
            all.compare_all(&|i| fleet[i], count, 7.0);
            let got = cells.pairs(|i| fleet[i], count, 7.0);
            assert_eq!(got, all.pairs, "seed {seed}");
            assert!(!got.is_empty());
        }
    }

    #[test]
    fn boats_astray_and_boats_that_need_no_reach_do_no_harm() {
        let fleet: Vec<Ned> = (0..40)
            .map(|i| Ned {
                north: 1e300,
                east: f64::from(i) * -1e12,
            })
            .collect();
        let mut near = Near::default();
        assert_eq!(near.pairs(|i| fleet[i], 40, 7.0), []);
        assert_eq!(near.pairs(|_| fleet[3], 40, 7.0).len(), 40 * 39 / 2);
        assert_eq!(near.pairs(|_| fleet[3], 40, 0.0), []);
    }
}
