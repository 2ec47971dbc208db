//! A table indexed by heading, with an entry every five degrees and linear interpolation.

use crate::lanes::{FOLD, Lanes, ROW};
use std::f64::consts::TAU;

/// Number of headings in the table.
// For the shipped boats, interpolation between 72 headings has an error of at most 0.4 % (root mean
// square). For a hull three wavelengths long it is up to 3 %, but such waves have little effect on
// such a hull.
pub(super) const BINS: usize = 72;

/// The heading of a bin, rad.
pub(super) fn of_bin(bin: usize) -> f64 {
    bin as f64 * (TAU / BINS as f64)
}

/// The heading in units of bins: the bin below, and the fraction up to the next.
#[inline(always)]
fn place(heading_rad: f64) -> (usize, f64) {
    let bins = heading_rad * (BINS as f64 / TAU);
    let below = bins.floor();
    // A NaN heading selects bin 0 and yields NaN.
    (
        (below as i64).rem_euclid(BINS as i64) as usize,
        bins - below,
    )
}

/// Four numbers for each of four components, between one bin and the next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    from: Lanes<f32>,
    /// Their increase up to the next bin.
    gain: Lanes<f32>,
}

impl Segment {
    /// The numbers at `fraction` (0 to 1) of the segment.
    #[inline(always)]
    pub(super) fn at_fraction(&self, fraction: Lanes<f32>) -> Lanes<f32> {
        self.from + self.gain * fraction
    }

    /// Their derivatives with respect to the heading, 1/rad.
    #[inline(always)]
    pub(super) fn per_rad(&self) -> Lanes<f32> {
        self.gain * Lanes::<f32>::splat((BINS as f64 / TAU) as f32)
    }
}

/// Rows of numbers that depend on the heading; rows of one bin are adjacent.
#[derive(Clone, Debug)]
pub(super) struct HeadingTable {
    rows: usize,
    lines: Vec<Segment>,
}

impl HeadingTable {
    /// A table with this many `rows`. `numbers` returns four numbers for a bin and a component;
    /// beyond the last component they are 0.
    pub(super) fn new(rows: usize, numbers: impl Fn(usize, usize) -> [f64; FOLD]) -> HeadingTable {
        let number = |i: usize| {
            let bin = i / rows;
            let row = i % rows;
            let parts: [[f64; FOLD]; ROW] =
                std::array::from_fn(|lane| numbers(bin, row * ROW + lane));
            Lanes::of_row(std::array::from_fn(|part| {
                parts.map(|parts| parts[part] as f32)
            }))
        };
        let at: Vec<Lanes<f32>> = (0..BINS * rows).map(number).collect();
        let line = |i: usize| Segment {
            from: at[i],
            gain: at[(i + rows) % at.len()] - at[i],
        };
        HeadingTable {
            rows,
            lines: (0..at.len()).map(line).collect(),
        }
    }

    /// The rows for a heading, and the heading's fraction of the way from their bin to the next.
    #[inline(always)]
    pub(super) fn at(&self, heading_rad: f64) -> (&[Segment], Lanes<f32>) {
        let (bin, fraction) = place(heading_rad);
        (
            &self.lines[bin * self.rows..(bin + 1) * self.rows],
            Lanes::splat(fraction as f32),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_heading_finds_the_bin_below_it_whichever_way_round_it_is_written() {
        for (heading_deg, bin, fraction) in [
            (0.0, 0, 0.0),
            (7.5, 1, 0.5),
            (-2.5, 71, 0.5),
            (-362.5, 71, 0.5),
            (357.5, 71, 0.5),
            (720.0 + 91.0, 18, 0.2),
        ] {
            let (got_bin, got_fraction) = place(f64::to_radians(heading_deg));
            assert!(
                got_bin == bin && (got_fraction - fraction).abs() < 1e-9,
                "{heading_deg}: {got_bin} {got_fraction}"
            );
        }
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            assert!(place(odd).0 < BINS, "{odd}");
        }
    }
}
