//! The control modes of a Surveyor, by their letters on the wire.

use serde::{Deserialize, Serialize};

/// A control mode that a boat's own controller receives or reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Mode {
    /// `L`: thrusters idle.
    #[default]
    Standby,
    /// `T`: thrust and difference as commanded.
    Thruster,
    /// `C`: hold a compass heading at a thrust.
    Heading,
    /// `G`: hold a heading and a speed.
    Speed,
    /// `R`: keep station.
    StationKeep,
    /// `N`: river navigation.
    RiverNav,
    /// `W`: follow the uploaded waypoints.
    Waypoint,
    /// `I`: autopilot.
    Autopilot,
    /// `3`: calibrate the compass.
    CompassCalibration,
    /// `H`: go to the emergency recovery point.
    GoToErp,
    /// `D`: depth.
    Depth,
    /// `S`: gravity vector.
    GravityVector,
    /// `F`: receive a file (a mission) line by line.
    FileDownload,
    /// `!`: boot loader.
    BootLoader,
}

impl Mode {
    /// All modes with their letters.
    // Source: the command dictionary of a public driver for Surveyors; the manufacturer's interface
    // document is not public.
    const LETTERS: [(Mode, char); 14] = [
        (Mode::Standby, 'L'),
        (Mode::Thruster, 'T'),
        (Mode::Heading, 'C'),
        (Mode::Speed, 'G'),
        (Mode::StationKeep, 'R'),
        (Mode::RiverNav, 'N'),
        (Mode::Waypoint, 'W'),
        (Mode::Autopilot, 'I'),
        (Mode::CompassCalibration, '3'),
        (Mode::GoToErp, 'H'),
        (Mode::Depth, 'D'),
        (Mode::GravityVector, 'S'),
        (Mode::FileDownload, 'F'),
        (Mode::BootLoader, '!'),
    ];

    /// All modes, in the order above.
    pub fn all() -> [Mode; 14] {
        Mode::LETTERS.map(|(mode, _)| mode)
    }

    /// Whether the boat follows set-points in this mode.
    pub fn is_set_point(self) -> bool {
        matches!(self, Mode::Thruster | Mode::Heading | Mode::Speed)
    }

    /// The letter on the wire.
    pub fn letter(self) -> char {
        Mode::LETTERS[self as usize].1
    }

    /// The mode with a letter, which is case-sensitive.
    pub fn from_letter(letter: char) -> Option<Mode> {
        Mode::LETTERS
            .iter()
            .find(|(_, known)| *known == letter)
            .map(|(mode, _)| *mode)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_mode_is_found_by_its_letter() {
        for (mode, letter) in Mode::LETTERS {
            assert_eq!(
                (mode.letter(), Mode::from_letter(letter)),
                (letter, Some(mode))
            );
        }
        for unknown in ['l', 'X', ' ', '0', 'é'] {
            assert_eq!(Mode::from_letter(unknown), None, "{unknown:?}");
        }
    }
}
