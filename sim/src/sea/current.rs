//! The water's own motion at a place and a time: what a scenario states, summed.
//!
//! What is the same everywhere (mean, wander, tide) is worked out once a tick by [`CurrentField::at_time`]; what is not
//! (shear, eddies) by boat.

use super::eddy::{self, Vortex};
use super::markov::{Markov, STEPS_PER_LENGTH};
use super::tape::{Process, Tape};
use game::SimTime;
use game::field::Field;
use game::frame::{Ned, body_from_ned};
use game::math;
use game::sea::{Current, Shear, Tide, Wander};
use game::stream::Noise;
use std::f64::consts::TAU;

/// The current over a field.
#[derive(Clone, Debug)]
pub struct CurrentField {
    mean_m_s: Ned,
    wander: Option<(Wander, Tape)>,
    tide: Option<Tide>,
    shear: Option<Shear>,
    eddies: Vec<Vortex>,
}

/// The current over a field at one moment.
#[derive(Clone, Copy, Debug)]
pub struct CurrentNow<'a> {
    /// What is the same everywhere, m/s.
    pub uniform_m_s: Ned,
    shear: Option<Shear>,
    eddies: &'a [Vortex],
}

impl CurrentField {
    /// The current over `field`.
    #[must_use]
    pub fn new(current: &Current, field: &Field, seed: u64) -> CurrentField {
        let drawn = current.eddies_by_lot.map(|lot| eddy::draw(&lot, field, seed)).unwrap_or_default();
        let tape = || Tape::new(Process::Markov(Markov::new(Noise::new(seed, "current"))), 0.0);
        CurrentField {
            mean_m_s: current.mean_m_s,
            wander: current.wander.map(|wander| (wander, tape())),
            tide: current.tide,
            shear: current.shear,
            eddies: current.eddies.iter().chain(&drawn).map(Vortex::new).collect(),
        }
    }

    /// Has at hand what [`CurrentField::at_time`] needs at `now`. Only for speed: without it, that gives the same bits.
    pub fn prepare(&mut self, now: SimTime) {
        if let Some((wander, tape)) = &mut self.wander {
            let place = wander_place(wander, now);
            tape.hold(place, place);
        }
    }

    /// The current at `now`.
    #[must_use]
    pub fn at_time(&self, now: SimTime) -> CurrentNow<'_> {
        let mut uniform_m_s = self.mean_m_s;
        if let Some((wander, tape)) = &self.wander {
            let mean_m_s = self.mean_m_s.dot(wander.toward);
            let wandering_m_s = mean_m_s + wander.sigma_m_s * tape.at(wander_place(wander, now)).0;
            let speed_m_s = wandering_m_s.max(wander.speed_m_s.0).min(wander.speed_m_s.1);
            uniform_m_s = uniform_m_s + wander.toward.scaled(speed_m_s - mean_m_s);
        }
        if let Some(tide) = self.tide {
            let turns = now.as_s() / tide.period_s + tide.phase;
            let (sin, _) = math::sin_cos(TAU * (turns - turns.floor()));
            uniform_m_s = uniform_m_s + tide.flood_m_s.scaled(sin);
        }
        CurrentNow { uniform_m_s, shear: self.shear, eddies: &self.eddies }
    }
}

/// Where on its tape the wander stands at `now`.
fn wander_place(wander: &Wander, now: SimTime) -> f64 {
    now.as_s() / wander.time_s * STEPS_PER_LENGTH
}

impl CurrentNow<'_> {
    /// The water's velocity at a place, m/s.
    #[inline]
    #[must_use]
    pub fn at(&self, place: Ned) -> Ned {
        let sheared = self.shear.map_or(self.uniform_m_s, |shear| {
            self.uniform_m_s + shear.toward.scaled(shear.per_s * (place - shear.origin).dot(shear.across))
        });
        self.eddies.iter().fold(sheared, |sum, vortex| sum + vortex.at(place))
    }

    /// The water's velocity (m/s) and rotation (rad/s clockwise) as a hull of `length_m` at `place` feels them.
    ///
    /// From the water at the two points of Gauss and Legendre, length / (2 √3) ahead and astern of midships: the mean
    /// over the hull's length and the rate that fits it best are exact where the flow changes quadratically along it.
    #[inline]
    #[must_use]
    pub fn over_hull(&self, place: Ned, sin_cos_psi: (f64, f64), length_m: f64) -> (Ned, f64) {
        if self.shear.is_none() && self.eddies.is_empty() {
            return (self.uniform_m_s, 0.0);
        }
        let apart_m = length_m / 3.0_f64.sqrt();
        let (sin, cos) = sin_cos_psi;
        let ahead = Ned { north: cos, east: sin }.scaled(0.5 * apart_m);
        let (fore, aft) = (self.at(place + ahead), self.at(place - ahead));
        let across_m_s = body_from_ned(sin_cos_psi, fore - aft).starboard;
        ((fore + aft).scaled(0.5), across_m_s / apart_m)
    }
}
