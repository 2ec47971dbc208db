//! `PSEAG`, the boat's error code.

use super::field::Fields;
use super::{Line, ParseError};

/// `PSEAG`. `N` means that nothing is wrong; what other codes mean is not published.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BoatError {
    /// The code as sent.
    pub code: String,
}

impl BoatError {
    pub(super) fn read(fields: &Fields) -> Result<BoatError, ParseError> {
        fields.at_least(1)?;
        Ok(BoatError { code: fields.text(1).to_owned() })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.words(&self.code);
        line.end();
    }
}
