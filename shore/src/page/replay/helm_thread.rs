//! A thread that recomputes helm reports for replays, since that may take a while.

use crate::page::rose::{HelmAnswer, helm_text};
use crate::page::view::Changes;
use game::{Scenario, VehicleId};
use parking_lot::{Condvar, Mutex};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Recomputes helm reports of a recorded game. That may take a while.
pub trait Helms: Send {
    /// What a boat's helm thought at a decision, with utilities or without.
    fn report(&mut self, vehicle: VehicleId, decision: u64, functions: bool) -> HelmAnswer;
}

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
    requests: BTreeMap<u64, HelmRequest>,
    answers: BTreeMap<u64, (HelmRequest, String)>,
    /// Whose answer is worked on, unless they have left.
    current: Option<u64>,
    /// Who was served last: all get their turn.
    last: u64,
    is_closed: bool,
}

struct SharedQueue {
    queue: Mutex<Queue>,
    requested: Condvar,
}

/// The helms.
pub(super) struct HelmThread(Arc<SharedQueue>);

impl HelmThread {
    /// Opens it. Without helms nobody knows what they thought.
    pub(super) fn open(scenario: Scenario, helms: Option<Box<dyn Helms>>, news: Changes) -> HelmThread {
        let counter = Arc::new(SharedQueue { queue: Mutex::default(), requested: Condvar::new() });
        let server = Arc::clone(&counter);
        let serve = move || server.serve(&scenario, helms, &news);
        // Without a thread nobody answers; pages see that.
        drop(std::thread::Builder::new().name("page-helms".to_owned()).spawn(serve));
        HelmThread(counter)
    }

    /// A viewer requests this now, and nothing else any more.
    pub(super) fn request(&self, viewer: u64, request: HelmRequest) {
        self.0.queue.lock().requests.insert(viewer, request);
        self.0.requested.notify_one();
    }

    /// The newest answer to a viewer, as it goes to the page.
    pub(super) fn take(&self, viewer: u64) -> Option<(HelmRequest, String)> {
        self.0.queue.lock().answers.remove(&viewer)
    }

    /// A viewer goes.
    pub(super) fn remove(&self, viewer: u64) {
        let mut queue = self.0.queue.lock();
        queue.requests.remove(&viewer);
        queue.answers.remove(&viewer);
        queue.current.take_if(|current| *current == viewer);
    }
}

impl Drop for HelmThread {
    fn drop(&mut self) {
        self.0.queue.lock().is_closed = true;
        // It may be at work for a while; it ends by itself.
        self.0.requested.notify_one();
    }
}

impl SharedQueue {
    fn serve(&self, scenario: &Scenario, mut helms: Option<Box<dyn Helms>>, news: &Changes) {
        while let Some(request) = self.next() {
            let answer = match &mut helms {
                Some(helms) => helms.report(request.vehicle, request.decision, request.functions),
                None => HelmAnswer { reason: Some("the recording does not tell".to_owned()), ..HelmAnswer::default() },
            };
            let text = helm_text(scenario, request.vehicle, request.functions, answer);
            self.deliver(request, text);
            news.notify();
        }
    }

    /// The next request in turn; none when the view is closed.
    fn next(&self) -> Option<HelmRequest> {
        let idle = |queue: &mut Queue| queue.requests.is_empty() && !queue.is_closed;
        let mut queue = self.queue.lock();
        self.requested.wait_while(&mut queue, idle);
        if queue.is_closed {
            return None;
        }
        let after = queue.last + 1;
        let viewer =
            queue.requests.range(after..).next().or_else(|| queue.requests.iter().next()).map(|(viewer, _)| *viewer)?;
        (queue.last, queue.current) = (viewer, Some(viewer));
        queue.requests.remove(&viewer)
    }

    /// The answer for whoever was served last. Nobody takes it if they have left meanwhile.
    fn deliver(&self, request: HelmRequest, text: String) {
        let mut queue = self.queue.lock();
        if let Some(viewer) = queue.current.take() {
            queue.answers.insert(viewer, (request, text));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use std::sync::mpsc::{Receiver, Sender, channel};

    /// Helms that signal when they begin, and work until they may go on.
    struct SlowHelms(Sender<()>, Receiver<()>);

    impl Helms for SlowHelms {
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
        let helms = HelmThread::open(scenario, Some(Box::new(SlowHelms(began, goes))), Changes::default());
        let request = HelmRequest { vehicle: VehicleId::at(0), decision: 1, functions: false };
        for (viewer, leaves) in [(1, true), (2, false), (3, false)] {
            helms.request(viewer, request);
            begins.recv().unwrap();
            if leaves {
                helms.remove(viewer);
            }
            go.send(()).unwrap();
        }
        // The third is at work only after the second was handed out.
        let kept: Vec<u64> = helms.0.queue.lock().answers.keys().copied().filter(|viewer| *viewer < 3).collect();
        assert_eq!(kept, [2]);
    }
}
