//! What boats report of themselves, whichever protocol they speak.

use crate::nmea::{FixQuality, Mode, Operator, TimeOfDay};
use primitives::LatLon;
use primitives::frame::Ned;

/// Something that a boat reports.
#[derive(Clone, Debug, PartialEq)]
pub enum Report {
    /// A fix of its receiver.
    Fix(Fix),
    /// Velocity over the ground, m/s.
    Velocity(Ned),
    /// Its heading.
    Heading(Heading),
    /// How it lies, roll and pitch in degrees.
    Tilt([f64; 2]),
    /// The receiver's time of day.
    Clock(TimeOfDay),
    /// What it does, and who commands it.
    Control(ControlReport),
    /// Somebody else was heard to send it a set-point.
    ForeignOrder,
    /// A ground station that is not we was heard for the first time: this is told to people.
    Station(String),
    /// Its battery, and who draws from it.
    Power(Power),
    /// The error that it is in; `None` is none.
    Error(Option<String>),
    /// Something that it says once and people should know.
    Notice(String),
    /// Where its home is, to which it goes for recovery: latitude and longitude, degrees.
    Home([f64; 2]),
}

/// What the battery gives, and who draws how much; what is not measured is missing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Power {
    /// Voltage, V.
    pub volts: Option<f64>,
    /// Current of the thrusters, port first, A.
    pub thruster_a: [Option<f64>; 2],
    /// Current of the bilge pumps, port first, A.
    pub bilge_a: [Option<f64>; 2],
}

/// A fix of the receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fix {
    /// When, by the receiver. A fix of the same time and position as the one before is no new one.
    pub time: Option<TimeOfDay>,
    /// Where; nothing if the receiver does not know.
    pub at: Option<LatLon>,
    /// Its quality, if it is told.
    pub quality: Option<FixQuality>,
    /// The horizontal dilution of precision, if it is told.
    pub hdop: Option<f64>,
    /// How many satellites it is made of, if that is told.
    pub satellites: Option<u8>,
}

/// A heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heading {
    /// Degrees.
    pub deg: f64,
    /// From which north.
    pub north: North,
    /// Rate of turn, degrees a second, if it is told.
    pub yaw_rate_deg_s: Option<f64>,
}

/// What a heading counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum North {
    /// True north.
    True,
    /// The one of the boat's compass: the gateway's file says which that is.
    Compass,
}

/// What a boat does, and who commands it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlReport {
    /// What it shows of the command that it follows.
    pub shown: Shown,
    /// Who commands it, if it says so.
    pub operator: Option<Operator>,
}

/// What a boat shows of a command, or should show.
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
