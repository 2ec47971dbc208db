//! A function in pieces: boxes that tile a domain, each with a linear function inside.
//!
//! On a box the utility is `at_zero + sum_i slope_i x_i`, where `x_i` is the *number* of the value on axis `i`. A piece is
//! fitted to a function by least squares over the corners of its box and, where it is a point of the grid, its centre.
//! Seen from the centre these samples lie in symmetric pairs, so the normal equations fall apart: the slope on an axis is
//! the mean of the samples at its high side less the mean at its low side, over the width, and the value at the centre is
//! the mean of all samples. A box of a single point is exact.
//!
//! A fit begins with a uniform tiling and then halves, again and again, the piece that is most in error, across its longest
//! side (Benjamin 2002 calls this smart refinement).

use super::domain::{AXES_MAX, Domain, Point};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use thiserror::Error;

/// The steepest slope of a piece, utility for each step. With it no sum of weighted pieces overflows.
pub const SLOPE_MAX: f64 = 500.0;

/// The largest value of a piece at zero.
pub const AT_ZERO_MAX: f64 = 1e8;

/// A box of grid points, ends included, with a linear function inside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Piece {
    /// The lowest point of the box.
    pub low: Point,
    /// The highest point of the box.
    pub high: Point,
    /// Utility for each step on an axis; 0 on axes the function does not know.
    pub slope: [f64; AXES_MAX],
    /// Utility if all numbers were 0.
    pub at_zero: f64,
}

impl Piece {
    /// Utility at a point.
    #[must_use]
    pub fn utility(&self, at: &Point) -> f64 {
        (0..AXES_MAX).fold(self.at_zero, |sum, i| sum + self.slope[i] * f64::from(at[i]))
    }

    /// Whether a point lies in the box.
    #[must_use]
    pub fn holds(&self, at: &Point) -> bool {
        (0..AXES_MAX).all(|i| self.low[i] <= at[i] && at[i] <= self.high[i])
    }

    fn overlaps(&self, other: &Piece) -> bool {
        (0..AXES_MAX).all(|i| self.low[i] <= other.high[i] && other.low[i] <= self.high[i])
    }
}

/// Why pieces make no function.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum PiecewiseError {
    /// A box that is empty or leaves the domain.
    #[error("piece {0} is empty or leaves the domain")]
    Outside(usize),
    /// A number that is none.
    #[error("piece {0} has a slope beyond {SLOPE_MAX}, a value beyond {AT_ZERO_MAX}, or one that is no number")]
    Number(usize),
    /// Two boxes on one point.
    #[error("pieces {0} and {1} overlap")]
    Overlap(usize, usize),
    /// Points without a box.
    #[error("{0} points of the domain are in no piece")]
    Gap(u128),
}

/// How finely a function is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Length of the boxes of the uniform tiling, points on each axis the function knows.
    pub side: usize,
    /// Boxes are halved until there are so many.
    pub pieces_max: usize,
    /// Boxes in error by no more than this at their samples are left alone, in points of utility.
    pub tolerance: f64,
}

/// A piecewise linear function of a domain.
#[derive(Clone, Debug, PartialEq)]
pub struct Piecewise {
    pieces: Vec<Piece>,
}

impl Piecewise {
    /// The function with these pieces.
    ///
    /// # Errors
    /// If they do not tile the domain, or a number is none.
    pub fn new(domain: &Domain, pieces: Vec<Piece>) -> Result<Piecewise, PiecewiseError> {
        let last = domain.last();
        let mut gap: u128 = last.iter().map(|&x| u128::from(x) + 1).product();
        for (i, piece) in pieces.iter().enumerate() {
            if (0..AXES_MAX).any(|a| piece.low[a] > piece.high[a] || piece.high[a] > last[a]) {
                return Err(PiecewiseError::Outside(i));
            }
            let small = piece.slope.iter().all(|slope| slope.abs() <= SLOPE_MAX) && piece.at_zero.abs() <= AT_ZERO_MAX;
            if !small {
                return Err(PiecewiseError::Number(i));
            }
            if let Some(other) = pieces[..i].iter().position(|other| piece.overlaps(other)) {
                return Err(PiecewiseError::Overlap(other, i));
            }
            gap -= (0..AXES_MAX).map(|a| u128::from(piece.high[a] - piece.low[a]) + 1).product::<u128>();
        }
        if gap > 0 { Err(PiecewiseError::Gap(gap)) } else { Ok(Piecewise { pieces }) }
    }

