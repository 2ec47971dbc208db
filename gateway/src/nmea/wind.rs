//! The reference of a wind sentence, and units of speed.

/// A knot, m/s.
pub const M_S_PER_KN: f64 = 1852.0 / 3600.0;

/// A knot, km/h.
pub(super) const KNOT_KM_H: f64 = 1.852;

/// The reference of an `MWV` wind. Both angles are relative to the bow; neither is a compass
/// bearing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum WindReference {
    /// `R`: as felt on the moving boat.
    #[default]
    Relative,
    /// `T`: as it would be felt on the same boat at rest.
    Theoretical,
}

impl WindReference {
    pub(super) fn letter(self) -> &'static str {
        match self {
            WindReference::Relative => "R",
            WindReference::Theoretical => "T",
        }
    }
}

/// The unit of a speed on the wire.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SpeedUnit {
    /// `M`.
    #[default]
    MetresPerSecond,
    /// `K`.
    KilometresPerHour,
    /// `N`.
    Knots,
    /// `S`: statute.
    MilesPerHour,
}

impl SpeedUnit {
    /// Every unit with its letter and its size, m/s.
    const ALL: [(SpeedUnit, &'static str, f64); 4] = [
        (SpeedUnit::MetresPerSecond, "M", 1.0),
        (SpeedUnit::KilometresPerHour, "K", 1.0 / 3.6),
        (SpeedUnit::Knots, "N", M_S_PER_KN),
        (SpeedUnit::MilesPerHour, "S", 0.44704),
    ];

    /// One of this unit, m/s.
    pub fn m_s(self) -> f64 {
        SpeedUnit::ALL[self as usize].2
    }

    pub(super) fn letter(self) -> &'static str {
        SpeedUnit::ALL[self as usize].1
    }

    pub(super) fn from_letter(letter: &str) -> Option<SpeedUnit> {
        SpeedUnit::ALL
            .iter()
            .find(|(_, known, _)| *known == letter)
            .map(|(unit, ..)| *unit)
    }
}
