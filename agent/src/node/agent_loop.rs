//! The loop of an agent process: receives pictures, lets its minds decide, and sends orders and
//! messages to teammates.

use super::error::NodeError;
use super::helm_queries::HelmQueries;
use super::policy_inbox::PolicyInbox;
use super::settings::Settings;
use super::talk::Talk;
use crate::{MindRunner, minds_for};
use bus::game_search::Joined;
use bus::{Bus, Declaration, Delivery, Latest, Patience, Priority, Publisher, SimState, SimWatch};
use messages::refusal::{Refusal, Refusals};
use messages::topic::{self, GameName};
use messages::{GameInfo, Picture};
use primitives::codec::{self, DecodeError};
use primitives::{TeamId, VehicleId};
use scenario::Scenario;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Number of times, per team, that a game's first picture may arrive after later ones, as a resent
/// copy that the network delayed. More copies mean that the game was reset: it then repeats its
/// first picture until its agents have joined again.
const FIRST_PICTURES_LATE: usize = 2;
/// Interval at which an agent without incoming pictures checks whether the sim is alive.
const LOOK_AGAIN: Duration = Duration::from_millis(100);
/// In lockstep, teammates' messages arrive before the picture unless hubs on the way reorder them
/// or a link fails. The agent waits this long for them, once.
const MESSAGES_LATE: Duration = Duration::from_millis(500);
/// Maximum number of pictures per team queued while the minds decide.
const UNREAD_MAX: usize = 64;
/// Maximum number of events carried over from pictures without a decision.
const EVENTS_MAX: usize = 1024;

/// The minds and their connections during a game.
pub(super) struct AgentLoop {
    runner: MindRunner,
    /// Number of consecutive arrivals of a game's first picture after decisions on later ones.
    first_pictures: usize,
    talk: Talk,
    policies: PolicyInbox,
    /// Opened after joining: an agent that is waiting for a boat must not answer for the agent that
    /// currently has it.
    helm_queries: Option<HelmQueries>,
    orders: Publisher,
    /// The pictures of each team that the minds have not seen, oldest first.
    unread: Arc<Latest<Vec<Vec<u8>>>>,
    sim: SimWatch,
    /// The teams of this agent's boats, whose pictures it receives.
    teams: Vec<TeamId>,
    _declarations: Vec<Declaration>,
    ticket: u64,
    /// The newest picture, by team.
    pictures: Vec<Option<Picture>>,
    /// Counts of rejected pictures.
    refusals: Refusals,
}

impl AgentLoop {
    /// Creates minds, subscriptions and publishers before the sim depends on them.
    pub(super) fn open(
        bus: &Bus,
        game: &GameName,
        info: &GameInfo,
        settings: &Settings,
    ) -> Result<AgentLoop, NodeError> {
        let scenario = &info.scenario;
        // The sim rejects unknown names.
        let known = settings
            .vehicles
            .iter()
            .filter_map(|name| scenario.vehicle_by_name(name));
        let known: Vec<VehicleId> = known.collect();
        let runner = MindRunner::new(match &settings.minds {
            Some(minds) => minds(scenario, &known),
            None => minds_for(scenario, known, None),
        });
        // The sim waits `patience_s` before it drops an agent. Waiting for teammates takes at most
        // half of this, so that a late teammate cannot cost this agent the game.
        let half_patience = Duration::from_secs_f64(0.5 * scenario.patience_s);
        let is_lockstep = info.pace == "lockstep";
        let delivery = Delivery::per_decision(is_lockstep);
        let limit = |wait: Duration| {
            if is_lockstep {
                wait.min(half_patience)
            } else {
                Duration::ZERO
            }
        };
        let mut teams: Vec<TeamId> = runner
            .minds()
            .map(|(vehicle, _)| scenario.team_of(vehicle))
            .collect();
        teams.sort_unstable();
        teams.dedup();
        let unread = Arc::new(Latest::new(scenario.teams.len()));
        let subscribe = |team: &TeamId| {
            bus.subscribe(
                topic::picture(game, scenario, *team),
                keep(&unread, team.index()),
            )
        };
        let declarations = teams.iter().map(subscribe).collect::<Result<Vec<_>, _>>()?;
        let sim = SimWatch::open(bus, game, Patience::of_player(settings.silence))?;
        let orders = topic::orders(game, scenario, &teams, &bus.id());
        Ok(AgentLoop {
            talk: Talk::open(bus, game, scenario, &runner, limit(MESSAGES_LATE))?,
            policies: PolicyInbox::open(bus, game, scenario, &runner, limit(settings.policy_wait))?,
            helm_queries: None,
            orders: bus.publisher_with(orders, Priority::Normal, delivery)?,
            unread,
            sim,
            teams,
            _declarations: declarations,
            runner,
            first_pictures: 0,
            ticket: 0,
            pictures: vec![None; scenario.teams.len()],
            refusals: Refusals::default(),
        })
    }

