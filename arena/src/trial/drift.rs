//! Where a free boat goes: nobody steers it, and the sea does what it likes.

use super::manoeuvre::turned_rad;
use super::sample::Sample;
use game::Ned;

/// How a boat drifts, over the second half of what was sailed, when it has found how it lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Mean velocity over the ground, m/s.
    pub velocity_m_s: Ned,
    /// Mean heading, rad, whole turns counted.
    pub heading_rad: f64,
}

impl Drift {
    /// That of these samples; `None` where there are too few.
    #[must_use]
    pub fn of(samples: &[Sample]) -> Option<Drift> {
        let middle = samples.len() / 2;
        let half = &samples[middle..];
        let (first, last) = (half.first()?, half.last()?);
        if last.t_s <= first.t_s {
            return None;
        }
        let turned_mean_rad = turned_rad(samples)[middle..].iter().sum::<f64>() / half.len() as f64;
        Some(Drift {
            velocity_m_s: (last.at - first.at).scaled(1.0 / (last.t_s - first.t_s)),
            heading_rad: samples[0].psi_rad + turned_mean_rad,
        })
    }

    /// Speed over the ground, m/s.
    #[must_use]
    pub fn speed_m_s(&self) -> f64 {
        self.velocity_m_s.length()
    }

    /// The bearing it drifts to, rad; `None` where it stays.
    #[must_use]
    pub fn toward_rad(&self) -> Option<f64> {
        (self.speed_m_s() > STAYS_M_S).then(|| Ned::default().bearing_rad(self.velocity_m_s))
    }
}

/// What is slower stays where it is, m/s: a micrometre in a few minutes.
const STAYS_M_S: f64 = 1e-8;
