//! The emulator's node: joins a game as the agent of a simulated boat, which a back seat drives
//! through the boat's own protocol.

use super::POLL;
use super::error::NodeError;
use super::game_terms::{declination_rad, pace_factor};
use super::node_event::NodeEvent;
use super::sitl_port::SitlPort;
use crate::bridge::Event;
use crate::emulator::{ArduPilot, Emulator, Extra, FrontSeat, Plan, Port, Servos};
use crate::link::{BoatLink, Link, LinkAddress, LinkEvent, LinkSettings};
use crate::nmea::Operator;
use crate::nmea::date_and_time;
use agent::{Mind, MindRunner};
use bus::game_search::{self, GameSearch};
use bus::{Patience, Place, Priority, Publisher, SimState, SimWatch, Watched};
use messages::topic::{self, GameName};
use messages::{Frame, Order, Picture, Role};
use primitives::frame::LatLon;
use primitives::{SimTime, VehicleId, codec};
use recording::utc;
use std::net::SocketAddr;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The settings of an emulated boat.
pub struct EmulatorSettings {
    /// The game to join; `None` means the only one available.
    pub game: Option<GameName>,
    /// The location of the sim.
    pub place: Place,
    /// The boat's name in the game.
    pub vehicle: String,
    /// The boat's front seat.
    pub front_seat: FrontSeatSettings,
    /// How long to look for the game.
    pub wait: Duration,
    /// Time without a picture after which the sim is treated as lost.
    pub silence: Duration,
    /// Set by the caller to end the emulator.
    pub stop: Arc<AtomicBool>,
}

/// The settings of an emulated boat's front seat.
pub enum FrontSeatSettings {
    /// Imitates a Surveyor's front seat.
    Surveyor {
        /// The address for the back seat.
        listen: LinkAddress,
        /// The address for the primary operator, if used.
        primary: Option<LinkAddress>,
        /// Declination, east positive, rad; `None` uses the World Magnetic Model.
        declination_rad: Option<f64>,
        /// Time without a command after which the boat goes to standby, s; `None` means never.
        watchdog_s: Option<f64>,
        /// Whether the boat ignores non-integer set-points and keeps the previous one.
        integers: bool,
        /// Sentences in addition to a Surveyor's.
        extra: Vec<Extra>,
        /// Initial charge of the battery, as a fraction; `None` means full, without drain.
        charge: Option<f64>,
    },
    /// Imitates an ArduPilot boat's front seat.
    ArduPilot {
        /// The address for the back seat.
        listen: LinkAddress,
        /// A ground station that waits for the boat, if used.
        ground_station: Option<LinkAddress>,
        /// Initial charge of the battery, as a fraction; `None` means full, without drain.
        charge: Option<f64>,
    },
    /// ArduPilot's own firmware, as *software in the loop*.
    Sitl {
        /// The UDP address at which the firmware requests its boat's motion.
        listen: SocketAddr,
        /// The servo outputs for the thrusters.
        servos: Servos,
    },
}

/// Maximum bytes of queued commands: more than a back seat sends in a minute.
const UNREAD_MAX: usize = 256 * 1024;

/// Maximum number of queued frames: more than a game publishes while one is being read.
const FRAMES_MAX: usize = 64;

/// Input from the links and the sim since the last poll.
#[derive(Default)]
struct Incoming {
    bytes: Vec<(Port, Vec<u8>)>,
    unread: usize,
    remarks: Vec<String>,
    picture: Option<Vec<u8>>,
    /// The true state of the game, if the front seat needs it.
    frames: Vec<Vec<u8>>,
}

