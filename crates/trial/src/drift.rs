//! The drift of a free boat, moved only by the sea.

use super::manoeuvre::turned_rad;
use super::sample::Sample;
use primitives::Ned;

/// A boat's drift over the second half of the run, once its heading has settled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Mean velocity over the ground, m/s.
    pub velocity_m_s: Ned,
    /// Mean heading, rad, including whole turns.
    pub heading_rad: f64,
}

impl Drift {
    /// The drift in these samples; `None` if there are too few.
    pub fn of(samples: &[Sample]) -> Option<Drift> {
        let middle = samples.len() / 2;
        let half = &samples[middle..];
        let first = half.first()?;
        let last = half.last()?;
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
    pub fn speed_m_s(&self) -> f64 {
        self.velocity_m_s.length()
    }

    /// The bearing towards which it drifts, rad; `None` if it does not move.
    pub fn toward_rad(&self) -> Option<f64> {
        (self.speed_m_s() > STAYS_M_S).then(|| Ned::default().bearing_rad(self.velocity_m_s))
    }
}

/// Speed below which a boat counts as stationary, m/s: a micrometre in a few minutes.
const STAYS_M_S: f64 = 1e-8;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, ROW, Start, TrialBoat, still_sea, ticks_per_row};
    use primitives::SimTime;
    use scenario::sea::{Gusts, Wind};
    use sim::sea::Summary;
    use std::f64::consts::FRAC_PI_2;
    use std::path::Path;

    #[test]
    fn in_a_steady_wind_a_boat_drifts_beam_on_as_the_balance_of_forces_says() {
        /// Remaining transient after 150 s, as a fraction of the speed.
        const TOLERANCE: f64 = 0.005;
        let boats = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/boats");
        let tick = SimTime::from_s(0.05);
        for (name, wind_m_s) in [
            ("surveyor_m1_8", 4.0),
            ("surveyor_m1_8", 12.0),
            ("otter", 8.0),
            ("heron", 8.0),
        ] {
            let boat = scenario::load_file::<scenario::Boat>(&boats.join(format!("{name}.toml")))
                .expect("it is shipped");
            let from_rad = 2.0;
            let gusts = Gusts::None;
            let wind = Wind {
                speed_10m_m_s: wind_m_s,
                from_rad,
                profile_exponent: 0.12,
                gusts,
            };
            let sea = scenario::sea::Sea {
                wind: Some(wind),
                ..still_sea()
            };
            let want_m_s = Summary::new(&sea, &boat, &crate::open_field(), 1)
                .wind
                .expect("there is wind")
                .drift_m_s;

            let mut trial_boat = TrialBoat::new(&boat, &sea, tick, 1, &Start::default());
            let per_row = ticks_per_row(tick).expect("it divides");
            let samples: Vec<Sample> = (0..3000_i64)
                .map(|row| {
                    (0..per_row).for_each(|_| trial_boat.step(Command::Hold));
                    trial_boat.sample((ROW * row).as_s(), Command::Hold)
                })
                .collect();
            let drift = Drift::of(&samples).expect("there are samples");
            let speed_m_s = drift.speed_m_s();
            let toward_rad = drift.toward_rad().expect("it moves");
            assert!(
                (speed_m_s / want_m_s - 1.0).abs() < TOLERANCE,
                "{name}: {speed_m_s} m/s, balance {want_m_s} m/s"
            );
            let off_rad = primitives::angle::wrap_pi(toward_rad - from_rad - std::f64::consts::PI);
            let off_beam_rad =
                primitives::angle::wrap_pi(drift.heading_rad - from_rad).abs() - FRAC_PI_2;
            assert!(
                off_rad.abs() < 0.05 && off_beam_rad.abs() < 0.1,
                "{name}: {off_rad} off, {off_beam_rad} rad"
            );
        }
    }
}
