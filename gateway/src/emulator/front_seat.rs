//! The front seat of an emulated boat, with either protocol.

use super::Port;
use crate::nmea::Operator;
use messages::picture::OwnBoat;
use messages::{Order, VehicleTruth};
use primitives::SimTime;

/// The front seat.
pub trait FrontSeat: Send {
    /// Sets the receiver's clock to UTC, ns since 1970.
    fn set_clock(&mut self, _now: SimTime, _utc_ns: u64) {}

    /// Receives bytes from a port. Replies are sent with the next telemetry.
    fn receive(&mut self, _now: SimTime, _port: Port, _bytes: &[u8]) {}

    /// The next log message, if any.
    fn take_remark(&mut self) -> Option<String>;

    /// The operator in control, if this depends on ports.
    fn operator(&self) -> Option<Operator> {
        None
    }

    /// Updates the sensor measurements.
    fn observe(&mut self, _now: SimTime, _own: &OwnBoat) {}

    /// Receives the boat's true motion, for front seats with their own sensors.
    fn observe_truth(&mut self, _now: SimTime, _truth: &VehicleTruth) {}

    /// The boat's current order to its thrusters.
    fn order(&mut self, now: SimTime) -> Order;

    /// Appends the telemetry that is due.
    fn telemetry(&mut self, _now: SimTime, _out: &mut Vec<u8>) {}
}
