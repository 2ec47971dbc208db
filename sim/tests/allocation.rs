//! Heap allocations of a step: none unless hulls are close, and then none that persist.
//!
//! `stats_alloc` counts: it has a hundred lines, is safe to use, and avoids an `unsafe` allocator of
//! our own. It counts the whole process, so this file has one test.

mod common;

use common::{came_together, shipped};
use messages::Order;
use primitives::Ned;
use sim::World;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static HEAP: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Ticks until all boats have met once, so that the lists of near boats and events have grown.
const WARM_UP: u32 = 1_300;

/// All boats head for the centre, then away again, for half a minute each.
fn orders(world: &World, middle: Ned, orders: &mut [Order]) {
    let away_rad = if (world.state().tick / 600).is_multiple_of(2) { 0.0 } else { std::f64::consts::PI };
    for (order, boat) in orders.iter_mut().zip(&world.state().boats) {
        *order = Order::Steer { heading_rad: boat.pose.at.bearing_rad(middle) + away_rad, speed_m_s: 2.0 };
    }
}

/// Whether any two boats are so close that their hulls may touch in the next tick.
fn crowded(world: &World, reach_m: f64) -> bool {
    let boats = &world.state().boats;
    let near = |i: usize| boats[..i].iter().any(|other| other.pose.at.distance(boats[i].pose.at) < reach_m);
    (0..boats.len()).any(near)
}

#[test]
fn a_step_leaves_nothing_on_the_heap_and_takes_nothing_unless_hulls_are_close() {
    for game in ["pav01_vs_pav01.toml", "pav01_4v4.toml", "pav01_afloat.toml"] {
        let scenario = shipped(game);
        let mut world = World::of_game(&scenario, 1).unwrap();
        let mut plan = vec![Order::Hold; scenario.vehicles.len()];
        let (mut free, mut busy, mut collisions, mut touching) = (0, 0, 0, Vec::new());
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
                assert_eq!(used.allocations, used.deallocations, "{game}, tick {tick}: {used:?}");
            } else {
                free += 1;
                assert_eq!(used.allocations + used.reallocations, 0, "{game}, tick {tick}: {used:?}");
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
