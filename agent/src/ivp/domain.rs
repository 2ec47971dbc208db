//! A space of decisions in any few variables, each with finitely many values.

use thiserror::Error;

/// The most axes of a domain.
pub const AXES_MAX: usize = 6;

/// The number of a value on each axis; axes that a domain does not have are 0.
pub type Point = [u16; AXES_MAX];

/// One variable: evenly spaced values from `low` to `high`.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// What it is called.
    pub name: String,
    /// The first value, in the variable's own unit.
    pub low: f64,
    /// The last value, in the variable's own unit.
    pub high: f64,
    /// How many values there are.
    pub points: usize,
}

impl Axis {
    /// Value number `i`, which may lie between two.
    #[must_use]
    pub fn value(&self, i: f64) -> f64 {
        if self.points > 1 { self.low + (self.high - self.low) * i / (self.points - 1) as f64 } else { self.low }
    }
}

/// Why axes make no domain.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DomainError {
    /// Too few or too many.
    #[error("{0} axes, allowed are 1 to {AXES_MAX}")]
    Axes(usize),
    /// An axis with too few or too many values.
    #[error("axis {0} has {1} points, allowed are 1 to 65536")]
    Points(String, usize),
    /// An axis whose ends are none.
    #[error("axis {0} goes from {1} to {2}, allowed are finite numbers, the lower one first")]
    Ends(String, f64, f64),
    /// Two axes of one name.
    #[error("two axes are called {0}")]
    Name(String),
}

/// Up to six variables.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    axes: Vec<Axis>,
}

impl Domain {
    /// The domain with these axes.
    ///
    /// # Errors
    /// If there are too few or too many axes or points, ends that are no numbers, or a name that occurs twice.
    pub fn new(axes: Vec<Axis>) -> Result<Domain, DomainError> {
        if !(1..=AXES_MAX).contains(&axes.len()) {
            return Err(DomainError::Axes(axes.len()));
        }
        for (i, axis) in axes.iter().enumerate() {
            if !(1..=1 << 16).contains(&axis.points) {
                return Err(DomainError::Points(axis.name.clone(), axis.points));
            }
            if !(axis.low.is_finite() && axis.high.is_finite() && axis.low <= axis.high) {
                return Err(DomainError::Ends(axis.name.clone(), axis.low, axis.high));
            }
            if axes[..i].iter().any(|other| other.name == axis.name) {
                return Err(DomainError::Name(axis.name.clone()));
            }
        }
        Ok(Domain { axes })
    }

    /// The axes.
    #[must_use]
    pub fn axes(&self) -> &[Axis] {
        &self.axes
    }

    /// The number of the axis with this name.
    #[must_use]
    pub fn axis(&self, name: &str) -> Option<usize> {
        self.axes.iter().position(|axis| axis.name == name)
    }

    /// The last point on every axis.
    #[must_use]
    pub fn last(&self) -> Point {
        std::array::from_fn(|i| self.axes.get(i).map_or(0, |axis| (axis.points - 1) as u16))
    }
}
