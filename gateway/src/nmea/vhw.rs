//! `VHW`, the log: heading, and speed through the water.

use super::field::Fields;
use super::{Line, ParseError, Talker};

/// One knot, km/h.
const KNOT_KM_H: f64 = 1.852;

/// `VHW`.
#[derive(Clone, Debug, PartialEq)]
pub struct Vhw {
    /// Who says so.
    pub talker: Talker,
    /// Heading, degrees true.
    pub heading_true_deg: Option<f64>,
    /// Heading, degrees magnetic.
    pub heading_magnetic_deg: Option<f64>,
    /// Speed through the water, knots.
    pub speed_kn: Option<f64>,
}

impl Vhw {
    /// Takes the speed from km/h where there are no knots.
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Vhw, ParseError> {
        fields.at_least(6)?;
        for (at, letter) in [(2, "T"), (4, "M"), (6, "N"), (8, "K")] {
            fields.unit(at, letter)?;
        }
        let speed_kn = fields.number(5)?;
        let speed_km_h = fields.number(7)?;
        Ok(Vhw {
            talker,
            heading_true_deg: fields.number(1)?,
            heading_magnetic_deg: fields.number(3)?,
            speed_kn: speed_kn.or(speed_km_h.map(|speed_km_h| speed_km_h / KNOT_KM_H)),
        })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.compass(self.heading_true_deg, 5, 1);
        line.fixed("T");
        line.compass(self.heading_magnetic_deg, 5, 1);
        line.fixed("M");
        line.number(self.speed_kn, 2);
        line.fixed("N");
        line.number(self.speed_kn.map(|speed_kn| speed_kn * KNOT_KM_H), 2);
        line.fixed("K");
        line.end();
    }
}
