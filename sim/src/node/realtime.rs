//! Real time, or a factor of it: the clock paces, nobody is waited for, old orders expire.

use super::booth::Booth;
use super::{News, NodeError, clock};
use game::VehicleId;
use std::time::Duration;

/// Plays until the game is over or stopped; gives the number of decision ticks that began late.
pub(super) fn play(booth: &mut Booth, factor: f64, tell: &mut dyn FnMut(News<'_>)) -> Result<u64, NodeError> {
    let scenario = booth.contest.scenario();
    let period = (scenario.tick * i64::from(scenario.ticks_per_decision)).as_s() / factor;
    let period = Duration::from_secs_f64(period);
    let mut due = clock::now() + period;
    let mut overruns = 0;
    while !booth.contest.is_over() && !booth.is_stopped() {
        booth.ask()?;
        booth.show()?;
        // Listens until the next tick is due, and at least once.
        loop {
            booth.listen(due.saturating_duration_since(clock::now()));
            if clock::now() >= due {
                break;
            }
        }
        let late = clock::since(due);
        if late > period {
            // What is lost is lost: the game runs slower than asked, and says so.
            overruns += 1;
            due = clock::now();
        }
        due += period;
        expire(booth);
        booth.contest.advance();
        booth.tell_progress(tell);
    }
    Ok(overruns)
}

/// Boats whose order is too old hold; minds that are silent for longer than patience are lost.
fn expire(booth: &mut Booth) {
    let now = booth.contest.now();
    let (ttl_s, patience_s) = (booth.contest.scenario().order_ttl_s, booth.contest.scenario().patience_s);
    for i in 0..booth.ordered_at.len() {
        if (now - booth.ordered_at[i]).as_s() > ttl_s {
            booth.contest.hold(VehicleId::at(i));
        }
    }
    booth.lose_silent(Duration::from_secs_f64(patience_s));
}
