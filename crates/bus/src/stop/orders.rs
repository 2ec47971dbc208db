//! Requested stops and later reports of boats: which stops to repeat, and which are done. Uses no
//! sockets and no clock.

#[cfg(test)]
mod tests;

use super::StopCommand;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::{Duration, Instant};

/// When a stop is sent, ms after the request. At such short intervals, a lost message costs little
/// time, and the repeats let TCP detect the loss immediately.
const SOON_MS: [u64; 6] = [0, 10, 20, 40, 80, 160];
/// The interval of later repeats.
const AGAIN: Duration = Duration::from_millis(200);
/// A published status may be older than the stop. For this time, the stop is repeated even if a
/// status shows it, and a status is ignored unless the boat was previously known to be in a
/// different state.
const DOUBTED: Duration = Duration::from_secs(1);
/// Maximum time by which a gateway's clock may fall behind from one status to the next.
const DRIFT: Duration = Duration::from_micros(100);
/// Apparent shift of a gateway's start time above which the gateway must have been restarted.
const RESTARTED: Duration = Duration::from_secs(10);
/// Time during which a stop of all boats goes to all; then it goes only to boats that do not show
/// it.
const TO_EVERYBODY: Duration = Duration::from_secs(2);
/// Time after which a boat that does not show a stop is reported as late.
const LATE: Duration = Duration::from_secs(2);
/// Time without hearing from a boat after which it counts as silent.
const SILENCE: Duration = Duration::from_secs(3);
/// Time without hearing directly from a boat after which the sim's copies count.
const RELAYED_AFTER: Duration = Duration::from_secs(1);
/// Maximum number of unread news; the oldest are discarded first.
const NEWS_MAX: usize = 1024;

/// The known facts about a boat.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownBoat {
    /// The boat's last reported state as a string, if any.
    pub state: Option<String>,
    /// When the boat was last heard, directly or through the sim.
    pub heard: Option<Instant>,
    /// When the boat was last heard directly, not through a copy from the sim.
    heard_itself: Option<Instant>,
    /// When the boat's gateway started, according to the status with the shortest delay.
    began: Option<Instant>,
    /// Whether the boat has been silent for some time.
    pub is_silent: bool,
}

/// News for an operator.
#[derive(Clone, Debug, PartialEq)]
pub enum StopNews {
    /// A boat's own status shows a stop for the first time.
    Done {
        /// The name of the boat.
        vehicle: String,
        /// The kind of stop.
        command: StopCommand,
        /// The state as a string.
        state: String,
        /// Time since the request.
        after: Duration,
    },
    /// A boat still does not show a stop after some time.
    Late {
        /// The name of the boat.
        vehicle: String,
        /// The kind of stop.
        command: StopCommand,
    },
    /// The sim's answer to a stop of all boats: after how long it came, or why the sim refused or
    /// did not answer.
    Sim(Result<Duration, String>),
    /// The state of a boat has changed.
    State {
        /// The name of the boat.
        vehicle: String,
        /// The state as a string.
        state: String,
    },
    /// A boat has been silent for some time.
    Silent {
        /// The name of the boat.
        vehicle: String,
    },
}

/// How a boat's report relates to a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// The answer to this stop.
    Answer(u64),
    /// A published state from no earlier than the given time: it may be older than a stop requested
    /// meanwhile.
    Published(Instant),
    /// A copy from the sim, which received the original no earlier than the given time.
    Relayed(Instant),
}

/// A requested stop.
#[derive(Clone, Debug)]
struct Stop {
    number: u64,
    /// The boat; `None` means all boats.
    target: Option<String>,
    command: StopCommand,
    asked: Instant,
    /// The number of times that the stop was sent.
    said: usize,
    /// Boats that show the stop, and whether the report is certainly newer than the stop.
    shown: BTreeMap<String, bool>,
    /// Boats that were in a different state when the stop was requested, or have been since.
    others: BTreeSet<String>,
    /// The sim's answer to a stop of all boats.
    sim: Option<Result<(), String>>,
    is_late: bool,
    /// Whether to send the stop at once because a path was added.
    is_hurried: bool,
    /// Whether a later command supersedes the stop.
    is_cancelled: bool,
}

/// A stop to be sent now.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Saying {
    pub(super) number: u64,
    pub(super) command: StopCommand,
    /// Whether the stop is for all boats.
    pub(super) is_of_fleet: bool,
    /// Whether the stop is still sent to all boats, even to those that already show it.
    pub(super) to_everybody: bool,
    /// The boats that do not certainly show the stop yet.
    pub(super) boats: Vec<String>,
}

