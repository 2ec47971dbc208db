//! A piecewise linear function with an index, so that look-ups need no search.

/// Maximum number of cells in the index.
const CELLS_MAX: usize = 256;

/// Linear interpolation through measured points; constant beyond the ends.
#[derive(Clone, Debug)]
pub(crate) struct PiecewiseLinear {
    pieces: Vec<Piece>,
    /// The piece at the start of each of the equally wide cells.
    index: Vec<u16>,
    per_x: f64,
    first: (f64, f64),
    last: (f64, f64),
}

/// One piece: `y = at.1 + slope * (x - at.0)` from `at.0` to below `end`.
#[derive(Clone, Copy, Debug)]
struct Piece {
    at: (f64, f64),
    slope: f64,
    end: f64,
}

impl PiecewiseLinear {
    /// The interpolation through `points`, in strictly ascending order of their first numbers.
    ///
    /// # Panics
    /// If there are fewer than two points.
    pub(crate) fn new(points: &[(f64, f64)]) -> PiecewiseLinear {
        assert!(points.len() >= 2, "expected at least two points");
        let piece = |ends: &[(f64, f64)]| {
            let a = ends[0];
            let b = ends[1];
            Piece {
                at: a,
                slope: (b.1 - a.1) / (b.0 - a.0),
                end: b.0,
            }
        };
        let pieces: Vec<Piece> = points.windows(2).map(piece).collect();
        let first = points[0];
        let last = points[points.len() - 1];
        let width = last.0 - first.0;
        let narrowest = pieces
            .iter()
            .map(|piece| piece.end - piece.at.0)
            .fold(width, f64::min);
        // Cells are as fine as the narrowest piece, so that a cell contains at most one border.
        let cells = ((width / narrowest).ceil() as usize).clamp(1, CELLS_MAX);
        let piece_at = |x: f64| {
            pieces[..pieces.len() - 1]
                .iter()
                .take_while(|piece| piece.end <= x)
                .count()
        };
        let index = (0..cells)
            .map(|cell| piece_at(first.0 + width * cell as f64 / cells as f64) as u16)
            .collect();
        PiecewiseLinear {
            pieces,
            index,
            per_x: cells as f64 / width,
            first,
            last,
        }
    }

    /// The value at `x`.
    #[inline]
    pub(crate) fn at(&self, x: f64) -> f64 {
        if x <= self.first.0 {
            return self.first.1;
        }
        if x >= self.last.0 {
            return self.last.1;
        }
        let cell = ((x - self.first.0) * self.per_x) as usize;
        let mut i = usize::from(self.index[cell.min(self.index.len() - 1)]);
        // A cell contains at most one border unless the pieces are very uneven. Unlike a branch,
        // the addition is never mispredicted.
        i += usize::from(x >= self.pieces[i].end);
        while x >= self.pieces[i].end {
            i += 1;
        }
        let piece = &self.pieces[i];
        piece.at.1 + piece.slope * (x - piece.at.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use primitives::math::interpolate;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_agrees_with_a_search(
            steps in prop::collection::vec((1e-6..1.0, -5.0..5.0), 2..40),
            tiny in any::<prop::sample::Index>(),
            share in prop::collection::vec(-0.1..1.1, 50),
        ) {
            let mut x = -1.0;
            let mut points: Vec<(f64, f64)> = Vec::new();
            let tiny = tiny.index(steps.len());
            for (i, (step, y)) in steps.into_iter().enumerate() {
                x += if i == tiny { 1e-7 } else { step };
                points.push((x, y));
            }
            let line = PiecewiseLinear::new(&points);
            let lo = points[0].0;
            let hi = points[points.len() - 1].0;
            let borders = points.iter().map(|p| p.0);
            for x in share.into_iter().map(|share| lo + share * (hi - lo)).chain(borders) {
                prop_assert!((line.at(x) - interpolate(points.iter().copied(), x)).abs() < 1e-12, "at {}", x);
            }
        }
    }
}
