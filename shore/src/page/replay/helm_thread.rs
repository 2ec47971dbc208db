//! A thread that recomputes helm reports for replays, since that may take a while.

use crate::page::rose::{HelmAnswer, helm_text};
use crate::page::view::Changes;
use bus::Watched;
use game::{Scenario, VehicleId};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

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

/// The helms.
pub(super) struct HelmThread(Arc<Watched<Queue>>);

impl HelmThread {
    /// Opens it. Without helms nobody knows what they thought.
    pub(super) fn open(scenario: Scenario, helms: Option<Box<dyn Helms>>, news: Changes) -> HelmThread {
        let counter = Arc::new(Watched::<Queue>::default());
        let server = Arc::clone(&counter);
        let serve = move || serve(&server, &scenario, helms, &news);
        // Without a thread nobody answers; pages see that.
        drop(std::thread::Builder::new().name("page-helms".to_owned()).spawn(serve));
        HelmThread(counter)
    }

    /// A viewer requests this now, and nothing else any more.
    pub(super) fn request(&self, viewer: u64, request: HelmRequest) {
        self.0.visit(|queue| queue.requests.insert(viewer, request));
    }

    /// The newest answer to a viewer, as it goes to the page.
    pub(super) fn take(&self, viewer: u64) -> Option<(HelmRequest, String)> {
        self.0.visit(|queue| queue.answers.remove(&viewer))
    }

    /// A viewer goes.
    pub(super) fn remove(&self, viewer: u64) {
        self.0.visit(|queue| {
            queue.requests.remove(&viewer);
            queue.answers.remove(&viewer);
            queue.current.take_if(|current| *current == viewer);
        });
    }
}

impl Drop for HelmThread {
    fn drop(&mut self) {
        // The thread may be at work for a while; it ends by itself.
        self.0.visit(|queue| queue.is_closed = true);
    }
}

/// Answers one request after the other until the view is closed.
fn serve(shared: &Watched<Queue>, scenario: &Scenario, mut helms: Option<Box<dyn Helms>>, news: &Changes) {
    const ROUND: Duration = Duration::from_secs(60);
    loop {
        shared.wait(ROUND, |queue| queue.is_closed || !queue.requests.is_empty());
        if shared.visit(|queue| queue.is_closed) {
            return;
        }
        let Some(request) = shared.visit(Queue::next) else { continue };
        let answer = match &mut helms {
            Some(helms) => helms.report(request.vehicle, request.decision, request.functions),
            None => HelmAnswer { reason: Some("the recording does not tell".to_owned()), ..HelmAnswer::default() },
        };
        let text = helm_text(scenario, request.vehicle, request.functions, answer);
        // Nobody takes it if they have left meanwhile.
        shared.visit(|queue| queue.current.take().map(|viewer| queue.answers.insert(viewer, (request, text))));
        news.send_replace(());
    }
}

impl Queue {
    /// The next request in turn.
    fn next(&mut self) -> Option<HelmRequest> {
        let after = self.requests.range(self.last + 1..).next().or_else(|| self.requests.iter().next());
        let viewer = *after?.0;
        (self.last, self.current) = (viewer, Some(viewer));
        self.requests.remove(&viewer)
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
        let kept: Vec<u64> =
            helms.0.visit(|queue| queue.answers.keys().copied().filter(|viewer| *viewer < 3).collect());
        assert_eq!(kept, [2]);
    }
}
