//! The desk where replays ask what helms thought: a thread of its own, since the answer may take a while.

use super::source::Helms;
use crate::page::rose::{HelmAnswer, helm_text};
use crate::page::show::News;
use game::{Scenario, VehicleId};
use std::collections::BTreeMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HelmRequest {
    /// Whose helm.
    pub(super) vehicle: VehicleId,
    /// At which decision.
    pub(super) decision: u64,
    /// Whether with utilities.
    pub(super) functions: bool,
}

/// Those who wait, by number.
#[derive(Default)]
struct Queue {
    wishes: BTreeMap<u64, HelmRequest>,
    answers: BTreeMap<u64, (HelmRequest, String)>,
    /// Whose answer is worked on, unless they have left.
    current: Option<u64>,
    /// Who was served last: all get their turn.
    last: u64,
    is_closed: bool,
}

struct Counter {
    queue: Mutex<Queue>,
    wished: Condvar,
}

/// The desk.
pub(super) struct HelmThread(Arc<Counter>);

impl HelmThread {
    /// Opens it. Without helms nobody knows what they thought.
    pub(super) fn open(scenario: Scenario, helms: Option<Box<dyn Helms>>, news: News) -> HelmThread {
        let counter = Arc::new(Counter { queue: Mutex::default(), wished: Condvar::new() });
        let server = Arc::clone(&counter);
        let serve = move || server.serve(&scenario, helms, &news);
        // Without a thread nobody answers; pages see that.
        drop(std::thread::Builder::new().name("page-helms".to_owned()).spawn(serve));
        HelmThread(counter)
    }

    /// A reader wishes this now, and nothing else any more.
    pub(super) fn wish(&self, reader: u64, wish: HelmRequest) {
        self.0.lock().wishes.insert(reader, wish);
        self.0.wished.notify_one();
    }

    /// The newest answer to a reader, as it goes to the page.
    pub(super) fn take(&self, reader: u64) -> Option<(HelmRequest, String)> {
        self.0.lock().answers.remove(&reader)
    }

    /// A reader goes.
    pub(super) fn leave(&self, reader: u64) {
        let mut queue = self.0.lock();
        queue.wishes.remove(&reader);
        queue.answers.remove(&reader);
        queue.current.take_if(|current| *current == reader);
    }
}

impl Drop for HelmThread {
    fn drop(&mut self) {
        self.0.lock().is_closed = true;
        // It may be at work for a while; it ends by itself.
        self.0.wished.notify_one();
    }
}

impl Counter {
    fn serve(&self, scenario: &Scenario, mut helms: Option<Box<dyn Helms>>, news: &News) {
        while let Some(wish) = self.next() {
            let answer = match &mut helms {
                Some(helms) => helms.report(wish.vehicle, wish.decision, wish.functions),
                None => HelmAnswer { reason: Some("the recording does not tell".to_owned()), ..HelmAnswer::default() },
            };
            let text = helm_text(scenario, wish.vehicle, wish.functions, answer);
            self.hand_out(wish, text);
            news.ring();
        }
    }

    /// The next wish in turn; none when the desk is closed.
    fn next(&self) -> Option<HelmRequest> {
        let idle = |queue: &mut Queue| queue.wishes.is_empty() && !queue.is_closed;
        let mut queue = self.wished.wait_while(self.lock(), idle).unwrap_or_else(PoisonError::into_inner);
        if queue.is_closed {
            return None;
        }
        let after = queue.last + 1;
        let reader =
            queue.wishes.range(after..).next().or_else(|| queue.wishes.iter().next()).map(|(reader, _)| *reader)?;
        (queue.last, queue.current) = (reader, Some(reader));
        queue.wishes.remove(&reader)
    }

    /// The answer for whoever was served last. NoRecorder takes it if they have left meanwhile.
    fn hand_out(&self, wish: HelmRequest, text: String) {
        let mut queue = self.lock();
        if let Some(reader) = queue.current.take() {
            queue.answers.insert(reader, (wish, text));
        }
    }

    /// Wishes and answers are put in and taken out whole.
    fn lock(&self) -> MutexGuard<'_, Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use std::sync::mpsc::{Receiver, Sender, channel};

    /// Helms that say when they begin to think, and think until they are told to stop.
    struct Thinkers(Sender<()>, Receiver<()>);

    impl Helms for Thinkers {
        fn report(&mut self, _: VehicleId, _: u64, _: bool) -> HelmAnswer {
            self.0.send(()).expect("the test listens");
            self.1.recv().expect("the test goes on");
            HelmAnswer::default()
        }
    }

    #[test]
    fn nothing_is_kept_for_a_reader_who_left_while_the_answer_was_worked_on() {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/pav01_vs_pav01.toml");
        let scenario = game::scenario::load(&file).unwrap();
        let ((began, begins), (go, goes)) = (channel(), channel());
        let desk = HelmThread::open(scenario, Some(Box::new(Thinkers(began, goes))), News::default());
        let wish = HelmRequest { vehicle: VehicleId::at(0), decision: 1, functions: false };
        for (reader, leaves) in [(1, true), (2, false), (3, false)] {
            desk.wish(reader, wish);
            begins.recv().unwrap();
            if leaves {
                desk.leave(reader);
            }
            go.send(()).unwrap();
        }
        // The third is at work only after the second was handed out.
        let kept: Vec<u64> = desk.0.lock().answers.keys().copied().filter(|reader| *reader < 3).collect();
        assert_eq!(kept, [2]);
    }
}
