//! The fix qualities of GGA and their ranking, which is not numerical order.

use serde::{Deserialize, Serialize};
use std::fmt;

/// The type of a fix, by its number in GGA.
// No `Ord`: the numbers are labels. Their order would rank dead reckoning (6) above RTK (4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct FixQuality(u8);

impl FixQuality {
    /// No fix.
    pub const NONE: FixQuality = FixQuality(0);

    /// The quality for a number in GGA.
    pub const fn from_gga(number: u8) -> FixQuality {
        FixQuality(number)
    }

    /// Whether this is a satellite fix at least as good as `required`.
    pub fn meets(self, required: FixQuality) -> bool {
        self.is_fix() && self.rank() >= required.rank()
    }

    /// Whether the fix comes from satellites. Dead reckoning, manual input and simulators do not
    /// measure a position.
    pub fn is_fix(self) -> bool {
        self.rank() > 0
    }

    /// The quality as a string.
    pub fn in_words(self) -> &'static str {
        match self.0 {
            0 => "no fix",
            1 => "GPS",
            2 => "DGPS",
            3 => "PPS",
            4 => "RTK fixed",
            5 => "RTK float",
            6 => "dead reckoning",
            7 => "manual input",
            8 => "simulator",
            _ => "an unknown quality",
        }
    }

    /// The rank, from no fix to the best.
    fn rank(self) -> u8 {
        match self.0 {
            1 => 1,
            2 | 3 => 2,
            5 => 3,
            4 => 4,
            _ => 0,
        }
    }
}

impl fmt::Display for FixQuality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.0, self.in_words())
    }
}

#[cfg(test)]
mod tests {
    use super::FixQuality;

    #[test]
    fn a_quality_meets_those_below_it_and_what_is_no_fix_meets_none() {
        let order: [&[u8]; 4] = [&[1], &[2, 3], &[5], &[4]];
        let rank = |number: u8| order.iter().position(|numbers| numbers.contains(&number));
        for (got, required) in
            (0..=255).flat_map(|got| (1..=5).map(move |required| (got, required)))
        {
            let want = rank(got).is_some_and(|rank_of_got| Some(rank_of_got) >= rank(required));
            let meets = FixQuality::from_gga(got).meets(FixQuality::from_gga(required));
            assert_eq!(meets, want, "{got} where {required} is required");
        }
    }
}
