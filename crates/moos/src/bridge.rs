//! The bridge: finds a game, opens the communities, joins the game with their boats, and serves the
//! communities until the game is over.

use crate::boat::{self, BoatMind};
use crate::clock::MoosClock;
use crate::community::{Address, Community};
use crate::share::Share;
use crate::shoreside::{self, Shoreside};
use agent::node::NodeError;
use bus::game_search::{GameSearch, NotFound};
use bus::{Bus, Patience, Place, SimState, SimWatch, Watched, clock};
use gateway::geodesy::LocalFrame;
use messages::run_state::RunState;
use messages::topic::{self, GameName};
use scenario::Scenario;
use std::collections::BTreeSet;
use std::net::{Ipv4Addr, SocketAddr};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use thiserror::Error;

/// Minimum interval between notes about dropped messages.
const REPORT: Duration = Duration::from_secs(1);
/// Maximum time to wait for a boat's helm once any application has connected.
const HELM_MAX: Duration = Duration::from_secs(5);
/// Time for applications to read the end of the game before their database closes.
const LINGER: Duration = Duration::from_millis(500);

/// The settings of a bridge.
pub struct Settings {
    /// The game to join. `None`: the only one available.
    pub game: Option<GameName>,
    /// The location of the sim.
    pub place: Place,
    /// Maximum time to search for the sim and to wait for free boats.
    pub wait: Duration,
    /// Time without a picture after which the sim counts as lost.
    pub silence: Duration,
    /// Set by the caller to leave the game.
    pub stop: Arc<AtomicBool>,
    /// Boats by name, with the addresses of their databases. A boat without an address gets the
    /// next port.
    pub boats: Vec<(String, Option<Address>)>,
    /// A team whose boats are all connected.
    pub team: Option<String>,
    /// The first port of boats without an address.
    pub first_port: u16,
    /// The address of the shoreside's database; `None` for no shoreside.
    pub shore: Option<Address>,
    /// Addresses of pShare instances that receive the shoreside's publications.
    pub share_to: Vec<SocketAddr>,
    /// The local address that receives commands from pShare.
    pub share_listen: Option<SocketAddr>,
}

/// Reports of the bridge.
pub enum News<'a> {
    /// No game has been found yet, or a boat is not free.
    Looking(&'a str),
    /// The communities are open.
    Open(Vec<String>),
    /// The boats are in the game.
    Joined(&'a str),
    /// A note for the person who runs the bridge.
    Note(String),
}

/// Why the bridge has ended.
#[derive(Debug, Error)]
pub enum BridgeError {
    /// No game was found.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// The game or the arguments do not allow a bridge.
    #[error("{0}")]
    Impossible(String),
    /// The boats could not join, or lost the game.
    #[error(transparent)]
    Node(#[from] NodeError),
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] bus::BusError),
}

impl From<String> for BridgeError {
    fn from(reason: String) -> BridgeError {
        BridgeError::Impossible(reason)
    }
}