/// All requested stops, and the known boats.
pub struct StopOrders {
    /// How long a stop that is not shown is repeated.
    limit: Duration,
    boats: BTreeMap<String, KnownBoat>,
    /// Whether all boats are known because a game has named them.
    is_complete: bool,
    stops: Vec<Stop>,
    count: u64,
    /// The number of requests and added paths so far.
    pub(super) changes: u64,
    /// The unread news.
    pub(super) news: VecDeque<StopNews>,
}

impl StopOrders {
    /// No stops yet. A stop that is not shown is repeated for up to `limit`.
    pub(super) fn new(limit: Duration) -> StopOrders {
        let boats = BTreeMap::new();
        let stops = Vec::new();
        let news = VecDeque::new();
        StopOrders {
            limit,
            boats,
            is_complete: false,
            stops,
            count: 0,
            changes: 0,
            news,
        }
    }

    /// Whether a boat has shown the last stop of this kind that was requested for it alone.
    pub fn is_shown(&self, vehicle: &str, command: StopCommand) -> bool {
        let is_it =
            |stop: &&Stop| stop.command == command && stop.target.as_deref() == Some(vehicle);
        self.stops
            .iter()
            .find(is_it)
            .is_some_and(|stop| stop.shown.contains_key(vehicle))
    }

    /// The known boats.
    pub fn boats(&self) -> impl Iterator<Item = (&String, &KnownBoat)> {
        self.boats.iter()
    }

    /// Whether every stop is certainly done; a stop of all boats is not certain before a game has
    /// named its boats.
    pub fn is_done(&self, now: Instant) -> bool {
        let is_for_all = self.stops.iter().any(|stop| stop.target.is_none());
        let is_sure = |stop: &Stop| {
            now >= stop.asked + DOUBTED || stop.shown.values().all(|is_sure| *is_sure)
        };
        (self.is_complete || !is_for_all)
            && self.unfinished().is_empty()
            && self.stops.iter().all(is_sure)
    }

    /// Returns and clears the unread news.
    pub fn take_news(&mut self) -> Vec<StopNews> {
        self.news.drain(..).collect()
    }

    /// Expects a boat to show stops of all boats, whether it is heard from or not.
    pub(super) fn expect(&mut self, vehicle: &str) {
        let unheard = KnownBoat {
            state: None,
            heard: None,
            heard_itself: None,
            began: None,
            is_silent: false,
        };
        self.boats.entry(vehicle.to_owned()).or_insert(unheard);
    }

    /// Forgets a boat that turns out to have a different name, or not to exist.
    pub(super) fn forget(&mut self, vehicle: &str) {
        self.boats.remove(vehicle);
    }

    /// Records that no more boats will be named: either all boats of the game are now expected, or
    /// there is no game.
    pub fn complete(&mut self) {
        self.is_complete = true;
    }

    /// Requests a stop; it replaces an earlier one of the same kind and target.
    pub(super) fn ask(
        &mut self,
        now: Instant,
        target: Option<String>,
        command: StopCommand,
    ) -> u64 {
        // Pressing the button again requests a new confirmation, not the earlier one.
        self.stops
            .retain(|stop| (&stop.target, stop.command) != (&target, command));
        self.count += 1;
        let is_other = |boat: &KnownBoat| {
            boat.state
                .as_ref()
                .is_some_and(|state| !command.is_shown_by(state))
        };
        let others = self
            .boats
            .iter()
            .filter(|(_, boat)| is_other(boat))
            .map(|(name, _)| name.clone())
            .collect();
        self.stops.push(Stop {
            number: self.count,
            target,
            command,
            asked: now,
            said: 0,
            shown: BTreeMap::new(),
            others,
            sim: None,
            is_late: false,
            is_hurried: false,
            is_cancelled: false,
        });
        self.changes += 1;
        self.count
    }

    /// Whether a stop was requested within the last `time`.
    pub(super) fn is_asked_within(&self, now: Instant, time: Duration) -> bool {
        self.stops.iter().any(|stop| now < stop.asked + time)
    }

    /// Sends unfinished stops at once, because a path was added.
    pub(super) fn hurry(&mut self) {
        self.stops
            .iter_mut()
            .for_each(|stop| stop.is_hurried = true);
        self.changes += 1;
    }

    /// The stops of all boats that no sim has answered.
    pub(super) fn unanswered(&self) -> Vec<u64> {
        let stops = self
            .stops
            .iter()
            .filter(|stop| stop.target.is_none() && stop.command == StopCommand::EStop);
        stops
            .filter(|stop| !stop.is_cancelled && stop.sim.is_none())
            .map(|stop| stop.number)
            .collect()
    }

