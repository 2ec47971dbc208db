//! The front seat of an emulated boat, whichever protocol it speaks.

use super::{ArduPilot, Emulator, Port};
use crate::nmea::{Operator, date_and_time};
use messages::Order;
use messages::picture::OwnBoat;
use primitives::SimTime;

/// The front seat.
pub enum FrontSeat {
    /// A Surveyor's.
    Surveyor(Box<Emulator>),
    /// An ArduPilot boat's, which speaks MAVLink.
    ArduPilot(Box<ArduPilot>),
}

impl FrontSeat {
    /// Sets the receiver's clock: UTC, ns since 1970.
    pub fn set_clock(&mut self, now: SimTime, utc_ns: u64) {
        match self {
            FrontSeat::Surveyor(boat) => boat.set_clock(now, date_and_time(utc_ns)),
            FrontSeat::ArduPilot(boat) => boat.set_clock(now, utc_ns),
        }
    }

    /// Receives bytes from a port. Replies are sent with the next telemetry.
    pub fn receive(&mut self, now: SimTime, port: Port, bytes: &[u8]) {
        match self {
            FrontSeat::Surveyor(boat) => boat.receive(now, port, bytes),
            FrontSeat::ArduPilot(boat) => boat.receive(now, bytes),
        }
    }

    /// The next log message, if any.
    pub fn take_remark(&mut self) -> Option<String> {
        match self {
            FrontSeat::Surveyor(boat) => boat.take_remark(),
            FrontSeat::ArduPilot(boat) => boat.take_remark(),
        }
    }

    /// The operator in control, if that depends on ports.
    #[must_use]
    pub fn operator(&self) -> Option<Operator> {
        match self {
            FrontSeat::Surveyor(boat) => Some(boat.operator()),
            FrontSeat::ArduPilot(_) => None,
        }
    }

    /// Updates the sensor measurements.
    pub fn observe(&mut self, now: SimTime, own: &OwnBoat) {
        match self {
            FrontSeat::Surveyor(boat) => boat.observe(now, own),
            FrontSeat::ArduPilot(boat) => boat.observe(now, own),
        }
    }

    /// The boat's order to its thrusters now.
    pub fn order(&mut self, now: SimTime) -> Order {
        match self {
            FrontSeat::Surveyor(boat) => boat.order(now),
            FrontSeat::ArduPilot(boat) => boat.order(now),
        }
    }

    /// Appends the telemetry that is due.
    pub fn telemetry(&mut self, now: SimTime, out: &mut Vec<u8>) {
        match self {
            FrontSeat::Surveyor(boat) => boat.telemetry(now, out),
            FrontSeat::ArduPilot(boat) => boat.telemetry(now, out),
        }
    }
}
