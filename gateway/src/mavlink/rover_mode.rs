//! The modes of ArduPilot Rover, which also runs on boats, by their numbers in HEARTBEAT.

/// A mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RoverMode {
    /// Steering and throttle follow the remote control.
    Manual,
    /// Rate of turn and speed follow the remote control.
    Acro,
    /// Like `Acro`, but turns are limited so that the vehicle does not tip over.
    Steering,
    /// Thrusters idle.
    Hold,
    /// Keeps station.
    Loiter,
    /// Follows the uploaded mission.
    Auto,
    /// Returns home.
    Rtl,
    /// Returns home along its track.
    SmartRtl,
    /// Follows set-points.
    Guided,
    /// Is starting up.
    Initialising,
    /// Any other number.
    // New versions add modes. The number is kept, and the mode is treated as another operator's
    // command.
    Other(u32),
}

impl RoverMode {
    /// The mode for a number.
    pub fn from_number(number: u32) -> RoverMode {
        match number {
            0 => RoverMode::Manual,
            1 => RoverMode::Acro,
            3 => RoverMode::Steering,
            4 => RoverMode::Hold,
            5 => RoverMode::Loiter,
            10 => RoverMode::Auto,
            11 => RoverMode::Rtl,
            12 => RoverMode::SmartRtl,
            15 => RoverMode::Guided,
            16 => RoverMode::Initialising,
            other => RoverMode::Other(other),
        }
    }

    /// Whether Rover can be armed in this mode. Unnamed modes are assumed not to allow arming.
    pub fn allows_arming(self) -> bool {
        !matches!(
            self,
            RoverMode::Rtl | RoverMode::SmartRtl | RoverMode::Initialising | RoverMode::Other(_)
        )
    }

    /// The mode's number.
    pub fn number(self) -> u32 {
        match self {
            RoverMode::Manual => 0,
            RoverMode::Acro => 1,
            RoverMode::Steering => 3,
            RoverMode::Hold => 4,
            RoverMode::Loiter => 5,
            RoverMode::Auto => 10,
            RoverMode::Rtl => 11,
            RoverMode::SmartRtl => 12,
            RoverMode::Guided => 15,
            RoverMode::Initialising => 16,
            RoverMode::Other(number) => number,
        }
    }
}
