//! Heap allocations of a whole decision: pictures, minds, ticks and the referee.
//!
//! `stats_alloc` counts them (see `sim/tests/allocation.rs`). This file has a single test, because
//! the count covers the whole process.

use scenario::Scenario;
use sim::Contest;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;
use std::path::Path;

#[global_allocator]
static HEAP: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Decisions until every kind of event, including captures and a tag, has occurred once, so that
/// every list has grown.
const WARM_UP: u64 = 4_100;

#[test]
fn a_decision_takes_nothing_from_the_heap_unless_hulls_are_close_or_something_happens() {
    let path =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios/games/pav01_vs_pav01.toml");
    let scenario: Scenario = scenario::load(&path).unwrap_or_else(|e| panic!("{e}"));
    let mut runner = arena::runner_of(agent::minds_of(&scenario));
    let mut contest = Contest::new(&scenario, 1).unwrap_or_else(|e| panic!("{e}"));
    let mut free = 0;
    let mut busy = 0;
    while !contest.is_over() {
        let boats = &contest.world().state().boats;
        let near = |i: usize| {
            boats[..i]
                .iter()
                .any(|other| other.pose.at.distance(boats[i].pose.at) < 1.83 + 1.0)
        };
        let crowded = (0..boats.len()).any(near);
        let events = contest.events().len();
        let decision = contest.decision();
        let heap = Region::new(HEAP);
        arena::decide(&mut contest, &mut runner);
        contest.advance();
        let used = heap.change();
        // Only the event log grows, occasionally.
        if crowded || contest.events().len() > events || decision < WARM_UP {
            busy += 1;
        } else {
            free += 1;
            assert_eq!(
                used.allocations + used.reallocations,
                0,
                "decision {decision}: {used:?}"
            );
        }
    }
    assert!(free > 1_500, "{free} decisions without, {busy} with");
}
