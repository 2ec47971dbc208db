//! The operator's stop client: sends stops on all available paths, and receives the states of
//! boats.

use super::datagram::States;
use super::gateway_link::{Asked, DatagramPath, GatewayPath, OnNews, PathNews};
use super::orders::{Saying, Source, StopOrders};
use super::{StopCommand, StopNews, StopTopics};
use crate::net::address;
use crate::{Bus, BusError, CurrentToken, Publisher, Token, Watched, clock, control, start_thread};
use messages::Control;
use messages::external::{FleetCommand, GatewayCommand, GatewayStatus, OperatorCommand};
use messages::topic::GameName;
use parking_lot::Mutex;
use std::collections::BTreeMap;
use std::io;
use std::net::{SocketAddr, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Weak};
use std::time::{Duration, Instant};

/// Interval at which the status is requested on every path.
const STATUS_AGAIN: Duration = Duration::from_secs(1);
/// Maximum wait for a game that is slow to answer, once all known boats have stopped.
const GAME_MAX: Duration = Duration::from_secs(3);
/// Maximum number of control ports.
const GATEWAYS_MAX: usize = 256;

/// Stops boats. Closes its paths when dropped.
pub struct StopClient(Arc<Shared>);

/// The state shared by the client's threads.
struct Shared {
    orders: Watched<StopOrders>,
    game: Mutex<Option<Arc<StopTopics>>>,
    gateways: Mutex<BTreeMap<SocketAddr, GatewayPath>>,
    /// Control ports named in statuses but not yet opened.
    named: Mutex<BTreeMap<SocketAddr, String>>,
    hubs: Mutex<Vec<DatagramPath>>,
    is_closing: AtomicBool,
}

