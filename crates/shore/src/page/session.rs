//! The protocol with one page, without I/O (sans-IO).

use super::message::{Mode, PageMessage};
use super::request::PageRequest;
use super::view::{Access, Budget, Outgoing, Viewer};
use std::collections::VecDeque;
use std::time::Instant;

/// Maximum number of frames sent and not yet drawn.
const UNDRAWN_MAX: u8 = 2;
/// Amount of text (bytes) after which a ping checks that it has arrived. The page acknowledges
/// drawn frames, but not text.
const UNCONFIRMED_MAX: usize = 4096;
/// Maximum number of queued refusals. A page that sends bad requests faster than it reads replies
/// misses some.
const REFUSALS_MAX: usize = 8;

/// The session with one page.
pub struct PageSession {
    viewer: Box<dyn Viewer>,
    access: Access,
    /// Frames sent and not yet drawn.
    undrawn: u8,
    /// Text sent since the last ping, bytes.
    unconfirmed: usize,
    /// The last ping sent, and the last pong received.
    pings: (u64, u64),
    /// Refusals to send: the request and the reason.
    refusals: VecDeque<(String, String)>,
}

impl PageSession {
    /// Starts a session with a page.
    pub fn new(viewer: Box<dyn Viewer>, access: Access) -> PageSession {
        PageSession {
            viewer,
            access,
            undrawn: 0,
            unconfirmed: 0,
            pings: (0, 0),
            refusals: VecDeque::new(),
        }
    }

    /// Replaces the viewer. Frames in flight still count.
    pub(super) fn show(self, viewer: Box<dyn Viewer>) -> PageSession {
        PageSession { viewer, ..self }
    }

    /// Handles a text message from the page.
    pub fn receive(&mut self, text: &str, now: Instant) {
        let ask: PageRequest = match serde_json::from_str(text) {
            Ok(ask) => ask,
            Err(e) => return self.refuse("message", format!("invalid message: {e}")),
        };
        if ask == PageRequest::Ack {
            self.undrawn = self.undrawn.saturating_sub(1);
            return;
        }
        // Each page has its own playback, but futures keep all cores busy.
        let is_own =
            self.viewer.mode() == Mode::Replay && !matches!(ask, PageRequest::WhatIf { .. });
        let is_allowed = is_own || self.access >= ask.needs();
        if !is_allowed {
            let reason = match self.access {
                Access::Watch => "this page may only watch: open it with the token",
                _ => {
                    "this page may only watch and stop real boats: open it with the operator's token"
                }
            };
            return self.refuse(ask.name(), reason.to_owned());
        }
        if let Err(reason) = self.viewer.ask(&ask, now) {
            self.refuse(ask.name(), reason);
        }
    }

    /// Handles a binary message from the page.
    pub fn receive_binary(&mut self) {
        self.refuse("message", "binary messages are not allowed".to_owned());
    }

    /// The next message to the page, if any.
    pub fn next_message(&mut self, now: Instant) -> Option<Outgoing> {
        if let Some((what, reason)) = self.refusals.pop_front() {
            return Some(Outgoing::Text(
                PageMessage::Refused {
                    what: &what,
                    reason: &reason,
                }
                .json(),
            ));
        }
        let outgoing = self.viewer.next_message(now, self.budget());
        match &outgoing {
            Some(Outgoing::Now(_)) => self.undrawn += 1,
            Some(Outgoing::Text(text)) => self.unconfirmed += text.len(),
            Some(Outgoing::Past(_)) | None => {}
        }
        outgoing
    }

    /// The page's free capacity. Limits the frames and text in flight, so that none arrives late.
    fn budget(&self) -> Budget {
        let (made, back) = self.pings;
        match self.undrawn < UNDRAWN_MAX {
            false => Budget::None,
            // Messages that can wait, such as helm reports, wait for space on the connection: an
            // E-stop must not queue behind pictures.
            true if back < made || self.unconfirmed >= UNCONFIRMED_MAX => Budget::Frames,
            true => Budget::All,
        }
    }

