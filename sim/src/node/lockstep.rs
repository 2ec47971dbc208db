//! Lockstep: every tick waits for every mind, but never forever.

use super::booth::Booth;
use super::{News, NodeError, clock};
use std::time::{Duration, Instant};

/// After this time without an answer the pictures are sent again.
const SEND_AGAIN: Duration = Duration::from_millis(250);

/// Plays until the game is over or stopped.
pub(super) fn play(booth: &mut Booth, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    while !booth.contest.is_over() && !booth.is_stopped() {
        booth.ask()?;
        booth.show()?;
        gather(booth, tell)?;
        booth.contest.advance();
        booth.tell_progress(tell);
    }
    Ok(())
}

/// Waits until everybody has answered the open tick; who takes longer than the scenario's patience is lost.
fn gather(booth: &mut Booth, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
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
            booth.tell_progress(tell);
            waiting = Some((since, clock::now()));
        }
    }
    // Whoever came to the door or left meanwhile, in a game that waits for nobody.
    booth.listen(Duration::ZERO);
    Ok(())
}