impl StopClient {
    /// A client without paths. It repeats a stop until the boats report it, for up to `limit`.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub fn open(limit: Duration) -> io::Result<StopClient> {
        let shared = Arc::new(Shared {
            orders: Watched::new(StopOrders::new(limit)),
            game: Mutex::default(),
            gateways: Mutex::default(),
            named: Mutex::default(),
            hubs: Mutex::default(),
            is_closing: AtomicBool::new(false),
        });
        let at_work = Arc::clone(&shared);
        // A lost TCP packet costs at least 200 ms, and opening a zenoh session five round trips;
        // datagrams and open connections cost only a one-way trip. So all paths are opened before
        // the button is pressed.
        start_thread("stop-client", move || at_work.run())?;
        Ok(StopClient(shared))
    }

    /// Adds a path: a gateway's control port, with its token. A port already known gets the new
    /// token.
    ///
    /// # Errors
    /// If the system cannot provide a socket or thread, or if there are too many ports.
    pub fn add_gateway(
        &self,
        at: SocketAddr,
        vehicle: Option<&str>,
        token: Option<Token>,
    ) -> io::Result<()> {
        self.0.add_gateway(at, vehicle, token)
    }

    /// Adds a path: datagrams to a sim that listens at these endpoints.
    ///
    /// # Errors
    /// If the system cannot provide a socket or thread. Endpoints that do not use TCP or whose host
    /// is unknown are skipped.
    pub fn add_hub(
        &self,
        endpoints: &[String],
        game: Option<&GameName>,
        token: Option<&Token>,
    ) -> io::Result<()> {
        // With keys there are no datagrams: they do not identify their senders, and every node in
        // such a game has a link anyway.
        for endpoint in endpoints
            .iter()
            .filter(|endpoint| endpoint.starts_with("tcp/"))
        {
            let found = address(endpoint)
                .to_socket_addrs()
                .ok()
                .and_then(|mut found| found.next());
            let Some(at) = found else { continue };
            let shared = Arc::downgrade(&self.0);
            let on_news: OnNews = Arc::new(move |news| {
                if let (Some(shared), PathNews::States(states, asked)) = (shared.upgrade(), news) {
                    shared.hub_answered(&states, asked.at);
                }
            });
            let game = game.map(|game| game.as_str().to_owned());
            let path = DatagramPath::open(at, game, token.cloned().into(), on_news)?;
            self.0.hubs.lock().push(path);
        }
        // A path that opens during a stop sends it immediately, not at the next repeat.
        self.0.orders.visit(StopOrders::hurry);
        Ok(())
    }

    /// Adds a path: the topics of a game with these real boats, replacing those of the previous
    /// game.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn join(&self, bus: &Bus, game: &GameName, boats: &[String]) -> Result<(), BusError> {
        let shared = Arc::downgrade(&self.0);
        let is_here = bus.is_on_this_machine;
        let path = StopTopics::open(bus, game, boats, move |status| {
            shared
                .upgrade()
                .iter()
                .for_each(|shared| shared.hear(&status, is_here));
        })?;
        let before = self.0.game.lock().replace(Arc::new(path));
        // A callback of the dropped subscription may still be running, so hold no lock here.
        drop(before);
        let unanswered = self.0.orders.visit(|orders| {
            boats.iter().for_each(|boat| orders.expect(boat));
            orders.complete();
            orders.hurry();
            orders.unanswered()
        });
        unanswered.into_iter().for_each(|stop| self.0.ask_sim(stop));
        Ok(())
    }

    /// Removes the path of the game, after the game or its session has ended.
    pub fn leave(&self) {
        let path = self.0.game.lock().take();
        drop(path);
    }

    /// Stops one boat or all boats; replaces an earlier stop of the same kind and target.
    pub fn stop(&self, target: Option<&str>, command: StopCommand) {
        let now = clock::now();
        let number = self
            .0
            .orders
            .visit(|orders| orders.ask(now, target.map(str::to_owned), command));
        // The client's thread sends the stop: the caller may hold a lock, and sending takes time.
        if target.is_none() && command == StopCommand::EStop {
            self.0.ask_sim(number);
        }
    }

    /// Reads or changes the known boats and stops.
    pub fn visit<R>(&self, visit: impl FnOnce(&mut StopOrders) -> R) -> R {
        self.0.orders.visit(visit)
    }

    /// Waits up to `limit` until `holds`; returns whether it does.
    pub fn wait(&self, limit: Duration, holds: impl FnMut(&StopOrders) -> bool) -> bool {
        self.0.orders.wait(limit, holds)
    }

    /// Waits up to `limit` until every stop is done; returns the unfinished ones. Call it after the
    /// last request. Without a game that names its boats, only the known boats count.
    pub fn finish(&self, limit: Duration) -> Vec<String> {
        let start = clock::now();
        // The sim's answer proves nothing: the sim may be suspended while all boats have stopped,
        // or answer while one has not. Only the boats' own states count.
        self.wait(limit.min(GAME_MAX), |orders| orders.is_done(clock::now()));
        self.wait(limit.saturating_sub(clock::since(start)), |orders| {
            orders.unfinished().is_empty()
        });
        self.visit(|orders| orders.unfinished())
    }

    /// Ends the repeats of earlier stops of one boat or all boats, because of a newer command.
    pub fn cancel(&self, target: Option<&str>) {
        self.visit(|orders| orders.cancel(target));
    }

    /// The known control ports, with their boats and tokens.
    pub fn gateways(&self) -> Vec<(SocketAddr, Option<String>, Option<Token>)> {
        let gateways = self.0.gateways.lock();
        let known = gateways
            .iter()
            .map(|(at, gateway)| (*at, gateway.vehicle.lock().clone(), gateway.token.get()));
        known.collect()
    }

    /// Waits up to `limit` for news and returns it.
    pub fn news(&self, limit: Duration) -> Vec<StopNews> {
        self.0.orders.wait(limit, |orders| !orders.news.is_empty());
        self.0.orders.visit(StopOrders::take_news)
    }
}

impl Drop for StopClient {
    fn drop(&mut self) {
        self.0.is_closing.store(true, Ordering::SeqCst);
        self.0.orders.visit(StopOrders::hurry);
        self.leave();
        let gateways = std::mem::take(&mut *self.0.gateways.lock());
        let hubs = std::mem::take(&mut *self.0.hubs.lock());
        // All of them end concurrently.
        gateways.values().for_each(GatewayPath::close);
        hubs.iter().for_each(DatagramPath::close);
    }
}

