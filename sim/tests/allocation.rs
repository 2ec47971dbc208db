//! Heap allocations of a step (none unless hulls are close, and then none that persist) and of a
//! decision with radio links and limits on sharing (none once queues have grown).
//!
//! `stats_alloc` counts them: it has a hundred lines, is safe to use, and saves us from writing an
//! `unsafe` allocator. It counts the whole process, so this file has a single test.

mod common;

use common::{came_together, order, shipped, started};
use messages::Order;
use primitives::{Ned, VehicleId};
use sim::World;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static HEAP: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Ticks until all boats have met once, so that the lists of near boats and events have grown.
const WARM_UP: u32 = 1_300;

/// All boats head for the centre, then away again, for half a minute each.
fn orders(world: &World, middle: Ned, orders: &mut [Order]) {
    let away_rad = if (world.state().tick / 600).is_multiple_of(2) {
        0.0
    } else {
        std::f64::consts::PI
    };
    for (order, boat) in orders.iter_mut().zip(&world.state().boats) {
        *order = Order::Steer {
            heading_rad: boat.pose.at.bearing_rad(middle) + away_rad,
            speed_m_s: 2.0,
        };
    }
}

/// Whether any two boats are so close that their hulls may touch in the next tick.
fn crowded(world: &World, reach_m: f64) -> bool {
    let boats = &world.state().boats;
    let near = |i: usize| {
        boats[..i]
            .iter()
            .any(|other| other.pose.at.distance(boats[i].pose.at) < reach_m)
    };
    (0..boats.len()).any(near)
}

#[test]
fn steps_and_decisions_take_nothing_from_the_heap_unless_hulls_are_close_or_something_happens() {
    a_step_leaves_nothing_on_the_heap_and_takes_nothing_unless_hulls_are_close();
    a_decision_over_the_air_takes_nothing_unless_hulls_are_close_or_something_happens();
}

fn a_step_leaves_nothing_on_the_heap_and_takes_nothing_unless_hulls_are_close() {
    for game in ["pav01_vs_pav01.toml", "pav01_4v4.toml", "pav01_afloat.toml"] {
        let scenario = shipped(game);
        let mut world = World::of_game(&scenario, 1).expect("the boats fit");
        let mut plan = vec![Order::Hold; scenario.vehicles.len()];
        let mut free = 0;
        let mut busy = 0;
        let mut collisions = 0;
        let mut touching = Vec::new();
        for tick in 0..6_000 {
            orders(&world, scenario.field.middle(), &mut plan);
            // Two Surveyors bow to bow, plus the distance they may close in a tick.
            let crowded = crowded(&world, 1.83 + 0.5);
            let heap = Region::new(HEAP);
            world.step(&plan);
            let used = heap.change();
            collisions += came_together(&world, &scenario, &mut touching);
            if tick < WARM_UP {
                continue;
            }
            if crowded {
                busy += 1;
                // Rapier frees what it allocates.
                assert_eq!(
                    used.allocations, used.deallocations,
                    "{game}, tick {tick}: {used:?}"
                );
            } else {
                free += 1;
                assert_eq!(
                    used.allocations + used.reallocations,
                    0,
                    "{game}, tick {tick}: {used:?}"
                );
            }
        }
        // In waves the four boats do not meet.
        let meet = game != "pav01_afloat.toml";
        assert!(
            free > 1_000 && (!meet || busy > 10 && collisions > 0),
            "{game}: {free} free, {busy} busy, {collisions} met"
        );
    }
}

/// Decisions until queues, pictures and the list of past true states have grown.
const WARM_UP_DECISIONS: u64 = 1_500;

fn a_decision_over_the_air_takes_nothing_unless_hulls_are_close_or_something_happens() {
    let mut scenario = shipped("pav01_4v4.toml");
    common::hamper(&mut scenario);
    let mut contest = started(&scenario);
    let middle = scenario.field.middle();
    let mut free = 0;
    let mut busy = 0;
    let mut contacts = 0;
    while !contest.is_over() && contest.decision() < 6_000 {
        let crowded = crowded(contest.world(), 1.83 + 1.0);
        let events = contest.events().len();
        let decision = contest.decision();
        let heap = Region::new(HEAP);
        contacts += contest
            .pictures()
            .iter()
            .map(|picture| picture.contacts.len())
            .sum::<usize>();
        for i in 0..scenario.vehicles.len() {
            let round_rad = decision as f64 * 0.01 + i as f64;
            let at = contest.world().state().boats[i].pose.at;
            let heading_rad = if at.distance(middle) > 30.0 {
                at.bearing_rad(middle)
            } else {
                round_rad
            };
            order(
                &mut contest,
                VehicleId::at(i),
                Order::Steer {
                    heading_rad,
                    speed_m_s: 1.5,
                },
            );
        }
        contest.advance();
        let used = heap.change();
        // The event log grows occasionally.
        if crowded || contest.events().len() > events || decision < WARM_UP_DECISIONS {
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
    assert!(
        free > 1_000 && contacts > 1_000,
        "{free} decisions without, {busy} with, {contacts} contacts"
    );
}
