//! Queries unpublished data of a game in its own thread, because replies take time.

use super::SharedState;
use super::live_state::{HelmMessage, LiveGame};
use crate::page::rose::{HelmAnswer, helm_text};
use crate::page::view::HELM_INTERVAL;
use bus::clock;
use bus::{Bus, Watched};
use messages::helm::{HelmQuestion, HelmReport};
use messages::topic;
use primitives::VehicleId;
use scenario::outcome::EventOutcome;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Interval between checks for pending queries.
const ROUND: Duration = Duration::from_millis(50);
/// Timeout for a helm's reply.
const HELM_ANSWER: Duration = Duration::from_secs(1);
/// Reciprocal of the maximum share of time that selected helms spend on replies.
const SHARE: u32 = 5;
/// Like [`SHARE`], for helms in the list of all boats, of which only the mode is needed.
const LIST_SHARE: u32 = 20;
/// Interval between queries for a helm's mode.
const LIST_INTERVAL: Duration = Duration::from_secs(2);
/// Timeout for the sim's list of events.
const EVENTS_ANSWER: Duration = Duration::from_secs(3);

/// Queries one game.
pub(super) struct QueryThread {
    pub(super) shared: Arc<SharedState>,
    pub(super) bus: Bus,
    pub(super) game: Arc<LiveGame>,
}

#[derive(Default)]
struct QuerySchedule {
    /// When each helm was last queried, and whether with utilities.
    asked: BTreeMap<VehicleId, (Instant, bool)>,
    /// Time before which no helm is queried.
    rest: Option<Instant>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Turn {
    vehicle: VehicleId,
    /// Whether to include utilities.
    functions: bool,
    /// Whether only the mode is needed, for a boat that no page selects.
    is_listed: bool,
}

impl QuerySchedule {
    /// The helm to query now, if any: the one that has waited longest. Selected helms come before
    /// those that are only listed.
    fn next(
        &mut self,
        wanted: &BTreeMap<VehicleId, bool>,
        listed: &[VehicleId],
        now: Instant,
    ) -> Option<Turn> {
        self.asked
            .retain(|vehicle, _| wanted.contains_key(vehicle) || listed.contains(vehicle));
        if self.rest.is_some_and(|rest| now < rest) {
            return None;
        }
        let start = |turn: &Turn| self.asked.get(&turn.vehicle).map(|(start, _)| *start);
        let is_due = |turn: &Turn| {
            let interval = if turn.is_listed {
                LIST_INTERVAL
            } else {
                HELM_INTERVAL
            };
            self.asked.get(&turn.vehicle).is_none_or(|(start, had)| {
                (turn.functions && !had) || now.saturating_duration_since(*start) >= interval
            })
        };
        let selected = wanted
            .iter()
            .map(|(vehicle, functions)| (*vehicle, *functions, false));
        let others = listed
            .iter()
            .filter(|vehicle| !wanted.contains_key(vehicle))
            .map(|vehicle| (*vehicle, false, true));
        let turns = selected
            .chain(others)
            .map(|(vehicle, functions, is_listed)| Turn {
                vehicle,
                functions,
                is_listed,
            });
        turns
            .filter(is_due)
            .min_by_key(|turn| (turn.is_listed, start(turn)))
    }

    /// Records a query from `start` to `end`. A lockstep game waits while a mind answers, and one
    /// process may run all minds, so after a long reply no helm is queried for some time. A paused
    /// game does not wait for minds.
    fn update(&mut self, turn: Turn, start: Instant, end: Instant, is_going: bool) {
        self.asked.insert(turn.vehicle, (start, turn.functions));
        let share = if turn.is_listed { LIST_SHARE } else { SHARE };
        self.rest = is_going.then(|| start + end.saturating_duration_since(start) * share);
    }
}

impl QueryThread {
    /// Queries until the game is left.
    pub(super) fn ask(&self, left: &Watched<bool>) {
        let mut schedule = QuerySchedule::default();
        while !left.wait(ROUND, |left| *left) {
            self.ask_events();
            let (wanted, listed) = {
                let state = self.shared.state.lock();
                (state.wanted(), state.listed())
            };
            let start = clock::now();
            if let Some(turn) = schedule.next(&wanted, &listed, start) {
                self.ask_helm(turn);
                let end = clock::now();
                let is_going = self.shared.state.lock().phase(end) == "playing";
                schedule.update(turn, start, end, is_going);
            }
        }
    }

    /// Queries the sim for all events if some were missed.
    fn ask_events(&self) {
        if !self
            .shared
            .state
            .lock()
            .event_log
            .should_query(clock::now())
        {
            return;
        }
        let answer = self
            .bus
            .ask(&topic::events(&self.game.name), Vec::new(), EVENTS_ANSWER);
        // Older sims do not reply; then the log contains only events from frames.
        let events = answer
            .ok()
            .flatten()
            .and_then(|bytes| serde_json::from_slice::<Vec<EventOutcome>>(&bytes).ok());
        if let Some(events) = events {
            self.shared.state.lock().event_log.replace(events);
            self.shared.news.send_replace(());
        }
    }

