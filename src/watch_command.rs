//! `squall watch`: a running game in the terminal, or what one boat's helm thinks.

use crate::net_args::LeafArgs;
use crate::observer::Observer;
use crate::screen;
use crate::stop;
use anyhow::{Result, bail};
use bus::Latest;
use game::codec;
use game::message::Frame;
use game::outcome::EventOutcome;
use game::topic;
use game::{Scenario, SimTime};
use std::collections::VecDeque;
use std::io::IsTerminal;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

mod chart;
mod helm;

/// Which game, and where.
#[derive(clap::Args)]
pub(crate) struct Args {
    #[command(flatten)]
    leaf: LeafArgs,
    /// Shows what this vehicle's helm thinks instead of the field
    #[arg(long, value_name = "NAME")]
    helm: Option<String>,
    /// Pictures a second
    #[arg(long, value_name = "HZ", default_value_t = 5, value_parser = clap::value_parser!(u8).range(1..=30))]
    rate: u8,
}

/// A game without a frame for this long is gone.
const SILENCE: Duration = Duration::from_secs(10);
/// Events that stay on the screen.
const EVENTS: usize = 6;

pub(crate) fn run(args: &Args) -> Result<ExitCode> {
    let stop = stop::on_ctrl_c()?;
    let observer = Observer::come(&args.leaf)?;
    let pause = Duration::from_secs_f64(1.0 / f64::from(args.rate));
    match &args.helm {
        Some(name) => helm::watch(&observer, name, pause, &stop)?,
        None => watch_field(&observer, pause, &stop)?,
    }
    observer.bus.close();
    Ok(ExitCode::SUCCESS)
}

/// Shows the field until the game is over, this often.
fn watch_field(Observer { bus, game, notice }: &Observer, pause: Duration, stop: &AtomicBool) -> Result<()> {
    let frames: Arc<Latest<Frame>> = Arc::new(Latest::new(1));
    let events: Arc<Latest<Frame>> = Arc::clone(&frames);
    let count = Arc::new(AtomicU64::new(0));
    let counter = Arc::clone(&count);
    let news = Arc::new(std::sync::Mutex::new(VecDeque::new()));
    let inbox = Arc::clone(&news);
    let scenario = notice.scenario.clone();
    let take = move |bytes: &[u8]| {
        counter.fetch_add(1, Ordering::Relaxed);
        if let Ok(frame) = codec::decode::<Frame>(bytes) {
            let mut queue = inbox.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            queue.extend(frame.logged(&scenario));
            let surplus = queue.len().saturating_sub(EVENTS);
            queue.drain(..surplus);
            events.put(0, frame);
        }
    };
    let _standing = bus.subscribe(topic::frame(game), take)?;
    let mut meter = Meter::new();
    let live = std::io::stdout().is_terminal();
    while !stop.load(Ordering::Relaxed) {
        let Some(frame) = frames.take(SILENCE).pop().flatten() else { bail!("game {} is gone", game.as_str()) };
        let rates = meter.read(frame.stamp.valid_ns, count.load(Ordering::Relaxed));
        let queue = news.lock().unwrap_or_else(std::sync::PoisonError::into_inner).clone();
        let told: Vec<String> = queue.iter().map(|logged| sentence(&notice.scenario, logged)).collect();
        let text = if live {
            format!("\x1b[H\x1b[J{}", chart::page(notice, game, &frame, &told, &rates))
        } else {
            chart::line(&notice.scenario, &frame, &rates)
        };
        if !screen::is_read(&text) || frame.over {
            break;
        }
        rest(pause);
    }
    Ok(())
}

fn sentence(scenario: &Scenario, logged: &game::event::Logged) -> String {
    let event = EventOutcome::new(scenario, logged);
    format!("{:>7.1} s  {}", event.at_s, event.sentence())
}

/// Frames and simulated seconds a second, since the last reading.
struct Meter {
    then: Instant,
    /// Nothing before the first reading.
    sim: Option<SimTime>,
    frames: u64,
}

/// What a meter reads.
pub(crate) struct Rates {
    /// Frames received a second.
    pub(crate) frames_hz: f64,
    /// Simulated seconds a second.
    pub(crate) factor: f64,
}

#[expect(clippy::disallowed_methods, reason = "rates are read by the clock")]
impl Meter {
    fn new() -> Meter {
        Meter { then: Instant::now(), sim: None, frames: 0 }
    }

    fn read(&mut self, sim: SimTime, frames: u64) -> Rates {
        let passed_s = self.then.elapsed().as_secs_f64().max(1e-6);
        let sim_s = self.sim.map_or(0.0, |before| (sim - before).as_s());
        let rates = Rates { frames_hz: (frames - self.frames) as f64 / passed_s, factor: sim_s / passed_s };
        *self = Meter { then: Instant::now(), sim: Some(sim), frames };
        rates
    }
}

#[expect(clippy::disallowed_methods, reason = "a person reads only so many pictures a second")]
fn rest(time: Duration) {
    std::thread::sleep(time);
}
