//! `OIWPL`, a waypoint of a mission that is being uploaded.

use super::field::Fields;
use super::{Line, ParseError};
use game::LatLon;

/// `OIWPL`. Four decimals of minutes place it to 0.1 m.
#[derive(Clone, Debug, PartialEq)]
pub struct Waypoint {
    /// Where.
    pub at: LatLon,
    /// Its number; 0 is the emergency recovery point.
    pub index: u16,
}

impl Waypoint {
    pub(super) fn read(fields: &Fields) -> Result<Waypoint, ParseError> {
        fields.at_least(5)?;
        let at = fields.position(1)?.ok_or_else(|| fields.wrong(1, "a latitude"))?;
        let index = fields.whole(5)?.ok_or_else(|| fields.wrong(5, "the waypoint's number"))?;
        Ok(Waypoint { at, index })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.position(Some(self.at), 4);
        line.fixed(&self.index.to_string());
        line.end();
    }
}
