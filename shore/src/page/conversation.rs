//! What passes between the server and one page, without the network in between.

use super::ask::Ask;
use super::show::{Guest, Room, Said, Show, Viewer};
use super::tell::{Mode, Tell};
use std::collections::VecDeque;
use std::time::Instant;

/// The most frames on their way to a page.
const UNDRAWN_MAX: u8 = 2;
/// After so much text a page is asked whether it has arrived, bytes: a frame is answered when it is drawn, a text is not.
const UNMARKED_MAX: usize = 4096;
/// The most refusals that wait to be told; a page that asks for nonsense faster than it listens misses some.
const REFUSALS_MAX: usize = 8;

/// The talk with one page.
pub(super) struct Conversation {
    viewer: Box<dyn Viewer>,
    guest: Guest,
    /// Frames sent and not yet drawn.
    undrawn: u8,
    /// Text sent since the last mark, bytes.
    unmarked: usize,
    /// The last mark that was made, and the last that came back.
    marks: (u64, u64),
    /// Refusals to be told: what, and why.
    refusals: VecDeque<(String, String)>,
}

impl Conversation {
    /// Begins to show something to a page.
    pub(super) fn new(show: &dyn Show, guest: Guest) -> Conversation {
        let viewer = show.admit(guest);
        Conversation { viewer, guest, undrawn: 0, unmarked: 0, marks: (0, 0), refusals: VecDeque::new() }
    }

    /// From now on something else is shown. Frames on their way stay on their way.
    pub(super) fn show(&mut self, show: &dyn Show) {
        self.viewer = show.admit(self.guest);
    }

    /// The page says this.
    pub(super) fn hear(&mut self, text: &str, now: Instant) {
        let ask: Ask = match serde_json::from_str(text) {
            Ok(ask) => ask,
            Err(e) => return self.refuse("message", format!("not understood: {e}")),
        };
        if ask == Ask::Ack {
            self.undrawn = self.undrawn.saturating_sub(1);
            return;
        }
        if ask.acts() && self.viewer.mode() == Mode::Live && !self.guest.rights {
            return self
                .refuse(ask.name(), "this page may only look: open it by its address with the token".to_owned());
        }
        if let Err(reason) = self.viewer.ask(&ask, now) {
            self.refuse(ask.name(), reason);
        }
    }

    /// The page sends something that is no text.
    pub(super) fn hear_noise(&mut self) {
        self.refuse("message", "not a text".to_owned());
    }

    /// The next thing to say to the page, if there is one now.
    pub(super) fn say(&mut self, now: Instant) -> Option<Said> {
        if let Some((what, reason)) = self.refusals.pop_front() {
            return Some(Said::Text(Tell::Refused { what: &what, reason: &reason }.json()));
        }
        let said = self.viewer.say(now, self.room());
        match &said {
            Some(Said::Now(_)) => self.undrawn += 1,
            Some(Said::Text(text)) => self.unmarked += text.len(),
            Some(Said::Past(_)) | None => {}
        }
        said
    }

    /// What the page can take now: of frames and of text no more is on its way than it can be late by.
    fn room(&self) -> Room {
        let (made, back) = self.marks;
        match self.undrawn < UNDRAWN_MAX {
            false => Room::None,
            true if back < made || self.unmarked >= UNMARKED_MAX => Room::Frames,
            true => Room::All,
        }
    }

    /// A mark to be sent after what was said last, if it is time for one. The page sends it back at once.
    pub(super) fn mark(&mut self) -> Option<u64> {
        if self.unmarked < UNMARKED_MAX {
            return None;
        }
        (self.unmarked, self.marks.0) = (0, self.marks.0 + 1);
        Some(self.marks.0)
    }

    /// The mark that was made last.
    pub(super) fn last_mark(&self) -> u64 {
        self.marks.0
    }

    /// A mark comes back: all that was said before it has arrived.
    pub(super) fn hear_mark(&mut self, mark: u64) {
        let (made, back) = self.marks;
        self.marks.1 = back.max(mark.min(made));
    }

    /// When there will be something to say though nothing is news.
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
    use super::super::clock;
    use super::super::show::News;
    use super::*;
    use proptest::prelude::*;
    use std::sync::{Arc, Mutex};

    /// A show with a frame for every question whether there is one, which notes what it is asked.
    struct Mirror {
        mode: Mode,
        news: News,
        asked: Arc<Mutex<Vec<Ask>>>,
    }

    struct Eye {
        mode: Mode,
        asked: Arc<Mutex<Vec<Ask>>>,
        frames: u8,
    }

    impl Show for Mirror {
        fn admit(&self, _: Guest) -> Box<dyn Viewer> {
            Box::new(Eye { mode: self.mode, asked: Arc::clone(&self.asked), frames: 0 })
        }
        fn news(&self) -> &News {
            &self.news
        }
    }

    impl Viewer for Eye {
        fn mode(&self) -> Mode {
            self.mode
        }
        fn ask(&mut self, ask: &Ask, _: Instant) -> Result<(), String> {
            self.asked.lock().unwrap().push(ask.clone());
            if matches!(ask, Ask::Seek { .. }) { Err("no".to_owned()) } else { Ok(()) }
        }
        fn say(&mut self, _: Instant, room: Room) -> Option<Said> {
            let fits = room >= Room::Frames;
            self.frames = self.frames.wrapping_add(u8::from(fits));
            fits.then(|| Said::now(&[self.frames]))
        }
        fn due(&self, _: Instant) -> Option<Instant> {
            None
        }
    }

