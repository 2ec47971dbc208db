//! The battery of an emulated boat: its thrusters drain it, and its voltage falls.

use super::autopilot::speed_of_thrust;
use crate::lithium;
use messages::Order;
use primitives::SimTime;

/// Maximum time step, s; a longer one means that the sim was not running.
const STEP_MAX_S: f64 = 10.0;

/// The properties of a battery and its loads.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pack {
    /// Cells in series.
    cells: f64,
    /// Capacity, Ah.
    capacity_ah: f64,
    /// Internal resistance, ohm.
    resistance_ohm: f64,
    /// Current of the electronics, A.
    pub(super) system_a: f64,
    /// Power of a thruster at full thrust ahead, W.
    thruster_w: f64,
}

impl Pack {
    /// The Surveyor's battery: 24 V, 1500 Wh and thrusters of 1000 W, from its specification. Boats
    /// reported 24.8 V with 15433 of 57741 left. If these counts are in mAh, this matches seven
    /// lithium cells at that charge.
    pub(super) const SURVEYOR: Pack = Pack {
        cells: 7.0,
        capacity_ah: 57.741,
        resistance_ohm: 0.03,
        system_a: 1.3,
        thruster_w: 1000.0,
    };
    /// A pack like a BlueBoat's: two lithium batteries of 14.8 V and 18 Ah, and thrusters of about
    /// 250 W.
    pub(super) const BLUEBOAT: Pack = Pack {
        cells: 4.0,
        capacity_ah: 36.0,
        resistance_ohm: 0.02,
        system_a: 1.3,
        thruster_w: 250.0,
    };
}

/// A battery with its charge.
#[derive(Clone, Debug)]
pub(super) struct Battery {
    pub(super) pack: Pack,
    /// Charge left, as a fraction.
    pub(super) left: f64,
    /// Whether it drains.
    drains: bool,
    /// Charge used since the start, Ah.
    used_ah: f64,
    /// Current of each thruster, port first, A.
    pub(super) thruster_a: [f64; 2],
    at: Option<SimTime>,
    /// The voltage reported regardless of the charge, V.
    pub(super) shown_v: Option<f64>,
}

impl Battery {
    /// A battery with this fraction of its charge left; `None` means full, without drain.
    pub(super) fn new(pack: Pack, left: Option<f64>) -> Battery {
        Battery {
            pack,
            left: left.unwrap_or(1.0).clamp(0.0, 1.0),
            drains: left.is_some(),
            used_ah: 0.0,
            thruster_a: [0.0; 2],
            at: None,
            shown_v: None,
        }
    }

    /// Advances time under an order. Returns the order as executed: an empty battery drives no
    /// thrusters.
    pub(super) fn carry_out(&mut self, now: SimTime, order: Order) -> Order {
        let step_s = self
            .at
            .replace(now)
            .map_or(0.0, |at| (now - at).as_s().clamp(0.0, STEP_MAX_S));
        let drawn_ah = self.amps() * step_s / 3600.0;
        self.used_ah += drawn_ah;
        if self.drains {
            self.left = (self.left - drawn_ah / self.pack.capacity_ah).max(0.0);
        }
        // Reports continue: a boat's electronics outlast its thrusters.
        let order = if self.left > 0.0 { order } else { Order::Hold };
        let rest_v = self.rest_v();
        // Use the voltage at rest, not under load: a loop through the resistance would need
        // iteration, for a few per cent of accuracy.
        self.thruster_a = powers(order).map(|share| share * self.pack.thruster_w / rest_v);
        order
    }

    /// The total current, A.
    pub(super) fn amps(&self) -> f64 {
        self.pack.system_a + self.thruster_a[0] + self.thruster_a[1]
    }

    /// The voltage under load, V.
    pub(super) fn volts(&self) -> f64 {
        self.shown_v
            .unwrap_or_else(|| self.rest_v() - self.amps() * self.pack.resistance_ohm)
    }

    /// Charge left, mAh.
    pub(super) fn left_mah(&self) -> f64 {
        1000.0 * self.left * self.pack.capacity_ah
    }

    /// Charge used since the start, mAh.
    pub(super) fn used_mah(&self) -> f64 {
        1000.0 * self.used_ah
    }

