//! Finds the game, subscribes to its topics and publishes commands from pages. Searches again when
//! the game has disappeared.

use super::live_state::LiveGame;
use super::query_thread::QueryThread;
use super::{Command, SharedState};
use bus::clock;
use bus::game_search::{self, Missing};
use bus::{
    ANSWER, Bus, BusError, Declaration, Delivery, Inbox, NodeThread, Patience, Place,
    PlacedSession, Priority, Publisher, SimState, SimWatch, Watched, inbox,
};
use messages::picture::Picture;
use messages::run_state::RunState;
use messages::topic::{self, GameName};
use messages::water::Water;
use messages::{Control, Frame, Message, PolicyProposal, Stamp};
use parking_lot::Mutex;
use primitives::{TeamId, VehicleId, codec};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Interval between searches for a missing game.
const LOOK_AGAIN: Duration = Duration::from_millis(250);
/// Interval between checks for timeouts.
const ROUND: Duration = Duration::from_millis(50);
/// Number of failed attempts after which the session is reopened, because it may be the cause.
const ATTEMPTS: u64 = 20;
/// Maximum number of queued requests to the sim.
const REQUESTS: usize = 16;
/// How long a sim's token may be missing, initially or after a link failure: a short interruption
/// does not mean that the sim has gone.
const PATIENCE: Patience = Patience {
    silence: Duration::from_secs(5),
    missing: Duration::from_secs(1),
    unheard: Duration::from_secs(1),
};
/// Minimum interval between estimates, at any game speed.
const PICTURE_AGAIN: Duration = Duration::from_millis(50);

/// Watches for the game in its own thread.
pub(super) struct GameWatcher {
    pub(super) shared: Arc<SharedState>,
    pub(super) place: Place,
    pub(super) game: Option<GameName>,
    pub(super) commands: Inbox<Command>,
}

struct GameSession {
    bus: Bus,
    game: Arc<LiveGame>,
    policies: BTreeMap<VehicleId, Publisher>,
    pictures: BTreeMap<TeamId, Declaration>,
    sim: SimWatch,
    _standing: Vec<Declaration>,
}

impl GameWatcher {
    /// Shows one game after another until the view closes.
    pub(super) fn run(self) {
        let mut session = None;
        let mut said = String::new();
        let mut attempts = 0_u64;
        while !self.shared.is_closing() {
            // Commands to a game that has ended must not reach the next one.
            while self.commands.take_now().is_some() {}
            match self.find(&mut session) {
                Ok(found) => {
                    said.clear();
                    self.run_until_gone(found);
                    session = None;
                }
                Err(missing) => {
                    // Even a permanent refusal may end, when a different game takes this one's
                    // place.
                    let reason = missing.to_string();
                    if reason != said {
                        (self.shared.tell)(&format!("no game to show: {reason}"));
                        self.shared.state.lock().missing.clone_from(&reason);
                        self.shared.news.send_replace(());
                        said = reason;
                    }
                    attempts += 1;
                    if attempts.is_multiple_of(ATTEMPTS) {
                        session = None;
                    }
                    clock::rest(LOOK_AGAIN);
                }
            }
        }
    }

    /// Connects to a game, if any. The session stays open for the next attempt.
    fn find(&self, session: &mut PlacedSession) -> Result<GameSession, Missing> {
        let (bus, name, info) = game_search::find_game(&self.place, self.game.as_ref(), session)?;
        // Older sims do not reply; then the water is drawn flat.
        let water = bus.ask(&topic::water(&name), Vec::new(), ANSWER)?;
        let water: Water = water
            .and_then(|bytes| serde_json::from_slice(&bytes).ok())
            .unwrap_or_default();
        Ok(GameSession::begin(
            &self.shared,
            bus,
            LiveGame::new(name, info, &water),
        )?)
    }