    /// Ends the repeats of earlier stops of one boat or all boats, because of a newer command.
    pub fn cancel(&mut self, target: Option<&str>) {
        let is_meant = |stop: &Stop| {
            target.is_none() || stop.target.is_none() || stop.target.as_deref() == target
        };
        self.stops
            .iter_mut()
            .filter(|stop| is_meant(stop))
            .for_each(|stop| stop.is_cancelled = true);
    }

    /// The earliest time at which a status arriving now can have been true; `at_s` is its time
    /// since the gateway started, s.
    pub(super) fn as_of(&mut self, now: Instant, vehicle: &str, at_s: f64) -> Instant {
        let at = Duration::try_from_secs_f64(at_s).ok();
        let (Some(boat), Some(at)) = (self.boats.get_mut(vehicle), at) else {
            return now;
        };
        let Some(began) = now.checked_sub(at) else {
            return now;
        };
        // The clocks may drift apart, and a restarted gateway started later. The earliest start
        // time implied by any status comes from the status with the shortest delay; later statuses
        // are judged by it.
        let known = boat
            .began
            .map(|known| known + DRIFT)
            .filter(|known| began < *known + RESTARTED);
        let began = known.map_or(began, |known| known.min(began));
        boat.began = Some(began);
        began + at
    }

    /// Records a boat's reported state.
    pub(super) fn report(&mut self, now: Instant, vehicle: &str, state: &str, source: Source) {
        self.expect(vehicle);
        let Some(boat) = self.boats.get_mut(vehicle) else {
            return;
        };
        let relayed = if let Source::Relayed(as_of) = source {
            Some(as_of)
        } else {
            None
        };
        if relayed.is_none() {
            boat.heard_itself = Some(now);
        }
        // The boat's own report is newer than the sim's copy.
        let is_news = relayed.is_none()
            || boat
                .heard_itself
                .is_none_or(|heard| now >= heard + RELAYED_AFTER);
        let is_change = is_news && (boat.state.as_deref() != Some(state) || boat.is_silent);
        if is_news {
            (boat.state, boat.heard, boat.is_silent) = (Some(state.to_owned()), Some(now), false);
        }
        let mut news = Vec::new();
        for stop in self.stops.iter_mut().filter(|stop| {
            stop.target
                .as_deref()
                .is_none_or(|target| target == vehicle)
        }) {
            // A status in transit may be older than the stop: the only proof is an answer to the
            // stop, or a status that is certainly newer.
            let is_sure = source == Source::Answer(stop.number)
                || relayed.is_some_and(|as_of| as_of > stop.asked);
            // A lost packet can delay a status by longer than a stop takes.
            if matches!(source, Source::Published(as_of) if as_of < stop.asked)
                && now < stop.asked + DOUBTED
            {
                continue;
            }
            if relayed.is_some() && !(is_sure && stop.command.is_shown_by(state)) {
                continue;
            }
            if !stop.command.is_shown_by(state) {
                stop.others.insert(vehicle.to_owned());
            } else if !is_sure && now < stop.asked + DOUBTED && !stop.others.contains(vehicle) {
                continue;
            }
            match stop.shown.get(vehicle).copied() {
                None if stop.command.is_shown_by(state) => {
                    let vehicle = vehicle.to_owned();
                    let state = state.to_owned();
                    let after = now - stop.asked;
                    stop.shown.insert(vehicle.clone(), is_sure);
                    news.push(StopNews::Done {
                        vehicle,
                        command: stop.command,
                        state,
                        after,
                    });
                }
                Some(was_sure) if stop.command.is_shown_by(state) => {
                    stop.shown.insert(vehicle.to_owned(), was_sure || is_sure);
                }
                // The earlier report, which showed the stop, was older than the stop.
                Some(false) if !stop.is_cancelled && now < stop.asked + DOUBTED => {
                    stop.shown.remove(vehicle);
                }
                _ => {}
            }
        }
        if is_change && news.is_empty() {
            news.push(StopNews::State {
                vehicle: vehicle.to_owned(),
                state: state.to_owned(),
            });
        }
        self.tell(news);
    }

    /// Records the sim's answer to a stop of all boats.
    pub(super) fn sim_answered(&mut self, now: Instant, number: u64, answer: Result<(), String>) {
        let Some(stop) = self.stops.iter_mut().find(|stop| stop.number == number) else {
            return;
        };
        let news = StopNews::Sim(answer.clone().map(|()| now - stop.asked));
        stop.sim = Some(answer);
        self.tell(vec![news]);
    }

