//! Lockstep: every decision waits for every agent, with a time limit.

use super::server::GameServer;
use super::settings::NodeError;
use crate::progress::ProgressMessage;
use bus::clock;
use std::time::{Duration, Instant};

/// Time without a reply after which the pictures are sent again.
// An interrupted link may have lost the picture or its reply, and both sides would wait forever.
const SEND_AGAIN: Duration = Duration::from_millis(250);

/// Plays until the game is over or stopped.
pub(super) fn play(
    server: &mut GameServer<'_>,
    tell: &mut dyn FnMut(ProgressMessage),
) -> Result<(), NodeError> {
    let mut due = clock::now();
    while !server.contest.is_over() && !server.is_stopped() {
        // Record before sending the pictures: then the recording of a decision is complete even if
        // the game is killed while agents compute.
        server.record();
        server.send_pictures()?;
        server.send_frame()?;
        gather(server, tell)?;
        if server.pacing.is_held() {
            server.stay_paused(tell)?;
            // Meanwhile, other nodes may have joined.
            gather(server, tell)?;
            due = clock::now();
        }
        // The game was stopped before all agents replied; their later replies do not count as late.
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

/// Waits until a decision has lasted as long as the speed limit requires. Returns the due time.
fn keep_speed(
    server: &mut GameServer<'_>,
    due: Instant,
    tell: &mut dyn FnMut(ProgressMessage),
) -> Result<Instant, NodeError> {
    let Some(speed) = server.pacing.speed else {
        return Ok(due);
    };
    let decision_s = server.contest.scenario().decision().as_s();
    let now = clock::now();
    // Lost time is not made up for.
    let due = (due + Duration::from_secs_f64(decision_s / speed)).max(now);
    // The speed may change, and the game may be paused, during the wait.
    while clock::now() < due
        && server.pacing.speed == Some(speed)
        && !server.pacing.is_held()
        && !server.is_stopped()
    {
        server.listen(
            due.saturating_duration_since(clock::now())
                .min(Duration::from_millis(50)),
        );
        server.report_progress(tell)?;
    }
    Ok(due.min(clock::now()))
}

/// Waits until all agents have replied to the open decision. Agents that exceed the time limit of
/// the scenario are lost.
fn gather(
    server: &mut GameServer<'_>,
    tell: &mut dyn FnMut(ProgressMessage),
) -> Result<(), NodeError> {
    let tick = server.contest.decision();
    let patience = Duration::from_secs_f64(server.contest.scenario().patience_s);
    // The time limit is measured in working time.
    let since = server.time.worked;
    let mut sent = clock::now();
    while !server.agents.all_answered(tick) && !server.is_stopped() {
        server.listen(Duration::from_millis(50));
        if server.time.worked.saturating_sub(since) >= patience {
            // Drop all agents that have not replied, so that the next decision waits for none of
            // them.
            server.give_up(tick);
        } else if clock::since(sent) >= SEND_AGAIN {
            server.send_pictures()?;
            server.report_progress(tell)?;
            sent = clock::now();
        }
    }
    // If all agents are lost, the loop has read nothing: handle nodes that joined or left
    // meanwhile.
    server.listen(Duration::ZERO);
    Ok(())
}