/// Emulates a boat until the game is over, or until it is stopped.
///
/// # Errors
/// [`NodeError`] if there is no such game or boat, if the boat already has an agent, or if the
/// network or a link fails.
pub fn emulate(
    settings: &EmulatorSettings,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Result<(), NodeError> {
    let mut search = GameSearch::new(settings.wait, &settings.stop);
    let mut looking = |reason: &str| notify(NodeEvent::Looking { reason });
    let (bus, game, info) = search.game(&mut looking, &settings.place, settings.game.as_ref())?;
    let vehicle = info.scenario.vehicle_named(&settings.vehicle)?;
    // A back seat runs in real time, so lockstep is rejected: a lockstep game's clock stops between
    // decisions.
    pace_factor(&info.pace, true)?;
    let scenario = &info.scenario;
    let datum = scenario.field.plan.datum;
    let incoming = Arc::new(Watched::new(Incoming::default()));
    let pictures = Arc::clone(&incoming);
    let _subscription = bus.subscribe(
        topic::picture(&game, scenario, scenario.team_of(vehicle)),
        move |bytes| {
            // Keep only the newest: a boat does not act on an outdated picture.
            pictures.visit(|incoming| incoming.picture = Some(bytes.to_vec()));
        },
    )?;
    let (front_seat, links) = open_front_seat(&settings.front_seat, datum, &incoming, notify)?;
    let frames = Arc::clone(&incoming);
    // Firmware has its own sensor models, so it needs the true state.
    let _truth = matches!(settings.front_seat, FrontSeatSettings::Sitl { .. }).then(|| {
        bus.subscribe(topic::frame(&game), move |bytes| {
            frames.visit(|incoming| incoming.keep_frame(bytes))
        })
    });
    let _truth = _truth.transpose()?;
    let names = [settings.vehicle.clone()];
    let mut say = |reason: &str| notify(NodeEvent::Looking { reason });
    let sim = SimWatch::open(&bus, &game, Patience::of_player(settings.silence))?;
    let place = &settings.place;
    let all = (&game, scenario);
    let joined = search.until(&mut say, || {
        game_search::join(&bus, place, all, Role::Agent, &names)
    })?;
    let boat = EmulatedBoat {
        vehicle,
        front_seat,
    };
    let mut node = EmulatorNode {
        runner: MindRunner::new([(vehicle, Box::new(boat))]),
        ticket: joined.ticket,
        sim,
        now: SimTime::ZERO,
        links,
        orders: bus.publisher(
            topic::orders(&game, scenario, &[scenario.team_of(vehicle)], &bus.id()),
            Priority::Normal,
        )?,
        operator: Some(Operator::Secondary),
        sent: 0,
    };
    let result = node.run(&settings.stop, &incoming, notify);
    bus.close();
    result
}

/// The front seat and its links: to the back seat, and to the primary operator or the ground
/// station.
type Opened = (Box<dyn FrontSeat>, [Option<Link>; 2]);

/// Opens the front seat of a boat on a field with the given datum.
fn open_front_seat(
    settings: &FrontSeatSettings,
    datum: LatLon,
    incoming: &Arc<Watched<Incoming>>,
    notify: &mut dyn FnMut(NodeEvent<'_>),
) -> Result<Opened, NodeError> {
    let mut open_both = |listen: &LinkAddress, other: &Option<LinkAddress>| {
        let back_seat = open(listen, Port::Secondary, incoming)?;
        notify(NodeEvent::Listening {
            what: "back seat",
            reach: &back_seat.reach(),
        });
        let other = other
            .as_ref()
            .map(|address| open(address, Port::Primary, incoming))
            .transpose()?;
        if let Some(other) = &other {
            notify(NodeEvent::Listening {
                what: "primary operator",
                reach: &other.reach(),
            });
        }
        Ok::<_, NodeError>([Some(back_seat), other])
    };
    match settings {
        FrontSeatSettings::Surveyor {
            listen,
            primary,
            declination_rad: set_rad,
            watchdog_s,
            integers,
            extra,
            charge,
        } => {
            let plan = Plan {
                datum,
                declination_rad: declination_rad(*set_rad, datum)?,
                watchdog_s: *watchdog_s,
                integers: *integers,
                extra: extra.clone(),
                began: date_and_time(utc::now_ns()),
                charge: *charge,
            };
            Ok((Box::new(Emulator::new(plan)), open_both(listen, primary)?))
        }
        FrontSeatSettings::ArduPilot {
            listen,
            ground_station,
            charge,
        } => Ok((
            Box::new(ArduPilot::new(datum, *charge)),
            open_both(listen, ground_station)?,
        )),
        FrontSeatSettings::Sitl { listen, servos } => {
            let port = SitlPort::open(*listen, *servos)?;
            let LatLon { lat_deg, lon_deg } = datum;
            let reach = format!(
                "udp://{}, started with --home {lat_deg},{lon_deg},0,0",
                port.address()
            );
            notify(NodeEvent::Listening {
                what: "firmware",
                reach: &reach,
            });
            Ok((Box::new(port), [None, None]))
        }
    }
}

/// Opens a port of the boat.
fn open(
    address: &LinkAddress,
    port: Port,
    incoming: &Arc<Watched<Incoming>>,
) -> Result<Link, NodeError> {
    let shared = Arc::clone(incoming);
    // A back seat may listen silently for hours.
    let settings = LinkSettings {
        silence: None,
        ..LinkSettings::default()
    };
    Ok(Link::open(address, settings, move |event| {
        shared.visit(|incoming| incoming.handle_event(port, event))
    })?)
}

impl Incoming {
    fn handle_event(&mut self, port: Port, event: LinkEvent) {
        match event {
            LinkEvent::Bytes { bytes, .. } if self.unread + bytes.len() <= UNREAD_MAX => {
                self.unread += bytes.len();
                self.bytes.push((port, bytes));
            }
            LinkEvent::Bytes { .. } | LinkEvent::Written { .. } => {}
            LinkEvent::Up { name, .. } => self.remarks.push(format!("{name} is connected")),
            LinkEvent::Down { reason, .. } | LinkEvent::Failed { reason, .. } => {
                self.remarks.push(reason)
            }
        }
    }

    fn keep_frame(&mut self, bytes: &[u8]) {
        if self.frames.len() < FRAMES_MAX {
            self.frames.push(bytes.to_vec());
        }
    }

    fn is_something(&self) -> bool {
        !self.bytes.is_empty()
            || !self.remarks.is_empty()
            || self.picture.is_some()
            || !self.frames.is_empty()
    }
}

/// The emulated boat as a mind: its order is the back seat's command.
struct EmulatedBoat {
    vehicle: VehicleId,
    front_seat: Box<dyn FrontSeat>,
}

impl Mind for EmulatedBoat {
    fn decide(&mut self, picture: &Picture) -> Order {
        let now = picture.stamp.valid_ns;
        if let Some(own) = picture.own(self.vehicle) {
            self.front_seat.observe(now, own);
        }
        self.front_seat.order(now)
    }
}

/// The boat in the game.
struct EmulatorNode {
    runner: MindRunner<EmulatedBoat>,
    ticket: u64,
    sim: SimWatch,
    /// Game time.
    now: SimTime,
    /// Links to the back seat and to the primary operator.
    links: [Option<Link>; 2],
    orders: Publisher,
    operator: Option<Operator>,
    sent: u64,
}

impl EmulatorNode {
    fn run(
        &mut self,
        stop: &AtomicBool,
        incoming: &Watched<Incoming>,
        notify: &mut dyn FnMut(NodeEvent<'_>),
    ) -> Result<(), NodeError> {
        while !stop.load(Ordering::Relaxed) {
            incoming.wait(POLL, Incoming::is_something);
            let Incoming {
                bytes,
                remarks,
                picture,
                frames,
                ..
            } = incoming.visit(std::mem::take);
            frames.iter().for_each(|bytes| self.observe_truth(bytes));
            remarks
                .into_iter()
                .for_each(|text| self.remark(text, notify));
            for (port, bytes) in &bytes {
                let now = self.now;
                self.front_seat().receive(now, *port, bytes);
            }
            self.report_operator(notify);
            if let Some(text) = self.front_seat().take_remark() {
                self.remark(text, notify);
            }
            let picture = picture.and_then(|bytes| codec::decode::<Picture>(&bytes).ok());
            if let Some(picture) = picture {
                self.sim.hears();
                if picture.over {
                    break;
                }
                self.answer(&picture)?;
            }
            match self.sim.state() {
                SimState::Alive => {}
                SimState::Replaced => return Err(NodeError::SimReplaced),
                SimState::Dead(silent) => return Err(NodeError::SimGone(silent)),
            }
        }
        Ok(())
    }

    /// Passes the boat's part of a frame to its front seat.
    fn observe_truth(&mut self, bytes: &[u8]) {
        let Ok(frame) = codec::decode::<Frame>(bytes) else {
            return;
        };
        let truth = self
            .runner
            .minds()
            .next()
            .and_then(|(vehicle, _)| frame.vehicles.get(vehicle.index()));
        if let Some(truth) = truth {
            self.front_seat().observe_truth(frame.stamp.valid_ns, truth);
        }
    }

    fn front_seat(&mut self) -> &mut dyn FrontSeat {
        let (_, boat) = self
            .runner
            .minds_mut()
            .next()
            .expect("one boat is run here");
        &mut *boat.front_seat
    }

    /// Reports who commands the boat, if this has changed.
    fn report_operator(&mut self, notify: &mut dyn FnMut(NodeEvent<'_>)) {
        let Some(operator) = self.front_seat().operator() else {
            return;
        };
        if self.operator.replace(operator) != Some(operator) {
            self.remark(format!("{operator:?} commands the boat"), notify);
        }
    }

    fn remark(&self, text: String, notify: &mut dyn FnMut(NodeEvent<'_>)) {
        notify(NodeEvent::Event {
            at_s: self.now.as_s(),
            event: &Event::Remark(text),
        });
    }

    /// Answers a picture with the boat's order, and sends telemetry.
    fn answer(&mut self, picture: &Picture) -> Result<(), NodeError> {
        // The sim repeats pictures whose answers were lost: repeat the order, but not the
        // telemetry.
        let is_new = self.runner.decided() != Some(picture.stamp.seq);
        if is_new {
            self.now = picture.stamp.valid_ns;
            if self.runner.decided().is_none() {
                let now = self.now;
                self.front_seat().set_clock(now, utc::now_ns());
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
        let now = self.now;
        let mut burst = Vec::with_capacity(512);
        self.front_seat().telemetry(now, &mut burst);
        if burst.is_empty() {
            return;
        }
        self.sent += 1;
        for link in self.links.iter().flatten() {
            link.send(burst.clone(), self.sent);
        }
    }
}
