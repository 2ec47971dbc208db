//! The water: what a boat feels of it at a place and a time.
//!
//! The one door through which the sea acts. Calm water, with or without a steady current.

pub mod current;
pub mod eddy;
pub mod gust_spectrum;
mod markov;
mod tape;
pub mod wind;
pub mod windage;

use game::frame::Ned;
use game::sea::Sea;

/// The sea of a game.
#[derive(Clone, Debug)]
pub struct SeaModel {
    current_m_s: Ned,
}

/// The sea at one boat.
#[derive(Clone, Copy, Debug)]
pub struct SeaSample {
    /// The velocity of the water over the ground, m/s.
    pub current_m_s: Ned,
}

impl SeaModel {
    /// The model of this sea.
    #[must_use]
    pub fn new(sea: &Sea) -> SeaModel {
        SeaModel { current_m_s: sea.current.mean_m_s }
    }

    /// The sea at a boat.
    #[inline]
    #[must_use]
    pub fn at(&self, _at: Ned) -> SeaSample {
        SeaSample { current_m_s: self.current_m_s }
    }
}
