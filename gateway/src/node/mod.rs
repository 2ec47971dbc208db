//! A gateway on the network: brings a real boat into a game, and plays a boat for real back seats.
//!
//! [`serve`] is the way to a real boat, [`emulate`] the way from a simulated one. Everything that decides is in
//! [`crate::bridge`] and [`crate::emulator`]; here are the sockets, the clocks and the threads.

mod clock;
mod emulator;
mod gateway_loop;
mod join;
mod latency;
mod logbook;

pub use emulator::{EmulatorSettings, emulate};

use crate::bridge::{Bridge, Event, Plan};
use crate::declination::{DeclinationError, declination_deg};
use crate::link::{Link, LinkAddress, LinkError, LinkEvent, LinkSettings};
use crate::record::RecordError;
use crate::utc;
use bus::game_search::{self, GameSearch, NotFound};
use bus::{Bus, BusError, Declaration, Delivery, Net, inbox};
use clock::Clock;
use game::external::GatewayStatus;
use game::frame::LatLon;
use game::gateway::Gateway;
use game::message::{Control, GameInfo, Role};
use game::scenario::{Source, UnknownVehicle};
use game::topic::{self, GameName, Part};
use game::{VehicleId, codec};
use gateway_loop::{Call, Counters, GatewayLoop, LatestOrder};
use join::Join;
use logbook::Logbook;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError};
use std::time::Duration;
use thiserror::Error;

/// What a gateway to a real boat needs to know.
pub struct Settings {
    /// The game; without a name, the only one there is.
    pub game: Option<GameName>,
    /// Where the sim is.
    pub net: Net,
    /// The boat's name in the game.
    pub vehicle: String,
    /// Where the boat is.
    pub link: LinkAddress,
    /// After this long without a byte the boat counts as gone.
    pub silence: Duration,
    /// How it is driven and stopped.
    pub gateway: Gateway,
    /// Whether it arms by itself, once.
    pub arms_itself: bool,
    /// Whether its clock runs as fast as the game's: for emulated boats.
    pub at_game_pace: bool,
    /// Where to record.
    pub record: Option<PathBuf>,
    /// How long to look for the game.
    pub wait: Duration,
    /// Set from outside to end.
    pub stop: Arc<AtomicBool>,
}

