//! Real time or a multiple of it: the clock sets the pace, and the game does not wait for nodes.

use super::server::GameServer;
use super::settings::NodeError;
use crate::progress::ProgressMessage;
use bus::clock;
use std::time::Duration;

/// Plays until the game is over or stopped. Counts the decisions that began late.
pub(super) fn play(
    server: &mut GameServer<'_>,
    tell: &mut dyn FnMut(ProgressMessage),
) -> Result<(), NodeError> {
    let mut due = clock::now() + period(server);
    while !server.contest.is_over() && !server.is_stopped() {
        server.record();
        server.send_pictures()?;
        server.send_frame()?;
        // Listens until the next decision is due, and at least once.
        loop {
            server.listen(due.saturating_duration_since(clock::now()));
            if clock::now() >= due {
                break;
            }
        }
        let period = period(server);
        if server.pacing.is_held() {
            server.stay_paused(tell)?;
            due = clock::now();
        }
        let late = clock::since(due);
        if late > period {
            // Lost time is not made up for: the game runs slower than requested and reports it.
            server.overruns += 1;
            due = clock::now();
        }
        due += period;
        // In real time, silence is measured from an agent's last message.
        server.lose_silent();
        server.contest.advance();
        server.pacing.played();
        server.report_progress(tell)?;
    }
    server.record();
    Ok(())
}

/// The wall-clock time between two decisions.
fn period(server: &GameServer<'_>) -> Duration {
    let decision_s = server.contest.scenario().decision().as_s();
    Duration::from_secs_f64(decision_s / server.pacing.speed.unwrap_or(1.0))
}
