//! Runs one target for some seconds with changes of real inputs; what fails is left in a file.

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

/// Counts what is allocated.
#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// The longest that a check may take of the processor: an input is small.
const CPU_MAX: Duration = Duration::from_secs(5);
/// The longest that it may take by the clock, on a machine that does much else.
const HUNG: Duration = Duration::from_secs(120);
/// The length of an input stands before it in the file, as 64 bits, little-endian.
const LENGTH: u64 = 8;

/// Checks an input, and what checking it costs.
///
/// # Panics
/// Where a promise is broken.
pub fn check(target: &Target, input: &[u8]) {
    let (base, times) = target.allocated_max;
    let is_within = |(allocated, cpu): (usize, Duration)| allocated <= base + times * input.len() && cpu < CPU_MAX;
    // What is made once and kept is not the input's fault: it is looked at again.
    if !is_within(cost(target, input)) {
        let (allocated, cpu) = cost(target, input);
        assert!(is_within((allocated, cpu)), "{allocated} bytes and {cpu:?} for {} bytes of input", input.len());
    }
}

/// What a check allocates in all, bytes, and how long it takes of the processor.
fn cost(target: &Target, input: &[u8]) -> (usize, Duration) {
    let (allocated, cpu) = (ALLOCATOR.stats().bytes_allocated, cpu_time());
    (target.check)(input);
    (ALLOCATOR.stats().bytes_allocated - allocated, cpu_time() - cpu)
}

/// Runs a target for so long; gives how many inputs there were. Each stands in the file `current` while it is checked, so that it is
/// there if the process does not survive it.
///
/// # Errors
/// The input that failed.
///
/// # Panics
/// If the file cannot be written.
#[expect(clippy::disallowed_methods, reason = "how long it runs is all that the clock decides")]
pub fn soak(target: &Target, time: Duration, seed: u64, current: &Path) -> Result<u64, Vec<u8>> {
    let seeds = (target.seeds)();
    let file = File::create(current).expect("the file can be written");
    let runs = watch_dog();
    let run = |input: Vec<u8>| {
        file.write_all_at(&(input.len() as u64).to_le_bytes(), 0).expect("the file can be written");
        file.write_all_at(&input, LENGTH).expect("the file can be written");
        runs.fetch_add(1, Ordering::Relaxed);
        catch_unwind(AssertUnwindSafe(|| check(target, &input))).map_err(|_| input)
    };
    // What was real is to pass, too.
    seeds.iter().try_for_each(|seed| run(seed.clone()))?;
    let (change, mut dice, begin) = ((target.change)(seeds), Dice::new(seed), Instant::now());
    while begin.elapsed() < time {
        run(change(&mut dice))?;
    }
    Ok(runs.load(Ordering::Relaxed))
}

/// The input that was being checked when the process ended.
#[must_use]
pub fn left_in(current: &Path) -> Option<Vec<u8>> {
    let bytes = std::fs::read(current).ok()?;
    let (length, rest) = bytes.split_first_chunk()?;
    rest.get(..usize::try_from(u64::from_le_bytes(*length)).ok()?).map(<[u8]>::to_vec)
}

/// A count of runs; the process ends if it stands still for too long.
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

/// The time that this thread has had of the processor.
fn cpu_time() -> Duration {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}