/// What a gateway tells the shell that runs it.
pub enum News<'a> {
    /// What is missing before it can begin.
    Looking {
        /// In words.
        reason: &'a str,
    },
    /// Something happened.
    Event {
        /// Time since it began, s.
        at_s: f64,
        /// What.
        event: &'a Event,
    },
    /// The shell saw something.
    Remark {
        /// Time since it began, s.
        at_s: f64,
        /// What.
        text: &'a str,
    },
    /// How it is: twice a second.
    Status(&'a GatewayStatus),
    /// It has ended; how it was.
    Ended(&'a GatewayStatus),
    /// Others can connect here.
    Listening {
        /// Which port this is.
        what: &'a str,
        /// Its address.
        reach: &'a str,
    },
}

/// Why a gateway cannot work.
#[derive(Debug, Error)]
pub enum NodeError {
    /// The network failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// There is no game, or it says no.
    #[error(transparent)]
    NotFound(#[from] NotFound),
    /// The link can never work.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The recording cannot be written.
    #[error("{path}: {source}")]
    Record {
        /// The file.
        path: PathBuf,
        /// Why.
        source: RecordError,
    },
    /// The declination is not known.
    #[error("{0}; declination_deg in the gateway's file says it otherwise")]
    Declination(#[from] DeclinationError),
    /// The game has no such boat.
    #[error(transparent)]
    UnknownVehicle(#[from] UnknownVehicle),
    /// The game and the gateway do not go together.
    #[error("{0}")]
    Refused(String),
    /// The sim has died or fallen silent, and with it the emulated boat.
    #[error("the sim is gone: no picture for {0:.1?}")]
    SimGone(Duration),
    /// Another sim serves a game of the same name, and knows nothing of us.
    #[error("the sim is gone, and another one serves the game: join again")]
    SimReplaced,
}

/// Calls that may wait at the desk.
const INBOX: usize = 4096;

/// Brings a real boat into a game until it is told to stop. However it ends, the boat is told standby.
///
/// # Errors
/// [`NodeError`] if there is no such game or boat, or if the network, the link or the recording cannot work. A boat or a
/// sim that goes away is none: the gateway waits for it.
pub fn serve(settings: &Settings, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    let mut look = GameSearch::new(settings.wait, &settings.stop);
    let (bus, game, notice) = find_game(&mut look, &settings.net, settings.game.as_ref(), tell)?;
    let vehicle = external_vehicle(&notice, &settings.vehicle)?;
    let factor = pace_factor(&notice.pace, settings.at_game_pace)?;
    let field = notice.scenario.field.clone();
    let declination_rad = match settings.gateway.declination_rad {
        Some(rad) => rad,
        None => declination_today_rad(field.plan.datum)?,
    };
    let plan = Plan {
        vehicle: settings.vehicle.clone(),
        gateway: settings.gateway.clone(),
        field,
        length_m: notice.scenario.boat_of(vehicle).length_m,
        declination_rad,
        arms_itself: settings.arms_itself,
    };
    let logbook = match &settings.record {
        Some(path) => {
            Some(Logbook::open(path, &plan).map_err(|source| NodeError::Record { path: path.clone(), source })?)
        }
        None => None,
    };
    let _alive = bus.show_alive(topic::alive(&game, Part::Gateway, &bus.id()))?;
    // Nothing is sent to a boat that another gateway has. The thread that keeps it joined asks again, and gets it again.
    let names = [settings.vehicle.clone()];
    let mut say = |reason: &str| tell(News::Looking { reason });
    look.until(&mut say, || game_search::join(&bus, &game, Role::Gateway, &names))?;
    let (inbox_sender, inbox) = inbox(INBOX);
    let latest_order = LatestOrder::default();
    let e_stop = Arc::new(AtomicBool::new(false));
    let standing = lines(&bus, &game, &notice, vehicle, (&latest_order, &e_stop, &inbox_sender))?;
    let calls = inbox_sender.clone();
    let link_settings = LinkSettings { silence: Some(settings.silence), ..LinkSettings::default() };
    let link = Link::open(&settings.link, link_settings, move |event: LinkEvent| calls.put(Call::Link(event)))?;
    let others = notice.scenario.vehicles.iter().enumerate().filter(|(_, other)| other.source == Source::External);
    let mut desk = GatewayLoop {
        bridge: Bridge::new(plan),
        link,
        clock: Clock::start(factor),
        inbox,
        latest_order,
        e_stop,
        nav: bus.publisher(topic::nav(&game, &notice.scenario, vehicle), Delivery::Drop)?,
        status: bus.publisher(topic::status(&game, &settings.vehicle), Delivery::Drop)?,
        wire: bus.publisher(topic::link(&game, &settings.vehicle), Delivery::Drop)?,
        vehicle,
        others: others.map(|(i, _)| VehicleId::at(i)).filter(|other| *other != vehicle).collect(),
        logbook,
        counters: Counters::new(),
    };
    let join = Join::begin(&bus, &game, &settings.vehicle, inbox_sender)?;
    let worked = desk.work(&settings.stop, tell);
    let status = desk.full_status();
    // The boat first, then the network.
    drop(desk);
    drop((join, standing));
    tell(News::Ended(&status));
    bus.close();
    worked
}

/// What comes from the sim and from people, into the latest_order and to the desk.
fn lines(
    bus: &Bus,
    game: &GameName,
    notice: &GameInfo,
    vehicle: VehicleId,
    (latest_order, e_stop, inbox_sender): (&LatestOrder, &Arc<AtomicBool>, &bus::InboxSender<Call>),
) -> Result<Vec<Declaration>, BusError> {
    let scenario = &notice.scenario;
    let (latest_order, orders) = (Arc::clone(latest_order), inbox_sender.clone());
    let take_order = move |bytes: &[u8]| {
        let Ok(order) = codec::decode(bytes) else { return };
        let mut latest_order = latest_order.lock().unwrap_or_else(PoisonError::into_inner);
        // Who has yet to look into the latest_order will find the newest.
        if latest_order.replace((order, bus::clock::now())).is_none() {
            orders.put(Call::Order);
        }
    };
    let (questions, controls, frames) = (inbox_sender.clone(), inbox_sender.clone(), inbox_sender.clone());
    let e_stop = Arc::clone(e_stop);
    let name = &scenario.vehicles[vehicle.index()].name;
    let mut standing = vec![
        bus.subscribe(topic::external_order(game, scenario, vehicle), take_order)?,
        bus.answer(topic::operate(game, name), move |question| questions.put(Call::Operate(question)))?,
        bus.subscribe(topic::control(game), move |bytes| match serde_json::from_slice(bytes) {
            Ok(Control::EStop) => {
                e_stop.store(true, Ordering::Relaxed);
                controls.put(Call::EStop);
            }
            Ok(Control::Release) => controls.put(Call::Release),
            // Everything else reaches the boat as an order, if at all.
            Ok(_) | Err(_) => {}
        })?,
    ];
    // The truth is made only where somebody asks for it.
    let real = scenario.vehicles.iter().filter(|vehicle| vehicle.source == Source::External).count();
    if real > 1 {
        standing.push(bus.subscribe(topic::frame(game), move |bytes| frames.put(Call::Frame(bytes.to_vec())))?);
    }
    Ok(standing)
}

/// The game, and what it is.
fn find_game(
    look: &mut GameSearch<'_>,
    net: &Net,
    game: Option<&GameName>,
    tell: &mut dyn FnMut(News<'_>),
) -> Result<(Bus, GameName, GameInfo), NodeError> {
    let mut say = |reason: &str| tell(News::Looking { reason });
    let (bus, game) = look.game(&mut say, net, game)?;
    let notice = look.until(&mut say, || game_search::game_info(&bus, &game))?;
    Ok((bus, game, notice))
}

fn external_vehicle(notice: &GameInfo, name: &str) -> Result<VehicleId, NodeError> {
    let vehicle = notice.scenario.vehicle_named(name)?;
    if notice.scenario.vehicles[vehicle.index()].source == Source::External {
        return Ok(vehicle);
    }
    Err(NodeError::Refused(format!("{name} is simulated in this game: a real boat needs source = \"external\"")))
}

/// How many seconds of the game go by in one of the wall's.
fn pace_factor(pace: &str, at_game_pace: bool) -> Result<f64, NodeError> {
    match (pace, at_game_pace) {
        ("realtime", _) => Ok(1.0),
        (pace, true) => pace
            .strip_suffix('x')
            .and_then(|factor| factor.parse().ok())
            .ok_or_else(|| NodeError::Refused(format!("the game's pace is {pace}, expected realtime or a factor"))),
        (pace, false) => Err(NodeError::Refused(format!(
            "the game's pace is {pace}, expected realtime: a real boat knows no other (--at-game-pace is for emulated ones)"
        ))),
    }
}

/// Magnetic north here and today, east of true, rad.
fn declination_today_rad(at: LatLon) -> Result<f64, NodeError> {
    Ok(declination_deg(at, utc::now().0)?.to_radians())
}
