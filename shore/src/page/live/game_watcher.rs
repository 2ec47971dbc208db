//! The keeper: finds the game, hears what is published in it, passes on what pages want, and finds it again.

use super::live_state::Play;
use super::query_thread::QueryThread;
use super::{Command, Place, SharedState};
use crate::page::clock;
use bus::game_search::{self, Missing};
use bus::{Bus, BusError, Declaration, Delivery, Patience, Publisher, SimState, SimWatch, Watched};
use game::codec;
use game::external::GatewayStatus;
use game::message::{Frame, Message, PolicyProposal, Stamp};
use game::picture::Picture;
use game::run_state::RunState;
use game::scenario::Source;
use game::topic::{self, GameName};
use game::water::Water;
use game::{TeamId, VehicleId};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::mpsc::Receiver;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// How often to look again for a game that is not there.
const LOOK_AGAIN: Duration = Duration::from_millis(250);
/// How often to see to what changes by itself.
const ROUND: Duration = Duration::from_millis(50);
/// After so many attempts the session may be what is wrong.
const ATTEMPTS: u64 = 20;
/// How long to wait for an answer.
const ANSWER: Duration = Duration::from_secs(2);
/// How long a sim's token may take to appear, and to come back: a sim is not gone because its link was cut for a moment.
const PATIENCE: Patience = Patience { silence: Duration::from_secs(5), missing: Duration::from_secs(1) };
/// Estimates are looked at no more often than this, however fast the game is.
const PICTURE_AGAIN: Duration = Duration::from_millis(50);

/// Keeps the show going.
pub(super) struct GameWatcher {
    shared: Arc<SharedState>,
    place: Place,
    game: Option<GameName>,
    commands: Receiver<Command>,
    tell: Box<dyn Fn(&str) + Send>,
}

/// A session in a game.
struct Visit {
    bus: Bus,
    play: Arc<Play>,
    control: Publisher,
    policies: BTreeMap<VehicleId, Publisher>,
    pictures: BTreeMap<TeamId, Declaration>,
    sim: SimWatch,
    _standing: Vec<Declaration>,
}

impl GameWatcher {
    pub(super) fn new(
        shared: Arc<SharedState>,
        place: Place,
        game: Option<GameName>,
        commands: Receiver<Command>,
        tell: Box<dyn Fn(&str) + Send>,
    ) -> GameWatcher {
        GameWatcher { shared, place, game, commands, tell }
    }

    /// Shows one game after the other until the show closes.
    pub(super) fn keep(self) {
        let mut bus = None;
        let (mut said, mut attempts) = (String::new(), 0_u64);
        while !self.shared.is_closing() {
            // What was wanted of a game that is gone is not wanted of the next.
            while self.commands.try_recv().is_ok() {}
            match self.come(&mut bus) {
                Ok(visit) => {
                    said.clear();
                    self.stay(visit);
                    bus = None;
                }
                Err(missing) => {
                    let reason = in_words(missing);
                    if reason != said {
                        (self.tell)(&reason);
                        said = reason;
                    }
                    attempts += 1;
                    if attempts % ATTEMPTS == 0 {
                        bus = None;
                    }
                    Self::rest(LOOK_AGAIN);
                }
            }
        }
    }

    /// Waits a while, for nothing.
    fn rest(time: Duration) {
        Watched::new(()).wait(time, |()| false);
    }

    /// Comes to a game, if there is one. The session stays open for the next attempt.
    fn come(&self, bus: &mut Option<Bus>) -> Result<Visit, Missing> {
        let bus = match bus {
            Some(bus) => bus.clone(),
            None => bus.insert(Bus::leaf(&(self.place)().map_err(Missing::Yet)?)?).clone(),
        };
        let name = match &self.game {
            Some(name) => name.clone(),
            None => game_search::only_game(&bus)?,
        };
        let notice = game_search::game_info(&bus, &name)?;
        // An older sim does not answer; then the water is drawn flat.
        let water = bus.ask(&topic::water(&name), Vec::new(), ANSWER)?;
        let water: Water = water.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
        Ok(Visit::begin(&self.shared, bus, Play::new(name, notice, &water))?)
    }

