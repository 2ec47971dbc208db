//! MOOS time: seconds since 1970 times the time warp.

use time::OffsetDateTime;

/// Maximum time warp of MOOS.
const WARP_MAX: f64 = 400.0;

/// The clock of all communities of a game.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MoosClock {
    /// MOOS seconds per second: the pace of the game.
    pub warp: f64,
}

impl MoosClock {
    /// The clock for a game with this pace.
    ///
    /// # Errors
    /// Why MOOS applications cannot follow that pace.
    pub fn of_pace(pace: &str) -> Result<MoosClock, String> {
        let warp = match pace {
            "lockstep" => {
                return Err("the game runs in lockstep, so every decision waits for every boat; MOOS applications \
                            follow the clock instead: start the game with --pace realtime or a factor such as --pace 4x"
                    .to_owned());
            }
            "realtime" => 1.0,
            factor => factor
                .strip_suffix('x')
                .and_then(|factor| factor.parse().ok())
                .unwrap_or(f64::NAN),
        };
        if warp > 0.0 && warp <= WARP_MAX {
            return Ok(MoosClock { warp });
        }
        Err(format!(
            "the pace of the game is {pace}, expected at most {WARP_MAX}x, the highest time warp of MOOS"
        ))
    }

    /// The current MOOS time, s.
    pub fn now_s(self) -> f64 {
        OffsetDateTime::now_utc().unix_timestamp_nanos() as f64 * 1e-9 * self.warp
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_warp_is_the_pace_and_lockstep_has_none() {
        for (pace, want) in [
            ("realtime", Some(1.0)),
            ("4x", Some(4.0)),
            ("0.5x", Some(0.5)),
            ("500x", None),
        ] {
            assert_eq!(
                MoosClock::of_pace(pace).ok().map(|clock| clock.warp),
                want,
                "{pace}"
            );
        }
        assert!(
            MoosClock::of_pace("lockstep")
                .unwrap_err()
                .contains("--pace realtime")
        );
        let fast_s = MoosClock { warp: 10.0 }.now_s();
        assert!((fast_s / MoosClock { warp: 1.0 }.now_s() - 10.0).abs() < 1e-6);
    }
}
