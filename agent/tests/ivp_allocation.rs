//! Heap allocations of a helm decision.
//!
//! `stats_alloc` counts; see `sim/tests/allocation.rs`. There is a single test because it counts the whole process.

use agent::ivp::{Approach, Closest, Grid, Objective, Peak, Preference, Problem, Table};
use primitives::Ned;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static HEAP: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// Decisions until every list has grown and the test harness has started this thread completely.
const WARM_UP: usize = 1_500;

#[test]
fn a_decision_takes_nothing_from_the_heap_once_its_lists_have_grown() {
    let grid = Grid::new(360, 36, 3.5);
    let table = Table::of(&grid, |k, j| ((36 * k + j) % 101) as f32);
    let mut problem = Problem::new(grid);
    for decision in 0..3_000 {
        let peak = Peak::tent(decision as f64, 2.0);
        let closest = Closest {
            offset: Ned { north: 30.0 - (decision % 60) as f64, east: 10.0 },
            velocity: Ned { north: -1.0, east: 0.5 },
            horizon_s: 60.0,
            min_m: 5.0,
            max_m: 50.0,
            touch_m: 0.0,
            approach: Approach::Avoid { at_min: 25.0, leave_to: None },
            lag: None,
        };
        let heap = Region::new(HEAP);
        problem.clear();
        problem.add(100.0, &Objective::Coupled { course: peak, speed: peak, course_share: 0.5 });
        problem.add(200.0, &Objective::Closest(closest));
        problem.add(20.0, &Objective::speed(Peak { peak_width: 2.0, ..Peak::tent(0.0, 0.5) }));
        problem.add(10.0, &Objective::Table(&table));
        let choice = problem.solve(Preference::default());
        let used = heap.change();
        assert!(choice.value > 0.0);
        if decision >= WARM_UP {
            assert_eq!(used.allocations + used.reallocations, 0, "decision {decision}: {used:?}");
        }
    }
}
