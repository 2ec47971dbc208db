//! An emulated boat on the network: joins a game as the agent of a simulated boat, and lets a back seat decide for it, by the
//! boat's own sentences.

use super::{News, NodeError, declination_today_rad, find_game, pace_factor};
use crate::emulator::{Emulator, Extra, Plan, Port};
use crate::link::{Link, LinkAddress, LinkEvent, LinkSettings};
use crate::nmea::Operator;
use crate::utc;
use agent::{Mind, MindRunner};
use bus::game_search::{self, GameSearch};
use bus::{Delivery, Net, Patience, Publisher, SimState, SimWatch, Watched};
use game::message::Role;
use game::topic::{self, GameName, Part};
use game::{Order, Picture, SimTime, VehicleId, codec};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// What an emulated boat needs to know.
pub struct EmulatorSettings {
    /// The game; without a name, the only one there is.
    pub game: Option<GameName>,
    /// Where the sim is.
    pub net: Net,
    /// The boat's name in the game.
    pub vehicle: String,
    /// Where the back seat connects.
    pub listen: LinkAddress,
    /// Where the primary operator connects, if anywhere.
    pub primary: Option<LinkAddress>,
    /// Magnetic north, east of true, rad; by the World Magnetic Model if it is not said.
    pub declination_rad: Option<f64>,
    /// After this long without a command the boat goes to standby, s; `None` is never.
    pub watchdog_s: Option<f64>,
    /// Whether settings that are no whole numbers leave the ones before in force.
    pub integers: bool,
    /// Sentences beyond a Surveyor's.
    pub extra: Vec<Extra>,
    /// How long to look for the game.
    pub wait: Duration,
    /// After this long without a picture the sim counts as dead.
    pub silence: Duration,
    /// Set from outside to end.
    pub stop: Arc<AtomicBool>,
}

/// How often somebody who hears nothing looks whether it is to end.
const LOOK: Duration = Duration::from_millis(100);
/// Bytes of commands that may wait: more than a back seat sends in a minute.
const UNREAD_MAX: usize = 256 * 1024;

/// What came from the links and the sim since the last look.
#[derive(Default)]
struct Incoming {
    bytes: Vec<(Port, Vec<u8>)>,
    unread: usize,
    told: Vec<String>,
    picture: Option<Vec<u8>>,
}

/// Plays a boat until the game is over, or until it is told to stop.
///
/// # Errors
/// [`NodeError`] if there is no such game or boat, if it has another agent, or if the network or a link cannot work.
pub fn emulate(settings: &EmulatorSettings, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    let mut look = GameSearch::new(settings.wait, &settings.stop);
    let (bus, game, notice) = find_game(&mut look, &settings.net, settings.game.as_ref(), tell)?;
    let vehicle = notice.scenario.vehicle_named(&settings.vehicle)?;
    // A back seat lives by the clock.
    pace_factor(&notice.pace, true)?;
    let scenario = &notice.scenario;
    let datum = scenario.field.plan.datum;
    let declination_rad = match settings.declination_rad {
        Some(rad) => rad,
        None => declination_today_rad(datum)?,
    };
    let plan = Plan {
        datum,
        declination_rad,
        watchdog_s: settings.watchdog_s,
        integers: settings.integers,
        extra: settings.extra.clone(),
        vtg_mode: false,
        began: utc::now(),
    };
    let incoming = Arc::new(Watched::new(Incoming::default()));
    let _alive = bus.show_alive(topic::alive(&game, Part::Agent, &bus.id()))?;
    let pictures = Arc::clone(&incoming);
    let _standing = bus.subscribe(topic::picture(&game, scenario, scenario.team_of(vehicle)), move |bytes| {
        pictures.visit(|incoming| incoming.picture = Some(bytes.to_vec()));
    })?;
    let back_seat = open(&settings.listen, Port::Secondary, &incoming)?;
    tell(News::Listening { what: "back seat", reach: &back_seat.reach() });
    let primary = settings.primary.as_ref().map(|address| open(address, Port::Primary, &incoming)).transpose()?;
    if let Some(primary) = &primary {
        tell(News::Listening { what: "primary operator", reach: &primary.reach() });
    }
    let names = [settings.vehicle.clone()];
    let mut say = |reason: &str| tell(News::Looking { reason });
    let sim = SimWatch::open(&bus, &game, Patience::of_player(settings.silence))?;
    let (ticket, _) = look.until(&mut say, || game_search::join(&bus, &game, Role::Agent, &names))?;
    let boat = EmulatedBoat { vehicle, emulator: Emulator::new(plan) };
    let mut player = Player {
        runner: MindRunner::new([(vehicle, Box::new(boat))]),
        ticket,
        sim,
        now: SimTime::ZERO,
        links: [Some(back_seat), primary],
        orders: bus.publisher(topic::orders(&game, &bus.id()), Delivery::Wait)?,
        operator: Operator::Secondary,
        sent: 0,
    };
    let played = player.play(&settings.stop, &incoming, tell);
    bus.close();
    played
}

