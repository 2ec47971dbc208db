//! `GLL`, a position and its time.

use super::field::Fields;
use super::{Line, ParseError, Talker, TimeOfDay};
use game::LatLon;

/// `GLL`.
#[derive(Clone, Debug, PartialEq)]
pub struct Gll {
    /// Who says so.
    pub talker: Talker,
    /// Where the antenna is.
    pub at: Option<LatLon>,
    /// Time of the fix.
    pub time: Option<TimeOfDay>,
    /// Whether the receiver vouches for it. Old ones have no such field, and it is not taken for granted.
    pub valid: bool,
}

impl Gll {
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Gll, ParseError> {
        fields.at_least(4)?;
        Ok(Gll { talker, at: fields.position(1)?, time: fields.time(5)?, valid: fields.valid(6)? })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.position(self.at, 5);
        line.time(self.time);
        line.fixed(if self.valid { "A" } else { "V" });
        line.fixed(if self.valid { "A" } else { "N" });
        line.end();
    }
}
