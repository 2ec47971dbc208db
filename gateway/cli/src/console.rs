//! `gateway console`: operator commands, line by line, over connections that stay open.

use super::log_line::full;
use super::tell::{ALL, CommandArg, Port, Words, real_boats, release_all, to_boat};
use anyhow::{Result, bail};
use bus::game_search::find_game;
use bus::stop::{StopClient, StopCommand, StopNews, StopOrders};
use bus::{Bus, Patience, SimState, SimWatch, Watched, clock};
use clap::Parser;
use command_line::leaf_args::LeafArgs;
use command_line::number::address;
use command_line::{program, stop, terminal};
use messages::external::OperatorReply;
use messages::topic::GameName;
use std::io::{BufRead, IsTerminal};
use std::net::SocketAddr;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Interval for reading this machine's registry and for looking for a missing game.
const LOOK_AGAIN: Duration = Duration::from_millis(250);
/// Number of failed attempts after which a new session is opened, in case the old one is broken.
const ATTEMPTS: u64 = 20;
/// The same timeouts as on the web page.
const PATIENCE: Patience = Patience {
    silence: Duration::from_secs(5),
    missing: Duration::from_secs(1),
    unheard: Duration::from_secs(1),
};
/// Maximum time to wait for unfinished stops when input ends.
const LAST: Duration = Duration::from_secs(5);
/// Polling interval for the end of the program.
const POLL: Duration = Duration::from_millis(100);

const HELP: &str = "\
  (empty line), estop     E-stops all boats
  all estop               the same; also: all disarm, all release, all status
  NAME estop              E-stops one boat; NAME disarm puts it in standby
  NAME arm, NAME release  like all other commands of `{gateway} tell`
  status                  prints the states of all boats, and the ages of their last reports
  quit                    exits, as does end of input
";

#[derive(clap::Args)]
#[command(after_help = program::text(concat!(
    "Reads commands from standard input, one per line, and prints the boats'\n",
    "reports with the time since each command:\n",
    "  blue_one  e-stopped  after 63 ms\n",
    "Type help for the commands. An empty line E-stops all boats.\n\n",
    "Exits with code 0 if every boat has confirmed all requested stops.\n\n",
    "Examples:\n",
    "  {gateway} console --game day\n",
    "  {gateway} console --connect tcp/10.0.0.5:7447 --gateway 10.0.0.21:7001\n",
    "  echo all estop | {gateway} console --game day",
)))]
pub struct Args {
    /// Address of a gateway's control port, as the gateway prints it; at most one per boat.
    /// Gateways on this machine and in the game are found without it
    #[arg(long, value_name = "HOST:PORT", value_parser = address)]
    gateway: Vec<SocketAddr>,
    #[command(flatten)]
    leaf: LeafArgs,
}

/// A line of input.
#[derive(Parser)]
#[command(
    no_binary_name = true,
    disable_help_flag = true,
    override_usage = "NAME COMMAND [ARGS], or help"
)]
struct Line {
    #[command(flatten)]
    words: Words,
}

/// The session in a game, with the game's name; `None` if there is no game.
type Session = Arc<Watched<Option<(Bus, GameName)>>>;