    fn ask_helm(
        &self,
        Turn {
            vehicle,
            functions,
            is_listed,
        }: Turn,
    ) {
        let question = serde_json::to_vec(&HelmQuestion { functions }).unwrap_or_default();
        let key = topic::helm(&self.game.name, self.game.scenario(), vehicle);
        let answer = self
            .bus
            .ask_node(&key, question, HELM_ANSWER)
            .ok()
            .flatten();
        let name = self.game.name_of(vehicle);
        let answer = match answer.map(|bytes| serde_json::from_slice::<Option<HelmReport>>(&bytes))
        {
            Some(Ok(Some(report))) => HelmAnswer {
                report: Some(report),
                ..HelmAnswer::default()
            },
            Some(Ok(None)) => because(format!("the agent of {name} has no helm")),
            Some(Err(_)) => because(format!(
                "the agent of {name} is running a different version of Squall"
            )),
            None => because(format!("no agent is running {name} now")),
        };
        self.shared
            .state
            .lock()
            .take_mode(vehicle, answer.report.as_ref());
        if is_listed {
            self.shared.news.send_replace(());
            return;
        }
        // Encoding a full report takes a long time, so unlock the state meanwhile.
        let full =
            functions.then(|| helm_text(self.game.scenario(), vehicle, true, answer.clone()));
        let light = helm_text(self.game.scenario(), vehicle, false, answer);
        self.shared
            .state
            .lock()
            .helms
            .insert(vehicle, Arc::new(HelmMessage { light, full }));
        self.shared.news.send_replace(());
    }
}

fn because(reason: String) -> HelmAnswer {
    HelmAnswer {
        reason: Some(reason),
        ..HelmAnswer::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOATS: [VehicleId; 3] = [VehicleId(0), VehicleId(1), VehicleId(2)];

    /// Simulates queries with equal reply times. Returns the helms queried, with times in ms.
    fn asked(
        (wanted, listed): (&BTreeMap<VehicleId, bool>, &[VehicleId]),
        took_ms: u64,
        until_ms: u64,
        is_going: bool,
    ) -> Vec<(VehicleId, u64)> {
        let start = clock::now();
        let at = |ms| start + Duration::from_millis(ms);
        let mut schedule = QuerySchedule::default();
        let mut now_ms = 0;
        let mut asked = vec![];
        while now_ms < until_ms {
            if let Some(turn) = schedule.next(wanted, listed, at(now_ms)) {
                schedule.update(turn, at(now_ms), at(now_ms + took_ms), is_going);
                asked.push((turn.vehicle, now_ms));
                now_ms += took_ms;
            }
            now_ms += 50;
        }
        asked
    }

    #[test]
    fn long_answers_leave_most_of_the_time_to_the_game_however_many_boats_are_looked_at() {
        for boats in 1..=BOATS.len() {
            let wanted: BTreeMap<VehicleId, bool> =
                BOATS[..boats].iter().map(|boat| (*boat, true)).collect();
            let all = asked((&wanted, &[]), 400, 12_000, true);
            assert_eq!(
                all.iter().map(|(_, at_ms)| *at_ms).collect::<Vec<_>>(),
                [0, 2000, 4000, 6000, 8000, 10_000]
            );
            let schedule: Vec<VehicleId> = BOATS[..boats]
                .iter()
                .copied()
                .cycle()
                .take(all.len())
                .collect();
            assert_eq!(
                all.iter().map(|(boat, _)| *boat).collect::<Vec<_>>(),
                schedule,
                "all are queried in turn"
            );
        }
    }

    #[test]
    fn short_answers_come_as_often_as_pages_are_told() {
        let wanted = BTreeMap::from([(BOATS[0], false), (BOATS[1], false)]);
        let all = asked((&wanted, &[]), 0, 2000, true);
        for boat in &BOATS[..2] {
            assert_eq!(
                all.iter().filter(|(asked, _)| asked == boat).count(),
                20,
                "{all:?}"
            );
        }
    }

    #[test]
    fn in_a_game_that_stands_a_miss_is_soon_asked_for_again() {
        let wanted = BTreeMap::from([(BOATS[0], true)]);
        let took_ms = HELM_ANSWER.as_millis() as u64;
        let times = |is_going| {
            asked((&wanted, &[]), took_ms, 6000, is_going)
                .iter()
                .map(|(_, at)| *at)
                .collect::<Vec<_>>()
        };
        assert_eq!(times(true), [0, 5000]);
        assert_eq!(times(false), [0, 1050, 2100, 3150, 4200, 5250]);
    }

    #[test]
    fn who_wants_utilities_too_does_not_wait_for_the_next_round() {
        let mut schedule = QuerySchedule::default();
        let start = clock::now();
        let turn = |functions| Turn {
            vehicle: BOATS[0],
            functions,
            is_listed: false,
        };
        schedule.update(turn(false), start, start, true);
        assert_eq!(
            schedule.next(&BTreeMap::from([(BOATS[0], false)]), &[], start),
            None
        );
        assert_eq!(
            schedule.next(&BTreeMap::from([(BOATS[0], true)]), &[], start),
            Some(turn(true))
        );
    }

    #[test]
    fn modes_of_all_boats_cost_little_and_keep_no_boat_that_is_looked_at_waiting() {
        let wanted = BTreeMap::from([(BOATS[0], true)]);
        let of =
            |all: &[(VehicleId, u64)], boat| all.iter().filter(|(asked, _)| *asked == boat).count();
        let quick = asked((&wanted, &BOATS), 0, 4000, true);
        assert_eq!(BOATS.map(|boat| of(&quick, boat)), [40, 2, 2], "{quick:?}");
        // With no boat selected, replies take a twentieth of the time, and each helm has its turn.
        let slow = asked((&BTreeMap::new(), &BOATS), 100, 12_000, true);
        assert_eq!(slow.len(), 6, "{slow:?}");
        assert_eq!(BOATS.map(|boat| of(&slow, boat)), [2, 2, 2]);
    }
}
