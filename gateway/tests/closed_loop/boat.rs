//! A boat with simple dynamics, and the plan of its emulated front seat.

use gateway::emulator;
use gateway::nmea::{Date, TimeOfDay};
use messages::Order;
use messages::picture::{Imu, Nav, OwnBoat};
use primitives::frame::{LatLon, Ned, Rotation};
use primitives::{SimTime, VehicleId};

/// Duration of a step, s.
pub(crate) const STEP_S: f64 = 0.01;

/// A boat that responds to thrust with a lag.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Boat {
    pub(crate) at: Ned,
    pub(crate) psi_rad: f64,
    pub(crate) speed_m_s: f64,
    pub(crate) turn_rad_s: f64,
}

impl Boat {
    /// Advances by one step: thrust and speed have a lag of two seconds, thrust difference and turn
    /// rate a lag of half a second.
    pub(crate) fn step(&mut self, order: Order) {
        let (speed_m_s, turn_rad_s) = match order {
            Order::Hold => (0.0, 0.0),
            Order::Thrust { port, starboard } => {
                (1.6 * (port + starboard), 1.5 * (port - starboard))
            }
            Order::Steer {
                heading_rad,
                speed_m_s,
            } => {
                let error_rad = primitives::angle::wrap_pi(heading_rad - self.psi_rad);
                (speed_m_s, error_rad.clamp(-0.5, 0.5))
            }
            Order::Turn { by_rad, speed_m_s } => (speed_m_s, by_rad.clamp(-0.5, 0.5)),
        };
        self.speed_m_s += (speed_m_s - self.speed_m_s) * STEP_S / 2.0;
        self.turn_rad_s += (turn_rad_s - self.turn_rad_s) * STEP_S / 0.5;
        self.psi_rad = primitives::angle::wrap_pi(self.psi_rad + self.turn_rad_s * STEP_S);
        self.at = self.at
            + Rotation::from_heading(self.psi_rad)
                .ahead()
                .scaled(self.speed_m_s * STEP_S);
    }

    /// The boat's sensor readings if its receiver reports `place`.
    pub(crate) fn measured(&self, now: SimTime, place: Ned) -> OwnBoat {
        let nav = Nav {
            north_m: place.north,
            east_m: place.east,
            psi_rad: self.psi_rad,
            surge_m_s: self.speed_m_s,
            sway_m_s: 0.0,
            yaw_rate_rad_s: self.turn_rad_s,
        };
        let imu = Imu {
            down_m_s2: -9.8,
            ..Imu::default()
        };
        OwnBoat {
            fix_ns: now,
            imu,
            ..OwnBoat::new(VehicleId(0), nav)
        }
    }
}

/// The plan of an emulated boat.
pub(crate) fn emulated(datum: LatLon, declination_rad: f64) -> emulator::Plan {
    emulator::Plan {
        datum,
        declination_rad,
        watchdog_s: None,
        integers: false,
        extra: vec![],
        began: (
            Date {
                year: 2026,
                month: 11,
                day: 20,
            },
            TimeOfDay(54_302_000),
        ),
        charge: Some(1.0),
    }
}