/// A port of the boat.
fn open(address: &LinkAddress, port: Port, incoming: &Arc<Watched<Incoming>>) -> Result<Link, NodeError> {
    let board = Arc::clone(incoming);
    let settings = LinkSettings { silence: None, ..LinkSettings::default() };
    Ok(Link::open(address, settings, move |event| board.visit(|incoming| incoming.take(port, event)))?)
}

impl Incoming {
    fn take(&mut self, port: Port, event: LinkEvent) {
        match event {
            LinkEvent::Bytes { bytes, .. } if self.unread + bytes.len() <= UNREAD_MAX => {
                self.unread += bytes.len();
                self.bytes.push((port, bytes));
            }
            LinkEvent::Bytes { .. } | LinkEvent::Written { .. } => {}
            LinkEvent::Up { name, .. } => self.told.push(format!("{name} is connected")),
            LinkEvent::Down { reason, .. } | LinkEvent::Failed { reason, .. } => self.told.push(reason),
        }
    }

    fn is_something(&self) -> bool {
        !self.bytes.is_empty() || !self.told.is_empty() || self.picture.is_some()
    }
}

/// A boat that is told by sentences what to do: to the game it is a mind like any other.
struct EmulatedBoat {
    vehicle: VehicleId,
    emulator: Emulator,
}

impl Mind for EmulatedBoat {
    fn decide(&mut self, picture: &Picture) -> Order {
        let now = picture.stamp.valid_ns;
        if let Some(own) = picture.own(self.vehicle) {
            self.emulator.observe(now, own);
        }
        self.emulator.order(now)
    }
}

/// The boat at work.
struct Player {
    runner: MindRunner<EmulatedBoat>,
    ticket: u64,
    sim: SimWatch,
    /// Time of the game.
    now: SimTime,
    /// To the back seat, and to the primary operator.
    links: [Option<Link>; 2],
    orders: Publisher,
    operator: Operator,
    sent: u64,
}

impl Player {
    fn play(
        &mut self,
        stop: &AtomicBool,
        incoming: &Watched<Incoming>,
        tell: &mut dyn FnMut(News<'_>),
    ) -> Result<(), NodeError> {
        while !stop.load(Ordering::Relaxed) {
            incoming.wait(LOOK, Incoming::is_something);
            let Incoming { bytes, told, picture, .. } = incoming.visit(std::mem::take);
            for text in &told {
                tell(News::Remark { at_s: self.now.as_s(), text });
            }
            for (port, bytes) in &bytes {
                let now = self.now;
                self.emulator().take(now, *port, bytes);
            }
            self.tell_operator(tell);
            if let Some(text) = self.emulator().take_remark() {
                tell(News::Remark { at_s: self.now.as_s(), text: &text });
            }
            let picture = picture.and_then(|bytes| codec::decode::<Picture>(&bytes).ok());
            if let Some(picture) = picture {
                self.sim.hears();
                if picture.over {
                    break;
                }
                self.see(&picture)?;
            }
            match self.sim.state() {
                SimState::Alive => {}
                SimState::Replaced => return Err(NodeError::SimReplaced),
                SimState::Dead(silent) => return Err(NodeError::SimGone(silent)),
            }
        }
        Ok(())
    }

    fn emulator(&mut self) -> &mut Emulator {
        let (_, boat) = self.runner.minds_mut().next().expect("one boat is run here");
        &mut boat.emulator
    }

    /// Says who commands the boat, if that is another one now.
    fn tell_operator(&mut self, tell: &mut dyn FnMut(News<'_>)) {
        let operator = self.emulator().operator();
        if operator != self.operator {
            self.operator = operator;
            let text = format!("{:?} commands the boat", self.operator);
            tell(News::Remark { at_s: self.now.as_s(), text: &text });
        }
    }

    /// A picture has come: the boat does what it is told, and tells how it is.
    fn see(&mut self, picture: &Picture) -> Result<(), NodeError> {
        let is_new = self.runner.decided() != Some(picture.stamp.seq);
        if is_new {
            self.now = picture.stamp.valid_ns;
            if self.runner.decided().is_none() {
                let now = self.now;
                self.emulator().set_clock(now, utc::now());
            }
            self.runner.decide(picture.stamp, |_| Some(picture));
        }
        if let Some(orders) = self.runner.answer(self.ticket) {
            self.orders.send(&orders)?;
        }
        if is_new {
            self.send_telemetry();
        }
        Ok(())
    }

    fn send_telemetry(&mut self) {
        let (now, mut burst) = (self.now, Vec::with_capacity(512));
        self.emulator().telemetry(now, &mut burst);
        self.sent += 1;
        for link in self.links.iter().flatten() {
            link.send(burst.clone(), self.sent);
        }
    }
}
