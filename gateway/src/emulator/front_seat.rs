//! The front seat of an emulated boat, whichever protocol it speaks.

use super::Port;
use crate::nmea::Operator;
use messages::Order;
use messages::picture::OwnBoat;
use primitives::SimTime;

/// The front seat.
pub trait FrontSeat: Send {
    /// Sets the receiver's clock: UTC, ns since 1970.
    fn set_clock(&mut self, now: SimTime, utc_ns: u64);

    /// Receives bytes from a port. Replies are sent with the next telemetry.
    fn receive(&mut self, now: SimTime, port: Port, bytes: &[u8]);

    /// The next log message, if any.
    fn take_remark(&mut self) -> Option<String>;

    /// The operator in control, if that depends on ports.
    fn operator(&self) -> Option<Operator>;

    /// Updates the sensor measurements.
    fn observe(&mut self, now: SimTime, own: &OwnBoat);

    /// The boat's order to its thrusters now.
    fn order(&mut self, now: SimTime) -> Order;

    /// Appends the telemetry that is due.
    fn telemetry(&mut self, now: SimTime, out: &mut Vec<u8>);
}