    /// Stays until the game is gone.
    fn stay(&self, mut visit: Visit) {
        let left = Watched::new(false);
        let asker = QueryThread::new(&self.shared, visit.bus.clone(), Arc::clone(&visit.play));
        std::thread::scope(|scope| {
            scope.spawn(|| asker.ask(&left));
            while !self.shared.is_closing() && visit.sim.state_by_token() == SimState::Alive {
                if let Ok(command) = self.commands.recv_timeout(ROUND) {
                    visit.send(command);
                }
                visit.steer(&self.shared);
                visit.see_to_wheels(&self.shared);
                visit.see_to_pictures(&self.shared);
            }
            self.shared.stage().end();
            self.shared.news.ring();
            left.visit(|left| *left = true);
        });
        visit.bus.close();
    }
}

/// What is missing, in words. What will never be there may yet be replaced by something else.
fn in_words(missing: Missing) -> String {
    match missing {
        Missing::Yet(reason) => reason,
        Missing::Forever(refusal) => refusal.to_string(),
    }
}

impl Visit {
    /// Puts the game on the stage and listens to it.
    fn begin(shared: &Arc<SharedState>, bus: Bus, play: Play) -> Result<Visit, BusError> {
        let play = Arc::new(play);
        let sim = SimWatch::open(&bus, &play.name, PATIENCE)?;
        let control = bus.publisher(topic::control(&play.name), Delivery::Wait)?;
        let generation = {
            let mut stage = shared.stage();
            stage.begin(Arc::clone(&play));
            stage.generation
        };
        shared.news.ring();
        let ear = Ear { shared: Arc::clone(shared), generation };
        let mut standing = vec![ear.clone().frames(&bus, &play)?, ear.clone().run(&bus, &play)?];
        for (i, vehicle) in play.scenario().vehicles.iter().enumerate() {
            if vehicle.source == Source::External {
                standing.push(ear.clone().status(&bus, &play, VehicleId::at(i))?);
            }
        }
        let (policies, pictures) = (BTreeMap::new(), BTreeMap::new());
        Ok(Visit { bus, play, control, policies, pictures, sim, _standing: standing })
    }

    /// Passes on what a page wants. What cannot be sent now is lost with the session, which is looked at anew.
    fn send(&self, command: Command) {
        match command {
            Command::Control(control) => {
                let json = serde_json::to_vec(&control).unwrap_or_default();
                drop(self.control.send_json(json));
            }
            // It is seen to in every round; this only begins one.
            Command::Steer => {}
        }
    }

    /// Tells steered boats where to go, as of the newest frame.
    fn steer(&mut self, shared: &SharedState) {
        let (steering, stamp) = {
            let mut stage = shared.stage();
            (std::mem::take(&mut stage.steering), stage.roll.stamp)
        };
        let stamp = Stamp { version: PolicyProposal::VERSION, ..stamp };
        for (vehicle, (course_rad, speed_m_s)) in steering {
            if !self.policies.contains_key(&vehicle) {
                let key = topic::policy(&self.play.name, self.play.scenario(), vehicle);
                let Ok(publisher) = self.bus.publisher(key, Delivery::Drop) else { continue };
                self.policies.insert(vehicle, publisher);
            }
            if let Some(publisher) = self.policies.get(&vehicle) {
                drop(publisher.send(&PolicyProposal { stamp, vehicle, course_rad, speed_m_s }));
            }
        }
    }

    /// Frees the wheels of silent pages.
    fn see_to_wheels(&self, shared: &SharedState) {
        if shared.stage().wheels.expire(clock::now()) {
            shared.news.ring();
        }
    }

