//! The queries: asks a game for what is not published, in a thread of its own, since answers take their time.

use super::SharedState;
use super::live_state::{HelmMessage, LiveGame};
use crate::page::rose::{HelmAnswer, helm_text};
use crate::page::view::HELM_INTERVAL;
use bus::clock;
use bus::{Bus, Watched};
use game::VehicleId;
use game::helm::{HelmQuestion, HelmReport};
use game::outcome::EventOutcome;
use game::topic;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// How often to see whether there is something to ask.
const ROUND: Duration = Duration::from_millis(50);
/// How long a helm may think about its answer.
const HELM_ANSWER: Duration = Duration::from_secs(1);
/// No more than one part in so many of the time is spent on the answers of helms.
const SHARE: u32 = 5;
/// How long the sim may collect its events.
const EVENTS_ANSWER: Duration = Duration::from_secs(3);

/// Asks one game.
pub(super) struct QueryThread {
    pub(super) shared: Arc<SharedState>,
    pub(super) bus: Bus,
    pub(super) game: Arc<LiveGame>,
}

/// Whose helm is asked next.
#[derive(Default)]
struct QuerySchedule {
    /// When each was asked last, and whether with utilities.
    asked: BTreeMap<VehicleId, (Instant, bool)>,
    /// Until when nobody is asked.
    rest: Option<Instant>,
}

impl QuerySchedule {
    /// Whose turn it is, if it is anybody's: of those that are due, the one that has waited longest.
    fn next(&mut self, wanted: &BTreeMap<VehicleId, bool>, now: Instant) -> Option<(VehicleId, bool)> {
        self.asked.retain(|vehicle, _| wanted.contains_key(vehicle));
        if self.rest.is_some_and(|rest| now < rest) {
            return None;
        }
        let is_due = |vehicle: &VehicleId, functions: bool| {
            self.asked.get(vehicle).is_none_or(|(start, had)| {
                (functions && !had) || now.saturating_duration_since(*start) >= HELM_INTERVAL
            })
        };
        let due = wanted.iter().filter(|(vehicle, functions)| is_due(vehicle, **functions));
        let longest = due.min_by_key(|(vehicle, _)| self.asked.get(vehicle).map(|(start, _)| *start));
        longest.map(|(vehicle, functions)| (*vehicle, *functions))
    }

    /// A helm was asked from `start` to `end`. In lockstep a game waits while a mind answers, and one process may mind all
    /// boats: after a long answer all have a rest. A game that stands waits for nobody.
    fn update(&mut self, asked: (VehicleId, bool), start: Instant, end: Instant, is_going: bool) {
        self.asked.insert(asked.0, (start, asked.1));
        self.rest = is_going.then(|| start + end.saturating_duration_since(start) * SHARE);
    }
}

impl QueryThread {
    /// Asks until the game is left.
    pub(super) fn ask(&self, left: &Watched<bool>) {
        let mut schedule = QuerySchedule::default();
        while !left.wait(ROUND, |left| *left) {
            self.ask_events();
            let wanted = self.shared.state.lock().wanted();
            let start = clock::now();
            if let Some((vehicle, functions)) = schedule.next(&wanted, start) {
                self.ask_helm(vehicle, functions);
                let end = clock::now();
                let is_going = self.shared.state.lock().phase(end) == "playing";
                schedule.update((vehicle, functions), start, end, is_going);
            }
        }
    }

    /// All that has happened, where something of it was missed.
    fn ask_events(&self) {
        if !self.shared.state.lock().event_log.should_query(clock::now()) {
            return;
        }
        let answer = self.bus.ask(&topic::events(&self.game.name), Vec::new(), EVENTS_ANSWER);
        // An older sim does not answer; then frames are all there is.
        let events = answer.ok().flatten().and_then(|bytes| serde_json::from_slice::<Vec<EventOutcome>>(&bytes).ok());
        if let Some(events) = events {
            self.shared.state.lock().event_log.replace(events);
            self.shared.news.send_replace(());
        }
    }