    /// A function of the axes with these numbers, fitted. It is asked with a value for each of them, in their order, on
    /// the grid or between its points, and gives a utility of 0 to 100; others are brought into that, and what is no
    /// number counts 0.
    ///
    /// # Panics
    /// With an axis the domain does not have, or boxes of no length.
    #[must_use]
    pub fn fitted(domain: &Domain, axes: &[usize], fit: Fit, utility: impl Fn(&[f64]) -> f64) -> Piecewise {
        assert!(fit.side > 0, "boxes of no length");
        assert!(axes.iter().all(|&a| a < domain.axes().len()), "axes {axes:?} of {}", domain.axes().len());
        let fitter = Fitter { domain, axes, utility };
        let mut pieces: Vec<Fitted> = Vec::new();
        let last = domain.last();
        let mut low = Point::default();
        loop {
            let mut high = last;
            for &a in axes {
                high[a] = (usize::from(low[a]) + fit.side - 1).min(last[a].into()) as u16;
            }
            pieces.push(fitter.fit(low, high));
            // The next box: as on a counter, the last axis goes first.
            let Some(&next) = axes.iter().rev().find(|&&a| high[a] < last[a]) else { break };
            let place = axes.iter().rposition(|&a| a == next).unwrap_or(0);
            low[next] = high[next] + 1;
            axes[place + 1..].iter().for_each(|&a| low[a] = 0);
        }
        let mut worst: BinaryHeap<Fitted> = pieces.into();
        while worst.len() < fit.pieces_max && worst.peek().is_some_and(|piece| piece.error > fit.tolerance) {
            let Some(Fitted { piece, .. }) = worst.pop() else { break };
            let Some(side) = axes.iter().copied().max_by_key(|&a| piece.high[a] - piece.low[a]) else { break };
            let middle = piece.low[side] + (piece.high[side] - piece.low[side]) / 2;
            let (mut high, mut low) = (piece.high, piece.low);
            (high[side], low[side]) = (middle, middle + 1);
            worst.push(fitter.fit(piece.low, high));
            worst.push(fitter.fit(low, piece.high));
        }
        let mut pieces: Vec<Piece> = worst.into_iter().map(|fitted| fitted.piece).collect();
        pieces.sort_by_key(|piece| piece.low);
        Piecewise { pieces }
    }

    /// The pieces.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// Utility at a point of the domain, as the pieces have it.
    #[must_use]
    pub fn utility(&self, at: &Point) -> f64 {
        self.pieces.iter().find(|piece| piece.holds(at)).map_or(0.0, |piece| piece.utility(at))
    }
}

/// A piece, and how far it is off at its samples.
#[derive(Clone, Copy, Debug)]
struct Fitted {
    piece: Piece,
    error: f64,
}

impl Ord for Fitted {
    /// By error; equal ones by place, so that a fit is always the same.
    fn cmp(&self, other: &Fitted) -> Ordering {
        self.error.total_cmp(&other.error).then_with(|| other.piece.low.cmp(&self.piece.low))
    }
}

impl PartialOrd for Fitted {
    fn partial_cmp(&self, other: &Fitted) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Fitted {
    fn eq(&self, other: &Fitted) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Fitted {}

/// A function that is being fitted.
struct Fitter<'a, F> {
    domain: &'a Domain,
    axes: &'a [usize],
    utility: F,
}

impl<F: Fn(&[f64]) -> f64> Fitter<'_, F> {
    /// The best linear function on a box.
    fn fit(&self, low: Point, high: Point) -> Fitted {
        let corners = 1_usize << self.axes.len();
        let mut samples: Vec<(Point, f64)> = Vec::with_capacity(corners + 1);
        let mut piece = Piece { low, high, ..Piece::default() };
        for corner in 0..corners {
            let mut at = low;
            for (bit, &a) in self.axes.iter().enumerate() {
                at[a] = if corner >> bit & 1 == 1 { high[a] } else { low[a] };
            }
            let utility = self.at(&at);
            samples.push((at, utility));
            for (bit, &a) in self.axes.iter().enumerate() {
                let sign = if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
                // Half of the corners are on either side.
                piece.slope[a] += sign * utility / (corners as f64 / 2.0) / f64::from((high[a] - low[a]).max(1));
            }
        }
        let centre: Point = std::array::from_fn(|a| low[a] + (high[a] - low[a]) / 2);
        let centre_utility = self.at(&centre);
        if self.axes.iter().all(|&a| (high[a] - low[a]).is_multiple_of(2)) {
            samples.push((centre, centre_utility));
        }
        let mean = samples.iter().map(|(_, utility)| utility).sum::<f64>() / samples.len() as f64;
        piece.at_zero = self.axes.iter().fold(mean, |sum, &a| {
            let middle = (f64::from(low[a]) + f64::from(high[a])) / 2.0;
            sum - piece.slope[a] * middle
        });
        let off = |(at, utility): &(Point, f64)| (piece.utility(at) - utility).abs();
        let error = samples.iter().map(off).fold(off(&(centre, centre_utility)), f64::max);
        // A single point has nothing to halve.
        let single = low == high || self.axes.iter().all(|&a| low[a] == high[a]);
        Fitted { piece, error: if single { 0.0 } else { error } }
    }

    fn at(&self, at: &Point) -> f64 {
        let mut values = [0.0; AXES_MAX];
        for (value, &a) in values.iter_mut().zip(self.axes) {
            *value = self.domain.axes()[a].value(f64::from(at[a]));
        }
        let utility = (self.utility)(&values[..self.axes.len()]);
        f64::from(super::fixed::utility(utility))
    }
}
