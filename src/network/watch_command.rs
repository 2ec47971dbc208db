//! `squall watch`: shows a running game, or one boat's helm, in the terminal.

use crate::screen;
use crate::stop;
use crate::style::Names;
use anyhow::{Result, bail};
use bus::{Watched, clock};
use command_line::leaf_args::LeafArgs;
use command_line::number::whole;
use command_line::observer::Observer;
use messages::{Frame, topic};
use primitives::{SimTime, codec};
use rules::event::Logged;
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use std::collections::VecDeque;
use std::io::IsTerminal;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

mod helm;
mod state;

#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    leaf: LeafArgs,
    /// Shows the mode, decision and behaviours of this vehicle's helm, instead of all boats
    #[arg(long, value_name = "NAME")]
    helm: Option<String>,
    /// Updates per second
    #[arg(long, value_name = "HZ", default_value_t = 5, value_parser = whole::<u8>(1, 30))]
    rate: u8,
}

/// Time without a frame after which to check whether the sim is still running.
const SILENCE: Duration = Duration::from_secs(3);
/// Number of events kept on the screen.
const EVENTS: usize = 6;

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c()?;
    stop::exit_when_late(&stop);
    let observer = Observer::connect(&args.leaf)?;
    let pause = Duration::from_secs_f64(1.0 / f64::from(args.rate));
    match &args.helm {
        Some(name) => helm::watch(&observer, name, pause, &stop)?,
        None => watch_boats(&observer, pause, &stop)?,
    }
    observer.bus.close();
    Ok(ExitCode::SUCCESS)
}

/// Data received from the game.
#[derive(Default)]
struct Seen {
    /// The newest frame; `None` once it has been shown.
    frame: Option<Frame>,
    /// Number of frames so far.
    count: u64,
    /// The newest events, oldest first.
    events: VecDeque<Logged>,
}

impl Seen {
    fn take(&mut self, scenario: &Scenario, bytes: &[u8]) {
        let Ok(frame) = codec::decode::<Frame>(bytes) else {
            return;
        };
        self.count += 1;
        self.events.extend(frame.logged(scenario));
        let surplus = self.events.len().saturating_sub(EVENTS);
        self.events.drain(..surplus);
        self.frame = Some(frame);
    }
}

/// Shows the boats at this interval until the game is over.
fn watch_boats(observer: &Observer, pause: Duration, stop: &AtomicBool) -> Result<()> {
    let Observer { bus, game, info } = observer;
    let seen = Arc::new(Watched::new(Seen::default()));
    let incoming = Arc::clone(&seen);
    let scenario = info.scenario.clone();
    let take = move |bytes: &[u8]| incoming.visit(|seen| seen.take(&scenario, bytes));
    let _frames = bus.subscribe(topic::frame(game), take)?;
    let mut meter = Meter::new();
    let names = Names::of(&info.scenario);
    let live = std::io::stdout().is_terminal();
    while !stop.load(Ordering::Relaxed) {
        seen.wait(SILENCE, |seen| seen.frame.is_some());
        let (frame, count, events) =
            seen.visit(|seen| (seen.frame.take(), seen.count, seen.events.clone()));
        let Some(frame) = frame else {
            // A paused game sends no frames.
            if stop.load(Ordering::Relaxed) || observer.is_on()? {
                continue;
            }
            bail!("game {} is no longer running", game.as_str());
        };
        let rates = meter.read(frame.stamp.valid_ns, count);
        let events: Vec<String> = events
            .iter()
            .map(|logged| sentence(&info.scenario, logged))
            .collect();
        let is_read = if live {
            screen::is_seen(&names.paint(&state::page(info, game, &frame, &events, &rates)))
        } else {
            screen::is_read(&state::line(&info.scenario, &frame, &rates))
        };
        if !is_read || frame.over {
            break;
        }
        clock::rest(pause);
    }
    Ok(())
}

fn sentence(scenario: &Scenario, logged: &Logged) -> String {
    let event = EventOutcome::new(scenario, logged);
    format!("{:>7.1} s  {}", event.at_s, event.sentence())
}

/// Measures frames and simulated seconds per second since the last reading.
struct Meter {
    then: Instant,
    /// Simulated time of the last reading; `None` before the first.
    sim: Option<SimTime>,
    frames: u64,
}

/// The rates that a meter reads.
pub(crate) struct Rates {
    /// Frames received per second.
    pub(crate) frames_hz: f64,
    /// Simulated seconds per second.
    pub(crate) factor: f64,
}

impl Meter {
    fn new() -> Meter {
        Meter {
            then: clock::now(),
            sim: None,
            frames: 0,
        }
    }

    fn read(&mut self, sim: SimTime, frames: u64) -> Rates {
        let passed_s = clock::since(self.then).as_secs_f64().max(1e-6);
        let sim_s = self.sim.map_or(0.0, |before| (sim - before).as_s());
        let rates = Rates {
            frames_hz: (frames - self.frames) as f64 / passed_s,
            factor: sim_s / passed_s,
        };
        *self = Meter {
            then: clock::now(),
            sim: Some(sim),
            frames,
        };
        rates
    }
}