    fn ask_helm(&self, vehicle: VehicleId, functions: bool) {
        let question = serde_json::to_vec(&HelmQuestion { functions }).unwrap_or_default();
        let key = topic::helm(&self.game.name, self.game.scenario(), vehicle);
        let answer = self.bus.ask(&key, question, HELM_ANSWER).ok().flatten();
        let name = self.game.name_of(vehicle);
        let answer = match answer.map(|bytes| serde_json::from_slice::<Option<HelmReport>>(&bytes)) {
            Some(Ok(Some(report))) => HelmAnswer { report: Some(report), ..HelmAnswer::default() },
            Some(Ok(None)) => because(format!("the mind of {name} goes by no helm")),
            Some(Err(_)) => because(format!("the mind of {name} is of another version of Squall")),
            None => because(format!("no agent runs {name} now")),
        };
        // Long work with a long report, for which the state is not kept from others.
        let full = functions.then(|| helm_text(self.game.scenario(), vehicle, true, answer.clone()));
        let light = helm_text(self.game.scenario(), vehicle, false, answer);
        self.shared.state.lock().helms.insert(vehicle, Arc::new(HelmMessage { light, full }));
        self.shared.news.send_replace(());
    }
}

fn because(reason: String) -> HelmAnswer {
    HelmAnswer { reason: Some(reason), ..HelmAnswer::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOATS: [VehicleId; 3] = [VehicleId(0), VehicleId(1), VehicleId(2)];

    /// Asks for so long, each answer after as long: who was asked when, ms.
    fn asked(wanted: &BTreeMap<VehicleId, bool>, took_ms: u64, until_ms: u64, is_going: bool) -> Vec<(VehicleId, u64)> {
        let start = clock::now();
        let at = |ms| start + Duration::from_millis(ms);
        let (mut schedule, mut now_ms, mut asked) = (QuerySchedule::default(), 0, vec![]);
        while now_ms < until_ms {
            if let Some(turn) = schedule.next(wanted, at(now_ms)) {
                schedule.update(turn, at(now_ms), at(now_ms + took_ms), is_going);
                asked.push((turn.0, now_ms));
                now_ms += took_ms;
            }
            now_ms += 50;
        }
        asked
    }

    #[test]
    fn long_answers_leave_most_of_the_time_to_the_game_however_many_boats_are_looked_at() {
        for boats in 1..=BOATS.len() {
            let wanted: BTreeMap<VehicleId, bool> = BOATS[..boats].iter().map(|boat| (*boat, true)).collect();
            let all = asked(&wanted, 400, 12_000, true);
            assert_eq!(all.iter().map(|(_, at_ms)| *at_ms).collect::<Vec<_>>(), [0, 2000, 4000, 6000, 8000, 10_000]);
            let schedule: Vec<VehicleId> = BOATS[..boats].iter().copied().cycle().take(all.len()).collect();
            assert_eq!(all.iter().map(|(boat, _)| *boat).collect::<Vec<_>>(), schedule, "each gets its turn");
        }
    }

    #[test]
    fn short_answers_come_as_often_as_pages_are_told() {
        let wanted = BTreeMap::from([(BOATS[0], false), (BOATS[1], false)]);
        let all = asked(&wanted, 0, 2000, true);
        for boat in &BOATS[..2] {
            assert_eq!(all.iter().filter(|(asked, _)| asked == boat).count(), 4, "{all:?}");
        }
    }

    #[test]
    fn in_a_game_that_stands_a_miss_is_soon_asked_for_again() {
        let wanted = BTreeMap::from([(BOATS[0], true)]);
        let took_ms = HELM_ANSWER.as_millis() as u64;
        let times = |is_going| asked(&wanted, took_ms, 6000, is_going).iter().map(|(_, at)| *at).collect::<Vec<_>>();
        assert_eq!(times(true), [0, 5000]);
        assert_eq!(times(false), [0, 1050, 2100, 3150, 4200, 5250]);
    }

    #[test]
    fn who_wants_utilities_too_does_not_wait_for_the_next_round() {
        let (mut schedule, start) = (QuerySchedule::default(), clock::now());
        schedule.update((BOATS[0], false), start, start, true);
        assert_eq!(schedule.next(&BTreeMap::from([(BOATS[0], false)]), start), None);
        assert_eq!(schedule.next(&BTreeMap::from([(BOATS[0], true)]), start), Some((BOATS[0], true)));
    }
}
