//! The stops that were asked for, and what boats have reported since: which are to be said again, and which are done.
//! No socket and no clock in here.

#[cfg(test)]
mod tests;

use super::StopCommand;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::time::{Duration, Instant};

/// When a stop is said again, ms after it was asked for: one that is lost costs little, and repeats let TCP find out at once.
const SOON_MS: [u64; 6] = [0, 10, 20, 40, 80, 160];
/// From then on it is said this often.
const AGAIN: Duration = Duration::from_millis(200);
/// A status that was published may be older than the stop. For so long the stop is said although one shows it, and one of a boat that
/// is not known to have been in another state does not count.
const DOUBTED: Duration = Duration::from_secs(1);
/// How far the clock of a gateway may fall behind from one status to the next.
const DRIFT: Duration = Duration::from_micros(100);
/// A gateway that seems to have begun so much later was started again.
const RESTARTED: Duration = Duration::from_secs(10);
/// A stop of all boats is said to everybody for so long; after that only to those that do not show it.
const TO_EVERYBODY: Duration = Duration::from_secs(2);
/// A boat that does not show a stop is reported as late after this long.
const LATE: Duration = Duration::from_secs(2);
/// A boat of which nothing was heard for so long is silent.
const SILENCE: Duration = Duration::from_secs(3);
/// The sim's copies count for a boat that has not been heard directly for this long.
const RELAYED_AFTER: Duration = Duration::from_secs(1);
/// News that nobody has read; the oldest go first.
const NEWS_MAX: usize = 1024;

/// What is known of a boat.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownBoat {
    /// Its state in words, if it was heard.
    pub state: Option<String>,
    /// When it was heard last.
    pub heard: Option<Instant>,
    /// When it was last heard directly, not by a copy from the sim.
    heard_itself: Option<Instant>,
    /// When its gateway began, by the status that took the least time to come.
    began: Option<Instant>,
    is_silent: bool,
}

impl KnownBoat {
    /// Whether nothing was heard of it for some time.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.is_silent
    }
}

/// What an operator wants to know.
#[derive(Clone, Debug, PartialEq)]
pub enum StopNews {
    /// A boat's own status shows a stop for the first time.
    Done {
        /// The boat.
        vehicle: String,
        /// The stop.
        command: StopCommand,
        /// The state in words.
        state: String,
        /// Since it was asked for.
        after: Duration,
    },
    /// A boat does not show a stop yet, and it has been some time.
    Late {
        /// The boat.
        vehicle: String,
        /// The stop.
        command: StopCommand,
    },
    /// The sim has answered to a stop of all boats, or has not, for this reason.
    Sim(Result<Duration, String>),
    /// A boat is in another state than before.
    State {
        /// The boat.
        vehicle: String,
        /// The state in words.
        state: String,
    },
    /// Nothing was heard of a boat for some time.
    Silent {
        /// The boat.
        vehicle: String,
    },
}

/// How a report of a boat relates to a stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// It is the answer to this stop.
    Answer(u64),
    /// It says how the boat was, not before this moment: it may be older than a stop that was asked for meanwhile.
    Published(Instant),
    /// A copy from the sim, which received the original no earlier than this.
    Relayed(Instant),
}

/// A stop that was asked for.
#[derive(Clone, Debug)]
struct Stop {
    number: u64,
    /// The boat; none is all of them.
    target: Option<String>,
    command: StopCommand,
    asked: Instant,
    /// How often it was said.
    said: usize,
    /// Boats that show it: whether that was an answer to it.
    shown: BTreeMap<String, bool>,
    /// Boats that were in another state then, or since.
    others: BTreeSet<String>,
    /// What the sim says to a stop of all.
    sim: Option<Result<(), String>>,
    is_late: bool,
    /// Whether it is to be said at once, since there is another path.
    is_hurried: bool,
    /// Something was asked for since that makes an end of it.
    is_cancelled: bool,
}

/// A stop to be said now.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Saying {
    pub(super) number: u64,
    pub(super) command: StopCommand,
    /// Whether it is for all boats, and is still said to everybody.
    pub(super) is_of_fleet: bool,
    pub(super) to_everybody: bool,
    /// The boats that do not show it for certain.
    pub(super) boats: Vec<String>,
}

