//! A thread that computes replay data missing from frames: helm reports, modes, curves. This may
//! take a while.

use super::curves::Plotter;
use crate::page::message::{PageMessage, seconds};
use crate::page::rose::{HelmAnswer, helm_text};
use crate::page::view::Changes;
use bus::Watched;
use primitives::{SimTime, VehicleId};
use scenario::Scenario;
use std::collections::BTreeMap;
use std::ops::Bound;
use std::sync::Arc;
use std::time::Duration;

/// Recomputes helm reports of a recorded game.
pub trait Helms: Send {
    /// The report of a boat's helm at a decision, with or without utilities.
    fn report(&mut self, vehicle: VehicleId, decision: u64, functions: bool) -> HelmAnswer;

    /// The modes of all helms at a decision, by vehicle. `None` without a helm or a mode.
    fn modes(&mut self, decision: u64) -> Vec<Option<String>>;
}

/// A viewer's query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Query {
    Helm(HelmRequest),
    /// The modes of all boats at a decision, with its time.
    Modes(u64, SimTime),
    /// The score, and curves of a boat.
    Curves(Option<VehicleId>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct HelmRequest {
    pub(super) vehicle: VehicleId,
    pub(super) decision: u64,
    /// Whether to include utilities.
    pub(super) functions: bool,
}

/// A viewer and a kind of query. Each viewer has at most one query of each kind at a time.
type Asker = (u64, u8);

impl Query {
    fn kind(&self) -> u8 {
        match self {
            Query::Helm(_) => 0,
            Query::Modes(..) => 1,
            Query::Curves(..) => 2,
        }
    }
}

/// Queued queries and finished replies.
#[derive(Default)]
struct Queue {
    requests: BTreeMap<Asker, Query>,
    answers: BTreeMap<Asker, (Query, String)>,
    /// The viewer and kind of the query in progress, unless the viewer has left.
    current: Option<Asker>,
    /// The viewer served last, so that each viewer gets its turn.
    last: Asker,
    is_closed: bool,
}

/// The sources of replies.
pub(super) struct Sources {
    pub(super) scenario: Scenario,
    /// `None` if helm reports cannot be recomputed.
    pub(super) helms: Option<Box<dyn Helms>>,
    pub(super) plotter: Plotter,
}

pub(super) struct QueryThread(Arc<Watched<Queue>>);

impl QueryThread {
    pub(super) fn open(sources: Sources, news: Changes) -> QueryThread {
        let counter = Arc::new(Watched::<Queue>::default());
        let server = Arc::clone(&counter);
        let serve = move || serve(&server, sources, &news);
        // Without a thread no query is answered, and pages show this.
        drop(
            std::thread::Builder::new()
                .name("page-queries".to_owned())
                .spawn(serve),
        );
        QueryThread(counter)
    }

    /// Queues a viewer's query, replacing its earlier one of the same kind.
    pub(super) fn request(&self, viewer: u64, query: Query) {
        self.0
            .visit(|queue| queue.requests.insert((viewer, query.kind()), query));
    }

    /// Takes the newest helm report for a viewer, encoded for the page.
    pub(super) fn take_helm(&self, viewer: u64) -> Option<(HelmRequest, String)> {
        match self.0.visit(|queue| queue.answers.remove(&(viewer, 0)))? {
            (Query::Helm(request), text) => Some((request, text)),
            _ => None,
        }
    }

    /// Takes another reply for a viewer, encoded for the page.
    pub(super) fn take_other(&self, viewer: u64) -> Option<String> {
        self.0
            .visit(|queue| (1..=2).find_map(|kind| queue.answers.remove(&(viewer, kind))))
            .map(|(_, text)| text)
    }

    pub(super) fn remove(&self, viewer: u64) {
        self.0.visit(|queue| {
            queue.requests.retain(|(of, _), _| *of != viewer);
            queue.answers.retain(|(of, _), _| *of != viewer);
            queue.current.take_if(|(of, _)| *of == viewer);
        });
    }
}

impl Drop for QueryThread {
    fn drop(&mut self) {
        // The thread may be busy for a while; it ends by itself.
        self.0.visit(|queue| queue.is_closed = true);
    }
}

/// Answers queries one by one until the view closes.
fn serve(shared: &Watched<Queue>, mut sources: Sources, news: &Changes) {
    const ROUND: Duration = Duration::from_secs(60);
    loop {
        shared.wait(ROUND, |queue| queue.is_closed || !queue.requests.is_empty());
        if shared.visit(|queue| queue.is_closed) {
            return;
        }
        let Some(query) = shared.visit(Queue::next) else {
            continue;
        };
        let text = sources.answer(query);
        // If the viewer has left meanwhile, the reply is dropped.
        shared.visit(|queue| {
            queue
                .current
                .take()
                .map(|asker| queue.answers.insert(asker, (query, text)))
        });
        news.send_replace(());
    }
}

impl Sources {
    fn answer(&mut self, query: Query) -> String {
        match query {
            Query::Helm(HelmRequest {
                vehicle,
                decision,
                functions,
            }) => {
                let answer = match &mut self.helms {
                    Some(helms) => helms.report(vehicle, decision, functions),
                    None => HelmAnswer {
                        reason: Some("the recording does not contain this".to_owned()),
                        ..HelmAnswer::default()
                    },
                };
                helm_text(&self.scenario, vehicle, functions, answer)
            }
            Query::Modes(decision, at) => {
                let modes = self
                    .helms
                    .as_mut()
                    .map(|helms| helms.modes(decision))
                    .unwrap_or_default();
                PageMessage::Modes {
                    at_s: seconds(at),
                    modes: &modes,
                }
                .json()
            }
            Query::Curves(vehicle) => self.plotter.curves(vehicle),
        }
    }
}

impl Queue {
    fn next(&mut self) -> Option<Query> {
        let later = (Bound::Excluded(self.last), Bound::Unbounded);
        let after = self
            .requests
            .range(later)
            .next()
            .or_else(|| self.requests.iter().next());
        let asker = *after?.0;
        (self.last, self.current) = (asker, Some(asker));
        self.requests.remove(&asker)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::rose::tests::scenario;
    use std::sync::mpsc::{Receiver, Sender, channel};

    /// Helms that signal when they start and then wait for permission to continue.
    struct SlowHelms(Sender<()>, Receiver<()>);

    impl Helms for SlowHelms {
        fn report(&mut self, _: VehicleId, _: u64, _: bool) -> HelmAnswer {
            self.0.send(()).expect("the test listens");
            self.1.recv().expect("the test continues");
            HelmAnswer::default()
        }

        fn modes(&mut self, _: u64) -> Vec<Option<String>> {
            vec![]
        }
    }

    #[test]
    fn nothing_is_kept_for_a_reader_who_left_while_the_answer_was_worked_on() {
        let (began, begins) = channel();
        let (go, goes) = channel();
        let helms: Option<Box<dyn Helms>> = Some(Box::new(SlowHelms(began, goes)));
        let thread = QueryThread::open(
            Sources {
                scenario: scenario(),
                helms,
                plotter: Plotter::default(),
            },
            Changes::default(),
        );
        let request = HelmRequest {
            vehicle: VehicleId::at(0),
            decision: 1,
            functions: false,
        };
        for (viewer, leaves) in [(1, true), (2, false), (3, false)] {
            thread.request(viewer, Query::Helm(request));
            begins.recv().unwrap();
            if leaves {
                thread.remove(viewer);
            }
            go.send(()).unwrap();
        }
        // The third report starts only after the second was returned.
        let kept: Vec<u64> = thread.0.visit(|queue| {
            queue
                .answers
                .keys()
                .map(|(viewer, _)| *viewer)
                .filter(|viewer| *viewer < 3)
                .collect()
        });
        assert_eq!(kept, [2]);
    }
}
