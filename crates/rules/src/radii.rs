//! The radii of the circles around a flag: its own, or else the rules'.

use super::Rules;
use crate::field::Flag;

/// Radii around a flag's home, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Radii {
    /// Maximum distance for a grab.
    pub grab_m: f64,
    /// Maximum distance for a capture at this flag.
    pub capture_m: f64,
    /// Maximum distance for untagging at this flag.
    pub untag_m: f64,
    /// Minimum distance of its team's boats while it is home; 0: no limit.
    pub keepout_m: f64,
}

impl Rules {
    /// The radii of flags without their own.
    pub fn radii(&self) -> Radii {
        Radii {
            grab_m: self.grab_radius_m,
            capture_m: self.capture_radius_m,
            untag_m: self.untag_radius_m,
            keepout_m: self.flag_keepout_m,
        }
    }

    /// The radii of a flag. Everything that concerns a particular flag uses these.
    #[inline]
    pub fn radii_of(&self, flag: &Flag) -> Radii {
        let own = &flag.settings.radii;
        let usual = self.radii();
        Radii {
            grab_m: own.grab_radius_m.unwrap_or(usual.grab_m),
            capture_m: own.capture_radius_m.unwrap_or(usual.capture_m),
            untag_m: own.untag_radius_m.unwrap_or(usual.untag_m),
            keepout_m: own.flag_keepout_m.unwrap_or(usual.keepout_m),
        }
    }
}
