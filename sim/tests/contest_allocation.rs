//! Heap allocations of a decision with radio links and limits on sharing: none once queues have
//! grown.
//!
//! `stats_alloc` counts; see `allocation.rs`. This file has one test because it counts the whole
//! process.

mod common;

use common::{order, shipped};
use messages::Order;
use primitives::VehicleId;
use sim::Contest;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static HEAP: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Decisions until queues, pictures and the list of past true states have grown.
const WARM_UP: u64 = 1_500;

#[test]
fn a_decision_over_the_air_takes_nothing_from_the_heap_unless_hulls_are_close_or_something_happens() {
    let mut scenario = shipped("pav01_4v4.toml");
    common::hamper(&mut scenario);
    let mut contest = Contest::new(&scenario, 1).unwrap();
    let middle = scenario.field.middle();
    let (mut free, mut busy, mut contacts) = (0, 0, 0);
    while !contest.is_over() && contest.decision() < 6_000 {
        let boats = &contest.world().state().boats;
        let near = |i: usize| boats[..i].iter().any(|other| other.pose.at.distance(boats[i].pose.at) < 1.83 + 1.0);
        let crowded = (0..boats.len()).any(near);
        let (count, events, decision) = (boats.len(), contest.events().len(), contest.decision());
        let heap = Region::new(HEAP);
        contacts += contest.pictures().iter().map(|picture| picture.contacts.len()).sum::<usize>();
        for i in 0..count {
            let round_rad = decision as f64 * 0.01 + i as f64;
            let at = contest.world().state().boats[i].pose.at;
            let heading_rad = if at.distance(middle) > 30.0 { at.bearing_rad(middle) } else { round_rad };
            order(&mut contest, VehicleId::at(i), Order::Steer { heading_rad, speed_m_s: 1.5 });
        }
        contest.advance();
        let used = heap.change();
        // The event log grows from time to time.
        if crowded || contest.events().len() > events || decision < WARM_UP {
            busy += 1;
        } else {
            free += 1;
            assert_eq!(used.allocations + used.reallocations, 0, "decision {decision}: {used:?}");
        }
    }
    assert!(free > 1_000 && contacts > 1_000, "{free} decisions without, {busy} with, {contacts} contacts");
}