    /// Joins with the boats and the ticket that the sim has granted.
    pub(super) fn join(
        &mut self,
        bus: &Bus,
        game: &GameName,
        scenario: &Scenario,
        joined: Joined,
    ) -> Result<(), NodeError> {
        // Orders name the vehicle: with boats other than those requested, the minds would steer
        // boats that they do not know.
        if !self
            .runner
            .minds()
            .map(|(vehicle, _)| vehicle)
            .eq(joined.vehicles)
        {
            return Err(NodeError::Refused(
                "the boats that it granted differ from those requested".to_owned(),
            ));
        }
        self.ticket = joined.ticket;
        self.helm_queries = Some(HelmQueries::open(bus, game, scenario, &self.runner)?);
        Ok(())
    }

    /// The boats whose programs had faults.
    pub(super) fn faults(&self) -> impl Iterator<Item = (VehicleId, String, u64)> {
        self.runner.faults()
    }

    /// The counts of messages rejected so far, and of expected messages that never arrived.
    pub(super) fn refusals(&self) -> Refusals {
        self.refusals + self.talk.refusals() + self.policies.refusals()
    }

    /// Decides until the game is over. Returns whether the game was reset and needs new minds.
    pub(super) fn play(&mut self, stop: &AtomicBool) -> Result<bool, NodeError> {
        while !stop.load(Ordering::Relaxed) {
            let mut decided = false;
            for (cell, unread) in self.unread.take(LOOK_AGAIN).into_iter().enumerate() {
                let Some(unread) = unread else { continue };
                self.sim.hears();
                unread.iter().try_for_each(|bytes| self.see(cell, bytes))?;
                if self.pictures[cell]
                    .as_ref()
                    .is_some_and(|picture| picture.over)
                {
                    return Ok(false);
                }
                if self.first_pictures > FIRST_PICTURES_LATE * self.teams.len() {
                    return Ok(true);
                }
                // Use only the newest picture: with a queue, a slow agent would work on outdated
                // ones. Events of skipped pictures carry over to the next one.
                decided |= self.decide()?;
            }
            if let Some(queries) = &mut self.helm_queries {
                // Answer queries after the orders have been sent: inspection slows down a lockstep
                // game but changes none of its decisions.
                queries.answer(&mut self.runner, decided);
            }
            match self.sim.state() {
                SimState::Alive => {}
                SimState::Replaced => return Err(NodeError::SimReplaced),
                SimState::Dead(silent) => return Err(NodeError::SimGone(silent)),
            }
        }
        Ok(false)
    }

    /// Receives a picture.
    fn see(&mut self, cell: usize, bytes: &[u8]) -> Result<(), NodeError> {
        let mut picture: Picture = match codec::decode(bytes) {
            Ok(picture) => picture,
            Err(e @ DecodeError::Version { .. }) => {
                return Err(NodeError::Version {
                    theirs: e.to_string(),
                });
            }
            // Corrupted in transit; the sim will send it again.
            Err(_) => return Ok(()),
        };
        if picture.stamp.seq == 0 && self.runner.decided() > Some(0) {
            self.first_pictures += 1;
            return Ok(());
        }
        self.first_pictures = 0;
        self.refusals
            .add(Refusal::BadNumber, picture.remove_bad_numbers());
        let before = self.pictures[cell].take();
        self.pictures[cell] = Some(with_missed_events(picture, before, self.runner.decided()));
        Ok(())
    }

