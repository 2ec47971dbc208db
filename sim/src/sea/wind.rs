//! The wind at a place and time: a mean that decreases towards the water, and gusts that travel
//! with it.
//!
//! Gusts are a frozen pattern that the mean wind carries over the field (Taylor 1938): a gust at
//! one boat reaches another d metres downwind after d / U. The pattern is therefore a function of U
//! t − d alone, with d measured downwind from the datum and U the mean wind at the reference
//! height. Boats at other heights meet the same pattern, in proportion to the mean wind at their
//! height. The pattern does not vary across the wind: boats abreast meet the same gusts.
//!
//! U is at least 1 m/s: a stationary pattern would not gust.

use super::cached_process::CachedProcess;
use super::gauss_markov::{GaussMarkov, STEPS_PER_LENGTH};
use primitives::SimTime;
use primitives::frame::{Ned, Rotation};
use primitives::reseed::Seeds;
use rules::field::Field;
use scenario::sea::{Gusts, Wind};

/// Minimum speed at which gusts travel, m/s.
pub const CARRY_MIN_M_S: f64 = 1.0;
/// Margin around the field within which gusts are cached, m. Beyond it they are computed more
/// slowly.
const MARGIN_M: f64 = 50.0;

/// The wind over a field.
#[derive(Clone, Debug)]
pub struct WindField {
    /// Unit vector of the mean wind's direction of travel.
    downwind: Ned,
    /// A quarter turn to starboard of `downwind`.
    across: Ned,
    speed_10m_m_s: f64,
    profile_exponent: f64,
    gusts: Option<Frozen>,
}

/// Gusts as a pattern along the wind.
#[derive(Clone, Debug)]
struct Frozen {
    process: CachedProcess,
    /// Standard deviations along and across the wind, relative to the mean speed.
    intensity: (f64, f64),
    /// Grid points per metre downwind.
    steps_per_m: f64,
    /// Grid points per second.
    steps_per_s: f64,
    /// Extent of the field downwind of the datum, with margin, m.
    reach_m: (f64, f64),
}

impl WindField {
    /// The wind over `field`. Gusts travel with the mean wind at `reference_height_m` above the
    /// water, usually the height of the boats' windage.
    pub fn new(wind: &Wind, reference_height_m: f64, field: &Field, seeds: &Seeds) -> WindField {
        let upwind = Rotation::from_heading(wind.from_rad);
        let downwind = upwind.ahead().scaled(-1.0);
        let across = upwind.starboard().scaled(-1.0);
        let mut made = WindField {
            downwind,
            across,
            speed_10m_m_s: wind.speed_10m_m_s,
            profile_exponent: wind.profile_exponent,
            gusts: None,
        };
        // Use the mean wind at the highest boat: the pattern needs a single speed, or boats would
        // disagree about the time of a gust.
        let carry_m_s = made.mean_m_s(reference_height_m).max(CARRY_MIN_M_S);
        let along_m = field.corners.map(|corner| corner.dot(downwind));
        let reach_m = (
            along_m.into_iter().fold(f64::INFINITY, f64::min) - MARGIN_M,
            along_m.into_iter().fold(f64::NEG_INFINITY, f64::max) + MARGIN_M,
        );
        made.gusts = match wind.gusts {
            Gusts::None => None,
            Gusts::OrnsteinUhlenbeck {
                intensity,
                across_ratio,
                length_m,
            } => {
                let steps_per_m = STEPS_PER_LENGTH / length_m;
                let steps_per_s = steps_per_m * carry_m_s;
                // When a new seed takes over, all gusts drawn from it are still upwind of the
                // field.
                let process = GaussMarkov::new(seeds, "gust", |now| {
                    place((steps_per_s, steps_per_m), reach_m.0, now)
                });
                Some(Frozen {
                    process: CachedProcess::new(process, (reach_m.1 - reach_m.0) * steps_per_m),
                    intensity: (intensity, intensity * across_ratio),
                    steps_per_m,
                    steps_per_s,
                    reach_m,
                })
            }
        };
        made
    }

    /// The mean speed (m/s) at a height above the water: U10 (z / 10 m)^α. Called once per boat,
    /// when the world is created.
    pub fn mean_m_s(&self, height_m: f64) -> f64 {
        self.speed_10m_m_s * libm::pow(height_m / 10.0, self.profile_exponent)
    }

    /// Caches the gusts over the field at `now`. This only saves time: [`WindField::at`] gives the
    /// same bits without it.
    pub fn prepare(&mut self, now: SimTime) {
        if let Some(gusts) = &mut self.gusts {
            let (near_m, far_m) = gusts.reach_m;
            gusts
                .process
                .hold(gusts.place(far_m, now), gusts.place(near_m, now));
        }
    }

    /// The air's velocity over the ground (m/s) at a place with the mean speed `mean_m_s` (from
    /// [`WindField::mean_m_s`]).
    #[inline]
    pub fn at(&self, place: Ned, mean_m_s: f64, now: SimTime) -> Ned {
        let Some(gusts) = &self.gusts else {
            return self.downwind.scaled(mean_m_s);
        };
        // Use two processes, along and across: gusts also change the wind direction.
        let (along, across) = gusts.process.at(gusts.place(place.dot(self.downwind), now));
        self.downwind
            .scaled(mean_m_s * (1.0 + gusts.intensity.0 * along))
            + self.across.scaled(mean_m_s * (gusts.intensity.1 * across))
    }
}

impl Frozen {
    /// The grid position of the process `downwind_m` metres downwind of the datum.
    #[inline]
    fn place(&self, downwind_m: f64, now: SimTime) -> f64 {
        place((self.steps_per_s, self.steps_per_m), downwind_m, now)
    }
}

#[inline]
fn place((steps_per_s, steps_per_m): (f64, f64), downwind_m: f64, now: SimTime) -> f64 {
    steps_per_s * now.as_s() - steps_per_m * downwind_m
}
