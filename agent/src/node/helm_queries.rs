//! A window into helms: questions what a boat's helm thinks, answered between decisions.

use super::NodeError;
use super::agent_loop::Seated;
use bus::{Bus, Declaration, Inbox, Query, clock, inbox};
use game::Scenario;
use game::helm::HelmQuestion;
use game::topic::{self, GameName};
use std::time::{Duration, Instant};

/// Questions that may wait to be looked at.
const INBOX: usize = 32;
/// A mind keeps what people look at for this long after the last question.
const LOOKED_AT: Duration = Duration::from_secs(5);
/// A question that came before anything was kept waits this long for the next decision. In a game that is paused there is
/// none, and the page waits no longer than a second.
const NEXT_DECISION: Duration = Duration::from_millis(500);
/// Answers between two looks at the pictures: a flood of questions must not keep a boat from deciding.
const ANSWERS: usize = 2;

/// A question about one of the boats.
struct Asked {
    /// Index of the seat.
    seat: usize,
    wants: HelmQuestion,
    question: Query,
    at: Instant,
}

/// What people ask of the helms here.
pub(super) struct HelmQueries {
    inbox: Inbox<(usize, Query)>,
    /// Asked before a decision was kept.
    waiting: Vec<Asked>,
    /// When each seat was looked at last, if it is looked at.
    looked: Vec<Option<Instant>>,
    _standing: Vec<Declaration>,
}

impl HelmQueries {
    /// Opens a window into each helm.
    pub(super) fn open(
        bus: &Bus,
        game: &GameName,
        scenario: &Scenario,
        seated: &[Seated],
    ) -> Result<HelmQueries, NodeError> {
        let (inbox_sender, inbox) = inbox(INBOX);
        let mut standing = Vec::new();
        for (i, seat) in seated.iter().enumerate() {
            let inbox_sender = inbox_sender.clone();
            let take = move |question| inbox_sender.put((i, question));
            standing.push(bus.answer(topic::helm(game, scenario, seat.vehicle), take)?);
        }
        Ok(HelmQueries { inbox, waiting: Vec::new(), looked: vec![None; seated.len()], _standing: standing })
    }

    /// Answers what was asked; `decided` says whether the minds have decided since the last time.
    pub(super) fn answer(&mut self, seated: &mut [Seated], decided: bool) {
        let waiting = std::mem::take(&mut self.waiting);
        for asked in waiting {
            if decided || clock::since(asked.at) >= NEXT_DECISION {
                reply(&seated[asked.seat], asked.wants, asked.question);
            } else {
                self.waiting.push(asked);
            }
        }
        for _ in 0..ANSWERS {
            let Some((seat, question)) = self.inbox.take_now() else { break };
            self.take(seated, seat, question);
        }
        for (seat, looked) in seated.iter_mut().zip(&mut self.looked) {
            if looked.take_if(|at| clock::since(*at) > LOOKED_AT).is_some() {
                seat.mind.show(false);
            }
        }
    }

    fn take(&mut self, seated: &mut [Seated], seat: usize, question: Query) {
        // Whoever asks without words wants the short answer.
        let wants: HelmQuestion = serde_json::from_slice(&question.payload).unwrap_or_default();
        let at = clock::now();
        if self.looked[seat].replace(at).is_none() {
            seated[seat].mind.show(true);
        } else if !self.waiting.iter().any(|asked| asked.seat == seat) {
            return reply(&seated[seat], wants, question);
        }
        if self.waiting.len() < INBOX {
            self.waiting.push(Asked { seat, wants, question, at });
        }
    }
}

fn reply(seat: &Seated, wants: HelmQuestion, question: Query) {
    let mut report = seat.mind.report();
    if let Some(report) = report.as_mut().filter(|_| !wants.functions) {
        report.functions.iter_mut().for_each(|function| function.utilities.clear());
    }
    question.answer(serde_json::to_vec(&report).expect("a report is JSON"));
}