    /// Listens to the pictures of the teams whose boats somebody looks at, and no others.
    fn see_to_pictures(&mut self, shared: &Arc<SharedState>) {
        let (wanted, generation) = {
            let mut stage = shared.stage();
            stage.forget_unwanted();
            (stage.wanted(), stage.generation)
        };
        let teams: BTreeSet<TeamId> = wanted.keys().map(|vehicle| self.play.scenario().team_of(*vehicle)).collect();
        self.pictures.retain(|team, _| teams.contains(team));
        for team in teams {
            if self.pictures.contains_key(&team) {
                continue;
            }
            let ear = Ear { shared: Arc::clone(shared), generation };
            if let Ok(standing) = ear.pictures(&self.bus, &self.play, team) {
                self.pictures.insert(team, standing);
            }
        }
    }
}

/// Hears what is published in one game.
#[derive(Clone)]
struct Ear {
    shared: Arc<SharedState>,
    generation: u64,
}

impl Ear {
    /// Changes the stage, if it is still that of this game.
    fn note(&self, change: impl FnOnce(&mut super::live_state::LiveState)) {
        let mut stage = self.shared.stage();
        if stage.generation == self.generation {
            change(&mut stage);
            drop(stage);
            self.shared.news.ring();
        }
    }

    fn frames(self, bus: &Bus, play: &Play) -> Result<Declaration, BusError> {
        bus.subscribe(topic::frame(&play.name), move |bytes| {
            if let Ok(frame) = codec::decode::<Frame>(bytes) {
                self.note(|stage| stage.take_frame(&frame, bytes, clock::now()));
            }
        })
    }

    fn run(self, bus: &Bus, play: &Play) -> Result<Declaration, BusError> {
        bus.subscribe(topic::run(&play.name), move |bytes| {
            if let Ok(run) = serde_json::from_slice::<RunState>(bytes) {
                self.note(|stage| stage.take_run(run));
            }
        })
    }

    fn status(self, bus: &Bus, play: &Play, vehicle: VehicleId) -> Result<Declaration, BusError> {
        let name = play.name_of(vehicle).to_owned();
        bus.subscribe(topic::status(&play.name, &name), move |bytes| {
            let status = serde_json::from_slice::<GatewayStatus>(bytes).ok();
            if let Some(status) = status.filter(|status| status.vehicle == name) {
                self.note(|stage| stage.take_status(vehicle, status));
            }
        })
    }

    fn pictures(self, bus: &Bus, play: &Play, team: TeamId) -> Result<Declaration, BusError> {
        let taken: Mutex<Option<Instant>> = Mutex::new(None);
        bus.subscribe(topic::picture(&play.name, play.scenario(), team), move |bytes| {
            let mut taken = taken.lock().unwrap_or_else(PoisonError::into_inner);
            let now = clock::now();
            if taken.is_some_and(|before| now.saturating_duration_since(before) < PICTURE_AGAIN) {
                return;
            }
            if let Ok(picture) = codec::decode::<Picture>(bytes) {
                *taken = Some(now);
                self.note(|stage| stage.take_picture(&picture));
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use game::message::Control;
    use std::sync::atomic::Ordering;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn what_was_asked_of_one_game_is_forgotten_before_the_next_is_looked_for() {
        let (commands, to_do) = sync_channel(1);
        let shared = Arc::new(SharedState::new(commands.clone()));
        commands.send(Command::Control(Control::Stop)).unwrap();
        let (found, finds) = sync_channel(1);
        let searched = Arc::clone(&shared);
        let place = move || {
            // There is room for one command only, and so for none if the one before is still there.
            found.send(commands.try_send(Command::Steer).is_ok()).unwrap();
            searched.is_closing.store(true, Ordering::Relaxed);
            Err("there is no network".to_owned())
        };
        GameWatcher::new(shared, Box::new(place), None, to_do, Box::new(|_| ())).keep();
        assert!(finds.recv().unwrap());
    }
}
