//! The bridge between the two networks: finds a game, publishes it to ROS 2, and drives boats as
//! requested from ROS 2.
//!
//! Observing and driving use separate sessions on the game's network; ROS 2 uses a third. Only the
//! newest frame and the newest picture of each team are kept: a slow ROS network loses messages but
//! does not delay the game.

mod driver;
mod graph;
mod publisher;
mod services;

use crate::name::{Node, is_ros_name};
use crate::set_point::Follower;
use agent::Mind;
use agent::node::{News as AgentNews, NodeError, Settings as AgentSettings};
use bus::game_search::{GameSearch, NotFound};
use bus::{
    Bus, BusError, Declaration, Latest, NodeThread, Patience, Place, SimWatch, Watched, clock,
};
use driver::{Driver, RequestCell};
use graph::Graph;
use messages::refusal::Refusals;
use messages::topic::{self, GameName};
use messages::{Frame, Picture};
use primitives::{SimTime, VehicleId};
use publisher::{Publisher, Statuses};
use scenario::{Scenario, Source, UnknownVehicle};
use services::Operator;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use thiserror::Error;

/// Interval at which an idle bridge checks whether the game is still running.
const LOOK_AGAIN: Duration = Duration::from_millis(100);
/// Absence of the sim's token after which the sim counts as lost. A lack of frames proves nothing,
/// because a paused game sends none.
const MISSING_MAX: Duration = Duration::from_secs(5);
/// How long an agent without pictures waits for the sim.
const SILENCE: Duration = Duration::from_secs(60);

/// The settings of a bridge.
pub struct Settings {
    /// The game to show. `None`: the only one available.
    pub game: Option<GameName>,
    /// The location of the sim.
    pub place: Place,
    /// The endpoint of the ROS 2 router.
    pub router: String,
    /// The ROS domain.
    pub domain: u32,
    /// Names of the boats driven from ROS 2.
    pub vehicles: Vec<String>,
    /// How long a request for a boat is valid, in game time.
    pub ttl: SimTime,
    /// Whether the truth is published.
    pub shows_truth: bool,
    /// Whether ROS 2 may send all operator commands; otherwise it may only stop boats.
    pub is_operator: bool,
    /// Maximum time to search for the sim and to wait for free boats.
    pub wait: Duration,
    /// Set by the caller to end the bridge.
    pub stop: Arc<AtomicBool>,
}

/// Reports from a bridge to the program that runs it.
pub enum News<'a> {
    /// The ROS network is available.
    OnRos {
        /// Whether this process is acting as its router.
        is_router: bool,
    },
    /// The bridge has not yet found a sim or a free boat.
    Looking {
        /// Why the bridge is waiting.
        reason: &'a str,
    },
    /// The bridge is publishing a game.
    Showing {
        /// The game's name.
        game: &'a str,
    },
    /// More messages have been refused.
    Refused {
        /// All counts so far.
        refused: Refusals,
    },
}

/// Why a bridge failed.
#[derive(Debug, Error)]
pub enum RosError {
    /// A network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// No game was found.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// The agent of the driven boats failed.
    #[error(transparent)]
    Agent(#[from] NodeError),
    /// The game has no such boat.
    #[error(transparent)]
    Vehicle(#[from] UnknownVehicle),
    /// ROS 2 does not accept the name of a boat or team.
    #[error(
        "{0:?} cannot be part of a ROS 2 topic: names of boats and teams must consist of letters, digits and single underscores, and start with a letter"
    )]
    Name(String),
    /// The sim is lost.
    #[error("lost the sim")]
    SimGone,
}

/// A message on its way to ROS 2.
enum Incoming {
    /// The bytes of a frame.
    Frame(Vec<u8>),
    /// A team's picture, with invalid numbers removed.
    Picture(Box<Picture>),
}

/// State shared by the threads of a bridge.
#[derive(Clone)]
struct Shared {
    /// The newest frame in slot 0, then the newest picture of each team.
    incoming: Arc<Latest<Incoming>>,
    statuses: Arc<Statuses>,
    refusals: Arc<Watched<Refusals>>,
    /// Set to end all threads.
    ended: Arc<AtomicBool>,
    /// Why the agent is waiting for its boats.
    agent_news: Arc<Watched<Option<String>>>,
    /// How the agent ended.
    agent_end: Arc<Watched<Option<Result<(), NodeError>>>>,
}