/// Receives reports.
pub type Tell<'a> = &'a (dyn Fn(News<'_>) + Sync);

/// A game and the communities connected to it.
struct Bridge<'a> {
    bus: Bus,
    game: GameName,
    scenario: Scenario,
    moos: MoosClock,
    boats: Vec<Arc<Watched<Community>>>,
    shore: Option<Arc<Watched<Community>>>,
    settings: &'a Settings,
    tell: Tell<'a>,
    /// Set when the boats' game is over.
    is_over: AtomicBool,
}

/// Serves the communities until the game is over.
///
/// # Errors
/// [`BridgeError`].
pub fn serve(settings: &Settings, tell: Tell<'_>) -> Result<(), BridgeError> {
    let mut search = GameSearch::new(settings.wait, &settings.stop);
    let mut looking = |reason: &str| tell(News::Looking(reason));
    let (bus, game, info) = search.game(&mut looking, &settings.place, settings.game.as_ref())?;
    let moos = MoosClock::of_pace(&info.pace)?;
    let scenario = info.scenario;
    if settings.shore.is_some() {
        shoreside::check_keys(&bus)?;
    }
    let open = |name: &str, address: &Address, reads: BTreeSet<String>| {
        Community::open(name, address, reads, moos)
            .map(|community| Arc::new(Watched::new(community)))
    };
    let boats = boats(settings, &scenario)?;
    let boats: Result<Vec<_>, String> = boats
        .iter()
        .map(|(name, address)| open(name, address, boat::reads()))
        .collect();
    let boats = boats?;
    let shore = settings.shore.as_ref();
    let shore = shore
        .map(|address| open("shoreside", address, shoreside::reads(&scenario)))
        .transpose()?;
    let is_over = AtomicBool::new(false);
    let bridge = Bridge {
        bus,
        game,
        scenario,
        moos,
        boats,
        shore,
        settings,
        tell,
        is_over,
    };
    tell(News::Open(bridge.opened()));
    bridge.run()
}

impl Bridge<'_> {
    /// The addresses of the communities, and the values that missions need to match the game.
    fn opened(&self) -> Vec<String> {
        let place = |community: &Arc<Watched<Community>>| {
            community.visit(|community| format!("{}: {}", community.name, community.place))
        };
        let mut lines: Vec<String> = self.boats.iter().chain(&self.shore).map(place).collect();
        let datum = self.scenario.field.plan.datum;
        lines.push(format!(
            "mission files: MOOSTimeWarp = {}, LatOrigin = {}, LongOrigin = {}",
            self.moos.warp, datum.lat_deg, datum.lon_deg
        ));
        lines
    }

    fn run(&self) -> Result<(), BridgeError> {
        let mut shoreside = self.shoreside()?;
        let speed = Arc::new(Watched::new(None));
        let newest = Arc::clone(&speed);
        let receive = move |bytes: &[u8]| {
            let state = serde_json::from_slice::<RunState>(bytes).ok();
            newest.visit(|speed| *speed = state.and_then(|state| state.speed));
        };
        let _run_state = self.bus.subscribe(topic::run(&self.game), receive)?;
        let is_ended =
            || self.is_over.load(Ordering::Relaxed) || self.settings.stop.load(Ordering::Relaxed);
        let played = std::thread::scope(|scope| {
            scope.spawn(|| self.report(&speed, &is_ended));
            let shore = shoreside
                .as_mut()
                .map(|shoreside| scope.spawn(|| shoreside.serve(&self.bus, &self.game, &is_ended)));
            let played = if self.boats.is_empty() {
                Ok(())
            } else {
                self.await_helms().and_then(|()| self.play())
            };
            if !self.boats.is_empty() {
                clock::rest(LINGER);
                self.is_over.store(true, Ordering::Relaxed);
            }
            let shown = shore.map(|shore| shore.join().expect("the shoreside does not panic"));
            self.is_over.store(true, Ordering::Relaxed);
            played.and(shown.unwrap_or(Ok(())).map_err(BridgeError::from))
        });
        self.bus.close();
        played
    }

    /// Waits until every boat has a helm or, after [`HELM_MAX`], any application, because a game
    /// begins once its last agent has joined.
    fn await_helms(&self) -> Result<(), BridgeError> {
        let patience = Patience::of_player(self.settings.silence);
        let sim = SimWatch::open(&self.bus, &self.game, patience)?;
        let mut told = String::new();
        let mut since = vec![None; self.boats.len()];
        loop {
            let waiting = self
                .boats
                .iter()
                .zip(&mut since)
                .filter_map(|(community, since)| {
                    let (name, (has_helm, has_some)) =
                        community.visit(|community| (community.name.clone(), community.presence()));
                    let start = has_some.then(|| *since.get_or_insert_with(clock::now));
                    let is_late = start.is_some_and(|start| clock::since(start) > HELM_MAX);
                    (!has_helm && !is_late).then_some(name)
                });
            let waiting = waiting.collect::<Vec<_>>().join(", ");
            let is_stopped = self.settings.stop.load(Ordering::Relaxed);
            if waiting.is_empty() || is_stopped || !matches!(sim.state(), SimState::Alive) {
                return Ok(());
            }
            if told != waiting {
                (self.tell)(News::Note(format!("waiting for the helms of {waiting}")));
                told = waiting;
            }
            clock::rest(LINGER / 5);
        }
    }

    /// Controls the boats until the game is over.
    fn play(&self) -> Result<(), BridgeError> {
        let name = |community: &Arc<Watched<Community>>| {
            community.visit(|community| community.name.clone())
        };
        let boats = self.boats.clone();
        let moos = self.moos;
        let make = move |scenario: &Scenario, vehicles: &[primitives::VehicleId]| {
            let scenario = Arc::new(scenario.clone());
            let mind = |vehicle: &primitives::VehicleId| -> (_, Box<dyn agent::Mind>) {
                let wanted = &scenario.vehicles[vehicle.index()].name;
                let community = boats.iter().find(|community| name(community) == *wanted);
                let community =
                    Arc::clone(community.expect("only boats with a community are requested"));
                let scenario = Arc::clone(&scenario);
                let mind = BoatMind::new(scenario, *vehicle, community, moos);
                (*vehicle, Box::new(mind))
            };
            vehicles.iter().map(mind).collect()
        };
        let Settings {
            place,
            wait,
            silence,
            stop,
            ..
        } = self.settings;
        let settings = agent::node::Settings {
            game: Some(self.game.clone()),
            place: place.clone(),
            vehicles: self.boats.iter().map(name).collect(),
            wait: *wait,
            silence: *silence,
            minds: Some(Box::new(make)),
            policy_wait: Duration::ZERO,
            stop: Arc::clone(stop),
        };
        let mut tell = |news: agent::node::News<'_>| match news {
            agent::node::News::Looking { reason } => (self.tell)(News::Looking(reason)),
            agent::node::News::Joined { game } => (self.tell)(News::Joined(game)),
            agent::node::News::Left { refused, .. } if refused.total() > 0 => {
                (self.tell)(News::Note(format!("refused or missed: {refused}")));
            }
            agent::node::News::Left { .. } => {}
        };
        let played = agent::node::serve(&settings, &mut tell);
        self.boats
            .iter()
            .for_each(|community| community.visit(boat::publish_end));
        Ok(played?)
    }

    fn shoreside(&self) -> Result<Option<Shoreside<'_>>, BridgeError> {
        let Some(community) = self.shore.clone() else {
            return Ok(None);
        };
        let Settings {
            share_to,
            share_listen,
            ..
        } = self.settings;
        let any: SocketAddr = (Ipv4Addr::UNSPECIFIED, 0).into();
        let open = |listen| {
            Share::open(listen, share_to.clone())
                .map_err(|e| format!("cannot open pShare's port at {listen}: {e}"))
        };
        let is_shared = share_listen.is_some() || !share_to.is_empty();
        Ok(Some(Shoreside {
            scenario: &self.scenario,
            frame: LocalFrame::new(self.scenario.field.plan.datum),
            community,
            share: is_shared
                .then(|| open(share_listen.unwrap_or(any)))
                .transpose()?,
            boats: self.boats.clone(),
            moos: self.moos,
            redraw_s: f64::NEG_INFINITY,
        }))
    }

    /// Reports dropped messages, at most once a second, and changes of pace, which MOOS does not
    /// follow.
    fn report(&self, speed: &Watched<Option<f64>>, is_ended: &dyn Fn() -> bool) {
        let mut last = vec![String::new(); self.boats.len() + 1];
        let mut told_speed = self.moos.warp;
        let mut due = clock::now();
        while !is_ended() {
            clock::rest(LINGER / 5);
            let is_due = clock::since(due) >= REPORT;
            due = if is_due { clock::now() } else { due };
            for (community, last) in self.boats.iter().chain(&self.shore).zip(&mut last) {
                let (notes, counts) = community.visit(|community| {
                    let (dropped, refused) = (
                        community.dropped().to_string(),
                        community.refusals.to_string(),
                    );
                    let texts: Vec<String> = [dropped, refused]
                        .into_iter()
                        .filter(|text| !text.is_empty())
                        .collect();
                    (
                        community.tend(),
                        format!(
                            "{}: dropped or refused: {}",
                            community.name,
                            texts.join(", ")
                        ),
                    )
                });
                notes
                    .into_iter()
                    .for_each(|note| (self.tell)(News::Note(note)));
                if is_due && !counts.ends_with(": ") && *last != counts {
                    (self.tell)(News::Note(counts.clone()));
                    *last = counts;
                }
            }
            if let Some(speed) = speed
                .visit(|speed| speed.take())
                .filter(|speed| *speed != told_speed)
            {
                let warp = self.moos.warp;
                (self.tell)(News::Note(format!(
                    "the game is now running at {speed}x, but MOOSTimeWarp remains {warp}"
                )));
                told_speed = speed;
            }
        }
    }
}