/// All of them.
pub struct StopOrders {
    /// For how long a stop is said that no boat shows.
    limit: Duration,
    boats: BTreeMap<String, KnownBoat>,
    /// Whether all boats are known: a game has named them.
    is_complete: bool,
    stops: Vec<Stop>,
    count: u64,
    changes: u64,
    news: VecDeque<StopNews>,
}

impl StopOrders {
    /// None yet. One that is not shown is said again for so long.
    pub(super) fn new(limit: Duration) -> StopOrders {
        let (boats, stops, news) = (BTreeMap::new(), Vec::new(), VecDeque::new());
        StopOrders { limit, boats, is_complete: false, stops, count: 0, changes: 0, news }
    }

    /// Whether a boat has shown the last stop of this kind that was asked of it alone.
    #[must_use]
    pub fn is_shown(&self, vehicle: &str, command: StopCommand) -> bool {
        let is_it = |stop: &&Stop| stop.command == command && stop.target.as_deref() == Some(vehicle);
        self.stops.iter().find(is_it).is_some_and(|stop| stop.shown.contains_key(vehicle))
    }

    /// The boats that are known.
    pub fn boats(&self) -> impl Iterator<Item = (&String, &KnownBoat)> {
        self.boats.iter()
    }

    /// Whether every stop is done, without doubt; a stop of all cannot be before a game has named its boats.
    #[must_use]
    pub fn is_done(&self, now: Instant) -> bool {
        let is_for_all = self.stops.iter().any(|stop| stop.target.is_none());
        let is_sure = |stop: &Stop| now >= stop.asked + DOUBTED || stop.shown.values().all(|is_sure| *is_sure);
        (self.is_complete || !is_for_all) && self.unfinished().is_empty() && self.stops.iter().all(is_sure)
    }

    /// Whether there are news.
    #[must_use]
    pub fn has_news(&self) -> bool {
        !self.news.is_empty()
    }

    /// The news since this was called last.
    pub fn take_news(&mut self) -> Vec<StopNews> {
        self.news.drain(..).collect()
    }

    /// A boat has to be stopped with all the others, whether it is heard or not.
    pub(super) fn expect(&mut self, vehicle: &str) {
        let unheard = KnownBoat { state: None, heard: None, heard_itself: None, began: None, is_silent: false };
        self.boats.entry(vehicle.to_owned()).or_insert(unheard);
    }

    /// It turns out to be another one, or none.
    pub(super) fn forget(&mut self, vehicle: &str) {
        self.boats.remove(vehicle);
    }

    /// All boats of the game are expected now, or there is none: nobody will name others.
    pub fn complete(&mut self) {
        self.is_complete = true;
    }

