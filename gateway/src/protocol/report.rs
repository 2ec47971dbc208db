//! The reports of boats, common to all protocols.

use crate::nmea::{FixQuality, Mode, Operator, TimeOfDay};
use primitives::LatLon;
use primitives::frame::Ned;

/// A report from a boat.
#[derive(Clone, Debug, PartialEq)]
pub enum Report {
    /// A fix from the boat's receiver.
    Fix(Fix),
    /// Velocity over the ground, m/s.
    Velocity(Ned),
    /// The boat's heading.
    Heading(Heading),
    /// The boat's attitude: roll and pitch in degrees.
    Tilt([f64; 2]),
    /// The receiver's time of day.
    Clock(TimeOfDay),
    /// The boat's mode, and who commands the boat.
    Control(ControlReport),
    /// A set-point for the boat from another sender was received.
    ForeignOrder,
    /// Another ground station was heard for the first time; operators are notified.
    Station(String),
    /// The boat's battery and electrical loads.
    Power(Power),
    /// The boat's current error; `None` means no error.
    Error(Option<String>),
    /// A single message for operators.
    Notice(String),
    /// The position of the boat's home, where it goes for recovery: latitude and longitude,
    /// degrees.
    Home([f64; 2]),
}

/// Battery and electrical loads; values that are not measured are missing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// Voltage, V.
    pub volts: Option<f64>,
    /// Charge left, per cent.
    pub left_pct: Option<f64>,
    /// Current of the thrusters, port first, A.
    pub thruster_a: [Option<f64>; 2],
    /// Current of the bilge pumps, port first, A.
    pub bilge_a: [Option<f64>; 2],
}

/// A fix of the receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fix {
    /// The receiver's time. A fix with the same time and position as the previous one is not new.
    pub time: Option<TimeOfDay>,
    /// The position; `None` if the receiver does not know it.
    pub at: Option<LatLon>,
    /// The fix quality, if reported.
    pub quality: Option<FixQuality>,
    /// The horizontal dilution of precision, if reported.
    pub hdop: Option<f64>,
    /// The number of satellites used, if reported.
    pub satellites: Option<u8>,
}

/// A heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// Degrees.
    pub deg: f64,
    /// The reference of the heading.
    pub north: North,
    /// Rate of turn, degrees a second, if reported.
    pub yaw_rate_deg_s: Option<f64>,
}

/// The reference of a heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum North {
    /// True north.
    True,
    /// The reference of the boat's compass, as stated in the gateway file.
    Compass,
}

/// A boat's mode, and who commands it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlReport {
    /// The command that the boat follows, according to its report.
    pub shown: Shown,
    /// Who commands the boat, if reported.
    pub operator: Option<Operator>,
}

/// A command as a boat reports it, or should report it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The mode.
    pub mode: Mode,
    /// Heading, degrees.
    pub heading_deg: Option<f64>,
    /// Thrust, per cent; in [`Mode::Speed`] the speed in knots.
    pub thrust: Option<f64>,
    /// Thrust difference, per cent.
    pub difference: Option<f64>,
}
