//! Fault injection: whole games between the real nodes, over a simulated network in virtual time,
//! with random faults.
//!
//! Each game is determined by a single number. `SQUALL_FAULT_SEED=7 cargo test --release --test
//! fault_injection -- --nocapture` repeats game 7 and shows its events; `SQUALL_FAULT_GAMES=100000`
//! plays that many games, starting with number `SQUALL_FAULT_FROM`.
#![allow(
    clippy::disallowed_methods,
    clippy::print_stdout,
    reason = "measures games per minute by the clock, and prints the result"
)]

#[path = "../../gateway/tests/closed_loop/boat.rs"]
mod boat;
mod check;
mod gateway_node;
mod operator;
#[path = "../../gateway/tests/closed_loop/oracle.rs"]
#[allow(dead_code, reason = "the tests of the gateway use all of it")]
mod oracle;
mod page;
mod plan;
mod play;
mod real_boat;
mod stranger;
mod wire_monitor;

use check::faults_of;
use plan::Plan;
use play::{Played, play};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Default number of games.
const GAMES: u64 = 400;
/// Additional games with rare events: a gateway loses its game and must join again, and the first
/// message to a teammate is lost.
const SELDOM: [u64; 3] = [3152, 3690, 4172];
/// Number of failures after which the remaining games are skipped.
const FAILURES: usize = 5;

fn number(variable: &str) -> Option<u64> {
    let text = std::env::var(variable).ok()?;
    Some(
        text.parse()
            .unwrap_or_else(|_| panic!("{variable} is {text:?}, expected a whole number")),
    )
}

/// Combines the traces of all games, in any order: two builds that print the same value have played
/// the same games, message by message.
static TRACES: AtomicU64 = AtomicU64::new(0);

/// The error in the game of a seed, if any.
fn failure(seed: u64) -> Option<String> {
    let plan = Plan::drawn(seed);
    let played = play(&plan, false);
    TRACES.fetch_add(played.run.trace.wrapping_mul(seed | 1), Ordering::Relaxed);
    let wrong = faults_of(&plan, &played);
    let again = format!(
        "SQUALL_FAULT_SEED={seed} cargo test --release --test fault_injection -- --nocapture"
    );
    (!wrong.is_empty()).then(|| format!("seed {seed}:\n  {}\n  again: {again}", wrong.join("\n  ")))
}

/// Plays one game and prints all events.
fn show(seed: u64) {
    let plan = Plan::drawn(seed);
    let played = play(&plan, true);
    let Played {
        run, sim, agents, ..
    } = &played;
    run.lines.iter().for_each(|line| println!("{line}"));
    println!(
        "{plan:#?}\n{:#?}\nagents: {agents:?}\nends: {:#?}",
        sim.as_ref().map(|sim| sim.as_ref().map(|r| &r.run)),
        run.ends
    );
    if let Some(Ok(report)) = sim {
        report
            .outcome
            .events
            .iter()
            .for_each(|event| println!("{event:?}"));
    }
    let wrong = faults_of(&plan, &played);
    assert!(wrong.is_empty(), "seed {seed}: {wrong:#?}");
}

#[test]
fn games_keep_their_guarantees_under_any_network_faults() {
    if let Some(seed) = number("SQUALL_FAULT_SEED") {
        return show(seed);
    }
    let games = number("SQUALL_FAULT_GAMES").unwrap_or(GAMES);
    let from = number("SQUALL_FAULT_FROM").unwrap_or(0);
    let next = AtomicU64::new(from);
    let start = Instant::now();
    let failures =
        parking_lot::Mutex::new(SELDOM.into_iter().filter_map(failure).collect::<Vec<_>>());
    let work = || {
        while failures.lock().len() < FAILURES {
            let seed = next.fetch_add(1, Ordering::Relaxed);
            if seed >= from + games {
                break;
            }
            if let Some(failure) = failure(seed) {
                failures.lock().push(failure);
            }
        }
    };
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..workers).for_each(|_| drop(scope.spawn(work))));
    let took_s = start.elapsed().as_secs_f64();
    let played = next.load(Ordering::Relaxed).min(from + games) - from;
    println!(
        "{played} games in {took_s:.1} s: {:.0} per minute on {workers} cores",
        60.0 * played as f64 / took_s
    );
    println!("traces {:016x}", TRACES.load(Ordering::Relaxed));
    let failures = failures.into_inner();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn the_same_seed_is_the_same_run_to_the_last_message() {
    for seed in 0..12 {
        let plan = Plan::drawn(seed);
        let [one, other] = [(); 2].map(|()| play(&plan, true).run);
        assert_eq!(one.lines, other.lines, "seed {seed}");
        assert_eq!(one, other, "seed {seed}");
    }
    let [one, other] = [1, 2].map(|seed| play(&Plan::drawn(seed), false).run.trace);
    assert_ne!(one, other);
}