    fn rest_v(&self) -> f64 {
        self.pack.cells * lithium::cell_volts(self.left)
    }
}

/// The power of each thruster under an order, port first, as a fraction of full power.
fn powers(order: Order) -> [f64; 2] {
    let full_m_s = speed_of_thrust(100.0);
    let of_speed = |speed_m_s: f64| {
        let share = (speed_m_s / full_m_s).clamp(0.0, 1.0);
        // Power is proportional to the cube of the speed, so at 40 % thrust the battery lasts far
        // more than 2.5 times as long as at full thrust.
        share * share * share
    };
    match order {
        Order::Hold => [0.0; 2],
        Order::Steer { speed_m_s, .. } | Order::Turn { speed_m_s, .. } => [of_speed(speed_m_s); 2],
        Order::Thrust { port, starboard } => {
            [port, starboard].map(|share| of_speed(speed_of_thrust(100.0 * share.abs())))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: Order = Order::Thrust {
        port: 0.4,
        starboard: 0.4,
    };

    /// The battery after this many hours of an order, in steps of one second.
    fn after(mut battery: Battery, hours: f64, order: Order) -> (Battery, Order) {
        let mut carried_out = order;
        for s in 0..=(3600.0 * hours) as u32 {
            carried_out = battery.carry_out(SimTime::from_s(f64::from(s)), order);
        }
        (battery, carried_out)
    }

    #[test]
    fn a_surveyor_shows_what_was_seen_on_one() {
        // $PSEAB,24.8,15433,1.3,22.3,42308,,,24.8,,1.3,0.0,0.0,,,26: received from a boat at rest.
        let (battery, _) = after(
            Battery::new(Pack::SURVEYOR, Some(15_433.0 / 57_741.0)),
            0.0,
            Order::Hold,
        );
        assert!((battery.volts() - 24.8).abs() < 0.2, "{}", battery.volts());
        assert!((battery.left_mah() - 15_433.0).abs() < 1.0 && (battery.amps() - 1.3).abs() < 1e-9);
    }

    #[test]
    fn it_holds_as_much_energy_as_the_specification_says_and_then_turns_no_thruster() {
        let mut battery = Battery::new(Pack::SURVEYOR, Some(1.0));
        let mut joules = 0.0;
        let mut s = 0.0;
        let first_v = battery.volts();
        while battery.left > 0.0 {
            s += 1.0;
            assert!(s < 86_400.0, "it lasts forever");
            assert!(battery.carry_out(SimTime::from_s(s), HALF) == HALF || battery.left == 0.0);
            joules += battery.volts() * battery.amps();
        }
        let wh = joules / 3600.0;
        let hours = s / 3600.0;
        assert!((1400.0..1600.0).contains(&wh), "{wh} Wh, expected 1500");
        // 1.5 m/s is half the maximum speed: an eighth of 2000 W, plus 33 W for the electronics.
        assert!((hours - 1500.0 / 283.0).abs() < 0.5, "{hours} h");
        assert!(
            first_v > 29.0 && battery.volts() < 21.5,
            "{first_v} V, {} V",
            battery.volts()
        );
        let (battery, carried_out) = after(battery, 0.1, HALF);
        assert_eq!((carried_out, battery.thruster_a), (Order::Hold, [0.0; 2]));
        assert!(
            (battery.used_mah() - 57_741.0).abs() < 300.0,
            "{} mAh",
            battery.used_mah()
        );
    }

    #[test]
    fn each_thruster_draws_for_itself_and_full_thrust_draws_all() {
        let thrust = |port, starboard| Order::Thrust { port, starboard };
        let drawn = |order| {
            after(Battery::new(Pack::SURVEYOR, Some(0.5)), 0.0, order)
                .0
                .thruster_a
        };
        let [port_a, starboard_a] = drawn(thrust(1.0, 0.0));
        assert!(
            (port_a - 1000.0 / (7.0 * 3.7)).abs() < 1e-9 && starboard_a == 0.0,
            "{port_a} A, {starboard_a} A"
        );
        let [ahead, astern] = drawn(thrust(0.4, -0.4));
        assert_eq!(ahead, astern);
        assert_eq!(
            drawn(Order::Steer {
                heading_rad: 1.0,
                speed_m_s: 1.5
            }),
            drawn(HALF)
        );
    }
}
