//! Runs one target for some time on mutated real inputs. Saves a failing input to a file.

use crate::{Dice, Target};
use rustix::time::{ClockId, clock_gettime};
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;
use std::fs::File;
use std::os::unix::fs::FileExt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Counts allocations.
#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// CPU time limit of a check; inputs are small.
const CPU_MAX: Duration = Duration::from_secs(5);
/// Wall-clock limit of a check, for busy machines.
const HUNG: Duration = Duration::from_secs(120);
/// Size of the length field before the input in the file `current`: 64 bits, little-endian.
const LENGTH: u64 = 8;

/// Checks an input, including the memory and CPU time that the check takes.
///
/// # Panics
/// If a guarantee is violated.
pub fn check(target: &Target, input: &[u8]) {
    let (base, times) = target.allocated_max;
    let is_within = |(allocated, cpu): (usize, Duration)| {
        allocated <= base + times * input.len() && cpu < CPU_MAX
    };
    // Data that is created once and cached does not count: measure again.
    if !is_within(cost(target, input)) {
        let (allocated, cpu) = cost(target, input);
        assert!(
            is_within((allocated, cpu)),
            "{allocated} bytes and {cpu:?} for {} bytes of input",
            input.len()
        );
    }
}

/// The total bytes allocated by a check, and its CPU time.
fn cost(target: &Target, input: &[u8]) -> (usize, Duration) {
    let allocated = ALLOCATOR.stats().bytes_allocated;
    let cpu = cpu_time();
    (target.check)(input);
    (
        ALLOCATOR.stats().bytes_allocated - allocated,
        cpu_time() - cpu,
    )
}

/// Runs a target for this long. Returns the number of inputs. The file `current` holds each input
/// while it is checked, so that the input survives a crash.
///
/// # Errors
/// The input that failed.
///
/// # Panics
/// If the file cannot be written.
#[expect(
    clippy::disallowed_methods,
    reason = "the clock only decides how long it runs"
)]
pub fn soak(target: &Target, time: Duration, seed: u64, current: &Path) -> Result<u64, Vec<u8>> {
    let seeds = (target.seeds)();
    let file = File::create(current).expect("the file can be written");
    let runs = watch_dog();
    let run = |input: Vec<u8>| {
        file.write_all_at(&(input.len() as u64).to_le_bytes(), 0)
            .expect("the file can be written");
        file.write_all_at(&input, LENGTH)
            .expect("the file can be written");
        runs.fetch_add(1, Ordering::Relaxed);
        catch_unwind(AssertUnwindSafe(|| check(target, &input))).map_err(|_| input)
    };
    // The unchanged real inputs must pass too.
    seeds.iter().try_for_each(|seed| run(seed.clone()))?;
    let change = (target.change)(seeds);
    let mut dice = Dice::new(seed);
    let begin = Instant::now();
    while begin.elapsed() < time {
        run(change(&mut dice))?;
    }
    Ok(runs.load(Ordering::Relaxed))
}

/// The input that was being checked when the process ended.
pub fn left_in(current: &Path) -> Option<Vec<u8>> {
    let bytes = std::fs::read(current).ok()?;
    let (length, rest) = bytes.split_first_chunk()?;
    rest.get(..usize::try_from(u64::from_le_bytes(*length)).ok()?)
        .map(<[u8]>::to_vec)
}

/// A counter of runs. The process ends if the counter does not change for too long.
fn watch_dog() -> &'static AtomicU64 {
    static RUNS: AtomicU64 = AtomicU64::new(0);
    std::thread::spawn(|| {
        loop {
            let before = RUNS.load(Ordering::Relaxed);
            std::thread::sleep(HUNG);
            if RUNS.load(Ordering::Relaxed) == before {
                std::process::abort();
            }
        }
    });
    &RUNS
}

/// CPU time used by this thread.
fn cpu_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}
