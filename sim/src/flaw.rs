//! Thruster flaws: command latency, gain and saturation, ventilation, and a sagging battery.
//!
//! The front seat is unaware of them: it assumes the nominal thrusters.

use crate::battery::BatteryModel;
use scenario::boat::{Flaws, Ventilation};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// The flaws of a pair of thrusters, for one tick length.
#[derive(Clone, Debug)]
pub(crate) struct FlawModel {
    /// Maximum effective setting, as a fraction of full ahead or astern.
    pub(crate) saturation: f64,
    /// Factors on thrust ahead and astern, for port and starboard.
    gain: [(f64, f64); 2],
    /// Yaw moment with both thrusters at full thrust, N m clockwise.
    pub(crate) bias_newton_m: f64,
    latency_ticks: usize,
    pub(crate) battery: Option<BatteryModel>,
    pub(crate) ventilation: Option<Ventilation>,
}

/// The changing state of flawed thrusters, except their shafts. The default is that of perfect
/// thrusters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlawState {
    /// Settings in transit to the thrusters, oldest first, one for each tick of latency.
    under_way: VecDeque<[f64; 2]>,
    /// Charge of the thrusters' battery, 0 to 1; 0, without effect, if they have no battery.
    pub charge: f64,
}

impl FlawModel {
    /// The model of `flaws` for ticks of `dt_s`; `None` for perfect thrusters.
    pub(crate) fn new(flaws: &Flaws, dt_s: f64) -> Option<FlawModel> {
        // The watchdog is not part of the thrusters; it acts where orders arrive.
        if (Flaws {
            watchdog_s: None,
            ..flaws.clone()
        }) == Flaws::default()
        {
            // Perfect thrusters have no model, so that the common case costs nothing.
            return None;
        }
        let gain = |side: f64| (side, side * flaws.reverse_efficiency);
        Some(FlawModel {
            saturation: flaws.saturation,
            gain: [gain(flaws.gain.0), gain(flaws.gain.1)],
            bias_newton_m: flaws.bias_newton_m,
            latency_ticks: (flaws.latency_s / dt_s).round() as usize,
            battery: flaws
                .battery
                .as_ref()
                .map(|battery| BatteryModel::new(battery, dt_s)),
            ventilation: flaws.ventilation,
        })
    }

    pub(crate) fn start(&self) -> FlawState {
        FlawState {
            under_way: VecDeque::from(vec![[0.0; 2]; self.latency_ticks]),
            charge: self.battery.map_or(0.0, |battery| battery.charge),
        }
    }

    /// Factor on a thrust with this sign.
    #[inline]
    pub(crate) fn gain(&self, side: usize, newton: f64) -> f64 {
        let (ahead, astern) = self.gain[side];
        if newton < 0.0 { astern } else { ahead }
    }

    /// Factors on the thrust of each thruster over this tick, from the battery and from the water
    /// above the propellers.
    #[inline]
    pub(crate) fn thrust_factors(&self, state: &FlawState, water_above_m: [f64; 2]) -> [f64; 2] {
        let battery = self
            .battery
            .map_or(1.0, |battery| battery.thrust_factor(state.charge));
        let wet = |above_m: f64| {
            self.ventilation
                .map_or(1.0, |ventilation| wetness(ventilation, above_m))
        };
        water_above_m.map(|above_m| battery * wet(above_m))
    }
}

impl FlawState {
    /// Replaces all settings in transit to one thruster.
    pub(crate) fn replace_under_way(&mut self, side: usize, setting: f64) {
        self.under_way
            .iter_mut()
            .for_each(|settings| settings[side] = setting);
    }

    /// Sends `settings`; returns the settings that arrive.
    #[inline]
    pub(crate) fn pass(&mut self, settings: [f64; 2]) -> [f64; 2] {
        // The queue is as long as the latency: with one push and one pop per tick, it never grows.
        self.under_way.push_back(settings);
        self.under_way.pop_front().unwrap_or(settings)
    }
}

/// Thrust factor of a propeller with this much water above it: 1 at half the still-water depth or
/// more, decreasing linearly to 0 at the surface. The measured loss depends on depth and propeller
/// radius (Minsaas, Faltinsen and Persson 1983), but there are no published data for such small
/// propellers.
#[inline]
pub fn wetness(ventilation: Ventilation, water_above_m: f64) -> f64 {
    (water_above_m / (0.5 * ventilation.depth_m)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn perfect_thrusters_have_no_flaw_model_and_a_watchdog_makes_none() {
        assert!(FlawModel::new(&Flaws::default(), 0.05).is_none());
        assert!(
            FlawModel::new(
                &Flaws {
                    watchdog_s: Some(1.0),
                    ..Flaws::default()
                },
                0.05
            )
            .is_none()
        );
        assert!(
            FlawModel::new(
                &Flaws {
                    latency_s: 0.1,
                    ..Flaws::default()
                },
                0.05
            )
            .is_some()
        );
    }

    #[test]
    fn a_propeller_loses_thrust_below_half_its_depth_of_water() {
        let ventilation = Ventilation { depth_m: 0.2 };
        for (above_m, want) in [
            (0.5, 1.0),
            (0.2, 1.0),
            (0.1, 1.0),
            (0.05, 0.5),
            (0.02, 0.2),
            (0.0, 0.0),
            (-0.3, 0.0),
        ] {
            let got = wetness(ventilation, above_m);
            assert!(
                (got - want).abs() < 1e-15,
                "{above_m} m: {got}, want {want}"
            );
        }
    }

    #[test]
    fn settings_arrive_after_as_many_ticks_as_the_latency_has() {
        for (latency_s, ticks) in [(0.0, 0), (0.05, 1), (0.15, 3), (0.14, 3), (1.0, 20)] {
            let flaws = Flaws {
                latency_s,
                saturation: 0.9,
                ..Flaws::default()
            };
            let mut state = FlawModel::new(&flaws, 0.05).unwrap().start();
            for tick in 0..50 {
                let arrived = state.pass([f64::from(tick) + 1.0, 0.0])[0];
                assert_eq!(
                    arrived,
                    f64::from((tick + 1 - ticks).max(0)),
                    "{latency_s} s, tick {tick}"
                );
            }
        }
    }
}
