//! Detects whether the sim of a game is still alive, for agents, gateways and pages.
//!
//! Two signs decide: the sim's liveliness token, and messages from it. A dying sim is heard until
//! its token disappears. If the link to it fails, it falls silent first, and its token disappears
//! when the network drops the link.

use crate::{Bus, BusError, Declaration, Watched, clock};
use messages::topic::{self, GameName};
use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How long a sim may be silent before it is treated as lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patience {
    /// Limit in every case.
    pub silence: Duration,
    /// Limit if the sim was heard until its token disappeared: perhaps the link was merely
    /// reopened.
    pub missing: Duration,
    /// Limit if the sim was never heard and its token disappeared: it has died, or the link has
    /// failed.
    pub unheard: Duration,
}

impl Patience {
    /// The patience of nodes that take part in the game: `silence` for a silent sim, and five
    /// seconds for a sim that was heard until its token disappeared.
    pub fn of_player(silence: Duration) -> Patience {
        Patience {
            silence,
            missing: Duration::from_secs(5),
            unheard: silence,
        }
    }
}

/// The state of a sim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SimState {
    /// Present, or not yet missing for long enough.
    Alive,
    /// A different sim serves a game with the same name and does not know this node.
    Replaced,
    /// Silent for the given time.
    Dead(Duration),
}

/// Observations of the sim: its identity, and when it was heard and missed.
#[derive(Clone, Debug)]
struct SimLiveness {
    patience: Patience,
    heard_at: Instant,
    /// Whether it was ever heard. Before its game begins, it may be silent for any length of time;
    /// until then, its token counts instead.
    is_heard: bool,
    /// When its token was first found missing.
    missed_at: Option<Instant>,
    /// The sim in use, by the key of its token.
    ours: Option<String>,
    /// The tokens present.
    tokens: BTreeSet<String>,
    is_replaced: bool,
}

impl SimLiveness {
    fn new(patience: Patience, now: Instant) -> SimLiveness {
        let ours = None;
        let tokens = BTreeSet::new();
        SimLiveness {
            patience,
            heard_at: now,
            is_heard: false,
            missed_at: None,
            ours,
            tokens,
            is_replaced: false,
        }
    }

    fn hear(&mut self, now: Instant) {
        (self.heard_at, self.is_heard) = (now, true);
    }

    /// Records that a token has appeared or disappeared.
    fn take_token(&mut self, key: &str, is_there: bool) {
        if is_there {
            let ours = self.ours.get_or_insert_with(|| key.to_owned());
            self.is_replaced |= ours != key;
            self.tokens.insert(key.to_owned());
        } else {
            self.tokens.remove(key);
        }
    }

    /// Switches to a sim that is present now, whichever was in use before. Returns whether one is
    /// present.
    fn choose(&mut self) -> bool {
        (self.ours, self.is_replaced) = (self.tokens.first().cloned(), false);
        self.ours.is_some()
    }

    /// Whether the token of our sim is present; `None` without a sim in use.
    fn is_there(&self) -> Option<bool> {
        self.ours.as_ref().map(|ours| self.tokens.contains(ours))
    }

    fn state(&mut self, now: Instant) -> SimState {
        if self.is_replaced {
            return SimState::Replaced;
        }
        if !self.is_heard && self.is_there() == Some(true) {
            self.heard_at = now;
        }
        self.missed_at = if self.is_there() == Some(false) {
            self.missed_at.or(Some(now))
        } else {
            None
        };
        let Patience {
            silence,
            missing,
            unheard,
        } = self.patience;
        // The order of the signs decides. A dying sim is heard until its token disappears. If the
        // link fails, silence comes first and zenoh drops the link after 10 s; an agent that left
        // then would be missing when the cable is plugged in again.
        let is_cut_off =
            |missed: Instant| missed.saturating_duration_since(self.heard_at) > missing;
        let limit = match self.missed_at {
            Some(_) if !self.is_heard => silence.min(unheard),
            Some(missed) if !is_cut_off(missed) => silence.min(missing),
            Some(_) | None => silence,
        };
        let silent = now.saturating_duration_since(self.heard_at);
        if silent > limit {
            SimState::Dead(silent)
        } else {
            SimState::Alive
        }
    }
}

/// Watches the sim of a game.
pub struct SimWatch {
    liveness: Arc<Watched<SimLiveness>>,
    _tokens: Declaration,
}