/// Publishes a game to ROS 2 until it is over.
///
/// # Errors
/// [`RosError`], including the loss of the sim.
pub fn serve(settings: &Settings, tell: &mut dyn FnMut(News<'_>)) -> Result<(), RosError> {
    let mut graph = Graph::open(&settings.router, settings.domain)?;
    tell(News::OnRos {
        is_router: graph.is_router(),
    });
    let mut search = GameSearch::new(settings.wait, &settings.stop);
    let mut report = |reason: &str| tell(News::Looking { reason });
    let (bus, game, info) = search.game(&mut report, &settings.place, settings.game.as_ref())?;
    let scenario = Arc::new(info.scenario);
    let mut names = scenario
        .vehicles
        .iter()
        .map(|boat| &boat.name)
        .chain(scenario.teams.iter().map(|team| &team.name));
    if let Some(name) = names.find(|name| !is_ros_name(name)) {
        return Err(RosError::Name(name.clone()));
    }
    let driven = settings
        .vehicles
        .iter()
        .map(|name| scenario.vehicle_named(name));
    let driven: Vec<VehicleId> = driven.collect::<Result<_, _>>()?;
    let shared = Shared {
        incoming: Arc::new(Latest::new(1 + scenario.teams.len())),
        statuses: Arc::default(),
        refusals: Arc::default(),
        ended: Arc::default(),
        agent_news: Arc::default(),
        agent_end: Arc::default(),
    };
    let squall = graph.node("squall")?;
    let nodes = scenario
        .vehicles
        .iter()
        .map(|boat| graph.node(&boat.name))
        .collect::<Result<Vec<_>, _>>()?;
    let publisher = Publisher::open(
        &mut graph,
        (&squall, &nodes),
        (game.as_str(), Arc::clone(&scenario)),
        &driven,
        settings.shows_truth,
    )?;
    let operator = Operator {
        bus: bus.clone(),
        game: game.clone(),
        may_all: settings.is_operator,
    };
    let services = services::open(
        &mut graph,
        &squall,
        operator,
        &shared.refusals,
        &shared.ended,
    )?;
    let agent = drive(&mut graph, &nodes, &driven, settings, (&game, &shared))?;
    let watch = SimWatch::open(&bus, &game, Patience::of_player(SILENCE))?;
    let _declarations = observe(&bus, &game, &scenario, &shared)?;
    tell(News::Showing {
        game: game.as_str(),
    });
    let mut bridge = Bridge {
        publisher,
        shared: shared.clone(),
        watch,
        missing_since: None,
        told: Refusals::default(),
    };
    let shown = bridge.run(&settings.stop, tell);
    shared.ended.store(true, Ordering::Relaxed);
    drop((services, agent));
    bus.close();
    shown
}

/// Subscribes to frames and gateways.
fn observe(
    bus: &Bus,
    game: &GameName,
    scenario: &Scenario,
    shared: &Shared,
) -> Result<Vec<Declaration>, BusError> {
    let incoming = Arc::clone(&shared.incoming);
    let keep = move |bytes: &[u8]| incoming.put(0, Incoming::Frame(bytes.to_vec()));
    let mut declarations = vec![bus.subscribe(topic::frame(game), keep)?];
    for boat in scenario
        .vehicles
        .iter()
        .filter(|boat| boat.source == Source::External)
    {
        let (statuses, name) = (Arc::clone(&shared.statuses), boat.name.clone());
        declarations.push(bus.subscribe_status(game, &boat.name, move |status| {
            statuses.visit(|statuses| statuses.insert(name.clone(), (status, clock::now())));
        })?);
    }
    Ok(declarations)
}

/// Starts the agent of the driven boats, if any.
fn drive(
    graph: &mut Graph,
    nodes: &[Node],
    driven: &[VehicleId],
    settings: &Settings,
    (game, shared): (&GameName, &Shared),
) -> Result<Option<NodeThread>, RosError> {
    if driven.is_empty() {
        return Ok(None);
    }
    let mut cells = BTreeMap::new();
    for boat in driven {
        let cell = Arc::new(RequestCell::default());
        driver::subscribe(graph, &nodes[boat.index()], *boat, &cell, &shared.refusals)?;
        cells.insert(*boat, cell);
    }
    let (ttl, incoming) = (settings.ttl, Arc::clone(&shared.incoming));
    let driver = move |boat: VehicleId| {
        // The agent requests only the boats that it was given.
        let cell = cells.get(&boat).map(Arc::clone).unwrap_or_default();
        Driver {
            boat,
            cell,
            follower: Follower::new(ttl),
            incoming: Arc::clone(&incoming),
        }
    };
    let agent = AgentSettings {
        game: Some(game.clone()),
        place: settings.place.clone(),
        vehicles: settings.vehicles.clone(),
        wait: settings.wait,
        silence: SILENCE,
        minds: Some(Box::new(move |_: &Scenario, boats: &[VehicleId]| {
            let mind =
                |boat: &VehicleId| -> (_, Box<dyn Mind>) { (*boat, Box::new(driver(*boat))) };
            boats.iter().map(mind).collect()
        })),
        policy_wait: Duration::ZERO,
        stop: Arc::clone(&shared.ended),
    };
    let shared = shared.clone();
    let body = move || {
        let end = agent::node::serve(&agent, &mut |news: AgentNews<'_>| match news {
            AgentNews::Looking { reason } => shared
                .agent_news
                .visit(|news| *news = Some(reason.to_owned())),
            AgentNews::Left { refused, .. } => shared
                .refusals
                .visit(|refusals| *refusals = *refusals + refused),
            AgentNews::Joined { .. } => {}
        });
        shared.agent_end.visit(|slot| *slot = Some(end));
    };
    let failed = |e: std::io::Error| BusError::Open {
        what: "start an agent's thread".to_owned(),
        reason: e.to_string(),
    };
    Ok(Some(NodeThread::start(body).map_err(failed)?))
}