    /// A ping to send after the last message, if due. The page returns it immediately.
    pub fn ping(&mut self) -> Option<u64> {
        if self.unconfirmed < UNCONFIRMED_MAX {
            return None;
        }
        (self.unconfirmed, self.pings.0) = (0, self.pings.0 + 1);
        Some(self.pings.0)
    }

    pub(super) fn last_ping(&self) -> u64 {
        self.pings.0
    }

    /// Handles a returned ping: everything before it has arrived.
    pub fn receive_pong(&mut self, ping: u64) {
        let (made, back) = self.pings;
        self.pings.1 = back.max(ping.min(made));
    }

    /// When the next message is due if nothing else happens.
    pub(super) fn due(&self, now: Instant) -> Option<Instant> {
        self.viewer.due(now)
    }

    fn refuse(&mut self, what: &str, reason: String) {
        if self.refusals.len() < REFUSALS_MAX {
            self.refusals.push_back((what.to_owned(), reason));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bus::clock;
    use proptest::prelude::*;
    use std::sync::{Arc, Mutex};

    /// A viewer that offers a frame at every call and records its requests.
    struct TestViewer {
        mode: Mode,
        asked: Arc<Mutex<Vec<PageRequest>>>,
        frames: u8,
    }

    impl Viewer for TestViewer {
        fn mode(&self) -> Mode {
            self.mode
        }
        fn ask(&mut self, ask: &PageRequest, _: Instant) -> Result<(), String> {
            self.asked.lock().unwrap().push(ask.clone());
            if matches!(ask, PageRequest::Seek { .. }) {
                Err("no".to_owned())
            } else {
                Ok(())
            }
        }
        fn next_message(&mut self, _: Instant, budget: Budget) -> Option<Outgoing> {
            let fits = budget >= Budget::Frames;
            self.frames = self.frames.wrapping_add(u8::from(fits));
            fits.then(|| Outgoing::now(&[self.frames]))
        }
        fn due(&self, _: Instant) -> Option<Instant> {
            None
        }
    }

    fn session(mode: Mode, access: Access) -> (PageSession, Arc<Mutex<Vec<PageRequest>>>) {
        let asked = Arc::new(Mutex::new(vec![]));
        let viewer = TestViewer {
            mode,
            asked: Arc::clone(&asked),
            frames: 0,
        };
        (PageSession::new(Box::new(viewer), access), asked)
    }

    #[test]
    fn two_frames_are_on_their_way_and_a_third_when_one_is_drawn() {
        let (mut session, _) = session(Mode::Live, Access::Watch);
        let now = clock::now();
        let frames: Vec<Outgoing> = std::iter::from_fn(|| session.next_message(now))
            .take(9)
            .collect();
        assert_eq!(frames, [Outgoing::now(&[1]), Outgoing::now(&[2])]);
        session.receive(r#"{"do":"ack"}"#, now);
        assert_eq!(session.next_message(now), Some(Outgoing::now(&[3])));
        assert_eq!(session.next_message(now), None);
        // A page that acknowledges more frames than it has received gets no more than two.
        (0..9).for_each(|_| session.receive(r#"{"do":"ack"}"#, now));
        assert_eq!(
            std::iter::from_fn(|| session.next_message(now))
                .take(9)
                .count(),
            2
        );
    }

    #[test]
    fn a_long_text_is_on_its_way_until_its_mark_is_back() {
        let (mut session, _) = session(Mode::Live, Access::Watch);
        assert_eq!((session.budget(), session.ping()), (Budget::All, None));
        session.unconfirmed = UNCONFIRMED_MAX - 1;
        assert_eq!(
            (session.budget(), session.ping()),
            (Budget::All, None),
            "short texts do not count"
        );
        session.unconfirmed = UNCONFIRMED_MAX;
        assert_eq!(session.budget(), Budget::Frames, "frames continue");
        assert_eq!(
            (session.ping(), session.ping(), session.last_ping()),
            (Some(1), None, 1)
        );
        session.receive_pong(0);
        assert_eq!(
            session.budget(),
            Budget::Frames,
            "an older ping does not confirm it"
        );
        session.receive_pong(1);
        assert_eq!(session.budget(), Budget::All);
        // A page that returns pings it never received has not received later messages.
        session.receive_pong(u64::MAX);
        session.unconfirmed = UNCONFIRMED_MAX;
        assert_eq!(
            (session.ping(), session.budget()),
            (Some(2), Budget::Frames)
        );
        session.undrawn = UNDRAWN_MAX;
        session.receive_pong(2);
        assert_eq!(session.budget(), Budget::None);
    }

    #[test]
    fn acts_need_rights_in_a_game_and_none_in_a_replay() {
        let pause = r#"{"do":"control","what":"pause"}"#;
        let disarm = r#"{"do":"operate","vehicle":"a","command":"disarm"}"#;
        let arm = r#"{"do":"operate","vehicle":"a","command":"arm"}"#;
        let mission = r#"{"do":"mission","vehicle":"a","lines":""}"#;
        for (act, least) in [
            (pause, Access::Control),
            (disarm, Access::Control),
            (arm, Access::Operate),
            (mission, Access::Operate),
        ] {
            for access in [Access::Watch, Access::Control, Access::Operate] {
                for mode in [Mode::Live, Mode::Replay] {
                    let (mut session, asked) = session(mode, access);
                    session.receive(act, clock::now());
                    let is_allowed = mode == Mode::Replay || access >= least;
                    assert_eq!(
                        asked.lock().unwrap().len(),
                        usize::from(is_allowed),
                        "{act} {mode:?} {access:?}"
                    );
                    let next = session.next_message(clock::now());
                    let refused =
                        matches!(next, Some(Outgoing::Text(text)) if text.contains("refused"));
                    assert_eq!(refused, !is_allowed, "{act} {mode:?} {access:?}");
                }
            }
        }
    }

    #[test]
    fn nonsense_is_answered_but_not_without_end() {
        let (mut session, _) = session(Mode::Live, Access::Control);
        let now = clock::now();
        (0..100).for_each(|_| session.receive("ahoy", now));
        session.receive_binary();
        let outgoing: Vec<Outgoing> = std::iter::from_fn(|| session.next_message(now))
            .take(100)
            .collect();
        assert_eq!(
            outgoing
                .iter()
                .filter(|outgoing| matches!(outgoing, Outgoing::Text(_)))
                .count(),
            REFUSALS_MAX
        );
        session.receive(r#"{"do":"seek","t_s":3}"#, now);
        let want = r#"{"kind":"refused","what":"seek","reason":"no"}"#;
        assert_eq!(
            session.next_message(now),
            Some(Outgoing::Text(want.to_owned()))
        );
    }

    fn anything() -> impl Strategy<Value = String> {
        let word = prop::sample::select(vec![
            "ack", "select", "control", "speed", "step", "seek", "drive", "let_go", "operate", "x",
        ]);
        let what = prop::sample::select(vec!["pause", "stop", "e_stop", "release", "fly"]);
        let asked = (word, what, any::<f64>(), any::<i64>(), ".{0,9}").prop_map(|(word, what, x, by, vehicle)| {
            serde_json::json!({"do": word, "what": what, "command": what, "factor": x, "by": by, "t_s": x, "vehicle": vehicle,
                "course_deg": x, "speed_m_s": x})
            .to_string()
        });
        prop_oneof![asked, ".{0,60}", r#"\{"do":"[a-z_]{0,8}".{0,20}\}"#]
    }

    proptest! {
        #[test]
        fn nothing_that_a_page_says_acts_without_rights(texts in prop::collection::vec(anything(), 0..40)) {
            let (mut session, asked) = session(Mode::Live, Access::Watch);
            let now = clock::now();
            for text in &texts {
                session.receive(text, now);
                session.next_message(now);
                prop_assert!(session.undrawn <= UNDRAWN_MAX && session.refusals.len() <= REFUSALS_MAX);
            }
            prop_assert!(asked.lock().unwrap().iter().all(|ask| ask.needs() == Access::Watch));
        }
    }
}
