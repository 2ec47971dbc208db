//! `MWV`, wind: where it comes from, seen from the bow, and how strong it is.

use super::field::Fields;
use super::{Line, ParseError, Talker};

/// `MWV`.
#[derive(Clone, Debug, PartialEq)]
pub struct Mwv {
    /// Who says so.
    pub talker: Talker,
    /// Where the wind comes from, degrees clockwise from the bow.
    pub angle_deg: Option<f64>,
    /// Which wind.
    pub reference: WindReference,
    /// How strong it is, m/s, whatever the unit on the wire.
    pub speed_m_s: Option<f64>,
    /// The unit on the wire.
    pub unit: SpeedUnit,
    /// Whether the sensor vouches for it.
    pub valid: bool,
}

/// Which wind an [`Mwv`] tells of. Both are angles from the bow, neither is a compass bearing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindReference {
    /// `R`: as felt on the moving boat.
    Relative,
    /// `T`: as it would be felt on the same boat at rest.
    Theoretical,
}

/// The unit of a speed on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpeedUnit {
    /// `M`.
    MetresPerSecond,
    /// `K`.
    KilometresPerHour,
    /// `N`.
    Knots,
    /// `S`: statute.
    MilesPerHour,
}

impl SpeedUnit {
    const LETTERS: [(SpeedUnit, &'static str); 4] = [
        (SpeedUnit::MetresPerSecond, "M"),
        (SpeedUnit::KilometresPerHour, "K"),
        (SpeedUnit::Knots, "N"),
        (SpeedUnit::MilesPerHour, "S"),
    ];

    /// One of this unit, m/s.
    #[must_use]
    pub fn m_s(self) -> f64 {
        match self {
            SpeedUnit::MetresPerSecond => 1.0,
            SpeedUnit::KilometresPerHour => 1.0 / 3.6,
            SpeedUnit::Knots => super::M_S_PER_KN,
            SpeedUnit::MilesPerHour => 0.44704,
        }
    }
}

impl Mwv {
    pub(super) fn read(talker: Talker, fields: &Fields) -> Result<Mwv, ParseError> {
        fields.at_least(5)?;
        let reference = match fields.text(2) {
            "R" => WindReference::Relative,
            "T" => WindReference::Theoretical,
            _ => return Err(fields.wrong(2, "R or T")),
        };
        let letter = fields.text(4);
        let unit = SpeedUnit::LETTERS.iter().find(|(_, known)| *known == letter).map(|(unit, _)| *unit);
        let speed = fields.number(3)?;
        // Without a speed nothing is lost with its unit.
        let unit = match (unit, speed) {
            (Some(unit), _) => unit,
            (None, None) if letter.is_empty() => SpeedUnit::MetresPerSecond,
            _ => return Err(fields.wrong(4, "K, M, N or S")),
        };
        let speed_m_s = speed.map(|speed| speed * unit.m_s());
        Ok(Mwv { talker, angle_deg: fields.number(1)?, reference, speed_m_s, unit, valid: fields.valid(5)? })
    }

    pub(super) fn write(&self, mut line: Line) {
        line.compass(self.angle_deg, 5, 1);
        line.fixed(match self.reference {
            WindReference::Relative => "R",
            WindReference::Theoretical => "T",
        });
        line.number(self.speed_m_s.map(|speed_m_s| speed_m_s / self.unit.m_s()), 1);
        line.fixed(SpeedUnit::LETTERS[self.unit as usize].1);
        line.fixed(if self.valid { "A" } else { "V" });
        line.end();
    }
}