/// The bridge's main loop.
struct Bridge {
    publisher: Publisher,
    shared: Shared,
    watch: SimWatch,
    missing_since: Option<Instant>,
    told: Refusals,
}

impl Bridge {
    fn run(&mut self, stop: &AtomicBool, tell: &mut dyn FnMut(News<'_>)) -> Result<(), RosError> {
        while !stop.load(Ordering::Relaxed) {
            for incoming in self.shared.incoming.take(LOOK_AGAIN).into_iter().flatten() {
                if self.send(incoming)? {
                    return Ok(());
                }
            }
            let refused = self.shared.refusals.visit(|refusals| *refusals);
            self.publisher.send_seldom(&self.shared.statuses, refused)?;
            self.report(refused, tell);
            if let Some(end) = self.shared.agent_end.visit(Option::take) {
                return Ok(end?);
            }
            let is_missing = self.watch.is_lost(Duration::ZERO);
            self.missing_since = self
                .missing_since
                .or_else(|| Some(clock::now()))
                .filter(|_| is_missing);
            if self
                .missing_since
                .is_some_and(|since| clock::since(since) > MISSING_MAX)
            {
                return Err(RosError::SimGone);
            }
        }
        Ok(())
    }

    /// Passes a message on to ROS 2, and returns whether the game is over.
    fn send(&mut self, incoming: Incoming) -> Result<bool, BusError> {
        match incoming {
            Incoming::Frame(bytes) => {
                let frame = self
                    .shared
                    .refusals
                    .visit(|refusals| refusals.decode::<Frame>(&bytes));
                let Some(frame) = frame else { return Ok(false) };
                self.publisher.send_frame(bytes, &frame)?;
                Ok(frame.over)
            }
            Incoming::Picture(picture) => {
                self.publisher.send_picture(&picture)?;
                Ok(picture.over)
            }
        }
    }

    fn report(&mut self, refused: Refusals, tell: &mut dyn FnMut(News<'_>)) {
        if let Some(reason) = self.shared.agent_news.visit(Option::take) {
            tell(News::Looking { reason: &reason });
        }
        // Refusals are reported when their number has grown tenfold, not for each message:
        // otherwise a hostile node could fill the terminal.
        if refused.total() > self.told.total().saturating_mul(10) {
            self.told = refused;
            tell(News::Refused { refused });
        }
    }
}