/// State shared by all threads.
#[derive(Clone)]
struct Console {
    client: Arc<StopClient>,
    session: Session,
    leaf: LeafArgs,
    is_over: Arc<AtomicBool>,
}

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let console = Console {
        client: Arc::new(StopClient::open(Duration::MAX)?),
        session: Session::default(),
        leaf: args.leaf.clone(),
        is_over: stop::on_ctrl_c()?,
    };
    let net = args.leaf.net()?;
    for at in &args.gateway {
        console.client.add_gateway(*at, None, net.token.clone())?;
    }
    if net.keys.is_none() {
        console
            .client
            .add_hub(&net.connect, args.leaf.game.as_ref(), net.token.as_ref())?;
    }
    let finder = console.clone();
    let printer = console.clone();
    let place = args.leaf.place()?;
    std::thread::spawn(move || finder.keep_game(&place));
    let printing = std::thread::spawn(move || printer.print_news());
    console.read_lines();
    let left = console.client.finish(LAST);
    console.is_over.store(true, Ordering::Relaxed);
    // Ignore the error: a thread that panicked prints nothing more.
    drop(printing.join());
    console
        .client
        .visit(StopOrders::take_news)
        .iter()
        .for_each(show);
    left.iter().for_each(|left| terminal::remark(left));
    Ok(if left.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

impl Console {
    /// Runs commands until the input ends, or the operator quits or presses Ctrl-C.
    fn read_lines(&self) {
        let is_terminal = std::io::stdin().is_terminal();
        let (sender, lines) = std::sync::mpsc::channel();
        // A thread that is waiting for input cannot be stopped; it ends with the process.
        std::thread::spawn(move || {
            for line in std::io::stdin().lock().split(b'\n').map_while(Result::ok) {
                if sender
                    .send(String::from_utf8_lossy(&line).trim().to_owned())
                    .is_err()
                {
                    return;
                }
            }
        });
        if is_terminal {
            terminal::print("type help for the commands; Enter alone E-stops all boats\n> ");
        }
        while !self.is_over.load(Ordering::Relaxed) {
            match lines.recv_timeout(POLL) {
                Ok(line) if line == "quit" => return,
                Ok(line) => self
                    .obey(&line)
                    .unwrap_or_else(|e| terminal::complain(&command_line::explain::line(&e))),
                Err(std::sync::mpsc::RecvTimeoutError::Timeout) => continue,
                Err(std::sync::mpsc::RecvTimeoutError::Disconnected) => return,
            }
            if is_terminal {
                terminal::print("> ");
            }
        }
    }

    fn obey(&self, line: &str) -> Result<()> {
        match line {
            "" | "estop" => self.client.stop(None, StopCommand::EStop),
            "help" => terminal::print(&program::text(HELP)),
            "status" => {
                terminal::print(&self.client.visit(|orders| boats_text(orders, clock::now())))
            }
            line => match Line::try_parse_from(line.split_whitespace()) {
                Ok(Line { words }) => self.command(words)?,
                Err(e) => bail!("{}", e.to_string().trim_end().trim_start_matches("error: ")),
            },
        }
        Ok(())
    }

    fn command(&self, words: Words) -> Result<()> {
        let command = words.command()?;
        let target = (words.vehicle != ALL).then_some(words.vehicle.as_str());
        if let Some(stop) = StopCommand::of(&command) {
            self.client.stop(target, stop);
            return Ok(());
        }
        // The new request takes precedence over unfinished stops.
        if words.command != CommandArg::Status {
            self.client.cancel(target);
        }
        let Some(name) = target.map(str::to_owned) else {
            return match words.command {
                CommandArg::Status => self.obey("status"),
                CommandArg::Release => {
                    self.leaf.check_one_game(&self.leaf.local_gateways(true))?;
                    self.release_all();
                    Ok(())
                }
                _ => bail!("`all` accepts only estop, disarm, release and status"),
            };
        };
        let console = self.clone();
        let asked = clock::now();
        // Ask on a separate thread: a slow answer must not delay other commands.
        std::thread::spawn(move || {
            let ports = console.ports();
            let session = console.session.visit(|session| session.clone());
            match to_boat(&ports, session.as_ref(), &name, &command) {
                Ok(OperatorReply {
                    refused: None,
                    status,
                }) if words.command == CommandArg::Status => {
                    terminal::show(&full(&status));
                }
                Ok(OperatorReply {
                    refused: None,
                    status,
                }) => tell(&name, brief(&status.state), asked),
                Ok(OperatorReply {
                    refused: Some(reason),
                    ..
                }) => terminal::complain(&format!("refused by {name}: {reason}")),
                Err(e) => {
                    terminal::complain(&format!("{name}: {}", command_line::explain::line(&e)))
                }
            }
        });
        Ok(())
    }

    fn release_all(&self) {
        let console = self.clone();
        let asked = clock::now();
        std::thread::spawn(move || {
            let session = console.session.visit(|session| session.clone());
            let failed = release_all(&console.ports(), session.as_ref());
            failed.iter().for_each(|failed| terminal::complain(failed));
            if failed.is_empty() {
                tell(ALL, "released", asked);
            }
        });
    }

    fn ports(&self) -> Vec<Port> {
        let known = self.client.gateways();
        known
            .into_iter()
            .map(|(at, vehicle, token)| Port { vehicle, at, token })
            .collect()
    }

    /// Keeps a session in the game and tracks this machine's gateways.
    fn keep_game(&self, place: &bus::Place) {
        let mut session = None;
        let mut said = String::new();
        let mut attempts = 0_u64;
        while !self.is_over.load(Ordering::Relaxed) {
            self.read_registry();
            match find_game(place, self.leaf.game.as_ref(), &mut session) {
                Ok((bus, game, info)) => {
                    said.clear();
                    match self.stay(&bus, &game, &real_boats(&info.scenario)) {
                        Ok(()) if self.is_over.load(Ordering::Relaxed) => {}
                        Ok(()) => terminal::remark(&format!(
                            "lost the connection to game {}; searching for it again",
                            game.as_str()
                        )),
                        Err(e) => terminal::remark(&e.to_string()),
                    }
                    bus.close();
                    session = None;
                }
                Err(missing) => {
                    // Even a permanent error may go away when a different game replaces this one.
                    let reason = missing.to_string();
                    if reason != said {
                        terminal::remark(&format!("no game: {reason}"));
                        said = reason;
                    }
                    attempts += 1;
                    if attempts.is_multiple_of(ATTEMPTS) {
                        session = None;
                    }
                }
            }
            clock::rest(LOOK_AGAIN);
        }
    }

    /// Stays in a game until it ends.
    fn stay(&self, bus: &Bus, game: &GameName, boats: &[String]) -> Result<(), bus::BusError> {
        let sim = SimWatch::open(bus, game, PATIENCE)?;
        self.client.join(bus, game, boats)?;
        self.session
            .visit(|session| *session = Some((bus.clone(), game.clone())));
        let boats = if boats.is_empty() {
            "no real boats".to_owned()
        } else {
            boats.join(", ")
        };
        terminal::remark(&format!("joined the game {}: {boats}", game.as_str()));
        while !self.is_over.load(Ordering::Relaxed) && sim.state() == SimState::Alive {
            self.read_registry();
            clock::rest(LOOK_AGAIN);
        }
        self.session.visit(|session| *session = None);
        self.client.leave();
        Ok(())
    }

    fn read_registry(&self) {
        let given = self.leaf.access.token().ok().flatten();
        for entry in self.leaf.local_gateways(true) {
            let token = given.clone().or_else(|| entry.token?.parse().ok());
            // If this fails, the next round tries again.
            drop(
                self.client
                    .add_gateway(entry.control, Some(&entry.vehicle), token),
            );
        }
    }

    fn print_news(&self) {
        while !self.is_over.load(Ordering::Relaxed) {
            self.client.news(POLL).iter().for_each(show);
        }
    }
}

/// Prints a line with the time since the request.
fn tell(name: &str, what: &str, asked: Instant) {
    terminal::print(&format!(
        "{name}  {what}  after {} ms\n",
        clock::since(asked).as_millis()
    ));
}

fn show(news: &StopNews) {
    terminal::print(&match news {
        StopNews::Done {
            vehicle,
            state,
            after,
            ..
        } => {
            format!(
                "{vehicle}  {}  after {} ms\n",
                brief(state),
                after.as_millis()
            )
        }
        StopNews::Late { vehicle, command } => {
            format!(
                "{vehicle}  has not confirmed {}; sending it again\n",
                command.operator_command()
            )
        }
        StopNews::Sim(Ok(after)) => format!("sim  confirmed  after {} ms\n", after.as_millis()),
        StopNews::Sim(Err(reason)) => format!("sim  {reason}\n"),
        StopNews::State { vehicle, state } => format!("{vehicle}  {state}\n"),
        StopNews::Silent { vehicle } => format!("{vehicle}  silent\n"),
    });
}

/// A state without the part in brackets.
fn brief(state: &str) -> &str {
    state.split(" (").next().unwrap_or(state)
}

fn boats_text(orders: &StopOrders, now: Instant) -> String {
    let boats = orders
        .boats()
        .map(|(name, boat)| match (&boat.state, boat.heard) {
            (Some(state), Some(heard)) => {
                let age_s = now.saturating_duration_since(heard).as_secs_f64();
                format!(
                    "{name}  {}, {age_s:.1} s ago\n",
                    if boat.is_silent { "silent" } else { state }
                )
            }
            _ => format!("{name}  no report yet\n"),
        });
    let text: String = boats.collect();
    if text.is_empty() {
        "no boats known yet\n".to_owned()
    } else {
        text
    }
}
