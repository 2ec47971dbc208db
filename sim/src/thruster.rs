//! A thruster: takes a setting up with dead-band, slew limit and lag, and turns it into thrust.

use crate::ramp::Ramp;
use game::boat::{ThrustCurve, Thruster};
use game::math;
use serde::{Deserialize, Serialize};

/// A thruster ready for computing, for one tick length.
///
/// A *setting* is a shaft speed in rad/s for a propeller, a share of full ahead for a table.
#[derive(Clone, Debug)]
pub struct ThrusterModel {
    curve: Curve,
    /// Distance from the centre line, m.
    pub arm_m: f64,
    /// Settings at full ahead and full astern.
    ahead: f64,
    astern: f64,
    /// Thrust at full ahead and full astern, N.
    pub newton_max: f64,
    /// Thrust at full astern (negative), N.
    pub newton_min: f64,
    /// Largest change of the commanded setting in a tick.
    slew: f64,
    /// Smaller commands give nothing.
    deadband: f64,
    /// What is left of a difference after half a tick and after a tick.
    lag: (f64, f64),
}

/// Thrust over setting, both ways.
#[derive(Clone, Debug)]
enum Curve {
    /// `k n |n|`.
    Propeller {
        k_ahead: f64,
        k_astern: f64,
    },
    Table {
        newton: Ramp,
        setting: Ramp,
    },
}

/// What one thruster is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shaft {
    /// The command after the slew limit.
    pub command: f64,
    /// The setting reached.
    pub setting: f64,
    /// The thrust it gives, N.
    pub newton: f64,
}

impl ThrusterModel {
    /// The model of `thruster` for ticks of `dt_s`.
    #[must_use]
    pub fn new(thruster: &Thruster, dt_s: f64) -> ThrusterModel {
        let (curve, ahead, astern) = match &thruster.curve {
            ThrustCurve::Propeller { k_ahead, k_astern, n_max_rad_s, n_min_rad_s } => {
                (Curve::Propeller { k_ahead: *k_ahead, k_astern: *k_astern }, *n_max_rad_s, *n_min_rad_s)
            }
            ThrustCurve::Table { points } => {
                let turned: Vec<(f64, f64)> = points.iter().map(|p| (p.1, p.0)).collect();
                let curve = Curve::Table { newton: Ramp::new(points), setting: Ramp::new(&turned) };
                (curve, points[points.len() - 1].0, -points[0].0)
            }
        };
        let left = |time_s: f64| if thruster.lag_s > 0.0 { math::exp(-time_s / thruster.lag_s) } else { 0.0 };
        let mut model = ThrusterModel {
            curve,
            arm_m: thruster.arm_m,
            ahead,
            astern,
            newton_max: 0.0,
            newton_min: 0.0,
            slew: thruster.slew_per_s * dt_s * ahead,
            deadband: thruster.deadband * ahead,
            lag: (left(0.5 * dt_s), left(dt_s)),
        };
        model.newton_max = model.newton(ahead);
        model.newton_min = model.newton(-astern);
        model
    }

    /// The thrust of a setting, N.
    #[inline]
    #[must_use]
    pub fn newton(&self, setting: f64) -> f64 {
        match &self.curve {
            Curve::Propeller { k_ahead, k_astern } => {
                (if setting > 0.0 { k_ahead } else { k_astern }) * setting * setting.abs()
            }
            Curve::Table { newton, .. } => newton.at(setting),
        }
    }

    /// The setting that gives this thrust, within what the thruster can do.
    #[inline]
    #[must_use]
    pub fn setting(&self, newton: f64) -> f64 {
        let wanted = newton.clamp(self.newton_min, self.newton_max);
        match &self.curve {
            Curve::Propeller { k_ahead, .. } if wanted > 0.0 => (wanted / k_ahead).sqrt(),
            Curve::Propeller { k_astern, .. } => -(-wanted / k_astern).sqrt(),
            Curve::Table { setting, .. } => setting.at(wanted),
        }
    }

    /// The setting at this share (−1 to 1) of full ahead or astern.
    #[inline]
    #[must_use]
    pub fn setting_of_share(&self, share: f64) -> f64 {
        share * if share > 0.0 { self.ahead } else { self.astern }
    }

    /// Moves a shaft on by one tick towards `wanted`; gives the thrust at the beginning, half-way and at the end, N.
    #[inline]
    pub fn respond(&self, shaft: &mut Shaft, wanted: f64) -> [f64; 3] {
        let change = (wanted - shaft.command).clamp(-self.slew, self.slew);
        shaft.command += change;
        let target = if shaft.command.abs() < self.deadband { 0.0 } else { shaft.command };
        let from = shaft.newton;
        let difference = shaft.setting - target;
        let half = self.newton(target + difference * self.lag.0);
        shaft.setting = target + difference * self.lag.1;
        shaft.newton = self.newton(shaft.setting);
        [from, half, shaft.newton]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::boat::Flaws;

    fn thruster(curve: ThrustCurve) -> Thruster {
        Thruster { arm_m: 0.4, curve, lag_s: 0.2, slew_per_s: 1.0, deadband: 0.05, flaws: Flaws::default() }
    }

    fn propeller() -> Thruster {
        thruster(ThrustCurve::Propeller { k_ahead: 0.011, k_astern: 0.006, n_max_rad_s: 100.0, n_min_rad_s: 90.0 })
    }

    fn table() -> Thruster {
        thruster(ThrustCurve::Table { points: vec![(-1.0, -30.0), (0.0, 0.0), (0.5, 20.0), (1.0, 60.0)] })
    }

    #[test]
    fn setting_and_thrust_are_each_others_inverse() {
        for thruster in [propeller(), table()] {
            let model = ThrusterModel::new(&thruster, 0.05);
            for newton in [-25.0, -1.0, 0.0, 0.5, 20.0, 59.0] {
                let back = model.newton(model.setting(newton));
                assert!((back - newton).abs() < 1e-9, "{newton} -> {back}");
            }
            assert_eq!(model.setting(1e9), model.setting_of_share(1.0));
            assert_eq!(model.setting(-1e9), model.setting_of_share(-1.0));
        }
    }

    #[test]
    fn a_step_is_taken_up_with_the_slew_and_the_lag_that_were_asked_for() {
        let mut quick = table();
        quick.slew_per_s = 1e9;
        let model = ThrusterModel::new(&quick, 0.05);
        let mut shaft = Shaft::default();
        (0..4).for_each(|_| {
            model.respond(&mut shaft, 1.0);
        });
        // One time constant: 1 − 1/e of the way.
        assert!((shaft.setting - 0.632_120_558_828_557_7).abs() < 1e-12, "{}", shaft.setting);

        let model = ThrusterModel::new(&table(), 0.05);
        let mut shaft = Shaft::default();
        (0..10).for_each(|_| {
            model.respond(&mut shaft, 1.0);
        });
        assert!((shaft.command - 0.5).abs() < 1e-12, "half a second at 1 per second: {}", shaft.command);
    }

    #[test]
    fn commands_inside_the_deadband_give_nothing() {
        let model = ThrusterModel::new(&table(), 0.05);
        let mut shaft = Shaft::default();
        (0..100).for_each(|_| {
            model.respond(&mut shaft, 0.049);
        });
        assert_eq!(shaft.newton, 0.0);
    }
}