    fn talk(mode: Mode, rights: bool) -> (Conversation, Arc<Mutex<Vec<Ask>>>) {
        let asked = Arc::new(Mutex::new(vec![]));
        let mirror = Mirror { mode, news: News::default(), asked: Arc::clone(&asked) };
        (Conversation::new(&mirror, Guest { rights }), asked)
    }

    #[test]
    fn two_frames_are_on_their_way_and_a_third_when_one_is_drawn() {
        let (mut talk, _) = talk(Mode::Live, false);
        let now = clock::now();
        let frames: Vec<Said> = std::iter::from_fn(|| talk.say(now)).take(9).collect();
        assert_eq!(frames, [Said::now(&[1]), Said::now(&[2])]);
        talk.hear(r#"{"do":"ack"}"#, now);
        assert_eq!(talk.say(now), Some(Said::now(&[3])));
        assert_eq!(talk.say(now), None);
        // A page that claims to have drawn more than it got gets no more than two.
        (0..9).for_each(|_| talk.hear(r#"{"do":"ack"}"#, now));
        assert_eq!(std::iter::from_fn(|| talk.say(now)).take(9).count(), 2);
    }

    #[test]
    fn a_long_text_is_on_its_way_until_its_mark_is_back() {
        let (mut talk, _) = talk(Mode::Live, false);
        assert_eq!((talk.room(), talk.mark()), (Room::All, None));
        talk.unmarked = UNMARKED_MAX - 1;
        assert_eq!((talk.room(), talk.mark()), (Room::All, None), "a short one does not matter");
        talk.unmarked = UNMARKED_MAX;
        assert_eq!(talk.room(), Room::Frames, "frames go on");
        assert_eq!((talk.mark(), talk.mark(), talk.last_mark()), (Some(1), None, 1));
        talk.hear_mark(0);
        assert_eq!(talk.room(), Room::Frames, "an older mark says nothing of it");
        talk.hear_mark(1);
        assert_eq!(talk.room(), Room::All);
        // A page that claims marks it never got has not got what is said next.
        talk.hear_mark(u64::MAX);
        talk.unmarked = UNMARKED_MAX;
        assert_eq!((talk.mark(), talk.room()), (Some(2), Room::Frames));
        talk.undrawn = UNDRAWN_MAX;
        talk.hear_mark(2);
        assert_eq!(talk.room(), Room::None);
    }

    #[test]
    fn acts_need_rights_in_a_game_and_none_in_a_replay() {
        let act = r#"{"do":"control","what":"pause"}"#;
        for (mode, rights, passed) in
            [(Mode::Live, false, 0), (Mode::Live, true, 1), (Mode::Replay, false, 1), (Mode::Replay, true, 1)]
        {
            let (mut talk, asked) = talk(mode, rights);
            talk.hear(act, clock::now());
            assert_eq!(asked.lock().unwrap().len(), passed, "{mode:?} {rights}");
            let refused = matches!(talk.say(clock::now()), Some(Said::Text(text)) if text.contains("refused"));
            assert_eq!(refused, passed == 0, "{mode:?} {rights}");
        }
    }

    #[test]
    fn nonsense_is_answered_but_not_without_end() {
        let (mut talk, _) = talk(Mode::Live, true);
        let now = clock::now();
        (0..100).for_each(|_| talk.hear("ahoy", now));
        talk.hear_noise();
        let said: Vec<Said> = std::iter::from_fn(|| talk.say(now)).take(100).collect();
        assert_eq!(said.iter().filter(|said| matches!(said, Said::Text(_))).count(), REFUSALS_MAX);
        talk.hear(r#"{"do":"seek","t_s":3}"#, now);
        let want = r#"{"kind":"refused","what":"seek","reason":"no"}"#;
        assert_eq!(talk.say(now), Some(Said::Text(want.to_owned())));
    }

    fn anything() -> impl Strategy<Value = String> {
        let word =
            prop::sample::select(vec!["ack", "select", "control", "speed", "step", "seek", "drive", "let_go", "x"]);
        let what = prop::sample::select(vec!["pause", "stop", "e_stop", "release", "fly"]);
        let asked = (word, what, any::<f64>(), any::<i64>(), ".{0,9}").prop_map(|(word, what, x, by, vehicle)| {
            serde_json::json!({"do": word, "what": what, "factor": x, "by": by, "t_s": x, "vehicle": vehicle,
                "course_deg": x, "speed_m_s": x})
            .to_string()
        });
        prop_oneof![asked, ".{0,60}", r#"\{"do":"[a-z_]{0,8}".{0,20}\}"#]
    }

    proptest! {
        #[test]
        fn nothing_that_a_page_says_acts_without_rights(texts in prop::collection::vec(anything(), 0..40)) {
            let (mut talk, asked) = talk(Mode::Live, false);
            let now = clock::now();
            for text in &texts {
                talk.hear(text, now);
                talk.say(now);
                prop_assert!(talk.undrawn <= UNDRAWN_MAX && talk.refusals.len() <= REFUSALS_MAX);
            }
            prop_assert!(asked.lock().unwrap().iter().all(|ask| !ask.acts()));
        }
    }
}
