//! `HDG`, the magnetic heading with what makes it true.

use super::field::Fields;
use super::{Line, ParseError, Talker};

/// `HDG`.
#[derive(Clone, Debug, PartialEq)]
pub struct Hdg {
    /// Who says so.
    pub talker: Talker,
    /// Heading by the sensor, degrees.
    pub heading_deg: Option<f64>,
    /// What the boat's own iron adds, degrees, east positive.
    pub deviation_deg: Option<f64>,
    /// What the earth's field adds (declination), degrees, east positive.
    pub variation_deg: Option<f64>,
}

impl Hdg {
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Hdg, ParseError> {
        fields.at_least(1)?;
        Ok(Hdg {
            talker,
            heading_deg: fields.number(1)?,
            deviation_deg: fields.east(2)?,
            variation_deg: fields.east(4)?,
        })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.compass(self.heading_deg, 5, 1);
        line.east(self.deviation_deg, 1);
        line.east(self.variation_deg, 1);
        line.end();
    }
}
