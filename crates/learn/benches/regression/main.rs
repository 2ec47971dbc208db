//! The cost of whole games, environment steps and policy evaluations, as a multiple of a reference
//! loop that is measured alternately with each case. The multiple depends little on the machine's
//! clock and load.
//!
//! `cargo bench -p squall-learn --bench regression` compares the multiples with those stored in
//! `stored.csv`; with `-- --store`, it stores them. `tests/compare.py` uses `-- --csv` to compare
//! two commits.
#![allow(clippy::print_stdout, reason = "a benchmark prints")]

mod cases;
#[path = "../../../arena/examples/speed/core_time.rs"]
mod core_time;

use cases::Case;
use core_time::core_time_s;
use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::Path;

/// Number of measurements of each case.
const ROUNDS: usize = 15;
/// CPU time of a measurement of a case, s: long enough to ignore the clock's resolution.
const RUN_S: f64 = 0.03;
/// Iterations of the reference loop per measurement, about 10 ms.
const REFERENCE: u32 = 400_000;

fn main() {
    let args: Vec<String> = std::env::args().collect();
    // `cargo test --benches` runs this without `--bench`: there is nothing to check.
    if !args.iter().any(|arg| arg == "--bench") {
        return;
    }
    let has = |flag: &str| args.iter().any(|arg| arg == flag);
    let measured = cases::all()
        .into_iter()
        .map(|case| (case.name, multiple(case)));
    if has("--csv") {
        measured.for_each(|(name, multiple)| println!("{name},{multiple:.5}"));
    } else if has("--store") {
        let rows: String = measured
            .map(|(name, multiple)| format!("{name},{multiple:.4}\n"))
            .collect();
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/regression/stored.csv");
        std::fs::write(&path, format!("case,reference loops\n{rows}"))
            .unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    } else {
        print_beside_stored(measured);
    }
}

fn print_beside_stored(measured: impl Iterator<Item = (&'static str, f64)>) {
    let stored: BTreeMap<&str, f64> = include_str!("stored.csv")
        .lines()
        .skip(1)
        .filter_map(|row| row.rsplit_once(','))
        .map(|(name, multiple)| (name, multiple.parse().expect("a stored multiple")))
        .collect();
    println!("{:<44}  {:>12}  {:>8}", "case", "in loops", "stored");
    for (name, multiple) in measured {
        match stored.get(name) {
            Some(before) => {
                let change = 100.0 * (multiple / before - 1.0);
                println!("{name:<44}  {multiple:>12.4}  {before:>8.4}  {change:>+6.1} %");
            }
            None => println!("{name:<44}  {multiple:>12.4}  {:>8}", "new"),
        }
    }
}

/// The median cost of one run of the case, in measurements of the reference loop.
fn multiple(mut case: Case) -> f64 {
    // Warms caches, and finds how often to run the case.
    let once_s = timed(&mut case.run).max(1e-6);
    let runs = (RUN_S / once_s).ceil().max(1.0) as u32;
    let mut multiples: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let before_s = timed(reference);
            let case_s = timed(|| (0..runs).for_each(|_| (case.run)())) / f64::from(runs);
            case_s / (0.5 * (before_s + timed(reference)))
        })
        .collect();
    multiples.sort_by(f64::total_cmp);
    multiples[ROUNDS / 2]
}

fn timed(run: impl FnOnce()) -> f64 {
    let begun_s = core_time_s();
    run();
    core_time_s() - begun_s
}

/// A loop with the instructions of a simulation: dependent and independent floating-point
/// arithmetic, square roots, branches, and memory that fits into the second-level cache.
fn reference() {
    const SIZE: usize = 1 << 14;
    let mut numbers = vec![1.0_f64; SIZE];
    let mut at = 1_usize;
    let mut sum = 0.0_f64;
    for i in 0..black_box(REFERENCE) {
        at = (at.wrapping_mul(1_103_515_245).wrapping_add(12_345)) % SIZE;
        let number = numbers[at];
        sum = 0.999 * sum + (number + f64::from(i & 15)).sqrt();
        numbers[at] = if sum > 2000.0 {
            1.0
        } else {
            number + 1e-3 * sum
        };
    }
    black_box((sum, numbers));
}
