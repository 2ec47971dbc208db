//! `RMC`, a fix with course, speed and date: the least that a chart plotter wants.

use super::field::Fields;
use super::{Date, Line, ParseError, Talker, TimeOfDay};
use game::LatLon;

/// `RMC`.
#[derive(Clone, Debug, PartialEq)]
pub struct Rmc {
    /// Who says so.
    pub talker: Talker,
    /// Time of the fix.
    pub time: Option<TimeOfDay>,
    /// Whether the receiver vouches for it.
    pub valid: bool,
    /// Where the antenna is.
    pub at: Option<LatLon>,
    /// Speed over ground, knots.
    pub speed_kn: Option<f64>,
    /// Course over ground, degrees true; none at rest.
    pub course_deg: Option<f64>,
    /// Date of the fix.
    pub date: Option<Date>,
}

impl Rmc {
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Rmc, ParseError> {
        fields.at_least(9)?;
        Ok(Rmc {
            talker,
            time: fields.time(1)?,
            valid: fields.valid(2)?,
            at: fields.position(3)?,
            speed_kn: fields.number(7)?,
            course_deg: fields.number(8)?,
            date: fields.date(9)?,
        })
    }

    /// Writes 12 fields: no magnetic variation, and a mode of autonomous or not valid.
    pub(super) fn write(&self, mut line: Line) {
        line.time(self.time);
        line.fixed(if self.valid { "A" } else { "V" });
        line.position(self.at, 5);
        line.number(self.speed_kn, 2);
        line.compass(self.course_deg, 5, 1);
        line.date(self.date);
        line.empty();
        line.empty();
        line.fixed(if self.valid { "A" } else { "N" });
        line.end();
    }
}
