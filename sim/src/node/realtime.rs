//! Real time, or a factor of it: the clock paces, nobody is waited for, old orders expire.

use super::booth::Booth;
use super::{News, NodeError, clock};
use game::VehicleId;
use std::time::Duration;

/// Plays until the game is over or stopped, and counts the decision ticks that began late.
pub(super) fn play(booth: &mut Booth<'_>, tell: &mut dyn FnMut(News<'_>)) -> Result<(), NodeError> {
    let mut due = clock::now() + period(booth);
    while !booth.contest.is_over() && !booth.is_stopped() {
        booth.bear_witness();
        booth.ask()?;
        booth.show()?;
        // Listens until the next tick is due, and at least once.
        loop {
            booth.listen(due.saturating_duration_since(clock::now()));
            if clock::now() >= due {
                break;
            }
        }
        let period = period(booth);
        if booth.tempo.is_held() {
            booth.stand_still(tell)?;
            due = clock::now();
        }
        let late = clock::since(due);
        if late > period {
            // What is lost is lost: the game runs slower than asked, and says so.
            booth.overruns += 1;
            due = clock::now();
        }
        due += period;
        expire(booth);
        booth.contest.advance();
        booth.tempo.played();
        booth.tell_progress(tell)?;
    }
    booth.bear_witness();
    Ok(())
}

/// The wall-clock time between two decisions.
fn period(booth: &Booth<'_>) -> Duration {
    let decision_s = booth.contest.scenario().decision().as_s();
    Duration::from_secs_f64(decision_s / booth.tempo.speed().unwrap_or(1.0))
}

/// Boats whose order is too old hold; minds that are silent for longer than patience are lost.
fn expire(booth: &mut Booth<'_>) {
    let now = booth.contest.now();
    let (ttl_s, patience_s) = (booth.contest.scenario().order_ttl_s, booth.contest.scenario().patience_s);
    for i in 0..booth.ordered_at.len() {
        if (now - booth.ordered_at[i]).as_s() > ttl_s {
            booth.contest.hold(VehicleId::at(i));
        }
    }
    booth.lose_silent(Duration::from_secs_f64(patience_s));
}