impl Shared {
    /// Repeats stops when due, until closed.
    fn run(self: &Arc<Self>) {
        let mut status_at = clock::now();
        while !self.is_closing.load(Ordering::SeqCst) {
            let now = clock::now();
            self.say(now);
            let named = std::mem::take(&mut *self.named.lock());
            for (at, vehicle) in named {
                let token = self
                    .game
                    .lock()
                    .as_ref()
                    .and_then(|game| game.bus.token.clone());
                // The next status names the port again.
                drop(self.add_gateway(at, Some(&vehicle), token));
            }
            // The answer to a stop includes the boat's state.
            if now >= status_at
                && !self
                    .orders
                    .visit(|orders| orders.is_asked_within(now, STATUS_AGAIN))
            {
                status_at = now + STATUS_AGAIN;
                self.ask_status();
            }
            let (next, changes) = self
                .orders
                .visit(|orders| (orders.next(now), orders.changes));
            let wait = next.saturating_duration_since(clock::now());
            self.orders.wait(wait, |orders| orders.changes != changes);
        }
    }

    fn add_gateway(
        self: &Arc<Self>,
        at: SocketAddr,
        vehicle: Option<&str>,
        token: Option<Token>,
    ) -> io::Result<()> {
        let mut gateways = self.gateways.lock();
        if let Some(gateway) = gateways.get(&at) {
            if token.is_some() {
                gateway.token.set(token);
            }
            return Ok(());
        }
        if gateways.len() >= GATEWAYS_MAX {
            return Err(io::Error::other(format!(
                "more than {GATEWAYS_MAX} gateways"
            )));
        }
        // Until the boat is known, the address serves as its name.
        let expected = vehicle.map_or_else(|| at.to_string(), str::to_owned);
        self.orders.visit(|orders| orders.expect(&expected));
        let shared = Arc::downgrade(self);
        let unnamed = vehicle.is_none().then_some(expected);
        let on_news: OnNews = Arc::new(move |news| gateway_said(&shared, unnamed.as_deref(), news));
        let gateway = GatewayPath::open(
            at,
            vehicle.map(str::to_owned),
            CurrentToken::from(token),
            on_news,
        )?;
        gateways.insert(at, gateway);
        drop(gateways);
        self.orders.visit(StopOrders::hurry);
        Ok(())
    }

    /// Requests the states of boats on every path.
    fn ask_status(&self) {
        let ask = |name: String| GatewayCommand::Boat {
            name,
            command: OperatorCommand::Status,
        };
        for gateway in self.gateways.lock().values() {
            let vehicle = gateway.vehicle.lock().clone().unwrap_or_default();
            gateway.send(&ask(vehicle), 0);
        }
        self.hubs
            .lock()
            .iter()
            .for_each(|hub| hub.send(&ask(String::new()), 0));
    }

    /// Sends stops that are due, on the fastest paths first.
    fn say(&self, now: Instant) {
        for saying in self.orders.visit(|orders| orders.due(now)) {
            self.say_to_hubs(&saying);
            self.say_to_game(&saying);
            for gateway in self.gateways.lock().values() {
                let vehicle = gateway.vehicle.lock().clone();
                let is_open = vehicle
                    .as_ref()
                    .is_none_or(|vehicle| saying.boats.contains(vehicle));
                if let Some(command) = saying.command_to(vehicle.as_deref()).filter(|_| is_open) {
                    gateway.send(&command, saying.number);
                }
            }
        }
    }

    fn say_to_hubs(&self, saying: &Saying) {
        let hubs = self.hubs.lock();
        if saying.to_everybody && saying.command == StopCommand::EStop {
            hubs.iter().for_each(|hub| {
                hub.send(&GatewayCommand::Fleet(FleetCommand::EStop), saying.number)
            });
            return;
        }
        // On this path, a fleet-wide E-stop cannot be sent to individual boats.
        let boats = saying
            .boats
            .iter()
            .filter(|_| saying.command == StopCommand::Disarm || !saying.is_of_fleet);
        for command in boats.filter_map(|boat| saying.command_to(Some(boat))) {
            hubs.iter()
                .for_each(|hub| hub.send(&command, saying.number));
        }
    }

