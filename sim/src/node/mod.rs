//! The sim on the network: lets nodes join, paces the game and publishes it.
//!
//! [`serve`] plays one game from the first join to the last frame. [`Contest`], [`membership`],
//! [`agents`] and [`gateways`] make all decisions; this module contains the sockets and clocks.

pub mod agents;
mod control_inbox;
pub mod gateways;
mod lockstep;
pub mod membership;
mod message_inbox;
mod observers;
mod pacing;
mod realtime;
mod server;
mod settings;
mod subscriptions;
mod throttle;
mod working_time;

pub use crate::progress::{Progress, ProgressMessage, Report, Reporter, Run};
pub use crate::recorder::GameRecorder;
pub use settings::{NodeError, Pace, Settings};

use crate::contest::Contest;
use crate::spawn::NoStart;
use bus::clock;
use scenario::Scenario;
use server::GameServer;

/// Serves the game of `scenario` with this seed to its end. `recorder` records it.
///
/// # Errors
/// [`NodeError`] if the boats do not fit on the field, the network fails, or a lockstep game has
/// real boats, which cannot wait.
pub fn serve(
    scenario: &Scenario,
    seed: u64,
    settings: &Settings,
    recorder: Option<&mut GameRecorder>,
    tell: &mut dyn FnMut(ProgressMessage),
) -> Result<Report, NodeError> {
    if settings.pace == Pace::Lockstep {
        // A real boat does not wait while agents compute.
        scenario.has_no_real_boats().map_err(NoStart::from)?;
    }
    // Create the contest before the hub opens: a game whose boats do not fit is rejected before any
    // node joins.
    let contest = Contest::new(scenario, seed)?;
    let mut server = GameServer::open(contest, scenario, settings, recorder)?;
    tell(ProgressMessage::Open {
        game: settings.game.as_str().to_owned(),
        endpoint: settings.net.local_endpoint().unwrap_or_default(),
    });
    let mut started;
    loop {
        // Simulated time starts when all nodes are present: the start-up of programs is not
        // part of a game.
        server.wait_for_everybody(settings.join_limit, tell)?;
        tell(ProgressMessage::Started);
        started = clock::now();
        match settings.pace {
            Pace::Lockstep => lockstep::play(&mut server, tell)?,
            Pace::Realtime { .. } => realtime::play(&mut server, tell)?,
        }
        if !server.restart() {
            break;
        }
    }
    let cut_short = !server.contest.is_over();
    let wall_s = clock::since(started).as_secs_f64();
    // The result is final before the agents leave, because leaving is not part of the game.
    let outcome = server.contest.outcome();
    std::mem::take(&mut server.reporter).rest(&outcome, tell);
    server.shut_down()?;
    let overruns = server.overruns;
    let run = Run {
        pace: settings.pace.to_string(),
        wall_s,
        refused: server.refusals(),
        overruns,
        cut_short,
        ..Run::default()
    };
    Ok(Report { outcome, run })
}
