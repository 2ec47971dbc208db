//! A battery: its charge under the thrusters' load, and the thrust lost as it discharges.
//!
//! At advance number 0, a propeller takes a torque of k_q n |n| and produces a thrust of k_t n |n|.
//! Its power 2 pi n Q is therefore proportional to |n|³, that is, to |T|^1.5 (Fossen 2021, ch. 9).
//! Two thrusters at the fractions s of full thrust draw P = P_hotel + P_full (s_port^1.5 +
//! s_starboard^1.5) / 2.

use scenario::boat::Battery;

/// A battery with constants for one tick length.
#[derive(Clone, Copy, Debug)]
pub struct BatteryModel {
    /// Initial charge as a fraction of a full battery.
    pub(crate) charge: f64,
    sag: f64,
    /// Charge used per tick by the hotel load, and by the thrusters at full thrust.
    hotel_per_tick: f64,
    full_per_tick: f64,
}

impl BatteryModel {
    /// The model of `battery` for ticks of `dt_s`.
    pub fn new(battery: &Battery, dt_s: f64) -> BatteryModel {
        BatteryModel {
            charge: battery.charge,
            sag: battery.sag,
            hotel_per_tick: battery.hotel_power_watt * dt_s / battery.capacity_joule,
            full_per_tick: battery.full_power_watt * dt_s / battery.capacity_joule,
        }
    }

    /// Thrust factor at this charge.
    #[inline]
    pub fn thrust_factor(&self, charge: f64) -> f64 {
        1.0 - self.sag * (1.0 - charge)
    }

    /// Subtracts one tick's energy, for thrusters at these fractions (0 to 1) of full thrust.
    #[inline]
    pub fn draw(&self, charge: &mut f64, shares: [f64; 2]) {
        // Not `powf`, whose last bit differs between platforms.
        let [port, starboard] = shares.map(|share| share * share.sqrt());
        let spent = self.hotel_per_tick + self.full_per_tick * 0.5 * (port + starboard);
        // An empty battery still supplies power; it only reduces the thrust.
        *charge = (*charge - spent).max(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BATTERY: Battery = Battery {
        capacity_joule: 36_000.0,
        charge: 0.8,
        full_power_watt: 720.0,
        hotel_power_watt: 36.0,
        sag: 0.15,
    };

    fn charge_after(shares: [f64; 2], seconds: u32) -> f64 {
        let model = BatteryModel::new(&BATTERY, 0.05);
        let mut charge = model.charge;
        (0..20 * seconds).for_each(|_| model.draw(&mut charge, shares));
        charge
    }

    #[test]
    fn the_charge_falls_by_the_energy_drawn() {
        for (shares, watt) in [
            ([0.0, 0.0], 36.0),
            ([1.0, 1.0], 756.0),
            ([1.0, 0.0], 396.0),
            // 0.25^1.5 is an eighth.
            ([0.25, 0.25], 126.0),
        ] {
            let want = 0.8 - watt * 30.0 / 36_000.0;
            let got = charge_after(shares, 30);
            assert!((got - want).abs() < 1e-12, "{shares:?}: {got}, want {want}");
        }
        assert_eq!(charge_after([1.0, 1.0], 100), 0.0, "empty is empty");
    }
}