    /// The stops to be sent now.
    pub(super) fn due(&mut self, now: Instant) -> Vec<Saying> {
        let mut sayings = Vec::new();
        let boats = &self.boats;
        let is_complete = self.is_complete;
        let limit = self.limit;
        for stop in &mut self.stops {
            if stop
                .next(boats, is_complete, limit)
                .is_none_or(|at| at > now)
            {
                continue;
            }
            stop.is_hurried = false;
            // Skip repeats missed during sleep.
            while stop.at(stop.said) <= now {
                stop.said += 1;
            }
            let is_open = |name: &&String| stop.is_open(name);
            sayings.push(Saying {
                number: stop.number,
                command: stop.command,
                is_of_fleet: stop.target.is_none(),
                to_everybody: stop.target.is_none() && now < stop.asked + TO_EVERYBODY,
                boats: stop.targets(boats).filter(is_open).cloned().collect(),
            });
        }
        self.tell_late(now);
        sayings
    }

    /// When the next repeat or report is due.
    pub(super) fn next(&self, now: Instant) -> Instant {
        let next = self
            .stops
            .iter()
            .filter_map(|stop| stop.next(&self.boats, self.is_complete, self.limit))
            .min();
        next.map_or(now + AGAIN, |at| at.min(now + AGAIN))
    }

    fn tell_late(&mut self, now: Instant) {
        let mut news = Vec::new();
        for stop in &mut self.stops {
            if !stop.is_late && now >= stop.asked + LATE {
                stop.is_late = true;
                let missing = stop
                    .targets(&self.boats)
                    .filter(|name| !stop.shown.contains_key(*name));
                let late = |name: &String| StopNews::Late {
                    vehicle: name.clone(),
                    command: stop.command,
                };
                news.extend(missing.map(late));
            }
        }
        for (name, boat) in &mut self.boats {
            if !boat.is_silent && boat.heard.is_some_and(|heard| now >= heard + SILENCE) {
                boat.is_silent = true;
                news.push(StopNews::Silent {
                    vehicle: name.clone(),
                });
            }
        }
        self.tell(news);
    }

    fn tell(&mut self, news: Vec<StopNews>) {
        self.news.extend(news);
        let surplus = self.news.len().saturating_sub(NEWS_MAX);
        self.news.drain(..surplus);
    }

    /// The latest stops that boats have not yet shown, as one string each. Empty if all stops are
    /// done.
    pub fn unfinished(&self) -> Vec<String> {
        let mut left = Vec::new();
        for stop in &self.stops {
            let missing = stop
                .targets(&self.boats)
                .filter(|name| !stop.shown.contains_key(*name));
            left.extend(missing.map(|name| {
                match self.boats.get(name).and_then(|boat| boat.state.as_ref()) {
                    Some(state) => format!("{name} does not report that it has stopped: {state}"),
                    None => format!("no report from {name}"),
                }
            }));
            // Without real boats, the sim answers for the boats that it simulates.
            if stop.target.is_none() && self.boats.is_empty() {
                left.extend(match &stop.sim {
                    Some(Ok(())) => None,
                    Some(Err(reason)) => Some(reason.clone()),
                    None => Some("the sim does not respond".to_owned()),
                });
            }
        }
        left
    }
}

impl Stop {
    /// The target boats.
    fn targets<'a>(
        &'a self,
        boats: &'a BTreeMap<String, KnownBoat>,
    ) -> Box<dyn Iterator<Item = &'a String> + 'a> {
        match &self.target {
            Some(target) => Box::new(std::iter::once(target)),
            None => Box::new(boats.keys()),
        }
    }

    fn is_open(&self, name: &str) -> bool {
        self.shown.get(name) != Some(&true)
    }

    /// When the stop is sent for the nth time.
    fn at(&self, n: usize) -> Instant {
        match SOON_MS.get(n) {
            Some(ms) => self.asked + Duration::from_millis(*ms),
            None => {
                self.asked
                    + Duration::from_millis(SOON_MS[SOON_MS.len() - 1])
                    + AGAIN * (n + 1 - SOON_MS.len()) as u32
            }
        }
    }

    /// When the stop is sent next, if at all.
    fn next(
        &self,
        boats: &BTreeMap<String, KnownBoat>,
        is_complete: bool,
        limit: Duration,
    ) -> Option<Instant> {
        let at = if self.is_hurried {
            self.asked
        } else {
            self.at(self.said)
        };
        let is_sure = self.targets(boats).all(|name| !self.is_open(name));
        let is_shown = self
            .targets(boats)
            .all(|name| self.shown.contains_key(name));
        let is_doubted = !is_sure && at < self.asked + DOUBTED;
        let is_done = match self.target {
            Some(_) => is_shown && !is_doubted,
            // Until a game names its boats, more may become known.
            None => is_shown && !is_doubted && (is_complete || at >= self.asked + TO_EVERYBODY),
        };
        let is_too_late = at.saturating_duration_since(self.asked) > limit;
        (!self.is_cancelled && !is_too_late && (self.said == 0 || !is_done)).then_some(at)
    }
}
