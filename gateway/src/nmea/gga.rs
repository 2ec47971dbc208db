//! `GGA`, a fix: when, where, how good.

use super::field::Fields;
use super::{Line, ParseError, Talker, TimeOfDay};
use game::LatLon;

/// `GGA`.
#[derive(Clone, Debug, PartialEq)]
pub struct Gga {
    /// Who says so.
    pub talker: Talker,
    /// Time of the fix.
    pub time: Option<TimeOfDay>,
    /// Where the antenna is.
    pub at: Option<LatLon>,
    /// How the fix was made: 0 not at all, 1 GPS, 2 differential, 4 RTK, 5 float. An empty field is 0.
    pub quality: u8,
    /// Satellites used.
    pub satellites: Option<u8>,
    /// Horizontal dilution of precision.
    pub hdop: Option<f64>,
    /// Height of the antenna above the geoid, m.
    pub altitude_m: Option<f64>,
    /// Height of the geoid above the ellipsoid, m.
    pub geoid_m: Option<f64>,
}

impl Gga {
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Gga, ParseError> {
        fields.at_least(6)?;
        fields.unit(10, "M")?;
        fields.unit(12, "M")?;
        Ok(Gga {
            talker,
            time: fields.time(1)?,
            at: fields.position(2)?,
            quality: fields.whole(6)?.unwrap_or_default(),
            satellites: fields.whole(7)?,
            hdop: fields.number(8)?,
            altitude_m: fields.number(9)?,
            geoid_m: fields.number(11)?,
        })
    }

    /// Writes 14 fields. The last, the reference station, must be empty: the driver of the fleet counts fields
    /// after it has dropped one empty one from the end, and with a station has no position at all.
    pub(super) fn write(&self, mut line: Line) {
        line.time(self.time);
        line.position(self.at, 5);
        line.fixed(&self.quality.to_string());
        line.words(&self.satellites.map_or_else(String::new, |number| format!("{number:02}")));
        line.number(self.hdop, 2);
        line.number(self.altitude_m, 1);
        line.fixed("M");
        line.number(self.geoid_m, 1);
        line.fixed("M");
        line.empty();
        line.empty();
        line.end();
    }
}