    fn run_until_gone(&self, mut session: GameSession) {
        let left = Arc::new(Watched::new(false));
        let queries = QueryThread {
            shared: Arc::clone(&self.shared),
            bus: session.bus.clone(),
            game: Arc::clone(&session.game),
        };
        let until = Arc::clone(&left);
        // The game is shown even without these threads.
        let no_thread = |e: &std::io::Error| {
            (self.shared.tell)(&format!(
                "cannot start a thread for queries to the game: {e}"
            ))
        };
        let query_thread = NodeThread::start(move || queries.ask(&until)).inspect_err(no_thread);
        let (requests, requested) = inbox(REQUESTS);
        let shared = Arc::clone(&self.shared);
        let bus = session.bus.clone();
        let game = session.game.name.clone();
        let until = Arc::clone(&left);
        // The sim may reply slowly, and a stop must not wait for its reply.
        let request_thread =
            NodeThread::start(move || request(&shared, &bus, &game, (&requested, &until)))
                .inspect_err(no_thread);
        while !self.shared.is_closing() && session.sim.state() == SimState::Alive {
            // Every round handles steering; the command only starts a round.
            if let Some(Command::Control(control)) = self.commands.take(ROUND) {
                // Requests beyond the queue are dropped; the page has to repeat them.
                requests.put(control);
            }
            session.steer(&self.shared);
            session.expire_steering(&self.shared);
            session.update_picture_subscriptions(&self.shared);
        }
        self.shared.state.lock().end();
        self.shared.stops.leave();
        self.shared.news.send_replace(());
        left.visit(|left| *left = true);
        drop((query_thread, request_thread));
        session.bus.close();
    }
}

/// Sends requests that the sim may refuse, until the game is left.
fn request(
    shared: &SharedState,
    bus: &Bus,
    game: &GameName,
    (requested, left): (&Inbox<Control>, &Watched<bool>),
) {
    while !left.visit(|left| *left) {
        let Some(control) = requested.take(ROUND) else {
            continue;
        };
        if let Err(error) = bus::control(bus, game, control) {
            (shared.tell)(&format!("{control:?} from the page failed: {error}"));
        }
    }
}

impl GameSession {
    /// Stores the game in the state and subscribes to it.
    fn begin(shared: &Arc<SharedState>, bus: Bus, game: LiveGame) -> Result<GameSession, BusError> {
        let game = Arc::new(game);
        let sim = SimWatch::open(&bus, &game.name, PATIENCE)?;
        let generation = {
            let mut state = shared.state.lock();
            state.begin(Arc::clone(&game));
            state.bus = Some(bus.clone());
            state.generation
        };
        shared.news.send_replace(());
        let boats: Vec<String> = game
            .scenario()
            .externals()
            .map(|boat| game.name_of(boat).to_owned())
            .collect();
        shared.stops.join(&bus, &game.name, &boats)?;
        let subscriptions = Subscriptions {
            shared: Arc::clone(shared),
            generation,
        };
        let mut standing = vec![
            subscriptions.clone().frames(&bus, &game)?,
            subscriptions.clone().run(&bus, &game)?,
        ];
        for vehicle in game.scenario().externals() {
            standing.push(subscriptions.clone().status(&bus, &game, vehicle)?);
        }
        let policies = BTreeMap::new();
        let pictures = BTreeMap::new();
        Ok(GameSession {
            bus,
            game,
            policies,
            pictures,
            sim,
            _standing: standing,
        })
    }

    /// Publishes set-points for steered boats, stamped with the newest frame.
    fn steer(&mut self, shared: &SharedState) {
        let (steering, stamp) = {
            let mut state = shared.state.lock();
            (std::mem::take(&mut state.steering), state.frames.stamp)
        };
        let stamp = Stamp {
            version: PolicyProposal::VERSION,
            ..stamp
        };
        for (vehicle, (course_rad, speed_m_s)) in steering {
            if !self.policies.contains_key(&vehicle) {
                let key = topic::policy(&self.game.name, self.game.scenario(), vehicle);
                let Ok(publisher) =
                    self.bus
                        .publisher_with(key, Priority::Normal, Delivery::Newest)
                else {
                    continue;
                };
                self.policies.insert(vehicle, publisher);
            }
            if let Some(publisher) = self.policies.get(&vehicle) {
                drop(publisher.send(&PolicyProposal {
                    stamp,
                    vehicle,
                    course_rad,
                    speed_m_s,
                }));
            }
        }
    }

