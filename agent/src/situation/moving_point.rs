//! A moving point: a place on the water, with its velocity.

use primitives::Ned;

/// A place, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct MovingPoint {
    pub(crate) at: Ned,
    /// Velocity over the ground, m/s.
    pub(crate) velocity: Ned,
}