    /// Decides once the pictures of all teams have the same tick. Answers a repeated tick with the
    /// same orders. Returns whether the minds have decided.
    fn decide(&mut self) -> Result<bool, NodeError> {
        let stamp_of = |team: &TeamId| {
            self.pictures[team.index()]
                .as_ref()
                .map(|picture| picture.stamp)
        };
        let Some(stamp) = self.teams.first().and_then(stamp_of) else {
            return Ok(false);
        };
        // Boats of several teams decide on the same tick: with pictures of different ticks, the
        // result would depend on the order of arrival.
        if self.teams.iter().any(|team| stamp_of(team) != Some(stamp)) {
            return Ok(false);
        }
        // The sim repeats unanswered pictures every 250 ms. The agent repeats the same orders,
        // because deciding again would change the minds' memory.
        let is_new = self.runner.decided() != Some(stamp.seq);
        if is_new {
            self.talk.hear(&mut self.runner, stamp.seq);
            self.policies.give(&mut self.runner, stamp);
            let pictures = &self.pictures;
            self.runner.decide(stamp, |vehicle| {
                pictures.iter().flatten().find(|p| p.own(vehicle).is_some())
            });
            self.talk.publish_words(self.runner.sent(), stamp);
        }
        // Send messages to teammates before orders: the sim advances once it has the orders, and by
        // then the messages are in transit.
        self.talk.send()?;
        if let Some(orders) = self.runner.answer(self.ticket) {
            self.orders.send(&orders)?;
        }
        Ok(is_new)
    }
}

/// A picture, with the events of the previous one added if that led to no decision. `decided` is
/// the number of the last decision. Each event is in only one picture.
fn with_missed_events(
    mut picture: Picture,
    before: Option<Picture>,
    decided: Option<u64>,
) -> Picture {
    let is_missed = |old: &Picture| {
        old.stamp.seq < picture.stamp.seq && decided.is_none_or(|decided| decided < old.stamp.seq)
    };
    if let Some(old) = before.filter(is_missed) {
        picture.events.splice(0..0, old.events);
        let surplus = picture.events.len().saturating_sub(EVENTS_MAX);
        picture.events.drain(..surplus);
    }
    picture
}

/// Adds pictures to the unread ones of a team.
fn keep(pictures: &Arc<Latest<Vec<Vec<u8>>>>, cell: usize) -> impl Fn(&[u8]) + use<> {
    let latest = Arc::clone(pictures);
    move |bytes| {
        latest.change(cell, |unread| {
            let mut unread: Vec<Vec<u8>> = unread.unwrap_or_default();
            unread.drain(..(unread.len() + 1).saturating_sub(UNREAD_MAX));
            unread.push(bytes.to_vec());
            unread
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use messages::{EventRecord, Stamp};
    use primitives::SimTime;
    use rules::event::{Event, Logged};

    /// A picture in which boat `seq` left the field.
    fn picture(seq: u64) -> Picture {
        let event = Event::LeftField(VehicleId(seq as u16));
        let events = vec![EventRecord::from(Logged {
            tick: seq,
            at: SimTime::ZERO,
            event,
        })];
        Picture {
            stamp: Stamp {
                seq,
                ..Stamp::default()
            },
            events,
            ..Picture::default()
        }
    }

    #[test]
    fn events_of_pictures_on_which_nobody_decided_come_with_the_next() {
        let subjects = |picture: &Picture| {
            picture
                .events
                .iter()
                .map(|event| event.subject)
                .collect::<Vec<_>>()
        };
        let late = with_missed_events(picture(4), Some(picture(3)), Some(2));
        assert_eq!(subjects(&late), [3, 4]);
        let later = with_missed_events(picture(5), Some(late.clone()), Some(2));
        assert_eq!(subjects(&later), [3, 4, 5]);
        assert_eq!(
            subjects(&with_missed_events(picture(5), Some(late.clone()), Some(4))),
            [5],
            "there was a decision on it"
        );
        assert_eq!(
            subjects(&with_missed_events(picture(4), Some(late), None)),
            [4],
            "the same picture again"
        );
        let many = (0..3000).fold(picture(0), |last, seq| {
            with_missed_events(picture(seq + 1), Some(last), None)
        });
        assert_eq!(
            (
                many.events.len(),
                many.events.last().map(|event| event.subject)
            ),
            (EVENTS_MAX, Some(3000))
        );
    }
}
