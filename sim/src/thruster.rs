//! A thruster: dead-band, slew limit, first-order lag and thrust curve.

use crate::flaw::{FlawModel, FlawState};
use crate::hull::Planar;
use crate::piecewise_linear::PiecewiseLinear;
use primitives::math;
use scenario::boat::{Propeller, ThrustCurve, Thruster, Ventilation};
use serde::{Deserialize, Serialize};

/// A thruster with constants for one tick length.
///
/// A *setting* is a shaft speed in rad/s for a propeller, or a fraction of full ahead for a table.
#[derive(Clone, Debug)]
pub struct ThrusterModel {
    curve: Curve,
    /// Distance from the centre line, m.
    pub arm_m: f64,
    /// Settings at full ahead and full astern.
    ahead: f64,
    astern: f64,
    /// Thrust at full ahead, N.
    pub newton_max: f64,
    /// Thrust at full astern (negative), N.
    pub newton_min: f64,
    /// Maximum change of the commanded setting per tick.
    slew: f64,
    /// Commands of a smaller magnitude have no effect.
    deadband: f64,
    /// Remaining fraction of a difference after half a tick and after a full tick.
    lag: (f64, f64),
    /// Flaws of a pair of these thrusters.
    flaws: Option<Box<FlawModel>>,
}

/// Thrust as a function of the setting, and its inverse.
#[derive(Clone, Debug)]
enum Curve {
    /// `k n |n|`.
    Propeller { k_ahead: f64, k_astern: f64 },
    Table {
        newton: PiecewiseLinear,
        setting: PiecewiseLinear,
    },
}

/// The state of one thruster.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shaft {
    /// The command after the slew limit.
    pub command: f64,
    /// The current setting.
    pub setting: f64,
    /// The current thrust, N.
    pub newton: f64,
}