    /// A stop is asked for; it takes the place of an earlier one like it.
    pub(super) fn ask(&mut self, now: Instant, target: Option<String>, command: StopCommand) -> u64 {
        // Somebody who presses the button again wants to see it done again, not that it was
        // done before.
        self.stops.retain(|stop| (&stop.target, stop.command) != (&target, command));
        self.count += 1;
        let is_other = |boat: &KnownBoat| boat.state.as_ref().is_some_and(|state| !command.is_shown_by(state));
        let others = self.boats.iter().filter(|(_, boat)| is_other(boat)).map(|(name, _)| name.clone()).collect();
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

    /// Whether a stop was asked for not longer ago than this.
    pub(super) fn is_asked_within(&self, now: Instant, time: Duration) -> bool {
        self.stops.iter().any(|stop| now < stop.asked + time)
    }

    /// There is another path: what is not done is said at once.
    pub(super) fn hurry(&mut self) {
        self.stops.iter_mut().for_each(|stop| stop.is_hurried = true);
        self.changes += 1;
    }

    /// How often somebody has asked for something, or there was another path.
    pub(super) fn changes(&self) -> u64 {
        self.changes
    }

    /// The stops of all boats that no sim has answered.
    pub(super) fn unanswered(&self) -> Vec<u64> {
        let stops = self.stops.iter().filter(|stop| stop.target.is_none() && stop.command == StopCommand::EStop);
        stops.filter(|stop| !stop.is_cancelled && stop.sim.is_none()).map(|stop| stop.number).collect()
    }

    /// Something else is asked of a boat, or of all: earlier stops are not said any more.
    pub fn cancel(&mut self, target: Option<&str>) {
        let is_meant = |stop: &Stop| target.is_none() || stop.target.is_none() || stop.target.as_deref() == target;
        self.stops.iter_mut().filter(|stop| is_meant(stop)).for_each(|stop| stop.is_cancelled = true);
    }

    /// Not before when a status was true that comes now; `at_s` is its time since the gateway began, s.
    pub(super) fn as_of(&mut self, now: Instant, vehicle: &str, at_s: f64) -> Instant {
        let at = Duration::try_from_secs_f64(at_s).ok();
        let (Some(boat), Some(at)) = (self.boats.get_mut(vehicle), at) else { return now };
        let Some(began) = now.checked_sub(at) else { return now };
        // The clocks may drift apart; a gateway that was started again began later.
        // The earliest beginning that any status implies is that of the one which took the
        // least time to come; all later ones are judged by it.
        let known = boat.began.map(|known| known + DRIFT).filter(|known| began < *known + RESTARTED);
        let began = known.map_or(began, |known| known.min(began));
        boat.began = Some(began);
        began + at
    }

    /// A boat reports its state.
    pub(super) fn report(&mut self, now: Instant, vehicle: &str, state: &str, source: Source) {
        self.expect(vehicle);
        let Some(boat) = self.boats.get_mut(vehicle) else { return };
        let relayed = if let Source::Relayed(as_of) = source { Some(as_of) } else { None };
        if relayed.is_none() {
            boat.heard_itself = Some(now);
        }
        // The boat's own report is newer than the sim's copy.
        let is_news = relayed.is_none() || boat.heard_itself.is_none_or(|heard| now >= heard + RELAYED_AFTER);
        let is_change = is_news && (boat.state.as_deref() != Some(state) || boat.is_silent);
        if is_news {
            (boat.state, boat.heard, boat.is_silent) = (Some(state.to_owned()), Some(now), false);
        }
        let mut news = Vec::new();
        for stop in self.stops.iter_mut().filter(|stop| stop.target.as_deref().is_none_or(|target| target == vehicle)) {
            // A status on its way may be older than the stop: only what is an answer to it, or
            // was certainly received after it, proves something.
            let is_sure = source == Source::Answer(stop.number) || relayed.is_some_and(|as_of| as_of > stop.asked);
            // A packet that was lost holds up statuses for longer than a stop takes.
            if matches!(source, Source::Published(as_of) if as_of < stop.asked) && now < stop.asked + DOUBTED {
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
                    let (vehicle, state, after) = (vehicle.to_owned(), state.to_owned(), now - stop.asked);
                    stop.shown.insert(vehicle.clone(), is_sure);
                    news.push(StopNews::Done { vehicle, command: stop.command, state, after });
                }
                Some(was_sure) if stop.command.is_shown_by(state) => {
                    stop.shown.insert(vehicle.to_owned(), was_sure || is_sure);
                }
                // What showed it was older than the stop.
                Some(false) if !stop.is_cancelled && now < stop.asked + DOUBTED => drop(stop.shown.remove(vehicle)),
                _ => {}
            }
        }
        if is_change && news.is_empty() {
            news.push(StopNews::State { vehicle: vehicle.to_owned(), state: state.to_owned() });
        }
        self.tell(news);
    }

    /// What the sim says to a stop of all boats.
    pub(super) fn sim_answered(&mut self, now: Instant, number: u64, answer: Result<(), String>) {
        let Some(stop) = self.stops.iter_mut().find(|stop| stop.number == number) else { return };
        let news = StopNews::Sim(answer.clone().map(|()| now - stop.asked));
        stop.sim = Some(answer);
        self.tell(vec![news]);
    }

