//! `HDT`, the true heading.

use super::field::Fields;
use super::{Line, ParseError, Talker};

/// `HDT`.
#[derive(Clone, Debug, PartialEq)]
pub struct Hdt {
    /// Who says so.
    pub talker: Talker,
    /// Heading, degrees true.
    pub heading_deg: Option<f64>,
}

impl Hdt {
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Hdt, ParseError> {
        fields.at_least(1)?;
        fields.unit(2, "T")?;
        Ok(Hdt { talker, heading_deg: fields.number(1)? })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.compass(self.heading_deg, 5, 1);
        line.fixed("T");
        line.end();
    }
}