impl ThrusterModel {
    /// The model of `thruster` for ticks of `dt_s`.
    pub fn new(thruster: &Thruster, dt_s: f64) -> ThrusterModel {
        let (curve, ahead, astern) = match &thruster.curve {
            ThrustCurve::Propeller(Propeller {
                k_ahead,
                k_astern,
                n_max_rad_s,
                n_min_rad_s,
            }) => (
                Curve::Propeller {
                    k_ahead: *k_ahead,
                    k_astern: *k_astern,
                },
                *n_max_rad_s,
                *n_min_rad_s,
            ),
            ThrustCurve::Table { points } => {
                let turned: Vec<(f64, f64)> = points.iter().map(|p| (p.1, p.0)).collect();
                let curve = Curve::Table {
                    newton: PiecewiseLinear::new(points),
                    setting: PiecewiseLinear::new(&turned),
                };
                (curve, points[points.len() - 1].0, -points[0].0)
            }
        };
        let left = |time_s: f64| {
            if thruster.lag_s > 0.0 {
                math::exp(-time_s / thruster.lag_s)
            } else {
                0.0
            }
        };
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
            flaws: FlawModel::new(&thruster.flaws, dt_s).map(Box::new),
        };
        model.newton_max = model.newton(ahead);
        model.newton_min = model.newton(-astern);
        model
    }

    /// Initial flaw state of a pair of these thrusters, for [`ThrusterModel::drive`].
    pub fn start(&self) -> FlawState {
        self.flaws
            .as_ref()
            .map(|flaws| flaws.start())
            .unwrap_or_default()
    }

    /// The thrusters' ventilation, if any.
    #[inline]
    pub fn ventilation(&self) -> Option<Ventilation> {
        self.flaws.as_ref().and_then(|flaws| flaws.ventilation)
    }

    /// The thrust at a setting, without flaws, N.
    #[inline]
    pub fn newton(&self, setting: f64) -> f64 {
        match &self.curve {
            Curve::Propeller { k_ahead, k_astern } => {
                (if setting > 0.0 { k_ahead } else { k_astern }) * setting * setting.abs()
            }
            Curve::Table { newton, .. } => newton.at(setting),
        }
    }

    /// The setting for a thrust within the thruster's limits, without flaws.
    #[inline]
    pub fn setting(&self, newton: f64) -> f64 {
        let wanted = newton.clamp(self.newton_min, self.newton_max);
        match &self.curve {
            Curve::Propeller { k_ahead, .. } if wanted > 0.0 => (wanted / k_ahead).sqrt(),
            Curve::Propeller { k_astern, .. } => -(-wanted / k_astern).sqrt(),
            Curve::Table { setting, .. } => setting.at(wanted),
        }
    }

    /// The setting for this fraction (−1 to 1) of full ahead or astern.
    #[inline]
    pub fn setting_of_share(&self, share: f64) -> f64 {
        share * if share > 0.0 { self.ahead } else { self.astern }
    }

    /// Advances both thrusters by one tick towards `settings` (port, starboard). Returns the force
    /// on the hull at the start, half-way and at the end.
    ///
    /// The initial `state` is [`ThrusterModel::start`]. `water_above_m` is the depth of each
    /// propeller below the surface; only [`ThrusterModel::ventilation`] uses it.
    #[inline]
    pub fn drive(
        &self,
        shafts: [&mut Shaft; 2],
        state: &mut FlawState,
        settings: [f64; 2],
        water_above_m: [f64; 2],
    ) -> [Planar; 3] {
        if let Some(flaws) = &self.flaws {
            return self.drive_flawed(flaws, shafts, state, settings, water_above_m);
        }
        let [port, starboard] = shafts;
        let port = self.respond(port, settings[0]);
        let starboard = self.respond(starboard, settings[1]);
        self.on_hull(port, starboard)
    }

    #[inline]
    fn on_hull(&self, port: [f64; 3], starboard: [f64; 3]) -> [Planar; 3] {
        [0, 1, 2].map(|i| Planar {
            surge: port[i] + starboard[i],
            sway: 0.0,
            yaw: self.arm_m * (port[i] - starboard[i]),
        })
    }

    // Kept separate from the common case of thrusters without flaws.
    #[cold]
    #[inline(never)]
    fn drive_flawed(
        &self,
        flaws: &FlawModel,
        shafts: [&mut Shaft; 2],
        state: &mut FlawState,
        settings: [f64; 2],
        water_above_m: [f64; 2],
    ) -> [Planar; 3] {
        let least = -self.astern * flaws.saturation;
        let most = self.ahead * flaws.saturation;
        let arrived = state.pass(settings);
        let factors = flaws.thrust_factors(state, water_above_m);
        // Thrust fractions that load the battery, and thrusts on the hull, N.
        let mut taken = [0.0; 2];
        let mut given = [[0.0; 3]; 2];
        for (side, shaft) in shafts.into_iter().enumerate() {
            shaft.newton = self.newton(shaft.setting);
            let nominal = self.respond(shaft, arrived[side].max(least).min(most));
            given[side] = nominal.map(|newton| newton * factors[side] * flaws.gain(side, newton));
            taken[side] = self.share(nominal[1] * factors[side]);
            // Observers see the force that acts on the hull.
            shaft.newton = given[side][2];
        }
        if let Some(battery) = flaws.battery {
            battery.draw(&mut state.charge, taken);
        }
        let mut on_hull = self.on_hull(given[0], given[1]);
        for (i, force) in on_hull.iter_mut().enumerate() {
            force.yaw +=
                flaws.bias_newton_m * 0.5 * (self.share(given[0][i]) + self.share(given[1][i]));
        }
        on_hull
    }

    /// The magnitude of a thrust as a fraction of full ahead or astern.
    #[inline]
    fn share(&self, newton: f64) -> f64 {
        newton
            / if newton < 0.0 {
                self.newton_min
            } else {
                self.newton_max
            }
    }

    /// Advances a shaft by one tick towards `wanted`, without flaws. Returns the thrust at the
    /// start, half-way and at the end, N.
    #[inline]
    pub fn respond(&self, shaft: &mut Shaft, wanted: f64) -> [f64; 3] {
        // The slew rate limits the command, and the lag follows it: motor controllers ramp,
        // propellers have inertia.
        let change = (wanted - shaft.command).clamp(-self.slew, self.slew);
        shaft.command += change;
        let target = if shaft.command.abs() < self.deadband {
            0.0
        } else {
            shaft.command
        };
        let from = shaft.newton;
        let difference = shaft.setting - target;
        // A first-order lag has an exact solution, so the thrust half-way and at the end needs no
        // integration.
        let half = self.newton(target + difference * self.lag.0);
        shaft.setting = target + difference * self.lag.1;
        shaft.newton = self.newton(shaft.setting);
        [from, half, shaft.newton]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scenario::boat::{Battery, Flaws};

    fn thruster(curve: ThrustCurve) -> Thruster {
        Thruster {
            arm_m: 0.4,
            curve,
            lag_s: 0.2,
            slew_per_s: 1.0,
            deadband: 0.05,
            flaws: Flaws::default(),
        }
    }

    fn propeller() -> Thruster {
        let n_max_rad_s = 100.0;
        let n_min_rad_s = 90.0;
        thruster(ThrustCurve::Propeller(Propeller {
            k_ahead: 0.011,
            k_astern: 0.006,
            n_max_rad_s,
            n_min_rad_s,
        }))
    }

    fn table() -> Thruster {
        thruster(ThrustCurve::Table {
            points: vec![(-1.0, -30.0), (0.0, 0.0), (0.5, 20.0), (1.0, 60.0)],
        })
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
        // After one time constant: 1 − 1/e of the way.
        assert!(
            (shaft.setting - 0.632_120_558_828_557_7).abs() < 1e-12,
            "{}",
            shaft.setting
        );

        let model = ThrusterModel::new(&table(), 0.05);
        let mut shaft = Shaft::default();
        (0..10).for_each(|_| {
            model.respond(&mut shaft, 1.0);
        });
        assert!(
            (shaft.command - 0.5).abs() < 1e-12,
            "half a second at 1 per second: {}",
            shaft.command
        );
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

    /// Runs both thrusters through 400 ticks of changing settings. Returns a hash over the bits of
    /// every force and moment, and the last surge and yaw.
    fn voyage(thruster: &Thruster) -> (u64, f64, f64) {
        let model = ThrusterModel::new(thruster, 0.05);
        let mut state = model.start();
        let mut port = Shaft::default();
        let mut starboard = Shaft::default();
        let mut bytes = Vec::new();
        let mut last = (0.0, 0.0);
        for tick in 0..400_u32 {
            let share = |step: u32| f64::from((tick / 7 * step) % 41) / 20.0 - 1.0;
            let settings = if tick % 3 == 0 {
                [
                    model.setting(70.0 * share(5)),
                    model.setting(-40.0 * share(11)),
                ]
            } else {
                [
                    model.setting_of_share(share(7)),
                    model.setting_of_share(share(3)),
                ]
            };
            for force in model.drive([&mut port, &mut starboard], &mut state, settings, [0.0; 2]) {
                last = (force.surge, force.yaw);
                bytes.extend(last.0.to_le_bytes());
                bytes.extend(last.1.to_le_bytes());
            }
        }
        (xxhash_rust::xxh3::xxh3_64(&bytes), last.0, last.1)
    }

    #[test]
    fn without_flaws_every_bit_is_as_it_was_before_there_were_any() {
        // Recorded before thrusters had flaws.
        let propeller_was = (
            7_544_133_322_723_756_280,
            13.121_373_992_948_243,
            -4.875_639_398_475_489_5,
        );
        let table_was = (
            3_658_721_781_925_709_332,
            15.826_061_272_148_417,
            -4.523_535_130_683_975_5,
        );
        assert_eq!(voyage(&propeller()), propeller_was);
        assert_eq!(voyage(&table()), table_was);
    }

    /// Forces at these fractions of full thrust after two minutes, when both shafts have settled.
    fn settled(flaws: Flaws, shares: [f64; 2]) -> Planar {
        let (model, mut state, mut shafts) = flawed(flaws);
        let settings = shares.map(|share| model.setting_of_share(share));
        let [port, starboard] = &mut shafts;
        let mut last = Planar::default();
        for _ in 0..2_400 {
            last = model.drive([port, starboard], &mut state, settings, [0.05, 0.2])[2];
        }
        last
    }

    fn flawed(flaws: Flaws) -> (ThrusterModel, FlawState, [Shaft; 2]) {
        let model = ThrusterModel::new(&Thruster { flaws, ..table() }, 0.05);
        let state = model.start();
        (model, state, [Shaft::default(); 2])
    }

    /// Two thrusts as a force on the hull of `table()`.
    fn pair(port_newton: f64, starboard_newton: f64, more_newton_m: f64) -> Planar {
        let yaw = 0.4 * (port_newton - starboard_newton) + more_newton_m;
        Planar {
            surge: port_newton + starboard_newton,
            sway: 0.0,
            yaw,
        }
    }

    #[test]
    fn each_flaw_does_what_its_closed_form_says() {
        let perfect = Flaws::default;
        // Full ahead is 60 N, full astern -30 N, half ahead 20 N.
        for (what, flaws, shares, want) in [
            (
                "saturation ahead",
                Flaws {
                    saturation: 0.5,
                    ..perfect()
                },
                [1.0, 0.3],
                pair(20.0, 12.0, 0.0),
            ),
            (
                "saturation astern",
                Flaws {
                    saturation: 0.5,
                    ..perfect()
                },
                [-1.0, -0.3],
                pair(-15.0, -9.0, 0.0),
            ),
            (
                "gain",
                Flaws {
                    gain: (0.9, 1.1),
                    ..perfect()
                },
                [1.0, 0.5],
                pair(54.0, 22.0, 0.0),
            ),
            (
                "reverse",
                Flaws {
                    reverse_efficiency: 0.4,
                    ..perfect()
                },
                [-1.0, 0.5],
                pair(-12.0, 20.0, 0.0),
            ),
            (
                "gain and reverse",
                Flaws {
                    gain: (0.5, 1.0),
                    reverse_efficiency: 0.4,
                    ..perfect()
                },
                [-1.0, -1.0],
                pair(-6.0, -12.0, 0.0),
            ),
            (
                "bias",
                Flaws {
                    bias_newton_m: 3.0,
                    ..perfect()
                },
                [1.0, 1.0],
                pair(60.0, 60.0, 3.0),
            ),
            (
                "bias of one",
                Flaws {
                    bias_newton_m: 3.0,
                    ..perfect()
                },
                [0.5, 0.0],
                pair(20.0, 0.0, 0.5),
            ),
            (
                "bias spinning",
                Flaws {
                    bias_newton_m: 3.0,
                    ..perfect()
                },
                [1.0, -1.0],
                pair(60.0, -30.0, 3.0),
            ),
            (
                "ventilation of port",
                Flaws {
                    ventilation: Some(Ventilation { depth_m: 0.2 }),
                    ..perfect()
                },
                [1.0, 1.0],
                pair(30.0, 60.0, 0.0),
            ),
            (
                "latency, after arrival",
                Flaws {
                    latency_s: 0.15,
                    ..perfect()
                },
                [1.0, 0.5],
                pair(60.0, 20.0, 0.0),
            ),
        ] {
            let got = settled(flaws, shares);
            let off = (got.surge - want.surge).abs() + (got.yaw - want.yaw).abs();
            assert!(off < 1e-9, "{what}: {got:?}, want {want:?}");
        }
    }

    #[test]
    fn a_late_command_does_the_same_later() {
        let (prompt, mut no_flaws, mut prompt_shafts) = flawed(Flaws::default());
        let (late, mut state, mut late_shafts) = flawed(Flaws {
            latency_s: 0.15,
            ..Flaws::default()
        });
        let wanted = |tick: i32| {
            [
                (f64::from(tick) * 0.1).clamp(-1.0, 1.0),
                (1.0 - f64::from(tick) * 0.03).max(-1.0),
            ]
        };
        let mut forces = Vec::new();
        for tick in 0..100 {
            let [port, starboard] = &mut prompt_shafts;
            forces.push(prompt.drive([port, starboard], &mut no_flaws, wanted(tick), [0.0; 2]));
            let [port, starboard] = &mut late_shafts;
            let got = late.drive([port, starboard], &mut state, wanted(tick), [0.0; 2]);
            let want = if tick < 3 {
                [Planar::default(); 3]
            } else {
                forces[tick as usize - 3]
            };
            assert_eq!(got, want, "tick {tick}");
        }
    }

    #[test]
    fn a_battery_sags_by_the_energy_it_has_given() {
        let battery = Battery {
            capacity_joule: 90_000.0,
            charge: 0.9,
            full_power_watt: 600.0,
            hotel_power_watt: 30.0,
            sag: 0.2,
        };
        let mut quick = table();
        (quick.lag_s, quick.slew_per_s) = (0.0, 1e9);
        quick.flaws.battery = Some(battery);
        let model = ThrusterModel::new(&quick, 0.05);
        let mut state = model.start();
        let mut port = Shaft::default();
        let mut starboard = Shaft::default();
        // One thruster full astern, the other half ahead, which is a third of full thrust.
        let mut charge = 0.9;
        let (mut sag, mut last): (f64, Planar) = (1.0, Planar::default());
        for _ in 0..1_200 {
            sag = 1.0 - 0.2 * (1.0 - charge);
            let both = sag * sag.sqrt() * (1.0 + 1.0 / 27_f64.sqrt());
            charge -= 0.05 * (30.0 + 600.0 * 0.5 * both) / 90_000.0;
            last = model.drive(
                [&mut port, &mut starboard],
                &mut state,
                [-1.0, 0.5],
                [0.0; 2],
            )[2];
        }
        assert!(
            (state.charge - charge).abs() < 1e-12,
            "{} {charge}",
            state.charge
        );
        assert!((0.55..0.75).contains(&charge), "{charge}");
        assert!(
            (last.surge - sag * -10.0).abs() < 1e-9,
            "{last:?}, sag {sag}"
        );
        assert_eq!(port.newton + starboard.newton, last.surge);
    }

    #[test]
    fn the_front_seat_knows_nothing_of_flaws() {
        let perfect = ThrusterModel::new(&table(), 0.05);
        let flaws = Flaws {
            saturation: 0.5,
            gain: (0.5, 0.5),
            reverse_efficiency: 0.3,
            ..Flaws::default()
        };
        let (flawed, ..) = flawed(flaws);
        for newton in [-40.0, -20.0, 0.0, 15.0, 59.0, 80.0] {
            assert_eq!(flawed.setting(newton), perfect.setting(newton));
        }
        assert_eq!(
            (flawed.newton_max, flawed.newton_min),
            (perfect.newton_max, perfect.newton_min)
        );
    }
}
