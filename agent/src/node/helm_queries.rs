//! Helm queries: requests for a boat's helm report, answered between decisions.

use super::error::NodeError;
use crate::{Mind, MindRunner};
use bus::{Bus, Declaration, Inbox, Query, clock, inbox};
use messages::helm::HelmQuestion;
use messages::topic::{self, GameName};
use primitives::VehicleId;
use scenario::Scenario;
use std::time::{Duration, Instant};

/// Capacity of the query queue.
const INBOX: usize = 32;
/// How long a mind keeps utilities after the last query that requested them.
const LOOKED_AT: Duration = Duration::from_secs(5);
/// How long a query waits for the first decision with kept utilities. A paused game makes no
/// decisions, and the web page waits at most a second.
const NEXT_DECISION: Duration = Duration::from_millis(500);
/// Maximum number of answers between picture polls: a flood of queries must not keep a boat from
/// deciding.
const ANSWERS: usize = 2;

/// A query about one of the boats.
struct Asked {
    vehicle: VehicleId,
    wants: HelmQuestion,
    query: Query,
    at: Instant,
}

/// The queries about the helms of this process.
pub(super) struct HelmQueries {
    inbox: Inbox<(VehicleId, Query)>,
    /// Queries received before the first decision with kept utilities.
    waiting: Vec<Asked>,
    /// The inspected boats, each with the time of its last query.
    looked: Vec<(VehicleId, Instant)>,
    _declarations: Vec<Declaration>,
}

impl HelmQueries {
    /// Opens the query endpoint of each helm.
    pub(super) fn open(
        bus: &Bus,
        game: &GameName,
        scenario: &Scenario,
        runner: &MindRunner,
    ) -> Result<HelmQueries, NodeError> {
        let (inbox_sender, inbox) = inbox(INBOX);
        let mut declarations = Vec::new();
        for (vehicle, _) in runner.minds() {
            let inbox_sender = inbox_sender.clone();
            let take = move |query| inbox_sender.put((vehicle, query));
            declarations.push(bus.answer(topic::helm(game, scenario, vehicle), take)?);
        }
        Ok(HelmQueries {
            inbox,
            waiting: Vec::new(),
            looked: Vec::new(),
            _declarations: declarations,
        })
    }

    /// Answers pending queries. `decided` states whether the minds have decided since the last
    /// call.
    pub(super) fn answer(&mut self, runner: &mut MindRunner, decided: bool) {
        let waiting = std::mem::take(&mut self.waiting);
        for asked in waiting {
            if decided || clock::since(asked.at) >= NEXT_DECISION {
                reply(runner, asked);
            } else {
                self.waiting.push(asked);
            }
        }
        for _ in 0..ANSWERS {
            let Some((vehicle, query)) = self.inbox.take_now() else {
                break;
            };
            self.answer_query(runner, vehicle, query);
        }
        self.looked.retain(|(vehicle, at)| {
            let is_looked_at = clock::since(*at) <= LOOKED_AT;
            show(runner, *vehicle, is_looked_at);
            is_looked_at
        });
    }

    fn answer_query(&mut self, runner: &mut MindRunner, vehicle: VehicleId, query: Query) {
        // A query without a payload requests the short answer.
        let wants: HelmQuestion = serde_json::from_slice(query.payload()).unwrap_or_default();
        let asked = Asked {
            vehicle,
            wants,
            query,
            at: clock::now(),
        };
        if !wants.functions {
            // Modes and weights need no inspection, so listing boats costs a helm nothing.
            return reply(runner, asked);
        }
        match self
            .looked
            .iter_mut()
            .find(|(looked, _)| *looked == vehicle)
        {
            Some((_, at)) => *at = asked.at,
            None => {
                self.looked.push((vehicle, asked.at));
                show(runner, vehicle, true);
                return self.postpone(asked);
            }
        }
        if self
            .waiting
            .iter()
            .any(|waiting| waiting.vehicle == vehicle)
        {
            self.postpone(asked);
        } else {
            reply(runner, asked);
        }
    }

    fn postpone(&mut self, asked: Asked) {
        // Excess queries are dropped unanswered; clients retry.
        if self.waiting.len() < INBOX {
            self.waiting.push(asked);
        }
    }
}

fn show(runner: &mut MindRunner, vehicle: VehicleId, shown: bool) {
    if let Some(mind) = runner.mind_mut(vehicle) {
        mind.show(shown);
    }
}

fn reply(runner: &MindRunner, asked: Asked) {
    let mut report = runner.mind(asked.vehicle).and_then(Mind::report);
    if let Some(report) = report.as_mut().filter(|_| !asked.wants.functions) {
        report
            .functions
            .iter_mut()
            .for_each(|function| function.utilities.clear());
    }
    asked
        .query
        .answer(serde_json::to_vec(&report).expect("a report can be encoded"));
}
