//! The current at a place and time: the sum of mean, wander, tide, shear and eddies.
//!
//! [`CurrentField::at_time`] computes the uniform part (mean, wander, tide) once per tick; the
//! local part (shear, eddies) is computed per boat.

use super::cached_process::CachedProcess;
use super::eddy::{self, Vortex};
use super::gauss_markov::{GaussMarkov, STEPS_PER_LENGTH};
use primitives::frame::{Ned, Rotation};
use primitives::reseed::Seeds;
use primitives::{SimTime, math};
use rules::field::Field;
use scenario::sea::{Current, Shear, Tide, Wander};
use std::f64::consts::TAU;

/// The current over a field.
#[derive(Clone, Debug)]
pub struct CurrentField {
    mean_m_s: Ned,
    wander: Option<(Wander, CachedProcess)>,
    tide: Option<Tide>,
    shear: Option<Shear>,
    eddies: Vec<Vortex>,
}

/// The current over a field at one moment.
#[derive(Clone, Copy, Debug)]
pub struct CurrentNow<'a> {
    /// The uniform part, m/s.
    pub uniform_m_s: Ned,
    shear: Option<Shear>,
    eddies: &'a [Vortex],
}

impl CurrentField {
    /// The current over `field`.
    pub fn new(current: &Current, field: &Field, seeds: &Seeds) -> CurrentField {
        let drawn = current
            .random_eddies
            .map(|random| eddy::draw(&random, field, seeds.first()))
            .unwrap_or_default();
        let process = |wander: &Wander| {
            let process = GaussMarkov::new(seeds, "current", |now| wander_place(wander, now));
            CachedProcess::new(process, 0.0)
        };
        CurrentField {
            mean_m_s: current.mean_m_s,
            wander: current.wander.map(|wander| (wander, process(&wander))),
            tide: current.tide,
            shear: current.shear,
            eddies: current
                .eddies
                .iter()
                .chain(&drawn)
                .map(Vortex::new)
                .collect(),
        }
    }

    /// Caches the values that [`CurrentField::at_time`] needs at `now`. This only saves time: the
    /// results have the same bits.
    pub fn prepare(&mut self, now: SimTime) {
        if let Some((wander, process)) = &mut self.wander {
            let place = wander_place(wander, now);
            process.hold(place, place);
        }
    }

    /// Whether the current is the same everywhere.
    #[inline]
    pub fn is_uniform(&self) -> bool {
        self.shear.is_none() && self.eddies.is_empty()
    }

    /// The current at `now`.
    #[inline]
    pub fn at_time(&self, now: SimTime) -> CurrentNow<'_> {
        let mut uniform_m_s = self.mean_m_s;
        if let Some((wander, process)) = &self.wander {
            let mean_m_s = self.mean_m_s.dot(wander.toward);
            let wandering_m_s =
                mean_m_s + wander.sigma_m_s * process.at(wander_place(wander, now)).0;
            // The speed is clipped, not reflected: the process itself continues unbounded and stays
            // a function of time.
            let speed_m_s = wandering_m_s
                .max(wander.speed_m_s.0)
                .min(wander.speed_m_s.1);
            uniform_m_s = uniform_m_s + wander.toward.scaled(speed_m_s - mean_m_s);
        }
        if let Some(tide) = self.tide {
            let turns = now.as_s() / tide.period_s + tide.phase;
            // Reduce the argument first, so that a game of many tides does not lose digits.
            let (sin, _) = math::sin_cos(TAU * (turns - turns.floor()));
            uniform_m_s = uniform_m_s + tide.flood_m_s.scaled(sin);
        }
        CurrentNow {
            uniform_m_s,
            shear: self.shear,
            eddies: &self.eddies,
        }
    }
}

/// The grid position of the wander's process at `now`.
fn wander_place(wander: &Wander, now: SimTime) -> f64 {
    now.as_s() / wander.time_s * STEPS_PER_LENGTH
}

impl CurrentNow<'_> {
    /// The water's velocity at a place, m/s.
    #[inline]
    pub fn at(&self, place: Ned) -> Ned {
        self.over_hull(place, Rotation::NORTH).0
    }

    /// The water's velocity (m/s) at the centre of a hull, and the rotation (rad/s clockwise)
    /// experienced by a hull on this heading: the rate at which the flow across the heading grows
    /// along the hull.
    ///
    /// The hull is assumed short compared with the curvature of the flow: for a hull a tenth as
    /// long as an eddy's core radius, the mean over its length differs by a thousandth.
    #[inline]
    pub fn over_hull(&self, place: Ned, rotation: Rotation) -> (Ned, f64) {
        let ahead = rotation.ahead();
        let starboard = rotation.starboard();
        let mut mean_m_s = self.uniform_m_s;
        let mut turn_rad_s = 0.0;
        if let Some(shear) = self.shear {
            let speed_m_s = shear.per_s * (place - shear.origin).dot(shear.across);
            mean_m_s = mean_m_s + shear.toward.scaled(speed_m_s);
            turn_rad_s += shear.per_s * shear.across.dot(ahead) * shear.toward.dot(starboard);
        }
        for vortex in self.eddies {
            let (velocity_m_s, rate_rad_s) = vortex.over(place, ahead);
            (mean_m_s, turn_rad_s) = (mean_m_s + velocity_m_s, turn_rad_s + rate_rad_s);
        }
        (mean_m_s, turn_rad_s)
    }
}