    fn expire_steering(&self, shared: &SharedState) {
        if shared.state.lock().steering_locks.expire(clock::now()) {
            shared.news.send_replace(());
        }
    }

    /// Subscribes to the pictures of exactly the teams whose boats are selected.
    fn update_picture_subscriptions(&mut self, shared: &Arc<SharedState>) {
        let (wanted, generation) = {
            let mut state = shared.state.lock();
            state.forget_unwanted();
            (state.wanted(), state.generation)
        };
        let teams: BTreeSet<TeamId> = wanted
            .keys()
            .map(|vehicle| self.game.scenario().team_of(*vehicle))
            .collect();
        self.pictures.retain(|team, _| teams.contains(team));
        for team in teams {
            if self.pictures.contains_key(&team) {
                continue;
            }
            let subscriptions = Subscriptions {
                shared: Arc::clone(shared),
                generation,
            };
            if let Ok(standing) = subscriptions.pictures(&self.bus, &self.game, team) {
                self.pictures.insert(team, standing);
            }
        }
    }
}

#[derive(Clone)]
struct Subscriptions {
    shared: Arc<SharedState>,
    generation: u64,
}

impl Subscriptions {
    /// Changes the state if it still belongs to this game.
    fn update(&self, change: impl FnOnce(&mut super::live_state::LiveState)) {
        let mut state = self.shared.state.lock();
        if state.generation == self.generation {
            change(&mut state);
            drop(state);
            self.shared.news.send_replace(());
        }
    }

    fn frames(self, bus: &Bus, game: &LiveGame) -> Result<Declaration, BusError> {
        bus.subscribe(topic::frame(&game.name), move |bytes| {
            if let Ok(frame) = codec::decode::<Frame>(bytes) {
                self.update(|state| state.take_frame(&frame, bytes, clock::now()));
            }
        })
    }

    fn run(self, bus: &Bus, game: &LiveGame) -> Result<Declaration, BusError> {
        bus.subscribe(topic::run(&game.name), move |bytes| {
            if let Ok(run) = serde_json::from_slice::<RunState>(bytes) {
                self.update(|state| state.take_run(run));
            }
        })
    }

    fn status(
        self,
        bus: &Bus,
        game: &LiveGame,
        vehicle: VehicleId,
    ) -> Result<Declaration, BusError> {
        bus.subscribe_status(&game.name, game.name_of(vehicle), move |status| {
            self.update(|state| drop(state.statuses.insert(vehicle, Arc::new(status))));
        })
    }

    fn pictures(self, bus: &Bus, game: &LiveGame, team: TeamId) -> Result<Declaration, BusError> {
        let taken: Mutex<Option<Instant>> = Mutex::new(None);
        bus.subscribe(
            topic::picture(&game.name, game.scenario(), team),
            move |bytes| {
                let mut taken = taken.lock();
                let now = clock::now();
                if taken.is_some_and(|before| now.saturating_duration_since(before) < PICTURE_AGAIN)
                {
                    return;
                }
                if let Ok(picture) = codec::decode::<Picture>(bytes) {
                    *taken = Some(now);
                    self.update(|state| state.take_picture(&picture));
                }
            },
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::Ordering;
    use std::sync::mpsc::sync_channel;

    #[test]
    fn what_was_asked_of_one_game_is_forgotten_before_the_next_is_looked_for() {
        let (commands, to_do) = inbox(1);
        let shared = SharedState::new(commands.clone(), Box::new(|_| ()), |_| Err(String::new()));
        let shared = Arc::new(shared.unwrap());
        assert!(commands.offer(Command::Control(Control::Stop)));
        let (found, finds) = sync_channel(1);
        let searched = Arc::clone(&shared);
        let place = move |_: Option<&GameName>| {
            // The queue holds one command, so the offer fails while an earlier one is queued.
            found.send(commands.offer(Command::Steer)).unwrap();
            searched.is_closing.store(true, Ordering::Relaxed);
            Err("there is no network".to_owned())
        };
        GameWatcher {
            shared,
            place: Place::new(place),
            game: None,
            commands: to_do,
        }
        .run();
        assert!(finds.recv().unwrap());
    }
}
