//! Simulated time: whole nanoseconds since the start of the game.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::{Add, Mul, Sub};

/// A time or duration in simulated nanoseconds.
///
/// With integers, ten thousand ticks of 50 ms are exactly 500 s on every machine. Sums saturate at
/// 292 years, because times also come from files and other nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(transparent)]
pub struct SimTime(pub i64);

impl SimTime {
    /// The start of the game.
    pub const ZERO: SimTime = SimTime(0);
    /// Earlier than anything in a game.
    pub const LONG_AGO: SimTime = SimTime(i64::MIN / 4);
    /// Later than anything in a game.
    pub const NEVER: SimTime = SimTime(i64::MAX / 4);

    /// The nearest whole nanosecond to `seconds`.
    pub fn from_s(seconds: f64) -> SimTime {
        SimTime((seconds * 1e9).round() as i64)
    }

    /// The time in seconds.
    #[inline]
    pub fn as_s(self) -> f64 {
        self.0 as f64 * 1e-9
    }
}

impl Add for SimTime {
    type Output = SimTime;
    fn add(self, other: SimTime) -> SimTime {
        SimTime(self.0.saturating_add(other.0))
    }
}

impl Sub for SimTime {
    type Output = SimTime;
    fn sub(self, other: SimTime) -> SimTime {
        SimTime(self.0.saturating_sub(other.0))
    }
}

impl Mul<i64> for SimTime {
    type Output = SimTime;
    fn mul(self, count: i64) -> SimTime {
        SimTime(self.0.saturating_mul(count))
    }
}

impl fmt::Display for SimTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} s", self.as_s())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_stop_at_the_ends() {
        let first = SimTime(i64::MIN);
        let last = SimTime(i64::MAX);
        let second = SimTime(1_000_000_000);
        for (got, want) in [
            (last + second, last),
            (first - second, first),
            (second - first, last),
            (last * -2, first),
            (second * 500, SimTime::from_s(500.0)),
            (second - second, SimTime::ZERO),
        ] {
            assert_eq!(got, want);
        }
    }
}
