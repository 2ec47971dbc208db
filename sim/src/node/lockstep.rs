//! Lockstep: every tick waits for every agent, but never forever.

use super::server::GameServer;
use super::{NodeError, ProgressMessage};
use bus::clock;
use std::time::{Duration, Instant};

/// After this time without an answer the pictures are sent again.
// A link that is cut and comes back may have lost the picture or its answer, and both sides
// would wait for ever.
const SEND_AGAIN: Duration = Duration::from_millis(250);

/// Plays until the game is over or stopped.
pub(super) fn play(server: &mut GameServer<'_>, tell: &mut dyn FnMut(ProgressMessage)) -> Result<(), NodeError> {
    let mut due = clock::now();
    while !server.contest.is_over() && !server.is_stopped() {
        // Before the pictures: what is recorded of a decision is complete even if the game is
        // killed while agents think.
        server.record();
        server.send_pictures()?;
        server.send_frame()?;
        gather(server, tell)?;
        if server.pacing.is_held() {
            server.stay_paused(tell)?;
            // Somebody may have joined meanwhile.
            gather(server, tell)?;
            due = clock::now();
        }
        // Not everybody has answered: what comes now is not late.
        if server.is_stopped() {
            break;
        }
        server.contest.advance();
        server.pacing.played();
        server.report_progress(tell)?;
        due = keep_speed(server, due, tell)?;
    }
    server.record();
    Ok(())
}

/// Waits until a decision's time has passed at the speed that is not to be exceeded; gives the moment.
fn keep_speed(
    server: &mut GameServer<'_>,
    due: Instant,
    tell: &mut dyn FnMut(ProgressMessage),
) -> Result<Instant, NodeError> {
    let Some(speed) = server.pacing.speed() else { return Ok(due) };
    let decision_s = server.contest.scenario().decision().as_s();
    let now = clock::now();
    // What was lost is lost.
    let due = (due + Duration::from_secs_f64(decision_s / speed)).max(now);
    // Somebody may ask for another speed, or for a pause, while it waits.
    while clock::now() < due && server.pacing.speed() == Some(speed) && !server.pacing.is_held() && !server.is_stopped()
    {
        server.listen(due.saturating_duration_since(clock::now()).min(Duration::from_millis(50)));
        server.report_progress(tell)?;
    }
    Ok(due.min(clock::now()))
}

/// Waits until everybody has answered the open tick; who takes longer than the scenario's patience is lost.
fn gather(server: &mut GameServer<'_>, tell: &mut dyn FnMut(ProgressMessage)) -> Result<(), NodeError> {
    let tick = server.contest.decision();
    let patience = Duration::from_secs_f64(server.contest.scenario().patience_s);
    // Patience goes by the time that the sim is at work.
    let since = server.time.worked();
    let mut sent = clock::now();
    while !server.agents.all_answered(tick) && !server.is_stopped() {
        server.listen(Duration::from_millis(50));
        if server.time.worked().saturating_sub(since) >= patience {
            // All that have not answered, at once: the next decision waits for none of them.
            server.give_up(tick);
        } else if clock::since(sent) >= SEND_AGAIN {
            server.send_pictures()?;
            server.report_progress(tell)?;
            sent = clock::now();
        }
    }
    // Whoever joined or left meanwhile, in a game that waits for nobody.
    server.listen(Duration::ZERO);
    Ok(())
}
