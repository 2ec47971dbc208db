//! `PSEAR`, the settings of a mission: how much throttle its waypoints are sailed with.

use super::field::Fields;
use super::{Line, ParseError};

/// `PSEAR`. The other fields are constant in every sample known.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionSettings {
    /// Throttle, percent.
    pub throttle_pct: f64,
}

impl MissionSettings {
    pub(super) fn read(fields: &Fields) -> Result<MissionSettings, ParseError> {
        fields.at_least(3)?;
        let throttle_pct = fields.number(3)?.ok_or_else(|| fields.wrong(3, "a throttle in percent"))?;
        Ok(MissionSettings { throttle_pct })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.fixed("0");
        line.fixed("000");
        line.number(Some(self.throttle_pct.round()), 0);
        line.fixed("0");
        line.fixed("000");
        line.end();
    }
}
