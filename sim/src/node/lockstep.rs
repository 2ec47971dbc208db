//! Lockstep: every tick waits for every mind, but never forever.

use super::booth::Booth;
use super::{News, NodeError, clock};
use std::time::{Duration, Instant};

/// After this time without an answer the pictures are sent again.
const SEND_AGAIN: Duration = Duration::from_millis(250);

/// Plays until the game is over or stopped.
pub(super) fn play(booth: &mut Booth<'_>, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    let mut due = clock::now();
    while !booth.contest.is_over() && !booth.is_stopped() {
        booth.bear_witness();
        booth.ask()?;
        booth.show()?;
        gather(booth, tell)?;
        if booth.tempo.is_held() {
            booth.stand_still(tell)?;
            // Somebody may have come to the door meanwhile.
            gather(booth, tell)?;
            due = clock::now();
        }
        booth.contest.advance();
        booth.tempo.played();
        booth.tell_progress(tell)?;
        due = keep_speed(booth, due, tell)?;
    }
    booth.bear_witness();
    Ok(())
}

/// Waits until a decision's time has passed at the speed that is not to be exceeded; gives the moment.
fn keep_speed(booth: &mut Booth<'_>, due: Instant, tell: &mut dyn FnMut(News<'_>)) -> Result<Instant, NodeError> {
    let Some(speed) = booth.tempo.speed() else { return Ok(due) };
    let decision_s = booth.contest.scenario().decision().as_s();
    let now = clock::now();
    // What was lost is lost.
    let due = (due + Duration::from_secs_f64(decision_s / speed)).max(now);
    // Somebody may ask for another speed, or for a pause, while it waits.
    while clock::now() < due && booth.tempo.speed() == Some(speed) && !booth.tempo.is_held() && !booth.is_stopped() {
        booth.listen(due.saturating_duration_since(clock::now()).min(Duration::from_millis(50)));
        booth.tell_progress(tell)?;
    }
    Ok(due.min(clock::now()))
}

/// Waits until everybody has answered the open tick; who takes longer than the scenario's patience is lost.
fn gather(booth: &mut Booth<'_>, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    let tick = booth.contest.decision();
    let patience = Duration::from_secs_f64(booth.contest.scenario().patience_s);
    // The clock is only looked at when somebody is slow.
    let mut waiting: Option<(Instant, Instant)> = None;
    while !booth.roster.all_answered(tick) && !booth.is_stopped() {
        let (since, sent) = *waiting.get_or_insert_with(|| (clock::now(), clock::now()));
        booth.listen(Duration::from_millis(50));
        if clock::since(since) >= patience {
            booth.give_up(tick);
        } else if clock::since(sent) >= SEND_AGAIN {
            booth.ask()?;
            booth.tell_progress(tell)?;
            waiting = Some((since, clock::now()));
        }
    }
    // Whoever came to the door or left meanwhile, in a game that waits for nobody.
    booth.listen(Duration::ZERO);
    Ok(())
}
