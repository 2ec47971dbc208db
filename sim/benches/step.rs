//! `World::step` in calm water with two, twenty and five hundred boats per side, and in a rough sea
//! with all effects of sea and sensors.
#![allow(
    clippy::print_stdout,
    clippy::disallowed_methods,
    reason = "a benchmark reads the clock and prints"
)]

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use messages::Order;
use scenario::Scenario;
use sim::{State, World};
use std::path::Path;

fn shipped(game: &str) -> Scenario {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../scenarios/games")
        .join(game);
    scenario::load(&path).unwrap_or_else(|e| panic!("{e}"))
}

/// Orders that make all boats circle at speed, each differently, so that every part of the step is
/// exercised.
fn circling(world: &World, tick: u64) -> Vec<Order> {
    let count = world.state().boats.len();
    let heading_rad = |i: usize| (tick as f64 * 0.02 + i as f64) % 6.0 - 3.0;
    (0..count)
        .map(|i| Order::Steer {
            heading_rad: heading_rad(i),
            speed_m_s: 2.0,
        })
        .collect()
}

/// Ticks between two readings of the sensors, as in games.
const SENSOR_PERIOD: u64 = 2;

/// Boats restart after this many ticks (two minutes), before they leave the field.
const VOYAGE: u64 = 2_400;

/// Advances a run from `start` by one step; the run restarts after [`VOYAGE`] ticks.
fn sail(world: &mut World, start: &State, orders: &mut Vec<Order>) -> usize {
    if world.state().tick == VOYAGE {
        world.set_state(start.clone());
    }
    let tick = world.state().tick;
    if tick.is_multiple_of(20) {
        *orders = circling(world, tick);
    }
    if tick.is_multiple_of(SENSOR_PERIOD) {
        world.read_sensors();
    }
    world.step(orders).len()
}

fn step(c: &mut Criterion) {
    let mut group = c.benchmark_group("world_step");
    for (name, game) in [
        ("2v2", "pav01_vs_pav01.toml"),
        ("20v20", "swarm_20v20.toml"),
        ("500v500", "swarm_500v500.toml"),
    ] {
        let mut world = World::of_game(&shipped(game), 1).unwrap_or_else(|e| panic!("{e}"));
        let start = world.state().clone();
        let mut orders = circling(&world, 0);
        group.throughput(Throughput::Elements(world.state().boats.len() as u64));
        group.bench_function(name, |b| b.iter(|| sail(&mut world, &start, &mut orders)));
    }
    group.finish();
}

/// The step in a fresh breeze with 64 wave components, gusts, a current and all sensors; then with
/// flawed thrusters and a battery as well.
fn rough(c: &mut Criterion) {
    let afloat = shipped("pav01_afloat.toml")
        .of_seed(1)
        .unwrap_or_else(|e| panic!("{e}"));
    let mut group = c.benchmark_group("world_step_rough");
    for (name, game, flawed) in [
        ("2v2", "pav01_vs_pav01.toml", false),
        ("2v2_flawed", "pav01_vs_pav01.toml", true),
        ("500v500", "swarm_500v500.toml", false),
        ("500v500_flawed", "swarm_500v500.toml", true),
    ] {
        let mut scenario = shipped(game);
        scenario.sea = afloat.sea.clone();
        scenario.sea.current.mean_m_s = primitives::Ned {
            north: 0.1,
            east: 0.2,
        };
        scenario.boats[0].sensors = afloat.boats[0].sensors.clone();
        if flawed {
            scenario.boats[0] = afloat.boats[0].clone();
        }
        let mut world = World::of_game(&scenario, 1).unwrap_or_else(|e| panic!("{e}"));
        let start = world.state().clone();
        let mut orders = circling(&world, 0);
        let boats = world.state().boats.len() as u64;
        group.throughput(Throughput::Elements(boats));
        let mut ticks = 0;
        let mut spent = std::time::Duration::ZERO;
        group.bench_function(name, |b| {
            b.iter_custom(|count| {
                let begin = std::time::Instant::now();
                for _ in 0..count {
                    std::hint::black_box(sail(&mut world, &start, &mut orders));
                }
                let took = begin.elapsed();
                (ticks, spent) = (ticks + count, spent + took);
                took
            });
        });
        if ticks == 0 {
            continue;
        }
        let per_tick_s = spent.as_secs_f64() / ticks as f64;
        let boat_seconds = boats as f64 * 0.05 / per_tick_s;
        println!(
            "{name}: {boat_seconds:.0} boat-seconds per CPU-second, {:.0} times real time",
            0.05 / per_tick_s
        );
    }
    group.finish();
}

criterion_group!(benches, step, rough);
criterion_main!(benches);