    fn say_to_game(&self, saying: &Saying) {
        // Hold no lock while messages go out.
        let Some(game) = self.game.lock().clone() else {
            return;
        };
        let send = |publisher: &Publisher, json: Vec<u8>| drop(publisher.send_json(json));
        if saying.to_everybody && saying.command == StopCommand::EStop {
            send(
                &game.control,
                serde_json::to_vec(&Control::EStop).unwrap_or_default(),
            );
        }
        let command = match saying.command_to(None) {
            Some(command @ GatewayCommand::Fleet(_)) => serde_json::to_vec(&command),
            _ => serde_json::to_vec(&saying.command.operator_command()),
        };
        let command = command.unwrap_or_default();
        for publisher in saying.boats.iter().filter_map(|boat| game.stops.get(boat)) {
            send(publisher, command.clone());
        }
    }

    /// Asks the sim to stop all boats, and waits for its answer: the sim stops the boats that it
    /// simulates.
    fn ask_sim(self: &Arc<Self>, stop: u64) {
        let game = self
            .game
            .lock()
            .as_ref()
            .map(|game| (game.bus.clone(), game.game.clone()));
        let Some((bus, name)) = game else { return };
        let shared = Arc::downgrade(self);
        let asked = start_thread("stop-sim", move || {
            let answer = control(&bus, &name, Control::EStop).map_err(|e| e.to_string());
            if let Some(shared) = shared.upgrade() {
                shared
                    .orders
                    .visit(|orders| orders.sim_answered(clock::now(), stop, answer));
            }
        });
        if let Err(e) = asked {
            self.orders.visit(|orders| {
                orders.sim_answered(
                    clock::now(),
                    stop,
                    Err(format!("cannot start a thread: {e}")),
                )
            });
        }
    }

    /// Handles a published status; `is_here` means that the game runs on this machine.
    fn hear(&self, status: &GatewayStatus, is_here: bool) {
        self.orders.visit(|orders| {
            let now = clock::now();
            let as_of = orders.as_of(now, &status.vehicle, status.at_s);
            orders.report(
                now,
                &status.vehicle,
                &status.state,
                Source::Published(as_of),
            );
        });
        let control = status
            .control
            .as_ref()
            .and_then(|control| control.parse::<SocketAddr>().ok());
        // A loopback address may belong to a different machine.
        let control =
            control.filter(|at| !at.ip().is_unspecified() && (is_here || !at.ip().is_loopback()));
        let mut named = self.named.lock();
        if let Some(at) = control.filter(|_| named.len() < GATEWAYS_MAX) {
            named.insert(at, status.vehicle.clone());
        }
    }

    fn hub_answered(&self, states: &States, asked: Instant) {
        self.orders.visit(|orders| {
            for (vehicle, (state, age_ms)) in states {
                orders.expect(vehicle);
                if !state.is_empty() {
                    // Assume that the request arrived instantly: the sim had then received the
                    // state `age_ms` before `asked`.
                    let as_of = asked
                        .checked_sub(Duration::from_millis(*age_ms))
                        .unwrap_or(asked);
                    orders.report(clock::now(), vehicle, state, Source::Relayed(as_of));
                }
            }
            orders.complete();
        });
    }
}

/// Handles news from a gateway; its boat is called `unnamed` until it is known.
fn gateway_said(shared: &Weak<Shared>, unnamed: Option<&str>, news: PathNews) {
    let Some(shared) = shared.upgrade() else {
        return;
    };
    shared.orders.visit(|orders| match news {
        PathNews::Connected => orders.hurry(),
        PathNews::States(states, Asked { stop, at }) => {
            unnamed.iter().for_each(|name| orders.forget(name));
            let source = if stop == 0 {
                Source::Published(at)
            } else {
                Source::Answer(stop)
            };
            for (vehicle, (state, _)) in &states {
                orders.report(clock::now(), vehicle, state, source);
            }
        }
    });
}

impl Saying {
    /// The command for the gateway of `vehicle`. If the vehicle is unknown, a stop of one boat is
    /// sent under that boat's name; a fleet-wide disarm cannot be sent (`None`).
    fn command_to(&self, vehicle: Option<&str>) -> Option<GatewayCommand> {
        if self.is_of_fleet && self.command == StopCommand::EStop {
            return Some(GatewayCommand::Fleet(FleetCommand::EStop));
        }
        let name = vehicle
            .or_else(|| {
                self.boats
                    .first()
                    .map(String::as_str)
                    .filter(|_| !self.is_of_fleet)
            })?
            .to_owned();
        Some(GatewayCommand::Boat {
            name,
            command: self.command.operator_command(),
        })
    }
}
