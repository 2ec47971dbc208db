//! The quantities that sensors measure, and code shared by the sensors.

use crate::hull::Planar;
use crate::sea::Attitude;
use primitives::frame::{Ned, Pose};
use primitives::{SimTime, math};

/// A boat's true state at one tick, as far as sensors measure it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Truth {
    /// Position and heading.
    pub pose: Pose,
    /// Velocity over the ground in body axes.
    pub nu: Planar,
    /// The rate of change of the components of `nu`; the accelerometers add the rotation of the
    /// axes.
    pub nu_dot: Planar,
    /// Attitude in the waves.
    pub attitude: Attitude,
    /// The mean magnitude of the two thrusts as a fraction of full thrust ahead; stands for the
    /// thrusters' current.
    pub thrust_share: f64,
}

impl Truth {
    /// Velocity over the ground, m/s.
    pub fn velocity_m_s(&self) -> Ned {
        self.nu.in_ned(self.pose.rotation())
    }
}

/// `period_s` as a whole number of ticks, at least one, since sensors are read at ticks.
pub(super) fn whole_ticks(period_s: f64, tick: SimTime) -> SimTime {
    let ticks = (period_s / tick.as_s()).round() as i64;
    tick * ticks.max(1)
}

/// One step of a Gauss-Markov process of variance 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct GaussMarkovStep {
    /// The correlation over the step.
    pub(super) kept: f64,
    /// The standard deviation of the innovation.
    pub(super) fresh: f64,
}

impl GaussMarkovStep {
    /// The very first step, which has no memory.
    pub(super) const FIRST: GaussMarkovStep = GaussMarkovStep {
        kept: 0.0,
        fresh: 1.0,
    };

    /// A step of `span` for a process with this correlation time.
    pub(super) fn new(span: SimTime, time_s: f64) -> GaussMarkovStep {
        let spans = span.as_s() / time_s;
        GaussMarkovStep {
            kept: math::exp(-spans),
            fresh: (-libm::expm1(-2.0 * spans)).sqrt(),
        }
    }
}
