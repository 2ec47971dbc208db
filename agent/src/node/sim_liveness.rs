//! Whether the sim is still there, by what is heard of it.

use std::time::{Duration, Instant};

/// How long a sim that was heard until its sign of life went may take to come back: the link may only have been opened anew.
const COME_BACK: Duration = Duration::from_secs(5);

/// Watches for the end of the sim. A sim that dies is heard until its sign of life goes; where the way to it is cut, it
/// falls silent first, and its sign of life goes when the link is given up.
pub(super) struct SimLiveness {
    silence: Duration,
    heard: Instant,
    /// When its sign of life was first missed.
    missed: Option<Instant>,
}

impl SimLiveness {
    /// From `now` on, when the sim is there; after `silence` it counts as dead in any case.
    pub(super) fn begin(silence: Duration, now: Instant) -> SimLiveness {
        SimLiveness { silence, heard: now, missed: None }
    }

    /// The sim is heard.
    pub(super) fn hears(&mut self, now: Instant) {
        self.heard = now;
    }

    /// For how long nothing was heard, if the sim counts as dead `now`; `is_alive` says whether it shows a sign of life.
    pub(super) fn dead_for(&mut self, is_alive: bool, now: Instant) -> Option<Duration> {
        self.missed = if is_alive { None } else { self.missed.or(Some(now)) };
        let is_cut_off = |missed: Instant| missed.saturating_duration_since(self.heard) > COME_BACK;
        let limit = match self.missed {
            Some(missed) if !is_cut_off(missed) => self.silence.min(COME_BACK),
            Some(_) | None => self.silence,
        };
        let silent = now.saturating_duration_since(self.heard);
        (silent > limit).then_some(silent)
    }
}

/// The signs of life of the sims that serve the game, one after the other.
#[derive(Default)]
pub(super) struct Signs {
    /// The one that let us in, by the key of its sign, and whether it is there.
    ours: Option<(String, bool)>,
    is_replaced: bool,
}

impl Signs {
    /// The sign of life of a sim has come or gone.
    pub(super) fn take(&mut self, sim: &str, is_alive: bool) {
        let (ours, is_there) = self.ours.get_or_insert_with(|| (sim.to_owned(), is_alive));
        if ours == sim {
            *is_there = is_alive;
        } else {
            self.is_replaced |= is_alive;
        }
    }

    /// Whether the sim that let us in is there, or was not missed yet.
    pub(super) fn is_alive(&self) -> bool {
        self.ours.as_ref().is_none_or(|(_, is_there)| *is_there)
    }

    /// Whether there is another one.
    pub(super) fn is_replaced(&self) -> bool {
        self.is_replaced
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::node::clock;

    const SILENCE: u64 = 60;

    /// For each second from the beginning: whether the sim is heard, and whether it shows a sign of life. Gives the second
    /// at which it counts as dead.
    fn died(silence_s: u64, is_heard: impl Fn(u64) -> bool, is_alive: impl Fn(u64) -> bool) -> Option<u64> {
        let start = clock::now();
        let mut sim_liveness = SimLiveness::begin(Duration::from_secs(silence_s), start);
        (0..300).find(|s| {
            let now = start + Duration::from_secs(*s);
            if is_heard(*s) {
                sim_liveness.hears(now);
            }
            sim_liveness.dead_for(is_alive(*s), now).is_some()
        })
    }

    #[test]
    fn a_sim_that_dies_is_missed_soon() {
        assert_eq!(died(SILENCE, |s| s <= 20, |s| s <= 20), Some(26));
        assert_eq!(died(SILENCE, |s| s <= 20, |s| s <= 18), Some(26), "its last pictures came late");
        assert_eq!(died(2, |s| s <= 20, |s| s <= 20), Some(23), "who wants to know sooner does");
    }

    #[test]
    fn a_sim_that_hangs_is_missed_after_the_silence_allowed() {
        assert_eq!(died(SILENCE, |s| s <= 20, |_| true), Some(81));
    }

    #[test]
    fn a_link_that_is_cut_is_waited_for() {
        // The network gives a link up after ten seconds.
        let is_alive = |s| !(30..55).contains(&s);
        assert_eq!(died(SILENCE, |s| s <= 20 || s >= 55, is_alive), None);
        assert_eq!(died(SILENCE, |s| s <= 20, |s| s < 30), Some(81), "but not forever");
        assert_eq!(
            died(SILENCE, |s| s <= 20 || (55..90).contains(&s), |s| is_alive(s) && s < 90),
            Some(95),
            "it died then"
        );
    }

    #[test]
    fn a_sim_of_the_same_name_is_another_one() {
        let mut signs = Signs::default();
        assert!(signs.is_alive() && !signs.is_replaced(), "its sign may take a moment");
        for is_alive in [true, false, true, false] {
            signs.take("a", is_alive);
            assert!(signs.is_alive() == is_alive && !signs.is_replaced());
        }
        signs.take("b", true);
        assert!(!signs.is_alive() && signs.is_replaced());
    }

    #[test]
    fn a_link_that_is_opened_anew_is_no_death() {
        assert_eq!(died(SILENCE, |s| !(21..24).contains(&s), |s| !(21..24).contains(&s)), None);
    }
}