impl SimWatch {
    /// Starts watching, until dropped.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn open(bus: &Bus, game: &GameName, patience: Patience) -> Result<SimWatch, BusError> {
        let liveness = Arc::new(Watched::new(SimLiveness::new(patience, clock::now())));
        let told = Arc::clone(&liveness);
        let take = move |key: &str, is_there: bool| {
            told.visit(|liveness| liveness.take_token(key, is_there))
        };
        let tokens = bus.watch_alive(topic::all_alive(game), take)?;
        Ok(SimWatch {
            liveness,
            _tokens: tokens,
        })
    }

    /// Records that the sim has just been heard.
    pub fn hears(&self) {
        self.liveness.visit(|liveness| liveness.hear(clock::now()));
    }

    /// The sim's current state. Callers that receive no messages rely on its token.
    pub fn state(&self) -> SimState {
        self.liveness.visit(|liveness| liveness.state(clock::now()))
    }

    /// Waits up to `limit` for a sim, and uses it from then on. Returns whether one is present.
    pub fn find(&self, limit: Duration) -> bool {
        self.liveness
            .wait(limit, |liveness| !liveness.tokens.is_empty())
            && self.liveness.visit(SimLiveness::choose)
    }

    /// Waits up to `limit` until the token of our sim is missing or a different sim has appeared.
    /// Returns whether either has happened.
    pub fn is_lost(&self, limit: Duration) -> bool {
        self.liveness.wait(limit, |liveness| {
            liveness.is_replaced || liveness.is_there() != Some(true)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SILENCE: u64 = 60;

    /// Returns the second at which a sim is treated as lost. The functions state in which seconds
    /// the sim is heard and its token is present.
    fn died(
        silence_s: u64,
        is_heard: impl Fn(u64) -> bool,
        is_there: impl Fn(u64) -> bool,
    ) -> Option<u64> {
        let start = clock::now();
        let mut sim = SimLiveness::new(Patience::of_player(Duration::from_secs(silence_s)), start);
        (0..300).find(|s| {
            let now = start + Duration::from_secs(*s);
            if is_heard(*s) {
                sim.hear(now);
            }
            sim.take_token("a", is_there(*s));
            matches!(sim.state(now), SimState::Dead(_))
        })
    }

    #[test]
    fn a_sim_that_dies_is_missed_soon() {
        assert_eq!(died(SILENCE, |s| s <= 20, |s| s <= 20), Some(26));
        assert_eq!(
            died(SILENCE, |s| s <= 20, |s| s <= 18),
            Some(26),
            "its last pictures came late"
        );
        assert_eq!(
            died(2, |s| s <= 20, |s| s <= 20),
            Some(23),
            "a node with less patience notices sooner"
        );
    }

    #[test]
    fn a_sim_that_hangs_is_missed_after_the_silence_allowed() {
        assert_eq!(died(SILENCE, |s| s <= 20, |_| true), Some(81));
    }

    #[test]
    fn a_game_that_does_not_begin_is_waited_for_as_long_as_the_sim_is_there() {
        assert_eq!(died(2, |_| false, |s| s <= 200), Some(203));
        assert_eq!(
            died(SILENCE, |_| false, |s| !(100..140).contains(&s)),
            None,
            "the link is cut, and reopened"
        );
        assert_eq!(died(2, |s| s > 100, |_| true), None, "it begins late");
        assert_eq!(
            died(2, |s| (100..=120).contains(&s), |_| true),
            Some(123),
            "it hangs in the game"
        );
    }

    #[test]
    fn a_link_that_is_cut_is_waited_for() {
        // The network drops a link after ten seconds.
        let is_there = |s| !(30..55).contains(&s);
        assert_eq!(died(SILENCE, |s| s <= 20 || s >= 55, is_there), None);
        assert_eq!(
            died(SILENCE, |s| s <= 20, |s| s < 30),
            Some(81),
            "but not forever"
        );
        assert_eq!(
            died(
                SILENCE,
                |s| s <= 20 || (55..90).contains(&s),
                |s| is_there(s) && s < 90
            ),
            Some(95),
            "it died then"
        );
    }

    #[test]
    fn a_link_that_is_opened_anew_is_no_death() {
        assert_eq!(
            died(
                SILENCE,
                |s| !(21..24).contains(&s),
                |s| !(21..24).contains(&s)
            ),
            None
        );
    }

    #[test]
    fn a_sim_of_the_same_name_is_another_one() {
        let now = clock::now();
        let mut sim = SimLiveness::new(Patience::of_player(Duration::from_secs(SILENCE)), now);
        assert_eq!(
            (sim.is_there(), sim.state(now)),
            (None, SimState::Alive),
            "its token may take a moment"
        );
        for is_there in [true, false, true, false] {
            sim.take_token("a", is_there);
            assert_eq!(
                (sim.is_there(), sim.state(now)),
                (Some(is_there), SimState::Alive)
            );
        }
        sim.take_token("b", true);
        assert_eq!(
            (sim.is_there(), sim.state(now)),
            (Some(false), SimState::Replaced)
        );
        assert!(sim.choose(), "a node that can begin again uses the new one");
        assert_eq!(
            (sim.is_there(), sim.state(now)),
            (Some(true), SimState::Alive)
        );
        sim.take_token("b", false);
        assert!(!sim.choose());
    }

    #[test]
    fn by_its_token_alone_a_sim_is_gone_when_it_is_not_the_same_or_not_there_for_a_while() {
        let start = clock::now();
        let second = Duration::from_secs(1);
        let patience = Patience {
            silence: Duration::from_secs(5),
            missing: second,
            unheard: second,
        };
        let mut sim = SimLiveness::new(patience, start);
        for (at_s, token, want, what) in [
            (4.0, None, true, "it has time to appear"),
            (4.5, Some(true), true, "it is there"),
            (5.0, Some(false), true, "the link is cut"),
            (9.0, Some(true), true, "and is back"),
            (9.5, Some(false), true, "the link is cut again"),
            (10.5, None, false, "for too long"),
        ] {
            let now = start + Duration::from_secs_f64(at_s);
            token
                .into_iter()
                .for_each(|is_there| sim.take_token("a", is_there));
            assert_eq!(sim.state(now) == SimState::Alive, want, "{at_s} s: {what}");
        }
        let never = SimLiveness::new(patience, start).state(start + Duration::from_secs(6));
        assert_eq!(never, SimState::Dead(Duration::from_secs(6)));
    }
}