/// The boats to connect and the addresses of their databases.
fn boats(settings: &Settings, scenario: &Scenario) -> Result<Vec<(String, Address)>, String> {
    let mut wanted = settings.boats.clone();
    for (name, _) in &wanted {
        scenario.vehicle_named(name).map_err(|e| e.to_string())?;
    }
    if let Some(team) = &settings.team {
        let names = || {
            scenario
                .teams
                .iter()
                .map(|team| team.name.clone())
                .collect::<Vec<_>>()
                .join(", ")
        };
        let index = scenario.teams.iter().position(|known| known.name == *team);
        let index =
            index.ok_or_else(|| format!("no team named {team:?}; the teams are: {}", names()))?;
        for boat in scenario
            .vehicles
            .iter()
            .filter(|boat| boat.team.index() == index)
        {
            if wanted.iter().all(|(name, _)| *name != boat.name) {
                wanted.push((boat.name.clone(), None));
            }
        }
    }
    let mut ports = settings.first_port..=u16::MAX;
    let addressed = wanted.into_iter().map(|(name, address)| {
        let next = || Some(Address::Serve((Ipv4Addr::LOCALHOST, ports.next()?).into()));
        let address = address
            .or_else(next)
            .ok_or("not enough ports from --port up to 65535 for all boats")?;
        Ok((name, address))
    });
    addressed.collect()
}