    /// What is to be said now.
    pub(super) fn due(&mut self, now: Instant) -> Vec<Saying> {
        let mut sayings = Vec::new();
        let (boats, is_complete, limit) = (&self.boats, self.is_complete, self.limit);
        for stop in &mut self.stops {
            if stop.next(boats, is_complete, limit).is_none_or(|at| at > now) {
                continue;
            }
            stop.is_hurried = false;
            // What was slept through is not made up for.
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

    /// When there is something to be said again, or to be told.
    pub(super) fn next(&self, now: Instant) -> Instant {
        let next = self.stops.iter().filter_map(|stop| stop.next(&self.boats, self.is_complete, self.limit)).min();
        next.map_or(now + AGAIN, |at| at.min(now + AGAIN))
    }

    fn tell_late(&mut self, now: Instant) {
        let mut news = Vec::new();
        for stop in &mut self.stops {
            if !stop.is_late && now >= stop.asked + LATE {
                stop.is_late = true;
                let missing = stop.targets(&self.boats).filter(|name| !stop.shown.contains_key(*name));
                let late = |name: &String| StopNews::Late { vehicle: name.clone(), command: stop.command };
                news.extend(missing.map(late));
            }
        }
        for (name, boat) in &mut self.boats {
            if !boat.is_silent && boat.heard.is_some_and(|heard| now >= heard + SILENCE) {
                boat.is_silent = true;
                news.push(StopNews::Silent { vehicle: name.clone() });
            }
        }
        self.tell(news);
    }

    fn tell(&mut self, news: Vec<StopNews>) {
        self.news.extend(news);
        let surplus = self.news.len().saturating_sub(NEWS_MAX);
        self.news.drain(..surplus);
    }

    /// What no boat has shown yet of what was asked of it last: in words, one each. Nothing is left where all stops are done.
    #[must_use]
    pub fn unfinished(&self) -> Vec<String> {
        let mut left = Vec::new();
        for stop in &self.stops {
            let missing = stop.targets(&self.boats).filter(|name| !stop.shown.contains_key(*name));
            left.extend(missing.map(|name| match self.boats.get(name).and_then(|boat| boat.state.as_ref()) {
                Some(state) => format!("{name} does not report that it has stopped: {state}"),
                None => format!("nothing is heard of {name}"),
            }));
            // Where there is no real boat, the sim answers for those that it simulates.
            if stop.target.is_none() && self.boats.is_empty() {
                left.extend(match &stop.sim {
                    Some(Ok(())) => None,
                    Some(Err(reason)) => Some(reason.clone()),
                    None => Some("the sim does not answer".to_owned()),
                });
            }
        }
        left
    }
}

impl Stop {
    /// The boats that it is for.
    fn targets<'a>(&'a self, boats: &'a BTreeMap<String, KnownBoat>) -> Box<dyn Iterator<Item = &'a String> + 'a> {
        match &self.target {
            Some(target) => Box::new(std::iter::once(target)),
            None => Box::new(boats.keys()),
        }
    }

    fn is_open(&self, name: &str) -> bool {
        self.shown.get(name) != Some(&true)
    }

    /// When it is said for the nth time.
    fn at(&self, n: usize) -> Instant {
        match SOON_MS.get(n) {
            Some(ms) => self.asked + Duration::from_millis(*ms),
            None => {
                self.asked + Duration::from_millis(SOON_MS[SOON_MS.len() - 1]) + AGAIN * (n + 1 - SOON_MS.len()) as u32
            }
        }
    }

    /// When it is said next, if it is.
    fn next(&self, boats: &BTreeMap<String, KnownBoat>, is_complete: bool, limit: Duration) -> Option<Instant> {
        let at = if self.is_hurried { self.asked } else { self.at(self.said) };
        let is_sure = self.targets(boats).all(|name| !self.is_open(name));
        let is_shown = self.targets(boats).all(|name| self.shown.contains_key(name));
        let is_doubted = !is_sure && at < self.asked + DOUBTED;
        let is_done = match self.target {
            Some(_) => is_shown && !is_doubted,
            // Until a game says which boats there are, others may come to be known.
            None => is_shown && !is_doubted && (is_complete || at >= self.asked + TO_EVERYBODY),
        };
        let is_too_late = at.saturating_duration_since(self.asked) > limit;
        (!self.is_cancelled && !is_too_late && (self.said == 0 || !is_done)).then_some(at)
    }
}
