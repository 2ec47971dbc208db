//! What a decision of the helm asks of the heap.
//!
//! `stats_alloc` counts for us, see `sim/tests/allocation.rs`; one test, since it counts the whole process.

use agent::ivp::{Approach, Closest, Grid, Objective, Peak, Peaks, Problem, SpeedLimit, Wish};
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static HEAP: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Decisions in which every list has grown, and the test harness has done with starting this thread.
const WARM_UP: usize = 1_500;

#[test]
fn a_decision_takes_nothing_from_the_heap_once_its_lists_have_grown() {
    let table: Vec<f32> = (0..360 * 36).map(|i| (i % 101) as f32).collect();
    let mut problem = Problem::new(Grid::default());
    for decision in 0..3_000 {
        let peaks = Peaks::one(Peak::tent(decision as f64, 2.0));
        let closest = Closest {
            north_m: 30.0 - (decision % 60) as f64,
            east_m: 10.0,
            velocity_north_m_s: -1.0,
            velocity_east_m_s: 0.5,
            horizon_s: 60.0,
            min_m: 5.0,
            max_m: 50.0,
            touch_m: 0.0,
            approach: Approach::Avoid { at_min: 25.0 },
            lag: None,
        };
        let heap = Region::new(HEAP);
        problem.clear();
        problem.add(100.0, &Objective::Coupled { course: peaks, speed: peaks, course_share: 0.5 });
        problem.add(200.0, &Objective::Closest(closest));
        problem.add(20.0, &Objective::Limit(SpeedLimit::at_most(2.0, 0.5)));
        problem.add(10.0, &Objective::Table(&table));
        let choice = problem.solve(Wish::default());
        let used = heap.change();
        assert!(choice.value > 0.0);
        if decision >= WARM_UP {
            assert_eq!(used.allocations + used.reallocations, 0, "decision {decision}: {used:?}");
        }
    }
}
