//! What the search for rare failures gains over brute force, in the same run: as many games of `sweeps/compass.toml`, drawn evenly; and what of that is the splitting.
//!
//! `cargo bench -p squall-sweep --bench find -- [GAMES] [CONDITION]`, by default 1000 games and `strategy_5.out_of_bounds > 0`.

use scenario::load_sweep;
use std::num::NonZeroUsize;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use sweep::{Condition, Found, Journal, Plan, Search, find};

#[expect(clippy::print_stdout, reason = "this is a program")]
fn main() {
    // Cargo itself says `--bench`.
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    let games = words.first().and_then(|word| word.parse().ok()).unwrap_or(1000_usize).max(20);
    let condition = words.get(1).map_or("strategy_5.out_of_bounds > 0", String::as_str);
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/sweeps/compass.toml");
    let sweep = load_sweep(&file).unwrap_or_else(|problems| panic!("{problems}"));
    let plan = Plan::new(&sweep).unwrap_or_else(|problems| panic!("{problems}"));
    let condition = Condition::parse(condition, &sweep).unwrap_or_else(|error| panic!("{error}"));
    let jobs = std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    println!("{condition}: {games} games each on {jobs} threads");

    let ways = [("splitting", true, true), ("cross-entropy", true, false), ("brute force", false, false)];
    let found = ways.map(|(name, learns, splits)| {
        let folder = tempfile::tempdir().expect("a folder");
        let mut journal = Journal::begin(folder.path(), &plan).unwrap_or_else(|error| panic!("{error}"));
        let stop = AtomicBool::new(false);
        let search = Search { games, learns, splits };
        let found = find(&plan, &condition, search, &mut journal, (jobs, &stop), |_, _| {});
        let found = found.unwrap_or_else(|error| panic!("{error}"));
        let (rate, half) = (100.0 * found.rate.mean, 100.0 * half_width(&found));
        println!("{name:14}{:5} failures in {} games, a rate of {rate:.3} % ± {half:.3}", found.failures, found.games);
        found
    });
    let brute = &found[2];
    for (found, (name, ..)) in found.iter().zip(ways).take(2) {
        let failures = found.failures as f64 / brute.failures.max(1) as f64;
        let ratio = half_width(brute) / half_width(found);
        let fewer = ratio * ratio * brute.games as f64 / found.games as f64;
        let after = found.factor.unwrap_or(f64::NAN);
        println!("{name}: {failures:.1} times as many failures; {fewer:.1} times fewer games for the same interval");
        println!("  by the games after learning alone: {after:.1} times fewer");
    }
}

fn half_width(found: &Found) -> f64 {
    found.rate.half_width().unwrap_or(f64::NAN)
}
