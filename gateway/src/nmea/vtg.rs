//! `VTG`, course and speed over ground.

use super::field::Fields;
use super::{Line, ParseError, Talker};

/// `VTG`.
#[derive(Clone, Debug, PartialEq)]
pub struct Vtg {
    /// Who says so.
    pub talker: Talker,
    /// Course over ground, degrees true; none at rest, which is not north.
    pub course_true_deg: Option<f64>,
    /// Course over ground, degrees magnetic.
    pub course_magnetic_deg: Option<f64>,
    /// Speed over ground, knots.
    pub speed_kn: Option<f64>,
    /// Speed over ground, km/h.
    pub speed_km_h: Option<f64>,
    /// Whether a ninth field says how the fix was made: boats of 2024 have none.
    pub with_mode: bool,
}

impl Vtg {
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Vtg, ParseError> {
        fields.at_least(8)?;
        for (at, letter) in [(2, "T"), (4, "M"), (6, "N"), (8, "K")] {
            fields.unit(at, letter)?;
        }
        Ok(Vtg {
            talker,
            course_true_deg: fields.number(1)?,
            course_magnetic_deg: fields.number(3)?,
            speed_kn: fields.number(5)?,
            speed_km_h: fields.number(7)?,
            with_mode: fields.len() > 8,
        })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.compass(self.course_true_deg, 5, 1);
        line.fixed("T");
        line.compass(self.course_magnetic_deg, 5, 1);
        line.fixed("M");
        line.number(self.speed_kn, 2);
        line.fixed("N");
        line.number(self.speed_km_h, 2);
        line.fixed("K");
        if self.with_mode {
            line.fixed(if self.speed_kn.or(self.speed_km_h).is_some() { "A" } else { "N" });
        }
        line.end();
    }
}
